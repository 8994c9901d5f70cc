"""What is asked of each picture, at each of its angles: its pixels' means, a calm mat, and smoothness inside pixels.

Each wish is a picture of its own, with points and weights of its own, under the lamps of the picture that it is for. A
mat is a coarse thing, and a few points do for it; smoothness is asked for at single points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lightcube.backward.mat import widened
from lightcube.backward.recipe import Recipe
from lightcube.optics.arrays import Counts, Reals
from lightcube.optics.grid import Grid, dense_step_deg
from lightcube.optics.light import Light, bundle, is_in_slices
from lightcube.optics.rig import Rig

#: How finely light is averaged over the pixels of a mat, where that is coarser than over those of the pictures.
MAT = Light(3, 3)
#: The points of a pixel at which smoothness is asked for.
SMOOTH = Light(2, 2)


@dataclass(frozen=True, eq=False)
class Wish:
    """One thing that is asked of each picture at each angle.

    Parameters
    ----------
    points, soft_points
        Of each pixel, ``(count, 4)`` as `Rig.split` takes them: under lamps without and with a disc.
    picture, mat
        How much the pixels of the picture and of its mat count, beside the weights that they have.
    """

    points: Reals
    soft_points: Reals
    picture: float
    mat: float


@dataclass(frozen=True, eq=False)
class Asked:
    """Everything that is asked of some pictures.

    Parameters
    ----------
    rig
        Its pictures are those of the first wish, of all stops and their angles in turn, then those of the next.
    wishes
        What is asked.
    angles
        At how many angles of a hold each picture is asked for.
    """

    rig: Rig
    wishes: list[Wish]
    angles: int

    @property
    def stop(self) -> Counts:
        """``(pictures of the rig,)``: which picture each is for."""
        stops = len(self.rig) // (len(self.wishes) * self.angles)
        return np.tile(np.repeat(np.arange(stops), self.angles), len(self.wishes))


def asked(rig: Rig, grid: Grid, recipe: Recipe) -> Asked:
    """All that a recipe asks of a rig's pictures: with their mats, at all angles of a hold, every wish in turn."""
    turned = held(widened(rig, grid, recipe.mat), recipe, grid)
    wishes, angles = _wishes(turned, grid, recipe), len(turned) // len(rig)
    if recipe.beams.is_thin:
        return Asked(turned, wishes, angles)
    every = turned.take(np.tile(np.arange(len(turned)), len(wishes)))
    of = (wishes[picture // len(turned)] for picture in every.sums.picture)
    points = [each.soft_points if disc else each.points for each, disc in zip(of, every.sums.disc_deg, strict=True)]
    return Asked(every.split(points), wishes, angles)


def held(rig: Rig, recipe: Recipe, grid: Grid) -> Rig:
    """Every picture at the angles that a hold asks for, those of a picture in a row; fewer where light is averaged."""
    return rig.held(recipe.hold_deg, dense_step_deg(grid), to_the_ends=recipe.beams.is_thin)


def _wishes(rig: Rig, grid: Grid, recipe: Recipe) -> list[Wish]:
    """What a recipe asks for, the picture itself first; `rig` has the pictures with their mats."""
    light, in_slices = recipe.beams, is_in_slices(rig, grid)
    own, coarse, single = (bundle(each, in_slices=in_slices) for each in (light, MAT, SMOOTH))
    apart = recipe.mat is not None and len(own[0]) > len(coarse[0])
    found = [Wish(*own, picture=1.0, mat=0.0 if apart else 1.0)]
    if apart:
        found.append(Wish(*coarse, picture=0.0, mat=1.0))
    if light.grain:
        weight = light.grain / len(single[0])
        found += [Wish(bare[None], soft[None], weight, 0.0) for bare, soft in zip(*single, strict=False)]
    return found
