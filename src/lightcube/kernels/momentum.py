"""What momentum needs to know of a step's end, and where it then leads to (see `lightcube.solvers.display`)."""

from typing import Any

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from lightcube.kernels.display import residual

Array = NDArray[Any]


@njit(cache=True, parallel=True)
def arrive(
    last: Array, now: Array, lamp: Array, view_of_row: Array, wanted: Array, weights: Array, srgb: bool
) -> tuple[Array, Array]:
    """Of each column, the objective at absorbance `now`, and the least absorbance if it changed as much once more.

    ``lamp[view, channel]`` is ln P; the objective is half the weighted sum of squared residuals. The change was from
    absorbance `last`; all but the lamps is ``(rows, columns)``.
    """
    rows, columns = now.shape
    parts = 64
    sums = np.zeros((parts, columns))
    least = np.full((parts, columns), np.inf)
    for part in prange(parts):
        for row in range(part * rows // parts, (part + 1) * rows // parts):
            powers = lamp[view_of_row[row]]
            for column in range(columns):
                here = now[row, column]
                value, _ = residual(powers[column % len(powers)] - here, wanted[row, column], srgb)
                sums[part, column] += 0.5 * weights[row, column] * value * value
                least[part, column] = min(least[part, column], here + (here - last[row, column]))
    for part in range(1, parts):
        least[0] = np.minimum(least[0], least[part])
    return sums.sum(axis=0), least[0]


@njit(cache=True, parallel=True)
def run_ahead(last: Array, now: Array, ahead: Array) -> None:
    """Replace `last` by ``now + ahead (now - last)``, with one number of `ahead` per column."""
    rows, columns = now.shape
    for row in prange(rows):
        for column in range(columns):
            here = now[row, column]
            last[row, column] = here + ahead[column] * (here - last[row, column])
