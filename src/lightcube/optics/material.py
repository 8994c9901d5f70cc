"""What the voxels of a cube can be."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from lightcube.errors import InputError
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.dyes import Dyes
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
    dyes
        What the voxels are mixed of: then amounts of these are solved for, and their limits are the bound. None = each
        colour is for itself.

    Raises
    ------
    InputError
        Where the bound is not positive, or it is counted along anything else; where dyes have a second bound.
    """

    max_extinction: float = math.inf
    per: Per = "mm"
    dyes: Dyes | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.max_extinction > 0:
            raise InputError(f"the largest extinction must be a positive number, not {self.max_extinction}")
        if self.dyes is not None and self.max_extinction < math.inf:
            raise InputError("dyes are bounded by their limits: leave the largest extinction out")

    @checked
    def most(self, grid: Grid) -> float:
        """The largest extinction of the grid's voxels, 1/mm."""
        if self.dyes is not None:
            dyes = self.dyes.in_block(grid)
            return float((dyes.base + dyes.limit @ dyes.extinction).max())
        return self.max_extinction / (grid.voxel_mm if self.per == "voxel" else 1.0)

    def of_any_size(self, grid: Grid) -> Material:
        """The same bounds, which are those of a grid's voxels, for voxels of any size: what smaller cubes are of."""
        if self.dyes is not None:
            return replace(self, dyes=self.dyes.in_block(grid))
        return Material(self.most(grid))
