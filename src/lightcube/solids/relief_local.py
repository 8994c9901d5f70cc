"""The local method: walls, and floors between them as deep below as the pictures want; one or two pictures, exact.

A picture's pixel is a square of ``width + 1`` columns: along each row a wall, then `width` columns of floor. The lamp
on the left makes the wall to the floor's left shade `a` of it, that on the right the next wall `b`:
``left wall = floor + a width``, ``right wall = floor + b width``. So from wall to wall the height changes by
``(b - a) width``: nothing is left to choose but the height of each row, and walls drift with the difference of the
pictures.
"""

from __future__ import annotations

import math

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals, locked
from lightcube.optics.transfer import decode
from lightcube.solids.relief import ReliefRecipe, darkest, display, filled
from lightcube.wording import counted

#: The pictures that there can be: one for each side of the walls.
MOST_LOCAL = 2
#: How wide floors are, in columns, where nothing is said of black.
_WIDTH = 4


def width_of(recipe: ReliefRecipe) -> int:
    """How wide the floors are: so that black is as dark as is asked for."""
    if recipe.black is None:
        return _WIDTH
    light = float(decode(np.array([recipe.black]))[0])
    return max(1, math.ceil(1 / max(light, 1e-6) - 1 - 1e-9))


def black_of(recipe: ReliefRecipe) -> float:
    """The display value of black: what is asked for, or a pixel's whose floor is dark all over."""
    least = filled(darkest(width_of(recipe)), recipe.bounce)
    return display(least) if recipe.black is None else recipe.black


def walled(wanted: Reals, width: int) -> tuple[Reals, float]:
    """Heights ``(row, column)`` whose shadows are the wanted light ``(picture, row, column)``, and their drift.

    The first picture is that of the lamp to the right. Heights have one column more than the pixels: the last wall. The
    drift is how much higher the highest wall of a row is than its lowest, at most, in columns of shadow.
    """
    shade = np.clip((1 - wanted) * (width + 1) / width, 0, 1)
    right, left = shade[0], shade[-1]
    rows, pixels = right.shape
    walls = np.zeros((rows, pixels + 1))
    np.cumsum((right - left) * width, axis=1, out=walls[:, 1:])
    floors = walls[:, :-1] - left * width
    drift = float(np.max(np.ptp(walls, axis=1)))
    low = floors.min(axis=1, keepdims=True)
    line = np.concatenate([(walls - low)[:, :-1, None], np.repeat((floors - low)[:, :, None], width, axis=2)], axis=2)
    heights = np.concatenate([line.reshape(rows, -1), (walls - low)[:, -1:]], axis=1)
    return locked(np.maximum(np.repeat(heights, width + 1, axis=0), 0.0)), drift


def check_local(count: int, recipe: ReliefRecipe, *, colour: bool) -> int:
    """How many pixels a side pictures have; `InputError` where there are too many pictures, or too few columns."""
    if colour or count > MOST_LOCAL:
        many = "three colours" if colour else counted(count, "picture")
        raise InputError(
            f"the local method has two sides of a wall for two pictures, not for {many}: use the global method"
        )
    cell = width_of(recipe) + 1
    if recipe.side < 2 * cell:
        raise InputError(
            f"pixels of {cell} columns for such a black do not fit {recipe.side} columns: "
            "take more columns, or a lighter black"
        )
    return recipe.side // cell


def check_height(heights_px: Reals, drift: float, recipe: ReliefRecipe) -> None:
    """Raise `InputError` where a relief is higher than was asked for."""
    high = float(heights_px.max())
    if high > recipe.relief_px * (1 + 1e-9):
        raise InputError(
            f"these pictures need a relief {high:.1f} columns high, as their walls drift by {drift:.1f}, and "
            f"{recipe.relief_px:g} are allowed: allow {math.ceil(high)}, or use the global method"
        )
