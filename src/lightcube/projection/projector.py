"""The matrix A: how much of each voxel each beam runs through."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import DTypeLike, NDArray

from lightcube.errors import InputError
from lightcube.kernels.layout import (
    as_writable,
    columns_from_pictures,
    columns_from_volume,
    empty,
    pictures_from_columns,
    volume_from_columns,
)
from lightcube.optics.arrays import Counts, Flags, Floats, Reals, as_numbers
from lightcube.optics.checks import checked
from lightcube.optics.grid import Grid
from lightcube.optics.refraction import bent
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.optics.views import Views, check_reach
from lightcube.projection.limits import ROOM

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from lightcube.projection.linear_operator import MatrixOperator

#: Of a dot test, which needs few.
_MOST_COLUMNS = 1000


class Engine(Protocol):
    """What multiplies by a matrix, of which `shape`, `level`, `parts` and `areas` are as a `Projector`'s."""

    level: bool
    parts: int

    @property
    def pieces(self) -> int:
        """How many pieces of rays that go one by one there are; of beams that go together 0."""

    @property
    def areas(self) -> Floats | None:
        """Of rectangles, the part of its pixel's area that each has."""

    @property
    def shape(self) -> tuple[int, int]:
        """``(equations, unknowns)`` of a column."""

    def forward(self, x: Floats) -> Floats:
        """``A @ x`` of a contiguous block of columns."""

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b`` of a contiguous block of columns."""

    def row(self, index: int) -> tuple[NDArray[np.int64], Reals]:
        """The unknowns of an equation, and its beam's length (mm) in each."""

    def to_sparse(self) -> csr_array:
        """The same matrix, float64."""


class Projector:
    """Lengths (mm) of the views' beams in the grid's voxels, as a linear operator A.

    ``A(volume)`` casts a volume of extinction (1/mm): the result are pictures of absorbance, what the beams lose.
    ``A.T(pictures)`` is the transpose, each picture thrown back along its beams. Volumes have shape ``A.domain_shape``,
    ``(z, y, x)``, or ``(channel, z, y, x)``; pictures have shape ``A.range_shape``, ``(view, row, column)``, or
    ``(view, row, column, channel)``. Channels, as many as one likes, do not touch each other; where what is given has
    no channel axis, the result has none.

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
    room
        Bytes that pieces of rays which go one by one may take. Who multiplies by the transpose, in float32, mostly goes
        on by turns: where they fit, all pieces are kept from then on, and where not, each product finds them anew. It
        decides how long products take, and not a bit of them.

    Attributes
    ----------
    domain_shape
        ``(nz, ny, nx)``, the grid's.
    range_shape
        ``(views, rows, columns)`` of the pictures.
    shape
        ``(equations, unknowns)`` of the matrix, for columns (below).
    level
        Whether beams are level and each slice has a row of pixels of its own.

    Notes
    -----
    Solvers want columns instead: ``A @ x``, ``A.forward`` and ``A.adjoint`` act on blocks of them, ``x`` of shape
    ``(A.shape[1], columns)`` and ``b`` of shape ``(A.shape[0], columns)``, columns being independent of each other.
    Where `level` is True, ``A.shape`` is ``(views * picture columns, ny * nx)`` and the columns are all slices and
    colours; else it is ``(views * picture columns * picture rows, ny * nx * nz)`` and the columns are the colours.
    Either way the numbers lie in memory as `lightcube.kernels.layout` puts them:
    ``columns_from_volume(volume).reshape(A.shape[1], -1)`` and
    ``columns_from_pictures(pictures).reshape(A.shape[0], -1)``.

    Parallel light on vertical screens whose rows are one voxel apart, a turntable's, has beams that are copies of
    each other and a quicker way to be multiplied (`lightcube.projection.stacked`); all else goes ray by ray
    (`lightcube.projection.rays`). Lengths are traced anew in every product (Siddon, see `lightcube.kernels.ray`).
    Beams along voxel faces follow the tie rule of docs/conventions.md.

    Examples
    --------
    A layer of extinction at the bottom of a clear block of 1 x 1.5 x 2 mm. Turned by 30 degrees, the beam through the
    middle is longer in it, and those beside it cut its corners:

    >>> import numpy as np
    >>> import lightcube as lc
    >>> grid = lc.Grid((2, 3, 4), voxel_mm=0.5)
    >>> A = lc.Projector(grid, lc.turntable(grid, [0, 30], picture_shape=(2, 3)))
    >>> volume = np.zeros(A.domain_shape)
    >>> volume[0] = 1.0
    >>> A(volume)[:, 1]  # the pictures' lower row
    array([[2.    , 2.    , 2.    ],
           [1.5   , 2.3094, 1.5   ]])
    >>> A.T(A(volume)).shape, A.T.T is A
    ((2, 3, 4), True)

    The same by columns, of which level light has one for each slice here:

    >>> from lightcube.kernels.layout import columns_from_volume
    >>> x = columns_from_volume(volume[None]).reshape(A.shape[1], -1)
    >>> A.shape, x.shape, (A @ x).shape
    ((6, 12), (12, 2), (6, 2))
    """

    grid: Grid
    views: Views
    domain_shape: tuple[int, int, int]
    range_shape: tuple[int, int, int]
    shape: tuple[int, int]
    level: bool

    @checked
    def __init__(self, grid: Grid, rig: Rig | Views, heard: Flags | None = None, *, room: int = ROOM) -> None:
        views = rig if isinstance(rig, Views) else rig.views
        check_reach(views, grid)
        self.grid, self.views = grid, views
        heard = None if heard is None else np.asarray(heard, np.bool_)
        if heard is not None and heard.shape != (len(views), *views.picture_shape):
            raise InputError(f"which pixels count has shape {heard.shape}, not {(len(views), *views.picture_shape)}")
        self._engine = _engine(grid, rig, heard, room)
        self.shape, self.level = self._engine.shape, self._engine.level
        self.domain_shape, self.range_shape = grid.shape, (self.parts * len(views), *views.picture_shape)

    def __repr__(self) -> str:
        return f"<projector of {' x '.join(map(str, self.domain_shape))} voxels, {self.views}>"

    def __call__(self, volume: Floats) -> Floats:
        """Cast a volume: the absorbance ``(view, row, column, channel)`` of extinction ``(channel, z, y, x)``.

        Parameters
        ----------
        volume
            ``(channel, nz, ny, nx)``, or ``(nz, ny, nx)`` for pictures without a channel axis; float32 or float64,
            any numbers. It is not written to.

        Returns
        -------
        New pictures in the dtype of `volume`: ``sum_v l_v x_v`` over the voxels v of each beam, l their lengths (mm).

        Raises
        ------
        InputError
            Where `volume` has another shape or dtype.
        """
        volume = _array(volume, "a volume for this matrix")
        if volume.ndim not in (3, 4) or volume.shape[-3:] != self.domain_shape or volume.size == 0:
            nz, ny, nx = self.domain_shape
            raise InputError(
                f"a volume for this matrix has shape ({nz}, {ny}, {nx}) or (channels, {nz}, {ny}, {nx}), not "
                f"{volume.shape}: A @ x takes columns, and volume_from_columns(x, A.domain_shape, channels) of "
                "lightcube.kernels.layout makes a volume of them"
            )
        channels = volume.reshape(-1, *self.domain_shape)
        b = self.forward(columns_from_volume(channels).reshape(self.shape[1], -1))
        pictures = pictures_from_columns(b, self.views.picture_shape, len(channels))
        return pictures if volume.ndim == 4 else pictures[..., 0]

    @cached_property
    def T(self) -> Transpose:  # noqa: N802 - what numpy calls it
        """The transpose: ``A.T(pictures)`` is a volume. ``A.T.T is A``."""
        return Transpose(self)

    def __matmul__(self, x: Floats) -> Floats:
        """``A @ x`` of a vector ``(A.shape[1],)`` or a block ``(A.shape[1], columns)``, as numpy shapes it."""
        return _product(self.forward, x)

    @property
    def parts(self) -> int:
        """How many beams each pixel of a view has, which follow each other: 1, or so many rectangles."""
        return self._engine.parts

    @property
    def areas(self) -> Floats | None:
        """``(views * parts, columns * rows)``: the part of its pixel's area that each rectangle has; None of beams."""
        return self._engine.areas

    @property
    def pieces(self) -> int:
        """Pieces of rays that go one by one: voxels that each runs through."""
        return self._engine.pieces

    @property
    def view_of_row(self) -> Counts:
        """The view that each row of the matrix belongs to."""
        return np.repeat(np.arange(len(self.views)), self.shape[0] // len(self.views))

    def forward(self, x: Floats) -> Floats:
        """``A @ x``: `x` is ``(A.shape[1], columns)`` float32 or float64, the result has its dtype."""
        hint = (
            "A(volume) takes a volume, and columns_from_volume(volume).reshape(A.shape[1], -1) of "
            "lightcube.kernels.layout makes columns of one (channel, z, y, x)"
        )
        return _multiplied(self._engine.forward, x, self.shape, hint)

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b``: `b` is ``(A.shape[0], columns)`` float32 or float64, the result has its dtype."""
        hint = (
            "A.T(pictures) takes pictures, and columns_from_pictures(pictures).reshape(A.shape[0], -1) of "
            "lightcube.kernels.layout makes columns of them (view, row, column, channel)"
        )
        return _multiplied(self._engine.adjoint, b, self.shape[::-1], hint)

    @checked
    def row(self, index: int) -> tuple[NDArray[np.int64], Reals]:
        """Return the unknowns that equation `index` touches, and its beam's length (mm) in each."""
        if not 0 <= index < self.shape[0]:
            raise InputError(f"row {index} is not in the matrix of {self.shape[0]} rows: count from 0")
        return self._engine.row(index)

    def to_sparse(self) -> csr_array:
        """Return the same matrix, float64."""
        return self._engine.to_sparse()

    def as_linear_operator(self, dtype: DTypeLike = np.float64) -> MatrixOperator:
        """Return the matrix as scipy's iterative solvers want it: a ``LinearOperator`` that can be pickled.

        Raises
        ------
        InputError
            Where `dtype` is neither float32 nor float64; and in its products, where they are with complex numbers.
        """
        from lightcube.projection.linear_operator import MatrixOperator

        return MatrixOperator(self, _precision(dtype))


class Transpose:
    """The transpose of a `Projector`, ``A.T``: all that the projector is, the other way round.

    Attributes
    ----------
    T
        The projector itself.
    domain_shape
        ``(views, rows, columns)`` of the pictures that are thrown back.
    range_shape
        ``(nz, ny, nx)``.
    shape
        ``(unknowns, equations)``, for columns.
    """

    T: Projector
    shape: tuple[int, int]
    domain_shape: tuple[int, int, int]
    range_shape: tuple[int, int, int]

    def __init__(self, projector: Projector) -> None:
        self.T = projector
        self.shape = projector.shape[::-1]
        self.domain_shape, self.range_shape = projector.range_shape, projector.domain_shape

    def __repr__(self) -> str:
        return f"<transpose of {self.T}>"

    def __call__(self, pictures: Floats) -> Floats:
        """Throw pictures ``(view, row, column, channel)`` back along their beams: a volume ``(channel, z, y, x)``.

        Parameters
        ----------
        pictures
            ``(views, rows, columns, channel)``, or ``(views, rows, columns)`` for a volume without a channel axis;
            float32 or float64, any numbers. It is not written to.

        Returns
        -------
        A new volume in the dtype of `pictures`: ``sum_i l_i b_i`` over the beams i of each voxel, l their lengths (mm).

        Raises
        ------
        InputError
            Where `pictures` have another shape or dtype.
        """
        pictures = _array(pictures, "pictures for this matrix")
        if pictures.ndim not in (3, 4) or pictures.shape[:3] != self.domain_shape or pictures.size == 0:
            views, rows, columns = self.domain_shape
            raise InputError(
                f"pictures for this matrix have shape ({views}, {rows}, {columns}) or ({views}, {rows}, {columns}, "
                f"channels), not {pictures.shape}: A.T @ b takes columns, and pictures_from_columns(b, "
                "A.range_shape[1:], channels) of lightcube.kernels.layout makes pictures of them"
            )
        channels = pictures.reshape(*self.domain_shape, -1)
        x = self.forward(columns_from_pictures(channels).reshape(self.shape[1], -1))
        volume = volume_from_columns(x, self.range_shape, channels.shape[3])
        return volume if pictures.ndim == 4 else volume[0]

    def __matmul__(self, b: Floats) -> Floats:
        """``A.T @ b`` of a vector ``(A.shape[0],)`` or a block ``(A.shape[0], columns)``, as numpy shapes it."""
        return _product(self.forward, b)

    def forward(self, b: Floats) -> Floats:
        """``A.T @ b``, the projector's `adjoint`."""
        return self.T.adjoint(b)

    def adjoint(self, x: Floats) -> Floats:
        """``A @ x``, the projector's `forward`."""
        return self.T.forward(x)

    def to_sparse(self) -> csr_array:
        """Return the same matrix, float64."""
        return self.T.to_sparse().T.tocsr()


def _engine(grid: Grid, rig: Rig | Views, heard: Flags | None, room: int) -> Engine:
    """What multiplies by the matrix of a block: the quickest there is."""
    if isinstance(grid, Stack):
        from lightcube.projection.films import Middles, Rectangles  # here: the compiler comes with them

        lit = Rig.of(rig, np.zeros(len(rig))) if isinstance(rig, Views) else rig
        return Rectangles(grid, lit) if np.any(lit.sums.square) else Middles(grid, lit)
    from lightcube.projection.bent import BentBeams
    from lightcube.projection.rays import Rays
    from lightcube.projection.stacked import StackedBeams, is_stacked

    if isinstance(rig, Rig) and rig.glass is not None:
        return BentBeams(grid, rig.views, heard, bent(rig), room=room)
    views = rig if isinstance(rig, Views) else rig.views
    return StackedBeams(grid, views, heard) if is_stacked(grid, views) else Rays(grid, views, heard, room=room)


def _product(multiply: Callable[[Floats], Floats], x: Floats) -> Floats:
    """What ``@`` gives for a vector or a block of columns."""
    if not isinstance(x, np.ndarray):
        return NotImplemented
    return multiply(x[:, None])[:, 0] if x.ndim == 1 else multiply(x)


def _multiplied(multiply: Callable[[Floats], Floats], block: Floats, shape: tuple[int, int], hint: str) -> Floats:
    """The product of a matrix of that `shape` with a block of columns, of which there may be none."""
    block = _array(block, "a block of columns for this matrix")
    if block.ndim != 2 or block.shape[0] != shape[1]:
        raise InputError(
            f"a block of columns for this matrix has shape ({shape[1]}, columns), not {block.shape}: {hint}"
        )
    _checked(block.dtype)
    if block.shape[1] == 0:
        return empty((shape[0], 0), block.dtype)
    return multiply(as_writable(np.ascontiguousarray(block)))


def _array(given: Floats, what: str) -> Floats:
    """What a product is taken of: an array as it is, and what becomes one."""
    return given if isinstance(given, np.ndarray) else as_numbers(given, what)


def _precision(dtype: DTypeLike) -> np.dtype[Any]:
    """A dtype that there are products of, from one of its names."""
    try:
        found = np.dtype(object if dtype is None else dtype)
    except (TypeError, ValueError) as error:
        raise InputError(f"the matrix multiplies numbers that are float32 or float64, not {dtype!r}") from error
    return _checked(found)


def _checked(dtype: np.dtype[Any]) -> np.dtype[Any]:
    """The same dtype, or `InputError` where there are no products of it."""
    if dtype not in (np.float32, np.float64):
        raise InputError(f"the matrix multiplies numbers that are float32 or float64, not {dtype}")
    return dtype


class Multiplies(Protocol):
    """What `dot_test` asks of a matrix: its shape, and its products with blocks of columns."""

    @property
    def shape(self) -> tuple[int, int]:
        """``(equations, unknowns)``."""

    def forward(self, x: Floats) -> Floats:
        """``A @ x`` of ``(unknowns, columns)``."""

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b`` of ``(equations, columns)``."""


@checked
def dot_test(operator: Multiplies, columns: int = 3, dtype: DTypeLike = "float64", seed: int = 0) -> float:
    """``|<A x, b> - <x, A.T b>|`` relative to ``|A x| |b|`` for random blocks of non-negative columns.

    `operator` has ``shape``, ``forward`` and ``adjoint``: a `Projector`, its transpose, or one of your own. An exact
    transpose gives rounding only: below 1e-5 for float32 and 1e-12 for float64.

    Examples
    --------
    >>> import lightcube as lc
    >>> grid = lc.Grid((3, 5, 7))
    >>> A = lc.Projector(grid, lc.turntable(grid, [13, 77], elevation_deg=20))
    >>> lc.dot_test(A) < 1e-12
    True
    """
    if not 1 <= columns <= _MOST_COLUMNS or seed < 0:
        raise InputError(
            f"a dot test takes 1 to {_MOST_COLUMNS} columns and a seed of at least 0, not {columns} and {seed}"
        )
    dtype, random = _precision(dtype), np.random.default_rng(seed)
    x = random.random((operator.shape[1], columns)).astype(dtype)
    b = random.random((operator.shape[0], columns)).astype(dtype)
    ax, atb = operator.forward(x), operator.adjoint(b)
    difference = np.vdot(ax.astype(np.float64), b) - np.vdot(x.astype(np.float64), atb)
    return float(abs(difference) / (np.linalg.norm(ax) * np.linalg.norm(b)))
