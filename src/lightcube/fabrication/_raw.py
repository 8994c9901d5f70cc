"""Volumes as NRRD, VTI and NPY: a head that says what there is, and all numbers behind it, as they are.

What is written is read back, and nothing else of these formats, which can hold far more.
"""

from __future__ import annotations

import re
import struct
from pathlib import Path
from typing import Any

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Volume, locked
from lightcube.optics.grid import Grid

_NRRD = """NRRD0004
# extinction of a light cube, 1/mm
type: float
dimension: 4
space: left-posterior-superior
sizes: {channels} {nx} {ny} {nz}
space directions: none ({sx!r},0,0) (0,{sy!r},0) (0,0,{sz!r})
kinds: {kind} domain domain domain
endian: little
encoding: raw
space origin: ({ox!r},{oy!r},{oz!r})
space units: "mm" "mm" "mm"

"""
_VTI = """<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<ImageData WholeExtent="0 {nx} 0 {ny} 0 {nz}" Origin="{ox!r} {oy!r} {oz!r}" Spacing="{sx!r} {sy!r} {sz!r}">
<Piece Extent="0 {nx} 0 {ny} 0 {nz}">
<PointData/>
<CellData>
<DataArray type="Float32" Name="extinction" NumberOfComponents="{channels}" format="appended" offset="0"/>
</CellData>
</Piece>
</ImageData>
<AppendedData encoding="raw">
_"""
_VTI_END = b"\n</AppendedData>\n</VTKFile>\n"
#: Of a VTI, how many bytes its numbers take.
_SIZE = struct.Struct("<Q")
#: No head of these is longer.
_LONGEST = 2048


def _write_headed(path: Path, head: bytes, volume: Volume, end: bytes) -> None:
    """Write a head, a volume slice by slice, and an end."""
    with path.open("wb") as file:
        file.write(head)
        for layer in range(volume.shape[1]):
            file.write(np.ascontiguousarray(volume[:, layer].transpose(1, 2, 0), "<f4").tobytes())
        file.write(end)


def write_nrrd(path: Path, volume: Volume, grid: Grid) -> None:
    """Write extinction as NRRD: colours lie together, then x, y and z; numbers are places in mm as they are here.

    Its space is left, posterior, superior: in any other one, ITK turns the numbers' signs.
    """
    kind = "RGB-color" if len(volume) == 3 else "vector"
    _write_headed(path, _NRRD.format(kind=kind, **_placed(volume, grid, middles=True)).encode(), volume, b"")


def read_nrrd(path: Path) -> tuple[Volume, Grid]:
    """The volume of a file that `write_nrrd` wrote, and its grid."""
    return _read_headed(path, _NRRD, b"", middles=True)


def write_vti(path: Path, volume: Volume, grid: Grid) -> None:
    """Write extinction as VTK's image data: voxels are its cells, and its corners are those of the block, in mm."""
    head = _VTI.format(**_placed(volume, grid, middles=False)).encode()
    _write_headed(path, head + _SIZE.pack(volume.size * 4), volume, _VTI_END)


def read_vti(path: Path) -> tuple[Volume, Grid]:
    """The volume of a file that `write_vti` wrote, and its grid."""
    return _read_headed(path, _VTI, _VTI_END, middles=False, skipped=_SIZE.size)


def write_npy(path: Path, volume: Volume, grid: Grid) -> None:
    """Write extinction as NumPy's array ``(channel, z, y, x)``; how large voxels are is said beside it."""
    with path.open("wb") as file:
        np.lib.format.write_array(file, np.ascontiguousarray(volume, "<f4"), allow_pickle=False)


def read_npy(path: Path) -> tuple[Volume, None]:
    """The volume of a file that `write_npy` wrote, which does not say how large voxels are."""
    try:
        mapped = np.load(path, mmap_mode="r", allow_pickle=False)
    except (ValueError, OSError, EOFError, SyntaxError) as error:
        raise foreign(path) from error
    if not isinstance(mapped, np.ndarray) or mapped.ndim != 4 or mapped.dtype != np.dtype("<f4") or not mapped.size:
        raise foreign(path)
    return locked(np.array(mapped, np.float32)), None


def foreign(path: Path) -> InputError:
    """Return the exception for a file that somebody else wrote, or that is damaged."""
    return InputError(
        f"{path} is not as lightcube export writes {path.suffix.lower()} files, or is damaged: other programs' volumes "
        "are not read, give one that it wrote"
    )


def _placed(volume: Volume, grid: Grid, *, middles: bool) -> dict[str, Any]:
    """Counts, sides and where the block begins, or where the middle of its first voxel is, by their names in heads."""
    counts, sides = np.array(grid.shape[::-1]), grid.sides_mm
    origin = -sides * (counts - middles) / 2
    rows = {"nx ny nz": counts, "sx sy sz": sides, "ox oy oz": origin}
    placed = {name: value for key, row in rows.items() for name, value in zip(key.split(), row.tolist(), strict=True)}
    return {"channels": len(volume), **placed}


def _read_headed(path: Path, template: str, end: bytes, *, middles: bool, skipped: int = 0) -> tuple[Volume, Grid]:
    """The volume of a file whose head is as a template has it, and its grid."""
    with path.open("rb") as file:
        start = file.read(_LONGEST)
    found = _pattern(template).match(start)
    if found is None:
        raise foreign(path)
    said = {name: float(value) for name, value in found.groupdict().items() if name != "kind"}
    channels, nz, ny, nx = (int(said[name]) for name in ("channels", "nz", "ny", "nx"))
    count, at = channels * nz * ny * nx, found.end() + skipped
    if not count or path.stat().st_size != at + 4 * count + len(end) or said["sx"] != said["sy"]:
        raise foreign(path)
    try:
        grid = Grid((nz, ny, nx), said["sx"], round(said["sz"] / said["sx"], 12))
    except (InputError, ZeroDivisionError) as error:
        raise foreign(path) from error
    volume = np.fromfile(path, "<f4", count, offset=at).reshape(nz, ny, nx, channels).transpose(3, 0, 1, 2)
    placed = _placed(volume, grid, middles=middles)
    if not np.allclose([said[name] for name in placed], list(placed.values()), rtol=1e-9):
        raise foreign(path)
    return locked(volume), grid


def _pattern(template: str) -> re.Pattern[bytes]:
    """What a head is that a template makes: numbers are groups of their names, the same wherever they stand again."""
    known: set[str] = set()
    parts = re.split(r"\{(\w+)(?:!r)?\}", template)
    made = re.escape(parts[0])
    for name, text in zip(parts[1::2], parts[2::2], strict=True):
        made += f"(?P={name})" if name in known else f"(?P<{name}>[-+.\\w]+)"
        made += re.escape(text)
        known.add(name)
    return re.compile(made.encode())
