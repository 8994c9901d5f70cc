"""Means of what is constant over voxels, over boxes that lie across them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.arrays import Reals


def edges(count: int, side: float, voxels: int, voxel: float) -> Reals:
    """Where `count` boxes of a side begin and end, counted in voxels, the middle of all being that of the voxels."""
    return np.asarray((np.arange(count + 1) - count / 2) * side / voxel + voxels / 2)


def means(values: NDArray[np.floating[Any]], axis: int, cut: Reals) -> Reals:
    """The mean over each part of an axis between two cuts, which are counted in voxels; outside of all it is 0.

    Sums are taken one after the other, so they are the same however many threads there are.
    """
    count = values.shape[axis]
    first = np.moveaxis(values, axis, 0)
    sums = np.zeros((count + 1, *first.shape[1:]))
    np.cumsum(first, axis=0, out=sums[1:])
    inside = np.clip(cut, 0, count)
    below = np.minimum(inside.astype(np.intp), count - 1)
    part = (inside - below).reshape(-1, *[1] * (first.ndim - 1))
    until = sums[below] + part * first[below]
    widths = np.diff(cut).reshape(part[1:].shape)
    return np.moveaxis(np.maximum(np.diff(until, axis=0), 0) / widths, 0, axis)
