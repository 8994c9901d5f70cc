"""Stacks of films on the command line."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import lightcube as lc
from lightcube.optics.stack import Stack
from lightcube.optics.transfer import encode
from tests.cli.test_cli import run

__all__ = ["run"]


@pytest.fixture
def photos(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A folder of two pictures of 6 x 8 pixels."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "photos").mkdir()
    random = np.random.default_rng(0)
    for name in ("a", "b"):
        Image.fromarray(random.integers(30, 220, (6, 8, 3), np.uint8)).save(tmp_path / "photos" / f"{name}.png")
    return "photos"


FEW = ("--films", "3", "--n", "16", "--size-mm", "40", "--gap-mm", "8", "--iterations", "20")


def test_photographs_become_films_in_one_command(run: Any, photos: str) -> None:
    done = run("solve", photos, *FEW, "-o", "stack.zarr", "--seed", "3")
    assert done.code == 0
    assert "3 films of 50 x 30 mm in cells of 2.5 mm, 16 mm deep" in " ".join(done.err.split())
    assert "with films 0.2 mm off" in done.err
    cube = lc.load("stack.zarr")
    assert cube.grid == Stack(cube.grid.shape, 2.5, heights_mm=(-8, 0, 8))
    assert cube.provenance["seed"] == 3
    known = run("info", "stack.zarr").out
    assert "heights_mm  -8, 0, 8" in known
    scored = json.loads(run("score", "stack.zarr", "--robust", "--json").out)
    assert scored["psnr_mean"] > scored["robust"]["shifted"]["psnr_mean"] > 10
    assert run("solve", photos, *FEW, "-o", "stack.zarr").code == 2  # it is there


def test_check_says_what_is_probably_not_meant(run: Any, photos: str) -> None:
    stack = "[stack]\nfilms = 2\nsize_mm = 4\npixels = 8\ncells_per_pixel = 1\n"
    Path("fine.toml").write_text(f'{stack}[[picture]]\nfile = "{photos}"\n')
    fine = run("check", "fine.toml")
    assert fine.code == 0
    assert "cells are as wide as pixels" in fine.out
    assert "cells are 0.5 mm wide" in fine.out
    many = run("check", photos, "--films", "12")
    assert "12 clear films as loose films let 27% through" in many.out
    assert "nothing here is impossible" in many.out


def test_a_stage_of_films_says_all_there_is(run: Any, photos: str) -> None:
    Path("films.toml").write_text(
        f'[stack]\nfilms = 3\ngap_mm = 8\nsize_mm = 40\npixels = 8\n[[picture]]\nfile = "{photos}"\n'
    )
    done = run("solve", "films.toml", "-o", "stack.zarr", "--iterations", "5")
    assert done.code == 0
    assert lc.load("stack.zarr").grid.shape[0] == 3
    refused = run("solve", "films.toml", "-o", "other.zarr", "--films", "4")
    assert refused.code == 2
    assert "--films is not for a stage" in refused.err


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (("--films", "0"), "films"),
        (("--films", "300"), "between 1 and 256"),
        (("--films", "1"), "are cast by the same light"),
        (("--films", "3", "--gap-mm", "0"), "are cast by the same light"),
        (("--films", "3", "--gap-mm", "-1"), "gap_mm"),
        (("--films", "3", "--n", "9"), "whole pixels of 2"),
        (("--films", "3", "--elevation-deg", "20"), "--elevation-deg is for cubes"),
        (("--films", "3", "--order", "best"), "--order is for cubes"),
        (("--films", "3", "--shape", "3,3,3"), "--shape is for cubes"),
        (("--films", "3", "--size-mm", "nan"), "size"),
        (("--gap-mm", "3"), "say how many with --films"),
        (("--n", "8", "--assembly-mm", "0.1", "--picture-width", "0.5"), "a cube has none"),
        (("--films", "3", "--method", "sirt"), "display"),
    ],
)
def test_what_cannot_be_is_one_sentence(run: Any, photos: str, more: tuple[str, ...], said: str) -> None:
    done = run("solve", photos, *more, "-o", "stack.zarr", "--dry-run")
    assert done.code == 2, done.err
    assert said in " ".join(done.err.split())
    assert "Traceback" not in done.err
    assert not Path("stack.zarr").exists()


def test_a_photograph_of_the_real_thing_is_compared_with_what_was_promised(run: Any, photos: str) -> None:
    """A camera that looks straight on, at a picture in the dark."""
    assert run("solve", photos, *FEW, "-o", "stack.zarr").code == 0
    promised = list(lc.cast(lc.load("stack.zarr")))[1]
    wall = np.zeros((200, 260, 3), np.uint8)
    shown = np.clip(encode(0.7 * promised), 0, 1).repeat(20, axis=0).repeat(20, axis=1)
    wall[40 : 40 + len(shown), 50 : 50 + shown.shape[1]] = np.rint(255 * shown)
    Image.fromarray(wall).save("wall.png")
    found = json.loads(run("score", "stack.zarr", "--photo", "wall.png", "--stop", "2", "--json").out)
    assert found["promised"]["psnr"] > 30
    assert found["exposure_ev"] == pytest.approx([np.log2(0.7)] * 3, abs=0.05)
    said = run("score", "stack.zarr", "--photo", "wall.png", "--stop", "2", "--sheet", "sheet.png")
    assert "beside what was promised" in said.out
    with Image.open("sheet.png") as sheet:
        assert sheet.size[0] > 300
    for more, what in (
        (("--photo", "wall.png"), "belong together"),
        (("--stop", "2"), "belong together"),
        (("--photo", "wall.png", "--stop", "3"), "there is no picture 3"),
        (("--photo", "no.png", "--stop", "2"), "no.png"),
        (("--photo", "wall.png", "--stop", "2", "--corners", "1,2,3"), "eight numbers"),
        (("--photo", "wall.png", "--stop", "2", "--robust"), "take --sheet only"),
    ):
        refused = run("score", "stack.zarr", *more)
        assert refused.code == 2
        assert what in " ".join(refused.err.split())
