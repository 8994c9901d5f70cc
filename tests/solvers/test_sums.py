"""The display solver where light of several views adds up: its objective and the bounds on it."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lightcube.kernels import display
from lightcube.kernels import objective as kernels
from lightcube.optics.law import Mixture, shown_light
from lightcube.optics.transfer import encode
from lightcube.solvers import _objective
from lightcube.solvers._convex import ConvexObjective as PlainScreen
from lightcube.solvers._objective import Objective
from lightcube.solvers.contract import Lighting, Wanted
from lightcube.solvers.display import display_values
from tests.conftest import INTERPRETED
from tests.helpers import plain
from tests.helpers.solver_problems import DenseOperator

#: Rows, columns and channels of a view's block, its entries, and its pixels.
ROWS, COLUMNS, CHANNELS = 3, 4, 2
ENTRIES, PIXELS = ROWS * COLUMNS, ROWS * COLUMNS // CHANNELS
#: Views of each picture: under lamps that shine on it together, and under one lamp for each picture.
SHAPES = ((2, 1, 4), (3, 1, 5))


def random_sums(counts: tuple[int, ...] = (2, 1, 4), plain: bool = False) -> tuple[Lighting, Mixture]:
    """Pictures of so many views each, under lamps that some of them share."""
    random = np.random.default_rng(1)
    views = sum(counts)
    lamps = {7: [0, 1, 1, 0, 2, 2, 3], 9: [0, 0, 0, 1, 2, 2, 2, 2, 2]}.get(views, list(range(views)))
    light, shadow = random.uniform(0.2, 1.5, (views, PIXELS)), random.uniform(0, 1, (views, PIXELS))
    share = random.uniform(0.1, 1, (views, CHANNELS))
    if plain:
        light, shadow, share = np.ones_like(light), np.ones_like(shadow), np.ones_like(share)
    mixture = Mixture(np.cumsum([0, *counts]), share, light, shadow)
    return Lighting(np.array(lamps), mixture), mixture


def some_screen(given: tuple[Lighting, Mixture], **more: Any) -> tuple[Objective, np.ndarray, np.ndarray]:
    """What is wanted of sums, some absorbance to try, and ln P to try it under."""
    random = np.random.default_rng(2)
    sums, mixture = given
    lamps = sums.lamps
    light = random.uniform(0.02, 1.6, (sums.pictures * ROWS, COLUMNS))
    weights = random.choice([0.0, 1.0, 2.5], light.shape)
    bounds = np.full((lamps, CHANNELS), 0.1), np.full((lamps, CHANNELS), 9.0)
    screen = Objective.of(Wanted(light, weights, sums, **{"lamp_bounds": bounds, **more}), mixture)
    absorbance = random.exponential(0.8, (len(sums.lamp) * ROWS, COLUMNS))
    return screen, absorbance, random.uniform(-1, 1, (lamps, CHANNELS))


def plain_objective(
    given: tuple[Lighting, Mixture], screen: Objective, absorbance: np.ndarray, lamp: np.ndarray
) -> np.ndarray:
    """Half the weighted squared two-sided residual of the sums, entry by entry, of each column."""
    (sums, mixture), total = given, np.zeros(COLUMNS)
    powers = np.exp(lamp)[sums.lamp] * mixture.share
    data = mixture.starts, powers, mixture.light, mixture.shadow, absorbance.reshape(-1, ENTRIES)
    for (picture, entry), light in np.ndenumerate(plain.shown_light(*data)):
        goal = screen.wanted[picture, entry]
        step = 1e-6
        pair = encode(np.exp(np.array([goal - step, goal + step])))
        slope = max(float(pair[1] - pair[0]) / (2 * step), 0.03)
        bright = float(encode(np.array([light]))[0] - encode(np.exp(np.array([goal])))[0])
        value = bright if np.log(light) > goal else slope * (np.log(light) - goal)
        total[entry % COLUMNS] += 0.5 * screen.weights[picture, entry] * value**2
    return total


def objective(screen: Objective | PlainScreen, absorbance: np.ndarray, lamp: np.ndarray) -> float:
    return float(np.sum(arrived(screen, absorbance, absorbance, lamp)[0]))


def arrived(
    screen: Objective | PlainScreen, last: np.ndarray, absorbance: np.ndarray, lamp: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    return screen.arrive(last, absorbance, screen.joint(absorbance), lamp)


def descended(screen: Objective | PlainScreen, absorbance: np.ndarray, lamp: np.ndarray) -> np.ndarray:
    slopes = absorbance.copy()
    return screen.descend(slopes, screen.joint(slopes), lamp)


def curved(screen: Objective | PlainScreen, absorbance: np.ndarray, lamp: np.ndarray) -> np.ndarray:
    return screen.curved(np.ones_like(absorbance), absorbance, screen.joint(absorbance), lamp)


@pytest.mark.parametrize("counts", SHAPES)
def test_the_objective_is_that_of_the_plain_sum(counts: tuple[int, ...]) -> None:
    given = random_sums(counts)
    screen, absorbance, lamp = some_screen(given)
    last = absorbance * 0.7
    found, least = arrived(screen, last, absorbance, lamp)
    np.testing.assert_allclose(found, plain_objective(given, screen, absorbance, lamp), rtol=1e-6)
    np.testing.assert_allclose(least, np.min((2 * absorbance - last).reshape(-1, COLUMNS), axis=0))


@pytest.mark.parametrize("counts", SHAPES)
def test_slopes_are_those_of_the_objective(counts: tuple[int, ...]) -> None:
    screen, absorbance, lamp = some_screen(random_sums(counts))
    slopes = descended(screen, absorbance, lamp)
    step = 1e-5
    for index in np.ndindex(*absorbance.shape):
        ends = []
        for sign in (-1, 1):
            moved = absorbance.copy()
            moved[index] += sign * step
            ends.append(objective(screen, moved, lamp))
        assert slopes[index] == pytest.approx((ends[1] - ends[0]) / (2 * step), rel=1e-4, abs=1e-7)


def hessians(mixture: Mixture, screen: Objective, absorbance: np.ndarray, lamp: np.ndarray) -> list[np.ndarray]:
    """Second derivatives by the absorbance of a picture's views, ``(entries, views, views)``: other pairs have none."""
    step, found = 1e-5, []
    for first, last in zip(mixture.starts[:-1], mixture.starts[1:], strict=True):
        rows = []
        for view in range(first, last):
            ends = []
            for sign in (-1, 1):
                moved = absorbance.reshape(-1, ENTRIES).copy()
                moved[view] += sign * step
                slopes = descended(screen, moved.reshape(absorbance.shape), lamp).reshape(-1, ENTRIES)
                ends.append(slopes[first:last].copy())
            rows.append((ends[1] - ends[0]) / (2 * step))
        found.append(np.stack(rows).transpose(2, 0, 1))
    return found


@pytest.mark.parametrize("counts", SHAPES)
@pytest.mark.parametrize("room", [None, 0.0])
def test_no_second_derivative_exceeds_its_bound(
    room: float | None, counts: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The diagonal matrix of the bounds less the second derivatives has no eigenvalue below 0; also without room."""
    sums, mixture = random_sums(counts)
    screen, absorbance, lamp = some_screen((sums, mixture))
    if room is not None:
        monkeypatch.setattr(_objective, "ROOM", room)
    bounds = curved(screen, absorbance, lamp)
    above, least = 0, np.inf
    weights = screen.weights
    for picture, second in enumerate(hessians(mixture, screen, absorbance, lamp)):
        views = slice(mixture.starts[picture], mixture.starts[picture + 1])
        diagonal = bounds.reshape(-1, ENTRIES)[views]
        for entry in np.flatnonzero(weights[picture]):
            gap = np.linalg.eigvalsh(np.diag(diagonal[:, entry]) - second[entry])
            assert gap[0] >= -1e-4
            above += int(np.any(np.linalg.eigvalsh(second[entry]) < -1e-3))
            least = min(least, float(gap[0] / diagonal[:, entry].max()))
    assert above > 0  # it is not convex
    assert room is None or least < 0.05  # and the bounds are near somewhere


def test_bounds_are_what_their_formula_says() -> None:
    """A view counts as a part of all light on the screen, whichever lamp it has."""
    sums, mixture = random_sums()
    screen, absorbance, lamp = some_screen((sums, mixture))
    found = curved(screen, absorbance, lamp).reshape(-1, ENTRIES)
    colours, pixels = np.arange(ENTRIES) % CHANNELS, np.arange(ENTRIES) // CHANNELS
    full = (np.exp(lamp)[sums.lamp] * mixture.share)[:, colours] * mixture.light[:, pixels]
    dark = full * mixture.shadow[:, pixels]
    through = dark * np.exp(-absorbance.reshape(-1, ENTRIES))
    for picture, first in enumerate(mixture.starts[:-1]):
        views = slice(first, mixture.starts[picture + 1])
        light = np.sum((full - dark + through)[views], axis=0)
        parts = np.maximum(through[views] / light, 0.2 * dark[views] / np.sum(full[views], axis=0))
        for i in range(ENTRIES):
            u, goal, weight = np.log(light[i]) + 0.1, screen.wanted[picture, i], screen.weights[picture, i]
            s = parts[:, i]
            first_slope = max(display.pull(float(u), float(goal), screen.curve)[0], 0)
            bend = display.curvature(float(u), float(goal), screen.curve)
            expected = weight * (s * np.sum(s) * bend + np.minimum(s, np.abs(2 * s * (1 - s))) * first_slope)
            np.testing.assert_allclose(found[views, i], expected, rtol=1e-6, atol=1e-12)


def test_lamps_are_pulled_as_the_objective_falls() -> None:
    sums, mixture = random_sums()
    _, absorbance, lamp = some_screen((sums, mixture))
    groups = np.array([0, 1, 2, 3, 4, 4, 5])  # of views of a picture and a lamp
    each = lamp[[0, 1, 1, 0, 2, 3]]
    own = replace(sums, lamp=groups)
    bounds = np.full((6, 2), np.exp(-9.0)), np.full((6, 2), np.exp(9.0))
    screen, _, _ = some_screen((own, mixture), lamp_bounds=bounds)
    joint = screen.joint(absorbance).reshape(6, ENTRIES)
    data = COLUMNS, screen.wanted, screen.weights, screen.curve
    first, second = kernels.pulls(screen.starts, np.exp(each), joint, *data)
    step = 1e-4
    for index in np.ndindex(*each.shape):
        ends = []
        for sign in (-1, 0, 1):
            moved = each.copy()
            moved[index] += sign * step
            ends.append(objective(screen, absorbance, moved))
        assert first[index] == pytest.approx((ends[2] - ends[0]) / (2 * step), rel=1e-4, abs=1e-6)
        assert (ends[0] - 2 * ends[1] + ends[2]) / step**2 <= second[index] + 1e-3


@pytest.mark.parametrize(("counts", "calls"), [(SHAPES[0], 8), (SHAPES[1], 1)])
def test_the_lamps_found_are_the_best_within_their_bounds(counts: tuple[int, ...], calls: int) -> None:
    """Found from anywhere, where several shine on a picture in a few calls; no step lowers the objective."""
    sums, mixture = random_sums(counts)
    low, high = np.full((sums.lamps, CHANNELS), 0.5), np.full((sums.lamps, CHANNELS), 2.0)
    low[1], high[1] = 1.3, 1.3
    screen, absorbance, lamp = some_screen((sums, mixture), lamp_bounds=(low, high))
    best = lamp
    for _ in range(calls):
        best = screen.best_lamp(screen.joint(absorbance), best)
    assert np.all((screen.powers(best) >= low) & (screen.powers(best) <= high))
    assert np.all(screen.powers(best)[1] == 1.3)
    reached = objective(screen, absorbance, best)
    assert reached < objective(screen, absorbance, np.clip(lamp, np.log(low), np.log(high)))
    for index in np.ndindex(*best.shape):
        for step in (-0.03, 0.03):
            moved = best.copy()
            moved[index] = np.clip(moved[index] + step, np.log(low[index]), np.log(high[index]))
            assert objective(screen, absorbance, moved) >= reached - 1e-6


def test_of_one_whole_shadow_each_it_is_the_screen_of_plain_pictures() -> None:
    mixed, absorbance, lamp = some_screen(random_sums((1, 1, 1, 1), plain=True))
    wanted, weights = np.exp(mixed.wanted).reshape(-1, COLUMNS), mixed.weights.reshape(-1, COLUMNS)
    plain = PlainScreen.of(Wanted(wanted, weights, Lighting(np.arange(4)), mixed.bounds))
    for one, other in zip(*(arrived(each, 0.5 * absorbance, absorbance, lamp) for each in (mixed, plain)), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-6)
    slopes = [descended(each, absorbance, lamp) for each in (mixed, plain)]
    np.testing.assert_allclose(slopes[0], slopes[1], rtol=1e-5, atol=1e-9)
    bounds = [curved(each, absorbance, lamp) for each in (mixed, plain)]
    assert np.all(bounds[0] >= bounds[1] * (1 - 1e-9))  # the other one knows that no light exceeds the lamp
    assert np.mean(np.isclose(bounds[0], bounds[1])) > 0.5
    lamps = [each.best_lamp(each.joint(absorbance), lamp) for each in (mixed, plain)]
    np.testing.assert_allclose(lamps[0], lamps[1], atol=1e-9)


def test_pixels_that_are_alike_may_be_one() -> None:
    """The same bits of all that a solver asks."""
    sums, mixture = random_sums()
    mixture.light[:], mixture.shadow[:] = mixture.light[:, :1], mixture.shadow[:, :1]
    one = Mixture(mixture.starts, mixture.share, mixture.light[:, :1], mixture.shadow[:, :1])
    screens = [some_screen(given) for given in ((sums, mixture), (Lighting(sums.lamp, one), one))]
    found = []
    for screen, absorbance, lamp in screens:
        both = curved(screen, absorbance, lamp), descended(screen, absorbance, lamp)
        best = screen.best_lamp(screen.joint(absorbance), lamp)
        found.append([*both, *arrived(screen, 0.5 * absorbance, absorbance, lamp), best])
    for many, few in zip(*found, strict=True):
        assert np.array_equal(many, few)


def test_pictures_of_many_views_and_pixels_leave_no_seam() -> None:
    """So many that a task takes some of the pixels at a time."""
    views, pixels = (3, 40) if INTERPRETED else (150, 700)
    random = np.random.default_rng(6)
    starts, lamp = np.array([0, views - 1, views]), np.arange(views) // (views - 1)
    light, shadow = random.uniform(0.5, 1, (2, views, pixels))
    mixture = Mixture(starts, np.ones((views, 3)), light, shadow)
    wanted = random.uniform(0.1, 1, (2 * pixels, 3)) * np.array([views, 1]).repeat(pixels)[:, None]
    bounds = np.full((2, 3), 0.5), np.full((2, 3), 2.0)
    screen = Objective.of(Wanted(wanted, None, Lighting(lamp, mixture), bounds, "linear"), mixture)
    absorbance, powers = random.exponential(0.5, (views * pixels, 3)), np.array([[0.7] * 3, [1.5] * 3])
    through = 1 + shadow[..., None] * np.expm1(-absorbance.reshape(views, pixels, 3))
    parts = powers[lamp][:, None] * light[..., None] * through
    expected = np.add.reduceat(parts, starts[:-1])
    shown = shown_light(mixture, powers[lamp], absorbance, (1, pixels))
    np.testing.assert_allclose(shown.reshape(expected.shape), expected, rtol=1e-6)
    off = expected - wanted.reshape(expected.shape)
    too_dark = wanted.reshape(expected.shape) * np.log(expected / wanted.reshape(expected.shape))
    value = np.where(off > 0, off, too_dark)
    found, _ = arrived(screen, absorbance, absorbance, np.log(powers))
    np.testing.assert_allclose(found, 0.5 * np.sum(value**2, axis=(0, 1)), rtol=1e-5)
    pulled = value * np.where(off > 0, expected, wanted.reshape(expected.shape))
    dark = parts - powers[lamp][:, None] * light[..., None] * (1 - shadow[..., None])
    slopes = -np.repeat(pulled / expected, np.diff(starts), axis=0) * dark
    np.testing.assert_allclose(
        descended(screen, absorbance, np.log(powers)).reshape(slopes.shape), slopes, rtol=1e-5, atol=1e-9
    )


def test_what_no_light_reaches_is_not_asked_for() -> None:
    """A lamp without green leaves it black whatever the cube: wanted or not, the cube is the same."""
    sums, mixture = random_sums()
    mixture.share[2, 1] = 0
    mixture.light[3:, 2] = 0
    wanted = np.random.default_rng(8).uniform(0.05, 1, (3 * ROWS, COLUMNS))
    A = DenseOperator(np.random.default_rng(9).random((7 * ROWS, 5)))
    unlit = np.zeros((3, PIXELS, CHANNELS), bool)
    unlit[1, :, 1] = unlit[2, 2] = True
    lamps = np.full((4, CHANNELS), 0.1), np.full((4, CHANNELS), 9.0)
    one = display_values(A, Wanted(wanted, None, sums, lamps), iterations=12)
    lit = 1.0 - unlit.reshape(3 * ROWS, COLUMNS)
    other = display_values(A, Wanted(wanted, lit, sums, lamps), iterations=12)
    np.testing.assert_array_equal(one.x, other.x)
    np.testing.assert_array_equal(one.residuals, other.residuals)


@pytest.mark.parametrize(("dtype", "start"), [("float64", 20.0), ("float32", 90.0), ("float64", 900.0)])
def test_a_sum_that_is_much_too_dark_comes_back(dtype: str, start: float) -> None:
    """From light so weak that float32 has no number for it, but in its logarithm."""
    sums, mixture = random_sums((2, 2, 2))
    mixture.shadow[:] = 1
    A = DenseOperator(np.random.default_rng(9).random((6 * ROWS, 4)))
    powers = np.full((6, CHANNELS), 1.5)
    truth = np.random.default_rng(10).exponential(0.5, (4, COLUMNS))
    wanted = shown_light(mixture, powers, A.forward(truth), (1, PIXELS)).reshape(-1, COLUMNS)
    goal = Wanted(wanted.astype(dtype), None, sums, (powers, powers))
    result = display_values(A, goal, x0=np.full((4, COLUMNS), start), iterations=400)
    shown = shown_light(mixture, powers, A.forward(result.x), (1, PIXELS)).reshape(-1, COLUMNS)
    assert np.max(np.abs(encode(shown) - encode(wanted))) < 0.01
