"""Pictures that are seen from the same side, or from opposite ones: they say the same, or nothing casts both."""

import itertools
from dataclasses import dataclass

import numpy as np

from lightcube.optics.arrays import Flags
from lightcube.optics.grid import Grid
from lightcube.solids import projections
from lightcube.solids.silhouettes import Silhouettes

#: Lamps that stand nearer to each other than this part of their way, or shine as alike, are at the same place.
_SAME = 1e-6


@dataclass(frozen=True)
class Pair:
    """Two pictures of which each says what the other must be.

    Parameters
    ----------
    first, second
        Their numbers.
    is_opposite
        Whether they are seen from opposite sides: in a mirror.
    overlap
        Shared part of what is dark in both, on the first one's screen, of all that is in one of them.
    """

    first: int
    second: int
    is_opposite: bool
    overlap: float


def pairs(silhouettes: Silhouettes, grid: Grid) -> list[Pair]:
    """All pairs of pictures whose rays are the same lines."""
    lamps = silhouettes.rig.views.lamps
    ways = lamps[:, :3] / np.linalg.norm(lamps[:, :3], axis=1, keepdims=True)
    found = []
    for first, second in itertools.combinations(range(len(lamps)), 2):
        if lamps[first, 3] != lamps[second, 3]:
            continue
        if lamps[first, 3] == 1:
            away = float(np.linalg.norm(lamps[first, :3]))
            is_same, is_opposite = bool(np.linalg.norm(lamps[first, :3] - lamps[second, :3]) < _SAME * away), False
        else:
            is_same, is_opposite = (bool(np.linalg.norm(ways[first] - way * ways[second]) < _SAME) for way in (1, -1))
        if is_same or is_opposite:
            own, other = silhouettes.pixels()[first], _seen_by(silhouettes, grid, first, second)
            shared, either = np.count_nonzero(own & other), np.count_nonzero(own | other)
            found.append(Pair(first, second, is_opposite, int(shared) / max(int(either), 1)))
    return found


def is_along_one_axis(silhouettes: Silhouettes) -> bool:
    """Whether all pictures are seen along one line, and none says how deep an object is."""
    lamps = silhouettes.rig.views.lamps
    if np.any(lamps[:, 3] == 1):
        return False
    ways = lamps[:, :3] / np.linalg.norm(lamps[:, :3], axis=1, keepdims=True)
    return bool(np.all(np.abs(ways @ ways[0]) > 1 - _SAME))


def _seen_by(silhouettes: Silhouettes, grid: Grid, first: int, second: int) -> Flags:
    """``(row, column)``: what of the second picture's shape is on the first one's rays."""
    from scipy import ndimage  # here: whoever compares nothing does without

    from lightcube.kernels.hull import MARGIN

    rig = silhouettes.rig
    rows, columns = rig.picture_shape
    row, column = np.indices((rows, columns)).reshape(2, -1)
    places = projections.rays(rig, grid)[first, :, :3] @ np.stack([column, row, np.ones_like(row)])
    onto = projections.of_voxels(projections.matrices(rig), grid)[second]
    across, down, w = onto @ np.vstack([places, np.ones(places.shape[1])])
    at = np.stack([down / w, across / w]) + MARGIN
    away = ndimage.map_coordinates(silhouettes.distances[second], at, order=1, cval=1.0)
    return np.asarray(away < 0).reshape(rows, columns)
