"""What every method keeps: the package's own, and a plain function as somebody else would write one.

A new method is one line more of `lightcube.solvers.METHODS`, and goes through all of this.
"""

import inspect
import io
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array

from lightcube.errors import InputError
from lightcube.optics.grid import Grid
from lightcube.optics.law import Mixture
from lightcube.optics.transfer import encode
from lightcube.optics.views import spread_angles, turntable_views
from lightcube.projection.projector import Projector
from lightcube.solvers import METHODS
from lightcube.solvers.contract import Floats, Lighting, Progress, Result, Solver, Wanted
from lightcube.solvers.method import Method
from tests.helpers.solver_problems import DenseOperator, full_rank, light, plain_descent, random_system

ALL: Mapping[str, Method] = {**METHODS, "plain": Method(plain_descent, "plain")}
#: Of which each iteration brings a bit.
ITERATIVE = [name for name, method in ALL.items() if method.passes is not None]
#: How near they come to a known cube, as a part of its darkest voxel, where they do not come to rounding; a cube's own
#: shadows come back to so many dB.
CLOSE, ENOUGH_DB = {"display": 0.03, "plain": 0.2}, {"plain": 40}
ROUNDING = {np.float32: 1e-3, np.float64: 1e-8}

every_method = pytest.mark.parametrize("name", ALL)
own_method = pytest.mark.parametrize("name", METHODS)
every_dtype = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def near(name: str, dtype: type[np.floating] = np.float64) -> float:
    return max(CLOSE.get(name, 0.0), ROUNDING[dtype])


def assert_near(name: str, found: Floats, x: Floats, dtype: type[np.floating] = np.float64) -> None:
    np.testing.assert_allclose(found, x, rtol=0, atol=near(name, dtype) * float(x.max()))


# ---- A known cube ----


@every_method
@every_dtype
@pytest.mark.parametrize("columns", [1, 6])
def test_full_rank_systems_are_solved_in_their_dtype(name: str, dtype: type[np.floating], columns: int) -> None:
    A, x, B = full_rank(columns, dtype)
    result = ALL[name].solve(A, Wanted(B), iterations=1000)
    assert result.x.dtype == dtype
    assert result.x.shape == x.shape
    assert_near(name, result.x, x, dtype)
    assert result.stop_reason == ("iterations" if name == "plain" else "converged")
    assert result.rejected.shape == (0, 2)
    assert result.residuals[-1] < (1e-3 if dtype == np.float32 or name in CLOSE else 1e-8)
    np.testing.assert_array_equal(result.lamp_powers, np.ones((1, 1)))


@every_method
def test_other_sizes_are_solved(name: str) -> None:
    rng = np.random.default_rng(7)
    matrix = random_system(rng, 33, 10)
    x = rng.uniform(0.05, 0.2, (10, 35))  # more columns than one block of the row actions
    result = ALL[name].solve(DenseOperator(matrix), Wanted(light(matrix, x)), iterations=1000)
    assert_near(name, result.x, x)


@every_method
@every_dtype
@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_a_cubes_own_shadows_come_back(name: str, dtype: type[np.floating], elevation_deg: float) -> None:
    """At least 60 dB in display values, in most methods; lamp powers differ between views and colours."""
    grid = Grid((2, 3, 5), 0.7)
    projector = Projector(
        grid, turntable_views(grid, spread_angles(9, elevation_deg=elevation_deg), elevation_deg=elevation_deg)
    )
    rng = np.random.default_rng(11)
    columns = 6 if elevation_deg == 0 else 3
    x = (rng.uniform(0, 0.8, (projector.shape[1], columns)) * (rng.random((projector.shape[1], 1)) < 0.6)).astype(dtype)
    powers = rng.uniform(0.5, 2.0, (9, 3))
    lamp = powers[projector.view_of_row][:, np.arange(columns) % 3]
    shown = (lamp * np.exp(-projector.forward(x))).astype(dtype)
    result = ALL[name].solve(projector, Wanted(shown, None, Lighting(np.arange(9)), (powers, powers)), iterations=150)
    found = lamp * np.exp(-projector.forward(result.x))
    psnr = -10 * np.log10(np.mean((encode(found) - encode(shown.astype(np.float64))) ** 2))
    assert psnr >= ENOUGH_DB.get(name, 60)


# ---- Where they start ----


@every_method
@every_dtype
def test_started_at_the_solution_they_stay_there(name: str, dtype: type[np.floating]) -> None:
    A, x, B = full_rank(3, dtype)
    result = ALL[name].solve(A, Wanted(B), x0=x.astype(dtype), iterations=20)
    np.testing.assert_allclose(result.x, x, atol=1e-5 if dtype == np.float32 else 1e-11)
    if name in METHODS and name in ITERATIVE:
        assert len(result.residuals) == 1
        assert result.stop_reason == "converged"


@pytest.mark.parametrize("name", ITERATIVE)
def test_the_start_is_used(name: str) -> None:
    A, x, B = full_rank(3)
    far, near = (ALL[name].solve(A, Wanted(B), x0=start, iterations=1).residuals[0] for start in (None, x + 1e-3))
    assert near < far / 10


@every_method
def test_what_is_given_is_not_written_to(name: str) -> None:
    A, x, B = full_rank(3)
    start, shown, weights = x + 0.1, B.copy(), np.ones(B.shape)
    ALL[name].solve(A, Wanted(B, weights), x0=start, iterations=3)
    np.testing.assert_array_equal(start, x + 0.1)
    np.testing.assert_array_equal(B, shown)
    np.testing.assert_array_equal(weights, 1)


# ---- Lamps, weights, columns, bounds ----


@every_method
def test_lamp_powers_count_per_view_and_channel(name: str) -> None:
    A, x, B = full_rank(6)
    powers = np.random.default_rng(1).uniform(0.5, 4.0, (11, 3))
    shown = B * np.repeat(powers, 7, axis=0)[:, [0, 1, 2, 0, 1, 2]]
    result = ALL[name].solve(A, Wanted(shown, None, Lighting(np.arange(11)), (powers, powers)), iterations=1000)
    assert_near(name, result.x, x)
    np.testing.assert_array_equal(result.lamp_powers, powers)


@every_method
def test_without_lamp_bounds_every_view_has_power_1(name: str) -> None:
    A, x, B = full_rank(3)
    result = ALL[name].solve(A, Wanted(B, lighting=Lighting(np.arange(11))), iterations=1000)
    assert_near(name, result.x, x)
    np.testing.assert_array_equal(result.lamp_powers, np.ones((11, 1)))


@own_method
def test_a_lamp_to_choose_is_chosen_within_its_bounds_or_refused(name: str) -> None:
    A, _, B = full_rank(3)
    wanted = Wanted(B, lamp_bounds=(np.full((1, 3), 0.5), np.full((1, 3), 4.0)))
    if METHODS[name].chooses_lamps:
        powers = METHODS[name].solve(A, wanted, iterations=5).lamp_powers
        assert np.all((powers >= 0.5) & (powers <= 4))
    else:
        with pytest.raises(InputError, match=f"method {name} cannot choose lamp powers"):
            METHODS[name].solve(A, wanted)


@own_method
def test_light_that_adds_up_is_taken_or_refused(name: str) -> None:
    mixture = Mixture(np.array([0, 2, 3]), np.ones((3, 2)), np.ones((3, 6)), np.full((3, 6), 0.5))
    wanted = Wanted(np.full((2 * 3, 4), 0.5), None, Lighting(np.arange(3), mixture), (np.ones((3, 2)), np.ones((3, 2))))
    A = DenseOperator(np.ones((3 * 3, 2)))
    if METHODS[name].takes_sums:
        assert METHODS[name].solve(A, wanted, iterations=1).x.shape == (2, 4)
    else:
        with pytest.raises(InputError, match=f"method {name} takes logarithms"):
            METHODS[name].solve(A, wanted)


@every_method
@pytest.mark.parametrize("per_column", [True, False])
def test_weight_0_is_no_equation(name: str, per_column: bool) -> None:
    A, x, B = full_rank(4)
    rng = np.random.default_rng(2)
    weights = (rng.random((77, 4 if per_column else 1)) > 0.2).astype(float)
    assert all(np.linalg.matrix_rank(A.matrix[column > 0]) == 15 for column in weights.T)
    spoilt = np.where(weights > 0, B, rng.uniform(0.001, 3.0, B.shape))
    result = ALL[name].solve(A, Wanted(spoilt, weights), iterations=2000)
    assert_near(name, result.x, x)
    assert result.rejected.shape == (0, 2)
    if result.undetermined is not None:
        assert not result.undetermined.any()


@every_method
def test_columns_do_not_feel_each_other(name: str) -> None:
    A, _, B = full_rank(5)
    B = B * np.random.default_rng(3).uniform(0.7, 1.4, B.shape)
    together = ALL[name].solve(A, Wanted(B), iterations=12)
    for column in (0, 3):
        alone = ALL[name].solve(A, Wanted(B[:, [column]]), iterations=12)
        np.testing.assert_allclose(together.x[:, [column]], alone.x, atol=1e-10)


@every_method
def test_bounds_are_kept(name: str) -> None:
    A, _, B = full_rank(5)
    B = B * np.random.default_rng(4).uniform(0.5, 2.0, B.shape)

    def look(progress: Progress) -> None:
        assert progress.x.min() >= 0.05
        assert progress.x.max() <= 0.25

    result = ALL[name].solve(A, Wanted(B), bounds=(0.05, 0.25), iterations=30, callback=look)
    look(Progress(0, 0, result.x, result.x, 0.0, result.lamp_powers, dict))
    assert result.x.min() == 0.05
    assert result.x.max() == 0.25


# ---- The callback ----


@every_method
@every_dtype
def test_the_callback_sees_what_is_reached(name: str, dtype: type[np.floating]) -> None:
    A, _, B = full_rank(3, dtype)
    B = (B * np.random.default_rng(5).uniform(0.8, 1.25, B.shape)).astype(dtype)
    seen: list[tuple[int, Floats, Floats]] = []
    residuals: list[float] = []

    def look(progress: Progress) -> None:
        seen.append((progress.iteration, progress.x.copy(), progress.absorbance.copy()))
        residuals.append(progress.residual)

    result = ALL[name].solve(A, Wanted(B), iterations=9, callback=look)
    assert residuals == result.residuals.tolist()
    for _, x, absorbance in seen:
        assert x.dtype == absorbance.dtype == dtype
        np.testing.assert_allclose(absorbance, A.forward(x), atol=1e-4 if dtype == np.float32 else 1e-11)
    if name in ITERATIVE:
        assert [iteration for iteration, _, _ in seen] == list(range(1, 10))
        assert result.stop_reason == "iterations"


@every_method
def test_the_callback_stops(name: str) -> None:
    A, _, B = full_rank(3)
    B = B * np.random.default_rng(6).uniform(0.5, 2.0, B.shape)
    result = ALL[name].solve(A, Wanted(B), callback=lambda progress: progress.iteration >= 2)
    assert result.stop_reason == "callback"
    assert len(result.residuals) == 2


# ---- Stopped and taken up again, to the last bit ----

ITERATIONS = 13
#: Method and whether it may choose the lamps.
CASES = [(name, False) for name in ALL] + [(name, True) for name, method in ALL.items() if method.chooses_lamps]
#: After which calls of the callback to stop. Method display renews its metric in iterations 1, 2, 4, 7, 11.
STOPS = [1, 3, 4, 5, 10, 11, 13]

every_case = pytest.mark.parametrize(("name", "free"), CASES)
Problem = tuple[Projector, Wanted]


def noisy(dtype: str, free: bool) -> Problem:
    """Pictures with much noise, so that bounds are met and equations rejected, but for two columns."""
    grid = Grid((2, 3, 5), 0.7)
    A = Projector(grid, turntable_views(grid, spread_angles(4)))
    rng = np.random.default_rng(5)
    powers = rng.uniform(0.8, 2.0, (4, 3))
    x = rng.uniform(0, 0.5, (A.shape[1], 6)) * (rng.random((A.shape[1], 6)) < 0.6)
    lamp = powers[A.view_of_row][:, np.arange(6) % 3]
    disturbed = np.exp(0.3 * rng.normal(size=lamp.shape) * (np.arange(6) > 1))
    weights = np.ones(lamp.shape)
    weights[3, 5] = 0
    shown = (lamp * np.exp(-A.forward(x)) * disturbed).astype(dtype)
    bounds = (powers / 2, powers * 2) if free else (powers, powers)
    return A, Wanted(shown, weights.astype(dtype), Lighting(np.arange(4)), bounds)


def white(dtype: str, free: bool) -> Problem:
    """Pictures of nothing but the lamps."""
    A, wanted = noisy(dtype, free)
    lamp = np.sqrt(np.prod(wanted.lamp_bounds, axis=0))[A.view_of_row][:, np.arange(6) % 3]
    return A, Wanted(lamp.astype(dtype), wanted.weights, wanted.lighting, wanted.lamp_bounds)


def added(dtype: str) -> Problem:
    """Two pictures of two views each; one lamp shines in both."""
    A, wanted = noisy(dtype, free=True)
    half = len(wanted.light) // 2
    falling, shadow = np.random.default_rng(6).uniform(0.3, 1, (2, 4, half)).astype(dtype)
    lighting = Lighting(np.array([0, 1, 0, 2]), Mixture(np.array([0, 2, 4]), np.ones((4, 3)), falling, shadow))
    low, high = (bound[:3] for bound in wanted.lamp_bounds)
    return A, Wanted(wanted.light[:half] + wanted.light[half:], wanted.weights[:half], lighting, (low, high))


def solved(name: str, problem: Problem, **given: Any) -> Result:
    return ALL[name].solve(*problem, **{"iterations": ITERATIONS, "x0": np.full((15, 6), 0.05), **given})


def loaded(state: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """What a file of plain arrays gives back."""
    file = io.BytesIO()
    np.savez(file, **state)
    file.seek(0)
    with np.load(file, allow_pickle=False) as arrays:
        return dict(arrays)


def state_after(name: str, calls: int, problem: Problem, **given: Any) -> tuple[dict[str, np.ndarray], Result]:
    """Stop in that call of the callback: the state there, and what the stopped solver returned."""
    states: list[dict[str, np.ndarray]] = []

    def stop(progress: Progress) -> bool:
        states.append(loaded(progress.state()))
        return len(states) == calls

    result = solved(name, problem, **given, callback=stop)
    return states[-1], result


@cache
def whole(name: str, free: bool, dtype: str) -> Result:
    return solved(name, noisy(dtype, free))


def assert_identical(one: Result, other: Result) -> None:
    for field in ("x", "lamp_powers", "residuals", "rejected", "undetermined"):
        np.testing.assert_array_equal(getattr(one, field), getattr(other, field), strict=True)
    assert (one.stop_reason, one.lower_bound) == (other.stop_reason, other.lower_bound)


@every_case
@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("calls", STOPS)
def test_going_on_ends_as_if_it_had_never_stopped(name: str, free: bool, dtype: str, calls: int) -> None:
    problem, expected = noisy(dtype, free), whole(name, free, dtype)
    state, stopped = state_after(name, calls, problem)
    np.testing.assert_array_equal(state["history"], expected.residuals[:calls])
    if calls < len(expected.residuals):
        assert stopped.stop_reason == "callback"
        assert not np.array_equal(stopped.x, expected.x)
    before = {key: array.copy() for key, array in state.items()}
    assert_identical(solved(name, problem, state={**state, "something else": np.zeros(3)}, x0=None), expected)
    for key, array in state.items():
        np.testing.assert_array_equal(array, before[key])


@pytest.mark.parametrize("name", [name for name, method in ALL.items() if method.takes_sums])
@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("calls", STOPS[::2])
def test_sums_of_views_go_on_as_if_they_had_never_stopped(name: str, dtype: str, calls: int) -> None:
    problem = added(dtype)
    expected = solved(name, problem, x0=None)
    state, stopped = state_after(name, calls, problem, x0=None)
    np.testing.assert_array_equal(state["history"], expected.residuals[:calls])
    assert calls == ITERATIONS or not np.array_equal(stopped.x, expected.x)
    assert_identical(solved(name, problem, state=state, x0=None), expected)


@every_case
def test_one_stop_after_another_changes_nothing(name: str, free: bool) -> None:
    problem = noisy("float32", free)
    state: dict[str, np.ndarray] | None = None
    for _ in range(4):
        state, _ = state_after(name, 1, problem, state=state)
    assert_identical(solved(name, problem, state=state), whole(name, free, "float32"))


@every_case
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_a_state_of_the_last_iteration_is_the_end(name: str, free: bool, dtype: str) -> None:
    """Also where it is the last because the method has converged: nothing is left to do."""
    cases: list[tuple[Problem, dict[str, Any], str]] = [
        (noisy(dtype, free), {"iterations": 2, "x0": None}, "iterations" if name in ITERATIVE else "converged"),
        (white(dtype, free), {"x0": None}, "converged" if name in METHODS else "iterations"),
    ]
    for problem, options, reason in cases:
        state, expected = state_after(name, -1, problem, **options)
        assert expected.stop_reason == reason

        def never(progress: Progress) -> None:
            raise AssertionError(f"iteration {progress.iteration} was done again")

        assert_identical(solved(name, problem, **options, state=state, callback=never), expected)


@every_case
def test_a_state_that_does_not_fit_is_refused_with_a_sentence(name: str, free: bool) -> None:
    if name not in METHODS:
        pytest.skip("a function of somebody else need not look")
    problem = noisy("float32", free)
    state, _ = state_after(name, 3, problem)
    for key, array in state.items():
        lacking = {other: kept for other, kept in state.items() if other != key}
        with pytest.raises(InputError, match=f"the state to continue from lacks '{key}': it is another method's"):
            solved(name, problem, state=lacking)
        for wrong in (array[None], array.astype(np.int16)):
            with pytest.raises(InputError, match=rf"has '{key}' as {wrong.dtype} of shape .*: it is another problem's"):
                solved(name, problem, state={**state, key: wrong})
    if name in ITERATIVE:
        with pytest.raises(InputError, match="is that after 3 iterations, but this is to be a run of 2"):
            solved(name, problem, iterations=2, state=state)
    with pytest.raises(InputError, match="is that after 0 iterations"):
        solved(name, problem, state={**state, "history": np.empty(0)})


# ---- Bad input; what is wrong with what is wanted `Wanted` says itself ----


@own_method
@pytest.mark.parametrize(
    ("match", "changes"),
    [
        ("is of 76 equations, but the matrix is of shape", {"wanted": Wanted(np.ones((76, 2)))}),
        ("x0 must be finite numbers of shape", {"x0": np.ones((15, 1))}),
        ("x0 must be finite numbers of shape", {"x0": np.full((15, 2), np.inf)}),
        ("bounds must be", {"bounds": (1.0, 0.0)}),
        ("bounds must be", {"bounds": (0.0, np.nan)}),
        ("bounds must be", {"bounds": (np.inf, np.inf)}),
        ("iterations must be at least 1", {"iterations": 0}),
        ("iterations must be a whole number", {"iterations": 2.5}),
    ],
)
def test_bad_input_is_refused_with_a_sentence(name: str, match: str, changes: dict[str, Any]) -> None:
    A, _, B = full_rank(2)
    with pytest.raises(InputError, match=match):
        METHODS[name].solve(A, **{"wanted": Wanted(B), **changes})


@settings(max_examples=25)
@given(
    name=st.sampled_from(list(METHODS)),
    shape=st.tuples(st.integers(0, 16), st.integers(0, 3)).filter(lambda shape: shape != (15, 2)),
)
def test_starts_of_any_other_shape_are_refused(name: str, shape: tuple[int, int]) -> None:
    A, _, B = full_rank(2)
    with pytest.raises(InputError, match="x0 must be"):
        METHODS[name].solve(A, Wanted(B), x0=np.ones(shape))


# ---- What is said of a method is true ----


@every_method
def test_every_method_has_the_one_signature(name: str) -> None:
    """The names of the parameters, their order and what they default to; iterations to what is said of the method."""
    expected = dict(list(inspect.signature(Solver.__call__).parameters.items())[1:])
    expected["iterations"] = expected["iterations"].replace(default=ALL[name].passes or 100)
    solve = ALL[name].solve
    got = inspect.signature(getattr(solve, "loaded", solve)).parameters
    assert [(p.name, p.kind, p.default) for p in got.values()] == [
        (p.name, p.kind, p.default) for p in expected.values()
    ]
    assert ALL[name].name == name


@every_method
def test_figures_of_columns_add_up_as_is_said(name: str) -> None:
    A, _, B = full_rank(2)
    B = B * np.random.default_rng(12).uniform(0.9, 1.1, B.shape)
    figures = [ALL[name].solve(A, Wanted(part), iterations=1).residuals for part in (B, B[:, :1], B[:, 1:])]
    whole, first, second = (float(each[-1]) for each in figures)
    assert whole == pytest.approx(np.hypot(first, second) if ALL[name].residual == "norm" else first + second)


@every_method
def test_the_sparse_matrix_is_asked_for_where_it_is_said(name: str) -> None:
    A, _, B = full_rank(2)
    asked: list[str] = []

    class Telling(DenseOperator):
        def to_sparse(self) -> csr_array:
            asked.append(name)
            return super().to_sparse()

    ALL[name].solve(Telling(A.matrix), Wanted(B), iterations=1)
    assert bool(asked) == ALL[name].holds_matrix
