"""How far the shadows of an opaque object are its silhouettes, as a cube of black glass casts them."""

from __future__ import annotations

import numpy as np

from lightcube.forward.casting import cast
from lightcube.optics.cube import Cube
from lightcube.pictures.fitting import targets_of


def overlaps(cube: Cube) -> list[float]:
    """Of each picture the shared part of the shadow and what was wanted, of all that is one of the two; 1 = the same.

    Pixels count by how dark they are, where anything was wanted of them.
    """
    found, targets = [], targets_of(cube)
    pairs = zip(cast(cube), targets.pictures, np.asarray(targets.weights), targets.rig.stops.window, strict=True)
    for picture, wanted, weight, (rows, columns) in pairs:
        counts = weight[:rows, :columns, None] > 0
        shade, given = (np.clip(1 - each[:rows, :columns], 0, 1) * counts for each in (picture, wanted))
        found.append(float(np.minimum(shade, given).sum() / max(float(np.maximum(shade, given).sum()), 1e-9)))
    return found
