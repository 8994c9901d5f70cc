"""Pictures to printed films in one command, and what is told on the way."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.cli.test_cli import run

__all__ = ["run"]

pytest.importorskip("reportlab")

FEW = ["--films", "2", "--n", "8", "--size-mm", "20.32", "--gap-mm", "5.08", "--iterations", "4"]


@pytest.fixture
def photos(tmp_path: Path) -> Path:
    """Two pictures that are no wider than high."""
    folder = tmp_path / "photos"
    folder.mkdir()
    for number in range(2):
        levels = np.random.default_rng(number).integers(0, 255, (6, 4, 3), dtype=np.uint8)
        Image.fromarray(levels).save(folder / f"{number}.png")
    return folder


def test_pictures_become_films_in_one_command(run, photos: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    out = tmp_path / "prints.pdf"
    told = " ".join(run("solve", photos, *FEW, "-o", out).out.split())
    assert "prints.pdf is ready to be printed" in told
    assert "lightcube export film" in told
    assert {each.name for each in tmp_path.iterdir()} == {"photos", "prints.pdf", "prints.pdf.json", "prints.zarr"}
    predicted = json.loads((tmp_path / "prints.pdf.json").read_text())["predicted"]["psnr_mean"]
    assert json.loads(run("score", out, "--json").out)["psnr_mean"] == pytest.approx(predicted, abs=0.05)
    assert json.loads(run("score", out, tmp_path / "prints.zarr", "--json").out)["psnr_mean"] == predicted
    assert run("play", out, "-o", tmp_path / "shown").code == 0


@pytest.mark.parametrize(
    ("said", "told"),
    [
        (["--n", "8"], "not a stack of films"),
        ([*FEW, "--unit", "1/2"], "--unit solves a part"),
        (["--films", "2", "--n", "8", "--size-mm", "300"], "do not fit a4"),
    ],
)
def test_what_cannot_be_printed_is_told_before_it_is_solved(  # type: ignore[no-untyped-def]
    run, photos: Path, tmp_path: Path, said: list[str], told: str
) -> None:
    found = run("solve", photos, *said, "-o", tmp_path / "prints.pdf")
    assert found.code == 2
    assert told in " ".join(found.err.split())
    assert [each.name for each in tmp_path.iterdir()] == ["photos"]


def test_a_cube_becomes_films_and_says_what_that_gains(run, photos: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    small = ["--n", 8, "--size-mm", 30, "--elevation-deg", 35, "--iterations", 4, "--hold-deg", 0, "--mat", "none"]
    assert run("solve", photos, *small, "-o", tmp_path / "cube.npz").code == 0
    out = tmp_path / "prints.pdf"
    told = " ".join(run("export", "film", tmp_path / "cube.npz", "-o", out, "--films", "4").out.split())
    assert "4 films, solved for themselves" in told
    assert "the cube's slices as they are" in told
    predicted = json.loads((tmp_path / "prints.pdf.json").read_text())["predicted"]["psnr_mean"]
    assert json.loads(run("score", out, "--json").out)["psnr_mean"] == pytest.approx(predicted, abs=0.05)
    again = run("export", "film", tmp_path / "prints.zarr", "-o", tmp_path / "more.pdf", "--paper", "a3", "--no-score")
    assert again.code == 0
    refused = run("export", "volume", tmp_path / "cube.npz", "-o", tmp_path / "a.vdb", "--films", "4")
    assert "--films is of printed films" in refused.err
