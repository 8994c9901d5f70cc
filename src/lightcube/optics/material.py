"""What the voxels of a cube can be."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from lightcube.errors import InputError
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.grid import Grid

#: What a largest extinction is counted along: a mm, or the side of a voxel.
Per = Literal["mm", "voxel"]


@dataclass(frozen=True)
class Material:
    """What bounds the extinction of voxels.

    Parameters
    ----------
    max_extinction
        The largest, above 0; infinity = any.
    per
        ``"mm"``, or ``"voxel"``: then it is the absorbance along a voxel's side.

    Raises
    ------
    InputError
        Where the bound is not positive, or it is counted along anything else.
    """

    max_extinction: float = math.inf
    per: Per = "mm"

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.max_extinction > 0:
            raise InputError(f"the largest extinction must be a positive number, not {self.max_extinction}")

    @checked
    def most(self, grid: Grid) -> float:
        """The largest extinction of the grid's voxels, 1/mm."""
        return self.max_extinction / (grid.voxel_mm if self.per == "voxel" else 1.0)
