"""Light on its way, as dust in the air shows it: from a lamp to the cube, and in colours from there to a wall."""

from collections.abc import Iterable
from itertools import product

import numpy as np

from lightcube.drawing import tones
from lightcube.drawing.camera import FINE, Canvas, Floats
from lightcube.drawing.furniture import pure_light
from lightcube.drawing.standing import PlacedLamp, PlacedScreen, size_of
from lightcube.optics.grid import Grid
from lightcube.optics.views import unit

#: A beam's picture has so many pixels along a side at most: it is soft. The lamp's light before the cube.
_PIXELS, BEFORE = 12, 0.55
#: Depths that differ relatively by less are of one thing.
_SAME = 1e-4
#: Nothing is farther away than one by this. About so many nanoseconds that an eye's ray takes.
_NEVER, _WORK = 1e-30, 200


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


class Air:
    """The light that dust throws to the eye of a canvas: behind the cube's glass, and before it."""

    def __init__(self, canvas: Canvas, grid: Grid) -> None:
        self._canvas, self._size = canvas, float(size_of(grid))
        self._beams: list[Floats] = []

    def take(self, lamp: PlacedLamp, screen: PlacedScreen, shown: Floats) -> None:
        """Take the light between a lamp and what a screen shows of it."""
        from lightcube.kernels import glimpse, tasks  # here: they load a compiler

        canvas, eye = self._canvas, self._canvas.eye
        ways = canvas.ways(canvas.whole).reshape(-1, 3)
        depths = [each[::FINE, ::FINE].astype(np.float64) for each in (canvas.near, canvas.glass, canvas.beyond)]
        ends = 1 / np.maximum(np.stack(depths, axis=-1).reshape(-1, 3), _NEVER)
        across, below = screen.pixels[1] * screen.right, screen.pixels[0] * screen.down
        source = -self._size * unit(lamp.place) if lamp.parallel else lamp.place - eye
        frame = np.stack([screen.corner - eye, across, below, screen.facing, source, -eye])
        picture = _small(shown[..., [min(i, shown.shape[2] - 1) for i in range(3)]])
        thrown = np.zeros((len(ways), 2, 3), np.float32)
        given = ways, ends, frame, not lamp.parallel, picture, BEFORE * pure_light(lamp), self._size, thrown
        tasks.run(glimpse.scatter, len(thrown), _WORK * len(thrown), *given)
        self._beams.append(thrown)

    def lay(self, off: Floats, part: float, *, front: bool) -> None:
        """Add what lies before the glass, or behind it; where `off` is 0 there is nothing (`off_pictures`)."""
        for thrown in self._beams:
            light = np.float32(part * tones.GLOW) * thrown[:, int(front)].reshape(*self._canvas.camera.size, 3)
            for i, j in product(range(FINE), repeat=2):
                self._canvas.light[i::FINE, j::FINE] += off[i::FINE, j::FINE] * light


def _small(picture: Floats) -> Floats:
    """The means of a picture's blocks, no brighter than white."""
    every = max(1, -(-max(picture.shape[:2]) // _PIXELS))
    rows, columns = (max(size // every, 1) for size in picture.shape[:2])
    blocks = np.minimum(picture[: rows * every, : columns * every], 1)
    down, along = (np.arange(count) * every for count in (rows, columns))
    sums = np.add.reduceat(np.add.reduceat(blocks, down, axis=0), along, axis=1)
    counts = np.diff([*down, blocks.shape[0]])[:, None] * np.diff([*along, blocks.shape[1]])
    return np.asarray(sums / counts[..., None], np.float32)
