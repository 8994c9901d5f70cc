"""The hull as a field: the greatest signed distance over all silhouettes, below 0 where an object may stand."""

import math

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Volume, locked
from lightcube.optics.grid import Grid
from lightcube.solids import projections
from lightcube.solids.silhouettes import Silhouettes


def hull_field(silhouettes: Silhouettes, grid: Grid, *, is_skipping: bool = True) -> Volume:
    """``(z, y, x)`` float32: how many voxels each one's middle is outside the hull (A. Laurentini, 1994).

    The middle of a voxel that lands inside every silhouette is inside; the block's faces bound the hull too. Values are
    multiples of 1/256 that are never 0, and 8 at most.

    Parameters
    ----------
    is_skipping
        Whether bricks of which some silhouette lets nothing stand are skipped: their voxels are 8 then, and all others
        the same.
    """
    from lightcube.kernels import hull, tasks  # here: the compiler comes with it

    projections.check_rig(silhouettes.rig, grid)
    onto = projections.of_voxels(projections.matrices(silhouettes.rig), grid)
    widths = projections.voxels_a_pixel(silhouettes.rig, grid)
    field = np.empty(grid.shape, np.float32)
    layers = -(-grid.shape[0] // hull.BRICK)
    work = 5 * math.prod(grid.shape) * len(silhouettes)
    tasks.run(hull.hull_field, layers, work, silhouettes.distances, onto, widths, is_skipping, field)
    return locked(field)


def check_stands(field: Volume) -> None:
    """Raise `InputError` where nothing of a hull is left."""
    if not np.any(field < 0):
        raise InputError(
            "nothing casts shadows in all these silhouettes: look whether they are of one object, at these angles, "
            "and not inverted (--invert)"
        )
