"""The command line with a stack of films: each picture is shown, nothing turns, and no word is of a turntable."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import lightcube as lc
from lightcube import load
from lightcube.forward import casting
from lightcube.io import save
from lightcube.optics.cube import Cube
from tests.cli.test_cli import run
from tests.helpers.films import stack_of

__all__ = ["run"]


@pytest.fixture
def stack(tmp_path: Path) -> Path:
    """Three films of noise, for two pictures under lamps of their own and one of a film that is slid."""
    moves = [None, None, lc.Move("m", shift_mm=((0, 0), (5, 0), (0, 0)))]
    films = lc.Films(count=3, gap_mm=12, pixels=6, size_mm=60)
    lamps = [lc.Lamp("left", direction=(0.3, 0.0, -1.0)), lc.Lamp("right", direction=(-0.3, 0.0, -1.0))]
    lit = [["left"], ["right"], ["right"]]
    stage = lc.attenuator(["one", "two", "three"], films, lamps=lamps, lit=lit, moves=moves)
    extinction = np.random.default_rng(1).uniform(0, 0.3, (3, *stage.grid.shape)).astype(np.float32)
    rig = stage.rig()
    wanted = np.random.default_rng(2).integers(1, 65536, (3, *rig.picture_shape, 4), np.uint16)
    cube = Cube(extinction, stack_of(stage), rig, targets=wanted, names=("one", "two", "three"))
    return save(cube, tmp_path / "a.zarr")


def test_play_shows_each_picture_once(run, stack: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    cube = load(stack)
    for more in ((), ("--stops",)):
        assert run("play", stack, "-o", tmp_path / "a.npy", "--overwrite", *more).code == 0
        assert np.array_equal(np.load(tmp_path / "a.npy"), casting.play(cube))
    assert run("play", stack, "-o", tmp_path / "shown").code == 0
    assert len(list((tmp_path / "shown").glob("*.png"))) == 3
    done = run("play", stack, "-o", tmp_path / "a.mp4", "--json")
    assert "at each of 3 pictures the lamp fades in" in json.loads(done.out.splitlines()[-1])["how"]


@pytest.mark.parametrize("more", [("--even",), ("--from-deg", 0), ("--count", 3), ("--angles-deg", 90)])
def test_nothing_turns(run, stack: Path, tmp_path: Path, more: tuple[object, ...]) -> None:  # type: ignore[no-untyped-def]
    done = run("play", stack, "-o", tmp_path / "a.npy", *more)
    assert (done.code, done.out, len(done.err.splitlines())) == (2, "", 1)
    assert "is of films, and nothing turns" in done.err
    assert not (tmp_path / "a.npy").exists()


def test_pictures_are_told_by_lamps_and_moves(run, stack: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    told = ["under left, films as they are", "under right, films as they are", "under right, film 2 slid 5 mm right"]
    assert json.loads(run("info", stack, "--json").out)["shown"] == told
    scored = run("score", stack, "--sheet", tmp_path / "sheet.png")
    assert (scored.code, [name in scored.out for name in told]) == (0, [True] * 3)
    assert "angle" not in scored.out
    between = run("score", stack, "--between")
    assert (between.code, between.out) == (2, "")
    assert "nothing turns" in between.err


@pytest.mark.usefixtures("large_rooms")
def test_films_are_drawn_as_they_are_put_together_and_in_their_room(run, stack: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    assert run("draw", stack, "-o", tmp_path / "a.svg").code == 0
    said = (tmp_path / "a.svg").read_text()
    assert "stack of 3 films" in said
    assert not any(word in said for word in ("voxel", "turntable", "stop "))
    refused = run("draw", stack, "-o", tmp_path / "b.svg", "--angle-deg", 3)
    assert (refused.code, refused.out) == (2, "")
    assert run("draw", stack, "-o", tmp_path / "a.png").code == 0
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.size == (960, 540)
