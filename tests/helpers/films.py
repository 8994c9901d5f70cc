"""Films, plainly: every beam by itself, through every film, as the conventions say."""

import numpy as np

from lightcube.optics.cube import Cube
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.optics.stage import Lamp, Screen, Shot, Stage


def stack_of(stage: Stage) -> Stack:
    """The films of a stage."""
    assert isinstance(stage.grid, Stack)
    return stage.grid


def room(stack: Stack, *, near: bool = False, low_mm: float = 0.0) -> Rig:
    """Two lamps, a screen below or in the middle, of 4 x 3 pixels of two cells, off the middle."""
    lamps = Lamp("a", direction=(0.3, 0.2, -1.0)), Lamp("b", direction=(-0.25, 0.41, -1.0))
    if near:
        lamps = Lamp("a", position_mm=(30.0, 10.0, 200.0)), Lamp("b", position_mm=(-60.0, 20.0, 150.0))
    pixel = 2 * stack.voxel_mm
    screen = Screen("w", (1.0, 0.5, low_mm), (4 * pixel, 3 * pixel), pixel, normal=(0, 0, 1), up=(0, 1, 0))
    shots = Shot("p", "w", ("a",)), Shot("q", "w", ("b",))
    return Stage(stack, lamps, (screen,), shots).rig()


def cast(cube: Cube, rig: Rig, beams: int) -> np.ndarray:
    """``(picture, row, column, channel)``: the mean over so many beams along each side of a pixel."""
    rows, columns = rig.picture_shape
    shown = np.zeros((len(rig), rows, columns, len(cube.extinction)))
    inside = (np.arange(beams) + 0.5) / beams - 0.5
    for view in range(len(rig.views)):
        total = np.zeros(shown.shape[1:])
        for right in inside:
            for down in inside:
                total += np.exp(-absorbances(cube, rig, view, right, down))
        shown[rig.sums.picture[view]] += total / beams**2 * cube.powers[rig.pair[view]]
    return shown


def absorbances(cube: Cube, rig: Rig, view: int, right: float, down: float) -> np.ndarray:
    """What the beam through a point of each pixel loses, ``(row, column, channel)``."""
    stack, views = cube.grid, rig.views
    assert isinstance(stack, Stack)
    rows, columns = rig.picture_shape
    across, along = np.meshgrid(np.arange(columns) - (columns - 1) / 2 + right, np.arange(rows) - (rows - 1) / 2 + down)
    points = views.origins_mm[view] + across[..., None] * views.column_steps_mm[view]
    points = points + along[..., None] * views.row_steps_mm[view]
    lamp = views.lamps[view]
    ways = points - lamp[:3] if lamp[3] else np.broadcast_to(lamp[:3], points.shape)
    outside = ways[..., :2] / ways[..., 2:]
    sine = np.linalg.norm(ways[..., :2], axis=-1) / np.linalg.norm(ways, axis=-1) / stack.index
    steeper = np.tan(np.arcsin(sine)) / np.maximum(np.linalg.norm(outside, axis=-1), 1e-300)
    inside = outside * (steeper[..., None] if stack.index != 1 else 1.0)
    places = films_of(stack, rig, int(rig.sums.picture[view]))
    low, high = places[:, 6].min(), places[:, 6].max()
    lost = np.zeros((rows, columns, len(cube.extinction)))
    for film, (a, b, c, d, x, y, z) in enumerate(places):
        face = np.clip(points[..., 2:], low, high) if stack.index != 1 else points[..., 2:]
        at = points[..., :2] + outside * (face - points[..., 2:]) + inside * (z - face)
        u, v = a * at[..., 0] + b * at[..., 1] + x, c * at[..., 0] + d * at[..., 1] + y
        column = np.floor(u / stack.voxel_mm + stack.shape[2] / 2).astype(int)
        row = np.floor(v / stack.voxel_mm + stack.shape[1] / 2).astype(int)
        is_on = (column >= 0) & (column < stack.shape[2]) & (row >= 0) & (row < stack.shape[1])
        met = cube.extinction[:, film, row % stack.shape[1], column % stack.shape[2]]
        longer = stack.voxel_mm * np.sqrt(1 + np.sum(inside**2, axis=-1))
        lost += np.moveaxis(met, 0, -1) * (is_on * longer)[..., None]
    return lost


def films_of(stack: Stack, rig: Rig, picture: int) -> np.ndarray:
    """Where each film lies for a picture."""
    if rig.stops.films.shape[1]:
        return rig.stops.films[picture]
    return np.array([(1, 0, 0, 1, 0, 0, z) for z in stack.heights_mm])
