"""Beams of several views through one tile of a block of voxels, traced eight at a time."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.beam import END, FIELDS, PARALLEL, begin, beside, max_pieces, on_face
from lightcube.kernels.compiled import compiled
from lightcube.kernels.marching import ABREAST, march

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
    return rays, max_pieces(TILE, TILE, rise) + 1


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
    strides: tuple[int, int, int],
    traced: Traced,
) -> int:
    """Trace the beams of views `view` to before `after` through the tile of `nx` by `ny` voxels at ``(x, y)``.

    Of each view only the beams `low` to before `high` in its window. Returns how many meet the tile; beams along faces
    are there two or four times, on either side of them (`lightcube.kernels.beam.trace_beam`).
    """
    state = np.empty((FIELDS, ABREAST))
    met, waiting, taken = 0, 0, 0
    for each in range(view, after):
        start, step, light = beams[each, 0], beams[each, 1], beams[each, 2]
        low_each, high_each = max(low, windows[each, 0]), min(high, windows[each, 1])
        first, last = _meeting(beams, each, low_each, high_each, x, y, nx, ny)
        for column in range(first, last):
            px, py, pz = start[0] + column * step[0] - x, start[1] + column * step[1] - y, start[2] + column * step[2]
            on_x, on_y, on_z = on_face(px, light[0]), on_face(py, light[1]), on_face(pz, light[2])
            part = scale * 0.5 ** (int(on_x) + int(on_y) + int(on_z))
            for side in range(8 if on_x or on_y or on_z else 1):
                sx, sy, sz = side & 1, side >> 1 & 1, side >> 2
                if (sx and not on_x) or (sy and not on_y) or (sz and not on_z):
                    continue
                qx, qy, qz = beside(px, on_x, sx), beside(py, on_y, sy), beside(pz, on_z, sz)
                if begin(qx, qy, qz, light[0], light[1], light[2], nx, ny, part, state, waiting):
                    traced.rays[met], traced.firsts[met] = (each - view) * width + column, taken + waiting
                    met, waiting = met + 1, waiting + 1
                if waiting == ABREAST:
                    taken = _march(state, nx, ny, strides, traced, taken, met - waiting)
                    waiting = 0
    if waiting:
        state[END, waiting:] = -np.inf  # no beam
        _march(state, nx, ny, strides, traced, taken, met - waiting)
    return met


@compiled
def _march(state: Array, nx: int, ny: int, strides: tuple[int, int, int], traced: Traced, taken: int, met: int) -> int:
    """Write the pieces of the beams in `state`, the last that were met; return how much room is taken then."""
    places, shifts, weights = traced.places, traced.shifts, traced.weights
    return march(state, nx, ny, strides, places, shifts, weights, taken, traced.counts, met)


@compiled
def paper(group: int, most_rays: int, most_pieces: int, real: Array) -> Traced:
    """Room for what is traced of so many views in a tile, lengths in numbers as those of `real`."""
    rays = 4 * group * most_rays + ABREAST  # some along faces
    most = rays * (most_pieces // 4 + 2)  # of one that is not split
    rays_firsts_counts = np.empty(rays, np.int64), np.empty(rays, np.int64), np.empty(rays, np.int64)
    # places are indices: whether a signed number is below 0 would be asked every time
    return Traced(*rays_firsts_counts, np.empty(most, np.uint32), np.empty(most, np.int32), np.empty(most, real.dtype))
