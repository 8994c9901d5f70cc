"""Coloured glass as one likes to see it: clearer than it is, and shining a little in its own colours.

Glass that casts photographs is nearly black from all sides but the lamp's. Where the eye is the lamp's, it is bare:
what comes through is exactly what the wall shows.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from lightcube.drawing import tones
from lightcube.drawing.bending import is_cut
from lightcube.drawing.camera import FINE, Canvas, Floats, Reals, Region
from lightcube.drawing.standing import Standing
from lightcube.kernels.layout import columns_from_volume
from lightcube.optics.cube import Cube

#: About so many nanoseconds a voxel that a ray meets.
_WORK = 20
#: Pixels of a ray in a voxel that is seen large.
_RAYS = 3


@dataclass(frozen=True)
class Seen:
    """What an eye sees of glass, by the pixels of a part of its picture.

    Parameters
    ----------
    pixels
        The part, in samples.
    through
        ``(row, column, 3)``: the part of the light behind it that comes through.
    more
        ``(row, column, 3)``: the light that it shines with.
    mirrors, brighter
        ``(row, column, 1)``: how much of the room the face that is seen mirrors, and how much brighter that is there.
    met
        Inverse depths at which each sample's ray enters it; 0 = it does not.
    """

    pixels: Region
    through: Floats
    more: Floats
    mirrors: Floats
    brighter: Floats
    met: Floats

    def lay(self, canvas: Canvas) -> None:
        """Lay it over what lies behind."""
        behind = self.met > canvas.near[self.pixels]
        mirror = np.multiply(tones.FAR, 1.6).astype(np.float32) + self.brighter
        for i, j in product(range(FINE), repeat=2):
            light = canvas.light[self.pixels][i::FINE, j::FINE]
            there = behind[i::FINE, j::FINE, None]
            seen = light * self.through + self.more
            seen += self.mirrors * (mirror - seen)
            light[...] = np.where(there, seen, light)


class Glass:
    """A cube's glass, laid out for eyes."""

    def __init__(self, cube: Cube) -> None:
        self._grid, self._is_cut = cube.grid, is_cut(cube.rig.glass)
        self._columns = columns_from_volume(cube.extinction).reshape(-1, cube.extinction.shape[0])

    def seen(self, canvas: Canvas, now: Standing, ember: Reals, bare: float) -> Seen | None:
        """What the canvas's eye sees of it, None where that is nothing.

        Parameters
        ----------
        ember
            The light that its purest voxels shine with.
        bare
            0 as one likes to see it, 1 as light goes through it.
        """
        from lightcube.kernels import glimpse, tasks  # here: they load a compiler

        turn, half = now.turn, np.array(self._grid.size_mm[::-1]) / 2
        region = enter(canvas, -half, half, turn)
        if region is None:
            return None
        pixels, shape = whole_pixels(region)
        every = self._every(canvas)
        ways = canvas.ways(pixels, every)
        rays, hit, slant, level = self._rays(canvas.eye @ turn, ways @ turn)
        nz, ny, nx = self._grid.shape
        absorbed, shining = np.zeros((2, len(rays), 3), np.float32)
        work = _WORK * len(rays) * (nx + ny + nz)
        given = rays, (nx, ny, nz), self._columns, self._grid.voxel_mm, bool(np.any(ember)), absorbed, shining
        tasks.run(glimpse.look, len(rays), work, *given)
        through = (1 - bare) * clearer(absorbed) + bare * np.exp(-absorbed)
        more = (1 - bare) * np.asarray(ember) * shining
        mirrored = (1 - bare) * (not self._is_cut) * (0.03 + 0.5 * (1 - slant) ** 4)
        found = np.column_stack([through, more, mirrored, 0.06 * level, np.ones(len(rays))])
        found *= hit[:, None] | (every == 1)
        seen = _enlarged(found.reshape(*ways.shape[:2], -1).astype(np.float32), shape, every)
        return Seen(pixels, seen[..., :3], seen[..., 3:6], seen[..., 6:7], seen[..., 7:], canvas.glass[pixels])

    def _every(self, canvas: Canvas) -> int:
        """Every so many-th pixel a ray is worth its while: of a voxel there are three."""
        away = np.linalg.norm(canvas.eye) - np.linalg.norm(self._grid.size_mm) / 2
        voxel = canvas.focal / FINE * self._grid.voxel_mm / max(float(away), self._grid.voxel_mm)
        return int(np.clip(voxel / _RAYS, 1, 8))

    def _rays(self, eye: Reals, ways: Reals) -> tuple[Reals, NDArray[np.bool_], Reals, NDArray[np.bool_]]:
        """Rays in voxels, whether each meets the cube, how its first face is slanted, and whether that is level."""
        half = np.array(self._grid.size_mm[::-1]) / 2
        ways = ways.reshape(-1, 3) / np.linalg.norm(ways, axis=-1).reshape(-1, 1)
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = (-half - eye) / ways, (half - eye) / ways
        first, last = np.nan_to_num(np.fmin(*ends), nan=-np.inf), np.fmax(*ends)
        face = np.argmax(first, axis=1)
        slant = np.abs(np.take_along_axis(ways, face[:, None], axis=1)[:, 0])
        sides = np.array(self._grid.sides_mm)
        rays = np.empty((len(ways), 8))
        rays[:, :3] = (eye + half) / sides
        rays[:, 3:6] = ways * (self._grid.voxel_mm / sides)
        rays[:, 6:] = 0, np.inf
        return rays, first.max(axis=1) < np.nanmin(last, axis=1), slant, face == 2


def whole_pixels(region: Region) -> tuple[Region, tuple[int, int]]:
    """The region of the whole pixels of samples, and its rows and columns of pixels."""
    tops, lefts = (slice(part.start // FINE, -(-part.stop // FINE)) for part in region)
    pixels = slice(tops.start * FINE, tops.stop * FINE), slice(lefts.start * FINE, lefts.stop * FINE)
    return pixels, (tops.stop - tops.start, lefts.stop - lefts.start)


def enter(canvas: Canvas, low: Reals, high: Reals, turn: Reals) -> Region | None:
    """Note where rays enter and leave a box; return the region where they do, None where none does.

    Parameters
    ----------
    low, high
        Two corners of the box ``(3,)``, mm, which `turn` turns into the room.
    """
    corners = np.array(list(product(*zip(low, high, strict=True)))) @ turn.T
    if np.all((corners - canvas.eye) @ canvas.axes[2] <= 0):
        return None
    region = canvas.around(corners)
    first, last = np.zeros_like(canvas.near[region]), np.full_like(canvas.near[region], np.inf)
    for axis, least, most in zip(turn.T, low, high, strict=True):
        start, way = np.float32(canvas.eye @ axis), canvas.along(axis, region)
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = (np.float32(least) - start) / way, (np.float32(most) - start) / way
        first, last = np.fmax(first, np.fmin(*ends)), np.fmin(last, np.fmax(*ends))
    canvas.glass[region] = np.where(first < last, 1 / np.maximum(first, 1e-9), 0)
    canvas.beyond[region] = np.where(first < last, 1 / np.maximum(last, 1e-9), 0)
    return region if np.any(canvas.glass[region] > 0) else None


def _enlarged(light: Floats, shape: tuple[int, int], every: int) -> Floats:
    """What coarse rays saw, by pixels: the last number of each is what it counts."""
    if every == 1:
        return light[..., :-1]
    rows, columns = light.shape[:2]
    size = columns * every, rows * every
    colours = [Image.fromarray(light[..., c]).resize(size, Image.Resampling.BILINEAR) for c in range(light.shape[2])]
    fine = np.stack([np.asarray(colour) for colour in colours], axis=2)[: shape[0], : shape[1]]
    return np.asarray(fine[..., :-1] / np.maximum(fine[..., -1:], np.float32(1e-6)), np.float32)


def clearer(absorbance: Floats) -> Floats:
    """What comes through glass whose blacks are dark colours, ``(..., 3)``, so that one sees into it."""
    grey = absorbance.min(axis=-1, keepdims=True)
    colour = absorbance - grey
    return np.asarray((1 + grey / tones.GREY) ** -tones.GREY * (1 + colour / tones.COLOUR) ** -tones.COLOUR, np.float32)
