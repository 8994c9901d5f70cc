"""Stopped and taken up again, every method ends where it would have ended, to the last bit."""

import io
import tracemalloc
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest
from numba import config
from scipy.sparse import csr_array

from lightcube.errors import InputError
from lightcube.kernels import convex, descent, display, momentum
from lightcube.optics.grid import Grid
from lightcube.optics.views import spread_angles, turntable_views
from lightcube.projection.projector import Projector
from lightcube.solvers import METHODS
from lightcube.solvers.contract import Floats, Mixture, Progress, Result
from lightcube.solvers.display import display_values

ITERATIONS = 13
#: Method and whether it may choose the lamps.
CASES = [(name, False) for name in METHODS] + [("display", True)]
#: After which calls of the callback to stop. Method display renews its metric in iterations 1, 2, 4, 7, 11.
STOPS = [1, 3, 4, 5, 10, 11, 13]

every_case = pytest.mark.parametrize(("name", "free"), CASES)
every_dtype = pytest.mark.parametrize("dtype", ["float32", "float64"])


def arguments(dtype: str, free: bool) -> dict[str, Any]:
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
    return {
        "A": A,
        "B": (lamp * np.exp(-A.forward(x)) * disturbed).astype(dtype),
        "weights": weights.astype(dtype),
        "view_of_row": A.view_of_row,
        "lamp_bounds": (powers / 2, powers * 2) if free else (powers, powers),
        "iterations": ITERATIONS,
    }


def solve(name: str, **changes: Any) -> Result:
    return METHODS[name](changes.pop("A"), changes.pop("B"), **changes)


def loaded(state: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """What a file of plain arrays gives back."""
    file = io.BytesIO()
    np.savez(file, **state)
    file.seek(0)
    with np.load(file, allow_pickle=False) as arrays:
        return dict(arrays)


def state_after(name: str, calls: int, **problem: Any) -> tuple[dict[str, np.ndarray], Result]:
    """Stop in that call of the callback: the state there, and what the stopped solver returned."""
    states: list[dict[str, np.ndarray]] = []

    def stop(progress: Progress) -> bool:
        states.append(loaded(progress.state()))
        return len(states) == calls

    result = solve(name, **problem, callback=stop)
    return states[-1], result


@cache
def whole(name: str, free: bool, dtype: str) -> Result:
    problem = arguments(dtype, free)
    return solve(name, **problem, x0=np.full((15, 6), 0.05))


def assert_identical(one: Result, other: Result) -> None:
    for field in ("x", "lamp_powers", "residuals", "rejected", "undetermined"):
        np.testing.assert_array_equal(getattr(one, field), getattr(other, field), strict=True)
    assert (one.stop_reason, one.lower_bound) == (other.stop_reason, other.lower_bound)


@every_case
@every_dtype
@pytest.mark.parametrize("calls", STOPS)
def test_going_on_ends_as_if_it_had_never_stopped(name: str, free: bool, dtype: str, calls: int) -> None:
    problem = arguments(dtype, free)
    expected = whole(name, free, dtype)
    state, stopped = state_after(name, calls, **problem, x0=np.full((15, 6), 0.05))
    np.testing.assert_array_equal(state["history"], expected.residuals[:calls])
    if calls < len(expected.residuals):
        assert stopped.stop_reason == "callback"
        assert not np.array_equal(stopped.x, expected.x)
    before = {key: array.copy() for key, array in state.items()}
    assert_identical(solve(name, **problem, state={**state, "something else": np.zeros(3)}), expected)
    for key, array in state.items():
        np.testing.assert_array_equal(array, before[key])


@every_dtype
@pytest.mark.parametrize("calls", STOPS[::2])
def test_sums_of_views_go_on_as_if_they_had_never_stopped(dtype: str, calls: int) -> None:
    """Two pictures of two views each; one lamp shines in both."""
    problem = arguments(dtype, free=True)
    half = len(problem["B"]) // 2
    light, shadow = np.random.default_rng(6).uniform(0.3, 1, (2, 4, half)).astype(dtype)
    low, high = (bound[:3] for bound in problem["lamp_bounds"])
    problem |= {
        "B": problem["B"][:half] + problem["B"][half:],
        "weights": problem["weights"][:half],
        "view_of_row": None,
        "lamp_bounds": (low, high),
        "mixture": Mixture(np.array([0, 2, 4]), np.array([0, 1, 0, 2]), np.ones((4, 3)), light, shadow),
    }
    expected = solve("display", **problem)
    state, stopped = state_after("display", calls, **problem)
    np.testing.assert_array_equal(state["history"], expected.residuals[:calls])
    assert calls == ITERATIONS or not np.array_equal(stopped.x, expected.x)
    assert_identical(solve("display", **problem, state=state), expected)


@every_case
def test_one_stop_after_another_changes_nothing(name: str, free: bool) -> None:
    problem = arguments("float32", free)
    state: dict[str, np.ndarray] | None = None
    for _ in range(4):
        state, _ = state_after(name, 1, **problem, state=state, x0=np.full((15, 6), 0.05))
    assert_identical(solve(name, **problem, state=state), whole(name, free, "float32"))


@every_case
@every_dtype
def test_a_state_of_the_last_iteration_is_the_end(name: str, free: bool, dtype: str) -> None:
    """Also where it is the last because the method has converged: nothing is left to do."""
    hard = arguments(dtype, free)
    low, high = hard["lamp_bounds"]
    white = np.sqrt(low * high)[hard["view_of_row"]][:, np.arange(6) % 3].astype(dtype)
    for problem, reason in ((hard | {"iterations": 2}, "iterations"), (hard | {"B": white}, "converged")):
        state, expected = state_after(name, -1, **problem)
        assert expected.stop_reason == ("converged" if name == "row-reduction" else reason)

        def never(progress: Progress) -> None:
            raise AssertionError(f"iteration {progress.iteration} was done again")

        assert_identical(solve(name, **problem, state=state, callback=never), expected)


@every_case
def test_a_state_that_does_not_fit_is_refused_with_a_sentence(name: str, free: bool) -> None:
    problem = arguments("float32", free)
    state, _ = state_after(name, 3, **problem)
    for key, array in state.items():
        lacking = {other: kept for other, kept in state.items() if other != key}
        with pytest.raises(InputError, match=f"the state to continue from lacks '{key}': it is another method's"):
            solve(name, **problem, state=lacking)
        for wrong in (array[None], array.astype(np.int16)):
            with pytest.raises(InputError, match=rf"has '{key}' as {wrong.dtype} of shape .*: it is another problem's"):
                solve(name, **problem, state={**state, key: wrong})
    if name != "row-reduction":  # of which iterations do not count
        with pytest.raises(InputError, match="is that after 3 iterations, but this is to be a run of 2"):
            solve(name, **problem | {"iterations": 2}, state=state)
    with pytest.raises(InputError, match="is that after 0 iterations"):
        solve(name, **problem, state={**state, "history": np.empty(0)})


def test_momentum_is_what_its_formulas_say() -> None:
    """One walk through memory against one line of numpy for each quantity; slopes may take the absorbance's place."""
    random = np.random.default_rng(12)
    last, now, wanted = (random.normal(size=(70, 4)) for _ in range(3))
    weights = np.broadcast_to(random.random((70, 1)), (70, 4))
    lamp, views = random.normal(size=(3, 2)), random.integers(0, 3, 70)
    u = lamp[views][:, np.arange(4) % 2] - now
    curve = display.curve(True, np.float64)
    pairs = [display.residual(float(a), float(b), curve) for a, b in zip(u.ravel(), wanted.ravel(), strict=True)]
    value, slope = np.array(pairs).T.reshape(2, 70, 4)
    objective, least = convex.arrive(last, now, lamp, views, wanted, weights, curve)
    np.testing.assert_allclose(objective, np.sum(0.5 * weights * value**2, axis=0))
    np.testing.assert_allclose(least, np.min(2 * now - last, axis=0))

    slopes = now.copy()
    convex.descend(slopes, lamp, views, wanted, weights, curve, slopes)
    np.testing.assert_allclose(slopes, -weights * value * slope)

    ahead = np.array([0.0, 1.0, 0.5, 1.0])
    expected = now + ahead * (now - last)
    momentum.run_ahead(last, now, ahead)
    np.testing.assert_allclose(last, expected)


def test_the_metric_is_what_its_formulas_say() -> None:
    random = np.random.default_rng(3)
    x = random.normal(size=(70, 3)) * (1, 1, 0)
    expected = np.empty_like(x)
    descent.expect(x, 0.5, expected)
    np.testing.assert_allclose(expected[:, :2], np.abs(x[:, :2]) + 0.5 * np.mean(np.abs(x[:, :2]), axis=0))
    assert np.all(expected[:, 2] == 1)

    metric = random.random((70, 3)) - 0.5
    quotients = metric.copy()
    descent.divide(expected, quotients)
    np.testing.assert_allclose(quotients, np.where(metric > 0, expected / metric, 0))


def test_weights_are_the_same_in_whatever_memory() -> None:
    problem = arguments("float32", True)
    by_row = np.linspace(0, 1, len(problem["B"]), dtype=np.float32)[:, None]
    strided = np.repeat(by_row, 12, axis=1)[:, ::2]
    one, other = (display_values(**problem | {"weights": weights}) for weights in (by_row, strided))
    assert_identical(one, other)


class Repeats:
    """Beams that see one voxel each, over and over, or fewer beams than voxels: products that take no room."""

    def __init__(self, equations: int, unknowns: int) -> None:
        self.shape = (equations, unknowns)

    def forward(self, x: Floats) -> Floats:
        return x[np.arange(self.shape[0]) % len(x)]

    def adjoint(self, b: Floats) -> Floats:
        x = np.zeros((self.shape[1], b.shape[1]), b.dtype)
        for row in range(0, len(b), len(x)):
            part = b[row : row + len(x)]
            x[: len(part)] += part
        return x

    def to_sparse(self) -> csr_array:
        raise NotImplementedError


def solve_through(A: Repeats) -> None:
    B = np.random.default_rng(6).uniform(0.1, 0.9, (A.shape[0], 40)).astype(np.float32)
    lamps = (np.full((3, 2), 0.5), np.full((3, 2), 2.0))
    views = np.arange(len(B)) % 3
    display_values(A, B, weights=np.ones((1, 1), np.float32), view_of_row=views, lamp_bounds=lamps, iterations=4)


def peak(equations: int, unknowns: int) -> int:
    """Most bytes in use while method display solves, those of what it solves included."""
    tracemalloc.start()
    solve_through(Repeats(equations, unknowns))
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return most


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="large arrays")  # type: ignore[attr-defined]
@pytest.mark.parametrize(("smaller", "larger"), [((9000, 600), (18000, 600)), ((600, 9000), (600, 18000))])
def test_display_holds_no_more_than_four_arrays_of_either_size(
    smaller: tuple[int, int], larger: tuple[int, int]
) -> None:
    """Beside B; what is predicted of its memory rests on this."""
    solve_through(Repeats(30, 20))  # compile
    counted = (peak(*larger) - peak(*smaller)) / (9000 * 40 * 4)
    assert counted < (5.5 if larger[0] > larger[1] else 4.5)
