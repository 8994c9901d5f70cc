"""A projected gradient step with momentum, in one walk through memory (see `lightcube.solvers.display`)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled

Array = NDArray[Any]

#: Parts that rows are divided into where they are summed; few columns are walked as one long run of so many numbers.
_PARTS, _RUN = 64, 512


def step(
    x: Array,
    before: Array,
    ahead: Array,
    slopes: Array,
    steps: Array,
    stride: Array,
    lower: float | Array,
    upper: float,
) -> Array:
    """Replace `before` by the point after `x`; return for each column how much the momentum points uphill.

    With ``y = x + ahead (x - before)`` the new point is ``y - stride steps slopes``, kept between the bounds, and
    what is returned is the sum of ``(y - new) (new - x) / steps``. Arrays are ``(unknowns, columns)``, but ``ahead``
    and ``stride``, and ``lower`` where it is no number, one number per column; unknowns with a step of 0 stay where
    they are.
    """
    rows, columns = x.shape
    lines = max(1, min(_RUN // columns, rows // _PARTS))
    least = np.full(columns, lower, x.dtype)
    patterns = (np.tile(each, lines) for each in (ahead, stride, least))
    sums = np.zeros((_PARTS, lines * columns))
    tasks.run(_step, _PARTS, x.size, x, before, slopes, steps, *patterns, upper, sums)
    return added(added(sums).reshape(lines, columns))


@compiled
def _step(
    first: int,
    last: int,
    x: Array,
    before: Array,
    slopes: Array,
    steps: Array,
    ahead: Array,
    stride: Array,
    lower: Array,
    upper: float,
    sums: Array,
) -> None:
    rows, columns = x.shape
    now, old, pull, length = x.reshape(-1), before.reshape(-1), slopes.reshape(-1), steps.reshape(-1)
    for part in range(first, last):
        stop = (part + 1) * rows // _PARTS * columns
        for start in range(part * rows // _PARTS * columns, stop, len(ahead)):
            here = slice(start, min(start + len(ahead), stop))
            _step_run(now[here], old[here], pull[here], length[here], ahead, stride, lower, upper, sums[part])


@compiled(error_model="numpy")  # else a division could end in an error, which no vector can
def _step_run(
    x: Array,
    before: Array,
    slopes: Array,
    steps: Array,
    ahead: Array,
    stride: Array,
    lower: Array,
    upper: float,
    sums: Array,
) -> None:
    for i in range(len(x)):
        here, length = x[i], steps[i]
        start = here + ahead[i] * (here - before[i])
        new = min(max(start - stride[i] * length * slopes[i], lower[i]), upper)
        before[i] = new if length > 0 else here
        sums[i] += (start - new) * (new - here) / length if length > 0 else 0


@compiled
def added(sums: Array) -> Array:
    """The sum of all rows, added in their order."""
    return sums.sum(axis=0)


def expect(x: Array, share: float, out: Array) -> None:
    """Write how far each unknown may move, relative to the others of its column: ``|x|`` and `share` of its mean.

    Where all of a column is 0, it is 1.
    """
    sums = np.zeros((_PARTS, x.shape[1]))
    tasks.run(_add, _PARTS, x.size, x, sums)
    more = (share * added(sums) / len(x)).astype(x.dtype)
    more[more == 0] = 1
    tasks.run(_expect, len(x), x.size, x, more, out)


@compiled
def _add(first: int, last: int, x: Array, sums: Array) -> None:
    rows, columns = x.shape
    for part in range(first, last):
        for row in range(part * rows // _PARTS, (part + 1) * rows // _PARTS):
            for column in range(columns):
                sums[part, column] += abs(x[row, column])


@compiled
def _expect(first: int, last: int, x: Array, more: Array, out: Array) -> None:
    for row in range(first, last):
        for column in range(x.shape[1]):
            out[row, column] = abs(x[row, column]) + more[column]


def divide(numerators: Array, denominators: Array) -> None:
    """Replace positive `denominators` by the quotients, all others by 0."""
    tasks.run(_divide, len(numerators), numerators.size, numerators, denominators)


@compiled
def _divide(first: int, last: int, numerators: Array, denominators: Array) -> None:
    for row in range(first, last):
        for column in range(numerators.shape[1]):
            below = denominators[row, column]
            denominators[row, column] = numerators[row, column] / below if below > 0 else 0
