"""Shells and points, which cast nothing, and the schedule of table and lamps, as other programs read them."""

import csv
import json
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import lightcube as lc
from lightcube.errors import InputError
from lightcube.fabrication import lamps, points
from lightcube.fabrication.schedule import schedule
from lightcube.forward.dimming import Course
from lightcube.io._stl import read_stl
from lightcube.optics.transfer import decode
from lightcube.solids.mesh import Mesh
from tests.helpers.made import a_cube


def clear_cube() -> lc.Cube:
    cube = a_cube((4, 5, 6))
    return replace(cube, extinction=0 * cube.extinction)


def test_shells_are_parts_of_one_object_and_every_triangle_has_a_colour(tmp_path: Path) -> None:
    pytest.importorskip("lib3mf", reason="lib3mf is of the extra readers")
    import lib3mf

    cube = a_cube()
    said = lc.export(cube, tmp_path / "a.3mf", "shell")
    model = lib3mf.get_wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromFile(str(tmp_path / "a.3mf"))
    assert model.GetUnit() == lib3mf.ModelUnit.MilliMeter
    assert model.GetBuildItems().Count() == 1
    assert model.GetComponentsObjects().Count() == 1
    objects = model.GetMeshObjects()
    volumes = []
    for part in said["shells"]:
        assert objects.MoveNext()
        mesh = objects.GetCurrentMeshObject()
        assert mesh.IsManifoldAndOriented()
        assert mesh.GetName() == part["part"]
        assert {each.ResourceID for each in mesh.GetAllTriangleProperties()} != {0}
        assert mesh.GetTriangleCount() == part["faces"]
        corners = np.array([vertex.Coordinates[:] for vertex in mesh.GetVertices()])
        faces = np.array([triangle.Indices[:] for triangle in mesh.GetTriangleIndices()])
        volumes.append(Mesh(corners.astype(float), faces.astype(np.int64)).volume_mm3)
    assert not objects.MoveNext()
    np.testing.assert_allclose(volumes, [part["volume_mm3"] for part in said["shells"]], rtol=1e-6)
    assert volumes == sorted(volumes, reverse=True)


def test_trimesh_reads_shells_and_an_stl_of_each_lies_beside_them(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh", reason="trimesh is of the extra readers")
    pytest.importorskip("networkx", reason="trimesh reads 3MF with networkx")
    pytest.importorskip("lxml", reason="trimesh reads 3MF with lxml")
    said = lc.export(a_cube(), tmp_path / "a.3mf", "shell", levels=2)
    assert sorted(said["files"]) == ["a-1.stl", "a-2.stl", "a.3mf"]
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a-1.stl", "a-2.stl", "a.3mf", "a.3mf.json"]
    scene = trimesh.load(tmp_path / "a.3mf")
    found = sorted(float(each.volume) for each in scene.geometry.values())
    np.testing.assert_allclose(found[::-1], [part["volume_mm3"] for part in said["shells"]], rtol=1e-5)
    for number, part in enumerate(said["shells"], 1):
        ((triangles,), _) = read_stl((tmp_path / f"a-{number}.stl").read_bytes())
        mesh = Mesh.of_triangles(triangles)
        assert mesh.is_watertight
        assert abs(mesh.volume_mm3 - part["volume_mm3"]) < 1e-4 * part["volume_mm3"]


def test_shells_hold_what_they_say_and_no_file_has_a_date(tmp_path: Path) -> None:
    cube = a_cube()
    for name in "ab":
        lc.export(cube, tmp_path / f"{name}.3mf", "shell")
    assert (tmp_path / "a.3mf").read_bytes() == (tmp_path / "b.3mf").read_bytes()
    assert zipfile.ZipFile(tmp_path / "a.3mf").testzip() is None
    holds = [part["holds"] for part in json.loads((tmp_path / "a.3mf.json").read_text())["shells"]]
    assert holds == sorted(holds, reverse=True)
    assert 0 < holds[-1] < holds[0] < 1


@pytest.mark.parametrize("kind", ["shell", "points"])
def test_a_ply_has_places_and_colours(tmp_path: Path, kind: str) -> None:
    plyfile = pytest.importorskip("plyfile", reason="plyfile is of the extra readers")
    cube = a_cube()
    said = lc.export(cube, tmp_path / "a.ply", kind)  # type: ignore[arg-type]
    read = plyfile.PlyData.read(tmp_path / "a.ply")
    vertices = read["vertex"]
    places = np.stack([vertices[axis] for axis in "xyz"], axis=1)
    half = np.array(cube.grid.size_mm[::-1]) / 2
    assert np.all(np.abs(places) <= half + 1e-5)
    assert len(places) > 100
    assert vertices["red"].dtype == np.uint8
    if kind == "points":
        assert any("decorative" in comment for comment in read.comments)
        assert abs(len(places) - said["about"]) < 0.1 * said["about"]
    else:
        assert len(read["face"]) == sum(part["faces"] for part in said["shells"])


def read_points(path: Path) -> NDArray[np.float32]:
    head, body = path.read_bytes().split(b"end_header\n", 1)
    count = int(head.split(b"element vertex ")[1].split()[0])
    corner = np.dtype([("place", "<f4", 3), ("colour", "u1", 3)])
    return np.frombuffer(body, corner, count)["place"]


@pytest.mark.parametrize("spacing_um", [100.0, 237.0])
def test_no_two_points_are_nearer_than_their_spacing_and_most_are_where_it_is_dark(
    tmp_path: Path, spacing_um: float
) -> None:
    from scipy.spatial import cKDTree

    cube = a_cube((9, 10, 12), 0.4)
    lc.export(cube, tmp_path / "a.ply", "points", spacing_um=spacing_um)
    places = read_points(tmp_path / "a.ply")
    nearest = np.asarray(cKDTree(places).query(places, k=2)[0])[:, 1]
    assert nearest.min() >= spacing_um / 1000 * (1 - 1e-5)
    voxels = np.floor(places / 0.4 + np.array([12, 10, 9]) / 2).astype(int)
    counts = np.zeros(cube.grid.shape)
    np.add.at(counts, tuple(voxels[:, ::-1].T), 1)
    assert np.corrcoef(counts.ravel(), points.luminance(cube).ravel())[0, 1] > 0.5


def test_ornaments_that_cannot_be_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cube = a_cube((4, 5, 6))
    for kind, name in (("shell", "a.3mf"), ("points", "a.ply")):
        with pytest.raises(InputError, match="the cube is clear all over"):
            lc.export(clear_cube(), tmp_path / name, kind)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="1 to 8 shells, not 9"):
        lc.export(cube, tmp_path / "a.3mf", "shell", levels=9)
    with pytest.raises(InputError, match="from 20 to 2000 micrometres apart, not 5"):
        lc.export(cube, tmp_path / "a.ply", "points", spacing_um=5.0)
    monkeypatch.setattr(points, "MOST", 100)
    with pytest.raises(InputError, match=r"are more than the 100 that a job takes: let them be at least \d+ micro"):
        lc.export(cube, tmp_path / "a.ply", "points")
    assert list(tmp_path.iterdir()) == []


def test_what_casts_nothing_says_so(tmp_path: Path) -> None:
    cube = a_cube((4, 5, 6))
    for kind, name, said in (
        ("shell", "a.3mf", "shells cast no picture"),
        ("shell", "b.ply", "shells cast no picture"),
        ("points", "c.ply", "points scatter light and cast no picture"),
        ("schedule", "d.csv", "a schedule casts no picture"),
    ):
        lc.export(cube, tmp_path / name, kind)  # type: ignore[arg-type]
        with pytest.raises(InputError, match=said):
            lc.read_export(tmp_path / name)


def test_a_schedule_turns_in_the_dark_as_the_movies_do(tmp_path: Path) -> None:
    cube = a_cube()
    said = lc.export(cube, tmp_path / "a.csv", "schedule")
    with (tmp_path / "a.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert json.loads((tmp_path / "a.csv.json").read_text())["rows"] == said["rows"]
    course = Course.of(3, 30.0)
    assert [float(row["angle_deg"]) for row in rows] == [10.0, 95.0, 222.0]
    assert [float(row["turn_deg"]) for row in rows] == [148.0, 85.0, 127.0]
    np.testing.assert_allclose([float(row["at_s"]) for row in rows], np.arange(3) * course.seconds, atol=1e-6)
    assert abs(said["round_s"] - 3 * course.seconds) < 1e-9
    for row, powers in zip(rows, cube.powers, strict=True):
        found = np.array([float(row[f"power_{colour}"]) for colour in ("red", "green", "blue")])
        np.testing.assert_allclose(found, powers, atol=1e-6)
        level = np.array([float(row[f"level_{colour}"]) for colour in ("red", "green", "blue")])
        np.testing.assert_allclose(level, powers / cube.powers.max(), atol=1e-6)
        ev = np.array([float(row[f"ev_{colour}"]) for colour in ("red", "green", "blue")])
        np.testing.assert_allclose(2**ev, level, atol=1e-5)
    fade = said["fade"]
    np.testing.assert_allclose(fade["light"], decode(np.array(fade["seconds"]) * 30 / course.fade))
    lc.export(cube, tmp_path / "b.json", "schedule")
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.csv", "a.csv.json", "b.json"]


def test_names_that_spreadsheets_would_reckon_with_are_text(tmp_path: Path) -> None:
    cube = replace(a_cube(), names=("=1+1", "@b", "c"))
    lc.export(cube, tmp_path / "a.csv", "schedule")
    assert [row.split(",")[4] for row in (tmp_path / "a.csv").read_text().splitlines()[1:]] == ["'=1+1", "'@b", "c"]


def test_the_white_lamp_is_the_best_one_that_does_not_change() -> None:
    cube = a_cube()
    targets = lc.Targets(
        np.stack(list(lc.cast(cube, lamp_powers=np.full_like(cube.powers, 0.37)))), cube.rig, transfer=cube.transfer
    )
    power, worth = lamps.white(cube, targets)
    assert abs(power - 0.37) < 1e-3
    assert worth > 60
    found = schedule(cube)["one_white_lamp"]
    assert found["psnr_mean"] < lc.score(cube)["psnr_mean"]


def test_lamps_that_were_changed_are_found_again() -> None:
    cube = a_cube()
    targets = lc.Targets(np.stack(list(lc.cast(cube))), cube.rig, transfer=cube.transfer)
    off = replace(cube, lamp_powers=cube.powers * np.random.default_rng(0).uniform(0.5, 2, cube.powers.shape))
    np.testing.assert_allclose(lamps.relit(off, targets).powers, cube.powers, rtol=1e-3)
