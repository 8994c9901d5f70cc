"""Search for the order of pictures: a short tour, and annealing in a model of what pictures leave unfitted."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled

Array = NDArray[Any]


@compiled
def shortest_tour(distances: Array) -> Array:
    """Return a short closed tour of points with symmetric `distances`: the nearest next point, then 2-opt.

    Every point is tried as the start. The tour returned is the shortest one found.
    """
    count = len(distances)
    best, tour, left = np.arange(count), np.empty(count, np.int64), np.empty(count, np.bool_)
    shortest = np.inf
    for start in range(count):
        left[:] = True
        at = start
        for place in range(count):
            tour[place] = at
            left[at] = False
            nearest = -1
            for other in range(count):
                if left[other] and (nearest < 0 or distances[at, other] < distances[at, nearest]):
                    nearest = other
            at = nearest
        _untangle(distances, tour)
        length = 0.0
        for place in range(count):
            length += distances[tour[place - 1], tour[place]]
        if length < shortest - 1e-9:
            shortest = length
            best[:] = tour
    return best


@compiled
def _untangle(distances: Array, tour: Array) -> None:
    """Turn round parts of `tour` in place for as long as that makes it shorter (2-opt)."""
    count = len(tour)
    shorter = True
    while shorter:
        shorter = False
        for i in range(count - 1):
            for j in range(i + 2, count):
                a, b, c, d = tour[i], tour[i + 1], tour[j], tour[(j + 1) % count]
                if distances[a, c] + distances[b, d] < distances[a, b] + distances[c, d] - 1e-9:
                    tour[i + 1 : j + 1] = tour[i + 1 : j + 1][::-1].copy()
                    shorter = True


@compiled
def misfit(parts: Array, order: Array) -> float:
    """Mean over stops of ln of the mean square that is left unfitted where ``order[stop]`` is the picture of a stop.

    ``parts[seen, stop, picture]`` is the vector that `picture` at `stop` adds to what is left at the stop `seen`.
    """
    total = 0.0
    for seen in range(len(parts)):
        left = np.zeros(parts.shape[3], parts.dtype)
        for stop in range(len(order)):
            left += parts[seen, stop, order[stop]]
        total += math.log(np.sum(left * left) / len(left) + TINY)
    return total / len(order)


#: A mean square of absorbance too small to matter.
TINY = 1e-9


@compiled(fastmath={"contract", "reassoc"})
def _left_after_swap(parts: Array, left: Array, s: int, t: int, i: int, j: int) -> float:
    """Sum over stops of ln of what is left once picture `j` stands at `s` and `i` at `t` instead of the reverse."""
    total = 0.0
    for seen in range(len(parts)):
        come_s, go_s = parts[seen, s, j], parts[seen, s, i]
        come_t, go_t = parts[seen, t, i], parts[seen, t, j]
        now = left[seen]
        square = 0.0
        for k in range(len(now)):
            value = now[k] + come_s[k] - go_s[k] + come_t[k] - go_t[k]
            square += value * value
        total += math.log(square / len(now) + TINY)
    return total


@compiled
def anneal(parts: Array, start: Array, places: Array, dice: Array, hot: float, cold: float) -> Array:
    """Return the best order met on a walk of swaps from `start` that keeps `misfit` low (simulated annealing).

    Swap `k` is of the two stops ``places[k]``. A rise of the sum over stops is accepted with probability
    ``exp(-rise / temperature)``, decided by ``dice[k]`` in [0, 1); the temperature falls geometrically from `hot` to
    `cold`.
    """
    order, best = start.copy(), start.copy()
    left = np.zeros((len(parts), parts.shape[3]), parts.dtype)
    for seen in range(len(parts)):
        for stop in range(len(order)):
            left[seen] += parts[seen, stop, order[stop]]
    now = len(order) * misfit(parts, order)
    lowest = now
    for k in range(len(places)):
        s, t = places[k, 0], places[k, 1]
        i, j = order[s], order[t]
        after = _left_after_swap(parts, left, s, t, i, j)
        temperature = hot * (cold / hot) ** (k / len(places))
        if after > now and dice[k] >= math.exp((now - after) / temperature):
            continue
        for seen in range(len(parts)):
            for m in range(left.shape[1]):
                change = parts[seen, s, j, m] - parts[seen, s, i, m] + parts[seen, t, i, m] - parts[seen, t, j, m]
                left[seen, m] += change
        order[s], order[t] = j, i
        now = after
        if now < lowest - 1e-9:
            lowest = now
            best[:] = order
    return best
