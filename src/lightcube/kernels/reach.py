"""Loops along the rays of pictures: how far the other silhouettes are in the way, and which pieces a ray meets.

A ray of a view goes through a pixel's middle. Its places are where it crosses the layers of voxels' middles across the
axis that it is most along, so in parallel light along an axis they are voxels' middles.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled
from lightcube.kernels.hull import MARGIN, looked_up, projected

Array = NDArray[Any]

#: What stands in the way where a ray misses the block, and where nothing does.
BLOCK, NOTHING = -2, -1
#: Pieces that are told apart; all others are one more.
MOST_PIECES = 63


@compiled
def _ray(rays: Array, view: int, row: float, column: float, start: Array, way: Array) -> int:
    """Let `start` be a place of a pixel's ray, and `way` the way to the next layer; the axis that it goes along."""
    ray = rays[view]
    axis = 0
    for each in range(3):
        start[each] = ray[each, 0] * column + ray[each, 1] * row + ray[each, 2]
        way[each] = ray[each, 3] * start[each] + ray[each, 4]
        if abs(way[each]) > abs(way[axis]):
            axis = each
    step = way[axis]
    for each in range(3):
        way[each] /= step
    for each in range(3):
        if each != axis:
            start[each] -= start[axis] * way[each]
    start[axis] = 0.0
    return axis


@compiled
def _is_in(place: Array, shape: tuple[int, int, int]) -> bool:
    """Whether a place is in the block."""
    return (
        -0.5 <= place[0] <= shape[0] - 0.5 and -0.5 <= place[1] <= shape[1] - 0.5 and -0.5 <= place[2] <= shape[2] - 0.5
    )


@compiled
def lacking(
    distances: Array, matrices: Array, widths: Array, view: int, place: Array, enough: float
) -> tuple[float, int]:
    """What the silhouettes but one lack most at a place, in voxels, and which does; at least `enough` if that much."""
    most, worst = -np.inf, NOTHING
    for other in range(len(matrices)):
        if other == view:
            continue
        row, column = projected(matrices, other, place[0], place[1], place[2])
        lacking = widths[other] * looked_up(distances[other], row, column)
        if lacking > most:
            most, worst = lacking, other
            if most >= enough:
                break
    return most, worst


@compiled
def depths(
    first: int,
    last: int,
    distances: Array,
    matrices: Array,
    widths: Array,
    rays: Array,
    shape: tuple[int, int, int],
    depth: Array,
    culprit: Array,
    places: Array,
) -> None:
    """For pixels inside their silhouettes, in rows `first` to before `last` of all pictures one below the other.

    Parameters
    ----------
    rays
        ``(views, 3, 5)``: a place of a pixel's ray is ``rays[:, :3] @ (column, row, 1)``, in voxels, and its way there
        ``rays[:, 3] * place + rays[:, 4]``.
    depth
        ``(views, rows, columns)``: the least over the ray of what the other silhouettes lack there, in voxels; below 0
        where they let it pass. Written, as the others.
    culprit
        Which of them lacks most there; `NOTHING` where the ray passes, or is not inside.
    places
        ``(views, rows, columns, 3)``: where on the ray that is.
    """
    rows, columns = depth.shape[1:]
    start, way, place = np.empty(3), np.empty(3), np.empty(3)
    for line in range(first, last):
        view, row = line // rows, line % rows
        for column in range(columns):
            culprit[view, row, column] = NOTHING
            depth[view, row, column] = 0.0
            if distances[view, row + MARGIN, column + MARGIN] >= 0:
                continue
            axis = _ray(rays, view, row, column, start, way)
            best, who, where = np.inf, BLOCK, 0
            for layer in range(shape[axis]):
                place[:] = start + layer * way
                if _is_in(place, shape):
                    most, worst = lacking(distances, matrices, widths, view, place, best)
                    if most < best:
                        best, who, where = most, worst, layer
            depth[view, row, column] = best
            culprit[view, row, column] = who if best >= 0 else NOTHING
            places[view, row, column] = start + where * way


@compiled
def pieces_met(first: int, last: int, labels: Array, distances: Array, rays: Array, met: Array) -> None:
    """Which pieces the rays of pixels inside meet, a bit each, in rows as `depths` counts them.

    `labels` is ``(nz, ny, nx)``, 0 where nothing stands, pieces from 1 on; all from `MOST_PIECES` on have one bit.
    """
    rows, columns = met.shape[1:]
    start, way = np.empty(3), np.empty(3)
    nz, ny, nx = labels.shape
    for line in range(first, last):
        view, row = line // rows, line % rows
        for column in range(columns):
            found = np.uint64(0)
            if distances[view, row + MARGIN, column + MARGIN] < 0:
                axis = _ray(rays, view, row, column, start, way)
                for layer in range(labels.shape[axis]):
                    z = math.floor(start[0] + layer * way[0] + 0.5)
                    y = math.floor(start[1] + layer * way[1] + 0.5)
                    x = math.floor(start[2] + layer * way[2] + 0.5)
                    if 0 <= z < nz and 0 <= y < ny and 0 <= x < nx and labels[z, y, x]:
                        found |= np.uint64(1) << np.uint64(min(labels[z, y, x] - 1, MOST_PIECES))
            met[view, row, column] = found
