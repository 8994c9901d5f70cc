"""Meshes that other programs wrote, in all formats, units and orders of bytes, are read as what they are."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from lightcube.errors import InputError
from lightcube.io import is_mesh, read_solid, save
from lightcube.io.printable import WRITERS
from lightcube.solids.mesh import Mesh
from tests.solids.test_carving import ball

MODEL = """<?xml version="1.0" encoding="UTF-8"?>
<model unit="{unit}" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>
<object id="7"><mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object>
<object id="8"><components><component objectid="{inner}" transform="0 1 0 -1 0 0 0 0 1 5 0 0"/></components></object>
</resources><build><item objectid="8" transform="2 0 0 0 2 0 0 0 2 0 0 1"/></build></model>"""


def same(read: Mesh, mesh: Mesh, atol: float = 1e-5) -> None:
    assert len(read) == len(mesh)
    assert read.is_watertight
    assert read.volume_mm3 == pytest.approx(mesh.volume_mm3, rel=1e-5)
    for one, other in ((read.vertices_mm.min(axis=0), mesh.vertices_mm.min(axis=0)), (read.size_mm, mesh.size_mm)):
        np.testing.assert_allclose(one, other, atol=atol)


@pytest.mark.parametrize("suffix", WRITERS)
def test_what_was_written_is_read(tmp_path: Path, suffix: str) -> None:
    mesh = ball(3.0, (1.0, 2.0, 3.0))
    assert is_mesh(tmp_path / f"a{suffix.upper()}")
    same(read_solid(save(mesh, tmp_path / f"a{suffix}")), mesh)


def test_what_is_inside_out_is_turned(tmp_path: Path) -> None:
    mesh = ball(3.0, (1.0, 2.0, 3.0))
    turned = Mesh(mesh.vertices_mm, np.ascontiguousarray(mesh.faces[:, ::-1]))
    assert turned.volume_mm3 < 0
    same(read_solid(save(turned, tmp_path / "a.ply")), mesh)


@pytest.mark.parametrize("encoding", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_ply_of_any_order_with_more_in_it(tmp_path: Path, encoding: str) -> None:
    """Vertices of doubles with colours, triangles and four-sided faces, and an element that nobody asked for."""
    corners = [(x, y, z) for x in (0.0, 2.0) for y in (0.0, 3.0) for z in (0.0, 4.0)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6)]
    faces: list[tuple[int, ...]] = [*quads[:2], (0, 2, 6), (0, 6, 4), *quads[2:], (1, 5, 7), (1, 7, 3)]
    head = (
        f"ply\nformat {encoding} 1.0\ncomment a box\nelement vertex 8\nproperty double x\nproperty double y\n"
        "property uchar red\nproperty double z\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_index\nend_header\n"
    )
    if encoding == "ascii":
        lines = [f"{x} {y} 200 {z}" for x, y, z in corners]
        lines += ["0 1", *(" ".join(map(str, (len(face), *face))) for face in faces)]
        body = "\n".join(lines).encode()
    else:
        order = "<" if "little" in encoding else ">"
        kind = [(name, f"{order}{number}") for name, number in (("x", "f8"), ("y", "f8"), ("red", "u1"), ("z", "f8"))]
        body = np.array([(x, y, 200, z) for x, y, z in corners], kind).tobytes()
        body += np.array([0, 1], f"{order}i4").tobytes()
        body += b"".join(bytes([len(face)]) + np.array(face, f"{order}i4").tobytes() for face in faces)
    (tmp_path / "a.ply").write_bytes(head.encode() + body)
    read = read_solid(tmp_path / "a.ply")
    assert read.size_mm == (2.0, 3.0, 4.0)
    assert len(read) == 12
    assert read.is_watertight
    assert read.volume_mm3 == pytest.approx(24)
    for cut in (len(head) + 20, len(head) + len(body) - 5):
        (tmp_path / "b.ply").write_bytes((head.encode() + body)[:cut])
        with pytest.raises(InputError, match=r"b\.ply cannot be read as a mesh"):
            read_solid(tmp_path / "b.ply")


def threemf(path: Path, unit: str = "millimeter", inner: str = "7", corner: str = "") -> Mesh:
    """A ball in an object that another one turns by a quarter and moves, twice as large by the build."""
    mesh = ball(3.0, (1.0, 2.0, 3.0))
    vertices = "".join(f'<vertex z="{z!r}" x="{x!r}" y="{y!r}"/>' for x, y, z in mesh.vertices_mm.tolist())
    triangles = "".join(f'<triangle v3="{corner or c}" v1="{a}" v2="{b}"/>' for a, b, c in mesh.faces.tolist())
    with zipfile.ZipFile(path, "w") as archive:
        text = MODEL.format(unit=unit, vertices=vertices, triangles=triangles, inner=inner)
        archive.writestr("3D/3dmodel.model", text)
    return mesh


@pytest.mark.parametrize(("unit", "mm"), [("millimeter", 1.0), ("inch", 25.4), ("micron", 0.001)])
def test_3mf_is_placed_as_its_build_says(tmp_path: Path, unit: str, mm: float) -> None:
    mesh = threemf(tmp_path / "a.3mf", unit)
    x, y, z = mesh.vertices_mm.T
    placed = np.stack([2 * (5 - y), 2 * x, 2 * z + 1], axis=1) * mm
    same(read_solid(tmp_path / "a.3mf"), Mesh(placed, mesh.faces), 1e-4 * mm)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"unit": "ell"}, "its model names 'ell'"),
        ({"inner": "9"}, "its model names '9'"),
        ({"inner": "8"}, "its model names itself"),
        ({"corner": "77"}, "a triangle names a vertex that is not among its 12"),
        ({"corner": "x"}, "cannot be read as a mesh"),
    ],
)
def test_3mf_that_makes_no_sense_is_one_sentence(tmp_path: Path, how: dict[str, str], said: str) -> None:
    threemf(tmp_path / "a.3mf", **how)
    with pytest.raises(InputError, match=said):
        read_solid(tmp_path / "a.3mf")
    with pytest.raises(InputError, match="there is no file"):
        read_solid(tmp_path / "b.3mf")
    (tmp_path / "c.3mf").write_bytes(b"PK\3\4 no archive")
    with pytest.raises(InputError, match=r"c\.3mf cannot be read as a mesh"):
        read_solid(tmp_path / "c.3mf")
