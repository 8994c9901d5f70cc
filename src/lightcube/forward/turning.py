"""What stands and shines where as the table turns: the room and its lamps' powers at any angle."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lightcube.optics.cube import Cube
from lightcube.optics.rig import Rig
from lightcube.optics.views import smallest_gap_deg


def moment(cube: Cube, angles_deg: ArrayLike) -> tuple[Rig, NDArray[np.float64]]:
    """The room of a cube and its lamps' powers ``(pairs, channels)`` at any turntable angles (degrees).

    The pictures of an angle follow each other, one for each screen (`lightcube.optics.rig.Rig.at`). The power of each
    lamp is linear in ln P between the stops at which it shines on that screen, constant where a stop's picture is held,
    and repeats after a whole turn; where half a turn shows the mirror image, after half a turn.
    """
    now, _ = cube.rig.at(angles_deg)
    return now, powers_of(cube, now)


def powers_of(cube: Cube, rig: Rig) -> NDArray[np.float64]:
    """Powers ``(pairs, channels)`` of the lamps of a cube's room that stands at other angles: those of its stops."""
    own = cube.rig
    screens, shown = own.stops.screen[own.pairs[:, 0]], rig.stops.screen[rig.pairs[:, 0]]
    logs = np.log(cube.powers)
    powers = np.empty((len(rig.pairs), logs.shape[1]))
    for screen, lamp in np.unique(np.stack([shown, rig.pairs[:, 1]], axis=1), axis=0):
        mine = (shown == screen) & (rig.pairs[:, 1] == lamp)
        alike = (screens == screen) & (own.pairs[:, 1] == lamp)
        stops, asked = own.stops.angle_deg[own.pairs[alike, 0]], rig.stops.angle_deg[rig.pairs[mine, 0]]
        powers[mine] = _powers_between(cube.hold_deg, asked, stops, logs[alike], own.period_deg)
    return powers


def _powers_between(
    hold_deg: float,
    angles_deg: NDArray[np.float64],
    stops: NDArray[np.float64],
    logs: NDArray[np.float64],
    period: float,
) -> NDArray[np.float64]:
    """Power at each of the angles, ``(angles, channels)``, from ln P at the stops, constant over the hold."""
    # just short of the middle between two stops, so that the ends of their holds keep their order
    hold_deg = min(hold_deg, smallest_gap_deg(stops, period) / 2 - 1e-6)
    if hold_deg > 0:
        stops, logs = np.concatenate([stops - hold_deg, stops + hold_deg]), np.concatenate([logs, logs])
    return np.exp(np.stack([np.interp(angles_deg, stops, column, period=period) for column in logs.T], axis=1))


def turn(cube: Cube, count: int | None = None, start: float = 0.0, end: float = 360.0) -> NDArray[np.float64]:
    """`count` angles from `start` to before `end` (degrees), each stop's nearest one moved onto the stop.

    Of a whole turn there are 120, or two for each stop where that is more; the stops alone where nothing turns.

    A picture falls apart within a degree of its stop, so an even turn would pass between the stops and show none.
    Where half a turn shows the mirror image a stop is passed twice. Where stops are nearer to each other than the
    angles, some are left out.
    """
    stops = cube.angles_deg
    if count is None:
        if not np.any(cube.rig.turning.turns) and (start, end) == (0.0, 360.0):
            return np.unique(stops)  # between them nothing is to be seen
        count = max(120, 2 * len(cube.names))
    if cube.rig.mirrors:
        stops = np.concatenate([stops, stops + 180])
    laps = 360.0 * np.arange(math.floor(min(start, end) / 360) - 1, math.ceil(max(start, end) / 360) + 1)
    passed = (stops[:, None] + laps).ravel()
    angles_deg = np.linspace(start, end, count, endpoint=False)
    place = (passed - start) * count / (end - start)
    nearest = np.rint(place).astype(int)
    for stop in np.argsort(-np.abs(place - nearest)):  # where two stops want the same angle, the nearer has it
        if 0 <= nearest[stop] < count:
            angles_deg[nearest[stop]] = passed[stop]
    return angles_deg
