"""Inks from densities that were typed, and from a photograph's file."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from lightcube.errors import InputError
from lightcube.io import read_dyes
from lightcube.optics.transfer import to_uint8
from tests.calibration.test_calibration import CMYK, WEDGE, usual
from tests.cli.test_cli import run
from tests.helpers.wedges import photograph, printed

__all__ = ["run"]


def table(path: Path, *more: str) -> Path:
    """Densities of all patches, and of the film, as a densitometer writes them."""
    base = CMYK.base / np.log(10)
    lines = ["ink,coverage,red,green,blue", f"film,0,{','.join(map(str, base))}"]
    for patch in WEDGE.patches:
        names = [name for name, part in zip(CMYK.names, patch.coverages, strict=True) if part]
        if names:
            densities = base - np.log10(printed(CMYK, patch))
            lines.append(
                f"{'+'.join(names)},{max(patch.coverages):.9f},{','.join(f'{each:.5f}' for each in densities)}"
            )
    path.write_text("\n".join([*lines, *more]) + "\n")
    return path


def test_typed_densities_give_the_inks_back(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("calibrate", "fit", table(tmp_path / "a.csv"), "-o", tmp_path / "inks.toml")
    assert done.code == 0, done.err
    assert "doubtful" not in done.err
    dyes = read_dyes(tmp_path / "inks.toml")
    assert (dyes.names, dyes.calibration, dyes.kind) == (CMYK.names, "measured", "ink")
    np.testing.assert_allclose(dyes.extinction, CMYK.extinction, rtol=1e-4)
    np.testing.assert_allclose(dyes.base, CMYK.base, rtol=1e-4)
    for fitted, planted in zip(dyes.gain, CMYK.gain, strict=True):
        assert fitted is not None
        assert planted is not None
        np.testing.assert_allclose(fitted, planted, atol=2e-4)


def test_a_photographs_file_does_too(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    Image.fromarray(to_uint8(photograph(usual(), noise=0.003), "srgb")).save(tmp_path / "photo.png")
    done = run("calibrate", "fit", tmp_path / "photo.png", "-o", tmp_path / "inks.toml")
    assert done.code == 0, done.err
    np.testing.assert_allclose(read_dyes(tmp_path / "inks.toml").extinction, CMYK.extinction, rtol=0.02, atol=0.01)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("cyan,0.5,0.1,0.2", "line 187 says 'cyan,0.5,0.1,0.2': give ink, coverage"),
        ("cyan,2,0.1,0.2,0.3", "coverage from 0 to 1"),
        ("cyan,0.5,-1,0.2,0.3", "three densities from 0 to 10"),
        ("cyan,0.5,nan,0.2,0.3", "three densities from 0 to 10"),
        ("orange,0.5,0.1,0.2,0.3", "full orange absorbs nothing"),
    ],
)
def test_a_wrong_line_is_named(run, tmp_path: Path, line: str, said: str) -> None:  # type: ignore[no-untyped-def]
    done = run("calibrate", "fit", table(tmp_path / "a.csv", line), "-o", tmp_path / "inks.toml")
    assert done.code == 2
    assert said in done.err
    assert not (tmp_path / "inks.toml").exists()


def test_what_else_is_wrong_is_one_sentence(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "film.csv").write_text("ink,coverage,red,green,blue\ncyan,1,1,1,1\n")
    (tmp_path / "head.csv").write_text("cyan,1,1,1,1\n")
    for words, said in [
        (("fit", tmp_path / "film.csv"), "says no density of bare film"),
        (("fit", tmp_path / "head.csv"), "must begin with the line ink,coverage,red,green,blue"),
        (("fit", tmp_path / "none.png"), "none.png"),
        (("fit",), "takes a photograph"),
        (("wedge", "photo.png"), "reads nothing"),
        (("wedge", "--inks", "orange"), "no ink called 'orange'"),
        (("wedge", "--steps", "3"), "16 or 32 steps"),
    ]:
        done = run("calibrate", *words, "-o", tmp_path / ("a.png" if words[0] == "wedge" else "a.toml"))
        assert done.code == 2, words
        assert said in done.err
        assert "Traceback" not in done.err
    with pytest.raises(InputError, match="no material"):
        read_dyes("a")


def test_the_page_is_written(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("calibrate", "wedge", "-o", tmp_path / "a.png", "--dpi", "100", "--inks", "cyan,yellow")
    assert done.code == 0, done.err
    with Image.open(tmp_path / "a.png") as image:
        assert image.size == (827, 1169)
