"""Blue noise over three dimensions: an order of the places of a tile, of which any first part is spread evenly.

Places are taken one by one where they are furthest from all that are taken already, as R. Ulichney's void-and-cluster
method has it (The void-and-cluster method for dither array generation, Proc. SPIE 1913 (1993) 332-343), in mm, so that
droplets may be longer than they are high. Distances are reckoned with whole numbers: the same order on every machine.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.arrays import Integers, locked

#: Places along a side of a tile.
SIDE = 32
#: How wide the bells are whose sum says how crowded a place is, in mean sides of droplets; and their height.
_WIDTH, _HEIGHT = 1.5, 1 << 24
#: Places that are spread evenly before the others are counted: a part of all.
_FIRST = 0.1


def blue_order(sides: tuple[float, float, float], side: int = SIDE) -> NDArray[np.uint16]:
    """``(z, y, x)``: when each place of a tile is taken, from 0 on; the tile repeats without a seam.

    Parameters
    ----------
    sides
        How far places are from each other along z, y and x.
    """
    longest = max(sides)
    z, y, x = (round(each / longest, 6) for each in sides)
    return _order((z, y, x), side)


@cache
def _order(sides: tuple[float, float, float], side: int) -> NDArray[np.uint16]:
    """The same, for sides of which the longest is 1."""
    bells = _bells(sides, side)
    first = _evenly(bells, side)
    order = np.empty((side,) * 3, np.uint16)
    taken, crowd = first.copy(), _crowd(first, bells)
    for rank in range(np.count_nonzero(first) - 1, -1, -1):  # those that were first, the most crowded last
        place = _most(np.where(taken, crowd, -1))
        order[place], taken[place] = rank, False
        crowd -= _bell(bells, place)
    taken, crowd = first.copy(), _crowd(first, bells)
    for rank in range(np.count_nonzero(first), side**3):
        place = _most(np.where(taken, -1, np.iinfo(np.int64).max - crowd))
        order[place], taken[place] = rank, True
        crowd += _bell(bells, place)
    return locked(order)


def _bells(sides: tuple[float, float, float], side: int) -> Integers:
    """A bell around the middle of twice as large a tile: the part from a place on is one around another place."""
    at = np.arange(2 * side)
    apart = np.minimum(at % side, -at % side)
    width = _WIDTH * float(np.prod(sides)) ** (1 / 3)
    z, y, x = (np.exp(-((apart * each / width) ** 2) / 2) for each in sides)
    return np.rint(_HEIGHT * z[:, None, None] * y[:, None] * x).astype(np.int64)


def _bell(bells: Integers, place: tuple[int, ...]) -> Integers:
    """The bell around a place of the tile."""
    side = len(bells) // 2
    return bells[tuple(slice(side - at, 2 * side - at) for at in place)]


def _crowd(taken: NDArray[np.bool_], bells: Integers) -> Integers:
    """How crowded each place is."""
    crowd = np.zeros(taken.shape, np.int64)
    for place in np.argwhere(taken).tolist():
        crowd += _bell(bells, tuple(place))
    return crowd


def _most(values: Integers) -> tuple[int, ...]:
    return tuple(int(each) for each in np.unravel_index(np.argmax(values), values.shape))


def _evenly(bells: Integers, side: int) -> NDArray[np.bool_]:
    """Some places, spread evenly: the most crowded goes to the emptiest place until that is where it came from."""
    taken = np.zeros(side**3, bool)
    taken[np.random.default_rng(1).permutation(side**3)[: max(1, round(_FIRST * side**3))]] = True
    taken = taken.reshape((side,) * 3)
    crowd = _crowd(taken, bells)
    for _ in range(side**3):  # it comes to rest long before
        left = _most(np.where(taken, crowd, -1))
        taken[left] = False
        crowd -= _bell(bells, left)
        found = _most(np.where(taken, -1, np.iinfo(np.int64).max - crowd))
        taken[found] = True
        crowd += _bell(bells, found)
        if found == left:
            break
    return taken
