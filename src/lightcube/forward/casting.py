"""Program 3, the forward computation: what the screen shows at any turntable angle."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.forward.turning import moment
from lightcube.kernels.layout import columns_from_volume, pictures_from_columns
from lightcube.optics.arrays import Light, Numbers, Reals
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.law import falling_light
from lightcube.optics.rig import Rig
from lightcube.projection.projector import Projector

#: Views that are computed together: enough for all threads, few enough to bound memory.
_BATCH = 16


@checked
def cast(cube: Cube, rig: Rig | None = None, lamp_powers: Reals | None = None) -> Iterator[Light]:
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
    if powers.shape != shape:
        raise InputError(f"lamp powers for this rig have shape {shape}, not {powers.shape}: give one for each pair")
    return _cast(columns_from_volume(cube.extinction), cube, rig or cube.rig, powers)


@checked
def play(cube: Cube, angles_deg: Numbers | None = None, *, whole_shadow: bool = False) -> Light:
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
def player(cube: Cube, *, whole_shadow: bool = False) -> Callable[[Numbers | None], Light]:
    """Make a function of the angles that shows what `play` does, fast enough for a cube that is turned by hand.

    The cube is laid out for casting once, which takes as much memory again.

    Parameters
    ----------
    whole_shadow
        As `play` takes it.
    """
    columns = columns_from_volume(cube.extinction)

    def show(angles_deg: Numbers | None) -> Light:
        if angles_deg is None:
            now, powers = cube.rig.whole(cube.grid) if whole_shadow else cube.rig, cube.powers
        else:
            now, powers = moment(cube, angles_deg, whole_shadow=whole_shadow)
        return np.stack(list(_cast(columns, cube, now, powers)))

    return show


def _cast(columns: NDArray[np.floating], cube: Cube, rig: Rig, lamp_powers: Reals) -> Iterator[Light]:
    """Yield what `cast` does, of the cube's extinction as `columns_from_volume` lays it out."""
    yield from (_thin if rig.is_thin else _summed)(columns, cube, rig, lamp_powers)


def _thin(columns: NDArray[np.floating], cube: Cube, rig: Rig, lamp_powers: Reals) -> Iterator[Light]:
    """Yield the unfaded shadows of single beams, a few views at a time: ``P T``."""
    rows, width = rig.picture_shape
    inside = rig.inside
    all_inside = bool(np.all(inside))
    for start in range(0, len(rig), _BATCH):
        batch = slice(start, start + _BATCH)
        matrix = Projector(cube.grid, rig.views.take(batch), None if all_inside else inside[batch])
        absorbance = matrix.forward(columns.reshape(matrix.shape[1], -1))
        light = absorbance.reshape(-1, width, rows * lamp_powers.shape[1])
        np.exp(np.negative(light, out=light), out=light)
        light *= np.tile(lamp_powers[batch].astype(np.float32), rows)[:, None, :]
        shown = pictures_from_columns(light.reshape(-1, light.shape[2]), rig.picture_shape, lamp_powers.shape[1])
        yield from shown if all_inside else shown * inside[batch][..., None]


def _summed(columns: NDArray[np.floating], cube: Cube, rig: Rig, lamp_powers: Reals) -> Iterator[Light]:
    """Yield sums of views, ``P g (1 - a (1 - T))`` each, picture by picture and a few views of it at a time."""
    light, shadow = falling_light(rig)
    powers = (lamp_powers[rig.pair] * rig.sums.share).astype(np.float32)
    inside, starts, shape = rig.inside, rig.starts, rig.picture_shape
    for picture in range(len(rig)):
        total = np.zeros((*shape, powers.shape[1]), np.float32)
        for first in range(starts[picture], starts[picture + 1], _BATCH):
            batch = range(first, min(first + _BATCH, starts[picture + 1]))
            heard = np.repeat(inside[picture][None], len(batch), axis=0)
            matrix = Projector(cube.grid, rig.views.take(batch), heard)
            absorbance = matrix.forward(columns.reshape(matrix.shape[1], -1))
            lines = absorbance.reshape(len(batch) * shape[1], -1)
            absorbed = pictures_from_columns(lines, shape, powers.shape[1])
            for view, each in zip(batch, absorbed, strict=True):
                total += powers[view] * light[view][..., None] * (1 + shadow[view][..., None] * np.expm1(-each))
        yield total * inside[picture][..., None]
