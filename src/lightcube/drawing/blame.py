"""Maps of what cannot be built: what no object casts of each silhouette, in the colour of what is in its way."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from lightcube.solids.reach import Reach

#: Display levels of ground, of what can be cast, and of what misses the block.
_GROUND, _CAST, _OUTSIDE = (255, 255, 255), (70, 74, 80), (160, 160, 160)
#: Of what is in the way of others, by the picture's number: its name in sentences, and its colour.
COLOURS = (
    ("red", (214, 39, 40)),
    ("blue", (31, 119, 180)),
    ("orange", (255, 140, 0)),
    ("green", (44, 160, 44)),
    ("violet", (148, 103, 189)),
    ("brown", (140, 86, 75)),
)
#: Pixels so deep, in voxels, have the full colour; those at the edge so much of it.
_DEEP, _LEAST = 8.0, 0.45


def blame_maps(found: Reach) -> Iterator[NDArray[np.uint8]]:
    """Yield a map for each picture, ``(row, column, 3)`` display levels: deep faults in strong colours."""
    colours = np.array([colour for _, colour in COLOURS])
    for given, depth, culprit in zip(found.given, found.depth, found.culprit, strict=True):
        picture = np.where(given[..., None], np.array(_CAST), np.array(_GROUND)).astype(np.float64)
        lost = depth > 0
        strong = np.clip(_LEAST + (1 - _LEAST) * depth[lost] / _DEEP, 0, 1)[:, None]
        full = np.where(culprit[lost, None] >= 0, colours[culprit[lost] % len(COLOURS)], np.array(_OUTSIDE))
        picture[lost] = (1 - strong) * 255 + strong * full
        yield np.rint(picture).astype(np.uint8)
