"""Where the points of a block land on the pictures of a rig."""

import itertools

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig

#: How much nearer to a lamp than its middle a block may come.
_NEAREST = 1e-3


def matrices(rig: Rig) -> Reals:
    """``(pictures, 3, 4)``: ``(x, y, z, 1)`` in mm to ``(column * w, row * w, w)``, w = 1 at the block's middle.

    A row and column are counted from the middle of the picture's first pixel.
    """
    views = rig.views
    made = np.empty((len(views), 3, 4))
    middles = (np.array(views.picture_shape[::-1]) - 1) / 2
    for number, lamp in enumerate(views.lamps):
        origin, across, down = (each[number] for each in (views.origins_mm, views.column_steps_mm, views.row_steps_mm))
        is_point = lamp[3] == 1
        third = origin - lamp[:3] if is_point else -lamp[:3]
        parts = np.linalg.inv(np.column_stack([across, down, third]))
        start = lamp[:3] if is_point else origin
        onto = np.column_stack([parts, -parts @ start])
        if not is_point:
            onto[2] = (0.0, 0.0, 0.0, 1.0)
        made[number] = onto / onto[2, 3]
        made[number, :2] += middles[:, None] * made[number, 2]
    return made


def of_voxels(onto: Reals, grid: Grid) -> Reals:
    """The same for voxels' places ``(z, y, x)``, counted from the middle of the first voxel."""
    sides, halves = grid.sides_mm, (np.array(grid.shape[::-1]) - 1) / 2
    place = np.zeros((4, 4))
    place[[0, 1, 2], [2, 1, 0]] = sides
    place[:3, 3] = -sides * halves
    place[3, 3] = 1
    return np.ascontiguousarray(onto @ place)


def finer(onto: Reals, times: int) -> Reals:
    """The same for pictures of `times` as many pixels along each side."""
    made = onto.copy()
    made[:, :2] = times * onto[:, :2] + (times - 1) / 2 * onto[:, 2:]
    return made


def rays(rig: Rig, grid: Grid) -> Reals:
    """``(pictures, 3, 5)``: rays of pixels in voxels, as `lightcube.kernels.reach.depths` takes them.

    A place on one is that of its pixel on the screen; the way there is the light's, or from a point lamp.
    """
    views = rig.views
    sides, halves = grid.sides_mm[::-1], (np.array(grid.shape) - 1) / 2
    rows, columns = views.picture_shape
    made = np.zeros((len(views), 3, 5))
    for number, lamp in enumerate(views.lamps):
        origin, across, down = (
            each[number, ::-1] / sides for each in (views.origins_mm, views.column_steps_mm, views.row_steps_mm)
        )
        made[number, :, 0], made[number, :, 1] = across, down
        made[number, :, 2] = origin + halves - (columns - 1) / 2 * across - (rows - 1) / 2 * down
        if lamp[3] == 1:
            made[number, :, 3], made[number, :, 4] = 1.0, -(lamp[2::-1] / sides + halves)
        else:
            made[number, :, 4] = lamp[2::-1] / sides
    return made


def voxels_a_pixel(rig: Rig, grid: Grid) -> Reals:
    """``(pictures,)``: how many voxels wide what a pixel shows is in the block's middle, by its shorter side."""
    views = rig.views
    sides = np.minimum(*(np.linalg.norm(each, axis=1) for each in (views.column_steps_mm, views.row_steps_mm)))
    lamps = views.lamps[:, :3]
    away = np.where(
        views.lamps[:, 3] == 1, np.linalg.norm(lamps, axis=1) / np.linalg.norm(views.origins_mm - lamps, axis=1), 1.0
    )
    return np.asarray(sides * away / grid.voxel_mm)


def check_rig(rig: Rig, grid: Grid) -> None:
    """Raise `InputError` where a picture has not one lamp, or a lamp does not stand clear of the block."""
    if len(rig.views) != len(rig):
        raise InputError("an opaque object casts one shadow for each lamp: let one lamp light each picture")
    corners = np.array(list(itertools.product(*((-side / 2, side / 2) for side in grid.size_mm[::-1]))))
    for number, onto in enumerate(matrices(rig)):
        if not np.all(corners @ onto[2, :3] + onto[2, 3] > _NEAREST):
            name = rig.lamps.names[int(rig.sums.lamp[number])]
            raise InputError(
                f"lamp {name!r} of picture {number + 1} stands in the block or too near to it, "
                "and light would go back from there: move it further away, before the screen"
            )
