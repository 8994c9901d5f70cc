"""What an eye sees of light that is on its way: in coloured glass, and in the air.

Glass is walked front to back, ray by ray. A ray is what `lightcube.kernels.ray` says; lengths are in voxels' widths.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled
from lightcube.kernels.ray import MOST_PARTS, Triple, most_pieces, trace

Array = NDArray[Any]
Vector = tuple[float, float, float]

#: How much of a voxel's width shines, and how that grows with the purity of its colour.
SHINES, PURITY = 0.1, 6.0
#: Of so much absorbance no display shows what is behind.
BLACK = 24.0
#: Pieces of a beam that an eye looks along, and how quickly light is fainter away from the cube, before it.
STEPS, FAINTER = 32, 1.2


@compiled
def look(
    first: int,
    last: int,
    rays: Array,
    size: Triple,
    glass: Array,
    width: float,
    shines: bool,
    absorbed: Array,
    shining: Array,
) -> None:
    """Write the absorbance that each ray meets, by colour, and the light that the glass itself throws to its eye.

    A voxel under a white lamp shines in its own colour, the purer the more; one that is black or clear does not. What
    shines farther back is veiled by what shines before it.

    Parameters
    ----------
    rays
        ``(rays, 8)``.
    size, width
        The block's, ``(nx, ny, nz)``, and the width of a voxel in mm.
    glass
        ``(y * x * z, channels)``: extinction, 1/mm.
    shines
        Whether a lamp is on; else it is quicker.
    absorbed, shining
        ``(rays, 3)``, written to.
    """
    nx, ny, nz = size
    most = MOST_PARTS * most_pieces(nx, ny, nz)
    places, shifts, lengths = np.empty(most, np.int64), np.empty(most, np.int64), np.empty(most)
    colours = glass.shape[1]
    for i in range(first, last):
        ray = rays[i, 0], rays[i, 1], rays[i, 2], rays[i, 3], rays[i, 4], rays[i, 5], rays[i, 6], rays[i, 7]
        count = trace(ray, size, (nz, nx * nz, 1), 1.0, places, shifts, lengths)
        sums, seen = np.zeros(3), np.zeros(3)
        unveiled = 1.0
        for k in range(count):
            voxel, length = places[k] + shifts[k], lengths[k]
            red = glass[voxel, 0] * width
            green = glass[voxel, min(1, colours - 1)] * width
            blue = glass[voxel, min(2, colours - 1)] * width
            sums[0] += length * red
            sums[1] += length * green
            sums[2] += length * blue
            high, low = max(red, green, blue), min(red, green, blue)
            if shines and high > low:
                part = 1.0 - math.exp(-length * SHINES * math.log(1.0 + PURITY * (high - low)))
                laid = unveiled * part / (high - low)
                seen[0] += laid * (high - red)
                seen[1] += laid * (high - green)
                seen[2] += laid * (high - blue)
                unveiled *= 1.0 - part
            if min(sums[0], sums[1], sums[2]) > BLACK:
                break
        absorbed[i], shining[i] = sums, seen


@compiled(inline="always")
def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled(inline="always")
def _sum(a: Vector, b: Vector, part: float) -> Vector:
    """Return a + part b."""
    return a[0] + part * b[0], a[1] + part * b[1], a[2] + part * b[2]


@compiled(inline="always")
def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled(inline="always")
def _row(array: Array, i: int) -> Vector:
    return array[i, 0], array[i, 1], array[i, 2]


@compiled
def scatter(
    first: int,
    last: int,
    ways: Array,
    ends: Array,
    frame: Array,
    near: bool,
    picture: Array,
    white: Array,
    size: float,
    thrown: Array,
) -> None:
    """Write the light that dust throws to an eye out of a beam that falls on a rectangle.

    White comes from the lamp, ever fainter away from the cube's middle; behind that it has the picture's colours.

    Parameters
    ----------
    ways
        ``(rays, 3)``, 1 deep; the eye is where they begin.
    ends
        ``(rays, 3)``: depths at which a ray ends, and enters and leaves the glass, in which there is no dust.
    frame
        ``(6, 3)``, seen from the eye: the rectangle's upper left corner, its two sides, where it faces, the lamp (the
        way of its light where it is not near), the cube's middle.
    near
        Whether the lamp is at a place.
    picture
        ``(row, column, 3)``: what the rectangle shows, coarsely.
    white
        ``(3)``: the lamp's light.
    size
        Of a way as long as this, in mm, dust throws to the eye what is there once.
    thrown
        ``(rays, 2, 3)``, written to: behind the glass, and before it.
    """
    corner, across, below, facing = _row(frame, 0), _row(frame, 1), _row(frame, 2), _row(frame, 3)
    lamp, middle = _row(frame, 4), _row(frame, 5)
    rows, columns = picture.shape[:2]
    for i in range(first, last):
        way = _row(ways, i)
        start, end = _met(way, ends[i, 0], frame, near)
        thrown[i] = 0.0
        if not start < end:
            continue
        piece = (end - start) / STEPS
        part = piece * math.sqrt(_dot(way, way)) / size
        for k in range(STEPS):
            t = start + (k + 0.5) * piece
            if ends[i, 1] < t < ends[i, 2]:
                continue
            place = t * way[0], t * way[1], t * way[2]
            light = _sum(place, lamp, -1.0) if near else lamp
            slant = _dot(light, facing)
            left = _dot(_sum(corner, place, -1.0), facing) / slant if slant != 0.0 else -1.0
            if left < 0.0:  # behind the rectangle, or behind the lamp
                continue
            side = 1 if t <= ends[i, 1] else 0
            off = _sum(place, middle, -1.0)
            if _dot(off, light) <= 0.0:
                faint = part * math.exp(-FAINTER * math.sqrt(_dot(off, off)) / size)
                for c in range(3):
                    thrown[i, side, c] += faint * white[c]
                continue
            hit = _sum(_sum(place, light, left), corner, -1.0)
            x = min(max(_dot(hit, across) / _dot(across, across) * columns - 0.5, 0.0), columns - 1.0)
            y = min(max(_dot(hit, below) / _dot(below, below) * rows - 0.5, 0.0), rows - 1.0)
            column, row = min(int(x), max(columns - 2, 0)), min(int(y), max(rows - 2, 0))
            right, down = min(column + 1, columns - 1), min(row + 1, rows - 1)
            x, y = x - column, y - row
            for c in range(3):
                upper = (1.0 - x) * picture[row, column, c] + x * picture[row, right, c]
                lower = (1.0 - x) * picture[down, column, c] + x * picture[down, right, c]
                thrown[i, side, c] += part * ((1.0 - y) * upper + y * lower)


@compiled
def _met(way: Vector, solid: float, frame: Array, near: bool) -> tuple[float, float]:
    """Depths at which a ray enters and leaves the light that falls on a rectangle."""
    corner, across, below, lamp = _row(frame, 0), _row(frame, 1), _row(frame, 2), _row(frame, 4)
    far = _sum(_sum(corner, across, 1.0), below, 1.0)
    middle = _sum(_sum(corner, across, 0.5), below, 0.5)
    start, end = 0.0, solid
    for side in range(4):
        along = across if side % 2 == 0 else below
        at = corner if side < 2 else far
        normal = _cross(along, _sum(at, lamp, -1.0) if near else lamp)
        inwards = 1.0 if _dot(normal, _sum(middle, at, -1.0)) > 0.0 else -1.0
        rate, distance = inwards * _dot(normal, way), inwards * _dot(normal, at)
        if rate > 0.0:
            start = max(start, distance / rate)
        elif rate < 0.0:
            end = min(end, distance / rate)
        elif distance > 0.0:
            return 1.0, 0.0
    return start, end
