"""Where momentum leads to (see `lightcube.solvers.display`)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled

Array = NDArray[Any]

#: Few columns are walked as one long run of so many numbers.
_RUN = 512


def run_ahead(last: Array, now: Array, ahead: Array) -> None:
    """Replace `last` by ``now + ahead (now - last)``, with one number of `ahead` per column."""
    pattern = np.tile(ahead, max(1, _RUN // len(ahead)))
    runs = -(-now.size // len(pattern))
    tasks.run(_run_ahead, runs, now.size, last, now, pattern)


@compiled
def _run_ahead(first: int, end: int, last: Array, now: Array, ahead: Array) -> None:
    target, source, size = last.reshape(-1), now.reshape(-1), len(ahead)
    for run in range(first, end):
        here = slice(run * size, min((run + 1) * size, len(source)))
        _move(target[here], source[here], ahead)


@compiled
def _move(last: Array, now: Array, ahead: Array) -> None:
    for i in range(len(now)):
        last[i] = now[i] + ahead[i] * (now[i] - last[i])
