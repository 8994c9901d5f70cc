"""A cube's extinction as a volume, for renderers and viewers of volumes, by suffix."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

from lightcube.errors import InputError
from lightcube.fabrication import _raw, _vdb
from lightcube.fabrication.planned import Advance, File, Planned, of_grid
from lightcube.io._files import Replaceable, suffix_entry
from lightcube.io._places import Place
from lightcube.optics.arrays import Volume
from lightcube.optics.checks import check_fields
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid

Reader = Callable[[Path], tuple[Volume, Grid | None]]

#: By suffix what writes a volume, and what reads such a file again.
FORMATS: Mapping[str, tuple[Callable[[Path, Volume, Grid], None], Reader]] = {
    ".vdb": (_vdb.write_vdb, _vdb.read_vdb),
    ".nrrd": (_raw.write_nrrd, _raw.read_nrrd),
    ".vti": (_raw.write_vti, _raw.read_vti),
    ".npy": (_raw.write_npy, _raw.read_npy),
}
#: How many mm a unit is.
_UNITS = {"mm": 1.0, "m": 1000.0}
#: How far a number may be off after it was counted in another unit, of itself.
_ROUNDED = 1e-6


@dataclass(frozen=True)
class VolumeFile:
    """How a volume is written.

    Parameters
    ----------
    unit
        What a VDB counts in: ``"m"`` for programs that take its unit for a metre; extinction is then per metre.
    """

    unit: Literal["mm", "m"] = "mm"

    called: ClassVar[str] = "a volume"
    suffixes: ClassVar[tuple[str, ...]] = tuple(FORMATS)
    replaceable: ClassVar[Replaceable] = None

    def __post_init__(self) -> None:
        check_fields(self)

    def plan(self, cube: Cube, at: Place) -> Planned:
        """What would be written."""
        write, read = suffix_entry(at, FORMATS, self.called)
        is_vdb = read is _vdb.read_vdb
        if is_vdb:
            _vdb.check_vdb(cube.grid)
        elif self.unit != "mm":
            raise InputError(f"{at} says that its unit is a mm, only a .vdb does not: leave --unit {self.unit} out")

        def written(path: Path, _: Advance) -> None:
            if is_vdb:
                _vdb.write_vdb(path, cube.extinction, cube.grid, _UNITS[self.unit])
            else:
                write(path, cube.extinction, cube.grid)
            _check_same(path, read(path)[0], cube.extinction)

        facts = {**of_grid(cube.grid), "unit": self.unit, "extinction": f"1/{self.unit}"}
        return Planned((File(at, written),), facts, (), read)


def _check_same(path: Path, read: Volume, written: Volume) -> None:
    """Raise `InputError` where a file does not hold what it was to hold."""
    if read.shape != written.shape or not np.allclose(read, written, rtol=_ROUNDED, atol=0):
        raise InputError(f"{path.name} does not hold what was written: try another disk, or another format")
