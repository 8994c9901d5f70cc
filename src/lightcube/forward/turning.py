"""What stands and shines where as the table turns: views, lamp powers and the room at any angle."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.optics.rig import Lighting, turned_by
from lightcube.optics.views import Views, check_angles, smallest_gap, turn_period, turntable

#: Stops nearer to each other than this, in degrees, are one.
_SAME_STOP = 1e-6


def views_at(cube: Cube, angles: ArrayLike, *, whole_screen: bool = False) -> Views:
    """Views of the cube at other turntable angles (degrees), with its own elevation and the nearest stop's window.

    Parameters
    ----------
    whole_screen
        Show the whole shadow and its surroundings instead of the picture window.
    """
    elevations = np.unique(cube.views.elevations)
    if cube.lighting is not None:
        raise InputError("this cube was made on a stage, whose lamps and screens stand anywhere: play it as it is")
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
    stops = cube.angles
    if cube.lighting is None and np.all(cube.views.elevations == 0):
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
    return _powers_between(cube, check_angles(angles), stops, np.log(cube.powers), turn_period(cube.views))


def _powers_between(
    cube: Cube, angles: NDArray[np.float64], stops: NDArray[np.float64], logs: NDArray[np.float64], period: float
) -> NDArray[np.float64]:
    """Power at each of the angles, ``(angles, channels)``, from ln P at the stops, constant over the cube's hold."""
    # just short of the middle between two stops, so that the ends of their holds keep their order
    hold = min(cube.hold_deg, smallest_gap(stops, period) / 2 - 1e-6)
    if hold > 0:
        stops, logs = np.concatenate([stops - hold, stops + hold]), np.concatenate([logs, logs])
    return np.exp(np.stack([np.interp(angles, stops, column, period=period) for column in logs.T], axis=1))


def exposures_at(cube: Cube, angles: ArrayLike) -> tuple[Views, Lighting, NDArray[np.float64]]:
    """Views, lighting and lamp powers of all screens of a cube's stage at any turntable angles (degrees).

    The pictures of an angle follow each other, one for each screen in the order of ``lighting.screen_names``. The room
    is lit as at the stop that is nearest: a screen that no picture is wanted on there is dark (its lamps' shares are
    0). The power of each lamp is linear in ln P between the stops at which it shines on that screen, constant where a
    stop's picture is held, and repeats after a whole turn.
    """
    lighting = stage_of(cube)
    turned, screens = check_angles(angles), np.unique(lighting.screen)
    away = np.abs(np.remainder(turned[:, None] - lighting.angle + 180, 360) - 180)
    own = np.where(lighting.screen == screens[:, None, None], away, np.inf)  # (screen, angle, picture)
    shown = np.argmin(own, axis=2).T.ravel()
    lit = (np.min(own, axis=2) < np.min(away, axis=1) + _SAME_STOP).T.ravel()
    moved, kept = lighting.take(shown)
    off = np.repeat(turned, len(screens)) - lighting.angle[shown]
    views = turned_by(cube.views.take(kept), moved, off[moved.picture])
    share = moved.share * lit[moved.picture][:, None]
    moved = replace(moved, angle=np.repeat(turned, len(screens)), share=share)
    logs = np.log(cube.powers)
    powers = np.empty((len(moved.pairs), logs.shape[1]))
    for row, (picture, lamp) in enumerate(moved.pairs):
        alike = (lighting.pairs[:, 1] == lamp) & (lighting.screen[lighting.pairs[:, 0]] == moved.screen[picture])
        stops = lighting.angle[lighting.pairs[alike, 0]]
        powers[row] = _powers_between(cube, moved.angle[[picture]], stops, logs[alike], 360.0)[0]
    return views, moved, powers


def stage_of(cube: Cube) -> Lighting:
    """The lighting of a cube that was made on a stage; `InputError` where it was made on a turntable alone."""
    if cube.lighting is None:
        raise InputError("this cube was not made on a stage: leave out what is for stages, screens and samples")
    return cube.lighting
