"""Deliberately plain second implementations: slow, short, and written without looking at the fast ones."""

import itertools
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.geometry import Grid, Views

Array = NDArray[np.floating[Any]]


def beam_of_pixel(views: Views, view: int, row: int, column: int) -> tuple[Array, Array]:
    """A point on the beam of a pixel, and its direction, in mm, from the definition of `Views`."""
    rows, columns = views.picture_shape
    point = (
        views.origins[view]
        + (column - (columns - 1) / 2) * views.column_steps[view]
        + (row - (rows - 1) / 2) * views.row_steps[view]
    )
    direction = views.lamps[view, :3]
    return point, direction / np.linalg.norm(direction)


def lengths_of_beam(grid: Grid, point: Array, direction: Array) -> Array:
    """Length (mm) of the endless beam in each voxel, ``(z, y, x)``: every voxel is a box, clipped on its own.

    A beam along a face (within 1e-9 voxel) is replaced by beams half a voxel to either side, of half weight.
    """
    side = grid.voxel_mm
    corner = -0.5 * side * np.array(grid.shape[::-1])
    choices: list[list[float]] = []
    for axis in range(3):
        place = (point[axis] - corner[axis]) / side
        along = abs(direction[axis]) < 1e-12 and abs(place - round(place)) <= 1e-9
        choices.append([round(place) - 0.5, round(place) + 0.5] if along else [place])
    lengths = np.zeros(grid.shape)
    beams = list(itertools.product(*choices))
    for place in beams:
        lengths += _clipped(grid, corner + side * np.array(place), direction, corner) / len(beams)
    return lengths


def _clipped(grid: Grid, point: Array, direction: Array, corner: Array) -> Array:
    enter = np.full(grid.shape, -np.inf)
    leave = np.full(grid.shape, np.inf)
    for axis in range(3):
        counts = [1, 1, 1]
        counts[2 - axis] = grid.shape[2 - axis]
        low = (corner[axis] + grid.voxel_mm * np.arange(grid.shape[2 - axis])).reshape(counts)
        high = low + grid.voxel_mm
        if abs(direction[axis]) < 1e-12:
            outside = ~((low < point[axis]) & (point[axis] < high))
            enter = np.where(outside, np.inf, enter)
        else:
            first, second = (low - point[axis]) / direction[axis], (high - point[axis]) / direction[axis]
            enter = np.maximum(enter, np.minimum(first, second))
            leave = np.minimum(leave, np.maximum(first, second))
    return np.maximum(leave - enter, 0)


def absorbance_pictures(grid: Grid, views: Views, extinction: Array) -> Array:
    """``(view, row, column, channel)`` absorbance of extinction ``(channel, z, y, x)``, pixel by pixel."""
    rows, columns = views.picture_shape
    pictures = np.zeros((len(views), rows, columns, len(extinction)))
    for view, row, column in np.ndindex(*pictures.shape[:3]):
        lengths = lengths_of_beam(grid, *beam_of_pixel(views, view, row, column))
        pictures[view, row, column] = np.einsum("zyx,czyx->c", lengths, extinction)
    return pictures


def srgb_decode(value: float) -> float:
    """IEC 61966-2-1, one number at a time."""
    return value / 12.92 if value <= 0.04045 else math.pow((value + 0.055) / 1.055, 2.4)
