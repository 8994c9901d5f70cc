"""What screens show of a cube, picture by picture: the matrix, and the law of light after it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from lightcube.optics.arrays import Floats, Images, Reals
from lightcube.optics.grid import Grid
from lightcube.optics.law import Mixture, shown_light
from lightcube.optics.rig import Rig
from lightcube.projection.projector import Projector

_Lit = tuple[Projector, Mixture]
#: Views that are computed together at least: enough for all threads; and pixels at most, to bound memory.
_BATCH, FEW_PIXELS = 16, 1 << 20


class Shadows:
    """What the screen shows in each picture of a rig, of as many cubes as one likes.

    Parameters
    ----------
    rows, colours
        Rows of the pictures, and colours, that the cubes' columns are of.

    Notes
    -----
    Where few views are looked at, their matrix and their light are kept: where glass bends light, finding its beams
    takes longer than the product.
    """

    def __init__(self, grid: Grid, rig: Rig, rows: slice = slice(None), colours: slice = slice(None)) -> None:
        self._grid, self._rig, self._rows, self._colours = grid, rig, rows, colours
        self._inside = rig.inside[:, rows]
        self._batches = list(_batches(rig))
        self._kept: _Lit | None = None

    def __call__(self, columns: Floats, powers: Reals) -> Iterator[Images]:
        """Yield the pictures, ``(row, column, channel)`` linear light, never clipped.

        Parameters
        ----------
        columns
            A cube's extinction, or that of some colours, or of some slices where each casts a row by itself; as
            `lightcube.kernels.layout.columns_from_volume` lays it out.
        powers
            ``(views, channels)``, of each view's lamp, in those colours.
        """
        picture, shape = self._rig.sums.picture, self._inside.shape[1:]
        all_inside = bool(np.all(self._inside))
        begun = None
        for batch in self._batches:
            own = picture[batch]
            matrix, mixture = self._lit(batch, powers.shape[1])
            absorbance = matrix.forward(columns.reshape(matrix.shape[1], -1))
            light = shown_light(mixture, powers[batch].repeat(matrix.parts, axis=0), absorbance, shape)
            if begun is not None:
                light[0] += begun
            if batch.stop < len(picture) and picture[batch.stop] == own[-1]:  # more views of the same picture follow
                begun = light[0]
                continue
            begun = None
            yield from light if all_inside else light * self._inside[own[0] : own[-1] + 1, ..., None]

    def _lit(self, batch: slice, channels: int) -> _Lit:
        """The matrix of some views, and how they add up."""
        if self._kept is not None:
            return self._kept
        rig = self._rig
        lit = rig if len(self._batches) == 1 else rig.of_views(batch)
        matrix = Projector(self._grid, lit, None if np.all(self._inside) else rig.inside[rig.sums.picture[batch]])
        channels = max(rig.sums.share.shape[1], self._colours.stop or channels)
        mixture = Mixture.of(lit, channels, self._colours, self._rows).in_parts(matrix.parts, matrix.areas)
        if len(self._batches) == 1:
            self._kept = matrix, mixture
        return matrix, mixture


def _batches(rig: Rig) -> Iterator[slice]:
    """A few views at a time: whole pictures, as many as are small enough together, or parts of one that is not."""
    most, first = max(_BATCH, FEW_PIXELS // math.prod(rig.picture_shape)), 0
    if np.any(rig.sums.square):  # of which each is many
        most = 1
    for start, end in pairwise(rig.starts.tolist()):
        if first < start and end - first > most:
            yield slice(first, start)
            first = start
        while end - first > most:
            yield slice(first, first + most)
            first += most
    if first < len(rig.views):
        yield slice(first, len(rig.views))
