"""Shells of a cube: surfaces around what is darkest in it, each of one colour, for printers that print parts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from lightcube.errors import InputError
from lightcube.fabrication.planned import AXES, Advance, File, Planned, named
from lightcube.fabrication.points import PLY_HEAD, check_matter, luminance
from lightcube.io._3mf import write_parts_3mf
from lightcube.io._files import Replaceable
from lightcube.io._places import Place, beside, name_of
from lightcube.io._stl import write_stl
from lightcube.optics.arrays import Volume
from lightcube.optics.checks import check_fields
from lightcube.optics.cube import Cube
from lightcube.optics.transfer import to_uint8
from lightcube.solids.mesh import Mesh
from lightcube.solids.surface import surface

#: Levels at most: printers hold few materials.
MOST = 8
#: Marching cubes make faces of no size nearer to 0.
_CLEAR_OF_0 = 1 / 256
#: And where it changes faster than this at a face, what stands there would stand out of the block.
_STEEPEST = np.float32(0.5)
#: What such a thing is.
_NOTE = "shells are decorative: printed in opaque parts they cast none of the cube's pictures"


@dataclass(frozen=True, eq=False)
class Shell:
    """What is darker than a level.

    Parameters
    ----------
    mesh
        Its surface, in mm around the block's middle.
    colour
        Red, green and blue, 8-bit display levels: white light behind so much of its matter that 1/e is left of it.
    level
        The level, 1/mm of brightness.
    holds
        The part of all extinction that is inside.
    """

    mesh: Mesh
    colour: tuple[int, int, int]
    level: float
    holds: float


@dataclass(frozen=True)
class Shells:
    """How shells are written.

    Parameters
    ----------
    levels
        How many there are.
    """

    levels: int = 3

    called: ClassVar[str] = "a shell"
    suffixes: ClassVar[tuple[str, ...]] = (".3mf", ".ply")
    replaceable: ClassVar[Replaceable] = None

    def __post_init__(self) -> None:
        check_fields(self)
        if not 1 <= self.levels <= MOST:
            raise InputError(f"a cube has 1 to {MOST} shells, not {self.levels}")

    def plan(self, cube: Cube, at: Place) -> Planned:
        """What would be written: parts in one file, and for slicers that cannot keep those together one STL each."""
        is_3mf = name_of(at).lower().endswith(".3mf")
        made = shells(cube, self.levels)
        parts = [(f"shell {number}", shell.mesh, shell.colour) for number, shell in enumerate(made, 1)]

        def main(path: Path, _: Advance) -> None:
            path.write_bytes(write_parts_3mf(parts) if is_3mf else ply(made))

        stem = name_of(at).rpartition(".")[0]
        files = [File(at, main)]
        files += [
            File(beside(at, f"{stem}-{number}.stl"), _stl(shell.mesh)) for number, shell in enumerate(made, 1) if is_3mf
        ]
        facts = {
            "size_mm": named(cube.grid.size_mm[::-1]),
            "axes": AXES,
            "shells": [
                {
                    "part": name,
                    "colour": "#{:02x}{:02x}{:02x}".format(*colour),
                    "holds": shell.holds,
                    "brightness_per_mm": shell.level,
                    "volume_mm3": mesh.volume_mm3,
                    "faces": len(mesh),
                }
                for shell, (name, mesh, colour) in zip(made, parts, strict=True)
            ],
        }
        return Planned(tuple(files), facts, (_NOTE,))


def _stl(mesh: Mesh) -> Callable[[Path, Advance], None]:
    """The writer of a shell by itself, where it is."""

    def write(path: Path, _: Advance) -> None:
        path.write_bytes(write_stl(mesh))

    return write


def shells(cube: Cube, levels: int) -> list[Shell]:
    """Shells that hold equal steps of all extinction, the outermost first; three hold 3/4, 1/2 and 1/4.

    The brightness that voxels take is smoothed by a voxel first: the matter of a solved cube is as rough as noise.
    """
    from scipy.ndimage import gaussian_filter  # here: it takes long to load

    check_matter(cube)
    dark = gaussian_filter(luminance(cube), 1.0, mode="constant")
    descending = np.sort(dark.ravel())[::-1].astype(np.float64)
    held = np.cumsum(descending) / descending.sum()
    made = []
    for step in range(levels, 0, -1):
        level = float(descending[np.searchsorted(held, step / (levels + 1))])
        made.append(_shell(cube, dark, level))
    return made


def _shell(cube: Cube, dark: Volume, level: float) -> Shell:
    """The shell around what is darker than a level."""
    inside = dark >= level
    field = ((level - dark) / max(level, float(np.finfo(np.float32).tiny))).astype(np.float32)
    low, high = np.clip(field, -_STEEPEST, -_CLEAR_OF_0), np.clip(field, _CLEAR_OF_0, _STEEPEST)
    mean = cube.extinction[:, inside].mean(axis=1, dtype=np.float64)
    light = np.exp(-mean / max(float(mean.mean()), 1e-12))
    red, green, blue = to_uint8(np.broadcast_to(light, 3) if len(light) != 3 else light).tolist()
    holds = float(cube.extinction[:, inside].sum(dtype=np.float64) / cube.extinction.sum(dtype=np.float64))
    return Shell(surface(np.where(inside, low, high), cube.grid), (red, green, blue), level, holds)


def ply(made: Sequence[Shell]) -> bytes:
    """Shells as the bytes of one binary PLY file, each vertex in its shell's colour."""
    corner = np.dtype([("place", "<f4", 3), ("colour", "u1", 3)])
    face = np.dtype([("count", "u1"), ("corners", "<i4", 3)])
    corners = [np.empty(len(shell.mesh.vertices_mm), corner) for shell in made]
    faces = [np.empty(len(shell.mesh), face) for shell in made]
    first = 0
    for shell, places, sides in zip(made, corners, faces, strict=True):
        places["place"], places["colour"] = shell.mesh.vertices_mm, shell.colour
        sides["count"], sides["corners"] = 3, shell.mesh.faces + first
        first += len(places)
    head = PLY_HEAD.format(comment="shells of a light cube, the outermost first", count=first)
    head += f"element face {sum(map(len, faces))}\nproperty list uchar int vertex_indices\nend_header\n"
    return head.encode() + b"".join(each.tobytes() for each in (*corners, *faces))
