"""Faces of Wavefront's OBJ files, and meshes as such."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from lightcube.io._stl import corner_of
from lightcube.solids.mesh import Mesh

#: More corners than any face needs: cutting one takes time with their square.
_MOST_CORNERS = 10_000
#: What begins a curved curve or surface.
_CURVED = (b"curv", b"curv2", b"surf")


def read_obj(data: bytes) -> tuple[list[NDArray[np.float64]], str]:
    """Faces of an OBJ file, ``(faces, corners, 3)``, and what else it holds; `ValueError` says what is wrong.

    Corners are told by their number in the file, from 1, or backwards from the last one before the face, from -1.
    """
    corners: list[list[float]] = []
    faces: dict[int, list[list[int]]] = {}
    last, last_line, curved = 0, 0, 0
    for number, words in _lines(data.removeprefix(b"\xef\xbb\xbf")):
        if words[0] == b"v":
            corners.append(corner_of(words[1:], number))
        elif words[0] in (b"f", b"fo"):
            face = [_index(word, len(corners), number) for word in words[1:]]
            if len(face) > _MOST_CORNERS:
                raise ValueError(f"line {number} is a face of {len(face)} corners, more than {_MOST_CORNERS}")
            faces.setdefault(len(face), []).append(face)
            if max(face, default=0) >= last:
                last, last_line = max(face, default=0), number
        elif words[0] in _CURVED:
            curved += 1
    if faces and last >= len(corners):
        raise ValueError(f"line {last_line} names corner {last + 1} of {len(corners)}")
    made = np.array(corners, dtype=np.float64).reshape(-1, 3)
    found = [made[np.array(alike, dtype=np.intp)] for count, alike in faces.items() if count >= 3]
    return found, f"{curved} curves or curved surfaces" if curved else ""


def write_obj(mesh: Mesh) -> bytes:
    """A mesh as the bytes of an OBJ file, coordinates as float32."""
    lines = ["# lightcube, millimetres, z is up"]
    lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in mesh.vertices_mm.astype(np.float32).tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (mesh.faces + 1).tolist()]
    return "\n".join([*lines, ""]).encode()


def _lines(data: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """Words of each line, without comments, and the line's number; a backslash at its end goes on with the next."""
    held = b""
    for number, line in enumerate(data.splitlines(), 1):
        said = held + line.split(b"#", 1)[0].rstrip()
        if said.endswith(b"\\"):
            held = said[:-1] + b" "
            continue
        held = b""
        if words := said.split():
            yield number, words


def _index(word: bytes, known: int, line: int) -> int:
    """A corner's place, from 0, that a word such as ``7``, ``7/2``, ``7//3`` or ``-1/-1/-1`` names."""
    try:
        given = int(word.split(b"/", 1)[0])
    except ValueError:
        raise ValueError(f"line {line} names a corner that is no whole number") from None
    if not -known <= given or not given:
        raise ValueError(f"line {line} names corner {given}, and corners count from 1 or back from -1")
    return given - 1 if given > 0 else known + given
