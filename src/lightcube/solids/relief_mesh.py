"""A relief as a closed mesh: tops of columns, walls between them, and a plate below.

Every column's top is drawn in a little on all sides, so that walls lean by as much: the surface has one height at each
place, whatever the heights are. Upright walls would meet where two high columns touch at a corner only, in an edge of
four faces, which no slicer takes.
"""

from __future__ import annotations

import numpy as np

from lightcube.optics.arrays import Integers, Reals, locked
from lightcube.optics.checks import checked
from lightcube.solids.mesh import Mesh
from lightcube.solids.relief import Relief

#: How far tops are drawn in on each side, in a column's side.
LEAN = 0.02


@checked
def relief_mesh(relief: Relief) -> Mesh:
    """The plate with its base and frame, in mm: x to the right, y away, standing on z = 0.

    Its walls lean by a twenty-fifth of a column.
    """
    pitch, recipe = relief.recipe.pitch_mm, relief.recipe
    heights = recipe.base_mm + relief.heights_mm
    x, y = (_edges(count) * pitch for count in heights.shape[::-1])
    y = y[-1] - y  # the first row is the furthest away
    tops = np.repeat(np.repeat(heights, 2, axis=0), 2, axis=1)
    if recipe.frame_mm:
        frame = np.array([-recipe.frame_mm, -LEAN * pitch])
        x, y = (np.concatenate([each.min() + frame, each, each.max() - frame[::-1]]) for each in (x, y[::-1]))
        y = y[::-1]
        tops = np.pad(tops, 2, constant_values=recipe.base_mm)
        x, y = x - x.min(), y - y.min()
    return _closed(x, y, tops)


def _edges(count: int) -> Reals:
    """Where the tops of so many columns begin and end, in a column's side."""
    edges = np.stack([np.arange(count) + LEAN, np.arange(count) + 1 - LEAN], axis=1).ravel()
    edges[0], edges[-1] = 0, count
    return edges


def _closed(x: Reals, y: Reals, z: Reals) -> Mesh:
    """A surface over places `x` from left to right and `y` from the back to the front, closed below at z = 0."""
    rows, columns = z.shape
    top = np.stack([*np.meshgrid(x, y), z], axis=-1).reshape(-1, 3)
    number = np.arange(rows * columns).reshape(rows, columns)
    around = np.concatenate([number[0, :-1], number[:-1, -1], number[-1, :0:-1], number[:0:-1, 0]])  # with the clock
    below = top[around] * (1, 1, 0)
    foot = len(top) + np.arange(len(around))
    middle = np.array([[np.mean((x[0], x[-1])), np.mean((y[0], y[-1])), 0.0]])
    faces = [
        _two(number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]),
        _two(around, np.roll(around, -1), np.roll(foot, -1), foot),
        np.stack([foot, np.roll(foot, -1), np.full_like(foot, len(top) + len(foot))], axis=1),
    ]
    return Mesh(locked(np.concatenate([top, below, middle])), locked(np.concatenate(faces)))


def _two(a: Integers, b: Integers, c: Integers, d: Integers) -> Integers:
    """Two triangles of each of some quadrangles, their corners counter-clockwise."""
    a, b, c, d = (each.ravel() for each in (a, b, c, d))
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
