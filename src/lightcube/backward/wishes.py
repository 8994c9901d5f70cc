"""What is asked of each picture, at each of its angles: its pixels' means, a calm mat, and smoothness inside pixels.

Each wish is a picture of its own, with points and weights of its own, under the lamps of the picture that it is for. A
mat is a coarse thing, and a few points do for it; for what lies beyond it a single one, at one angle of a hold.
Smoothness is asked for at single points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lightcube.backward.mat import places_beyond, widened
from lightcube.backward.recipe import Recipe
from lightcube.errors import InputError
from lightcube.optics.arrays import Counts, Reals
from lightcube.optics.grid import Grid, dense_step_deg
from lightcube.optics.light import Light, bundle, finer, is_exact, is_in_slices, seeds
from lightcube.optics.moves import misplaced
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack

#: How finely light is averaged over the pixels of a mat, where that is coarser than over those of the pictures.
MAT = Light(3, 3)
#: And over those of the shadow beyond it.
BEYOND = Light.thin()
#: At so many places of films that lie off pictures are asked for: 10 are no better (measured).
MISPLACED = 4
#: The middle of a pixel, about which means are taken that are exact, and points of a lamp's disc for them.
_MIDDLE, _DISC = np.zeros((1, 4)), 7
#: The points of a pixel at which smoothness is asked for.
SMOOTH = Light(2, 2)


@dataclass(frozen=True, eq=False)
class Wish:
    """One thing that is asked of each picture, at each angle of its hold or at one.

    Parameters
    ----------
    points, soft_points
        Of each pixel, ``(count, 4)`` as `Rig.split` takes them: under lamps without and with a disc.
    picture, mat
        How much the pixels of the picture and of its mat count, beside the weights that they have.
    place
        How far from the picture's window, in pixels right and down, its own stands: elsewhere lies what is beyond mats.
    """

    points: Reals
    soft_points: Reals
    picture: float = 0.0
    mat: float = 0.0
    place: tuple[int, int] = (0, 0)

    @property
    def is_beyond(self) -> bool:
        """Whether the shadow beyond the mats is asked to be calm."""
        return self.place != (0, 0)


@dataclass(frozen=True, eq=False)
class Asked:
    """Everything that is asked of some pictures.

    Parameters
    ----------
    rig
        Its pictures are those of the first wish, of all stops and their angles in turn, then those of the next.
    wishes
        What is asked.
    wish, stop, angle
        ``(pictures of the rig,)``: which of the wishes each is, for which picture, at which of the angles of a hold.
    """

    rig: Rig
    wishes: list[Wish]
    wish: Counts
    stop: Counts
    angle: Counts


def asked(rig: Rig, grid: Grid, recipe: Recipe) -> Asked:
    """All that a recipe asks of a rig's pictures: with their mats, at all angles of a hold, every wish in turn."""
    turned = held(widened(rig, grid, recipe.mat), recipe, grid)
    every, angles = np.arange(len(turned)), len(turned) // len(rig)
    wishes = _wishes(turned, grid, recipe) + _beyond(rig, grid, recipe)
    pictures = [every[every % angles == angles // 2] if each.is_beyond else every for each in wishes]
    picture, wish = np.concatenate(pictures), np.repeat(np.arange(len(wishes)), [len(each) for each in pictures])
    if not recipe.beams.is_thin:
        turned = _split(turned.take(picture), [wishes[each] for each in wish])
        turned = turned.squared(1.0) if is_exact(rig, grid) else turned
    return Asked(turned, wishes, wish, picture // angles, picture % angles)


def _split(rig: Rig, wishes: Sequence[Wish]) -> Rig:
    """Pictures where and at the points at which they are wanted, each as a wish says."""
    placed = rig.shifted(np.array([each.place for each in wishes]))
    of = (wishes[picture] for picture in rig.sums.picture)
    discs = rig.sums.disc_deg
    return placed.split([each.soft_points if disc else each.points for each, disc in zip(of, discs, strict=True)])


def held(rig: Rig, recipe: Recipe, grid: Grid) -> Rig:
    """Every picture at the angles that a hold asks for, those of a picture in a row; fewer where light is averaged."""
    turned = rig.held(recipe.hold_deg, dense_step_deg(grid), to_the_ends=recipe.beams.is_thin)
    return turned if not recipe.assembly_mm else _assembled(turned, recipe, grid)


def _assembled(rig: Rig, recipe: Recipe, grid: Grid) -> Rig:
    """Every picture with films that lie off by chance, each time alike for all pictures; those of one in a row."""
    if not isinstance(grid, Stack):
        raise InputError("films that lie off are of a stack, and a cube has none: leave --assembly-mm out")
    random = np.random.default_rng(recipe.seed)
    off_mm = np.zeros((MISPLACED, grid.shape[0], 3))
    off_mm[..., :2] = recipe.assembly_mm * random.standard_normal((MISPLACED, grid.shape[0], 2))
    every = rig.take(np.repeat(np.arange(len(rig)), MISPLACED))
    return misplaced(every, grid, np.tile(off_mm, (len(rig), 1, 1)))


def _wishes(rig: Rig, grid: Grid, recipe: Recipe) -> list[Wish]:
    """What a recipe asks for, the picture itself first; `rig` has the pictures with their mats."""
    if is_exact(rig, grid):
        return [Wish(_MIDDLE, np.hstack([np.zeros((_DISC, 2)), seeds(_DISC)]), picture=1.0, mat=1.0)]
    light, in_slices = finer(recipe.beams, rig, grid), is_in_slices(rig, grid)
    own, coarse, single = (bundle(each, in_slices=in_slices) for each in (light, MAT, SMOOTH))
    apart = recipe.mat is not None and len(own[0]) > len(coarse[0])
    found = [Wish(*own, picture=1.0, mat=0.0 if apart else 1.0)]
    if apart:
        found.append(Wish(*coarse, mat=1.0))
    if light.grain:
        weight = light.grain / len(single[0])
        found += [Wish(bare[None], soft[None], picture=weight) for bare, soft in zip(*single, strict=False)]
    return found


def _beyond(rig: Rig, grid: Grid, recipe: Recipe) -> list[Wish]:
    """What is asked of the shadow beyond the mats: nothing by thin beams."""
    if recipe.beams.is_thin:
        return []
    points = bundle(BEYOND, in_slices=False)
    return [Wish(*points, place=(int(right), int(down))) for right, down in places_beyond(rig, grid, recipe.mat)]
