"""The matrix of rays in any direction: parallel or from a point, onto screens in any position, and bent by glass."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.kernels import listed, rays
from lightcube.kernels.layout import empty
from lightcube.kernels.ray import MOST_PARTS, most_pieces
from lightcube.kernels.ray_matrix import trace_all
from lightcube.optics.arrays import Counts
from lightcube.optics.grid import Grid
from lightcube.optics.refraction import Bent
from lightcube.optics.views import Views
from lightcube.projection.limits import PIECE, ROOM

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Floats = NDArray[np.floating[Any]]

#: The kernels number them by 32 bits.
_MOST_VOXELS = 2**32
_Lists = tuple[Counts, Floats, Floats]


class Rays:
    """Lengths (mm) of rays in voxels; see `lightcube.projection.projector.Projector`, whose engine this is.

    Parameters
    ----------
    heard
        ``(views, rows, columns)`` bool: the pixels that count; the rows of the others in the matrix are empty.
        None = all.
    bent
        Where rays go in glass: only what they run through it counts; None = all is straight.
    room
        Bytes that their pieces may take.
    """

    level = False
    parts = 1
    areas = None
    grid: Grid
    shape: tuple[int, int]

    def __init__(
        self,
        grid: Grid,
        views: Views,
        heard: NDArray[np.bool_] | None = None,
        bent: Bent | None = None,
        *,
        room: int = ROOM,
    ) -> None:
        if math.prod(grid.shape) > _MOST_VOXELS:
            raise InputError(
                f"a cube of {math.prod(grid.shape):,} voxels is too large for rays in any direction, which number "
                f"{_MOST_VOXELS:,} at most: make it smaller, or let screens stand upright with rows a slice apart"
            )
        rows, columns = views.picture_shape
        sides_mm = grid.sides_mm
        middle = np.array(grid.shape[::-1]) / 2
        lowest_left = views.origins_mm - (columns - 1) / 2 * views.column_steps_mm + (rows - 1) / 2 * views.row_steps_mm
        self.grid = grid
        self._screens = np.stack(
            [lowest_left / sides_mm + middle, views.column_steps_mm / sides_mm, -views.row_steps_mm / sides_mm], 1
        )
        self._lamps = views.lamps.copy()
        points = views.lamps[:, 3] != 0
        self._lamps[points, :3] = views.lamps[points, :3] / sides_mm + middle
        self._lamps[~points, :3] /= np.linalg.norm(views.lamps[~points, :3], axis=1, keepdims=True)
        self._lamps[~points, :3] *= grid.voxel_mm / sides_mm  # in voxels a voxel's width of the way
        self._sides = grid.voxel_mm, grid.tall
        self._picture = columns, rows
        listening = np.ones((len(views), rows, columns), bool) if heard is None else heard
        lines = listening[:, ::-1].transpose(0, 2, 1).reshape(len(views) * columns, rows)
        self._heard = np.ascontiguousarray(lines, np.uint8)
        self._lines, self._boxes = np.empty((1, 0, 6)), np.empty((1, 0, 4), np.int64)
        if bent is not None:
            self._bend(bent)
        self.shape = (len(views) * columns * rows, int(np.prod(grid.shape)))
        self._room = room
        self._lists: tuple[_Lists, ...] | None = None

    def _bend(self, bent: Bent) -> None:
        """Let each pixel have the piece of its ray inside the glass; where there is none it is not heard."""
        middle = np.array(self.grid.shape[::-1]) / 2
        pieces = bent.lines_mm / np.tile(self.grid.sides_mm, 2) + np.tile(middle, 2)
        rows = self._picture[1]
        self._lines = np.ascontiguousarray(pieces[:, ::-1].swapaxes(1, 2)).reshape(-1, rows, 6)
        self._heard *= (bent.through > 0)[:, ::-1].swapaxes(1, 2).reshape(-1, rows)
        self._boxes = rays.boxes(self._lines, self._heard, self._picture, self.grid.shape)

    @property
    def pieces(self) -> int:
        """Of all rays: voxels that each runs through."""
        return int(listed.count(self._rays, self._picture, self._heard, self.grid.shape, self._sides)[-1])

    @property
    def _rays(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """What the kernels find the pixels' rays by."""
        return self._lamps, self._screens, self._lines

    def forward(self, x: Floats) -> Floats:
        """``A @ x`` of a contiguous block of columns."""
        b = empty((self.shape[0], x.shape[1]), x.dtype)
        if self._lists and x.dtype == np.float32:
            listed.gather(*self._lists[0], x, b)
            return b
        rays.forward(*self._rays, self._picture, self._heard, self.grid.shape, *self._sides, x, b)
        return b

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b`` of a contiguous block of columns."""
        x = empty((self.shape[1], b.shape[1]), b.dtype)
        if b.dtype == np.float32 and self._lists is None:  # who wants one such product wants many, by turns
            self._lists = self._kept()
        if b.dtype == np.float32 and self._lists:
            listed.gather(*self._lists[1], b, x)
            return x
        straight = not self._lines.shape[1]
        shadows = shadow_matrices(self._lamps, self._screens) if straight else np.zeros((len(self._lamps), 3, 4))
        data = *self._rays, shadows, self._boxes, self._picture, self._heard
        rays.adjoint(*data, self.grid.shape, *self._sides, b, x)
        return x

    def _kept(self) -> tuple[_Lists, ...]:
        """The pieces of all rays, for the matrix and for its transpose; nothing where there is no room."""
        data = self._rays, self._picture, self._heard, self.grid.shape, self._sides
        offsets = listed.count(*data)
        if PIECE * offsets[-1] > self._room:
            return ()
        found = listed.trace(*data, offsets)
        return found, listed.transposed(*found, self.shape[1])

    def row(self, index: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the unknowns that equation `index` touches, and its ray's length (mm) in each."""
        nz, ny, nx = self.grid.shape
        most = MOST_PARTS * most_pieces(nx, ny, nz)
        unknowns, lengths = np.empty(most, np.int64), np.empty(most)
        if not self._heard.reshape(-1)[index]:
            return unknowns[:0], lengths[:0]
        data = *self._rays, self._picture, index, self.grid.shape, *self._sides
        count = rays.trace(*data, unknowns, lengths)
        return unknowns[:count], lengths[:count]

    def to_sparse(self) -> "csr_array":
        """Return the same matrix, float64."""
        from scipy.sparse import csr_array  # here: it takes longer to load than a small cube to play

        data = *self._rays, self._picture, self._heard, self.grid.shape, *self._sides
        offsets = np.zeros(self.shape[0] + 1, np.int64)
        trace_all(*data, offsets, np.empty(0, np.int64), np.empty(0))
        unknowns, lengths = np.empty(offsets[-1], np.int64), np.empty(offsets[-1])
        trace_all(*data, offsets, unknowns, lengths)
        matrix = csr_array((lengths, unknowns, offsets), shape=self.shape)
        matrix.sum_duplicates()
        return matrix


def shadow_matrices(lamps: NDArray[np.float64], screens: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(views, 3, 4)``: from a point ``(x, y, z, 1)`` to its shadow's ``(column, row, 1)``, times a number.

    The number is above 0 where the point lies on the screen's side of the lamp, and where light is parallel.

    Notes
    -----
    With m the way to the lamp from a point s of the screen's plane (or the light's direction), w the way from s to the
    point, n the plane's normal, and h 1 for a lamp (0 for a direction), the shadow lies at
    ``s + (m (w.n) - w (m.n)) / (h w.n - m.n)``. Both parts are linear in w, so their values at four points give the
    matrix; Cramer's rule turns places into columns and rows.
    """
    points = np.vstack([np.zeros(3), np.eye(3)])
    corner, right, up = screens[:, None, 0], screens[:, None, 1], screens[:, None, 2]
    from_lamp = lamps[:, None, 3]
    normal = np.cross(right, up)
    size = np.sum(normal**2, axis=2)
    size[size == 0] = 1.0  # pixels on a line: the matrix is 0, and shadows may be anywhere
    light = lamps[:, None, :3] - from_lamp[..., None] * corner
    ways = points - corner
    aside, away = np.sum(ways * normal, axis=2), np.sum(light * normal, axis=2)
    onto = aside[..., None] * light - away[..., None] * ways
    across, along = (np.sum(np.cross(*each) * normal, axis=2) / size for each in ((onto, up), (right, onto)))
    values = -np.sign(away)[..., None] * np.stack([across, along, from_lamp * aside - away], axis=1)
    matrices = np.empty((len(lamps), 3, 4))
    matrices[..., 3] = values[..., 0]
    matrices[..., :3] = values[..., 1:] - values[..., :1]
    return matrices
