"""A mesh by itself beside silhouettes: wherever it lies, however large, and in a mirror."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from lightcube.io import read_solid, save
from lightcube.optics.arrays import locked
from lightcube.solids.mesh import Mesh
from lightcube.verbs.meshes import bodies
from tests.cli.test_cli import run
from tests.solids.test_carving import ball
from tests.solids.test_printing import box

__all__ = ["run"]


@pytest.fixture
def word(tmp_path: Path) -> tuple[Path, list[Path]]:
    """An F, an L and a T, none its own mirror image, and what hull makes of them."""
    bars = {
        "front": ((0, 40, 0, 14), (0, 12, 0, 40), (18, 28, 0, 30)),
        "side": ((0, 40, 0, 14), (28, 40, 0, 40)),
        "top": ((0, 40, 0, 40),),
    }
    paths = []
    for name, parts in bars.items():
        levels = np.full((50, 50), 255, np.uint8)
        for top, bottom, left, right in parts:
            levels[5 + top : 5 + bottom, 5 + left : 5 + right] = 0
        paths.append(tmp_path / f"{name}.png")
        Image.fromarray(levels).save(paths[-1])
    return tmp_path / "word", paths


def moved(mesh: Mesh, scale: float, way: tuple[float, float, float], mirrored: int = 1) -> Mesh:
    corners = scale * mesh.vertices_mm * (mirrored, 1, 1) + way
    return Mesh(locked(corners), locked(mesh.faces[:, ::mirrored].copy()))


def told(done: Any) -> dict[str, Any]:
    assert done.code == 0, done.err
    found: dict[str, Any] = json.loads(done.out)
    return found


@pytest.mark.parametrize("suffix", ["stl", "3mf", "obj", "ply"])
def test_a_mesh_is_scored_as_its_shape_is(run: Any, word: tuple[Path, list[Path]], suffix: str) -> None:
    name, pictures = word
    shape, mesh = f"{name}.shape.zarr", f"{name}.{suffix}"
    made = ("--walls", "--repair", "none", "--n", 32, "--base", "none")
    assert run("hull", *pictures, *made, "-o", mesh, "-o", shape).code == 0
    kept, found = told(run("score", shape, "--json")), told(run("score", mesh, shape, "--json"))
    assert found["overlap"] == pytest.approx(kept["overlap"], abs=0.002)
    assert (found["scaled"], found["mirrored"], found["watertight"], found["pieces"]) == (1, False, True, 1)
    assert found["names"] == ["front", "side", "top"]
    given = told(run("score", mesh, *pictures, "--walls", "--json"))
    assert given["overlap_mean"] == pytest.approx(found["overlap_mean"], abs=0.02)
    assert given["scaled"] == pytest.approx(1, abs=0.03)


def test_wherever_a_mesh_lies_and_in_a_mirror(run: Any, word: tuple[Path, list[Path]]) -> None:
    name, pictures = word
    shape = f"{name}.shape.zarr"
    made = ("--walls", "--repair", "none", "--n", 32, "--base", "none")
    assert run("hull", *pictures, *made, "-o", f"{name}.stl", "-o", shape).code == 0
    mesh, best = read_solid(f"{name}.stl"), told(run("score", f"{name}.stl", shape, "--json"))
    inches = save(moved(mesh, 1 / 25.4, (3.0, -7.0, 1.0)), f"{name}-in.stl")
    found = told(run("score", inches, shape, "--json"))
    assert found["scaled"] == pytest.approx(25.4, rel=1e-3)
    assert found["overlap_mean"] == pytest.approx(best["overlap_mean"], abs=0.01)
    assert "it is moved, and scaled by 25.4, to where it fits the silhouettes best" in run("score", inches, shape).out
    other = save(moved(mesh, 1.0, (0.0, 0.0, 0.0), -1), f"{name}-mirrored.stl")
    found = told(run("score", other, shape, "--json"))
    assert found["mirrored"]
    assert found["overlap_mean"] < 0.9
    assert found["mirrored_overlap_mean"] == pytest.approx(best["overlap_mean"], abs=1e-6)
    said = run("score", other, shape).out
    assert "it is a mirrored copy, and its mirror image overlaps by" in said
    assert "front: overlap " in said


def test_pieces_are_bodies_and_not_cavities() -> None:
    one, far = ball(5.0, (0.0, 0.0, 0.0)), moved(box(2.0, 3.0, 4.0), 1.0, (20.0, 0.0, 0.0))
    hole = ball(2.0, (0.0, 0.0, 0.0))
    corners = np.concatenate([one.vertices_mm, far.vertices_mm, hole.vertices_mm])
    first, second = len(one.vertices_mm), len(one.vertices_mm) + len(far.vertices_mm)
    faces = np.concatenate([one.faces, far.faces + first, hole.faces[:, ::-1] + second])
    assert bodies(Mesh(locked(corners), locked(faces))) == 2
    assert bodies(one) == 1


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("a.stl",), "a.stl is a mesh and keeps no pictures: give them after it"),
        (("a.stl", "p.png", "--robust"), "a.stl is a mesh, and --robust is for cubes: leave it out"),
        (("b.stl", "front.png", "side.png", "top.png", "--walls"), "there is no file"),
        (("a.stl", "front.png", "side.png", "--walls"), "three walls take three pictures"),
        (("a.stl", "front.png", "side.png", "top.png", "--walls", "--angles-deg", "1,2,3"), "is for a turntable"),
        (("cube.zarr", "--walls"), "cube.zarr knows how its pictures were cut out"),
        (("cube.zarr", "a", "b"), "which takes pictures one by one of meshes only"),
    ],
)
def test_what_cannot_be_is_one_sentence(
    run: Any, word: tuple[Path, list[Path]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: Any, said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    save(ball(3.0, (0.0, 0.0, 0.0)), "a.stl")
    done = run("score", *given)
    assert (done.code, len(done.err.strip().splitlines())) == (2, 1)
    assert said in done.err
