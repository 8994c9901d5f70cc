"""The two-sided residual of all entries of a block (see `lightcube.solvers.display`), in runs that fill vectors.

Blocks are ``(rows, columns)``; the colour channel of column ``j`` is ``j % channels``, and ``lamp[view, channel]`` is
ln P. Rows of one view that follow each other are walked as one long run, however few columns there are. Results do
not depend on the number of threads.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled
from lightcube.kernels.descent import added
from lightcube.kernels.display import Curve, curvature, pull, residual

Array = NDArray[Any]

#: Entries of a run at most, but one row at least; parts that a block's rows are divided into.
_RUN, _PARTS = 1024, 64
#: The last step of a lamp may be so long, in ln P, by Newton's method and by bisection.
_SMALL, _TINY = 2e-3, 1e-6


@compiled
def _run(rows: int, columns: int) -> int:
    """Rows of a run at most, where a part has so many of so many columns."""
    return max(1, min(_RUN // columns, rows))


@compiled
def _repeat(few: Array, many: Array) -> None:
    """Fill `many` with copies of `few`."""
    done = min(len(few), len(many))
    many[:done] = few[:done]
    while done < len(many):  # twice as many each time: long copies are quick
        more = min(done, len(many) - done)
        many[done : done + more] = many[:more]
        done += more


@compiled
def _stretches(first: int, last: int, view_of_row: Array, columns: int) -> list[tuple[int, int, int]]:
    """What parts `first` to before `last` walk: the part, a run's first row, and one after its last, of one view."""
    rows, found = len(view_of_row), []
    most = _run(rows // _PARTS + 1, columns)
    for part in range(first, last):
        row, stop = part * rows // _PARTS, (part + 1) * rows // _PARTS
        while row < stop:
            end = row + 1
            while end < min(stop, row + most) and view_of_row[end] == view_of_row[row]:
                end += 1
            found.append((part, row, end))
            row = end
    return found


@compiled
def _room(absorbance: Array) -> Array:
    """Room for `bright` of the longest run."""
    rows, columns = absorbance.shape
    return np.empty(_run(rows // _PARTS + 1, columns) * columns, absorbance.dtype)


@compiled
def _descend_run(bright: Array, absorbance: Array, wanted: Array, weights: Array, curve: Curve) -> None:
    """Write the slopes over `bright`: where they go may be `absorbance`, which would make these no vectors."""
    for i in range(len(absorbance)):
        value, slope = residual(bright[i] - absorbance[i], wanted[i], curve)
        bright[i] = -weights[i] * value * slope


def descend(
    absorbance: Array, lamp: Array, view_of_row: Array, wanted: Array, weights: Array, curve: Curve, slopes: Array
) -> None:
    """Write the derivative of the objective by the absorbance to `slopes`, which may be `absorbance` itself.

    The objective is half the weighted sum of squared residuals.
    """
    data = absorbance, lamp, view_of_row, wanted, weights, curve, slopes
    tasks.run(_descend, _PARTS, 3 * absorbance.size, *data)


@compiled
def _descend(
    first_part: int,
    last_part: int,
    absorbance: Array,
    lamp: Array,
    view_of_row: Array,
    wanted: Array,
    weights: Array,
    curve: Curve,
    slopes: Array,
) -> None:
    columns = absorbance.shape[1]
    now, aim, out = absorbance.reshape(-1), wanted.reshape(-1), slopes.reshape(-1)
    bright = _room(absorbance)
    for _, row, end in _stretches(first_part, last_part, view_of_row, columns):
        here = slice(row * columns, end * columns)
        heavy = weights[row:end].ravel()
        _repeat(lamp[view_of_row[row]], bright)
        _descend_run(bright, now[here], aim[here], heavy, curve)
        out[here] = bright[: (end - row) * columns]


@compiled
def _arrive_run(
    bright: Array, last: Array, now: Array, wanted: Array, weights: Array, curve: Curve, sums: Array, least: Array
) -> None:
    for i in range(len(now)):
        value, _ = residual(bright[i] - now[i], wanted[i], curve)
        sums[i] += weights[i] * value * value
        least[i] = min(least[i], now[i] + (now[i] - last[i]))


def arrive(
    last: Array, now: Array, lamp: Array, view_of_row: Array, wanted: Array, weights: Array, curve: Curve
) -> tuple[Array, Array]:
    """Of each column, the objective at absorbance `now`, and the least absorbance if it changed as much once more.

    The objective is half the weighted sum of squared residuals; the change was from absorbance `last`.
    """
    rows, columns = now.shape
    room = _PARTS, _run(rows // _PARTS + 1, columns) * columns
    sums, least = np.zeros(room), np.full(room, np.inf, now.dtype)
    tasks.run(_arrive, _PARTS, 4 * now.size, last, now, lamp, view_of_row, wanted, weights, curve, sums, least)
    total = added(added(sums).reshape(-1, columns))
    return 0.5 * total, least.min(axis=0).reshape(-1, columns).min(axis=0).astype(np.float64)


@compiled
def _arrive(
    first_part: int,
    last_part: int,
    last: Array,
    now: Array,
    lamp: Array,
    view_of_row: Array,
    wanted: Array,
    weights: Array,
    curve: Curve,
    sums: Array,
    least: Array,
) -> None:
    columns = now.shape[1]
    before, after, aim = last.reshape(-1), now.reshape(-1), wanted.reshape(-1)
    bright = _room(now)
    for part, row, end in _stretches(first_part, last_part, view_of_row, columns):
        here = slice(row * columns, end * columns)
        heavy = weights[row:end].ravel()
        _repeat(lamp[view_of_row[row]], bright)
        _arrive_run(bright, before[here], after[here], aim[here], heavy, curve, sums[part], least[part])


@compiled
def _curve_run(
    bright: Array, absorbance: Array, wanted: Array, weights: Array, curve: Curve, room: Any, values: Array
) -> None:
    for i in range(len(absorbance)):
        now = bright[i] - absorbance[i]
        u = max(now, min(now + room, bright[i]))
        values[i] *= weights[i] * curvature(u, wanted[i], curve)


def curvatures(
    absorbance: Array,
    lamp: Array,
    view_of_row: Array,
    wanted: Array,
    weights: Array,
    curve: Curve,
    room: Any,
    values: Array,
) -> None:
    """Multiply `values` by the weighted `curvature` that holds while ln light rises by no more than `room`."""
    data = absorbance, lamp, view_of_row, wanted, weights, curve, room, values
    tasks.run(_curvatures, _PARTS, 3 * absorbance.size, *data)


@compiled
def _curvatures(
    first_part: int,
    last_part: int,
    absorbance: Array,
    lamp: Array,
    view_of_row: Array,
    wanted: Array,
    weights: Array,
    curve: Curve,
    room: Any,
    values: Array,
) -> None:
    columns = absorbance.shape[1]
    now, aim, out = absorbance.reshape(-1), wanted.reshape(-1), values.reshape(-1)
    bright = _room(absorbance)
    for _, row, end in _stretches(first_part, last_part, view_of_row, columns):
        here = slice(row * columns, end * columns)
        heavy = weights[row:end].ravel()
        _repeat(lamp[view_of_row[row]], bright)
        _curve_run(bright, now[here], aim[here], heavy, curve, room, out[here])


@compiled
def _pull_run(
    bright: Array, absorbance: Array, wanted: Array, weights: Array, curve: Curve, slopes: Array, bends: Array
) -> None:
    for i in range(len(absorbance)):
        first, second = pull(bright[i] - absorbance[i], wanted[i], curve)
        slopes[i] += weights[i] * first
        bends[i] += weights[i] * second


@compiled
def _pulls(
    absorbance: Array, rows: Array, wanted: Array, weights: Array, curve: Curve, lamp: Array, sums: Array
) -> None:
    """Write the first and second derivative of the objective by each channel's ln P, for some rows, to `sums`."""
    columns = absorbance.shape[1]
    now, aim = absorbance.reshape(-1), wanted.reshape(-1)
    run = _run(len(rows), columns)
    bright = np.empty(run * columns, now.dtype)
    slopes, bends = np.zeros(run * columns), np.zeros(run * columns)
    _repeat(lamp.astype(now.dtype), bright)
    k = 0
    while k < len(rows):
        row, end = rows[k], k + 1
        while end < len(rows) and end - k < run and rows[end] == row + end - k:
            end += 1
        heavy = weights[row : row + end - k].ravel()
        here = slice(row * columns, (row + end - k) * columns)
        _pull_run(bright, now[here], aim[here], heavy, curve, slopes, bends)
        k = end
    sums[:] = 0
    for i in range(len(slopes) // len(lamp)):
        for channel in range(len(lamp)):
            sums[0, channel] += slopes[i * len(lamp) + channel]
            sums[1, channel] += bends[i * len(lamp) + channel]


def fit_lamp(
    absorbance: Array,
    rows: Array,
    starts: Array,
    wanted: Array,
    weights: Array,
    curve: Curve,
    low: Array,
    high: Array,
    lamp: Array,
) -> None:
    """Replace ``lamp[view, channel]`` = ln P, where to start, by the best one between `low` and `high`.

    The rows of view v are ``rows[starts[v]:starts[v + 1]]``. Newton's method on a convex function of one number,
    kept inside a shrinking bracket by bisection; it ends with a step so small that its square no longer counts.
    """
    data = absorbance, rows, starts, wanted, weights, curve, low, high, lamp
    tasks.run(_fit_lamp, len(lamp), 10 * absorbance.size, *data)


@compiled
def _fit_lamp(
    first: int,
    last: int,
    absorbance: Array,
    rows: Array,
    starts: Array,
    wanted: Array,
    weights: Array,
    curve: Curve,
    low: Array,
    high: Array,
    lamp: Array,
) -> None:
    channels = lamp.shape[1]
    for view in range(first, last):
        below, above = low[view].copy(), high[view].copy()
        u = np.minimum(np.maximum(lamp[view], below), above)
        tried_low, tried_high = u == below, u == above
        found = np.zeros(channels, np.bool_)
        sums = np.empty((2, channels))
        for _ in range(40):
            _pulls(absorbance, rows[starts[view] : starts[view + 1]], wanted, weights, curve, u, sums)
            for c in range(channels):
                if found[c]:
                    continue
                slope, bend = sums[0, c], sums[1, c] + 1e-30
                if slope == 0:
                    found[c] = True
                    continue
                if slope > 0:
                    above[c], tried_high[c] = u[c], True
                else:
                    below[c], tried_low[c] = u[c], True
                following = u[c] - slope / bend
                newton = below[c] < following < above[c]
                if following >= above[c]:
                    following = 0.5 * (below[c] + above[c]) if tried_high[c] else high[view, c]
                    tried_high[c] = True
                elif following <= below[c]:
                    following = 0.5 * (below[c] + above[c]) if tried_low[c] else low[view, c]
                    tried_low[c] = True
                found[c] = abs(following - u[c]) < (_SMALL if newton else _TINY)
                u[c] = following
            if np.all(found):
                break
        lamp[view] = u
