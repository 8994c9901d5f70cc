"""What the voxels of a cube can be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.dyes import Dyes
from lightcube.optics.grid import Grid

#: What a largest extinction is counted along: a mm, or the side of a voxel.
Per = Literal["mm", "voxel"]

#: No clear material takes more of the light, 1/mm.
_MOST_CLEAR = 1e6


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
    clear
        The least extinction, 1/mm: what the clearest voxel takes of the light, absorbed or thrown aside. One number, or
        one of each colour.

    Raises
    ------
    InputError
        Where a bound is out of range, or counted along anything else; where dyes have a second one.

    Examples
    --------
    >>> import lightcube as lc
    >>> lc.Material(0.12)  # stained glass: no voxel of it is black
    Material(max_extinction=0.12, per='mm', dyes=None, clear=0.0)
    """

    max_extinction: float = math.inf
    per: Per = "mm"
    dyes: Dyes | None = None
    clear: float | Sequence[float] = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.max_extinction > 0:
            raise InputError(f"the largest extinction must be a positive number, not {self.max_extinction}")
        if self.dyes is not None and self.max_extinction < math.inf:
            raise InputError("dyes are bounded by their limits: leave the largest extinction out")
        least = np.asarray(self.clear, np.float64)
        if least.ndim > 1 or not least.size or not np.all((least >= 0) & (least <= _MOST_CLEAR)):
            raise InputError(
                f"clear material takes 0 to {_MOST_CLEAR:g} per mm, of all colours or of each one, not {self.clear}"
            )
        if self.dyes is not None and np.any(least):
            raise InputError("a material of dyes has what its clear part takes as base: add it there")
        same = bool(np.all(least == least.flat[0]))
        object.__setattr__(self, "clear", float(least.flat[0]) if same else tuple(least.tolist()))

    @checked
    def most(self, grid: Grid) -> float:
        """The largest extinction of the grid's voxels, 1/mm."""
        if self.dyes is not None:
            dyes = self.dyes.in_block(grid)
            return float((dyes.base + dyes.limit @ dyes.extinction).max())
        return self.max_extinction / (grid.voxel_mm if self.per == "voxel" else 1.0)

    def least(self, grid: Grid, colours: int) -> Reals:
        """The least extinction of each of so many colours, 1/mm; `InputError` where it is not below the largest."""
        clear = np.asarray(self.clear)
        if clear.ndim and len(clear) != colours:
            raise InputError(f"clear material is known of {len(clear)} colours, and pictures have {colours}: give one")
        if np.any(clear >= self.most(grid)):
            raise InputError(
                f"the clearest voxel takes {clear.max():g} per mm, and the darkest may take {self.most(grid):g}: give "
                "less of the one or more of the other"
            )
        return np.broadcast_to(clear, colours).astype(np.float64)

    def of_any_size(self, grid: Grid) -> Material:
        """The same bounds, which are those of a grid's voxels, for voxels of any size: what smaller cubes are of."""
        if self.dyes is not None:
            return replace(self, dyes=self.dyes.in_block(grid))
        return Material(self.most(grid), clear=self.clear)
