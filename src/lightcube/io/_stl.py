"""Faces of STL files, binary and text, and meshes as binary ones."""

import numpy as np
from numpy.typing import NDArray

from lightcube.solids.mesh import Mesh

_COUNT, _START = 80, 84
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])
#: What begins the lines of a text that say nothing of a face's corners.
_SILENT = (b"facet", b"endfacet", b"color")


def read_stl(data: bytes) -> tuple[list[NDArray[np.float64]], str]:
    """Faces of an STL file, ``(faces, corners, 3)``, and what else it holds; `ValueError` says what is wrong.

    A file is binary where it is long enough for as many triangles as it says then, whatever it begins with: many
    programs begin binary files as text begins.
    """
    count = int.from_bytes(data[_COUNT:_START], "little")
    room = (len(data) - _START) // _TRIANGLE.itemsize
    more = room - count
    if len(data) >= _START and more >= 0:
        if more and not count:
            raise ValueError(f"it announces no triangles and goes on for {len(data) - _START} bytes")
        triangles = np.frombuffer(data, _TRIANGLE, count, offset=_START)["corners"].astype(np.float64)
        more = room - count
        return [triangles], f"room for {more} triangles behind the {count} that it announces" if more else ""
    text = data.removeprefix(b"\xef\xbb\xbf").lstrip()
    if text[:5].lower() == b"solid" and b"\0" not in text:
        return _text(text), ""
    if len(data) < _START:
        raise ValueError("it is shorter than any")
    raise ValueError(f"it announces {count} triangles and is cut short after {room}")


def _text(text: bytes) -> list[NDArray[np.float64]]:
    """Faces of a text, which may be several solids one behind the other; what follows the last of them is ignored."""
    faces: dict[int, list[list[list[float]]]] = {}
    loop: list[list[float]] | None = None
    inside = False
    for number, line in enumerate(text.splitlines(), 1):
        words = line.lower().split()
        first = words[0] if words else b""
        if first == b"solid":
            inside = True
        elif not inside or not words:
            continue
        elif first in (b"endsolid", b"end"):
            inside = False
        elif first == b"outer" and loop is None:
            loop = []
        elif first == b"vertex" and loop is not None:
            loop.append(corner_of(words[1:], number))
        elif first == b"endloop" and loop is not None:
            faces.setdefault(len(loop), []).append(loop)
            loop = None
        elif first not in _SILENT or loop is not None:
            raise ValueError(f"line {number} is no line of an STL file here")
    if inside:
        raise ValueError("it is cut short: its last solid does not end")
    return [np.array(alike, dtype=np.float64) for corners, alike in faces.items() if corners >= 3]


def write_stl(mesh: Mesh) -> bytes:
    """A mesh as the bytes of a binary STL file, coordinates as float32."""
    faces = np.zeros(len(mesh), _TRIANGLE)
    faces["corners"] = mesh.triangles
    a, b, c = mesh.triangles.transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    faces["normal"] = np.divide(normals, lengths, where=lengths > 0, out=np.zeros_like(normals))
    return b"lightcube, millimetres".ljust(_COUNT) + len(faces).to_bytes(4, "little") + faces.tobytes()


def corner_of(words: list[bytes], line: int) -> list[float]:
    """The three numbers that a corner's line gives; `ValueError` naming the line where they are none."""
    try:
        x, y, z = (float(word) for word in words[:3])
    except ValueError:
        raise ValueError(f"line {line} does not give three numbers") from None
    return [x, y, z]
