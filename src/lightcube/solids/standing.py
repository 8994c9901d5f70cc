"""From shapes cut out of pictures to silhouettes on the pictures of a rig."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import locked
from lightcube.optics.checks import checked
from lightcube.optics.rig import Rig
from lightcube.pictures.fitting import Fit, fill
from lightcube.solids.cutting import Cut
from lightcube.solids.silhouettes import FINE, Silhouettes
from lightcube.wording import counted


@checked
def silhouettes(cuts: Sequence[Cut], rig: Rig, ways: Fit | Sequence[Fit] = "pad") -> Silhouettes:
    """Put shapes onto the pictures of a rig, one each.

    Parameters
    ----------
    ways
        As `lightcube.fit` takes them; what is left free around a picture is ground.
    """
    fits: list[Fit] = [ways] * len(cuts) if isinstance(ways, str) else list(ways)
    if not len(cuts) == len(fits) == len(rig):
        raise InputError(f"{counted(len(cuts), 'shape')} for {counted(len(rig), 'picture')} of a rig: give one each")
    rows, columns = rig.picture_shape
    inside = np.zeros((len(rig), FINE * rows, FINE * columns), np.bool_)
    for shape, one, (high, wide), way in zip(inside, cuts, FINE * rig.stops.window, fits, strict=True):
        area = np.zeros((high, wide, 1), np.float32)
        fill(area, np.zeros((high, wide), np.float32), one.coverage[..., None], way, (0.5, 0.5))
        shape[:high, :wide] = area[..., 0] > 0.5
    return Silhouettes(locked(inside), rig, tuple(one.name for one in cuts))
