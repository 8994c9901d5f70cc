"""The matrix of rays in any direction, number by number; its data are those of `lightcube.kernels.rays`."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled
from lightcube.kernels.ray import MOST_PARTS, Triple, most_pieces
from lightcube.kernels.rays import trace

Array = NDArray[Any]


@compiled
def trace_all(
    lamps: Array,
    screens: Array,
    lines: Array,
    shape: tuple[int, int],
    heard: Array,
    grid: Triple,
    scale: float,
    tall: float,
    offsets: Array,
    places: Array,
    weights: Array,
) -> None:
    """Write the pieces of equation ``i`` to ``offsets[i]`` and on, or where there is no room only count them.

    With `places` of length 0, ``offsets[i + 1]`` is set to the number of pieces up to and with equation ``i``. A pixel
    that is not heard has none.
    """
    nz, ny, nx = grid
    most = MOST_PARTS * most_pieces(nx, ny, nz)
    p, w = np.empty(most, np.int64), np.empty(most, np.float64)
    for index in range(len(offsets) - 1):
        count = 0
        if heard[index // shape[1], index % shape[1]]:
            count = trace(lamps, screens, lines, shape, index, grid, scale, tall, p, w)
        if len(places) == 0:
            offsets[index + 1] = offsets[index] + count
        else:
            here = slice(offsets[index], offsets[index] + count)
            places[here], weights[here] = p[:count], w[:count]
