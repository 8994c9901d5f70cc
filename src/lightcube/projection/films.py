"""The matrix of a stack of films: beams through the middles of pixels, or rectangles that make up a pixel exactly.

The mean of the light over a pixel is not that of a few of its beams: films cut it into cells of their own, shifted
against each other. The edges of a pixel and of all films' cells, each seen along the light, cut it into **rectangles**
in which all beams meet the same cells. Each is one beam of the matrix, and its part of the pixel's area its share of
the light, so means are exact. That is so where cells' sides run along pixels' sides; elsewhere means are taken over
points, as those of any block (`lightcube.optics.light`).
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.kernels import films as kernels
from lightcube.kernels.layout import empty
from lightcube.optics.arrays import Counts, Floats, Integers, Reals
from lightcube.optics.films import Paths, paths
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack

if TYPE_CHECKING:
    from scipy.sparse import csr_array

#: Edges nearer to each other than this, in pixels, are one.
_SAME_EDGE = 1e-7
#: A film's cells are shared out among so many tasks at most.
_STRIPES = 16
#: The kernels number unknowns by 30 bits.
_MOST_CELLS = 2**30


class Middles:
    """Beams through the middles of pixels; see `lightcube.projection.projector.Projector`, whose engine this is."""

    level = False
    shape: tuple[int, int]
    parts = 1
    pieces = 0
    areas = None

    def __init__(self, stack: Stack, rig: Rig) -> None:
        _check_size(stack)
        self._stack, self._paths = stack, paths(stack, rig)
        rows, columns = rig.picture_shape
        self._picture = columns, rows
        self.shape = (len(rig.views) * columns * rows, math.prod(stack.shape))
        self._given = self._paths.table, self._paths.places, self._picture, stack.shape[:0:-1], stack.voxel_mm

    def forward(self, x: Floats) -> Floats:
        """``A @ x`` of a contiguous block of columns."""
        b = empty((self.shape[0], x.shape[1]), x.dtype)
        kernels.forward_middles(*self._given, x, b)
        return b

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b`` of a contiguous block of columns."""
        x = empty((self.shape[1], b.shape[1]), b.dtype)
        kernels.adjoint_middles(*self._given, b, x)
        return x

    @cached_property
    def _entries(self) -> tuple[Integers, Reals]:
        """``(beams, films)``: the unknown that each beam meets, below 0 where it misses the film, and its length."""
        columns, rows = self._picture
        films, ny, nx = self._stack.shape
        cells = np.full((self.shape[0], films), -1, np.int64)
        lengths = np.zeros((self.shape[0], films))
        for beam in range(self.shape[0]):
            view, column, row = beam // (columns * rows), beam // rows % columns, beam % rows
            found = kernels.beam_of(self._paths.table[view], column, row)
            lengths[beam] = found[4] * self._stack.voxel_mm
            for film in range(films):
                cell = kernels.cell_of(found, self._paths.places[view, film], self._stack.voxel_mm, nx, ny)
                cells[beam, film] = cell * films + film if cell >= 0 else -1
        return cells, lengths

    def row(self, index: int) -> tuple[Integers, Reals]:
        """Return the unknowns that equation `index` touches, and its beam's length (mm) in each."""
        return _row(*self._entries, index)

    def to_sparse(self) -> csr_array:
        """Return the same matrix, float64."""
        return _sparse(*self._entries, self.shape)


class Rectangles:
    """Parts of pixels in which all beams meet the same cells; an engine as `Middles`.

    Attributes
    ----------
    parts
        How many rectangles each pixel has, some of which may be empty.
    areas
        ``(views * parts, columns * rows)``: the part of its pixel's area that each has, float32.
    """

    level = False
    pieces = 0
    shape: tuple[int, int]
    parts: int
    areas: Floats

    def __init__(self, stack: Stack, rig: Rig) -> None:
        _check_size(stack)
        found = paths(stack, rig)
        if not found.are_aligned:
            raise InputError("cells of these films do not lie along the pixels: take means over points instead")
        rows, columns = rig.picture_shape
        films, ny, nx = stack.shape
        across, wide = _parts(found, stack, rig.sums.square, columns, 0)
        along, high = _parts(found, stack, rig.sums.square, rows, 1)
        self._width = stack.voxel_mm
        self._across, sides = _numbers(found, stack, across, 0)
        self._along, _ = _numbers(found, stack, along, 1)
        self._slants = (
            np.where(wide > 0, found.slants(across, 0), np.nan),
            np.where(high > 0, found.slants(along, 1), np.nan),
        )
        self._stripes = _stripes(found, sides, (ny, nx))
        self.parts = across.shape[1] * along.shape[1]
        area = wide[:, :, None, :, None] * high[:, None, :, None, :]
        self.areas = area.reshape(len(rig.views) * self.parts, columns * rows).astype(np.float32)
        self.shape = (self.areas.size, films * ny * nx)

    def forward(self, x: Floats) -> Floats:
        """``A @ x`` of a contiguous block of columns."""
        b = empty((self.shape[0], x.shape[1]), x.dtype)
        kernels.forward_rectangles(self._across, self._along, self._slants, self._width, x, b)
        return b

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b`` of a contiguous block of columns."""
        x = empty((self.shape[1], b.shape[1]), b.dtype)
        kernels.adjoint_rectangles(self._across, self._along, self._slants, self._stripes, self._width, b, x)
        return x

    @cached_property
    def _entries(self) -> tuple[Integers, Reals]:
        """As those of `Middles`; empty rectangles meet nothing."""
        films = self._across.shape[-1]
        cells = self._across[:, :, None, :, None, :].astype(np.int64) + self._along[:, None, :, None, :, :]
        aslant, upslant = self._slants
        lengths = self._width * np.sqrt(1 + aslant[:, :, None, :, None] + upslant[:, None, :, None, :])
        cells = np.where(np.isnan(lengths)[..., None] | (cells < 0), -1, cells).reshape(-1, films)
        return cells, np.repeat(np.nan_to_num(lengths).reshape(-1, 1), films, axis=1)

    def row(self, index: int) -> tuple[Integers, Reals]:
        """Return the unknowns that equation `index` touches, and its beams' length (mm) in each."""
        return _row(*self._entries, index)

    def to_sparse(self) -> csr_array:
        """Return the same matrix, float64."""
        return _sparse(*self._entries, self.shape)


def _check_size(stack: Stack) -> None:
    """Raise `InputError` where there are more cells than are numbered."""
    count = math.prod(stack.shape)
    if count >= _MOST_CELLS:
        raise InputError(f"a stack has at most {_MOST_CELLS:,} cells, not {count:,}: make them wider")


def _parts(found: Paths, stack: Stack, square: Reals, count: int, axis: int) -> tuple[Reals, Reals]:
    """Middles and widths of the parts that columns (axis 0) or rows (1) of pixels fall into, ``(views, parts, count)``.

    In pixels, from the first column or the lowest row on; the widths of a pixel's parts add up to 1.
    """
    edges = [_edges(found, stack, view, side, count, axis) for view, side in enumerate(square)]
    most = max(each.shape[1] for each in edges)
    ends = np.stack([np.pad(each, ((0, 0), (0, most - each.shape[1])), mode="edge") for each in edges])
    widths = np.diff(ends, axis=2)
    middles = (ends[..., 1:] + ends[..., :-1]) / 2
    widths[widths < _SAME_EDGE] = 0
    order = np.argsort(widths == 0, axis=2, kind="stable")  # those that are none last
    widths, middles = (np.take_along_axis(each, order, 2) for each in (widths, middles))
    used = max(1, int(np.max(np.sum(widths > 0, axis=2))))
    widths = widths[..., :used] / np.sum(widths, axis=2, keepdims=True)
    return np.ascontiguousarray(middles[..., :used].transpose(0, 2, 1)), widths.transpose(0, 2, 1)


def _edges(found: Paths, stack: Stack, view: int, side: float, count: int, axis: int) -> Reals:
    """``(count, edges)``, ascending: the ends of each pixel's square, and the cells' edges in between."""
    _, ny, nx = stack.shape
    low, high = np.arange(count) - side / 2, np.arange(count) + side / 2
    inside = [low[:, None], high[:, None]]
    for film in range(stack.shape[0]):
        which, start, step = found.along(view, film, axis)
        if abs(step) * max(count, 1) < _SAME_EDGE * stack.voxel_mm:
            continue
        cells = (nx, ny)[which]
        at = np.sort([start + step * low, start + step * high], axis=0) / stack.voxel_mm + cells / 2
        first = np.ceil(at[0]).astype(np.int64)
        most = int(np.max(np.floor(at[1]) - first)) + 1
        numbers = first[:, None] + np.arange(max(most, 0))
        edges = ((numbers - cells / 2) * stack.voxel_mm - start) / step
        inside.append(np.clip(edges, low[:, None], high[:, None]))
    return np.sort(np.concatenate(inside, axis=1), axis=1)


def _numbers(found: Paths, stack: Stack, middles: Reals, axis: int) -> tuple[NDArray[np.int32], Counts]:
    """What parts of columns (axis 0) or rows (1) add to numbers of unknowns, ``(views, parts, count, films)``.

    And the row or column of cells itself, of the same shape.
    """
    films, ny, nx = stack.shape
    numbers = np.empty((*middles.shape, films), np.int32)
    sides = np.empty(numbers.shape, np.intp)
    for view in range(len(middles)):
        for film in range(films):
            which, start, step = found.along(view, film, axis)
            side = np.floor((start + step * middles[view]) / stack.voxel_mm + (nx, ny)[which] / 2)
            is_on = (side >= 0) & (side < (nx, ny)[which])
            number = side * films * (1, nx)[which] + (film if axis == 0 else 0)
            numbers[view, ..., film] = np.where(is_on, number, kernels.NONE)
            sides[view, ..., film] = np.where(is_on, side, 0)
    return numbers, sides


def _stripes(found: Paths, sides: Counts, cells: tuple[int, int]) -> NDArray[np.int32]:
    """The task of each part of a column and film: by rows or columns of cells, where all pictures see them alike."""
    stripes = np.zeros(sides.shape, np.int32)
    for film in range(sides.shape[-1]):
        ways = {found.along(view, film, 0)[0] for view in range(len(sides))}
        if len(ways) == 1:
            count = cells[1 - ways.pop()]
            stripes[..., film] = sides[..., film] * min(_STRIPES, count) // count
    return stripes


def _row(cells: Integers, lengths: Reals, index: int) -> tuple[Integers, Reals]:
    is_met = cells[index] >= 0
    return cells[index][is_met], lengths[index][is_met]


def _sparse(cells: Integers, lengths: Reals, shape: tuple[int, int]) -> csr_array:
    from scipy.sparse import csr_array  # here: it takes longer to load than a small stack to play

    is_met = cells >= 0
    offsets = np.concatenate([[0], np.cumsum(np.sum(is_met, axis=1))])
    matrix = csr_array((lengths[is_met], cells[is_met], offsets), shape=shape)
    matrix.sum_duplicates()
    return matrix
