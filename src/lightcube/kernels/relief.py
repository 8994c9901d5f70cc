"""A relief of square columns under low lamps: its horizons, its light, and annealing of heights by exact changes.

Heights are in the descent of the light over one column at the elevation that a relief is made for. Planes ``(lamp,
row * column)`` are laid so that light runs along their lines: a lamp beside the rows has them as they are, one beside
the columns has them transposed. `axes` says which (0 rows, 1 columns), `signs` from which end of a line its light comes
(1 the last), `slopes` how far it descends over a column.

The horizon of a column is the highest that anything before it reaches by the time the light is there. From one column
to the next ``horizon = max(height, horizon - slope)``; what lies between it and the column's own top is in shadow.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled

Array = NDArray[Any]

#: The horizon where nothing stands in the way.
OPEN = -1e9
#: Shares of the steps that are small and that are large; all else makes a column just shade another, or just not.
_SMALL, _LARGE = 0.35, 0.7
#: How long those steps are, in a normal distribution; and among how many columns the others look.
_SHORT, _LONG, _NEAR = 0.4, 2.0, 3


@compiled(inline="always")
def lit(horizon: float, height: float, slope: float) -> float:
    """The share of a column's top that the light reaches."""
    return 1.0 - min(1.0, max(0.0, (horizon - height) / slope))


@compiled
def horizons(heights: Array, axes: Array, signs: Array, slopes: Array, lengths: Array) -> Array:
    """Horizons ``(lamp, place)`` of heights ``(2, place)``, by rows and by columns; `lengths` of their lines."""
    found = np.empty((len(axes), heights.shape[1]))
    for lamp in range(len(axes)):
        axis, sign, slope = axes[lamp], signs[lamp], slopes[lamp]
        length = lengths[axis]
        for line in range(0, heights.shape[1], length):
            horizon = OPEN
            for step in range(length):
                place = line + (length - 1 - step if sign > 0 else step)
                found[lamp, place] = horizon
                horizon = max(heights[axis, place], horizon - slope)
    return found


@compiled(inline="always")
def _proposed(heights: Array, lengths: Array, axes: Array, signs: Array, at: Array, dice: Array) -> float:
    """Another height for the column at ``(row, column)``, by four numbers in [0, 1) and a normal one; -1 = none."""
    rows, columns = lengths[1], lengths[0]
    old = heights[0, at[0] * columns + at[1]]
    kind = dice[0]
    if kind < _SMALL:
        return max(0.0, old + _SHORT * dice[4])
    if kind < _LARGE:
        return max(0.0, old + _LONG * dice[4])
    lamp, off = int(dice[1] * len(axes)), 1 + int(dice[2] * _NEAR)
    row, column = at[0], at[1]
    if axes[lamp] == 0:
        column += signs[lamp] * off
    else:
        row += signs[lamp] * off
    if row < 0 or column < 0 or row >= rows or column >= columns:
        return -1.0
    rest = (kind - _LARGE) / (1 - _LARGE) * 2
    other = heights[0, row * columns + column]
    if rest < 1:
        return max(0.0, other - (off - 1) + rest * 1.2 - 0.1)
    return max(0.0, other + (off - 1) + (rest - 1) * 1.2)


@compiled(inline="always")
def _between(
    heights: Array, lengths: Array, row: int, column: int, steepest: float, most: float
) -> tuple[float, float]:
    """The least and the greatest height that leaves no neighbour further off than `steepest`."""
    rows, columns = lengths[1], lengths[0]
    low, high = 0.0, most
    for down, right in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        if 0 <= row + down < rows and 0 <= column + right < columns:
            beside = heights[0, (row + down) * columns + column + right]
            low, high = max(low, beside - steepest), min(high, beside + steepest)
    return low, high


@compiled(inline="always")
def _rougher(heights: Array, lengths: Array, row: int, column: int, new: float) -> float:
    """How much greater the steps to the neighbours become."""
    rows, columns = lengths[1], lengths[0]
    old, sum_ = heights[0, row * columns + column], 0.0
    for down, right in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        if 0 <= row + down < rows and 0 <= column + right < columns:
            beside = heights[0, (row + down) * columns + column + right]
            sum_ += abs(beside - new) - abs(beside - old)
    return sum_


@compiled(inline="always")
def _changes(
    heights: Array, horizon: Array, place: int, line: int, length: int, sign: int, slope: float, new: float, out: Array
) -> int:
    """How the light changes where one column becomes `new`: in `out` from it on, away from the lamp; how many."""
    old, before = heights[place], horizon[place]
    out[0] = lit(before, new, slope) - lit(before, old, slope)
    count, here = 1, max(new, before - slope)
    at = place - sign
    while line <= at < line + length and here != horizon[at]:
        out[count] = lit(here, heights[at], slope) - lit(horizon[at], heights[at], slope)
        here = max(heights[at], here - slope)
        count += 1
        at -= sign
    return count


@compiled(inline="always")
def _blurred(change: Array, count: int, sign: int, taps: Array, out: Array) -> None:
    """What `count` changes are along their line once blurred, in the order of memory: ``count + len(taps) - 1``."""
    out[: count + len(taps) - 1] = 0.0
    for each in range(count):
        value = change[each]
        if value != 0.0:
            first = count - 1 - each if sign > 0 else each
            for tap in range(len(taps)):
                out[first + tap] += value * taps[tap]


@compiled(fastmath={"contract", "reassoc"})
def _worse(
    error: Array, weight: Array, start: int, count: int, length: int, bar: tuple[int, int], taps: Array, blurred: Array
) -> float:
    """How much the weighted square of `error` grows by a change that is blurred along its line and across lines.

    `start` is the first place of `blurred` in the plane, `bar` the line and how many lines there are.
    """
    radius, sum_ = len(taps) // 2, 0.0
    line, lines = bar
    left = start - line * length
    begin, end = max(0, -left), min(count, length - left)
    for across in range(max(0, line - radius), min(lines, line + radius + 1)):
        share = taps[across - line + radius]
        base = across * length + left
        for k in range(begin, end):
            change = share * blurred[k]
            sum_ += weight[base + k] * change * (2.0 * error[base + k] + change)
    return sum_


@compiled
def _add(error: Array, start: int, count: int, length: int, bar: tuple[int, int], taps: Array, blurred: Array) -> None:
    """Add a change, as `_worse` has it, to `error`."""
    radius = len(taps) // 2
    line, lines = bar
    left = start - line * length
    begin, end = max(0, -left), min(count, length - left)
    for across in range(max(0, line - radius), min(lines, line + radius + 1)):
        share = taps[across - line + radius]
        base = across * length + left
        for k in range(begin, end):
            error[base + k] += share * blurred[k]


@compiled
def _cast_on(heights: Array, horizon: Array, place: int, line: int, length: int, sign: int, slope: float) -> None:
    """Carry horizons on from one column whose height is new, as far as they change."""
    here, at = max(heights[place], horizon[place] - slope), place - sign
    while line <= at < line + length and here != horizon[at]:
        horizon[at] = here
        here = max(heights[at], here - slope)
        at -= sign


@compiled
def anneal(
    first: int,
    last: int,
    tiles: Array,
    heights: Array,
    horizon: Array,
    error: Array,
    weight: Array,
    axes: Array,
    signs: Array,
    slopes: Array,
    lengths: Array,
    taps: Array,
    dice: Array,
    looked: int,
    bounds: Array,
    temperature: float,
    smooth: float,
) -> None:
    """Propose one other height for every column of the tiles `first` to before `last`, each accepted or refused.

    Minimises ``sum weight * error ** 2 + smooth * sum |steps between neighbours|``, where `error` is the blurred light
    less what is wanted.

    Parameters
    ----------
    tiles
        ``(tile, 4)``: first row, row after the last, first column, column after the last. No change in one may reach
        what another one reads.
    heights
        ``(2, place)``, by rows and by columns.
    horizon, error, weight
        ``(lamp, place)``.
    taps
        The blur along a line.
    dice
        ``(row, column, 5)``: four numbers in [0, 1) and a normal one.
    looked
        How many of the lamps, the first ones, are looked at by steps that just shade a neighbour.
    bounds
        The greatest height, and the greatest step between neighbours.
    """
    columns, rows, radius = lengths[0], lengths[1], len(taps) // 2
    longest = max(rows, columns)
    change, blurred = np.empty(longest), np.empty((len(axes), longest + len(taps)))
    starts, counts, at = np.empty(len(axes), np.int64), np.empty(len(axes), np.int64), np.empty(2, np.int64)
    for tile in range(first, last):
        for row in range(tiles[tile, 0], tiles[tile, 1]):
            for column in range(tiles[tile, 2], tiles[tile, 3]):
                at[0], at[1] = row, column
                thrown = dice[row, column]
                new = _proposed(heights, lengths, axes[:looked], signs, at, thrown)
                low, high = 0.0, bounds[0]
                if bounds[1] < bounds[0]:
                    low, high = _between(heights, lengths, row, column, bounds[1], bounds[0])
                if new < 0 or low > high:
                    continue
                new = min(high, max(low, new))
                if new == heights[0, row * columns + column]:
                    continue
                worse = smooth * _rougher(heights, lengths, row, column, new)
                for lamp in range(len(axes)):
                    axis, sign, slope = axes[lamp], signs[lamp], slopes[lamp]
                    length, line = lengths[axis], row if axis == 0 else column
                    place = line * length + (column if axis == 0 else row)
                    count = _changes(
                        heights[axis], horizon[lamp], place, line * length, length, sign, slope, new, change
                    )
                    _blurred(change, count, sign, taps, blurred[lamp])
                    starts[lamp] = (place - count + 1 if sign > 0 else place) - radius
                    counts[lamp] = count + 2 * radius
                    bar = (line, lengths[1 - axis])
                    worse += _worse(
                        error[lamp], weight[lamp], starts[lamp], counts[lamp], length, bar, taps, blurred[lamp]
                    )
                if worse > -temperature * math.log1p(-thrown[3]):
                    continue
                heights[0, row * columns + column] = new
                heights[1, column * rows + row] = new
                for lamp in range(len(axes)):
                    axis = axes[lamp]
                    length, line = lengths[axis], row if axis == 0 else column
                    place = line * length + (column if axis == 0 else row)
                    _cast_on(heights[axis], horizon[lamp], place, line * length, length, signs[lamp], slopes[lamp])
                    bar = (line, lengths[1 - axis])
                    _add(error[lamp], starts[lamp], counts[lamp], length, bar, taps, blurred[lamp])
