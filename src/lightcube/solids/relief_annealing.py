"""The global method: all heights of a relief at once, so that every picture is as near as an eye can tell.

What is minimised is, summed over pictures and elevations of the lamp, the square of the blurred light less what is
wanted, weighted by the squared slope of the display curve, and a little for every step between neighbours. Columns are
offered other heights in turn; what that changes is known exactly from the few columns whose horizon it moves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lightcube.events import Interrupted, Progress, Tell
from lightcube.optics.arrays import Integers, Reals, locked
from lightcube.solids.relief import LAMPS_DEG, ReliefRecipe
from lightcube.solids.relief_light import unbounced

#: How far an eye blurs, in columns, and over how many on either side that is reckoned.
BLUR, RADIUS = 1.0, 2
#: Of each sweep the temperature is so much at the beginning and at the end; between them it falls geometrically.
_HOT, _COLD = 0.1, 3e-4
#: How much pictures count under lamps that are too low and too high, beside those that are right: so they lose alike.
_FLAT, _STEEP = 0.8, 1.7
#: Heights at the beginning: about so much of the whole, and up to so many columns more.
_MIDDLE, _ROUGH = 1 / 3, 2.0
#: Steps of a column's offer and of one lamp, about a nanosecond each.
_WORK = 60
#: Differences between display values of linear light below this are as those of it: nobody sees more.
_DARK = 0.03


@dataclass(frozen=True)
class _Lamps:
    """Lamps as kernels take them: see `lightcube.kernels.relief`."""

    axes: Integers
    signs: Integers
    slopes: Reals

    @classmethod
    def of(cls, count: int, slopes: tuple[float, ...]) -> _Lamps:
        """The lamps of so many pictures, at one elevation after the other."""
        along_rows = np.isin(LAMPS_DEG[:count], (0.0, 180.0))
        from_the_end = np.isin(LAMPS_DEG[:count], (0.0, 270.0))  # to the right, and in front, where the last row is
        axes, signs = np.where(along_rows, 0, 1), np.where(from_the_end, 1, -1)
        return cls(np.tile(axes, len(slopes)), np.tile(signs, len(slopes)), np.repeat(np.array(slopes), count))

    def laid(self, pictures: Reals) -> Reals:
        """Pictures ``(lamp, row, column)`` as planes along whose lines light runs."""
        return np.stack(
            [(each if axis == 0 else each.T).ravel() for each, axis in zip(pictures, self.axes, strict=True)]
        )


def light_of(heights_px: Reals, count: int, slopes: tuple[float, ...] = (1.0,)) -> Reals:
    """The light of columns ``(lamp, row, column)`` of the first `count` lamps, slope after slope: exact."""
    from lightcube.kernels import relief as kernel

    lamps, (rows, columns) = _Lamps.of(count, slopes), heights_px.shape
    both = np.stack([heights_px.ravel(), heights_px.T.ravel()])
    horizon = kernel.horizons(both, lamps.axes, lamps.signs, lamps.slopes, np.array([columns, rows]))
    light = 1 - np.clip((horizon - both[lamps.axes]) / lamps.slopes[:, None], 0, 1)
    return np.stack(
        [
            plane.reshape(rows, columns) if axis == 0 else plane.reshape(columns, rows).T
            for plane, axis in zip(light, lamps.axes, strict=True)
        ]
    )


def annealed(wanted: Reals, recipe: ReliefRecipe, tell: Tell | None = None) -> Reals:
    """Heights ``(row, column)`` whose shadows are near the wanted light ``(picture, row, column)``.

    Raises
    ------
    Interrupted
        Where `tell` stops the work.
    """
    from lightcube.kernels import relief as kernel
    from lightcube.kernels.tasks import run

    count, rows, columns = wanted.shape
    lamps, lengths, taps = _Lamps.of(count, recipe.slopes), np.array([columns, rows]), blur_taps()
    random = np.random.default_rng(recipe.seed)
    heights = _begun(random, (rows, columns), recipe)
    both = np.stack([heights.ravel(), heights.T.ravel()])
    horizon = kernel.horizons(both, lamps.axes, lamps.signs, lamps.slopes, lengths)
    times = len(recipe.slopes), 1, 1
    error = lamps.laid(
        blurred(light_of(heights, count, recipe.slopes) - np.tile(unbounced(wanted, recipe.bounce), times))
    )
    weight = lamps.laid(seen(blurred(np.tile(wanted, times)))) * np.repeat(shares(recipe), count)[:, None]
    bounds = np.array([recipe.relief_px, recipe.steepest_px])
    groups, work = tiles((rows, columns), reach(recipe)), rows * columns * len(lamps.axes) * _WORK
    dice = np.empty((rows, columns, 5))
    for sweep in range(recipe.sweeps):
        temperature = _HOT * (_COLD / _HOT) ** (sweep / recipe.sweeps)
        random.random(out=dice)
        dice[..., 4] = random.standard_normal((rows, columns))
        for group in groups:
            run(
                *(kernel.anneal, len(group), work // len(groups), group, both, horizon, error, weight),
                *(lamps.axes, lamps.signs, lamps.slopes, lengths, taps, dice, count, bounds),
                *(temperature, recipe.smooth),
            )
        if tell is not None and tell(Progress(sweep + 1, recipe.sweeps)):
            raise Interrupted
    return locked(both[0].reshape(rows, columns))


def shares(recipe: ReliefRecipe) -> Reals:
    """How much the pictures count at each slope: together 1."""
    slopes = np.array(recipe.slopes)
    given = np.where(slopes > 1, _STEEP, np.where(slopes < 1, _FLAT, 1.0))
    return np.asarray(given / given.sum())


def _begun(random: np.random.Generator, shape: tuple[int, int], recipe: ReliefRecipe) -> Reals:
    """Heights to begin with: a rough plain."""
    rough = min(_ROUGH, recipe.steepest_px, recipe.relief_px * (1 - _MIDDLE))
    return random.uniform(0, rough, shape) + recipe.relief_px * _MIDDLE


def reach(recipe: ReliefRecipe) -> int:
    """So many columns away, in a row or a column of them, one that changes may change what another one is offered."""
    return math.ceil(recipe.relief_px / min(recipe.slopes)) + 1 + 2 * RADIUS


def tiles(shape: tuple[int, int], reach: int) -> list[Integers]:
    """Four groups of tiles ``(tile, 4)`` that cover a plate, as on a chessboard; those of a group are `reach` apart."""
    cuts = [np.linspace(0, side, max(1, side // (reach + 1)) + 1).astype(int) for side in shape]
    groups: dict[tuple[int, int], list[tuple[int, ...]]] = {}
    for i, (top, bottom) in enumerate(zip(cuts[0][:-1], cuts[0][1:], strict=True)):
        for j, (left, right) in enumerate(zip(cuts[1][:-1], cuts[1][1:], strict=True)):
            groups.setdefault((i % 2, j % 2), []).append((int(top), int(bottom), int(left), int(right)))
    return [np.array(group) for group in groups.values()]


def blur_taps() -> Reals:
    """The blur of an eye along a line: a normal distribution, cut off."""
    taps = np.exp(-(np.arange(-RADIUS, RADIUS + 1) ** 2) / (2 * BLUR**2))
    return np.asarray(taps / taps.sum())


def blurred(pictures: Reals) -> Reals:
    """Pictures ``(picture, row, column)`` as an eye sees them; beyond their edges there is nothing."""
    from scipy.ndimage import convolve1d

    taps = blur_taps()
    return np.asarray(convolve1d(convolve1d(pictures, taps, axis=1, mode="constant"), taps, axis=2, mode="constant"))


def seen(light: Reals) -> Reals:
    """How much errors of linear light count: the squared slope of the display curve there, 1 on average."""
    slope = np.maximum(light, _DARK) ** (1 / 2.4 - 1)
    return np.asarray(slope**2 / np.mean(slope**2))
