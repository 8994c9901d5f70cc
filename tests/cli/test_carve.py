"""The command `carve`: brushes, rays, giving back, what it says, and what it refuses."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube.io import read_shape, save
from lightcube.io._stl import write_stl
from lightcube.optics.arrays import locked
from lightcube.solids.mesh import Mesh
from lightcube.solids.shape import Shape
from tests.cli.test_cli import run
from tests.solids.test_carving import ball, block, pieces, same_shadows

__all__ = ["run"]


@pytest.fixture
def whole(tmp_path: Path) -> Path:
    return save(block(), tmp_path / "whole.shape.zarr")


def told(out: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(out.splitlines()[-1])
    assert found["event"] == "result"
    return found


def taken(before: Path, after: Path) -> tuple[Shape, Shape, Any]:
    one, other = read_shape(before), read_shape(after)
    return one, other, one.inside & ~other.inside


def test_a_lace_under_a_brush_and_back_again(run: Any, whole: Path, tmp_path: Path) -> None:
    brush = np.zeros(read_shape(whole).grid.shape, np.float32)
    brush[:, :9] = 0.5
    np.save(tmp_path / "brush.npy", brush)
    less, mesh = tmp_path / "less.shape.zarr", tmp_path / "less.stl"
    args = ("--carve", "lace", "--keep-deep", 1, "--where", tmp_path / "brush.npy")
    done = run("carve", whole, "-o", less, "-o", mesh, *args, "--json")
    assert done.code == 0
    said = told(done.out)
    one, other, gone = taken(whole, less)
    assert said["voxels_taken"] == gone.sum() > 0
    assert not np.any(gone & ~(brush != 0))
    assert same_shadows(one, other)
    assert said["pieces"] == pieces(other.inside) == 1
    assert said["bad_edges"] == 0
    assert said["overlap_with_before_min"] > 0.95
    assert said["brush"] == np.count_nonzero(one.inside & (brush != 0))
    assert mesh.exists()
    back = run("carve", less, "-o", tmp_path / "back.shape.zarr", "--undo-to", "hull")
    assert back.code == 0
    assert np.array_equal(read_shape(tmp_path / "back.shape.zarr").inside, one.inside)
    assert "1 piece, watertight; shadows of the file overlap those of before by" in back.out


def test_a_mesh_is_a_brush_where_it_lies_over_the_mesh_file(run: Any, whole: Path, tmp_path: Path) -> None:
    """The block stands on z = 0, 15 mm high: a ball around a corner of its top."""
    save(ball(7.0, (10.0, 8.0, 15.0)), tmp_path / "ball.3mf")
    made = tmp_path / "made.shape.zarr"
    done = run("carve", whole, "-o", made, "--carve", "lace", "--keep-deep", 1, "--where", tmp_path / "ball.3mf")
    assert done.code == 0
    places = np.argwhere(taken(whole, made)[2])
    assert len(places) > 5
    middles = (places - (np.array(read_shape(whole).grid.shape) - 1) / 2) * 1.5
    z, y, x = middles.T
    assert np.all(np.linalg.norm([x - 10, y - 8, z + 7.5 - 15], axis=0) < 7)
    save(ball(3.0, (100.0, 0.0, 0.0)), tmp_path / "far.stl")
    far = run("carve", whole, "-o", tmp_path / "far.ply", "--carve", "lace", "--where", tmp_path / "far.stl")
    assert far.code == 0
    assert "nothing of the shape is under the brush: lay it over the shape, which stands on z = 0" in far.out


def test_a_ray_is_named_by_its_picture(run: Any, whole: Path, tmp_path: Path) -> None:
    made = []
    for name in ("S", "2"):
        out = tmp_path / f"{name}.shape.zarr"
        assert run("carve", whole, "-o", out, "--ray", f"{name},5,7", "--keep-deep", 2).code == 0
        made.append(taken(whole, out)[2])
    assert np.array_equal(*made)
    assert made[0].sum() == 18 - 2  # all of a row along x but two


def test_a_dry_run_writes_nothing(run: Any, whole: Path, tmp_path: Path) -> None:
    done = run("carve", whole, "-o", tmp_path / "a.stl", "--carve", "shell", "--wall", 3, "--dry-run")
    assert done.code == 0
    assert "nothing is written: this was a dry run" in done.out
    assert not (tmp_path / "a.stl").exists()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ((), "nothing is to be taken out: say shell or lace"),
        (("--ray", "F,5"), "--ray F,5: give a picture, a row and a column from 0, such as F,12,34"),
        (("--ray", "X,5,6"), "--ray X,5,6: there is no picture X: name one of F, S, T, or 1 to 3"),
        (("--ray", "F,5,99999"), "picture F has 14 x 22 pixels, counted from 0, and none in row 5, column 99999"),
        (("--carve", "lace", "--where", "none.npy"), "there is no file none.npy"),
        (("--carve", "lace", "--where", "small.npy"), "a brush has shape (2, 3, 4), not (14, 18, 22)"),
        (("--carve", "lace", "--where", "flat.npy"), "flat.npy holds no block of numbers (z, y, x)"),
        (("--carve", "lace", "--where", "nan.npy"), "nan.npy holds NaN"),
        (("--carve", "lace", "--where", "text.npy"), "text.npy cannot be read"),
        (("--carve", "lace", "--where", "open.stl"), "--where open.stl: a mesh with 3 open or doubled edges"),
        (("--carve", "lace", "--where", "brush.gif"), "brush.gif is no mesh"),
        (("--carve", "shell", "--wall", "1e308"), "a wall is thicker than 0 mm"),
        (("--undo-to", "yesterday"), "yesterday"),
    ],
)
def test_what_cannot_be_is_one_sentence(
    run: Any, whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: tuple[str, ...], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    np.save("small.npy", np.ones((2, 3, 4)))
    np.save("flat.npy", np.ones((2, 3)))
    np.save("nan.npy", np.full((14, 18, 22), np.nan))
    Path("text.npy").write_text("no numbers")
    whole_ball = ball(3.0, (0.0, 0.0, 5.0))
    Path("open.stl").write_bytes(write_stl(Mesh(whole_ball.vertices_mm, locked(whole_ball.faces[1:].copy()))))
    done = run("carve", whole, "-o", tmp_path / "a.stl", *given)
    assert done.code == 2
    assert said in done.err
    assert len(done.err.strip().splitlines()) == 1
    assert not (tmp_path / "a.stl").exists()
