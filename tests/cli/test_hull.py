"""The command that carves hulls: three walls, a turntable and a stage in, meshes and shapes out."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from lightcube.io import read_shape
from lightcube.io.printable import read_written
from lightcube.solids.certificate import certify
from lightcube.solids.mesh import Mesh
from tests.cli.test_cli import run

__all__ = ["run"]

STAGE = """
[cube]
shape = [10, 10, 10]
size_mm = 50
turns = false

[[lamp]]
name = "near"
position_mm = [-200, 0, 0]

[[lamp]]
name = "far"
direction = [0, 1, 0]

[[screen]]
name = "wall"
centre_mm = [100, 0, 0]
size_mm = [100, 100]

[[screen]]
name = "side"
centre_mm = [0, 100, 0]
size_mm = [50, 50]

[[picture]]
file = "disc.png"
screen = "wall"
lamps = ["near"]

[[picture]]
file = "disc.png"
screen = "side"
lamps = ["far"]
"""


def polygon(path: Path, corners: list[tuple[int, int]], **how: Any) -> Path:
    """A picture of 40 x 40 pixels with a dark polygon on white, larger by `times`, of size `size`."""
    size, times = how.get("size", (40, 40)), 4
    image = Image.new("L", (size[0] * times, size[1] * times), 255)
    ImageDraw.Draw(image).polygon([(x * times, y * times) for x, y in corners], fill=0)
    image.resize(size, Image.Resampling.BOX).save(path)
    return path


@pytest.fixture
def three(tmp_path: Path) -> list[Path]:
    """A triangle, a square and an L, each elsewhere in its picture."""
    return [
        polygon(tmp_path / "front.png", [(5, 35), (35, 35), (20, 5)]),
        polygon(tmp_path / "side.png", [(8, 8), (38, 8), (38, 38), (8, 38)]),
        polygon(tmp_path / "top.png", [(3, 3), (33, 3), (33, 13), (13, 13), (13, 33), (3, 33)]),
    ]


def result(out: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(out.splitlines()[-1])
    assert found["event"] == "result"
    return found


@pytest.mark.parametrize("suffix", ["stl", "3mf", "obj", "ply"])
def test_three_pictures_become_a_mesh(run, tmp_path: Path, three: list[Path], suffix: str) -> None:  # type: ignore[no-untyped-def]
    out = tmp_path / f"a.{suffix}"
    done = run("hull", *three, "--walls", "-o", out, "--n", 24, "--size-mm", 60, "--json", "--repair", "none")
    assert done.code == 0, done.err
    found = result(done.out)
    mesh = read_written(out)
    assert mesh.is_watertight
    assert mesh.vertices_mm[:, 2].min() == 0
    assert mesh.size_mm == pytest.approx((60, 60, 60), abs=4)
    assert mesh.volume_mm3 == pytest.approx(found["volume_mm3"], rel=1e-6)
    assert found["beyond_max"] < 0.02
    assert (found["bad_edges"], found["pieces"]) == (0, 1)
    assert [each["by"] for each in found["pictures"]] == ["dark"] * 3


def test_what_it_says_of_the_file_is_true_of_the_file(run, tmp_path: Path, three: list[Path]) -> None:  # type: ignore[no-untyped-def]
    for name in ("a.stl", "a.shape.zarr"):
        done = run("hull", *three, "--walls", "-o", tmp_path / name, "--n", 20, "--json", "--repair", "none")
        found = result(done.out)
        shape = read_shape(tmp_path / "a.shape.zarr") if name.endswith("zarr") else None
        if shape is not None:
            assert found["overlap"] == certify(shape.mesh, shape.silhouettes).overlap.tolist()
            lifted = read_written(tmp_path / "a.stl").vertices_mm - shape.mesh.standing().vertices_mm[:, 2].min()
            low = shape.mesh.vertices_mm[:, 2].min()
            again = Mesh(lifted + np.array([0, 0, low]), read_written(tmp_path / "a.stl").faces)
            assert certify(again, shape.silhouettes).overlap == pytest.approx(found["overlap"], abs=1e-3)


def test_pictures_are_walls_by_their_names_or_else_in_order(run, tmp_path: Path, three: list[Path]) -> None:  # type: ignore[no-untyped-def]
    made = {}
    for name, given in (("named", three[::-1]), ("folder", [tmp_path / "folder"]), ("ordered", three)):
        if name == "folder":
            given[0].mkdir()
            for number, picture in enumerate(three):
                (given[0] / f"{number}.png").write_bytes(picture.read_bytes())
        out = tmp_path / f"{name}.stl"
        assert run("hull", *given, "--walls", "-o", out, "--n", 16, "--repair", "none").code == 0
        made[name] = out.read_bytes()
    assert made["named"] == made["folder"] == made["ordered"]


def test_a_turntables_pictures_become_a_shape_that_info_knows(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    folder = tmp_path / "views"
    folder.mkdir()
    for number in range(4):
        polygon(folder / f"{number}.png", [(10, 5), (30, 5), (30, 35), (10 + number, 35)])
    out = tmp_path / "a.shape.zarr"
    done = run("hull", folder, "-o", out, "--n", 20, "--elevation-deg", 0, "--angles-deg", "0,45,90,135")
    assert done.code == 0, done.err
    assert "4 shapes dark on light, threshold 0.5" in done.err
    assert "watertight" in done.out
    shape = read_shape(out)
    assert shape.rig.elevation_deg == 0
    assert shape.rig.stops.angle_deg.tolist() == [0, 45, 90, 135]
    told = run("info", out, "--json")
    known = json.loads(told.out)
    assert known["kind"] == "shape"
    assert known["faces"] == len(shape.mesh)
    assert known["made_with_command"] == "hull"
    assert "voxels" in run("info", out).out
    refused = run("solve", "gems", "--start-from", out, "-o", tmp_path / "b.npz")
    assert refused.code == 2


def test_a_stage_says_all_there_is(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    polygon(tmp_path / "disc.png", [(12, 8), (30, 10), (32, 28), (10, 30)])
    stage = tmp_path / "room.toml"
    stage.write_text(STAGE)
    done = run("hull", stage, "-o", tmp_path / "a.ply", "--json")
    assert done.code == 0, done.err
    assert result(done.out)["overlap_min"] > 0.8
    for options, said in (
        (["--n", 9], "--n is not for a stage"),
        (["--elevation-deg", 9], "--elevation-deg is not for a stage"),
        (["--walls"], "leave out --walls"),
        ([tmp_path / "disc.png"], "leave out other pictures"),
    ):
        refused = run("hull", stage, *options, "-o", tmp_path / "b.ply")
        assert (refused.code, len(refused.err.splitlines())) == (2, 1)
        assert said in refused.err


def test_doubtful_pictures_are_told_one_by_one(run, tmp_path: Path, three: list[Path]) -> None:  # type: ignore[no-untyped-def]
    polygon(three[0], [(0, 40), (0, 25), (15, 25), (15, 36), (8, 40)])
    polygon(three[1], [(10, 10), (70, 10), (70, 70), (10, 70)], size=(80, 80))
    picture = np.asarray(Image.open(three[1])).copy()
    picture[2, 2] = 0
    Image.fromarray(picture).save(three[1])
    polygon(three[2], [(10, 0), (12, 0), (12, 40), (10, 40)])
    done = run("hull", *three, "--walls", "-o", tmp_path / "a.stl", "--n", 10, "--dry-run")
    assert done.code == 0
    assert not (tmp_path / "a.stl").exists()
    assert "note: front: its shape touches the border of its picture" in done.err
    assert "note: side: 1 speck removed" in done.err
    assert "pictures are stretched by" in done.err
    inverted = run("hull", *three, "--walls", "-o", tmp_path / "a.stl", "--n", 10, "--dry-run", "--invert")
    assert "so it may be the ground" in inverted.err


def test_strokes_that_are_too_thin_and_heights_that_others_leave_empty_are_told(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    folder = tmp_path / "views"
    folder.mkdir()
    polygon(folder / "high.png", [(15, 3), (25, 3), (25, 37), (15, 37)])
    polygon(folder / "low.png", [(15, 20), (25, 20), (25, 37), (15, 37)])
    polygon(folder / "thin.png", [(19, 3), (21, 3), (21, 37), (19, 37)])
    done = run("hull", folder, "-o", tmp_path / "a.stl", "--n", 20, "--elevation-deg", 0, "--dry-run")
    assert "note: low: it is empty over 50% of the height that others fill" in done.err
    assert "note: thin: 100% of its shape is thinner than two voxels" in done.err
    assert "note: high" not in done.err


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--threshold", 2], "a threshold between shape and ground lies between 0 and 1, not 2"),
        (["--angles-deg", "1,2,3"], "--angles-deg is for a turntable"),
        (["--every", 2], "--most, --every, --from and --to are for one film"),
        (["--n", 2000], "GB of memory"),
        (["--n", 0], "--n 0: a cube needs at least 1 voxel a side"),
    ],
)
def test_what_cannot_be_is_one_sentence(run, tmp_path: Path, three: list[Path], options: list[Any], said: str) -> None:  # type: ignore[no-untyped-def]
    done = run("hull", *three, "--walls", "-o", tmp_path / "a.stl", *options)
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert said in done.err
    assert not (tmp_path / "a.stl").exists()


def test_two_pictures_are_no_three_walls_and_one_grey_no_shape(run, tmp_path: Path, three: list[Path]) -> None:  # type: ignore[no-untyped-def]
    done = run("hull", *three[:2], "--walls", "-o", tmp_path / "a.stl")
    assert (done.code, "front, side and top, not 2" in done.err) == (2, True)
    Image.new("L", (9, 9), 128).save(three[1])
    done = run("hull", *three, "--walls", "-o", tmp_path / "a.stl")
    assert (done.code, "picture side is of one grey" in done.err) == (2, True)
    done = run("hull", *three, "--walls", "-o", tmp_path / "a.glb")
    assert (done.code, "has no suffix that a shape can have" in done.err) == (2, True)


def test_one_picture_makes_no_solid_and_it_is_said_what_does(run, tmp_path: Path, three: list[Path]) -> None:  # type: ignore[no-untyped-def]
    for asked in (("hull", three[0], "-o", tmp_path / "a.stl"), ("check", three[0], "--opaque")):
        done = run(*asked)
        assert (done.code, len(done.lines)) == (2, 1)
        assert "holds one picture, and a solid needs two at least" in done.err
        assert "cube" not in done.err.replace("lightcube", "").replace(str(tmp_path), "")
        assert not (tmp_path / "a.stl").exists()


def test_transparent_pictures_are_cut_by_their_opacity(run, tmp_path: Path, three: list[Path]) -> None:  # type: ignore[no-untyped-def]
    for path in three:
        grey = np.asarray(Image.open(path))
        layers: NDArray[np.uint8] = np.dstack([np.full((*grey.shape, 3), 77, np.uint8), 255 - grey])
        Image.fromarray(layers).save(path)
    done = run("hull", *three, "--walls", "-o", tmp_path / "a.stl", "--n", 12)
    assert done.code == 0
    assert "3 shapes cut by their transparency" in done.err
    assert "white" not in done.err
