"""Where on the screen each picture stands."""

import math

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.optics.grid import Grid, raster_shape
from lightcube.pictures.targets import Targets


def spread_over_screen(targets: Targets, grid: Grid, pixels: int | None = None) -> NDArray[np.intp]:
    """Whole pixels ``(view, 2)``, right and down, by which to move each picture so that neighbours fight less.

    Going round by angle, pictures stand high, in the middle and low in turn, and left and right in turn, so that
    each needs other voxels than its neighbours.

    Parameters
    ----------
    pixels
        How far at most; default half the shorter side of a picture. Up and down it is no more than keeps the picture
        on the screen, sideways no more than half of what keeps it within the narrowest shadow: measured, more costs.
    """
    rows, columns = targets.rig.picture_shape
    far = min(rows, columns) // 2 if pixels is None else pixels
    if far < 0:
        raise InputError(f"pictures cannot be moved by {far} pixels: give a whole number of at least 0")
    views = targets.rig.views
    high, wide = views.pixel_in(grid)
    screen = min(raster_shape(grid, elevation_deg, high)[0] for elevation_deg in views.elevations_deg)
    aside = min(far, max(0, (math.floor(min(grid.shape[1:]) / wide + 1e-9) - columns) // 4))
    up = min(far, (screen - rows) // 2)
    rank = np.argsort(np.argsort(targets.angles_deg, kind="stable"), kind="stable")
    return np.stack([np.array([aside, -aside])[rank % 2], np.array([up, 0, -up])[rank % 3]], axis=1).astype(np.intp)
