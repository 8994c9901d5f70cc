"""The matrix of parallel light on vertical screens whose rows are one slice apart, or whole ones: a turntable's.

All beams of a picture column are the same beam, moved up by whole slices: one traversal serves them all.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import stacked
from lightcube.kernels.layout import LINE, empty, is_worth_lines
from lightcube.kernels.ray import MOST_PARTS, most_pieces
from lightcube.kernels.tasks import threads
from lightcube.optics.arrays import Flags, Reals
from lightcube.optics.grid import PARALLEL, Grid
from lightcube.optics.views import Views

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Floats = NDArray[np.floating[Any]]


def is_stacked(grid: Grid, views: Views) -> bool:
    """Whether light is parallel and not vertical, and each screen vertical with rows whole slices apart."""
    return bool(
        np.all(views.lamps[:, 3] == 0)
        and views.slices_a_row(grid)
        and np.all(np.abs(views.column_steps_mm[:, 2]) <= 1e-9 * grid.voxel_mm)
        and np.all(np.abs(views.elevations_deg) <= 89.999)
    )


class StackedBeams:
    """Lengths (mm) of beams in voxels; see `lightcube.projection.projector.Projector`, whose engine this is.

    Where beams are level, and each slice has a row of pixels of its own, `level` is True and the matrix is that of
    one slice. Where rows are several slices apart products take and make a copy of the unknowns, sorted by
    `lightcube.kernels.stacked.by_class`. Nothing is stored but a few numbers per view: lengths are traced anew in
    every product.
    """

    grid: Grid
    beams: NDArray[np.float64]
    rise: int
    level: bool
    parts = 1
    pieces = 0
    areas = None
    shape: tuple[int, int]

    def __init__(self, grid: Grid, views: Views, heard: Flags | None = None) -> None:
        self.grid = grid
        rows, self._width = views.picture_shape
        nz, ny, nx = grid.shape
        sides_mm = grid.sides_mm
        lowest_left = (
            views.origins_mm - (self._width - 1) / 2 * views.column_steps_mm + (rows - 1) / 2 * views.row_steps_mm
        )
        light = views.lamps[:, :3] / np.linalg.norm(views.lamps[:, :3], axis=1, keepdims=True)
        light = light * (grid.voxel_mm / sides_mm)  # in voxels a voxel's width of the way
        corner = lowest_left / sides_mm + (nx / 2, ny / 2, nz / 2)
        ends = np.tile([-np.inf, np.inf, 0.0], (len(views), 1))
        self.beams = np.stack([corner, views.column_steps_mm / sides_mm, light, ends], axis=1)
        slope = np.max(np.abs(light[:, 2]) / np.hypot(light[:, 0], light[:, 1]))
        self.rise = math.ceil(slope * math.hypot(nx, ny)) + 2
        self._apart = views.slices_a_row(grid)
        own_rows = self._apart == 1 and rows == nz
        self.level = bool(slope < PARALLEL and own_rows and np.allclose(corner[:, 2], 0.5, rtol=0, atol=1e-9))
        self._stacked = 1 if self.level else rows
        self._windows = _windows(np.ones((len(views), rows, self._width), bool) if heard is None else heard)
        self.shape = (len(views) * self._width * self._stacked, ny * nx * (1 if self.level else nz))

    @classmethod
    def of_columns(cls, grid: Grid, views: Views, pieces: Reals, heard: Flags) -> StackedBeams:
        """Those of views whose picture columns have a beam each, which runs from somewhere to somewhere.

        Parameters
        ----------
        pieces
            ``(views, columns, 6)``: two ends of each column's beam for the lowest row, from the middle, in voxels.
        heard
            ``(views, rows, columns)``: the pixels that count; others may have a beam too.
        """
        made = cls(grid, views, heard)
        views_count, rows, width = heard.shape
        ways = (pieces[..., 3:] - pieces[..., :3]).reshape(-1, 3)
        lengths = np.linalg.norm(ways * (1.0, 1.0, grid.tall), axis=1, keepdims=True)
        used = np.any(heard, axis=1).reshape(-1)
        light = np.where(used[:, None], ways / np.where(lengths > 0, lengths, 1.0), (1.0, 0.0, 0.0))
        ends = np.hstack([np.zeros_like(lengths), lengths, np.zeros_like(lengths)])
        middle = np.array(grid.shape[::-1]) / 2
        made.beams = np.stack([pieces.reshape(-1, 6)[:, :3] + middle, np.zeros_like(light), light, ends], axis=1)
        made._width, made.level, made._stacked = 1, False, rows
        made.rise = (
            math.ceil(np.max(np.abs(light[:, 2]) / np.hypot(light[:, 0], light[:, 1])) * math.hypot(*grid.shape[1:]))
            + 2
        )
        inside = np.flatnonzero(np.any(heard, axis=(0, 2))[::-1])
        low, high = (int(inside[0]), int(inside[-1]) + 1) if len(inside) else (0, 0)
        made._windows = np.tile(np.array([0, 1, low, high], np.int64), (views_count * width, 1))
        made._windows[~used, 1] = 0
        made.shape = (views_count * width * rows, int(np.prod(grid.shape)))
        return made

    def forward(self, x: Floats) -> Floats:
        """``A @ x`` of a contiguous block of columns."""
        channels = x.shape[1]
        b = empty((self.shape[0] // self._stacked, self._stacked * channels), x.dtype)
        rows = x.reshape(self._voxels, -1)
        if self._apart > 1:
            rows = self._classes(channels, x.dtype)
            stacked.by_class(x.reshape(self._voxels, -1), rows, self.grid.shape[0], self._apart)
        elif len(b) >= len(rows):  # else it does not pay
            rows = self._in_lines(rows)
        how = channels, self._apart, _tasks()
        stacked.forward(self.beams, self._heard(channels), self._width, *self._plane(), rows, b, *how)
        return b.reshape(self.shape[0], channels)

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b`` of a contiguous block of columns."""
        channels = b.shape[1]
        x = empty((self._voxels, self.shape[1] // self._voxels * channels), b.dtype)
        rows = self._in_lines(b.reshape(-1, self._stacked * channels))
        target = x if self._apart == 1 else self._classes(channels, b.dtype)
        how = channels, self._apart, _tasks()
        stacked.adjoint(self.beams, self._heard(channels), self._width, *self._plane(), rows, target, *how)
        if self._apart > 1:
            stacked.from_classes(target, x, self.grid.shape[0], self._apart)
        return x.reshape(self.shape[1], channels)

    def row(self, index: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the unknowns that equation `index` touches, and its beam's length (mm) in each."""
        ray, lift = divmod(index, self._stacked)
        first, after, low, high = self._heard(1)[ray // self._width]
        if not (first <= ray % self._width < after and low <= lift < high):
            return np.empty(0, np.int64), np.empty(0)
        nx, ny, scale = self._plane()
        most = MOST_PARTS * most_pieces(nx, ny, self.rise)
        voxels, levels, lengths = np.empty(most, np.int32), np.empty(most, np.int32), np.empty(most)
        count = stacked.trace_column(self.beams, self._width, ray, nx, ny, scale, voxels, levels, lengths)
        unknowns, inside = self._unknowns(voxels[:count], levels[:count] + lift * self._apart)
        return unknowns[inside], lengths[:count][inside]

    def to_sparse(self) -> csr_array:
        """Return the same matrix, float64."""
        from scipy.sparse import csr_array  # here: it takes longer to load than a small cube to play

        rays = self.shape[0] // self._stacked
        offsets = np.zeros(rays + 1, np.int64)
        none = np.empty(0, np.int32)
        stacked.trace_all(self.beams, self._width, *self._plane(), self.rise, offsets, none, none, np.empty(0))
        voxels, levels = np.empty(offsets[-1], np.int32), np.empty(offsets[-1], np.int32)
        lengths = np.empty(offsets[-1])
        stacked.trace_all(self.beams, self._width, *self._plane(), self.rise, offsets, voxels, levels, lengths)
        ray = np.repeat(np.arange(rays), np.diff(offsets))
        lift = np.arange(self._stacked)[:, None]
        unknowns, inside = self._unknowns(voxels, levels + lift * self._apart)
        first, after, low, high = self._heard(1)[ray // self._width].T
        inside &= (first <= ray % self._width) & (ray % self._width < after) & (low <= lift) & (lift < high)
        equations = ray * self._stacked + lift
        shape = unknowns.shape
        entries = (np.broadcast_to(lengths, shape)[inside], (equations[inside], unknowns[inside]))
        return csr_array(entries, shape=self.shape)

    def _heard(self, channels: int) -> NDArray[np.int64]:
        """``(view, 4)``: beams first to before last, and rows of them, so many numbers each, that count.

        Where beams are level, what is multiplied may be of some slices only, and all of it counts.
        """
        windows = self._windows.copy()
        if self.level:
            windows[:, 2:] = 0, 1
        windows[:, 2:] *= channels
        return windows

    @property
    def _voxels(self) -> int:
        return self.grid.shape[1] * self.grid.shape[2]

    def _classes(self, channels: int, dtype: np.dtype[Any]) -> Floats:
        """Room for the unknowns, their slices sorted by class."""
        return empty((self._voxels * self._apart, -(-self.grid.shape[0] // self._apart) * channels), dtype)

    def _in_lines(self, rows: Floats) -> Floats:
        """Rows that each begin at a whole cache line, longer ones if need be: they are quicker to add up.

        With a raised lamp parts of rows are added up, from anywhere on.
        """
        size = rows.shape[1] * rows.itemsize
        if not (self.level and is_worth_lines(size)):
            return rows
        length = -(-size // LINE) * LINE // rows.itemsize
        longer = empty((len(rows), length), rows.dtype)
        stacked.copy_rows(rows, longer)
        return longer

    def _plane(self) -> tuple[int, int, float]:
        """What the kernels want to know of the grid: nx, ny, and a voxel's width."""
        return self.grid.shape[2], self.grid.shape[1], self.grid.voxel_mm

    def _unknowns(
        self, voxels: NDArray[np.int32], levels: NDArray[np.integer[Any]]
    ) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Numbers of the unknowns for pieces ``(voxel, level)``, and which of them are inside the grid."""
        if self.level:
            return np.broadcast_to(voxels.astype(np.int64), levels.shape), np.ones(levels.shape, np.bool_)
        nz = self.grid.shape[0]
        return voxels.astype(np.int64) * nz + levels, (levels >= 0) & (levels < nz)


def _windows(heard: Flags) -> NDArray[np.int64]:
    """``(view, 4)``: first column and one after the last, first row from below and one after the last, that count."""
    columns, rows = np.any(heard, axis=1), np.any(heard, axis=2)[:, ::-1]
    ends = [(np.argmax(each, axis=1), each.shape[1] - np.argmax(each[:, ::-1], axis=1)) for each in (columns, rows)]
    windows = np.stack([*ends[0], *ends[1]], axis=1)
    windows[~np.any(columns, axis=1)] = 0
    return windows.astype(np.int64)


def _tasks() -> int:
    """Parts that a product is divided into at least: more than threads, for they are not all equally long."""
    return 4 * threads()
