"""What `play` shows: a cube's pictures at its stops or other angles, its screens side by side, or the whole room."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing.room import camera_for, room_player
from lightcube.drawing.sheet import beside_each_other, beside_targets
from lightcube.forward import casting
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


@dataclass(frozen=True)
class Look:
    """How screens are shown: of each the picture alone, how much finer than pixels, and in what light.

    As `lightcube.forward.casting.play` takes them.
    """

    picture_only: bool = False
    zoom: int = 1
    light: Beams = "area"

    def of(self, cube: Cube) -> Callable[[NDArray[np.float64] | None], Iterator[Picture]]:
        """A function of the angles that yields what is shown there; None = at the stops."""
        return casting.screens(cube, picture_only=self.picture_only, zoom=self.zoom, light=self.light)

    def rig(self, cube: Cube) -> Rig:
        """The cube's, with pictures as large as what is shown, in pixels."""
        return cube.rig if self.picture_only else cube.rig.whole(cube.grid)


def of_stops(cube: Cube, look: Look, *, target: bool) -> Show:
    """The pictures that a cube was made for, one by one."""
    return _shown(cube, look, look.rig(cube), look.of(cube)(None), cube.names, target=target)


def of_turn(cube: Cube, angles_deg: NDArray[np.float64], look: Look, *, target: bool) -> Show:
    """The one screen of a cube at some angles."""
    return _shown(cube, look, look.rig(cube).at(angles_deg)[0], look.of(cube)(angles_deg), None, target=target)


def _shown(
    cube: Cube, look: Look, rig: Rig, pictures: Iterator[Picture], names: tuple[str, ...] | None, *, target: bool
) -> Show:
    """Pictures of a rig, each beside the wanted one if asked for."""
    rows = look.zoom * rig.picture_shape[0]
    if target:
        beside = beside_targets(pictures, targets_of(cube), rig.stops.angle_deg, look.zoom)
        return Show(beside, len(rig), rows, None, names)
    return Show(pictures, len(rig), rows, None if rig.elevation_deg is None else rig.views, names)


def of_screens(cube: Cube, angles_deg: NDArray[np.float64], look: Look) -> Show:
    """All screens of each angle side by side."""
    rig, show = look.rig(cube), look.of(cube)

    def beside() -> Iterator[Picture]:
        for angle_deg in angles_deg:
            now, _ = rig.at([angle_deg])
            yield beside_each_other(list(show(np.array([angle_deg]))), look.zoom * now.stops.window)

    return Show(beside(), len(angles_deg), look.zoom * int(rig.stops.window[:, 0].max()))


def of_room(cube: Cube, angles_deg: NDArray[np.float64]) -> Show:
    """The room in perspective at some angles."""
    camera = camera_for(cube)
    show = room_player(cube, camera)
    return Show((show(float(angle_deg)) for angle_deg in angles_deg), len(angles_deg), camera.size[0])
