"""The display solver: its objective, its optimum, its limits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import Bounds, minimize

from lightcube.kernels import descent
from lightcube.kernels.display import conjugate, curvature, display_of_log, residual
from lightcube.kernels.display import curve as curve_of
from lightcube.optics.grid import Grid
from lightcube.optics.transfer import Transfer, encode
from lightcube.optics.views import spread_angles, turntable_views
from lightcube.projection.projector import Projector
from lightcube.solvers.contract import Lighting, Progress, Wanted
from lightcube.solvers.display import display_values

#: Lamps of three and of four views, each with its own.
THREE, FOUR = (Lighting(np.arange(views)) for views in (3, 4))


def plain_objective(matrix: np.ndarray, x: np.ndarray, wanted: np.ndarray, power: float, weight: np.ndarray) -> float:
    """Half the weighted squared two-sided residual, one entry at a time."""
    total = 0.0
    light = power * np.exp(-(matrix @ x))
    for index in np.ndindex(*wanted.shape):
        u, goal = np.log(light[index]), np.log(wanted[index])
        g_u, g_goal = (float(encode(np.array([value]))[0]) for value in (light[index], wanted[index]))
        step = 1e-6
        pair = encode(np.exp(np.array([goal - step, goal + step])))
        slope = max(float(pair[1] - pair[0]) / (2 * step), 0.03)
        value = g_u - g_goal if u > goal else slope * (u - goal)
        total += 0.5 * float(weight[index]) * value**2
    return total


@given(st.floats(-9, 4), st.booleans())
def test_display_of_log_is_the_curve_and_its_derivatives(u: float, srgb: bool) -> None:
    value, slope, bend = display_of_log(u, curve_of(srgb, np.float64))
    light = np.exp(np.array([u]))
    assert value == pytest.approx(float((encode(light) if srgb else light)[0]), rel=1e-7, abs=1e-7)
    if abs(u - np.log(0.0031308)) > 1e-3:
        step = 1e-5
        low, high = (
            display_of_log(u - step, curve_of(srgb, np.float64)),
            display_of_log(u + step, curve_of(srgb, np.float64)),
        )
        assert slope == pytest.approx((high[0] - low[0]) / (2 * step), rel=1e-4)
        assert bend == pytest.approx((high[1] - low[1]) / (2 * step), rel=1e-4)


@given(st.floats(-9, 3), st.floats(-9, 0), st.booleans())
def test_the_bound_on_the_curvature_holds_below(u: float, wanted: float, srgb: bool) -> None:
    bound = curvature(u, wanted, curve_of(srgb, np.float64))
    step = 1e-4
    for other in np.linspace(-9, max(u, wanted) - 2 * step, 7):
        if min(abs(other - wanted), abs(other - np.log(0.0031308))) < 3 * step:
            continue  # half the square has a kink in its slope there
        halves = [
            0.5 * residual(float(v), wanted, curve_of(srgb, np.float64))[0] ** 2
            for v in (other - step, other, other + step)
        ]
        second = (halves[0] - 2 * halves[1] + halves[2]) / step**2
        assert second <= bound + 1e-4


@given(st.floats(-2, 2), st.floats(-9, 0), st.booleans())
def test_the_conjugate_is_the_largest_of_all_differences(slope: float, wanted: float, srgb: bool) -> None:
    """Convex duality: slope u - f(u) never exceeds it, and comes near it somewhere."""
    found = conjugate(slope, wanted, curve_of(srgb, np.float64))
    lines = [
        slope * u - 0.5 * residual(float(u), wanted, curve_of(srgb, np.float64))[0] ** 2
        for u in np.linspace(-40, 6, 4001)
    ]
    assert max(lines) <= found + 1e-9 * (1 + abs(found))
    if abs(slope) < 0.01:  # its place lies within the range looked at
        assert max(lines) == pytest.approx(found, rel=2e-3, abs=2e-3)


def small_problem() -> tuple[Projector, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    grid = Grid((1, 3, 4))
    views = turntable_views(grid, spread_angles(3))
    matrix = Projector(grid, views)
    random = np.random.default_rng(0)
    wanted = random.uniform(0.02, 1.4, (matrix.shape[0], 2))
    weight = random.choice([0.0, 1.0, 2.0], wanted.shape)
    powers = np.full((3, 2), 1.5)
    return matrix, wanted, weight, powers, matrix.to_sparse().toarray()


@pytest.mark.parametrize("bounds", [(0.0, np.inf), (0.0, 0.4)])
def test_matches_a_generic_bounded_optimiser(bounds: tuple[float, float]) -> None:
    matrix, wanted, weight, powers, dense = small_problem()
    result = display_values(
        matrix,
        Wanted(wanted, weights=weight, lighting=THREE, lamp_bounds=(powers, powers)),
        bounds=bounds,
        iterations=400,
    )

    def flat_objective(flat: np.ndarray) -> float:
        return plain_objective(dense, flat.reshape(result.x.shape), wanted, 1.5, weight)

    generic = minimize(
        flat_objective,
        np.full(result.x.size, 0.1),
        method="L-BFGS-B",
        bounds=Bounds(*bounds),
        options={"maxiter": 300},
    )
    ours = plain_objective(dense, result.x, wanted, 1.5, weight)
    assert result.residuals[-1] == pytest.approx(ours, rel=1e-6)
    assert ours <= generic.fun * (1 + 1e-3)
    assert result.x.min() >= bounds[0]
    assert result.x.max() <= bounds[1]


def test_the_objective_at_the_end_is_a_minimum_in_every_direction() -> None:
    """Convex and optimal: no feasible step of any unknown lowers the objective by more than rounding."""
    matrix, wanted, weight, powers, dense = small_problem()
    result = display_values(matrix, Wanted(wanted, weight, THREE, (powers, powers)), iterations=400)
    best = plain_objective(dense, result.x, wanted, 1.5, weight)
    for index in np.ndindex(*result.x.shape):
        for step in (-0.02, 0.02):
            moved = result.x.copy()
            moved[index] = max(float(moved[index]) + step, 0.0)
            assert plain_objective(dense, moved, wanted, 1.5, weight) >= best - 1e-4


def test_a_beam_that_is_much_too_dark_comes_back() -> None:
    """Started from nearly black, where display values alone have no gradient left."""
    grid = Grid((1, 2, 3))
    matrix = Projector(grid, turntable_views(grid, [30.0, 100.0]))
    truth = np.random.default_rng(1).random((6, 3)) * 0.3
    wanted = np.exp(-matrix.forward(truth))
    result = display_values(matrix, Wanted(wanted), x0=np.full((6, 3), 20.0), iterations=800)
    assert np.max(np.abs(encode(np.exp(-matrix.forward(result.x))) - encode(wanted))) < 0.01


def test_bright_beams_beyond_the_lamp_pull_to_transparent() -> None:
    grid = Grid((1, 2, 3))
    matrix = Projector(grid, turntable_views(grid, [30.0]))
    result = display_values(matrix, Wanted(np.full((matrix.shape[0], 1), 2.0)), x0=np.full((6, 1), 0.5), iterations=50)
    assert np.allclose(result.x, 0)


def test_voxels_that_no_weighted_beam_meets_stay_where_they_are() -> None:
    grid = Grid((1, 4, 6))
    matrix = Projector(grid, turntable_views(grid, [0.0], picture_shape=(1, 2)))
    result = display_values(matrix, Wanted(np.full((matrix.shape[0], 1), 0.5)), iterations=5)
    unseen = np.asarray(matrix.to_sparse().sum(axis=0)).ravel() == 0
    assert unseen.any()
    assert np.all(result.x[unseen] == 0)
    assert np.all(result.x[~unseen] > 0)


def test_the_callback_sees_the_absorbance_of_x_and_stops() -> None:
    matrix, wanted, _, _, dense = small_problem()
    seen: list[int] = []

    def callback(progress: Progress) -> bool:
        assert np.allclose(progress.absorbance, dense @ progress.x)
        seen.append(progress.iteration)
        return progress.iteration == 4

    result = display_values(matrix, Wanted(wanted), callback=callback)
    assert seen == [1, 2, 3, 4]
    assert result.stop_reason == "callback"


def lamp_problem() -> tuple[Projector, np.ndarray, np.ndarray]:
    """Pictures of a known cube under lamps of known powers, brighter and darker than 1, two channels."""
    grid = Grid((2, 3, 4))
    matrix = Projector(grid, turntable_views(grid, spread_angles(4)))
    random = np.random.default_rng(3)
    powers = np.array([[0.5, 1.0], [2.0, 3.0], [1.0, 0.7], [5.0, 1.5]])
    truth = random.uniform(0, 0.4, (matrix.shape[1], 4))
    light = powers[matrix.view_of_row][:, np.arange(4) % 2] * np.exp(-matrix.forward(truth))
    return matrix, light, powers


def test_lamp_powers_are_found_where_beams_beside_the_cube_show_them() -> None:
    matrix, light, powers = lamp_problem()
    bounds = (np.full((4, 2), 1e-3), np.full((4, 2), 16.0))
    result = display_values(matrix, Wanted(light, lighting=FOUR, lamp_bounds=bounds), iterations=2000)
    assert np.allclose(result.lamp_powers, powers, rtol=1e-2)
    assert result.residuals[-1] < 1e-6


def test_started_at_the_cube_it_stays_there_and_finds_the_lamps_at_once() -> None:
    matrix, _, powers = lamp_problem()
    truth = np.random.default_rng(4).uniform(0, 0.4, (matrix.shape[1], 2))
    light = powers[matrix.view_of_row] * np.exp(-matrix.forward(truth))
    bounds = (np.full((4, 2), 1e-3), np.full((4, 2), 16.0))
    result = display_values(matrix, Wanted(light, None, FOUR, bounds), x0=truth, iterations=1)
    assert np.allclose(result.x, truth, atol=1e-6)
    assert np.allclose(result.lamp_powers, powers, rtol=1e-6)


def test_lamp_powers_keep_their_bounds_and_none_within_is_better() -> None:
    matrix, light, _ = lamp_problem()
    low, high = np.full((4, 2), 0.8), np.full((4, 2), 2.0)
    result = display_values(matrix, Wanted(light, lighting=FOUR, lamp_bounds=(low, high)), iterations=300)
    assert np.all((result.lamp_powers >= low * (1 - 1e-9)) & (result.lamp_powers <= high * (1 + 1e-9)))
    dense = matrix.to_sparse().toarray()

    def objective(powers: np.ndarray) -> float:
        total = 0.0
        for view in range(4):
            for channel in range(2):
                mine = matrix.view_of_row == view
                part = light[mine][:, channel::2]
                total += plain_objective(
                    dense[mine], result.x[:, channel::2], part, float(powers[view, channel]), np.ones(part.shape)
                )
        return total

    best = objective(result.lamp_powers)
    assert best == pytest.approx(result.residuals[-1], rel=1e-5)
    for index in np.ndindex(4, 2):
        for factor in (0.97, 1.03):
            powers = result.lamp_powers.copy()
            powers[index] = np.clip(powers[index] * factor, 0.8, 2.0)
            assert objective(powers) >= best - 1e-6


def test_a_free_lamp_is_never_worse_than_a_fixed_one() -> None:
    matrix, light, _ = lamp_problem()
    one = np.ones((4, 2))
    fixed = display_values(matrix, Wanted(light, None, FOUR, (one, one)), iterations=500)
    free = display_values(matrix, Wanted(light, None, FOUR, (0.1 * one, 4 * one)), iterations=500)
    assert free.residuals[-1] < fixed.residuals[-1]


def test_views_may_share_a_lamp() -> None:
    """Rows of several views that name the same lamp get one power, the best for all of them."""
    matrix, light, _ = lamp_problem()
    bounds = (np.full((2, 2), 0.1), np.full((2, 2), 8.0))
    result = display_values(
        matrix, Wanted(light, lighting=Lighting(np.array([0, 0, 1, 1])), lamp_bounds=bounds), iterations=300
    )
    assert result.lamp_powers.shape == (2, 2)


def test_linear_pictures_are_fitted_in_linear_light() -> None:
    """On pictures that no cube can cast, each curve's own optimum is the better one in its own display values."""
    matrix, wanted, _, powers, _ = small_problem()
    errors = {}
    transfers: tuple[Transfer, ...] = ("srgb", "linear")
    for transfer in transfers:
        goal = Wanted(np.minimum(wanted, 1.5), None, THREE, (powers, powers), transfer)
        x = display_values(matrix, goal, iterations=400).x
        shown = 1.5 * np.exp(-matrix.forward(x))
        errors[transfer] = np.sum((shown - np.minimum(wanted, 1.5)) ** 2)
    assert errors["linear"] < 0.99 * errors["srgb"]


def test_the_scale_of_all_weights_changes_nothing() -> None:
    matrix, wanted, weight, powers, _ = small_problem()
    lamps = powers, powers
    one = display_values(matrix, Wanted(wanted, weight, THREE, lamps), iterations=60)
    small = display_values(matrix, Wanted(wanted, weight * 2.0**-30, THREE, lamps), iterations=60)
    assert len(one.residuals) == len(small.residuals)
    assert np.allclose(one.x, small.x, atol=1e-9)


def test_a_lamp_that_nothing_speaks_for_stays_where_it_starts() -> None:
    matrix, light, _ = lamp_problem()
    weights = np.where(matrix.view_of_row == 1, 0.0, 1.0)[:, None]
    bounds = (np.full((4, 2), 0.1), np.full((4, 2), 16.0))
    result = display_values(matrix, Wanted(light, weights=weights, lighting=FOUR, lamp_bounds=bounds), iterations=5)
    assert np.allclose(result.lamp_powers[1], 1)


def test_fixed_lamp_powers_come_back_to_the_last_digit() -> None:
    matrix, wanted, _, powers, _ = small_problem()
    odd = powers * 1.1
    result = display_values(matrix, Wanted(wanted, None, THREE, (odd, odd)), iterations=2)
    assert np.array_equal(result.lamp_powers, odd)


@pytest.mark.parametrize(("lamp", "bounds"), [(1.0, (0.0, np.inf)), (8.0, (0.0, np.inf)), (8.0, (0.02, 0.5))])
def test_no_cube_and_no_lamp_comes_below_the_lower_bound(lamp: float, bounds: tuple[float, float]) -> None:
    """It holds after few iterations, and after many it is nearly reached: then the optimum is known."""
    matrix, wanted, weight, _, _ = small_problem()
    powers = (np.full((3, 2), 0.3), np.full((3, 2), lamp))
    goal = Wanted(wanted, weight, THREE, powers)
    results = [display_values(matrix, goal, bounds=bounds, iterations=count) for count in (1, 5, 20, 2000)]
    best = float(results[-1].residuals[-1])
    for result in results:
        assert result.lower_bound is not None
        assert 0 <= result.lower_bound <= best * (1 + 1e-6)
    assert best > 0.01
    assert results[-1].lower_bound == pytest.approx(best, rel=0.05)


def test_a_step_is_what_its_formula_says() -> None:
    """One walk through memory against one line of numpy for each quantity."""
    random = np.random.default_rng(11)
    x, before, slopes = (random.normal(size=(70, 3)) for _ in range(3))
    steps = np.where(random.random((70, 3)) < 0.2, 0, random.random((70, 3)))
    ahead, stride = np.array([0.0, 1.0, 1.0]), np.array([1.0, 1.3, 0.7])
    y = x + ahead * (x - before)
    moved = np.clip(y - stride * steps * slopes, -0.5, 0.8)
    new = np.where(steps > 0, moved, x)
    share = np.divide((y - new) * (new - x), steps, out=np.zeros_like(x), where=steps > 0)
    uphill = descent.step(x, before, ahead, slopes, steps, stride, -0.5, 0.8)
    assert np.allclose(before, new)
    assert np.allclose(uphill, share.sum(axis=0))
