"""Faces of PLY files, binary and text, and meshes as binary ones."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.solids.mesh import Mesh

_FACE = np.dtype([("count", "u1"), ("corners", "<i4", 3)])
_HEAD = """ply
format binary_little_endian 1.0
comment lengths are millimetres, z is up
element vertex {vertices}
property float x
property float y
property float z
element face {faces}
property list uchar int vertex_indices
end_header
"""
#: Types of numbers by both of their names.
_TYPES = {
    **dict(zip(("char", "uchar", "short", "ushort", "int", "uint", "float", "double"), "bBhHiIfd", strict=True)),
    **dict(
        zip(
            ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"),
            "bBhHiIfd",
            strict=True,
        )
    ),
}
_ORDERS = {b"ascii": "", b"binary_little_endian": "<", b"binary_big_endian": ">"}
#: What lists of a face's corners are called.
_CORNERS = ("vertex_indices", "vertex_index")
_MOST_HEAD = 1 << 16

#: Names and types of what an element has, of a list the types of its length and of its numbers.
_Properties = list[tuple[str, tuple[str, ...]]]
#: An element: its name, how many there are, and what each has.
_Element = tuple[str, int, _Properties]
#: By name what was read, arrays one behind the other.
_Values = dict[str, list[NDArray[Any]]]


def write_ply(mesh: Mesh) -> bytes:
    """A mesh as the bytes of a PLY file, coordinates as float32."""
    faces = np.empty(len(mesh.faces), _FACE)
    faces["count"], faces["corners"] = 3, mesh.faces
    head = _HEAD.format(vertices=len(mesh.vertices_mm), faces=len(faces))
    return head.encode() + mesh.vertices_mm.astype("<f4").tobytes() + faces.tobytes()


def read_ply(data: bytes) -> tuple[list[NDArray[np.float64]], str]:
    """Faces of a PLY file, ``(faces, corners, 3)``, and what else it holds; `ValueError` says what is wrong."""
    order, elements, body = _header(data)
    words = body.split() if not order else []
    corners: NDArray[np.float64] | None = None
    lists: list[NDArray[np.int64]] = []
    at = 0
    for name, count, properties in elements:
        values, at = _text(words, at, count, properties) if not order else _binary(body, at, order, count, properties)
        if name == "vertex":
            if not all(axis in values for axis in "xyz"):
                raise ValueError("its vertices have no x, y and z")
            corners = np.column_stack([np.concatenate(values[axis]) for axis in "xyz"]).astype(np.float64)
        if name == "face":
            alike: dict[int, list[NDArray[Any]]] = {}
            for each in values.get(_CORNERS[0], values.get(_CORNERS[1], [])):
                alike.setdefault(each.shape[1], []).append(each)
            lists = [np.concatenate(each).astype(np.int64) for each in alike.values()]
    if corners is None or not lists:
        raise ValueError("it has no vertices, or no faces that name them")
    if min(int(each.min(initial=0)) for each in lists) < 0 or max(int(each.max(initial=0)) for each in lists) >= len(
        corners
    ):
        raise ValueError(f"a face names a vertex that is not among its {len(corners)}")
    return [corners[each] for each in lists if each.shape[1] >= 3], ""


def _header(data: bytes) -> tuple[str, list[_Element], bytes]:
    """Order of bytes, nothing for a text, what there is of elements, and all that follows."""
    end = data.find(b"end_header", 0, _MOST_HEAD)
    if not data.startswith(b"ply") or end < 0:
        raise ValueError("it does not begin as one")
    order, elements = None, list[_Element]()
    for line in data[:end].splitlines()[1:]:
        words = line.split()
        try:
            if words[:1] == [b"format"]:
                order = _ORDERS[words[1]]
            elif words[:1] == [b"element"]:
                elements.append((words[1].decode(), int(words[2]), []))
            elif words[:1] == [b"property"]:
                is_list = words[1] == b"list"
                types = tuple(_TYPES[word.decode()] for word in (words[2:4] if is_list else words[1:2]))
                elements[-1][2].append((words[-1].decode(), types))
        except (KeyError, IndexError, ValueError):
            raise ValueError(f"its header has a line {line[:60].decode(errors='replace')!r}") from None
    if order is None:
        raise ValueError("its header does not say in which format it is")
    start = data.find(b"\n", end) + 1 or len(data)
    return order, elements, data[start:]


def _binary(body: bytes, at: int, order: str, count: int, properties: _Properties) -> tuple[_Values, int]:
    """Numbers of an element in a binary body, and where the next one begins; of a list one array for each length."""
    runs: dict[str, list[NDArray[Any]]] = {name: [] for name, _ in properties}
    done, most = 0, 64
    while done < count and properties:
        fields: list[Any] = []
        place = at
        for name, types in properties:  # as the first that is left is: mostly all are alike
            if len(types) == 1:
                fields.append((name, order + types[0]))
                place += np.dtype(types[0]).itemsize
                continue
            (length,) = np.frombuffer(body, order + types[0], 1, place).tolist()
            fields += [(f"{name} count", order + types[0]), (name, order + types[1], (int(length),))]
            place += np.dtype(types[0]).itemsize + int(length) * np.dtype(types[1]).itemsize
        kind = np.dtype(fields)
        rows = np.frombuffer(body, kind, min(count - done, most, (len(body) - at) // kind.itemsize), at)
        if not len(rows):
            raise ValueError("it is cut short")
        same = np.ones(len(rows), np.bool_)
        for name, types in properties:
            if len(types) == 2:
                same &= rows[f"{name} count"] == rows[f"{name} count"][0]
        alike = len(rows) if np.all(same) else int(np.argmin(same))
        for name, _ in properties:
            runs[name].append(rows[name][:alike])
        most = 2 * most if alike == len(rows) else 64
        done, at = done + alike, at + alike * kind.itemsize
    return runs, at


def _text(words: list[bytes], at: int, count: int, properties: _Properties) -> tuple[_Values, int]:
    """The same of a text's words."""
    if len(properties) and all(len(types) == 1 for _, types in properties):
        end = at + count * len(properties)
        if end > len(words):
            raise ValueError("it is cut short")
        table = np.array(words[at:end], np.float64).reshape(count, -1)
        return {name: [table[:, number]] for number, (name, _) in enumerate(properties)}, end
    runs: dict[str, list[NDArray[Any]]] = {name: [] for name, _ in properties}
    for _ in range(count if properties else 0):
        for name, types in properties:
            if at >= len(words):
                raise ValueError("it is cut short")
            length = 1 if len(types) == 1 else int(words[at])
            at += len(types) - 1
            if not 0 <= length <= len(words) - at:
                raise ValueError("it is cut short")
            runs[name].append(np.array([words[at : at + length]], np.float64))
            at += length
    return runs, at
