"""A projected gradient step with momentum, in one walk through memory (see `lightcube.solvers.display`)."""

from typing import Any

import numpy as np
from numba import prange
from numpy.typing import NDArray

from lightcube.kernels.threads import parallel

Array = NDArray[Any]


@parallel
def step(
    x: Array, before: Array, ahead: Array, slopes: Array, steps: Array, stride: Array, lower: float, upper: float
) -> Array:
    """Replace `before` by the point after `x`; return for each column how much the momentum points uphill.

    With ``y = x + ahead (x - before)`` the new point is ``y - stride steps slopes``, kept between the bounds, and
    what is returned is the sum of ``(y - new) (new - x) / steps``. Arrays are ``(unknowns, columns)``, but ``ahead``
    and ``stride`` one number per column; unknowns with a step of 0 stay where they are.
    """
    rows, columns = x.shape
    parts = 64
    sums = np.zeros((parts, columns))
    for part in prange(parts):
        for row in range(part * rows // parts, (part + 1) * rows // parts):
            for column in range(columns):
                here = x[row, column]
                length = steps[row, column]
                if length == 0:
                    before[row, column] = here
                    continue
                start = here + ahead[column] * (here - before[row, column])
                new = min(max(start - stride[column] * length * slopes[row, column], lower), upper)
                sums[part, column] += (start - new) * (new - here) / length
                before[row, column] = new
    return sums.sum(axis=0)


@parallel
def expect(x: Array, share: float, out: Array) -> None:
    """Write how far each unknown may move, relative to the others of its column: ``|x|`` and `share` of its mean.

    Where all of a column is 0, it is 1.
    """
    rows, columns = x.shape
    parts = 64
    sums = np.zeros((parts, columns))
    for part in prange(parts):
        for row in range(part * rows // parts, (part + 1) * rows // parts):
            for column in range(columns):
                sums[part, column] += abs(x[row, column])
    more = (share * sums.sum(axis=0) / rows).astype(x.dtype)
    more[more == 0] = 1
    for row in prange(rows):
        for column in range(columns):
            out[row, column] = abs(x[row, column]) + more[column]


@parallel
def divide(numerators: Array, denominators: Array) -> None:
    """Replace positive `denominators` by the quotients, all others by 0."""
    rows, columns = numerators.shape
    for row in prange(rows):
        for column in range(columns):
            below = denominators[row, column]
            denominators[row, column] = numerators[row, column] / below if below > 0 else 0
