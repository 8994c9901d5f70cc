"""A block of mixed dyes as droplets, each of one of them or clear: slice by slice, in blue noise over three dimensions.

A droplet is of a dye with the chance that is the dye's part of its place, and the noise of a dye is that of no other.
The darkest dye is laid first, and its noise is the bluest. Tiles of the noise are moved apart at random: a pattern
that repeats would be seen by beams that run along it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lightcube.fabrication.boxes import edges, means
from lightcube.fabrication.noise import SIDE, blue_order
from lightcube.optics.arrays import Counts, Reals, Volume
from lightcube.optics.grid import Grid

Labels = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Droplets:
    """Droplets of a block.

    Parameters
    ----------
    amounts
        ``(dye, z, y, x)``, the part of each voxel that is of a dye: of at least 0, and up to 1 together.
    grid
        The voxels.
    sides_mm
        Of a droplet, along x, y and z.
    order
        Dyes in the order in which they are laid.
    seed
        Of the noise.
    """

    amounts: Volume
    grid: Grid
    sides_mm: tuple[float, float, float]
    order: tuple[int, ...]
    seed: int

    @property
    def shape(self) -> tuple[int, int, int]:
        """Droplets along z, y and x: as many as the block needs, an even number, the outer ones may stand out of it."""
        halves = (mm / side / 2 for mm, side in zip(self.grid.size_mm, self._sides, strict=True))
        nz, ny, nx = (2 * int(np.ceil(half - 1e-9)) for half in halves)
        return nz, ny, nx

    @property
    def _sides(self) -> tuple[float, float, float]:
        """Along z, y and x."""
        x, y, z = self.sides_mm
        return z, y, x

    def expected(self) -> Reals:
        """How many droplets of each dye there are to be."""
        each = np.prod(self.grid.sides_mm) / np.prod(self.sides_mm)
        return np.asarray(self.amounts.sum(axis=(1, 2, 3), dtype=np.float64) * each)

    def layer(self, number: int) -> Labels:
        """``(y, x)``: of each droplet of a slice 0 where it is clear, else one more than the number of its dye."""
        parts = self._parts(number)
        labels = np.zeros(parts.shape[1:], np.uint8)
        left = np.ones(parts.shape[1:])
        for dye in self.order:
            chance = parts[dye] / np.maximum(left, 1e-9)
            labels[(labels == 0) & (self._noise(number, dye) < chance)] = dye + 1
            left -= parts[dye]
        return labels

    def _parts(self, number: int) -> Reals:
        """The part of each dye in each droplet of a slice, ``(dye, y, x)``."""
        cuts = [
            edges(count, side, voxels, mm)
            for count, side, voxels, mm in zip(
                self.shape, self._sides, self.grid.shape, self.grid.sides_mm[::-1], strict=True
            )
        ]
        low, high = cuts[0][number : number + 2]
        first, last = max(0, int(np.floor(low))), min(self.grid.shape[0], int(np.ceil(high)))
        plane = means(self.amounts[:, first:last], 1, np.array([low, high]) - first)[:, 0]
        return means(means(plane, 1, cuts[1]), 2, cuts[2])

    def _noise(self, number: int, dye: int) -> Reals:
        """Numbers from 0 to 1 for the droplets of a slice, ``(y, x)``, spread evenly among their neighbours."""
        _, rows, columns = self.shape
        order = blue_order(self._sides)
        tile, down, across = number // SIDE, np.arange(rows), np.arange(columns)
        random = np.random.default_rng([self.seed, dye, tile])
        tiles = -(-rows // SIDE), -(-columns // SIDE)
        moved: Counts = random.integers(0, SIDE, (3, *tiles))
        finer = random.random(tiles)
        of_tile = np.ix_(down // SIDE, across // SIDE)
        z, y, x = (each[of_tile] for each in moved)
        ranks = order[(number + z) % SIDE, (down[:, None] + y) % SIDE, (across + x) % SIDE]
        return np.asarray((ranks + finer[of_tile]) / order.size)
