"""What `hull` makes of pictures that contradict each other, what it takes out, and what it says."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from lightcube.io import read_shape
from tests.cli.test_cli import run
from tests.solids.test_warp import BARS

__all__ = ["run"]


@pytest.fixture
def word(tmp_path: Path) -> list[Path]:
    """H, U and T, 40 pixels wide."""
    paths = []
    for name, letter in zip(("front", "side", "top"), "HUT", strict=True):
        levels = np.full((50, 50), 255, np.uint8)
        for top, bottom, left, right in BARS[letter]:
            levels[5 + 4 * top : 5 + 4 * bottom, 5 + 4 * left : 5 + 4 * right] = 0
        paths.append(tmp_path / f"{name}.png")
        Image.fromarray(levels).save(paths[-1])
    return paths


def told(out: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(out.splitlines()[-1])
    return found


def test_a_word_that_contradicts_itself_is_bent(run: Any, word: list[Path], tmp_path: Path) -> None:
    drawn = tmp_path / "over" / "bent.png"
    drawn.parent.mkdir()
    done = run("hull", *word, "--walls", "--n", 32, "-o", tmp_path / "word.stl", "--overlay", drawn)
    assert done.code == 0
    assert "until one object casts them" in done.out
    assert "watertight, 1 piece" in done.out
    assert "--placement best may ask for less" in done.out
    placed = run("hull", *word, "--walls", "--n", 24, "--placement", "best", "-o", tmp_path / "b.stl")
    assert "may ask for less" not in placed.out
    assert "placed as front = side, side = top" in placed.err
    levels = np.asarray(Image.open(drawn).convert("RGB")).astype(int)
    for colour in ((52, 55, 60), (236, 120, 70), (104, 160, 214)):  # both, given only, cast only
        assert np.mean(np.abs(levels - colour).max(axis=2) < 3) > 0.003


@pytest.mark.parametrize("way", ["none", "trim", "grow", "warp"])
def test_the_way_can_be_chosen(run: Any, word: list[Path], tmp_path: Path, way: str) -> None:
    done = run("hull", *word, "--walls", "--n", 20, "-o", tmp_path / "a.shape.zarr", "--repair", way, "--json")
    assert done.code == 0
    said = told(done.out)
    assert said["repair"]["way"] == way
    assert (said["overlap_min"] > 0.95) is (way != "none")
    assert read_shape(tmp_path / "a.shape.zarr").provenance["repair"]["way"] == way
    assert np.all(np.array(said["repair"]["overlap"]) <= 1)


@pytest.mark.parametrize("carving", ["shell", "lace"])
def test_material_is_taken_out(run: Any, word: list[Path], tmp_path: Path, carving: str) -> None:
    volumes = []
    for more in ((), ("--carve", carving, "--keep-deep", 1, "--wall", 2)):
        made = ("-o", tmp_path / "a.ply", "--repair", "trim", "--overwrite", "--json")
        done = run("hull", *word, "--walls", "--n", 32, *made, *more)
        assert done.code == 0
        volumes.append(told(done.out)["volume_mm3"])
        assert told(done.out)["bad_edges"] == 0
    assert volumes[1] < 0.8 * volumes[0]


def test_a_picture_is_kept(run: Any, word: list[Path], tmp_path: Path) -> None:
    overlaps = []
    for more in ((), ("--keep", "front")):
        args = ("hull", *word, "--walls", "--n", 20, "-o", tmp_path / "a.stl", "--overwrite", "--json", "--wall", 0)
        overlaps.append(told(run(*args, *more).out)["repair"]["overlap"][0])
    assert overlaps[1] > overlaps[0]
    assert overlaps[1] > 0.9


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("--keep", "back"), "--keep back: there is no such picture: name one of front, side, top"),
        (("--wall", "-1"), "--wall is how thick walls are, 0 mm or more, not -1"),
        (("--carve", "holes"), "holes"),
        (("--keep-deep", "0"), "keep-deep"),
        (("--carve", "shell", "--drain", "-2"), "a drain 0 mm or more"),
        (("--repair", "mend"), "mend"),
    ],
)
def test_what_cannot_be_is_one_sentence(
    run: Any, word: list[Path], tmp_path: Path, given: tuple[str, ...], said: str
) -> None:
    done = run("hull", *word, "--walls", "--n", 16, "-o", tmp_path / "a.stl", *given)
    assert done.code == 2
    assert said in done.err
    assert not (tmp_path / "a.stl").exists()


def test_many_pictures_are_told_to_be_too_many(run: Any, word: list[Path], tmp_path: Path) -> None:
    six = [*word, *word]
    done = run("hull", *six, "--n", 20, "--elevation-deg", 0, "--span-deg", 300, "-o", tmp_path / "a.stl")
    assert done.code == 0
    assert "coloured glass, which holds many more (lightcube solve)" in done.out


def test_a_bent_word_has_room(run: Any, word: list[Path], tmp_path: Path) -> None:
    """What is bent beyond its box is not cut off: nothing touches the walls' edges."""
    assert run("hull", *word, "--walls", "--n", 32, "-o", tmp_path / "a.shape.zarr").code == 0
    shape = read_shape(tmp_path / "a.shape.zarr")
    for inside in shape.silhouettes.inside:
        edges = np.concatenate([inside[0], inside[-1], inside[:, 0], inside[:, -1]])
        assert not edges.any()
    assert max(shape.mesh.size_mm) == pytest.approx(100, rel=0.15)


def test_all_that_takes_cubes_takes_shapes(run: Any, word: list[Path], tmp_path: Path) -> None:
    shape = tmp_path / "word.shape.zarr"
    assert run("hull", *word, "--walls", "--n", 16, "-o", shape).code == 0
    scored = run("score", shape, "--json")
    assert scored.code == 0
    assert json.loads(scored.out)["overlap_min"] > 0.97
    assert "watertight" in run("score", shape).out
    assert run("play", shape, "-o", tmp_path / "shadows").code == 0
    assert len(list((tmp_path / "shadows").glob("*.png"))) == 1
    assert run("view", shape, "-o", tmp_path / "word.html").code == 0
    text = (tmp_path / "word.html").read_text(encoding="utf-8")
    assert "A solid stands in the light, and its shadows are pictures: front, side, top." in text
    done = run("score", shape, "--robust")
    assert done.code == 2
    assert "is a shape, and --robust is for cubes: leave it out" in done.err
