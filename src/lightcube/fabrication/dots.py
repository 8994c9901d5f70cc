"""Dots of full ink for films: blue noise, of which no two inks and no two films share the pattern."""

from __future__ import annotations

from functools import cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from lightcube.fabrication.noise import SIDE, blue_order
from lightcube.optics.arrays import locked

Halftone = Literal["none", "blue"]

#: Layers of the tile are so far apart, in dots, that each is spread evenly by itself.
_APART = 8.0


@cache
def _thresholds() -> NDArray[np.uint8]:
    """``(layer, row, column)``: levels above which a dot is printed, each layer's spread evenly from 0 to 254."""
    order = blue_order((_APART, 1.0, 1.0)).reshape(SIDE, -1)
    ranks = np.argsort(np.argsort(order, axis=1, kind="stable"), axis=1, kind="stable")
    return locked((255 * ranks // SIDE**2).astype(np.uint8).reshape(SIDE, SIDE, SIDE))


def blue_dots(film: int, levels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Full dots or none for levels ``(row, column, colour)``; of one colour a level is light, of four they are inks."""
    rows, columns, colours = levels.shape
    made = np.empty_like(levels)
    for colour in range(colours):
        layer = (film * 4 + colour) % SIDE
        shift = np.random.default_rng((film, colour)).integers(0, SIDE, 2)
        tile = np.roll(_thresholds()[layer], tuple(shift.tolist()), (0, 1))
        over = np.tile(tile, (-(-rows // SIDE), -(-columns // SIDE)))[:rows, :columns]
        made[..., colour] = np.where(levels[..., colour] > over, 255, 0)
    return made
