"""Light on whole pixels as plainly as can be: the average of thin beams beside the pixels' middles."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.forward.turning import powers_of
from lightcube.optics.cube import Cube
from lightcube.optics.light import seeds
from lightcube.optics.rig import Rig
from tests.helpers.thin import cast

Points = Sequence[tuple[float, float]]


def over_square(count: int, step: int) -> Points:
    """Points of a pixel, across and down from its middle in its sides: a lattice on all of it."""
    return [((i + 0.5) / count - 0.5, ((step * i) % count + 0.5) / count - 0.5) for i in range(count)]


def along_row(count: int) -> Points:
    """The middles of equal parts of its width."""
    return [((i + 0.5) / count - 0.5, 0.0) for i in range(count)]


THIN: Points = [(0.0, 0.0)]
JUDGED, JUDGED_LEVEL = over_square(55, 34), along_row(16)


def judged(cube: Cube, angles_deg: Sequence[float], *, whole: bool = False) -> NDArray[Any]:
    """What a cube shows on pixels of a turntable, by the points that it is judged with."""
    one_slice = cube.rig.views.pixel_in(cube.grid)[0] < 1.5
    level = cube.rig.elevation_deg == 0 and (cube.rig.glass is None or cube.rig.glass.form != "sphere")
    points = JUDGED_LEVEL if level and one_slice else JUDGED
    return averaged(cube, angles_deg, points, whole=whole)


def averaged(
    cube: Cube, angles_deg: Sequence[float], points: Points, *, parts: int = 1, whole: bool = False
) -> NDArray[Any]:
    """Mean light over points of each pixel, or of each of its parts, ``(picture, row, column, channel)``."""
    rig, _ = (cube.rig.whole(cube.grid) if whole else cube.rig).at(angles_deg)
    powers = powers_of(cube, rig)
    light = _moved(cube, rig, powers, 0, 0).repeat(parts, axis=1).repeat(parts, axis=2)
    middles = [(part + 0.5) / parts - 0.5 for part in range(parts)]
    for i, j in np.ndindex(parts, parts):
        own = [(middles[j] + across / parts, middles[i] + down / parts) for across, down in points]
        light[:, i::parts, j::parts] = np.mean([_moved(cube, rig, powers, *point) for point in own], axis=0)
    return light


def _moved(cube: Cube, rig: Rig, powers: NDArray[Any], across: float, down: float) -> NDArray[Any]:
    """Thin beams beside the pixels' middles."""
    views = rig.views
    origins_mm = views.origins_mm + across * views.column_steps_mm + down * views.row_steps_mm
    moved = replace(rig, views=replace(views, origins_mm=origins_mm))
    return np.stack(list(cast(cube, moved, powers))).astype(np.float64)


def divided(rig: Rig, *, lamp: int = 1, pixel: int = 1) -> Rig:
    """Every view at so many points of its lamp's disc, and so many along each side of a pixel."""
    fine = (np.arange(pixel) + 0.5) / pixel - 0.5
    square = np.stack([each.ravel() for each in np.meshgrid(fine, fine)], axis=1)
    disc = seeds(lamp)
    points = np.hstack([np.repeat(square, lamp, axis=0), np.tile(disc, (len(square), 1))])
    bare = np.hstack([square, np.zeros_like(square)])
    return rig.split([points if disc_deg else bare for disc_deg in rig.sums.disc_deg])
