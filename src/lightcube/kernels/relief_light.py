"""The light that the tops of square columns get from a lamp far away in any direction."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled

Array = NDArray[Any]


@compiled
def cast(first: int, last: int, heights: Array, to_lamp: Array, points: Array, out: Array) -> None:
    """The lit share of each column of the rows `first` to before `last`.

    Parameters
    ----------
    heights
        ``(row, column)``, in any unit.
    to_lamp
        Where the lamp is: how far a ray to it goes along rows, along columns, and how much it rises, over a column's
        side.
    points
        ``(point, 2)``: places on a column's top, down and right, in its sides.
    """
    highest = np.max(heights)
    for row in range(first, last):
        for column in range(heights.shape[1]):
            lit = 0
            for point in range(len(points)):
                if _is_lit(heights, row, column, points[point], to_lamp, highest):
                    lit += 1
            out[row, column] = lit / len(points)


@compiled
def _is_lit(heights: Array, row: int, column: int, point: Array, to_lamp: Array, highest: float) -> bool:
    """Whether nothing stands between a point on a column's top and the lamp: from column to column, as the ray goes."""
    rows, columns = heights.shape
    own = heights[row, column]
    down, right, rise = to_lamp[0], to_lamp[1], to_lamp[2]
    next_row, next_column, per_row, per_column = math.inf, math.inf, math.inf, math.inf
    if down != 0.0:
        per_row = 1.0 / abs(down)
        next_row = (1.0 - point[0] if down > 0.0 else point[0]) * per_row
    if right != 0.0:
        per_column = 1.0 / abs(right)
        next_column = (1.0 - point[1] if right > 0.0 else point[1]) * per_column
    while True:
        if next_column < next_row:
            way = next_column
            column += 1 if right > 0.0 else -1
            next_column += per_column
        else:
            way = next_row
            row += 1 if down > 0.0 else -1
            next_row += per_row
        ray = own + way * rise
        if row < 0 or column < 0 or row >= rows or column >= columns or ray >= highest:
            return True
        if heights[row, column] > ray:
            return False
