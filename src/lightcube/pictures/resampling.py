"""The same problem at half the size, and back: where a large cube starts from."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.arrays import locked
from lightcube.optics.grid import Grid
from lightcube.pictures.targets import Targets

Array = NDArray[np.floating[Any]]


def halved(targets: Targets, grid: Grid) -> tuple[Targets, Grid]:
    """Return the same pictures and cube with voxels and pixels twice as large, an odd last half voxel added."""
    return coarser(targets, grid, 2)


def coarser(targets: Targets, grid: Grid, ratio: float) -> tuple[Targets, Grid]:
    """Return the same pictures and cube with voxels and pixels `ratio` times as large, the last ones rounded up.

    Pixels are means in linear light, their weights the mean weight; both cubes and all pictures share their centres.
    """
    nz, ny, nx = (_parts(count, ratio) for count in grid.shape)
    small = grid.coarser((nz, ny, nx), ratio)
    rows, columns = targets.rig.picture_shape
    down, across = _covered(rows, ratio), _covered(columns, ratio)
    shape = (len(down), len(across))
    weight = np.empty((len(targets), *shape), np.float32)
    pictures = np.ones((*weight.shape, targets.pictures.shape[-1]), np.float32)
    for view, picture in enumerate(targets.pictures):  # one by one, for the memory
        weight[view] = down @ targets.weight[view] @ across.T
        light = np.einsum("ir,rck,jc->ijk", down, picture * targets.weight[view, ..., None], across, optimize=True)
        part = weight[view, ..., None]
        np.divide(light, part, out=pictures[view], where=part > 0)
    coarse = targets.rig.with_pixels(ratio, shape)
    return replace(targets, pictures=locked(pictures), rig=coarse, weights=locked(weight)), small


def enlarged(volume: Array, shape: tuple[int, int, int], slices: slice | None = None) -> Array:
    """`volume` ``(channel, z, y, x)`` at the voxels, or some slices, of a grid of `shape`, half as large: trilinear."""
    for axis, count in enumerate(shape, 1):
        coarse = volume.shape[axis]
        place = (np.arange(count) - (count - 1) / 2) / 2 + (coarse - 1) / 2
        if axis == 1 and slices is not None:
            place = place[slices]
        below = np.clip(np.floor(place).astype(int), 0, coarse - 1)
        above = np.clip(below + 1, 0, coarse - 1)
        part = np.clip(place - below, 0, 1).astype(volume.dtype).reshape([-1] + [1] * (3 - axis))
        volume = np.take(volume, below, axis) * (1 - part) + np.take(volume, above, axis) * part
    return volume


def _parts(count: int, ratio: float) -> int:
    """How many parts, `ratio` times as wide, cover so many."""
    return math.ceil(count / ratio - 1e-9)


def _covered(count: int, ratio: float) -> NDArray[np.float32]:
    """``(coarse, count)``: the share of each coarse pixel, `ratio` times as wide, that each of `count` pixels covers.

    Middles coincide; of the outer pixels a part may be covered by none.
    """
    coarse = _parts(count, ratio)
    starts = np.arange(count) + (coarse * ratio - count) / 2
    edges = ratio * np.arange(coarse)[:, None]
    shared = np.minimum(starts + 1, edges + ratio) - np.maximum(starts, edges)
    return (np.maximum(shared, 0) / ratio).astype(np.float32)


def shares(count: int, parts: int) -> NDArray[np.float64]:
    """``(parts, count)``: the share of each of so many equal pixels in each equal part; rows add up to 1."""
    edges, pixel = np.arange(parts + 1)[:, None] * count / parts, np.arange(count)
    shared = np.minimum(edges[1:], pixel + 1) - np.maximum(edges[:-1], pixel)
    return np.asarray(np.maximum(shared, 0) * parts / count, np.float64)
