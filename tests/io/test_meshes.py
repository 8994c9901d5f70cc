"""Mesh files: what is read is what the file says, by volume, surface and closedness, or one sentence."""

import struct
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.io.meshes import read_mesh
from lightcube.scene.meshes import DoubtfulMesh, is_closed, tidy, volume

Array = NDArray[np.float64]

#: Floor of a room of three squares.
ELL = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
BOX = [(0, 0), (1, 0), (1, 1), (0, 1)]


def prism(outline: Sequence[tuple[float, float]], spin: Array | None = None, *, backwards: bool = False) -> str:
    """An OBJ of an outline, counter-clockwise, raised by 1: two faces of all its corners, and walls."""
    count = len(outline)
    corners = np.array([(x, y, z) for z in (0, 1) for x, y in outline], float) @ (np.eye(3) if spin is None else spin)
    faces = [list(range(count))[::-1], list(range(count, 2 * count))]
    faces += [[i, (i + 1) % count, (i + 1) % count + count, i + count] for i in range(count)]
    shift = -2 * count if backwards else 1
    lines = ["v {} {} {}".format(*corner) for corner in corners]
    return "\n".join([*lines, *("f " + " ".join(str(i + shift) for i in face) for face in faces), ""])


def facets(triangles: Array) -> str:
    """The same as a text STL."""
    lines = ["solid a"]
    for triangle in triangles:
        corners = ["vertex {} {} {}".format(*corner) for corner in triangle]
        lines += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
    return "\n".join([*lines, "endsolid a", ""])


def binary(triangles: Array, header: bytes = b"", behind: bytes = b"") -> bytes:
    rows = b"".join(struct.pack("<12fH", 0, 0, 0, *triangle.reshape(-1), 0) for triangle in triangles)
    return header.ljust(80) + struct.pack("<I", len(triangles)) + rows + behind


def read(folder: Path, name: str, content: str | bytes) -> Array:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return tidy(read_mesh(path, "here"))


def surface(triangles: Array) -> float:
    a, b, c = triangles.transpose(1, 0, 2)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


@pytest.fixture(scope="module")
def ell(tmp_path_factory: pytest.TempPathFactory) -> Array:
    return read(tmp_path_factory.mktemp("ell"), "ell.obj", prism(ELL))


def test_concave_faces_are_filled_and_no_more(ell: Array) -> None:
    assert is_closed(ell)
    assert volume(ell) == pytest.approx(3)
    assert surface(ell) == pytest.approx(14)


OUTLINES: dict[str, list[tuple[float, float]]] = {
    "a corner on a straight side": [(0, 0), (1, 0), (2, 0), (2, 1), (0, 1)],
    "an arrow": [(0, 0), (2, 1), (0, 2), (1, 1)],
    "a spiral": [(0, 0), (5, 0), (5, 5), (1, 5), (1, 2), (3, 2), (3, 3), (2, 3), (2, 4), (4, 4), (4, 1), (0, 1)],
    "a ring, cut open": [(0, 0), (3, 0), (3, 3), (0, 3), (0, 0), (1, 1), (1, 2), (2, 2), (2, 1), (1, 1)],
    "a comb": [(0, 0), (7, 0), (7, 2), (6, 2), (6, 1), (5, 1), (5, 2), (4, 2), (4, 1), (3, 1), (3, 2), (0, 2)],
}


@pytest.mark.parametrize("outline", OUTLINES.values(), ids=OUTLINES)
@pytest.mark.parametrize("start", [0, 1, 2, 3])
def test_any_outline_has_its_own_volume_wherever_it_starts(
    tmp_path: Path, outline: Sequence[tuple[float, float]], start: int
) -> None:
    spin, _ = np.linalg.qr(np.random.default_rng(start).normal(size=(3, 3)))
    spin *= np.linalg.det(spin)
    x, y = np.array(outline, float).T
    area = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)
    body = read(tmp_path, "a.obj", prism([*outline[start:], *outline[:start]], spin))
    assert is_closed(body)
    assert volume(body) == pytest.approx(area)
    floor = np.linalg.norm(np.diff([*outline, outline[0]], axis=0), axis=1).sum()
    assert surface(body) == pytest.approx(2 * area + floor)


@given(radii=st.lists(st.floats(0.2, 3), min_size=3, max_size=12))
def test_stars_have_their_volume(tmp_path_factory: pytest.TempPathFactory, radii: list[float]) -> None:
    around = 2 * np.pi * np.arange(len(radii)) / len(radii)
    outline = [(r * np.cos(a), r * np.sin(a)) for r, a in zip(radii, around, strict=True)]
    area = float(np.sum(np.array(radii) * np.roll(radii, -1)) * np.sin(2 * np.pi / len(radii)) / 2)
    body = read(tmp_path_factory.getbasetemp(), "star.obj", prism(outline))
    assert is_closed(body)
    assert volume(body) == pytest.approx(area)


def test_faces_that_are_not_flat_leave_no_gap(tmp_path: Path) -> None:
    lifted = prism(ELL).replace("v 1.0 1.0 1.0", "v 1.0 1.0 1.3").replace("v 0.0 2.0 1.0", "v 0.0 2.0 0.8")
    body = read(tmp_path, "a.obj", lifted)
    assert is_closed(body)
    assert 2.8 < volume(body) < 3.3


def test_corners_count_backwards_from_each_face(tmp_path: Path) -> None:
    two = prism(BOX, backwards=True) + prism([(x + 2, y) for x, y in BOX], backwards=True)
    body = read(tmp_path, "two.obj", two)
    assert is_closed(body)
    assert volume(body) == pytest.approx(2)
    assert body.reshape(-1, 3).max(axis=0) == pytest.approx([3, 1, 1])


OBJ_SAYINGS: dict[str, Callable[[str], str]] = {
    "byte order mark": lambda text: "\ufeff" + text,
    "windows lines": lambda text: text.replace("\n", "\r\n"),
    "old mac lines": lambda text: text.replace("\n", "\r"),
    "comments": lambda text: "# f 1 2 3\no box # f\n" + text.replace("\nf", " # up\nf"),
    "lines that go on": lambda text: text.replace("f 1 2", "f 1 \\\n2"),
    "texture and normals": lambda text: "vt 0 0\nvn 0 0 1\n" + text.replace("f 1 2", "f 1/1/1 2//1"),
    "colours of corners": lambda text: text.replace(" 1.0\n", " 1.0 0.5 0.5 0.5\n"),
    "names in any script": lambda text: "g a\x85f 1 2 3 ж\n" + text,
    "points and lines": lambda text: text + "p 1\nl 1 2\nf 1 2\n",
    "faces first": lambda text: "".join(sorted(text.splitlines(keepends=True), key=lambda line: line[0])),
}


@pytest.mark.parametrize("said", OBJ_SAYINGS.values(), ids=OBJ_SAYINGS)
def test_an_obj_may_say_it_in_many_ways(tmp_path: Path, said: Callable[[str], str]) -> None:
    body = read(tmp_path, "box.obj", said(prism(BOX)))
    assert is_closed(body)
    assert volume(body) == pytest.approx(1)


def test_an_stl_may_say_it_in_many_ways(tmp_path: Path, ell: Array) -> None:
    text = facets(ell)
    square = text.replace("vertex", "VERTEX").replace("solid a", "SOLID  a b c")
    several = facets(ell[:9]) + facets(ell[9:])
    ways: dict[str, str | bytes] = {
        "binary": binary(ell),
        "a binary that begins as text": binary(ell, b"solid facet normal"),
        "a few bytes behind": binary(ell, behind=bytes(7)),
        "text": text,
        "capitals": square,
        "two solids": several,
        "indented, behind a mark": "\ufeff\n  " + text.replace("\n", "\r\n\t"),
        "words behind": text + "made by hand\n",
    }
    for way, content in ways.items():
        body = read(tmp_path, "ell.STL", content)
        assert len(body) == len(ell), way
        assert volume(body) == pytest.approx(3), way


def test_what_is_left_out_is_said(tmp_path: Path, ell: Array) -> None:
    with pytest.warns(DoubtfulMesh, match=r"^here: a\.stl holds room for 2 triangles behind the 20 that it announces"):
        assert len(read(tmp_path, "a.stl", binary(ell, behind=bytes(120)))) == 20
    with pytest.warns(DoubtfulMesh, match=r"^here: a\.obj holds 1 curves or curved surfaces, which were left out"):
        read(tmp_path, "a.obj", prism(BOX) + "surf 0 1 0 1 1 2 3 4\n")


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 4\n", "line 4 names corner 4 of 3"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 0\n", "line 4 names corner 0"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf -1 -2 -4\n", "line 4 names corner -4"),
        ("a.obj", "v 0 0 0\nv 1,5 0 0\n", "line 2 does not give three numbers"),
        ("a.obj", "v 0 0\n", "line 1 does not give three numbers"),
        ("a.obj", "v 0 0 0\nf a b c\n", "line 2 names a corner that is no whole number"),
        ("a.obj", "f 1 2 3\n", "line 1 names corner 3 of 0"),
        ("a.obj", "v 0 0 0\nf" + 20_000 * " 1", "a face of 20000 corners"),
        ("a.stl", "solid a\nfacet\nouter loop\nvertex 0 0 0\n", "cut short"),
        ("a.stl", "solid a\nfacet\nvertex 0 0 0\n", "line 3 is no line of an STL file here"),
        ("a.stl", "solid a\nouter loop\nvertex 0 0 x\n", "line 3 does not give three numbers"),
        ("a.stl", binary(np.zeros((3, 3, 3)))[:-1], "announces 3 triangles and is cut short after 2"),
        ("a.stl", binary(np.zeros((3, 3, 3)), b"solid")[:-1], "announces 3 triangles and is cut short after 2"),
        ("a.stl", binary(np.zeros((0, 3, 3)), behind=bytes(100)), "announces no triangles and goes on for 100 bytes"),
        ("a.stl", "<html>", "shorter than any"),
    ],
)
def test_what_is_wrong_with_a_mesh_is_one_sentence(tmp_path: Path, name: str, content: str | bytes, said: str) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, name, content)
    assert str(caught.value).startswith(f"here: {name} cannot be read as a mesh (")
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
