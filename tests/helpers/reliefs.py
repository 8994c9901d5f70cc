"""Deliberately plain second implementations of reliefs: their light, by formula, by marching and by triangles."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

#: Where lamps of the pictures are, as steps of row and column towards them: right, left, behind, in front.
TOWARDS = ((0, 1), (0, -1), (-1, 0), (1, 0))


def plain_light(heights: Array, lamp: int, slope: float = 1.0) -> Array:
    """The lit share of every column, from the definition: everything on the way to the lamp, one column at a time."""
    rows, columns = heights.shape
    down, right = TOWARDS[lamp]
    light = np.ones(heights.shape)
    for row in range(rows):
        for column in range(columns):
            k, shade = 1, 0.0
            while 0 <= row + k * down < rows and 0 <= column + k * right < columns:
                above = heights[row + k * down, column + k * right] - (k - 1) * slope - heights[row, column]
                shade = max(shade, min(1.0, above / slope))
                k += 1
            light[row, column] = 1 - shade
    return light


def marched(heights: Array, azimuth_deg: float, slope: float = 1.0, over: int = 8) -> Array:
    """The lit share by small steps from `over` squared points of each column towards the lamp, all at once."""
    rows, columns = heights.shape
    y, x = np.meshgrid((np.arange(rows * over) + 0.5) / over, (np.arange(columns * over) + 0.5) / over, indexing="ij")
    right, up = math.cos(math.radians(azimuth_deg)), math.sin(math.radians(azimuth_deg))
    start = heights[y.astype(int), x.astype(int)]
    lit, step = np.ones(start.shape, bool), 0.25 / over
    for number in range(1, math.ceil(heights.max() / slope / step) + 1):
        way = (number + 1e-6) * step
        at_y, at_x = y - up * way, x + right * way
        inside = (at_y >= 0) & (at_y < rows) & (at_x >= 0) & (at_x < columns)
        i, j = (np.where(inside, at, 0).astype(int) for at in (at_y, at_x))
        lit &= ~(inside & (heights[i, j] > start + way * slope + 1e-9))
    return lit.reshape(rows, over, columns, over).mean(axis=(1, 3))


def plain_blur(picture: Array, taps: Array) -> Array:
    """A blur of rows and columns, with nothing beyond the edges."""
    rows, columns = picture.shape
    radius = len(taps) // 2
    padded = np.pad(picture, radius)
    down = sum(tap * padded[k : k + rows] for k, tap in enumerate(taps))
    return np.asarray(sum(tap * down[:, k : k + columns] for k, tap in enumerate(taps)))


def objective(heights: Array, wanted: Array, slopes: Array, shares: Array, taps: Array, smooth: float) -> float:
    """What the global method minimises, all anew; `wanted` ``(picture, row, column)``."""
    total = smooth * sum(np.abs(np.diff(heights, axis=axis)).sum() for axis in (0, 1))
    blurred = np.stack([plain_blur(each, taps) for each in wanted])
    slope_of_display = np.maximum(blurred, 0.03) ** (1 / 2.4 - 1)
    weight = slope_of_display**2 / np.mean(slope_of_display**2)
    for slope, share in zip(slopes, shares, strict=True):
        for lamp, target in enumerate(wanted):
            error = plain_blur(plain_light(heights, lamp, slope) - target, taps)
            total += share * np.sum(weight[lamp] * error**2)
    return float(total)


def cast_by_triangles(mesh: Any, points: Array, to_lamp: Array) -> Array:
    """Whether each point ``(x, y, z)`` sees the lamp past all triangles of a mesh."""
    a, b, c = (mesh.triangles[:, corner] for corner in range(3))
    along, across = b - a, c - a
    normal = np.cross(to_lamp, across)
    slant = np.einsum("ij,ij->i", along, normal)
    meets = np.abs(slant) > 1e-12
    along, across, normal, a = (each[meets] for each in (along, across, normal, a))
    inverse = 1 / slant[meets]
    lit = np.ones(len(points), bool)
    for number, point in enumerate(points):
        off = point - a
        u = np.einsum("ij,ij->i", off, normal) * inverse
        turned = np.cross(off, along)
        v = turned @ to_lamp * inverse
        way = np.einsum("ij,ij->i", across, turned) * inverse
        lit[number] = not np.any((u >= 0) & (v >= 0) & (u + v <= 1) & (way > 1e-6))
    return lit
