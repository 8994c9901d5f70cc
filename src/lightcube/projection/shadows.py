"""What screens show of a cube, picture by picture: the matrix, and the law of light after it."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from lightcube.optics.arrays import Floats, Images, Reals
from lightcube.optics.grid import Grid
from lightcube.optics.law import Mixture, shown_light
from lightcube.optics.rig import Rig
from lightcube.projection.projector import Projector

#: Views that are computed together: enough for all threads, few enough to bound memory.
_BATCH = 16


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
        matrix = Projector(grid, rig.views.take(batch), None if all_inside else rig.inside[own])
        absorbance = matrix.forward(columns.reshape(matrix.shape[1], -1))
        light = shown_light(Mixture.of(rig, channels, colours, rows, batch), powers[batch], absorbance, shape)
        if begun is not None:
            light[0] += begun
        if batch.stop < len(picture) and picture[batch.stop] == own[-1]:  # more views of the same picture follow
            begun = light[0]
            continue
        begun = None
        yield from light if all_inside else light * inside[own[0] : own[-1] + 1, ..., None]


def _batches(rig: Rig) -> Iterator[slice]:
    """A few views at a time: of pictures of one view each, or of one picture."""
    starts = [0, len(rig)] if len(rig) == len(rig.views) else rig.starts.tolist()
    for start, end in pairwise(starts):
        for first in range(start, end, _BATCH):
            yield slice(first, min(first + _BATCH, end))
