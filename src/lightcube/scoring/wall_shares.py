"""How thick the walls of an opaque object are: which part of it balls of some size reach."""

from __future__ import annotations

import numpy as np

from lightcube.optics.arrays import Reals
from lightcube.solids.shape import Shape

#: So many sizes of balls are tried, and what is so far beyond a ball's reach, in voxels, counts as reached.
_SIZES, _SLACK = 8, 0.75


def wall_shares(shape: Shape) -> tuple[Reals, Reals]:
    """Edges of classes of thickness (mm, ascending), and the part of the object whose walls are of each class.

    A wall is as thick at a voxel as the largest ball inside the object that reaches it.
    """
    from scipy import ndimage  # here: whoever prints nothing does without

    box = tuple(slice(int(each.min()), int(each.max()) + 1) for each in np.nonzero(shape.inside))
    inside = np.pad(shape.inside[box], 1)
    deep = ndimage.distance_transform_edt(inside)
    radii = np.linspace(1.0, float(deep.max()), _SIZES) if deep.max() > 1 else np.ones(1)
    reached = [
        np.count_nonzero(inside & (ndimage.distance_transform_edt(deep < radius) <= radius + _SLACK))
        for radius in radii[1:]
    ]
    whole = int(np.count_nonzero(inside))
    left = np.minimum.accumulate(np.array([whole, *reached, 0])) / whole
    # so deep a voxel is that far from the first one outside, which begins half a voxel before its middle
    thick = np.append(2 * radii - 1, 2 * radii[-1] - 1 + 2 * (radii[1] - radii[0] if len(radii) > 1 else 1.0))
    return np.asarray(thick * shape.grid.voxel_mm), np.asarray(-np.diff(left))
