"""Where momentum leads to (see `lightcube.solvers.display`)."""

from typing import Any

from numba import prange
from numpy.typing import NDArray

from lightcube.kernels.threads import parallel

Array = NDArray[Any]


@parallel
def run_ahead(last: Array, now: Array, ahead: Array) -> None:
    """Replace `last` by ``now + ahead (now - last)``, with one number of `ahead` per column."""
    rows, columns = now.shape
    for row in prange(rows):
        for column in range(columns):
            here = now[row, column]
            last[row, column] = here + ahead[column] * (here - last[row, column])
