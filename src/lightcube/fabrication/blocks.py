"""Droplets in blocks, each a voxel that lets as much light through as its droplets do.

Where there are too many droplets to cast them one by one, their mean extinction would cast too dark: light goes by
where little absorbs, and a block of droplets lets more of it through than as much of an even mixture. So a block
gets the extinction of which an even one lets through what it does, the mean over light along x, along y and along z.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lightcube.optics.arrays import Reals
from lightcube.optics.grid import Grid


@dataclass(frozen=True)
class Blocks:
    """Blocks of droplets.

    Parameters
    ----------
    counts
        Blocks along z, y and x.
    each
        Droplets of a block along z, y and x.
    repeats
        Blocks that a droplet is long along y: above 1, where droplets are longer than they are wide.
    sides_mm
        Of a droplet along x, y and z.
    """

    counts: tuple[int, int, int]
    each: tuple[int, int, int]
    repeats: int
    sides_mm: tuple[float, float, float]

    @classmethod
    def of(cls, shape: tuple[int, int, int], sides_mm: tuple[float, float, float], most: int) -> Blocks:
        """Single droplets, or blocks that are as high as they are wide, nearly, of which there are no more than `most`.

        Parameters
        ----------
        shape
            Droplets along z, y and x.
        """
        x, y, z = sides_mm
        longer = max(1, round(y / x))
        high, wide = 1, 1
        while True:
            deep, repeats = max(1, wide // longer), longer if wide == 1 else 1
            each = high, deep, wide
            nz, ny, nx = (-(-count // size) for count, size in zip(shape, each, strict=True))
            if nz * ny * repeats * nx <= most:
                return cls((nz, ny * repeats, nx), each, repeats, sides_mm)
            if wide * x <= high * z:
                wide = longer if wide == 1 < longer else 2 * wide
            else:
                high *= 2

    @property
    def grid(self) -> Grid:
        """The blocks as voxels."""
        x, _, z = self.sides_mm
        high, _, wide = self.each
        return Grid(self.counts, wide * x, high * z / (wide * x))

    def padding(self, shape: tuple[int, int, int]) -> list[tuple[int, int]]:
        """Clear droplets before and behind those that there are, along z, y and x, so that blocks are whole."""
        counts = self.counts[0], self.counts[1] // self.repeats, self.counts[2]
        missing = [count * size - there for count, size, there in zip(counts, self.each, shape, strict=True)]
        return [(left // 2, left - left // 2) for left in missing]

    def seen(self, extinction: Reals) -> Reals:
        """Extinction ``(channel, y, x)`` of a layer of blocks of droplets ``(channel, z, y, x)``, 1/mm."""
        high, deep, wide = self.each
        channels, _, rows, columns = extinction.shape
        parts = extinction.reshape(channels, high, rows // deep, deep, columns // wide, wide)
        x, y, z = self.sides_mm
        found = np.zeros((channels, rows // deep, columns // wide))
        for axis, count, side in ((1, high, z), (3, deep, y), (5, wide, x)):
            along = parts.mean(axis=axis, keepdims=True) * (count * side)
            found -= np.log(np.exp(-along).mean(axis=(1, 3, 5))) / (count * side) / 3
        return found.repeat(self.repeats, axis=1)
