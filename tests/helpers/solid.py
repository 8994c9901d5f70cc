"""Silhouettes and bodies for tests of `lightcube.solids`, and plain ways to what its loops do."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.solids.silhouettes import FINE, Silhouettes
from tests.conftest import INTERPRETED

#: For loops over so many voxels that they take minutes interpreted.
compiled_only = pytest.mark.skipif(INTERPRETED, reason="takes minutes interpreted")
Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


def blobs(rig: Rig, seed: int, *, full: float = 0.4) -> Silhouettes:
    """Smooth random silhouettes that cover about so much of their pictures."""
    rows, columns = rig.picture_shape
    random = np.random.default_rng(seed)
    noise = random.normal(size=(len(rig), FINE * rows, FINE * columns))
    smooth = ndimage.gaussian_filter(noise, (0, 6, 6), mode="nearest")
    inside = smooth > np.quantile(smooth, 1 - full, axis=(1, 2), keepdims=True)
    return Silhouettes(inside, rig, tuple(map(str, range(len(rig)))))


def seen(body: Flags) -> tuple[Flags, Flags, Flags]:
    """What of a body ``(z, y, x)`` is seen from the front, the right and above, rows from above."""
    front, side, top = (np.asarray(body.any(axis=axis)) for axis in (1, 2, 0))
    return front[::-1], side[::-1], top[::-1]


def of_pixels(rig: Rig, *pictures: Flags) -> Silhouettes:
    """Silhouettes of whole pixels, each picture in the upper left of its screen."""
    rows, columns = rig.picture_shape
    inside = np.zeros((len(rig), rows, columns), np.bool_)
    for each, picture in zip(inside, pictures, strict=True):
        each[: picture.shape[0], : picture.shape[1]] = picture
    fine = inside.repeat(FINE, axis=1).repeat(FINE, axis=2)
    return Silhouettes(fine, rig, tuple(map(str, range(len(rig)))))


def around(grid: Grid, count: int) -> Rig:
    """A turntable's rig under a raised lamp."""
    return turntable(grid, np.arange(count) * 77.0 + 13, elevation_deg=25)


def windows(grid: Grid, count: int) -> Rig:
    """The same with pictures that are smaller than the block's shadow."""
    rows, columns = around(grid, 1).picture_shape
    small = rows % 2 + 2 * (rows // 5), columns % 2 + 2 * (columns // 5)
    return turntable(grid, np.arange(count) * 77.0 + 13, elevation_deg=25, picture_shape=small)


def near_lamps(grid: Grid, count: int) -> Rig:
    """Point lamps around a block, each before an upright screen of its own, none of them square to it."""
    size = max(grid.size_mm)
    angles = np.arange(count) * 2.2 + 0.3
    lamps, screens = [], []
    for number, angle in enumerate(angles):
        cos, sin = float(np.cos(angle)), float(np.sin(angle))
        lamps.append(Lamp(str(number), position_mm=(-2 * size * cos, -2 * size * sin, 0.3 * size)))
        place = (size * float(np.cos(angle + 0.2)), size * float(np.sin(angle + 0.2)), 0.0)
        screens.append(Screen(str(number), place, (2.5 * size, 2 * size), 2 * grid.voxel_mm))
    shots = tuple(Shot(lamp.name, lamp.name, (lamp.name,)) for lamp in lamps)
    return Stage(grid, tuple(lamps), tuple(screens), shots).rig()


def plain_distances(inside: Flags) -> Array:
    """Signed distances in pixels of one silhouette, at the middles of pixels, two pixels further than it goes."""
    wide = np.pad(inside, 2 * FINE)
    out, within = (ndimage.distance_transform_edt(side) for side in (~wide, wide))
    fine = np.where(wide, 0.5 - within, out - 0.5) / FINE
    rows, columns = (count // FINE for count in fine.shape)
    middles = fine.reshape(rows, FINE, columns, FINE)[
        :, FINE // 2 - 1 : FINE // 2 + 1, :, FINE // 2 - 1 : FINE // 2 + 1
    ]
    return np.asarray(middles.mean(axis=(1, 3)))


def plain_field(silhouettes: Silhouettes, grid: Grid, widths: Array) -> Array:
    """The greatest signed distance over views and the block's faces, in voxels, by meeting voxels' rays with screens.

    `widths` are those of pixels in voxels.
    """
    views = silhouettes.rig.views
    z, y, x = np.indices(grid.shape).reshape(3, -1)
    halves = (np.array(grid.shape[::-1]) - 1) / 2
    points = (np.stack([x, y, z], axis=1) - halves) * grid.sides_mm
    places = zip(np.indices(grid.shape), grid.shape, strict=True)
    most = -0.5 - np.minimum.reduce([np.minimum(i, n - 1 - i) for i, n in places]).ravel().astype(float)
    for number, lamp in enumerate(views.lamps):
        across, down, origin = (each[number] for each in (views.column_steps_mm, views.row_steps_mm, views.origins_mm))
        ways = points - lamp[:3] if lamp[3] else np.broadcast_to(lamp[:3], points.shape)
        matrices = np.stack([np.broadcast_to(across, ways.shape), np.broadcast_to(down, ways.shape), -ways], axis=2)
        right, below, _ = np.linalg.solve(matrices, (points - origin)[..., None])[..., 0].T
        rows, columns = views.picture_shape
        place = np.stack([below + (rows - 1) / 2 + 2, right + (columns - 1) / 2 + 2])
        distances = plain_distances(silhouettes.inside[number])
        edge = np.array(distances.shape)[:, None] - 1
        near = np.clip(place, 0, edge)
        beyond = np.linalg.norm(place - near, axis=0)
        most = np.maximum(most, widths[number] * (ndimage.map_coordinates(distances, near, order=1) + beyond))
    return most.reshape(grid.shape)


def products(front: Flags, side: Flags, top: Flags) -> tuple[Flags, Flags, Flags]:
    """What three walls can show of three pictures, rows from above, by products of boolean matrices."""
    f, s, t = (picture[::-1].T for picture in (front, side, top))  # (x, z), (y, z), (x, y)
    shown = f & (t @ s), s & (t.T @ f), t & (f @ s.T)
    a, b, c = (each.T[::-1] for each in shown)
    return a, b, c
