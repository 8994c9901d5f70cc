"""The matrix A: how much of each voxel each beam runs through."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.optics.grid import Grid
from lightcube.optics.views import Views

if TYPE_CHECKING:
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import LinearOperator

Floats = NDArray[np.floating[Any]]


class Projector:
    """Lengths (mm) of the views' beams in the grid's voxels, as a linear operator ``B = A X``.

    ``forward`` and ``adjoint`` act on blocks of columns, ``X`` of shape ``(A.shape[1], columns)`` and ``B`` of shape
    ``(A.shape[0], columns)``; columns are independent of each other. With level beams, one picture row per slice,
    `level` is True, ``A.shape`` is ``(views * picture columns, ny * nx)`` and the columns are all slices and colours;
    else it is ``(views * picture columns * picture rows, ny * nx * nz)`` and the columns are the colours. Either way
    the numbers lie in memory as `lightcube.kernels.layout` puts them:
    ``columns_from_volume(v).reshape(A.shape[1], -1)``.

    Parameters
    ----------
    grid
        The voxels.
    views
        Lamps and screens. A parallel lamp's beam is the whole line through its pixel (it casts the same picture on
        every parallel screen), a point lamp's the stretch from the lamp to the pixel.
    heard
        ``(views, rows, columns)`` bool: pixels that do not count may be left out, for speed; a matrix that does so
        has empty rows there. None = all count.

    Notes
    -----
    Parallel light on vertical screens whose rows are one voxel apart, a turntable's, has beams that are copies of
    each other and a quicker way to be multiplied (`lightcube.projection.stacked`); all else goes ray by ray
    (`lightcube.projection.rays`). Lengths are traced anew in every product (Siddon, see `lightcube.kernels.beam`).
    Beams along voxel faces follow the tie rule of docs/conventions.md.
    """

    def __init__(self, grid: Grid, views: Views, heard: NDArray[np.bool_] | None = None) -> None:
        from lightcube.projection.rays import Rays  # here: the compiler comes with them
        from lightcube.projection.stacked import StackedBeams, is_stacked

        self.grid, self.views = grid, views
        if heard is not None and heard.shape != (len(views), *views.picture_shape):
            raise InputError(f"which pixels count has shape {heard.shape}, not {(len(views), *views.picture_shape)}")
        self._engine = StackedBeams(grid, views) if is_stacked(grid, views) else Rays(grid, views, heard)
        self.shape, self.level = self._engine.shape, self._engine.level

    def __repr__(self) -> str:
        return f"<projector {self.shape[0]} x {self.shape[1]}, {self.grid}, {self.views}>"

    @property
    def view_of_row(self) -> NDArray[np.intp]:
        """The view that each row of the matrix belongs to."""
        return np.repeat(np.arange(len(self.views)), self.shape[0] // len(self.views))

    def forward(self, x: Floats) -> Floats:
        """``A @ x``: `x` is ``(A.shape[1], columns)`` float32 or float64, the result has its dtype."""
        return self._engine.forward(self._checked(x, self.shape[1]))

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b``: `b` is ``(A.shape[0], columns)`` float32 or float64, the result has its dtype."""
        return self._engine.adjoint(self._checked(b, self.shape[0]))

    def row(self, index: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the unknowns that equation `index` touches, and its beam's length (mm) in each."""
        if not 0 <= index < self.shape[0]:
            raise InputError(f"row {index} is not in the matrix of {self.shape[0]} rows")
        return self._engine.row(index)

    def to_sparse(self) -> "csr_array":
        """Return the same matrix, float64."""
        return self._engine.to_sparse()

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
