"""Light on its way, as dust in the air shows it: from a lamp to the cube, and in colours from there to a wall.

A beam is drawn as slices across it, each a small copy of what the wall shows, coarsely: it is soft, and fades out.
"""

from collections.abc import Iterable
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from lightcube.drawing.camera import Canvas
from lightcube.drawing.standing import PlacedLamp, PlacedScreen, size_of
from lightcube.optics.grid import Grid

Floats = NDArray[np.float32]
Reals = NDArray[np.float64]

#: Slices of a beam, parts of a pixel's side that it is drawn in, and the light that dust takes where it is whole.
_SLICES, _COARSE, _DUST = 72, 4, 0.24
#: Light before the cube, of white, and pixels that a slice has at most.
_BEFORE, _PIXELS = 0.35, 24
#: Depths that differ relatively by less are of one thing.
_SAME = 1e-4


def off_pictures(canvas: Canvas, screens: Iterable[PlacedScreen]) -> Floats:
    """``(row, column, 1)``: 0 where a screen's picture is seen, which no beam covers, else 1."""
    off = np.ones((*canvas.near.shape, 1), np.float32)
    for screen in screens:
        region = canvas.around(screen.corners)
        near, across, below = canvas.plane(screen.corner, screen.right, screen.down, region)
        rows, columns = screen.pixels
        onto = (across >= 0) & (across <= columns) & (below >= 0) & (below <= rows)
        off[region][onto & (near > 0) & (np.abs(near - canvas.near[region]) <= _SAME * near)] = 0
    return off


def draw_beam(canvas: Canvas, grid: Grid, lamp: PlacedLamp, screen: PlacedScreen, shown: Floats, off: Floats) -> None:
    """Add the light between a lamp and what a screen shows of it, where nothing solid stands before it.

    Where `off` is 0 there is none (`off_pictures`).
    """
    power = float(lamp.light.max(initial=0.0))
    if power <= 0 or (canvas.eye - screen.corner) @ screen.facing <= 0:
        return
    high, wide = (-(-size // _COARSE) for size in canvas.camera.size)
    coarse = Canvas(replace(canvas.camera, size=(high, wide)))
    rows, columns = coarse.near.shape
    solid = np.zeros((rows, columns), np.float32)
    own = canvas.near[::_COARSE, ::_COARSE][:rows, :columns]
    solid[: own.shape[0], : own.shape[1]] = own
    after = _small(shown[..., [min(i, shown.shape[2] - 1) for i in range(3)]])
    edge = np.hanning(after.shape[0] + 2)[1:-1, None] * np.hanning(after.shape[1] + 2)[1:-1]
    white = np.array([lamp.light[min(i, len(lamp.light) - 1)] for i in range(3)]) / power * _BEFORE
    before = (np.minimum(1, 4 * edge)[..., None] * white).astype(np.float32)
    middle = screen.corners.mean(axis=0)
    way = lamp.place - middle
    glow = np.zeros((rows, columns, 3), np.float32)
    for part in (np.arange(_SLICES) + 0.5) / _SLICES:
        place = middle + part * way
        ahead = np.clip(0.5 - (place @ way) / np.linalg.norm(way) / size_of(grid), 0, 1)  # 0 before the cube, 1 behind
        light = (before + np.float32(ahead) * (after - before)) * np.float32(min(1, 12 * (1 - part), 5 * part))
        _add_slice(glow, coarse, screen, place, 1.0 if lamp.parallel else 1 - part, light, solid)
    dust = np.float32(_DUST * np.linalg.norm(way) / size_of(grid) / _SLICES)
    canvas.light += off * _enlarged(dust * glow, canvas.near.shape)


def _add_slice(
    glow: Floats, coarse: Canvas, screen: PlacedScreen, place: Reals, size: float, picture: Floats, solid: Floats
) -> None:
    """Add the light of one slice about a place, where nothing solid stands before it."""
    from scipy.ndimage import map_coordinates  # here: it takes longer to load than a small cube to play

    rows, columns = picture.shape[:2]
    right, down = (
        size * step * count / fine
        for step, count, fine in ((screen.right, screen.pixels[1], columns), (screen.down, screen.pixels[0], rows))
    )
    sides = np.array(list(product((-0.5, 0.5), repeat=2))) * (columns, rows)
    region = coarse.around(place + sides @ np.stack([right, down]))
    near, across, below = coarse.plane(place, right, down, region)
    seen = (near > solid[region]) & (near > 0)
    places = np.stack([below + rows / 2, across + columns / 2]) - 0.5
    for channel in range(3):
        glow[region][..., channel] += np.where(seen, map_coordinates(picture[..., channel], places, order=1), 0)


def _small(picture: Floats) -> Floats:
    """The means of a picture's blocks, no brighter than white."""
    every = max(1, -(-max(picture.shape[:2]) // _PIXELS))
    rows, columns = (size // every for size in picture.shape[:2])
    blocks = np.minimum(picture[: rows * every, : columns * every], 1).reshape(rows, every, columns, every, 3)
    return blocks.mean(axis=(1, 3), dtype=np.float32)


def _enlarged(light: Floats, shape: tuple[int, ...]) -> Floats:
    """A coarse picture as large as a fine one."""
    size = shape[1], shape[0]
    colours = [Image.fromarray(light[..., c]).resize(size, Image.Resampling.BILINEAR) for c in range(3)]
    return np.stack([np.asarray(colour) for colour in colours], axis=2)
