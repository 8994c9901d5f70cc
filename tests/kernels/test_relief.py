"""Laws of the loops for reliefs: horizons, exact changes, tiles; held against plain code that makes all anew."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from lightcube.kernels import relief as kernel
from lightcube.kernels import tasks
from lightcube.solids import relief_annealing as annealing
from lightcube.solids.relief import ReliefRecipe
from tests.helpers.reliefs import TOWARDS, objective, plain_light

SHAPE = (7, 9)
SLOPES = (1.0, 0.9, 1.12)


def some_heights(number: int = 0, shape: tuple[int, int] = SHAPE, most: float = 5.0) -> NDArray[np.float64]:
    return np.random.default_rng(number).uniform(0, most, shape)


def some_pictures(count: int, shape: tuple[int, int] = SHAPE) -> NDArray[np.float64]:
    return np.random.default_rng(7).uniform(0.2, 1, (count, *shape))


@pytest.mark.parametrize("slope", SLOPES)
def test_light_is_what_the_definition_says(slope: float) -> None:
    heights = some_heights()
    found = annealing.light_of(heights, 4, (slope,))
    np.testing.assert_allclose(found, [plain_light(heights, lamp, slope) for lamp in range(4)], atol=1e-12)


def test_slopes_come_one_after_the_other() -> None:
    heights = some_heights(1)
    found = annealing.light_of(heights, 3, (1.0, 0.8)).reshape(2, 3, *SHAPE)
    np.testing.assert_allclose(found[1], [plain_light(heights, lamp, 0.8) for lamp in range(3)], atol=1e-12)


class Walk:
    """A plate that is annealed by the kernel, with all that it keeps up to date."""

    def __init__(self, count: int, recipe: ReliefRecipe, smooth: float = 0.01) -> None:
        self.wanted, self.recipe, self.smooth = some_pictures(count), recipe, smooth
        self.lamps = annealing._Lamps.of(count, recipe.slopes)
        self.lengths, self.taps = np.array(SHAPE[::-1]), annealing.blur_taps()
        heights = some_heights(2, most=recipe.relief_px)
        self.both = np.stack([heights.ravel(), heights.T.ravel()])
        everywhere = np.tile(self.wanted, (len(recipe.slopes), 1, 1))
        self.horizon = self.horizons()
        self.error = self.errors()
        self.shares = annealing.shares(recipe)
        self.weight = self.lamps.laid(annealing.seen(annealing.blurred(everywhere)))
        self.weight *= np.repeat(self.shares, count)[:, None]

    @property
    def heights(self) -> NDArray[np.float64]:
        return self.both[0].reshape(SHAPE)

    def horizons(self) -> NDArray[np.float64]:
        return kernel.horizons(self.both, self.lamps.axes, self.lamps.signs, self.lamps.slopes, self.lengths)

    def errors(self) -> NDArray[np.float64]:
        light = annealing.light_of(self.heights, len(self.wanted), self.recipe.slopes)
        off = light - np.tile(self.wanted, (len(self.recipe.slopes), 1, 1))
        return self.lamps.laid(annealing.blurred(off))

    def go(self, dice: NDArray[Any], temperature: float) -> None:
        whole = np.array([[0, SHAPE[0], 0, SHAPE[1]]])
        bounds = np.array([self.recipe.relief_px, self.recipe.steepest_px])
        kernel.anneal(
            *(0, 1, whole, self.both, self.horizon, self.error, self.weight),
            *(self.lamps.axes, self.lamps.signs, self.lamps.slopes, self.lengths, self.taps),
            *(dice, len(self.wanted), bounds, temperature, self.smooth),
        )


def some_dice(number: int) -> NDArray[np.float64]:
    random = np.random.default_rng(number)
    return np.concatenate([random.random((*SHAPE, 4)), random.standard_normal((*SHAPE, 1))], axis=2)


def plain_offer(heights: NDArray[Any], row: int, column: int, dice: NDArray[Any], lamps: int) -> float | None:
    """The height that a column is offered, told anew."""
    kind, which, off, _, normal = dice
    if kind < 0.35:
        return heights[row, column] + 0.4 * normal
    if kind < 0.7:
        return heights[row, column] + 2.0 * normal
    k = 1 + int(3 * off)
    down, right = TOWARDS[int(lamps * which)]
    if not (0 <= row + k * down < SHAPE[0] and 0 <= column + k * right < SHAPE[1]):
        return None
    other, rest = heights[row + k * down, column + k * right], (kind - 0.7) / (1 - 0.7) * 2
    return other - (k - 1) + 1.2 * rest - 0.1 if rest < 1 else other + (k - 1) + 1.2 * (rest - 1)


@pytest.mark.parametrize(("count", "tolerance_deg"), [(1, 0.0), (2, 3.0), (4, 3.0)])
def test_a_sweep_accepts_what_reckoning_all_anew_accepts(count: int, tolerance_deg: float) -> None:
    recipe = ReliefRecipe(side=9, relief_px=5.0, tolerance_deg=tolerance_deg)
    walk = Walk(count, recipe)
    heights, accepted = walk.heights.copy(), 0
    for sweep, temperature in enumerate((0.5, 0.05)):
        dice = some_dice(sweep)
        walk.go(dice, temperature)

        def worth(plate: NDArray[Any]) -> float:
            return objective(plate, walk.wanted, np.array(recipe.slopes), walk.shares, walk.taps, walk.smooth)

        for row, column in itertools.product(*map(range, SHAPE)):
            offered = plain_offer(heights, row, column, dice[row, column], count)
            if offered is None:
                continue
            other = heights.copy()
            other[row, column] = min(5.0, max(0.0, offered))
            if worth(other) - worth(heights) <= -temperature * math.log(1 - dice[row, column, 3]):
                accepted += not np.array_equal(heights, other)
                heights = other
        np.testing.assert_allclose(walk.heights, heights, atol=1e-12)
    assert 10 < accepted < 2 * heights.size - 10


def test_what_is_kept_is_what_would_be_made_anew() -> None:
    walk = Walk(3, ReliefRecipe(side=9, relief_px=5.0))
    before = walk.heights.copy()
    for sweep in range(5):
        walk.go(some_dice(sweep), 0.1)
    assert np.count_nonzero(walk.heights != before) > before.size / 2
    np.testing.assert_array_equal(walk.both[1].reshape(SHAPE[::-1]).T, walk.heights)
    np.testing.assert_array_equal(walk.horizon, walk.horizons())
    np.testing.assert_allclose(walk.error, walk.errors(), atol=1e-12)


def test_steps_are_never_steeper_than_is_allowed() -> None:
    walk = Walk(2, ReliefRecipe(side=9, relief_px=5.0, steepest_px=1.5))
    walk.both[:] = 2.0 + np.random.default_rng(0).uniform(0, 0.1, walk.both[0].shape)
    walk.both[1] = walk.both[0].reshape(SHAPE).T.ravel()
    walk.horizon, walk.error = walk.horizons(), walk.errors()
    for sweep in range(6):
        walk.go(some_dice(sweep), 5.0)
    steps = [np.abs(np.diff(walk.heights, axis=axis)).max() for axis in (0, 1)]
    assert 1.0 < max(steps) <= 1.5 + 1e-12
    assert walk.heights.min() >= 0


@given(st.integers(1, 70), st.integers(1, 70), st.integers(1, 20))
@settings(max_examples=60)
def test_tiles_cover_a_plate_once_and_those_of_a_group_are_out_of_reach(rows: int, columns: int, reach: int) -> None:
    covered = np.zeros((rows, columns), int)
    for group in annealing.tiles((rows, columns), reach):
        for top, bottom, left, right in group:
            covered[top:bottom, left:right] += 1
        for one, other in itertools.combinations(group, 2):
            down = max(one[0], other[0]) - min(one[1], other[1]) + 1
            across = max(one[2], other[2]) - min(one[3], other[3]) + 1
            assert max(down, across) > reach
    assert np.all(covered == 1)


def test_nothing_reaches_further_than_is_said() -> None:
    """Columns of two tiles that are annealed at once neither write nor read what the other one writes."""
    recipe = ReliefRecipe(side=64, relief_px=5.0)
    reach, side = annealing.reach(recipe), 64
    heights = np.random.default_rng(0).uniform(0, 0.01, (side, side))
    heights[32, 32] = 5.0
    light = annealing.light_of(heights, 4, recipe.slopes)
    heights[32, 32] = 0.0
    changed = annealing.blurred(light - annealing.light_of(heights, 4, recipe.slopes)) != 0
    rows, columns = np.nonzero(changed.any(axis=0))
    furthest = max(np.abs(rows - 32).max(), np.abs(columns - 32).max())
    assert reach - annealing.RADIUS - 1 <= furthest <= reach - annealing.RADIUS


@pytest.mark.skipif(tasks.config.DISABLE_JIT, reason="interpreted loops have one thread")  # type: ignore[attr-defined]
def test_any_number_of_threads_gives_the_same_bits() -> None:
    recipe = ReliefRecipe(side=60, relief_px=4.0, sweeps=4)
    assert max(len(group) for group in annealing.tiles((60, 60), annealing.reach(recipe))) >= 4
    pictures, made = some_pictures(3, (60, 60)), []
    for threads in (1, 2, 5):
        with tasks.using(threads):
            made.append(annealing.annealed(pictures, recipe))
    np.testing.assert_array_equal(made[0], made[1])
    np.testing.assert_array_equal(made[0], made[2])


def test_annealing_comes_nearer_and_a_seed_decides() -> None:
    pictures = some_pictures(2, (12, 10))
    recipe = ReliefRecipe(side=12, relief_px=4.0, sweeps=8)

    def worth(heights: NDArray[Any]) -> float:
        shares = annealing.shares(recipe)
        return objective(heights, pictures, np.array(recipe.slopes), shares, annealing.blur_taps(), recipe.smooth)

    first = annealing.annealed(pictures, recipe)
    np.testing.assert_array_equal(first, annealing.annealed(pictures, recipe))
    assert worth(first) < 0.5 * worth(some_heights(0, (12, 10), 4.0))
    other = annealing.annealed(pictures, ReliefRecipe(side=12, relief_px=4.0, sweeps=8, seed=1))
    assert not np.array_equal(first, other)
