"""Program 3, the forward computation: what the screen shows at any turntable angle."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lightcube.cube import Cube
from lightcube.errors import InputError
from lightcube.geometry import Views, check_angles, smallest_gap, turn_period, turntable
from lightcube.layout import columns_from_volume, pictures_from_columns
from lightcube.projector import Projector

#: Views that are computed together: enough for all threads, few enough to bound memory.
_BATCH = 16


def views_at(cube: Cube, angles: ArrayLike, *, whole_screen: bool = False) -> Views:
    """Views of the cube at other turntable angles (degrees), with its own elevation and the nearest stop's window.

    Parameters
    ----------
    whole_screen
        Show the whole shadow and its surroundings instead of the picture window.
    """
    elevations = np.unique(cube.views.elevations)
    if len(elevations) > 1:
        raise InputError("this cube was made with lamps at several elevations: play its own stops instead")
    if whole_screen:
        return turntable(cube.grid, angles, elevation=float(elevations[0]))
    views = turntable(cube.grid, angles, elevation=float(elevations[0]), picture_shape=cube.views.picture_shape)
    columns, rows = _standing(cube, views.angles)
    return replace(views, origins=views.origins + columns * views.column_steps + rows * views.row_steps)


def _standing(cube: Cube, angles: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Pixels to the right and down, ``(angles, 1)`` each, by which the picture of the nearest stop is off the middle.

    Half a turn on, level light shows it mirrored.
    """
    views = cube.views
    right, down = (
        np.sum(views.origins * steps, axis=1) / np.sum(steps**2, axis=1)
        for steps in (views.column_steps, views.row_steps)
    )
    stops = views.angles
    if turn_period(views) == 180:
        stops, right, down = np.append(stops, stops + 180), np.append(right, -right), np.append(down, down)
    away = np.abs(np.remainder(angles[:, None] - stops + 180, 360) - 180)
    nearest = np.argmin(away, axis=1)
    return right[nearest, None], down[nearest, None]


def turn(cube: Cube, count: int, start: float = 0.0, end: float = 360.0) -> NDArray[np.float64]:
    """`count` angles from `start` to before `end` (degrees), each stop's nearest one moved onto the stop.

    A picture falls apart within a degree of its stop, so an even turn would pass between the stops and show none.
    With level light a stop is passed twice, half a turn apart. Where stops are nearer to each other than the angles,
    some are left out.
    """
    stops = cube.views.angles
    if np.all(cube.views.elevations == 0):
        stops = np.concatenate([stops, stops + 180])
    laps = 360.0 * np.arange(math.floor(min(start, end) / 360) - 1, math.ceil(max(start, end) / 360) + 1)
    passed = (stops[:, None] + laps).ravel()
    angles = np.linspace(start, end, count, endpoint=False)
    place = (passed - start) * count / (end - start)
    nearest = np.rint(place).astype(int)
    for stop in np.argsort(-np.abs(place - nearest)):  # where two stops want the same angle, the nearer has it
        if 0 <= nearest[stop] < count:
            angles[nearest[stop]] = passed[stop]
    return angles


def lamp_at(cube: Cube, angles: ArrayLike) -> NDArray[np.float64]:
    """Lamp power at other turntable angles (degrees), ``(angles, channels)``: linear in ln P between the stops.

    It is constant where a stop's picture is held. The powers repeat after a whole turn; at elevation 0, where half a
    turn shows the mirror image, after half a turn, unless stops half a turn apart have powers of their own.
    """
    stops = cube.views.angles
    wanted = check_angles(angles)
    period = turn_period(cube.views)
    logs = np.log(cube.powers)
    # just short of the middle between two stops, so that the ends of their holds keep their order
    hold = min(cube.hold_deg, smallest_gap(stops, period) / 2 - 1e-6)
    if hold > 0:
        stops, logs = np.concatenate([stops - hold, stops + hold]), np.concatenate([logs, logs])
    return np.exp(np.stack([np.interp(wanted, stops, column, period=period) for column in logs.T], axis=1))


def cast(cube: Cube, views: Views, lamp_powers: NDArray[np.float64]) -> Iterator[NDArray[np.float32]]:
    """Yield what the screen shows in each view, ``(row, column, channel)`` float32 linear light, never clipped.

    Parameters
    ----------
    views
        Lamp and screen of each picture.
    lamp_powers
        ``(views, channels)``; a beam that misses the cube shows the lamp's power.
    """
    yield from _cast(columns_from_volume(cube.extinction), cube, views, lamp_powers)


def play(cube: Cube, angles: ArrayLike | None = None, *, whole_screen: bool = False) -> NDArray[np.float32]:
    """What the screen shows, ``(view, row, column, channel)`` float32 linear light, lamp included, never clipped.

    Parameters
    ----------
    angles
        Turntable angles in degrees; None = the views that the cube was made for.
    whole_screen
        Show the whole shadow and its surroundings instead of the picture window.
    """
    return player(cube, whole_screen=whole_screen)(angles)


def player(cube: Cube, *, whole_screen: bool = False) -> Callable[[ArrayLike | None], NDArray[np.float32]]:
    """Make a function of the angles that shows what `play` does, fast enough for a cube that is turned by hand.

    The cube is laid out for casting once, which takes as much memory again.

    Parameters
    ----------
    whole_screen
        Show the whole shadow and its surroundings instead of the picture window.
    """
    columns = columns_from_volume(cube.extinction)

    def show(angles: ArrayLike | None) -> NDArray[np.float32]:
        turned = cube.views.angles if angles is None else check_angles(angles)
        powers = cube.powers if angles is None else lamp_at(cube, turned)
        own = angles is None and not whole_screen
        views = cube.views if own else views_at(cube, turned, whole_screen=whole_screen)
        return np.stack(list(_cast(columns, cube, views, powers)))

    return show


def _cast(
    columns: NDArray[np.floating], cube: Cube, views: Views, lamp_powers: NDArray[np.float64]
) -> Iterator[NDArray[np.float32]]:
    """Yield what `cast` does, of the cube's extinction as `columns_from_volume` lays it out."""
    channels = lamp_powers.shape[1]
    for start in range(0, len(views), _BATCH):
        batch = views.take(slice(start, start + _BATCH))
        matrix = Projector(cube.grid, batch)
        absorbance = matrix.forward(columns.reshape(matrix.shape[1], -1))
        light = absorbance.reshape(len(batch), batch.picture_shape[1], -1)
        np.exp(np.negative(light, out=light), out=light)
        light *= np.tile(lamp_powers[start : start + _BATCH].astype(np.float32), batch.picture_shape[0])[:, None, :]
        yield from pictures_from_columns(light.reshape(-1, light.shape[2]), batch.picture_shape, channels)
