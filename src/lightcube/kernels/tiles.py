"""Beams of several views through one tile of a block of voxels, traced eight at a time."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled
from lightcube.kernels.marching import ABREAST, march
from lightcube.kernels.ray import END, FIELDS, MOST_PARTS, PARALLEL, Triple, enter, most_pieces, parts_of

Array = NDArray[Any]

#: Voxels along the side of a tile (measured).
TILE = 16


class Traced(NamedTuple):
    """Beams that meet a tile, and their pieces.

    The i-th is number ``rays[i]``, counted from the first beam of a group of views; its ``counts[i]`` pieces are every
    `ABREAST`-th of `places`, `shifts` and `weights` from ``firsts[i]`` on. Those go up or down, never both.
    """

    rays: Array
    firsts: Array
    counts: Array
    places: Array
    shifts: Array
    weights: Array


@compiled
def room(beams: Array, width: int) -> tuple[int, int]:
    """Return how many beams of a view may meet a tile, and how many pieces one of them may have there."""
    rays, rise = 0, 0
    for view in range(len(beams)):
        step, light = beams[view, 1], beams[view, 2]
        turned = abs(step[0] * light[1] - step[1] * light[0])
        flat = math.hypot(light[0], light[1])
        spread = TILE * (abs(light[0]) + abs(light[1]))
        rays = max(rays, width if spread >= turned * width else min(width, int(spread / turned) + 4))
        rise = max(rise, int(abs(light[2]) / flat * TILE * 1.5) + 2)
    return rays, most_pieces(TILE, TILE, rise)


@compiled
def _meeting(beams: Array, view: int, low: int, high: int, x: int, y: int, nx: int, ny: int) -> tuple[int, int]:
    """Return the first of the beams `low` to before `high` of a view that may meet a tile, and one after the last."""
    start, step, light = beams[view, 0], beams[view, 1], beams[view, 2]
    turned = step[0] * light[1] - step[1] * light[0]
    if abs(turned) < PARALLEL:
        return low, high
    first, last = np.inf, -np.inf
    for corner in range(4):
        across = x - start[0] + (nx if corner & 1 else 0)
        along = y - start[1] + (ny if corner & 2 else 0)
        column = (across * light[1] - along * light[0]) / turned
        first, last = min(first, column), max(last, column)
    return int(max(float(low), math.floor(first))), int(min(float(high), math.ceil(last) + 1))


@compiled
def trace_tile(
    beams: Array,
    windows: Array,
    width: int,
    view: int,
    after: int,
    low: int,
    high: int,
    x: int,
    y: int,
    nx: int,
    ny: int,
    scale: float,
    strides: Triple,
    traced: Traced,
) -> int:
    """Trace the beams of views `view` to before `after` through the tile of `nx` by `ny` voxels at ``(x, y)``.

    Of each view only the beams `low` to before `high` in its window. Returns how many meet the tile; beams along faces
    are there two or four times, on either side of them (`lightcube.kernels.ray`).
    """
    state, size = np.zeros((FIELDS, ABREAST)), (nx, ny, 0)
    met, waiting, taken = 0, 0, 0
    for each in range(view, after):
        start, step, light, ends = beams[each, 0], beams[each, 1], beams[each, 2], beams[each, 3]
        low_each, high_each = max(low, windows[each, 0]), min(high, windows[each, 1])
        first, last = _meeting(beams, each, low_each, high_each, x, y, nx, ny)
        for column in range(first, last):
            px, py, pz = start[0] + column * step[0] - x, start[1] + column * step[1] - y, start[2] + column * step[2]
            ray = (px, py, pz, light[0], light[1], light[2], ends[0], ends[1])
            if waiting + parts_of(ray) > ABREAST:
                taken = _march(state, waiting, size, strides, traced, taken, met)
                waiting = 0
            for _ in range(enter(ray, size, scale, state, waiting)):
                traced.rays[met], traced.firsts[met] = (each - view) * width + column, taken + waiting
                met, waiting = met + 1, waiting + 1
    _march(state, waiting, size, strides, traced, taken, met)
    return met


@compiled
def _march(state: Array, waiting: int, size: Triple, strides: Triple, traced: Traced, taken: int, met: int) -> int:
    """Write the pieces of the beams `waiting` in `state`, the last that were met; return how much room is taken."""
    state[END, waiting:] = -np.inf  # no beam
    places, shifts, weights = traced.places, traced.shifts, traced.weights
    return march(state, size, strides, places, shifts, weights, taken, traced.counts, met - waiting)


@compiled
def paper(rays: int, pieces: int, real: Array) -> Traced:
    """Room for what is traced of so many beams of so many pieces each, lengths in numbers as those of `real`."""
    beams = MOST_PARTS * rays + ABREAST
    room = beams * (pieces + 1)
    rays_firsts_counts = np.empty(beams, np.int64), np.empty(beams, np.int64), np.empty(beams, np.int64)
    # places are indices: whether a signed number is below 0 would be asked every time
    return Traced(*rays_firsts_counts, np.empty(room, np.uint32), np.empty(room, np.int32), np.empty(room, real.dtype))
