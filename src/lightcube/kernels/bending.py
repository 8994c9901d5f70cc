"""Loops that bend silhouettes until they agree: how much the others give way on each pixel's ray, and who does not.

A view's matrix ``(3, 4)`` takes a voxel's place ``(z, y, x, 1)`` to ``(column * w, row * w, w)``.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled

Array = NDArray[Any]

#: As far outside as a pixel is whose ray misses the block, in pixels.
MISSED = 20.0
#: Nearer to a whole number than this, the places that a ray lands on are looked up as they are.
_WHOLE = 1e-6
#: Of a pixel further outside its silhouette than this, in widths of the soft edge, the rest does not matter.
_OUTSIDE = 8.0


@compiled(error_model="numpy")
def _ray(matrix: Array, row: float, column: float, ones: Array, others: Array, point: Array, way: Array) -> int:
    """The ray of a pixel, ``point + layer * way`` in voxels: returns the axis along which `way` is 1 and `point` 0.

    `ones` and `others` are room for four numbers each.
    """
    for i in range(4):
        ones[i] = matrix[0, i] - column * matrix[2, i]
        others[i] = matrix[1, i] - row * matrix[2, i]
    axis, largest = 0, 0.0
    for i in range(3):
        b, c = (i + 1) % 3, (i + 2) % 3
        way[i] = ones[b] * others[c] - ones[c] * others[b]
        if abs(way[i]) > largest:
            axis, largest = i, abs(way[i])
    b, c = (axis + 1) % 3, (axis + 2) % 3
    determinant = way[axis]
    point[axis] = 0.0
    point[b] = (-ones[3] * others[c] + others[3] * ones[c]) / determinant
    point[c] = (-ones[b] * others[3] + others[b] * ones[3]) / determinant
    for i in range(3):
        way[i] = way[i] / determinant
    return axis


@compiled
def _bounds(shape: Array, point: Array, way: Array, axis: int) -> tuple[int, int]:
    """The first layer that a ray meets within the block, and the one after the last."""
    low, high = 0.0, shape[axis] - 1.0
    for i in range(3):
        if i == axis:
            continue
        if abs(way[i]) < 1e-12:
            if point[i] < -0.5 or point[i] > shape[i] - 0.5:
                return 0, 0
            continue
        one, other = (-0.5 - point[i]) / way[i], (shape[i] - 0.5 - point[i]) / way[i]
        low, high = max(low, min(one, other)), min(high, max(one, other))
    return math.ceil(low - 1e-9), math.floor(high + 1e-9) + 1


@compiled
def _is_whole(value: float) -> bool:
    return abs(value - math.floor(value + 0.5)) < _WHOLE


@compiled(inline="always")
def _between(distances: Array, row: float, column: float) -> float:
    """Bilinear, of the nearest place where it is beside the picture."""
    rows, columns = distances.shape
    row, column = min(max(row, 0.0), rows - 1.0), min(max(column, 0.0), columns - 1.0)
    i, j = min(int(row), rows - 2), min(int(column), columns - 2)
    down, across = row - i, column - j
    upper = (1 - across) * distances[i, j] + across * distances[i, j + 1]
    lower = (1 - across) * distances[i + 1, j] + across * distances[i + 1, j + 1]
    return (1 - down) * upper + down * lower


@compiled(error_model="numpy")
def _is_on_pixels(land: Array, low: int, high: int, rows: int, columns: int) -> bool:
    """Whether what lands from layer `low` to before `high` of a ray does so on the middles of a picture's pixels."""
    for i in range(3):
        if not (_is_whole(land[i]) and _is_whole(land[3 + i])):
            return False
    if abs(land[2] - 1) >= _WHOLE or abs(land[5]) >= _WHOLE:
        return False
    for layer in (low, high - 1):
        column, row = land[0] + layer * land[3], land[1] + layer * land[4]
        if not (-_WHOLE < column < columns - 1 + _WHOLE and -_WHOLE < row < rows - 1 + _WHOLE):
            return False
    return True


@compiled(error_model="numpy", fastmath={"nnan", "nsz"})
def _add_greater(distances: Array, land: Array, low: int, high: int, greatest: Array) -> None:
    """Take a view's distances where the layers of a ray land on it, where they are greater than what there is."""
    rows, columns = distances.shape
    if _is_on_pixels(land, low, high, rows, columns):
        flat = distances.reshape(rows * columns)
        first = round(land[1]) * columns + round(land[0])
        stride = round(land[4]) * columns + round(land[3])
        for layer in range(low, high):
            greatest[layer] = max(greatest[layer], flat[first + layer * stride])
        return
    for layer in range(low, high):
        w = land[2] + layer * land[5]
        row, column = (land[1] + layer * land[4]) / w, (land[0] + layer * land[3]) / w
        greatest[layer] = max(greatest[layer], _between(distances, row, column))


@compiled(error_model="numpy")
def _land(matrices: Array, point: Array, way: Array, land: Array) -> None:
    """Where a ray's layer 0 lands on each view's picture, ``(column w, row w, w)``, and what a layer adds to each."""
    for view in range(len(matrices)):
        for i in range(3):
            start, step = matrices[view, i, 3], 0.0
            for a in range(3):
                start += matrices[view, i, a] * point[a]
                step += matrices[view, i, a] * way[a]
            land[view, i], land[view, 3 + i] = start, step


@compiled(error_model="numpy")
def _blame(distances: Array, own: int, land: Array, layer: int, place: Array) -> int:
    """Which other view has the greatest distance where a layer of a ray lands, and the row and column of that."""
    most, culprit = -np.inf, -1
    for view in range(len(distances)):
        if view == own:
            continue
        w = land[view, 2] + layer * land[view, 5]
        row, column = (land[view, 1] + layer * land[view, 4]) / w, (land[view, 0] + layer * land[view, 3]) / w
        value = _between(distances[view], row, column)
        if value > most:
            most, culprit = value, view
            place[0], place[1] = row, column
    return culprit


@compiled(error_model="numpy")
def ways(
    first: int,
    last: int,
    distances: Array,
    matrices: Array,
    shape: Array,
    edge: float,
    deficits: Array,
    culprits: Array,
    places: Array,
) -> None:
    """Of each pixel's ray, in lines of all pictures `first` to before `last`, the place where the others give way most.

    A deficit is ``min over the ray of max over other views of their distance``: how many pixels they are short of
    letting the pixel be cast; below 0 it is cast.

    Parameters
    ----------
    distances
        ``(views, rows, columns)`` signed, in pixels, negative inside.
    shape
        ``(3,)``: of the block, in voxels.
    edge
        Width of the soft edge: pixels further outside than some of it are left out, their deficit `-MISSED`.
    deficits
        ``(views, rows, columns)``, written.
    culprits
        The same, the view with the largest distance there, -1 where the ray misses the block; written.
    places
        ``(views, rows, columns, 2)``: row and column where it lands on that view's picture; written.
    """
    views, rows, columns = distances.shape
    point, way, ones, others = np.empty(3), np.empty(3), np.empty(4), np.empty(4)
    land, greatest = np.empty((views, 6)), np.empty(max(shape[0], shape[1], shape[2]))
    for line in range(first, last):
        own, row = line // rows, line % rows
        for column in range(columns):
            culprits[own, row, column] = -1
            if distances[own, row, column] > _OUTSIDE * edge:
                deficits[own, row, column] = -MISSED
                continue
            axis = _ray(matrices[own], row, column, ones, others, point, way)
            low, high = _bounds(shape, point, way, axis)
            greatest[low:high] = -MISSED
            _land(matrices, point, way, land)
            for view in range(views):
                if view != own:
                    _add_greater(distances[view], land[view], low, high, greatest)
            deficit, at = MISSED, -1
            for layer in range(low, high):
                if greatest[layer] < deficit:
                    deficit, at = greatest[layer], layer
            deficits[own, row, column] = deficit
            if at >= 0:
                culprits[own, row, column] = _blame(distances, own, land, at, places[own, row, column])


@compiled
def pull(
    distances: Array,
    deficits: Array,
    culprits: Array,
    places: Array,
    urgency: Array,
    edge: float,
    margin: float,
    slopes: Array,
) -> float:
    """The inconsistency ``sum of S(distance) phi(deficit + margin)``, and its slope by each distance.

    ``S(d) = 1 / (1 + exp(d / edge))`` is 1 inside; ``phi(v) = v^2 / (1 + v / 8)`` of what is above 0: quadratic, then
    linear, so that pixels far off do not outweigh all others.

    Parameters
    ----------
    urgency
        ``(views, rows, columns)``: how much each pixel counts.
    slopes
        ``(views, rows, columns)`` of zeros, added to.
    """
    views, rows, columns = distances.shape
    loss = 0.0
    for own in range(views):
        for row in range(rows):
            for column in range(columns):
                short = deficits[own, row, column] + margin
                if short <= 0:
                    continue
                soft = min(max(distances[own, row, column] / edge, -30.0), 30.0)
                inside = urgency[own, row, column] / (1 + math.exp(soft))
                sharp = 1 / (edge * (1 + math.exp(-soft)))
                part = 1 + short / 8
                cost = short * short / part
                loss += inside * cost
                slopes[own, row, column] -= cost * inside * sharp
                other = culprits[own, row, column]
                if other < 0:
                    continue
                push = inside * (2 * short + short * short / 8) / (part * part)
                y = min(max(places[own, row, column, 0], 0.0), rows - 1.0)
                x = min(max(places[own, row, column, 1], 0.0), columns - 1.0)
                i, j = min(int(y), rows - 2), min(int(x), columns - 2)
                down, across = y - i, x - j
                slopes[other, i, j] += push * (1 - down) * (1 - across)
                slopes[other, i, j + 1] += push * (1 - down) * across
                slopes[other, i + 1, j] += push * down * (1 - across)
                slopes[other, i + 1, j + 1] += push * down * across
    return loss


@compiled
def bent(first: int, last: int, distances: Array, moves: Array, values: Array, slopes: Array) -> None:
    """Pictures `first` to before `last` taken from elsewhere: ``values(p) = distances(p + move(p))``, and its slope.

    Beside a picture is what its border has.

    Parameters
    ----------
    moves
        ``(views, 2, rows, columns)``: down and across, in pixels.
    values
        ``(views, rows, columns)``, written.
    slopes
        ``(views, 2, rows, columns)``: of the value by the move; written.
    """
    _, rows, columns = distances.shape
    for view in range(first, last):
        for row in range(rows):
            for column in range(columns):
                y, x = row + moves[view, 0, row, column], column + moves[view, 1, row, column]
                is_beside_y, is_beside_x = y < 0 or y > rows - 1, x < 0 or x > columns - 1
                y, x = min(max(y, 0.0), rows - 1.0), min(max(x, 0.0), columns - 1.0)
                i, j = min(int(y), rows - 2), min(int(x), columns - 2)
                down, across = y - i, x - j
                a, b = distances[view, i, j], distances[view, i, j + 1]
                c, d = distances[view, i + 1, j], distances[view, i + 1, j + 1]
                upper, lower = (1 - across) * a + across * b, (1 - across) * c + across * d
                values[view, row, column] = (1 - down) * upper + down * lower
                slopes[view, 0, row, column] = 0.0 if is_beside_y else lower - upper
                slopes[view, 1, row, column] = 0.0 if is_beside_x else (1 - down) * (b - a) + down * (d - c)
