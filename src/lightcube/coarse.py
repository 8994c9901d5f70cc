"""The same problem at half the size, and back: where a large cube starts from."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.frames import Frames
from lightcube.geometry import Grid, Views

Array = NDArray[np.floating[Any]]


def halved(frames: Frames, grid: Grid) -> tuple[Frames, Grid]:
    """Return the same pictures and cube with voxels and pixels twice as large, an odd last half voxel added.

    Pixels are means in linear light, their weights the mean weight; both cubes and all pictures share their centres.
    """
    nz, ny, nx = grid.shape
    small = Grid(((nz + 1) // 2, (ny + 1) // 2, (nx + 1) // 2), 2 * grid.voxel_mm)
    rows, columns = frames.views.picture_shape
    down, across = _halving(rows), _halving(columns)
    views = frames.views
    shape = (len(down), len(across))
    weight = np.empty((len(frames), *shape), np.float32)
    pictures = np.ones((*weight.shape, frames.pictures.shape[-1]), np.float32)
    for view, picture in enumerate(frames.pictures):  # one by one, for the memory
        weight[view] = down @ frames.weight[view] @ across.T
        light = np.einsum("ir,rck,jc->ijk", down, picture * frames.weight[view, ..., None], across, optimize=True)
        part = weight[view, ..., None]
        np.divide(light, part, out=pictures[view], where=part > 0)
    halves = Views(views.lamps, views.origins, 2 * views.column_steps, 2 * views.row_steps, shape)
    return replace(frames, pictures=pictures, views=halves, weights=weight), small


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


def _halving(count: int) -> NDArray[np.float32]:
    """``(coarse, count)``: the share of each coarse pixel that each of `count` pixels covers; middles coincide."""
    coarse = math.ceil(count / 2)
    starts = np.arange(count) + coarse - count / 2
    edges = 2 * np.arange(coarse)[:, None]
    covered = np.minimum(starts + 1, edges + 2) - np.maximum(starts, edges)
    return (np.maximum(covered, 0) / 2).astype(np.float32)
