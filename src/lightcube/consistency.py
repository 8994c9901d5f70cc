"""Pre-flight: what the pictures ask of a cube that no cube can do."""

import numpy as np

from lightcube.frames import Frames
from lightcube.transfer import encode

#: Root mean square difference of display values above which two pictures are different pictures.
_DIFFERENT = 0.02


def mirror_conflicts(frames: Frames) -> list[tuple[int, int]]:
    """Pairs of views half a turn apart at elevation 0 whose pictures are not mirror images of each other.

    With level light every beam runs through the same voxels in both, so the later picture is the mirror
    image of the earlier one whatever the cube.
    """
    level = frames.views.elevations == 0
    angles = frames.views.angles
    conflicts = []
    for first in range(len(frames)):
        half_turn = np.abs(np.remainder(angles[first] + 180 - angles + 180, 360) - 180) < 1e-6
        for second in np.flatnonzero(half_turn & level & level[first]):
            if second <= first:
                continue
            shown = encode(frames.pictures[first], frames.transfer)
            mirrored = encode(frames.pictures[second][:, ::-1], frames.transfer)
            weight = frames.weight[first] * frames.weight[second][:, ::-1]
            squares = np.sum(weight[..., None] * (shown - mirrored) ** 2)
            if squares > _DIFFERENT**2 * np.sum(weight) * shown.shape[-1]:
                conflicts.append((first, int(second)))
    return conflicts
