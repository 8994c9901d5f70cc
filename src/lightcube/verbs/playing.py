"""What `play` shows: a cube's pictures at its stops or other angles, its screens side by side, or the whole room."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing.room import camera_for, room_player
from lightcube.drawing.sheet import beside_each_other, beside_targets
from lightcube.errors import InputError
from lightcube.forward import casting, turning
from lightcube.optics.cube import Cube
from lightcube.optics.rig import sampled
from lightcube.optics.views import Views
from lightcube.pictures.fitting import frames_from_targets

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


def of_turntable(cube: Cube, angles: NDArray[np.float64], *, stops: bool, target: bool, whole_screen: bool) -> Show:
    """The one screen of a turntable's cube at some angles, which are its own `stops`, or not."""
    views = cube.views if stops and not whole_screen else turning.views_at(cube, angles, whole_screen=whole_screen)
    powers = cube.powers if stops else turning.lamp_at(cube, angles)
    pictures, names = casting.cast(cube, views, powers), cube.names if stops else None
    rows = views.picture_shape[0]
    if target:
        return Show(beside_targets(pictures, frames_from_targets(cube), angles), len(views), rows, None, names)
    return Show(pictures, len(views), rows, views, names)


def of_stage(cube: Cube, angles: NDArray[np.float64], *, stops: bool, side_by_side: bool) -> Show:
    """The screens of a stage's cube: each wanted picture by itself, or all screens of each angle side by side."""
    lighting = turning.stage_of(cube)
    if stops and not side_by_side:
        pictures = casting.cast(cube, cube.views, cube.powers, lighting)
        return Show(pictures, lighting.pictures, cube.views.picture_shape[0], None, cube.names)
    angles = np.unique(angles) if stops else angles

    def beside() -> Iterator[Picture]:
        for angle in angles:
            views, shown, powers = turning.exposures_at(cube, [angle])
            yield beside_each_other(list(casting.cast(cube, views, powers, shown)), shown.window)

    return Show(beside(), len(angles), int(lighting.window[:, 0].max()))


def of_room(cube: Cube, angles: NDArray[np.float64]) -> Show:
    """The room in perspective at some angles."""
    camera = camera_for(cube)
    show = room_player(cube, camera)
    return Show((show(float(angle)) for angle in angles), len(angles), camera.size[0])


def with_samples(cube: Cube, lamp_samples: int, pixel_samples: int) -> Cube:
    """A stage's cube whose lamps' discs and pixels are sampled at so many points; `InputError` where they are."""
    if lamp_samples == pixel_samples == 1:
        return cube
    lighting = turning.stage_of(cube)
    for name, count in (("lamp_samples", lamp_samples), ("pixel_samples", pixel_samples)):
        if count > 1 and cube.provenance.get(name, 1) > 1:
            raise InputError(f"this cube was made with --{name.replace('_', '-')} and is played so: leave it out")
    views, finer = sampled(cube.views, lighting, lamp_samples=lamp_samples, pixel_samples=pixel_samples)
    return replace(cube, views=views, lighting=finer)
