"""Where momentum leads to (see `lightcube.solvers.display`)."""

from typing import Any

from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled

Array = NDArray[Any]


def run_ahead(last: Array, now: Array, ahead: Array) -> None:
    """Replace `last` by ``now + ahead (now - last)``, with one number of `ahead` per column."""
    tasks.run(_run_ahead, len(now), now.size, last, now, ahead)


@compiled
def _run_ahead(first: int, end: int, last: Array, now: Array, ahead: Array) -> None:
    for row in range(first, end):
        for column in range(now.shape[1]):
            here = now[row, column]
            last[row, column] = here + ahead[column] * (here - last[row, column])
