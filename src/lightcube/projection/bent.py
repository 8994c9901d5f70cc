"""The matrix of light that glass bends.

Behind an upright side of glass all beams of a picture column are the same beam, moved up by whole slices, as in
straight light (`lightcube.projection.stacked`): they are traced once. Others, those through the top and bottom of a
block and those of a sphere, go ray by ray (`lightcube.projection.rays`).
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.glass import columns
from lightcube.optics.arrays import Flags, Floats, Reals
from lightcube.optics.grid import Grid
from lightcube.optics.refraction import Bent
from lightcube.optics.views import Views
from lightcube.projection.limits import ROOM
from lightcube.projection.rays import Rays
from lightcube.projection.stacked import StackedBeams, is_stacked

if TYPE_CHECKING:
    from scipy.sparse import csr_array


class BentBeams:
    """Lengths (mm) of bent beams in voxels; see `lightcube.projection.projector.Projector`, whose engine this is."""

    level = False
    parts = 1
    areas = None
    shape: tuple[int, int]

    def __init__(self, grid: Grid, views: Views, heard: Flags | None, bent: Bent, *, room: int = ROOM) -> None:
        lit = bent.through > 0 if heard is None else heard & (bent.through > 0)
        self.grid, self.views = grid, views
        self._lit, self._bent = lit, bent
        self.shape = (lit.size, math.prod(grid.shape))
        together: Flags = np.zeros(lit.shape, np.bool_)
        if is_stacked(grid, views):
            ends = np.zeros((lit.shape[0], lit.shape[2], 6))
            columns(bent.lines_mm / np.tile(grid.sides_mm, 2), lit, views.slices_a_row(grid), ends, together)
            self._stacked = StackedBeams.of_columns(grid, views, ends, together)
        self._any_together = bool(np.any(together))
        alone = lit & ~together
        self._rays = Rays(grid, views, alone, bent, room=room) if np.any(alone) else None
        self._counts = np.ascontiguousarray(together[:, ::-1].swapaxes(1, 2)).reshape(-1, 1)

    @property
    def pieces(self) -> int:
        """Of the rays that go one by one."""
        return 0 if self._rays is None else self._rays.pieces

    @cached_property
    def _all(self) -> Rays:
        """All beams, one by one."""
        return Rays(self.grid, self.views, self._lit, self._bent)

    def forward(self, x: Floats) -> Floats:
        """``A @ x`` of a contiguous block of columns."""
        b = self._rays.forward(x) if self._rays is not None else np.zeros((self.shape[0], x.shape[1]), x.dtype)
        if self._any_together:
            b += self._stacked.forward(x) * self._counts
        return b

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b`` of a contiguous block of columns."""
        x = self._rays.adjoint(b) if self._rays is not None else np.zeros((self.shape[1], b.shape[1]), b.dtype)
        if self._any_together:
            x += self._stacked.adjoint(b * self._counts)
        return x

    def row(self, index: int) -> tuple[NDArray[np.int64], Reals]:
        """Return the unknowns that equation `index` touches, and its beam's length (mm) in each."""
        return self._all.row(index)

    def to_sparse(self) -> csr_array:
        """Return the same matrix, float64."""
        return self._all.to_sparse()
