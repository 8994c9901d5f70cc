"""Whether silhouettes can be built, on the command line: sentences, exit codes, maps, JSON, and what is refused."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from lightcube.drawing.blame import COLOURS
from tests.cli.test_cli import run
from tests.solids.test_reach import letters

__all__ = ["run"]


def written(folder: Path, word: str) -> list[Path]:
    """Letters as pictures with some paper around."""
    paths = []
    for number, letter in enumerate(word):
        dark = np.pad(letters()[letter], 6)
        paths.append(folder / f"{number}{letter}.png")
        Image.fromarray(np.where(dark, 0, 255).astype(np.uint8)).save(paths[-1])
    return paths


def bars(folder: Path, *corners: tuple[int, int, int, int]) -> list[Path]:
    """Rectangles (left, top, right, bottom) in pictures of 40 x 40 pixels."""
    paths = []
    for number, (left, top, right, bottom) in enumerate(corners):
        picture = np.full((40, 40), 255, np.uint8)
        picture[top:bottom, left:right] = 0
        paths.append(folder / f"{number}.png")
        Image.fromarray(picture).save(paths[-1])
    return paths


def test_what_can_be_built_is_said_and_is_exit_code_0(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("check", *bars(tmp_path, *[(5, 5, 35, 35)] * 3), "--opaque", "--walls", "--n", 16)
    assert done.code == 0, done.err
    assert "0: all of it can be cast" in done.out
    assert "one piece casts all that can be cast" in done.out
    assert "the given one is the best" in done.out
    assert "this can be built as it is" in done.out


def test_a_word_that_must_give_way_is_exit_code_3_with_maps_and_a_better_placement(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    word, maps = written(tmp_path, "HUT"), tmp_path / "maps"
    done = run("check", *word, "--opaque", "--walls", "--n", 32, "--map", maps)
    assert done.code == 3, done.err
    assert "1U: 6" in done.out  # per cent
    assert "in the way: 0H (" in done.out
    assert "of which none casts all; one would if all silhouettes grew by" in done.out
    assert "best of 24 placements: front = " in done.out
    pictures = [np.asarray(Image.open(path).convert("RGB")) for path in sorted(maps.glob("*.png"))]
    assert len(pictures) == 3
    lost = float(np.mean((pictures[1][..., 0] > 200) & (pictures[1][..., 2] < 160)))
    assert 0.2 < lost < 0.5  # of the U's picture, in the H's red
    assert COLOURS[0][0] == "red"
    told = json.loads(run("check", *word, "--opaque", "--walls", "--n", 32, "--json").out)
    assert told["verdict"] == "repairable"
    assert told["reach"][1]["in_the_way"][0]["name"] == "0H"
    assert told["reach"][1]["unreachable"] > 0.5
    assert len(told["placements"]) == 24
    better = run("hull", *word, "--walls", "--placement", "best", "-o", tmp_path / "a.stl", "--n", 32, "--json")
    assert json.loads(better.out.splitlines()[-1])["overlap_min"] > 0.97


def test_what_is_beyond_repair_is_exit_code_4(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    folder = tmp_path / "views"
    folder.mkdir()
    bars(folder, (2, 5, 12, 35), (28, 5, 38, 35), (15, 5, 25, 35), (2, 5, 12, 35))
    done = run("check", folder, "--opaque", "--elevation-deg", 0, "--n", 20)
    assert done.code == 4, done.err
    assert "this is beyond repair" in done.out
    assert "placements" not in done.out


def test_a_word_that_another_placement_saves_is_told_that(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run("check", *written(tmp_path, "ALT"), "--opaque", "--walls", "--n", 32)
    assert done.code == 4, done.err
    assert "contradict each other too much: place them as above" in done.out
    assert "beyond repair" not in done.out


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--opaque", "--walls", "--sheet", "a.png"], "--sheet and --paper are for cubes of glass"),
        (["--walls"], "say --opaque too"),
        (["--map", "maps"], "say --opaque too"),
        (["--threshold", 0.5], "say --opaque too"),
        ([], "more than one place is for opaque objects"),
        (["--opaque", "--walls", "--angles-deg", "1,2,3"], "--angles-deg is for a turntable"),
    ],
)
def test_what_cannot_be_is_one_sentence(run, tmp_path: Path, options: list[Any], said: str) -> None:  # type: ignore[no-untyped-def]
    done = run("check", *bars(tmp_path, *[(5, 5, 35, 35)] * 3), *options)
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert said in done.err


def test_placements_are_of_walls(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    three = bars(tmp_path, *[(5, 5, 35, 35)] * 3)
    done = run("hull", *three, "--placement", "best", "-o", tmp_path / "a.stl")
    assert (done.code, "--placement is for three walls" in done.err) == (2, True)


def test_pictures_along_the_same_lines_are_told(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    two = bars(tmp_path, (5, 5, 20, 35), (5, 5, 20, 35))
    level = ("--opaque", "--elevation-deg", 0, "--n", 20)
    done = run("check", *two, *level, "--angles-deg", "10,190")
    assert "note: 0 and 1 are seen from opposite sides, and must be mirror images, but share" in done.err
    assert "note: all pictures are seen along one line, and none says how deep the object is" in done.err
    done = run("check", *two, *level, "--angles-deg", "10,100")
    assert "are seen" not in done.err
