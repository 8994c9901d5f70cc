"""`check --sheet` and `--focus`: crops are seen before they are solved for, moved, and remembered."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from lightcube import load
from tests.cli.test_cli import run

__all__ = ["run"]

SMALL = ("--n", 6, "--picture-width", 1, "--iterations", 2, "--hold-deg", 0, "--grain", 0, "--mat", "none")


@pytest.fixture
def wide(tmp_path: Path) -> Path:
    """A square picture, and two of which the left half is dark and the right half bright."""
    folder = tmp_path / "wide"
    folder.mkdir()
    Image.new("RGB", (40, 40), (128, 128, 128)).save(folder / "0.png")
    halves = np.repeat(np.repeat(np.array([[60, 220]], np.uint8), 50, axis=1), 40, axis=0)
    for number in (1, 2):
        Image.fromarray(np.stack([halves] * 3, axis=2)).save(folder / f"{number}.png")
    return folder


@pytest.mark.parametrize(("said", "levels"), [((), 140), (("--focus", "0,0.5"), 60), (("--focus", "1,0"), 220)])
def test_the_focus_decides_what_is_asked_for_and_is_remembered(  # type: ignore[no-untyped-def]
    run, wide: Path, tmp_path: Path, said: tuple[str, ...], levels: int
) -> None:
    out = tmp_path / "a.npz"
    assert run("solve", wide, "-o", out, *SMALL, *said).code == 0
    cube = load(out)
    assert cube.targets is not None
    assert np.median(cube.targets[1, ..., :3]) / 257 == pytest.approx(levels, abs=90 if not said else 1)
    own, again = (json.loads(run("score", out, *given, "--json").out)["psnr_mean"] for given in ((), (wide,)))
    assert again == pytest.approx(own, abs=0.05)
    page = tmp_path / "a.html"
    assert run("report", out, wide, "-o", page).code == 0
    assert " ".join(said) in page.read_text()
    assert ("--focus" in page.read_text()) == bool(said)


def test_a_sheet_shows_what_will_be_asked_for(run, wide: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    sheets = []
    for name, said in (("a.png", ()), ("b.webp", ("--focus", "0,0.5")), ("c.jpg", ("--focus", "1,0.5"))):
        done = run("check", wide, "--n", 6, "--picture-width", 1, "--sheet", tmp_path / name, *said)
        assert done.code == 0, done.err
        with Image.open(tmp_path / name) as sheet:
            sheets.append(np.asarray(sheet.convert("RGB")).astype(int))
    assert sheets[0].shape == sheets[1].shape == sheets[2].shape
    # of the second picture the left half is dim where the right one is kept
    left, right = (sheet[: sheet.shape[0] // 2, 168 : 168 + 40].mean() for sheet in sheets[1:])
    assert left > right
    again = run("check", wide, "--n", 6, "--sheet", tmp_path / "a.png")
    assert (again.code, len(again.lines)) == (2, 1)
    assert "exists" in again.err
    assert run("check", wide, "--n", 6, "--sheet", tmp_path / "a.png", "--overwrite").code == 0


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--focus", "1.2,0.5"), "--focus 1.2,0.5 is outside the picture"),
        (("--focus", "0.5,-0.1"), "--focus 0.5,-0.1 is outside the picture"),
        (("--focus", "nan,0.5"), "outside the picture"),
        (("--focus", "0.5"), "--focus 0.5: give two numbers"),
        (("--focus", "left"), "--focus left: give numbers"),
        (("--focus", "0.5,0.5", "--fit", "pad"), "not for --fit pad"),
        (("--sheet", "{tmp}/a.txt"), "has no suffix that a picture can have"),
        (("--sheet", "{tmp}/none/a.png"), "none"),
    ],
)
def test_what_cannot_be_is_one_sentence(run, wide: Path, tmp_path: Path, options: tuple[str, ...], said: str) -> None:  # type: ignore[no-untyped-def]
    before = sorted(tmp_path.rglob("*"))
    done = run("check", wide, "--n", 6, *(option.format(tmp=tmp_path) for option in options))
    assert (done.code, len(done.lines)) == (2, 1), done.err
    assert said in done.err
    assert sorted(tmp_path.rglob("*")) == before
