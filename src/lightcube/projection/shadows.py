"""What screens show of a cube, picture by picture: the matrix, and the law of light after it."""

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from lightcube.optics.arrays import Floats, Images, Reals
from lightcube.optics.grid import Grid
from lightcube.optics.law import Mixture, shown_light
from lightcube.optics.rig import Rig
from lightcube.projection.projector import Projector

#: Views that are computed together at least: enough for all threads; and pixels at most, to bound memory.
_BATCH, _PIXELS = 16, 1 << 20


def shadows(
    columns: Floats,
    grid: Grid,
    rig: Rig,
    powers: Reals,
    rows: slice = slice(None),
    colours: slice = slice(None),
) -> Iterator[Images]:
    """Yield what the screen shows in each picture of a rig, ``(row, column, channel)`` linear light, never clipped.

    Parameters
    ----------
    columns
        The cube's extinction, or that of some colours, or of some slices where each casts a row by itself; as
        `lightcube.kernels.layout.columns_from_volume` lays it out.
    powers
        ``(views, channels)``, of each view's lamp, in those colours.
    rows, colours
        Rows of the pictures, and colours, that the columns are of.
    """
    inside = rig.inside[:, rows]
    all_inside = bool(np.all(inside))
    picture, shape = rig.sums.picture, inside.shape[1:]
    channels = max(rig.sums.share.shape[1], colours.stop or powers.shape[1])
    begun = None
    for batch in _batches(rig):
        own = picture[batch]
        lit = rig.of_views(batch)
        matrix = Projector(grid, lit, None if all_inside else rig.inside[own])
        absorbance = matrix.forward(columns.reshape(matrix.shape[1], -1))
        mixture = Mixture.of(lit, channels, colours, rows).in_parts(matrix.parts, matrix.areas)
        light = shown_light(mixture, powers[batch].repeat(matrix.parts, axis=0), absorbance, shape)
        if begun is not None:
            light[0] += begun
        if batch.stop < len(picture) and picture[batch.stop] == own[-1]:  # more views of the same picture follow
            begun = light[0]
            continue
        begun = None
        yield from light if all_inside else light * inside[own[0] : own[-1] + 1, ..., None]


def _batches(rig: Rig) -> Iterator[slice]:
    """A few views at a time: whole pictures, as many as are small enough together, or parts of one that is not."""
    most, first = max(_BATCH, _PIXELS // math.prod(rig.picture_shape)), 0
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
