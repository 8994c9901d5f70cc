"""Products with a matrix of rays whose pieces are kept: what is traced once need not be found anew in every product.

The pieces of equation i are ``places[offsets[i] : offsets[i + 1]]``, the voxels, and `weights`, the lengths in them;
those of the transpose, voxel by voxel, are the equations. Products of either go along the lists, so that no two threads
write the same number, and sums do not depend on how many threads there are. The other data are those of
`lightcube.kernels.rays`.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled
from lightcube.kernels.marching import ABREAST
from lightcube.kernels.ray import FIELDS, Triple, most_pieces
from lightcube.kernels.rays import trace_rows
from lightcube.kernels.tiles import paper

Array = NDArray[Any]


def count(
    rays: tuple[Array, Array, Array], shape: tuple[int, int], heard: Array, grid: Triple, sides: tuple[float, float]
) -> Array:
    """Where the pieces of each ray begin, and those of the last end; `trace` has the data."""
    offsets = np.zeros(heard.size + 1, np.int64)
    nothing = np.empty(0, np.uint32), np.empty(0, np.float32)
    tasks.run(_trace, len(heard), 3 * heard.size * sum(grid), *rays, shape, heard, grid, *sides, offsets, *nothing)
    return np.cumsum(offsets, out=offsets)


def trace(
    rays: tuple[Array, Array, Array],
    shape: tuple[int, int],
    heard: Array,
    grid: Triple,
    sides: tuple[float, float],
    offsets: Array,
) -> tuple[Array, Array, Array]:
    """`offsets`, as `count` gives them, and places and weights of the pieces of all rays.

    `rays` are lamps, screens and lines, `sides` a voxel's width and how many times as high it is.
    """
    places, weights = np.empty(offsets[-1], np.uint32), np.empty(offsets[-1], np.float32)
    work = 3 * heard.size * sum(grid)
    tasks.run(_trace, len(heard), work, *rays, shape, heard, grid, *sides, offsets, places, weights)
    return offsets, places, weights


@compiled
def _trace(
    first: int,
    last: int,
    lamps: Array,
    screens: Array,
    lines: Array,
    shape: tuple[int, int],
    heard: Array,
    grid: Triple,
    scale: float,
    tall: float,
    offsets: Array,
    places: Array,
    weights: Array,
) -> None:
    """Write the pieces of picture columns `first` to before `last`; where there is no room, count equation i's.

    The count goes to ``offsets[i + 1]``.
    """
    width, height = shape
    nz, ny, nx = grid
    size, strides = (nx, ny, nz), (nz, nx * nz, 1)
    state, traced = np.zeros((FIELDS, ABREAST)), paper(0, most_pieces(nx, ny, nz), weights)
    for line in range(first, last):
        lamp, screen, column = lamps[line // width], screens[line // width], line % width
        own, row, before, at = lines[line % len(lines)], 0, -1, 0
        while row < height:
            row, met = trace_rows(
                *(lamp, screen, own, heard[line], column, row, height, (0, 0, 0), size, strides, scale, tall),
                *(state, traced),
            )
            for lane in range(met):
                ray, count = line * height + traced.rays[lane], traced.counts[lane]
                if len(places) == 0:
                    offsets[ray + 1] += count
                    continue
                at, before = offsets[ray] if ray != before else at, ray  # a ray along a face has several parts
                for k in range(lane, lane + ABREAST * count, ABREAST):
                    places[at] = traced.places[k] + np.uint32(traced.shifts[k])
                    weights[at] = traced.weights[k]
                    at += 1


@compiled
def transposed(offsets: Array, places: Array, weights: Array, voxels: int) -> tuple[Array, Array, Array]:
    """The lists of the transpose, in each of which equations ascend."""
    ends = np.zeros(voxels + 1, np.int64)
    for place in places:
        ends[place + 1] += 1
    for voxel in range(voxels):
        ends[voxel + 1] += ends[voxel]
    rows, lengths, at = np.empty_like(places), np.empty_like(weights), ends[:-1].copy()
    for row in range(len(offsets) - 1):
        for k in range(offsets[row], offsets[row + 1]):
            here = at[places[k]]
            rows[here], lengths[here] = row, weights[k]
            at[places[k]] = here + 1
    return ends, rows, lengths


def gather(offsets: Array, places: Array, weights: Array, x: Array, sums: Array) -> None:
    """``sums[i] = sum_k weights[k] x[places[k]]`` over the pieces of each list i; every number of `sums` is written."""
    tasks.run(_gather, len(sums), 2 * len(places) + len(sums), offsets, places, weights, x, sums)


@compiled
def _gather(first: int, last: int, offsets: Array, places: Array, weights: Array, x: Array, sums: Array) -> None:
    """Do lists `first` to before `last`."""
    for i in range(first, last):
        if x.shape[1] == 3:  # the colours of most cubes: in registers
            red = green = blue = x.dtype.type(0)
            for k in range(offsets[i], offsets[i + 1]):
                place, weight = places[k], weights[k]
                red += weight * x[place, 0]
                green += weight * x[place, 1]
                blue += weight * x[place, 2]
            sums[i, 0], sums[i, 1], sums[i, 2] = red, green, blue
        else:
            sums[i] = 0
            for k in range(offsets[i], offsets[i + 1]):
                for column in range(x.shape[1]):
                    sums[i, column] += weights[k] * x[places[k], column]
