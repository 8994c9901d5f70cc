"""Deliberately plain second implementations: slow, short, and written without looking at the fast ones."""

import itertools
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.grid import Grid
from lightcube.optics.views import Views

Array = NDArray[np.floating[Any]]


def beam_of_pixel(views: Views, view: int, row: float, column: float) -> tuple[Array, Array, float, float]:
    """A place of the raster, the way light comes to it (a unit vector), and from where to where its beam runs, in mm.

    From the definition of `Views`: parallel light runs all along the line, a point lamp's from the lamp to the pixel.
    """
    rows, columns = views.picture_shape
    point = (
        views.origins_mm[view]
        + (column - (columns - 1) / 2) * views.column_steps_mm[view]
        + (row - (rows - 1) / 2) * views.row_steps_mm[view]
    )
    if views.lamps[view, 3] == 0:
        direction = views.lamps[view, :3]
        return point, direction / np.linalg.norm(direction), -math.inf, math.inf
    way = point - views.lamps[view, :3]
    length = float(np.linalg.norm(way))
    return point, way / length if length > 0 else np.array([1.0, 0, 0]), -length, 0.0


def lengths_of_beam(
    grid: Grid, point: Array, direction: Array, first: float = -math.inf, last: float = math.inf
) -> Array:
    """Length (mm) of the beam in each voxel, ``(z, y, x)``: every voxel is a box, clipped on its own.

    The beam is ``point + t direction`` with ``first <= t <= last``. One along a face (within 1e-9 voxel) is replaced by
    beams half a voxel to either side, of half weight.
    """
    sides = [grid.voxel_mm, grid.voxel_mm, grid.voxel_mm * grid.tall]
    corner = -0.5 * np.array(sides) * np.array(grid.shape[::-1])
    choices: list[list[float]] = []
    for axis in range(3):
        place = (point[axis] - corner[axis]) / sides[axis]
        along = abs(direction[axis]) < 1e-12 and abs(place - round(place)) <= 1e-9
        choices.append([round(place) - 0.5, round(place) + 0.5] if along else [place])
    lengths = np.zeros(grid.shape)
    beams = list(itertools.product(*choices))
    for place in beams:
        lengths += _clipped(grid, corner + np.array(sides) * np.array(place), direction, corner, first, last) / len(
            beams
        )
    return lengths


def _clipped(grid: Grid, point: Array, direction: Array, corner: Array, first: float, last: float) -> Array:
    enter = np.full(grid.shape, first)
    leave = np.full(grid.shape, last)
    for axis in range(3):
        counts = [1, 1, 1]
        counts[2 - axis] = grid.shape[2 - axis]
        side = -2 * corner[axis] / grid.shape[2 - axis]
        low = (corner[axis] + side * np.arange(grid.shape[2 - axis])).reshape(counts)
        high = low + side
        if abs(direction[axis]) < 1e-12:
            outside = ~((low < point[axis]) & (point[axis] < high))
            enter = np.where(outside, np.inf, enter)
        else:
            one, other = (low - point[axis]) / direction[axis], (high - point[axis]) / direction[axis]
            enter = np.maximum(enter, np.minimum(one, other))
            leave = np.minimum(leave, np.maximum(one, other))
    return np.maximum(leave - enter, 0)


def matrix(grid: Grid, views: Views) -> Array:
    """The matrix of all voxels: equations ``(view, column, row bottom-up)``, unknowns ``(y, x, z)``."""
    rows, columns = views.picture_shape
    pixels = itertools.product(range(len(views)), range(columns), reversed(range(rows)))
    lengths = [lengths_of_beam(grid, *beam_of_pixel(views, view, row, column)) for view, column, row in pixels]
    return np.stack([each.transpose(1, 2, 0).ravel() for each in lengths])


def absorbance_pictures(grid: Grid, views: Views, extinction: Array) -> Array:
    """``(view, row, column, channel)`` absorbance of extinction ``(channel, z, y, x)``, pixel by pixel."""
    rows, columns = views.picture_shape
    pictures = np.zeros((len(views), rows, columns, len(extinction)))
    for view, row, column in np.ndindex(*pictures.shape[:3]):
        lengths = lengths_of_beam(grid, *beam_of_pixel(views, view, row, column))
        pictures[view, row, column] = np.einsum("zyx,czyx->c", lengths, extinction)
    return pictures


def back_projection(grid: Grid, views: Views, pictures: Array) -> Array:
    """``(channel, z, y, x)``: the lengths of each beam times its pixel of ``(view, row, column, channel)``, summed."""
    volume = np.zeros((pictures.shape[3], *grid.shape))
    for view, row, column in np.ndindex(*pictures.shape[:3]):
        lengths = lengths_of_beam(grid, *beam_of_pixel(views, view, row, column))
        volume += pictures[view, row, column][:, None, None, None] * lengths
    return volume


def shown_light(starts: NDArray[Any], powers: Array, light: Array, shadow: Array, absorbance: Array) -> Array:
    """``(pictures, entries)`` by the law of light: P is ``(views, channels)``, g and a are ``(views, pixels)``.

    The views of picture p are those from ``starts[p]`` to before ``starts[p + 1]``; absorbance is ``(views, entries)``.
    """
    shown = np.zeros((len(starts) - 1, absorbance.shape[1]))
    for picture, entry in np.ndindex(*shown.shape):
        pixel, channel = divmod(entry, powers.shape[1])
        for view in range(starts[picture], starts[picture + 1]):
            strength, through = shadow[view, pixel], math.exp(-absorbance[view, entry])
            kept = (1 - strength) + strength * through  # 1 - strength * (1 - through), which loses the darkest
            shown[picture, entry] += powers[view, channel] * light[view, pixel] * kept
    return shown


def srgb_decode(value: float) -> float:
    """IEC 61966-2-1, one number at a time."""
    return value / 12.92 if value <= 0.04045 else math.pow((value + 0.055) / 1.055, 2.4)
