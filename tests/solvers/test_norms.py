"""The norms that sirt and cgls state, against generic solvers on inconsistent systems."""

import numpy as np
import pytest
from numba import config
from scipy.optimize import lsq_linear, nnls

from lightcube.solvers._checks import linear_problem
from lightcube.solvers._momentum import run_ahead
from lightcube.solvers.cgls import cgls
from lightcube.solvers.contract import Progress, Solver, Wanted
from lightcube.solvers.sirt import sirt
from tests.helpers.solver_problems import DenseOperator, projections, random_system

FREE = (-np.inf, np.inf)
SOLVERS: dict[str, Solver] = {"sirt": sirt, "cgls": cgls}
MATRICES = {
    "grid 3 x 5": projections((3, 5), 11, 7),
    "grid 7 x 4": projections((7, 4), 13, 9),
    "random 41 x 12": random_system(np.random.default_rng(0), 41, 12),
}

both = pytest.mark.parametrize("name", SOLVERS)
every_matrix = pytest.mark.parametrize("matrix", MATRICES.values(), ids=MATRICES)


def squared_weights(name: str, matrix: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """What each squared residual is multiplied by in the norm that the method states, ``(equations, columns)``."""
    if name == "cgls":
        return weights
    sums = matrix.sum(axis=1)[:, None]
    return np.asarray(weights * np.divide(1, sums, out=np.zeros_like(sums), where=sums > 0))


def inconsistent(matrix: np.ndarray, columns: int, dtype: type[np.floating] = np.float64) -> np.ndarray:
    """Pictures of a cube, half of it empty, with much noise: about as many voxels at 0 as above it."""
    rng = np.random.default_rng(1)
    x = rng.uniform(0.2, 2.0, (matrix.shape[1], columns)) / matrix.sum(axis=1).max()
    x[rng.random(x.shape) < 0.5] = 0
    return np.asarray(np.exp(-matrix @ x + 0.3 * rng.normal(size=(len(matrix), columns))).astype(dtype))


def some_weights(shape: tuple[int, int]) -> np.ndarray:
    rng = np.random.default_rng(2)
    return rng.uniform(0.1, 3.0, shape) * (rng.random(shape) < 0.9)


def scaled(
    name: str, matrix: np.ndarray, shown: np.ndarray, weights: np.ndarray, column: int
) -> tuple[np.ndarray, ...]:
    """The matrix and the right-hand side whose plain 2-norm is the one that the method states."""
    root = np.sqrt(squared_weights(name, matrix, weights)[:, column])
    return matrix * root[:, None], -np.log(shown[:, column]) * root


@both
@every_matrix
@pytest.mark.parametrize("weighted", [False, True])
def test_without_bounds_they_are_lstsq(name: str, matrix: np.ndarray, weighted: bool) -> None:
    B = inconsistent(matrix, 3)
    weights = some_weights(B.shape) if weighted else np.ones(B.shape)
    result = SOLVERS[name](
        DenseOperator(matrix), Wanted(B, weights=weights if weighted else None), bounds=FREE, iterations=5000
    )
    assert result.stop_reason == "converged"
    for column in range(3):
        a, b = scaled(name, matrix, B, weights, column)
        np.testing.assert_allclose(result.x[:, column], np.linalg.lstsq(a, b)[0], atol=1e-8)
    assert result.x.min() < -1e-3


@both
@every_matrix
@pytest.mark.parametrize("weighted", [False, True])
def test_above_0_they_are_nnls(name: str, matrix: np.ndarray, weighted: bool) -> None:
    B = inconsistent(matrix, 3)
    weights = some_weights(B.shape) if weighted else np.ones(B.shape)
    result = SOLVERS[name](DenseOperator(matrix), Wanted(B, weights=weights if weighted else None), iterations=5000)
    assert result.stop_reason == "converged"
    at_bound = 0
    for column in range(3):
        wanted, norm = nnls(*scaled(name, matrix, B, weights, column))
        np.testing.assert_allclose(result.x[:, column], wanted, atol=1e-8)
        assert norm > 0.1
        at_bound += int(np.sum(wanted == 0))
    assert 0 < at_bound < result.x.size


@both
@every_matrix
def test_between_bounds_they_are_lsq_linear(name: str, matrix: np.ndarray) -> None:
    B = inconsistent(matrix, 3)
    weights, bounds = some_weights(B.shape), (0.02, 0.15)
    result = SOLVERS[name](DenseOperator(matrix), Wanted(B, weights=weights), bounds=bounds, iterations=5000)
    assert result.stop_reason == "converged"
    for column in range(3):
        a, b = scaled(name, matrix, B, weights, column)
        np.testing.assert_allclose(result.x[:, column], lsq_linear(a, b, bounds, method="bvls").x, atol=1e-8)
    for bound in bounds:
        assert np.any(result.x == bound)


@both
@pytest.mark.parametrize("bounds", [FREE, (0.0, np.inf), (0.02, 0.15)])
def test_float32_comes_as_close_as_it_can(name: str, bounds: tuple[float, float]) -> None:
    matrix = MATRICES["random 41 x 12"]
    B = inconsistent(matrix, 3, np.float32)
    result = SOLVERS[name](DenseOperator(matrix), Wanted(B), bounds=bounds, iterations=5000)
    assert result.x.dtype == np.float32
    assert result.stop_reason == "converged"
    exact = SOLVERS[name](DenseOperator(matrix), Wanted(B.astype(np.float64)), bounds=bounds, iterations=5000)
    np.testing.assert_allclose(result.x, exact.x, atol=1e-4)


@both
@pytest.mark.parametrize("bounds", [FREE, (0.0, np.inf), (0.02, 0.15)])
def test_started_at_the_minimum_they_stay_there(name: str, bounds: tuple[float, float]) -> None:
    matrix = MATRICES["grid 7 x 4"]
    B = inconsistent(matrix, 3)
    there = SOLVERS[name](DenseOperator(matrix), Wanted(B), bounds=bounds, iterations=5000).x
    result = SOLVERS[name](DenseOperator(matrix), Wanted(B), x0=there, bounds=bounds, iterations=50)
    np.testing.assert_allclose(result.x, there, atol=1e-10)
    assert len(result.residuals) <= 2


@both
@pytest.mark.parametrize("bounds", [FREE, (0.0, np.inf), (0.02, 0.15)])
def test_residuals_are_the_stated_norm(name: str, bounds: tuple[float, float]) -> None:
    matrix = MATRICES["grid 3 x 5"]
    B, start = inconsistent(matrix, 3), np.full((15, 3), 0.1)
    weights = some_weights(B.shape)
    norms: list[float] = []
    factors = squared_weights(name, matrix, weights)

    def look(progress: Progress) -> None:
        norms.append(float(np.sqrt(np.sum(factors * (np.log(B) + matrix @ progress.x) ** 2))))

    result = SOLVERS[name](
        DenseOperator(matrix), Wanted(B, weights=weights), x0=start, bounds=bounds, iterations=25, callback=look
    )
    np.testing.assert_allclose(result.residuals, norms, rtol=1e-10)


@pytest.mark.parametrize("bounds", [FREE, (0.0, np.inf), (0.02, 0.15)])
@every_matrix
def test_cgls_never_goes_uphill(matrix: np.ndarray, bounds: tuple[float, float]) -> None:
    B = inconsistent(matrix, 1)
    start = np.random.default_rng(3).uniform(0, 0.5, (matrix.shape[1], 1))
    result = cgls(DenseOperator(matrix), Wanted(B), x0=start, bounds=bounds, iterations=200)
    assert np.all(np.diff(result.residuals) <= 1e-12)
    assert result.residuals[-1] < result.residuals[0]


@pytest.mark.parametrize("seed", range(6))
def test_cgls_never_goes_uphill_where_clipping_would(seed: int) -> None:
    """Dense columns and far too much shadow: a whole step, clipped, often ends higher than it began."""
    rng = np.random.default_rng(seed)
    matrix, B = rng.uniform(0, 1, (6, 4)), np.exp(-rng.uniform(0, 1, (6, 1)))
    result = cgls(DenseOperator(matrix), Wanted(B), x0=rng.uniform(0, 1, (4, 1)), bounds=(0.0, 1.0), iterations=50)
    assert np.all(np.diff(result.residuals) <= 1e-12)
    wanted = lsq_linear(matrix, -np.log(B[:, 0]), (0.0, 1.0), method="bvls").x
    np.testing.assert_allclose(result.x[:, 0], wanted, atol=1e-9)


def test_cgls_without_bounds_is_cgls() -> None:
    """The textbook's loop on one column, iterate by iterate."""
    matrix = MATRICES["grid 7 x 4"]
    B = inconsistent(matrix, 1)
    seen: list[np.ndarray] = []
    cgls(DenseOperator(matrix), Wanted(B), bounds=FREE, iterations=8, callback=lambda p: seen.append(p.x[:, 0].copy()))

    x, r = np.zeros(matrix.shape[1]), -np.log(B[:, 0])
    s = matrix.T @ r
    p, gamma = s, s @ s
    for iterate in seen:
        q = matrix @ p
        alpha = gamma / (q @ q)
        x, r = x + alpha * p, r - alpha * q
        s = matrix.T @ r
        p, gamma = s + (s @ s) / gamma * p, s @ s
        np.testing.assert_allclose(iterate, x, atol=1e-10)


def test_the_first_step_of_sirt_is_sirt() -> None:
    matrix = MATRICES["grid 7 x 4"]
    B, start = inconsistent(matrix, 2), np.full((28, 2), 0.05)
    weights = some_weights(B.shape)
    result = sirt(DenseOperator(matrix), Wanted(B, weights=weights), x0=start, bounds=FREE, iterations=1)
    sums = matrix.sum(axis=1)
    R = np.divide(1, sums, out=np.zeros_like(sums), where=sums > 0)
    for column in range(2):
        W = weights[:, column]
        C = 1 / (matrix.T @ W)
        step = C * (matrix.T @ (R * W * (-np.log(B[:, column]) - matrix @ start[:, column])))
        np.testing.assert_allclose(result.x[:, column], start[:, column] + step, atol=1e-13)


def test_sirt_runs_ahead_as_nesterov_says() -> None:
    """The textbook's accelerated projected gradient on one column, iterate by iterate, before any restart."""
    matrix = projections((3, 5), 4, 7)
    B = inconsistent(matrix, 1)
    seen: list[np.ndarray] = []
    sirt(DenseOperator(matrix), Wanted(B), iterations=6, callback=lambda p: seen.append(p.x[:, 0].copy()))

    R, C = 1 / np.maximum(matrix.sum(axis=1), 1e-9), 1 / matrix.sum(axis=0)
    x = y = np.zeros(15)
    t = 1.0
    for iterate in seen:
        before, x = x, np.maximum(y + C * (matrix.T @ (R * (-np.log(B[:, 0]) - matrix @ y))), 0)
        np.testing.assert_allclose(iterate, x, atol=1e-12)
        t, t_before = (1 + np.sqrt(1 + 4 * t * t)) / 2, t
        y = x + (t_before - 1) / t * (x - before)


@pytest.mark.parametrize(("name", "scale"), [("sirt", True), ("cgls", False)])
def test_where_many_are_least_they_find_the_stated_one(name: str, scale: bool) -> None:
    """One view less than needed: of all minimisers, the one that the docstring names."""
    matrix = projections((3, 5), 3, 7)
    B = inconsistent(matrix, 2)
    assert np.linalg.matrix_rank(matrix) < 15
    result = SOLVERS[name](DenseOperator(matrix), Wanted(B), bounds=FREE, iterations=5000)
    C = 1 / matrix.sum(axis=0) if scale else np.ones(15)
    for column in range(2):
        a, b = scaled(name, matrix, B, np.ones(B.shape), column)
        least = np.sqrt(C) * (np.linalg.pinv(a * np.sqrt(C)) @ b)
        np.testing.assert_allclose(result.x[:, column], least, atol=1e-7)


@both
def test_voxels_that_no_weighted_beam_meets_keep_their_start(name: str) -> None:
    matrix = MATRICES["grid 3 x 5"].copy()
    matrix[:, 4] = 0
    B = inconsistent(matrix, 2)
    weights = np.ones(B.shape)
    weights[matrix[:, 7] > 0, 1] = 0
    result = SOLVERS[name](DenseOperator(matrix), Wanted(B, weights=weights), x0=np.full((15, 2), 0.07), iterations=500)
    np.testing.assert_array_equal(result.x[4], [0.07, 0.07])
    assert result.x[7, 1] == 0.07
    assert result.x[7, 0] != 0.07


@both
def test_black_and_white_columns_do_not_spoil_the_others(name: str) -> None:
    """A column that starts at its solution, one whose lamp is the picture, and an ordinary one."""
    matrix = MATRICES["grid 3 x 5"]
    B = inconsistent(matrix, 3)
    B[:, 1] = 1
    start = np.zeros((15, 3))
    start[:, 0] = SOLVERS[name](DenseOperator(matrix), Wanted(B[:, :1]), iterations=5000).x[:, 0]
    result = SOLVERS[name](DenseOperator(matrix), Wanted(B), x0=start, iterations=5000)
    assert result.stop_reason == "converged"
    np.testing.assert_allclose(result.x[:, 0], start[:, 0], atol=1e-9)
    if name == "cgls":
        np.testing.assert_array_equal(result.x[:, 0], start[:, 0])  # it rests
    np.testing.assert_array_equal(result.x[:, 1], 0)
    np.testing.assert_allclose(result.x[:, 2], nnls(*scaled(name, matrix, B, np.ones(B.shape), 2))[0], atol=1e-8)


@both
def test_a_larger_cube_matches_nnls(name: str) -> None:
    size = 5 if config.DISABLE_JIT else 11  # type: ignore[attr-defined]
    matrix = projections((size, size + 2), 3 * size, size + 6)
    B = inconsistent(matrix, 2)
    result = SOLVERS[name](DenseOperator(matrix), Wanted(B), iterations=3000)
    for column in range(2):
        wanted = nnls(*scaled(name, matrix, B, np.ones(B.shape), column))[0]
        np.testing.assert_allclose(result.x[:, column], wanted, atol=1e-6)


def test_momentum_runs_further_ahead_until_it_restarts() -> None:
    momentum, ahead = np.ones(2), np.zeros(2)
    before = -1.0
    for _ in range(5):
        ahead, momentum = run_ahead(momentum, np.array([False, True]))
        assert before < ahead[0] < 1
        assert ahead[1] == 0
        assert momentum[1] == 1
        before = ahead[0]


def test_a_problem_owns_its_start_and_keeps_it_within_bounds() -> None:
    A, start = DenseOperator(np.ones((2, 3))), np.array([[-1.0], [0.2], [9.0]])
    problem = linear_problem("sirt", A, Wanted(np.full((2, 1), 0.5)), start, (0.0, 1.0))
    np.testing.assert_array_equal(problem.x, [[0], [0.2], [1]])
    assert not np.shares_memory(problem.x, start)
