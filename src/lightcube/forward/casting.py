"""Program 3, the forward computation: what the screen shows at any turntable angle."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.forward.turning import moment
from lightcube.kernels.layout import columns_from_volume
from lightcube.optics.arrays import Images, Numbers, Reals
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.law import Mixture, shown_light
from lightcube.optics.rig import Rig
from lightcube.projection.projector import Projector

#: Views that are computed together: enough for all threads, few enough to bound memory.
_BATCH = 16


@checked
def cast(cube: Cube, rig: Rig | None = None, lamp_powers: Reals | None = None) -> Iterator[Images]:
    """Yield what the screen shows in each picture, ``(row, column, channel)`` float32 linear light, never clipped.

    Pixels that are not on their screen are black; a beam that misses the cube shows the lamp's power.

    Parameters
    ----------
    rig
        Lamps and screens; None = those that the cube was made for.
    lamp_powers
        ``(pairs, channels)``, of the rig's ``pairs``; None = the cube's.
    """
    powers = cube.powers if lamp_powers is None else np.asarray(lamp_powers, np.float64)
    shape = len((rig or cube.rig).pairs), len(cube.extinction)
    colours = (rig or cube.rig).sums.share.shape[1]
    if colours not in (1, shape[1]):
        raise InputError(f"a rig of {colours} colours does not fit a cube of {shape[1]}: give one of as many")
    if powers.shape != shape:
        raise InputError(f"lamp powers for this rig have shape {shape}, not {powers.shape}: give one for each pair")
    return _cast(columns_from_volume(cube.extinction), cube, rig or cube.rig, powers)


@checked
def play(cube: Cube, angles_deg: Numbers | None = None, *, whole_shadow: bool = False) -> Images:
    """What the screen shows, ``(picture, row, column, channel)`` float32 linear light, lamp included, never clipped.

    Parameters
    ----------
    angles_deg
        Turntable angles in degrees; None = the pictures that the cube was made for. Where there are several screens the
        pictures of an angle follow each other (`lightcube.forward.turning.moment`).
    whole_shadow
        Show the whole shadow and its surroundings instead of the picture, where the screen has no edges.
    """
    return player(cube, whole_shadow=whole_shadow)(angles_deg)


@checked
def player(cube: Cube, *, whole_shadow: bool = False) -> Callable[[Numbers | None], Images]:
    """Make a function of the angles that shows what `play` does, fast enough for a cube that is turned by hand.

    The cube is laid out for casting once, which takes as much memory again.

    Parameters
    ----------
    whole_shadow
        As `play` takes it.
    """
    columns = columns_from_volume(cube.extinction)

    def show(angles_deg: Numbers | None) -> Images:
        if angles_deg is None:
            now, powers = cube.rig.whole(cube.grid) if whole_shadow else cube.rig, cube.powers
        else:
            now, powers = moment(cube, angles_deg, whole_shadow=whole_shadow)
        return np.stack(list(_cast(columns, cube, now, powers)))

    return show


def _cast(columns: NDArray[np.floating], cube: Cube, rig: Rig, lamp_powers: Reals) -> Iterator[Images]:
    """Yield what `cast` does, of the cube's extinction as `columns_from_volume` lays it out, a few views at a time."""
    inside, channels = rig.inside, lamp_powers.shape[1]
    all_inside = bool(np.all(inside))
    powers, picture = lamp_powers[rig.pair], rig.sums.picture
    begun = None
    for batch in _batches(rig):
        own = picture[batch]
        matrix = Projector(cube.grid, rig.views.take(batch), None if all_inside else inside[own])
        absorbance = matrix.forward(columns.reshape(matrix.shape[1], -1))
        light = shown_light(Mixture.of(rig, channels, views=batch), powers[batch], absorbance, rig.picture_shape)
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
