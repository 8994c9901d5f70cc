"""The matrix A: how much of each voxel each beam runs through."""

import math
from typing import TYPE_CHECKING, Any

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from lightcube.errors import InputError
from lightcube.geometry import PARALLEL, Grid, Views
from lightcube.kernels import projection
from lightcube.kernels.beam import max_pieces
from lightcube.layout import LINE, empty, is_worth_lines

if TYPE_CHECKING:
    from scipy.sparse.linalg import LinearOperator

Floats = NDArray[np.floating[Any]]


class Projector:
    """Lengths (mm) of the views' beams in the grid's voxels, as a linear operator ``B = A X``.

    ``forward`` and ``adjoint`` act on blocks of columns, ``X`` of shape ``(A.shape[1], columns)`` and ``B`` of shape
    ``(A.shape[0], columns)``; columns are independent of each other. With level beams, one picture row per slice,
    ``A.shape`` is ``(views * picture columns, ny * nx)`` and the columns are all slices and colours; else it is
    ``(views * picture columns * picture rows, ny * nx * nz)`` and the columns are the colours. Either way the
    numbers lie in memory as `lightcube.layout` puts them: ``columns_from_volume(v).reshape(A.shape[1], -1)``.

    Parameters
    ----------
    grid
        The voxels.
    views
        Parallel light and vertical screens whose rows are one voxel apart, as `turntable` makes them.

    Raises
    ------
    InputError
        For point lamps, vertical light, and screens in any other position.

    Notes
    -----
    Nothing is stored but a few numbers per view: lengths are traced anew in every product
    (Siddon, see `lightcube.kernels.beam`). Beams along voxel faces follow the tie rule of docs/conventions.md.
    """

    def __init__(self, grid: Grid, views: Views) -> None:
        _check_turntable(grid, views)
        self.grid, self.views = grid, views
        rows, self._width = views.picture_shape
        nz, ny, nx = grid.shape
        side = grid.voxel_mm
        lowest_left = views.origins - (self._width - 1) / 2 * views.column_steps + (rows - 1) / 2 * views.row_steps
        light = views.lamps[:, :3] / np.linalg.norm(views.lamps[:, :3], axis=1, keepdims=True)
        corner = lowest_left / side + (nx / 2, ny / 2, nz / 2)
        self._beams = np.stack([corner, views.column_steps / side, light], axis=1)
        slope = np.max(np.abs(light[:, 2]) / np.hypot(light[:, 0], light[:, 1]))
        self._rise = math.ceil(slope * math.hypot(nx, ny)) + 2
        self._level = bool(slope < PARALLEL and rows == nz and np.allclose(corner[:, 2], 0.5, rtol=0, atol=1e-9))
        self._stacked = 1 if self._level else rows
        self.shape = (len(views) * self._width * self._stacked, ny * nx * (1 if self._level else nz))

    def __repr__(self) -> str:
        return f"<projector {self.shape[0]} x {self.shape[1]}, {self.grid}, {self.views}>"

    @property
    def view_of_row(self) -> NDArray[np.intp]:
        """The view that each row of the matrix belongs to."""
        return np.repeat(np.arange(len(self.views)), self.shape[0] // len(self.views))

    def forward(self, x: Floats) -> Floats:
        """``A @ x``: `x` is ``(A.shape[1], columns)`` float32 or float64, the result has its dtype."""
        x = self._checked(x, self.shape[1])
        channels = x.shape[1]
        b = empty((self.shape[0] // self._stacked, self._stacked * channels), x.dtype)
        rows = x.reshape(self._voxels, -1)
        if len(b) >= len(rows):  # else it does not pay
            rows = self._in_lines(rows)
        projection.forward(self._beams, self._width, *self._plane(), rows, b, channels, _tasks())
        return b.reshape(self.shape[0], channels)

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b``: `b` is ``(A.shape[0], columns)`` float32 or float64, the result has its dtype."""
        b = self._checked(b, self.shape[0])
        channels = b.shape[1]
        x = empty((self._voxels, self.shape[1] // self._voxels * channels), b.dtype)
        rows = self._in_lines(b.reshape(-1, self._stacked * channels))
        projection.adjoint(self._beams, self._width, *self._plane(), rows, x, channels, _tasks())
        return x.reshape(self.shape[1], channels)

    def row(self, index: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the unknowns that equation `index` touches, and its beam's length (mm) in each."""
        if not 0 <= index < self.shape[0]:
            raise InputError(f"row {index} is not in the matrix of {self.shape[0]} rows")
        ray, lift = divmod(index, self._stacked)
        nx, ny, scale = self._plane()
        most = max_pieces(nx, ny, self._rise) + 1
        voxels, levels, lengths = np.empty(most, np.int32), np.empty(most, np.int32), np.empty(most)
        count = projection.trace_column(self._beams, self._width, ray, nx, ny, scale, voxels, levels, lengths)
        unknowns, inside = self._unknowns(voxels[:count], levels[:count] + lift)
        return unknowns[inside], lengths[:count][inside]

    def to_sparse(self) -> csr_array:
        """Return the same matrix, float64."""
        rays = self.shape[0] // self._stacked
        offsets = np.zeros(rays + 1, np.int64)
        none = np.empty(0, np.int32)
        projection.trace_all(self._beams, self._width, *self._plane(), self._rise, offsets, none, none, np.empty(0))
        voxels, levels = np.empty(offsets[-1], np.int32), np.empty(offsets[-1], np.int32)
        lengths = np.empty(offsets[-1])
        projection.trace_all(self._beams, self._width, *self._plane(), self._rise, offsets, voxels, levels, lengths)
        ray = np.repeat(np.arange(rays), np.diff(offsets))
        lift = np.arange(self._stacked)[:, None]
        unknowns, inside = self._unknowns(voxels, levels + lift)
        equations = ray * self._stacked + lift
        shape = unknowns.shape
        entries = (np.broadcast_to(lengths, shape)[inside], (equations[inside], unknowns[inside]))
        return csr_array(entries, shape=self.shape)

    def as_linear_operator(self, dtype: type[np.floating[Any]] = np.float64) -> "LinearOperator[Any]":
        """Return the matrix as scipy's iterative solvers want it."""
        from scipy.sparse.linalg import LinearOperator

        return LinearOperator(
            self.shape,
            matvec=lambda x: self.forward(np.asarray(x, dtype).reshape(-1, 1)),
            rmatvec=lambda b: self.adjoint(np.asarray(b, dtype).reshape(-1, 1)),
            matmat=lambda x: self.forward(np.asarray(x, dtype)),
            rmatmat=lambda b: self.adjoint(np.asarray(b, dtype)),
            dtype=dtype,
        )

    @property
    def _voxels(self) -> int:
        return self.grid.shape[1] * self.grid.shape[2]

    def _in_lines(self, rows: Floats) -> Floats:
        """Rows that each begin at a whole cache line, longer ones if need be: they are quicker to add up.

        With a raised lamp parts of rows are added up, from anywhere on.
        """
        size = rows.shape[1] * rows.itemsize
        if not (self._level and is_worth_lines(size)):
            return rows
        length = -(-size // LINE) * LINE // rows.itemsize
        longer = empty((len(rows), length), rows.dtype)
        projection.copy_rows(rows, longer)
        return longer

    def _plane(self) -> tuple[int, int, float]:
        """What the kernels want to know of the grid: nx, ny, voxel side."""
        return self.grid.shape[2], self.grid.shape[1], self.grid.voxel_mm

    def _unknowns(
        self, voxels: NDArray[np.int32], levels: NDArray[np.integer[Any]]
    ) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Numbers of the unknowns for pieces ``(voxel, level)``, and which of them are inside the grid."""
        if self._level:
            return np.broadcast_to(voxels.astype(np.int64), levels.shape), np.ones(levels.shape, np.bool_)
        nz = self.grid.shape[0]
        return voxels.astype(np.int64) * nz + levels, (levels >= 0) & (levels < nz)

    def _checked(self, array: Floats, rows: int) -> Floats:
        if array.ndim != 2 or array.shape[0] != rows or array.shape[1] == 0:
            raise InputError(f"a block of columns for this matrix has shape ({rows}, columns), not {array.shape}")
        if array.dtype not in (np.float32, np.float64):
            raise InputError(f"a block of columns must be float32 or float64, not {array.dtype}")
        return np.ascontiguousarray(array)


def dot_test(operator: Any, columns: int = 3, dtype: type[np.floating[Any]] = np.float64, seed: int = 0) -> float:
    """``|<A x, b> - <x, A.T b>|`` relative to ``|A x| |b|`` for random blocks of non-negative columns.

    `operator` has ``shape``, ``forward`` and ``adjoint``. An exact transpose gives rounding only: below 1e-5 for
    float32 and 1e-12 for float64.
    """
    random = np.random.default_rng(seed)
    x = random.random((operator.shape[1], columns)).astype(dtype)
    b = random.random((operator.shape[0], columns)).astype(dtype)
    ax, atb = operator.forward(x), operator.adjoint(b)
    difference = np.vdot(ax.astype(np.float64), b) - np.vdot(x.astype(np.float64), atb)
    return float(abs(difference) / (np.linalg.norm(ax) * np.linalg.norm(b)))


def _tasks() -> int:
    """Parts that a product is divided into at least: more than threads, for they are not all equally long."""
    return int(4 * numba.get_num_threads())


def _check_turntable(grid: Grid, views: Views) -> None:
    if np.any(views.lamps[:, 3] != 0):
        raise InputError("this projector casts parallel light only: give every lamp as a direction (x, y, z, 0)")
    tolerance = 1e-9 * grid.voxel_mm
    if not np.allclose(views.row_steps, (0, 0, -grid.voxel_mm), rtol=0, atol=tolerance):
        raise InputError(f"the screen's rows must be one voxel ({grid.voxel_mm:g} mm) apart, straight down")
    if np.any(np.abs(views.column_steps[:, 2]) > tolerance):
        raise InputError("the screen's columns must lie on a horizontal line")
    if np.any(np.abs(views.elevations) > 89.999):
        raise InputError("vertical light casts no shadow on a vertical screen: use an elevation below 90 degrees")
