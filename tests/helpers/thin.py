"""The paper's thin beams, one through the middle of each pixel of the pictures: what is exact is known of those."""

from functools import partial
from typing import Any

from lightcube.backward.recipe import Recipe
from lightcube.forward import casting
from lightcube.optics.light import Light

cast = partial(casting.cast, light="thin")
play = partial(casting.play, picture_only=True, light="thin")
player = partial(casting.player, picture_only=True, light="thin")


def thin_recipe(**options: Any) -> Recipe:
    """A recipe of thin beams."""
    return Recipe(**{"light": Light.thin()} | options)
