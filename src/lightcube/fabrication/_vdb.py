"""Volumes as OpenVDB, which renderers take: dense grids, in files of version 224 as OpenVDB 10 writes them.

A tree of three levels: a root with one node of 32 a side, nodes of 16 a side in it, and leaves of 8 voxels a side.
First the whole tree comes as bits that say what is there, then the numbers, leaf by leaf, those of a leaf with z
fastest. Places: voxel (0, 0, 0) has its middle where the transform puts it, and no axis is turned.
"""

from __future__ import annotations

import hashlib
import re
import struct
import uuid
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.fabrication._raw import foreign
from lightcube.optics.arrays import Flags, Volume, locked
from lightcube.optics.grid import Grid

_MAGIC, _FILE_VERSION, _LIBRARY = 0x56444220, 224, (10, 0)
#: Only the numbers of voxels that are there are kept, beside bits that say which are.
_ACTIVE_ONLY = 2
#: Voxels along a side of a leaf; leaves along one of a node, and nodes along the side of the one that holds all.
_LEAF, _NODE, _TOP = 8, 16, 32
_MOST = _LEAF * _NODE * _TOP
#: No file of this package has more grids.
_MOST_GRIDS = 64
#: What the colours are called, each a grid of its own, and the grid of vectors that holds all three.
COLOURS, TOGETHER = ("red", "green", "blue"), "sigma"
#: What is told of a grid beside what every such file has: the file's unit, and the sides of voxels as `Grid` has them.
_TOLD = ("mm_per_unit", "voxel_mm", "voxel_tall")


def write_vdb(path: Path, volume: Volume, grid: Grid, unit_mm: float = 1.0) -> None:
    """Write extinction, per unit of length, as a grid for each colour and of three colours one of vectors.

    Parameters
    ----------
    unit_mm
        How long the file's unit is: 1000 for programs that take it for a metre.
    """
    check_vdb(grid)
    scaled = np.ascontiguousarray(volume.transpose(3, 2, 1, 0), np.float32) * np.float32(unit_mm)
    names = _names(len(volume))
    digest = hashlib.sha256(scaled.tobytes()).digest()
    with path.open("wb") as file:
        file.write(struct.pack("<qIII?", _MAGIC, _FILE_VERSION, *_LIBRARY, True))
        file.write(str(uuid.UUID(bytes=digest[:16], version=4)).encode())
        file.write(_metadata({}) + struct.pack("<I", len(names)))
        for name in names:
            numbers = scaled if name == TOGETHER else scaled[..., names.index(name)]
            opening, body = _opening(name, grid, unit_mm, channels=1 if numbers.ndim == 3 else 3)
            at = file.tell() + len(opening) + 24
            numbers_at = at + len(body)
            end = numbers_at + 4 * numbers.size + _leaf_count(grid) * (_LEAF**3 // 8 + 1)
            file.write(opening + struct.pack("<qqq", at, numbers_at, end) + body)
            for part in _leaves(numbers, grid):
                file.write(part)


def read_vdb(path: Path) -> tuple[Volume, Grid]:
    """The volume of a file that `write_vdb` wrote, in 1/mm, and its grid."""
    data = path.read_bytes()
    at = struct.calcsize("<qIII?") + 36
    try:
        grid, unit_mm, channels = _said(data)
        start = struct.pack("<qIII?", _MAGIC, _FILE_VERSION, *_LIBRARY, True)
        if not data.startswith(start) or data[at : at + 8] != _metadata({}) + struct.pack("<I", len(_names(channels))):
            raise foreign(path)
        at += 8
        volume = np.empty((channels, *grid.shape[::-1]), np.float32)
        for name in _names(channels):
            opening, body = _opening(name, grid, unit_mm, channels=3 if name == TOGETHER else 1)
            first, _, end = struct.unpack_from("<qqq", data, at + len(opening))
            if not data.startswith(opening, at) or first != at + len(opening) + 24 or not data.startswith(body, first):
                raise foreign(path)
            if name != TOGETHER:
                volume[COLOURS.index(name) if channels == 3 else int(name.removeprefix("colour_"))] = _numbers(
                    data, first + len(body), grid
                )
            at = end
    except (struct.error, ValueError, IndexError) as error:
        raise foreign(path) from error
    if at != len(data):
        raise foreign(path)
    return locked(volume.transpose(0, 3, 2, 1) / np.float32(unit_mm)), grid


def check_vdb(grid: Grid) -> None:
    """Raise `InputError` where a grid is larger than one node holds."""
    if max(grid.shape) > _MOST:
        raise InputError(f"a VDB of this package holds {_MOST} voxels a side, not {max(grid.shape)}: use .nrrd or .vti")


def _names(channels: int) -> tuple[str, ...]:
    return (*COLOURS, TOGETHER) if channels == 3 else tuple(f"colour_{channel}" for channel in range(channels))


def _text(value: str | bytes) -> bytes:
    data = value.encode() if isinstance(value, str) else value
    return struct.pack("<I", len(data)) + data


def _metadata(entries: dict[str, tuple[str, bytes]]) -> bytes:
    each = (_text(name) + _text(kind) + _text(value) for name, (kind, value) in entries.items())
    return struct.pack("<I", len(entries)) + b"".join(each)


def _opening(name: str, grid: Grid, unit_mm: float, *, channels: int) -> tuple[bytes, bytes]:
    """What comes before the three places of a grid in the file, and what comes behind them, up to the numbers."""
    kind = "vec3s" if channels == 3 else "float"
    opening = _text(name) + _text(f"Tree_{kind}_5_4_3") + _text("")
    counts = np.array(grid.shape[::-1])
    said = {
        "class": ("string", b"unknown" if channels == 3 else b"fog volume"),
        "file_bbox_max": ("vec3i", (counts - 1).astype("<i4").tobytes()),
        "file_bbox_min": ("vec3i", np.zeros(3, "<i4").tobytes()),
        "file_compression": ("string", b"active values"),
        "is_saved_as_half_float": ("bool", b"\0"),
        "name": ("string", name.encode()),
    }
    for each, value in zip(_TOLD, (unit_mm, grid.voxel_mm, grid.tall), strict=True):
        said[each] = ("double", struct.pack("<d", value))
    if channels == 3:
        said["vector_type"] = ("string", b"invariant")
    sides = grid.sides_mm / unit_mm
    moved = -sides * (counts - 1) / 2
    placed = np.concatenate([moved, sides, sides, 1 / sides, 1 / sides**2, 0.5 / sides]).astype("<f8").tobytes()
    return opening, b"".join(
        [
            struct.pack("<I", _ACTIVE_ONLY),
            _metadata(said),
            _text("ScaleTranslateMap") + placed,
            struct.pack("<I", 1) + bytes(4 * channels),  # one buffer; what is not there is 0
            _tree(grid),
        ]
    )


def _tree(grid: Grid) -> bytes:
    """The bits that say which nodes, leaves and voxels there are."""
    root = struct.pack("<II", 0, 1) + np.zeros(3, "<i4").tobytes()
    leaves = -(-np.array(grid.shape[::-1]) // _LEAF)
    nodes = np.zeros((_TOP,) * 3, bool)
    nodes[tuple(slice(-(-count // _NODE)) for count in leaves)] = True
    parts = [root, _bits(nodes), bytes(_TOP**3 // 8), b"\0"]
    for node in np.argwhere(nodes):
        inside = np.zeros((_NODE,) * 3, bool)
        inside[tuple(slice(min(_NODE, left)) for left in leaves - _NODE * node)] = True
        parts += [_bits(inside), bytes(_NODE**3 // 8), b"\0"]
        parts += [_bits(_there(_NODE * node + leaf, grid)) for leaf in np.argwhere(inside)]
    return b"".join(parts)


def _corners(grid: Grid) -> Iterator[NDArray[np.intp]]:
    """Yield the numbers of all leaves along x, y and z, in the order in which they come in the file."""
    leaves = -(-np.array(grid.shape[::-1]) // _LEAF)
    for node in np.ndindex(*-(-leaves // _NODE)):
        begin = _NODE * np.array(node)
        for leaf in np.ndindex(*np.minimum(_NODE, leaves - begin)):
            yield begin + leaf


def _leaf_count(grid: Grid) -> int:
    return int(np.prod(-(-np.array(grid.shape) // _LEAF)))


def _there(leaf: NDArray[np.intp], grid: Grid) -> Flags:
    """Which voxels of a leaf there are."""
    there = np.zeros((_LEAF,) * 3, bool)
    there[tuple(slice(min(_LEAF, left)) for left in np.array(grid.shape[::-1]) - _LEAF * leaf)] = True
    return there


def _bits(flags: Flags) -> bytes:
    return np.packbits(flags.ravel(), bitorder="little").tobytes()


def _cut(leaf: NDArray[np.intp]) -> tuple[slice, ...]:
    """The voxels of a leaf, as far as there are any."""
    return tuple(slice(begin, begin + _LEAF) for begin in (_LEAF * leaf).tolist())


def _leaves(numbers: NDArray[np.float32], grid: Grid) -> Iterator[bytes]:
    """Yield the bytes of each leaf: bits that say which voxels there are, and their numbers."""
    for leaf in _corners(grid):
        yield _bits(_there(leaf, grid)) + b"\0" + numbers[_cut(leaf)].astype("<f4").tobytes()


def _numbers(data: bytes, at: int, grid: Grid) -> NDArray[np.float32]:
    """The numbers of leaves from some place of a file on."""
    volume = np.empty(grid.shape[::-1], np.float32)
    for leaf in _corners(grid):
        part = volume[_cut(leaf)]
        at += _LEAF**3 // 8 + 1
        part[:] = np.frombuffer(data, "<f4", part.size, at).reshape(part.shape)
        at += 4 * part.size
    return volume


def _said(data: bytes) -> tuple[Grid, float, int]:
    """The grid, the unit and the number of colours that the first grid of a file says; `ValueError` where none."""
    start = data[: 2 * _LEAF**3]
    box = re.search(rb"file_bbox_max\x05\0\0\0vec3i\x0c\0\0\0(.{12})", start, re.DOTALL)
    told = [re.search(name.encode() + rb"\x06\0\0\0double\x08\0\0\0(.{8})", start, re.DOTALL) for name in _TOLD]
    if box is None:
        raise ValueError
    nx, ny, nz = (np.frombuffer(box[1], "<i4").astype(int) + 1).tolist()
    unit_mm, wide, tall = (struct.unpack("<d", found[1])[0] for found in told if found is not None)
    if not unit_mm > 0 or max(nx, ny, nz) > _MOST or 4 * nx * ny * nz > len(data):
        raise ValueError
    at = struct.calcsize("<qIII?") + 40
    (count,) = struct.unpack_from("<I", data, at)
    if not 1 <= count <= _MOST_GRIDS:
        raise ValueError
    is_rgb = data.startswith(_text(COLOURS[0]), at + 4)
    return Grid((nz, ny, nx), wide, tall), unit_mm, 3 if is_rgb else count
