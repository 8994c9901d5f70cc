"""What is to be written, before it is: files, and what is known of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Protocol

import numpy as np

from lightcube.io._files import Replaceable
from lightcube.io._places import Place
from lightcube.optics.arrays import Reals, Volume
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid

#: Is told how many of how many parts are done.
Advance = Callable[[int, int], None]
#: Which way all files lie.
AXES = "x and y lie, z stands up, right-handed; the block's middle is at 0; lengths are millimetres"


@dataclass(frozen=True)
class File:
    """A file or a folder that is to be written.

    Parameters
    ----------
    at
        Where.
    write
        Called with a path where nothing is yet, and tells how far it is.
    replaceable
        Tells of an existing folder whether it may be replaced; None where a file is written.
    """

    at: Place
    write: Callable[[Path, Advance], None]
    replaceable: Replaceable = None


@dataclass(frozen=True, eq=False)
class Planned:
    """What is to be written, before it is.

    Parameters
    ----------
    files
        The main one first.
    facts
        What is known of them, for the sidecar and for who only asks.
    notes
        What is to be said to people.
    held
        Reads the volume of the main file again; None where it casts nothing.
    is_relit
        Whether it is another block than the cube, which other lamps suit better.
    """

    files: tuple[File, ...]
    facts: dict[str, Any]
    notes: tuple[str, ...] = ()
    held: Callable[[Path], tuple[Volume, Grid | None]] | None = None
    is_relit: bool = False


class How(Protocol):
    """How something of a kind is made; what it is called, what its names end with, and which folders it may replace."""

    called: ClassVar[str]
    suffixes: ClassVar[tuple[str, ...]]
    replaceable: ClassVar[Replaceable]

    def plan(self, cube: Cube, at: Place) -> Planned:
        """What would be written; `InputError` where it cannot be right."""
        ...


def named(values: Sequence[float] | Reals) -> dict[str, Any]:
    """Numbers along x, y and z by name."""
    return dict(zip("xyz", np.asarray(values).tolist(), strict=True))


def of_grid(grid: Grid) -> dict[str, Any]:
    """How large a block of voxels is."""
    return {
        "voxels": named(grid.shape[::-1]),
        "pitch_mm": named(grid.sides_mm),
        "size_mm": named(grid.size_mm[::-1]),
        "axes": AXES,
    }
