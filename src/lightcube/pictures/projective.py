"""Flat things as a camera sees them: projections of the plane."""

from __future__ import annotations

import numpy as np

from lightcube.optics.arrays import Reals


def homography(before: Reals, after: Reals) -> Reals:
    """The projection ``(3, 3)`` that takes four points ``(4, 2)`` to four others."""
    rows = []
    for (x, y), (u, v) in zip(before, after, strict=True):
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y, -u], [0, 0, 0, x, y, 1, -v * x, -v * y, -v]]
    matrix = np.linalg.svd(np.array(rows))[2][-1].reshape(3, 3)
    return np.asarray(matrix / matrix[2, 2])


def projected(place: Reals, points: Reals) -> Reals:
    """Where points ``(..., 2)`` lie after a projection."""
    ahead = np.concatenate([points, np.ones((*points.shape[:-1], 1))], axis=-1) @ place.T
    return np.asarray(ahead[..., :2] / ahead[..., 2:])
