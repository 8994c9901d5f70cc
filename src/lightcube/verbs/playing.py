"""What `play` shows: a cube's pictures at its stops or other angles, its screens side by side, or the whole room."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing.room import camera_for, room_player
from lightcube.drawing.sheet import beside_each_other, beside_targets
from lightcube.forward import casting, turning
from lightcube.optics.cube import Cube
from lightcube.optics.light import Beams
from lightcube.optics.rig import Rig
from lightcube.optics.views import Views
from lightcube.pictures.fitting import targets_of

Picture = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Show:
    """Pictures to be written, one after the other.

    Parameters
    ----------
    pictures
        ``(row, column, channel)`` each, linear light.
    count, rows
        How many there are, and how high.
    views
        Those of a turntable's, for the folder that they are written to; None = something else is shown.
    names
        One per picture, or None where they are numbered.
    """

    pictures: Iterator[Picture]
    count: int
    rows: int
    views: Views | None = None
    names: tuple[str, ...] | None = None


def of_stops(cube: Cube, *, target: bool, whole_shadow: bool, light: Beams) -> Show:
    """The pictures that a cube was made for, one by one."""
    rig = cube.rig.whole(cube.grid) if whole_shadow else cube.rig
    return _shown(cube, rig, cube.powers, cube.angles_deg, cube.names, light, target=target)


def of_turn(cube: Cube, angles_deg: NDArray[np.float64], *, target: bool, whole_shadow: bool, light: Beams) -> Show:
    """The one screen of a cube at some angles."""
    rig, powers = turning.moment(cube, angles_deg, whole_shadow=whole_shadow)
    return _shown(cube, rig, powers, angles_deg, None, light, target=target)


def _shown(
    cube: Cube,
    rig: Rig,
    powers: NDArray[np.float64],
    angles_deg: NDArray[np.float64],
    names: tuple[str, ...] | None,
    light: Beams,
    *,
    target: bool,
) -> Show:
    """Pictures of a rig, each beside the wanted one if asked for."""
    pictures, rows = casting.cast(cube, rig, powers, light=light), rig.picture_shape[0]
    if target:
        return Show(beside_targets(pictures, targets_of(cube), angles_deg), len(rig), rows, None, names)
    return Show(pictures, len(rig), rows, None if rig.elevation_deg is None else rig.views, names)


def of_screens(cube: Cube, angles_deg: NDArray[np.float64], *, light: Beams) -> Show:
    """All screens of each angle side by side."""

    def beside() -> Iterator[Picture]:
        for angle_deg in angles_deg:
            rig, powers = turning.moment(cube, [angle_deg])
            yield beside_each_other(list(casting.cast(cube, rig, powers, light=light)), rig.stops.window)

    return Show(beside(), len(angles_deg), int(cube.rig.stops.window[:, 0].max()))


def of_room(cube: Cube, angles_deg: NDArray[np.float64]) -> Show:
    """The room in perspective at some angles."""
    camera = camera_for(cube)
    show = room_player(cube, camera)
    return Show((show(float(angle_deg)) for angle_deg in angles_deg), len(angles_deg), camera.size[0])
