"""What all methods on logarithms keep, and what the paper's two do with false equations and undetermined voxels."""

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import config

from lightcube.errors import InputError
from lightcube.kernels.row_action import BLOCK, sweep
from lightcube.optics.grid import Grid
from lightcube.optics.transfer import encode
from lightcube.optics.views import spread_angles, turntable_views
from lightcube.projection.projector import Projector
from lightcube.solvers._absorbance import half_level
from lightcube.solvers.cgls import cgls
from lightcube.solvers.contract import Progress, Result, Solver
from lightcube.solvers.gauss_seidel import gauss_seidel
from lightcube.solvers.row_reduction import LARGEST, row_reduction
from lightcube.solvers.sirt import sirt
from tests.helpers.solver_problems import DenseOperator, light, projections, random_system

SOLVERS: dict[str, Solver] = {
    "row-reduction": row_reduction,
    "gauss-seidel": gauss_seidel,
    "sirt": sirt,
    "cgls": cgls,
}
ITERATIVE = [name for name in SOLVERS if name != "row-reduction"]
PAPERS = ["row-reduction", "gauss-seidel"]
#: Relative to the largest number of the solution.
CLOSE = {np.float32: 1e-3, np.float64: 1e-8}

every_solver = pytest.mark.parametrize("name", SOLVERS)
every_dtype = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def problem(
    columns: int, dtype: type[np.floating] = np.float64, seed: int = 0
) -> tuple[DenseOperator, np.ndarray, np.ndarray]:
    """A grid of 3 x 5 seen in 11 views of 7 beams, full rank: the matrix, a cube and its shadows."""
    matrix = projections((3, 5), 11, 7)
    assert np.linalg.matrix_rank(matrix) == 15
    x = np.random.default_rng(seed).uniform(0.1, 1.0, (15, columns)) / 3
    return DenseOperator(matrix), x, light(matrix, x, dtype)


def pairs(mask: np.ndarray) -> list[list[int]]:
    return np.argwhere(mask).tolist()


@every_solver
@every_dtype
@pytest.mark.parametrize("columns", [1, 6])
def test_full_rank_systems_are_solved(name: str, dtype: type[np.floating], columns: int) -> None:
    A, x, B = problem(columns, dtype)
    result = SOLVERS[name](A, B, iterations=1000)
    assert result.x.dtype == dtype
    assert result.x.shape == x.shape
    np.testing.assert_allclose(result.x, x, rtol=0, atol=CLOSE[dtype] * x.max())
    assert result.stop_reason == "converged"
    assert result.rejected.shape == (0, 2)
    assert result.residuals[-1] < (1e-3 if dtype == np.float32 else 1e-8)
    np.testing.assert_array_equal(result.lamp_powers, np.ones((1, 1)))


@every_solver
def test_other_sizes_are_solved(name: str) -> None:
    rng = np.random.default_rng(7)
    matrix = random_system(rng, 33, 10)
    x = rng.uniform(0.05, 0.2, (10, 35))  # more columns than one block of the row actions
    result = SOLVERS[name](DenseOperator(matrix), light(matrix, x), iterations=1000)
    np.testing.assert_allclose(result.x, x, atol=1e-8)


@every_solver
@every_dtype
def test_started_at_the_solution_they_stay_there(name: str, dtype: type[np.floating]) -> None:
    A, x, B = problem(3, dtype)
    result = SOLVERS[name](A, B, x0=x.astype(dtype), iterations=20)
    np.testing.assert_allclose(result.x, x, atol=1e-5 if dtype == np.float32 else 1e-11)
    if name in ITERATIVE:
        assert len(result.residuals) == 1
        assert result.stop_reason == "converged"


@pytest.mark.parametrize("name", ITERATIVE)
def test_the_start_is_used(name: str) -> None:
    A, x, B = problem(3)
    far, near = (SOLVERS[name](A, B, x0=start, iterations=1).residuals[0] for start in (None, x + 1e-3))
    assert near < far / 10


@pytest.mark.parametrize("name", SOLVERS)
def test_the_start_is_not_written_to(name: str) -> None:
    A, x, B = problem(3)
    start, given_light = x + 0.1, B.copy()
    SOLVERS[name](A, B, x0=start, iterations=3)
    np.testing.assert_array_equal(start, x + 0.1)
    np.testing.assert_array_equal(B, given_light)


@every_solver
def test_lamp_powers_count_per_view_and_channel(name: str) -> None:
    A, x, B = problem(6)
    view_of_row = np.repeat(np.arange(11), 7)
    powers = np.random.default_rng(1).uniform(0.5, 4.0, (11, 3))
    shown = B * powers[view_of_row][:, [0, 1, 2, 0, 1, 2]]
    result = SOLVERS[name](A, shown, view_of_row=view_of_row, lamp_bounds=(powers, powers), iterations=1000)
    np.testing.assert_allclose(result.x, x, atol=1e-8)
    np.testing.assert_array_equal(result.lamp_powers, powers)


@every_solver
def test_without_lamp_bounds_every_view_has_power_1(name: str) -> None:
    A, x, B = problem(3)
    result = SOLVERS[name](A, B, view_of_row=np.repeat(np.arange(11), 7), iterations=1000)
    np.testing.assert_allclose(result.x, x, atol=1e-8)
    np.testing.assert_array_equal(result.lamp_powers, np.ones((11, 1)))


@every_solver
def test_a_lamp_to_choose_is_refused(name: str) -> None:
    A, _, B = problem(3)
    with pytest.raises(InputError, match=f"method {name} cannot choose lamp powers"):
        SOLVERS[name](A, B, lamp_bounds=(np.ones((1, 3)), np.full((1, 3), 4.0)))


@every_solver
@pytest.mark.parametrize("per_column", [True, False])
def test_weight_0_is_no_equation(name: str, per_column: bool) -> None:
    A, x, B = problem(4)
    rng = np.random.default_rng(2)
    weights = (rng.random((77, 4 if per_column else 1)) > 0.2).astype(float)
    assert all(np.linalg.matrix_rank(A.matrix[column > 0]) == 15 for column in weights.T)
    spoilt = np.where(weights > 0, B, rng.uniform(0.001, 3.0, B.shape))
    result = SOLVERS[name](A, spoilt, weights=weights, iterations=2000)
    np.testing.assert_allclose(result.x, x, atol=1e-8)
    assert result.rejected.shape == (0, 2)
    if result.undetermined is not None:
        assert not result.undetermined.any()


@every_solver
def test_columns_do_not_feel_each_other(name: str) -> None:
    A, _, B = problem(5)
    B = B * np.random.default_rng(3).uniform(0.7, 1.4, B.shape)
    together = SOLVERS[name](A, B, iterations=12)
    for column in (0, 3):
        alone = SOLVERS[name](A, B[:, [column]], iterations=12)
        np.testing.assert_allclose(together.x[:, [column]], alone.x, atol=1e-10)


@every_solver
def test_bounds_are_kept(name: str) -> None:
    A, _, B = problem(5)
    B = B * np.random.default_rng(4).uniform(0.5, 2.0, B.shape)

    def look(progress: Progress) -> None:
        assert progress.x.min() >= 0.05
        assert progress.x.max() <= 0.25

    result = SOLVERS[name](A, B, bounds=(0.05, 0.25), iterations=30, callback=look)
    look(Progress(0, 0, result.x, result.x, 0.0, result.lamp_powers, dict))
    assert result.x.min() == 0.05
    assert result.x.max() == 0.25


@every_solver
@every_dtype
def test_the_callback_sees_what_is_reached(name: str, dtype: type[np.floating]) -> None:
    A, _, B = problem(3, dtype)
    B = (B * np.random.default_rng(5).uniform(0.8, 1.25, B.shape)).astype(dtype)
    seen: list[Progress] = []

    def look(progress: Progress) -> None:
        seen.append(
            Progress(progress.iteration, progress.iterations, progress.x.copy(), progress.absorbance.copy(), 0, B, dict)
        )
        residuals.append(progress.residual)

    residuals: list[float] = []
    result = SOLVERS[name](A, B, iterations=9, callback=look)
    assert len(seen) == len(result.residuals)
    assert residuals == result.residuals.tolist()
    for progress in seen:
        assert progress.x.dtype == progress.absorbance.dtype == dtype
        close = 1e-4 if dtype == np.float32 else 1e-11
        np.testing.assert_allclose(progress.absorbance, A.forward(progress.x), atol=close)
    if name in ITERATIVE:
        assert [progress.iteration for progress in seen] == list(range(1, 10))
        assert result.stop_reason == "iterations"


@every_solver
def test_the_callback_stops(name: str) -> None:
    A, _, B = problem(3)
    B = B * np.random.default_rng(6).uniform(0.5, 2.0, B.shape)
    result = SOLVERS[name](A, B, callback=lambda progress: progress.iteration >= 2)
    assert result.stop_reason == "callback"
    assert len(result.residuals) == 2


# ---- The paper's two methods ----


def planted(
    matrix: np.ndarray, columns: int, false: int, dtype: type[np.floating] = np.float64, seed: int = 0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A cube, its shadows with some pixels of each column made too dark or too bright, and which."""
    rng = np.random.default_rng(seed)
    x = rng.uniform(0.1, 1.0, (matrix.shape[1], columns)) / matrix.sum(axis=1).max()
    shown, mask = light(matrix, x, dtype), np.zeros((len(matrix), columns), np.bool_)
    for column in range(columns):
        rows = rng.choice(np.flatnonzero(matrix.sum(axis=1) > 0.5), false, replace=False)
        mask[rows, column] = True
        shown[rows, column] *= rng.choice([0.2, 0.5, 1.3], false)
    return x, shown, mask


@pytest.mark.parametrize("name", PAPERS)
@every_dtype
@pytest.mark.parametrize(
    ("shape", "views", "beams", "false"), [((3, 5), 13, 7, 5), ((3, 5), 13, 7, 8), ((3, 3), 8, 5, 2), ((5, 3), 9, 6, 1)]
)
def test_planted_false_equations_are_exactly_those_rejected(
    name: str, dtype: type[np.floating], shape: tuple[int, int], views: int, beams: int, false: int
) -> None:
    matrix = projections(shape, views, beams)
    x, shown, mask = planted(matrix, 7, false, dtype)
    result = SOLVERS[name](DenseOperator(matrix), shown, iterations=400)
    assert result.rejected.dtype == np.int64
    assert result.rejected.tolist() == pairs(mask)
    np.testing.assert_allclose(result.x, x, atol=2e-3 * x.max() if dtype == np.float32 else 1e-8)
    assert result.undetermined is not None
    assert not result.undetermined.any()
    assert result.stop_reason == "converged"


@pytest.mark.parametrize("name", PAPERS)
def test_many_false_equations_in_a_larger_cube(name: str) -> None:
    size = 4 if config.DISABLE_JIT else 9  # type: ignore[attr-defined]
    matrix = projections((size, size + 1), 3 * size, size + 6)
    x, shown, mask = planted(matrix, 3, size, seed=1)
    result = SOLVERS[name](DenseOperator(matrix), shown, iterations=400)
    assert result.rejected.tolist() == pairs(mask)
    np.testing.assert_allclose(result.x, x, atol=1e-5)


@pytest.mark.parametrize("name", PAPERS)
def test_a_disagreement_of_less_than_half_a_level_is_none(name: str) -> None:
    A, x, B = problem(3)
    row = 5 * 7 + 3
    for levels, count in ((0.3, 0), (30.0, 3)):
        shown = B.copy()
        shown[row] *= np.exp(-2 * levels * half_level(B[row]))
        result = SOLVERS[name](A, shown, iterations=400)
        assert len(result.rejected) == count
    np.testing.assert_allclose(result.x, x, atol=1e-8)


def test_half_a_level_is_half_a_level() -> None:
    shown = np.array([0.004, 0.05, 0.3, 1.0, 2.5])
    step = half_level(shown)
    levels = (encode(shown * np.exp(step / 100)) - encode(shown)) * 255 * 100
    np.testing.assert_allclose(levels, 0.5, rtol=1e-3)
    np.testing.assert_array_equal(half_level(np.array([1e-9, 1e-3])), half_level(np.array([0.0031308]))[0])
    assert half_level(shown.astype(np.float32)).dtype == np.float32


@pytest.mark.parametrize("name", PAPERS)
def test_weights_say_which_of_two_equal_equations_goes(name: str) -> None:
    """One voxel, two beams through it that disagree: only their weights tell them apart."""
    A = DenseOperator(np.array([[1.0], [1.0]]))
    B = np.exp(-np.array([[0.2, 0.2], [0.6, 0.6]]))
    result = SOLVERS[name](A, B, weights=np.array([[1.0, 0.1], [0.1, 1.0]]), iterations=60)
    assert result.rejected.tolist() == [[0, 1], [1, 0]]
    np.testing.assert_allclose(result.x, [[0.2, 0.6]], atol=1e-9)


@pytest.mark.parametrize("name", PAPERS)
def test_impossible_equations_go_and_take_nothing_with_them(name: str) -> None:
    """A shadow where the beam misses the cube, and a pixel brighter than the lamp."""
    A, x, B = problem(2)
    matrix = np.concatenate([A.matrix, np.zeros((1, 15))])
    shown = np.concatenate([B, [[0.5, 1.0]]])
    shown[38, 1] = 1.7
    result = SOLVERS[name](DenseOperator(matrix), shown, iterations=400)
    assert result.rejected.tolist() == [[38, 1], [77, 0]]
    np.testing.assert_allclose(result.x, x, atol=1e-8)
    if name == "gauss-seidel":
        assert gauss_seidel(DenseOperator(matrix), shown, iterations=1).rejected.tolist() == [[38, 1], [77, 0]]


@pytest.mark.parametrize("name", PAPERS)
def test_what_the_bounds_forbid_goes_before_what_weighs_less(name: str) -> None:
    """Two beams through one voxel: the one of more weight asks for more light than the lamp has."""
    A = DenseOperator(np.ones((2, 1)))
    B = np.exp(-np.array([[-0.4], [0.3]]))
    result = SOLVERS[name](A, B, weights=np.array([[1.5], [1.0]]), iterations=60)
    assert result.rejected.tolist() == [[0, 0]]
    np.testing.assert_allclose(result.x, [[0.3]], atol=1e-9)


@pytest.mark.parametrize("name", PAPERS)
def test_voxels_without_equations_are_transparent(name: str) -> None:
    """Voxels 4 and 9 are met by no beam, voxel 11 only by beams that do not count in column 1."""
    A, x, B = problem(3)
    matrix = A.matrix.copy()
    matrix[:, [4, 9]] = 0
    weights = np.ones(B.shape)
    weights[matrix[:, 11] > 0, 1] = 0
    expected = np.zeros(x.shape, np.bool_)
    expected[[4, 9]] = True
    expected[11, 1] = True
    seen = [voxel for voxel in range(15) if voxel not in (4, 9, 11)]
    present = matrix[weights[:, 1] > 0]
    assert np.linalg.matrix_rank(present[:, seen]) == len(seen)  # the others stay determined
    result = SOLVERS[name](
        DenseOperator(matrix), light(matrix, x), weights=weights, x0=np.full(x.shape, 0.3), iterations=3000
    )
    np.testing.assert_array_equal(result.undetermined, expected)
    np.testing.assert_allclose(result.x, np.where(expected, 0, x), atol=1e-8)


@pytest.mark.parametrize("name", PAPERS)
def test_voxels_of_rejected_equations_only_are_transparent(name: str) -> None:
    """Voxel 2 is seen by one beam alone, and that beam asks for more light than the lamp has."""
    A = DenseOperator(np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 1.0]]))
    B = np.exp(-np.array([[0.3], [0.8], [0.5], [-2.0]]))
    result = SOLVERS[name](A, B, x0=np.full((3, 1), 0.2), iterations=200)
    if name == "gauss-seidel":
        assert result.rejected.tolist() == [[3, 0]]
        assert result.undetermined is not None
        assert result.undetermined.tolist() == [[False], [False], [True]]
    np.testing.assert_allclose(result.x, [[0.3], [0.5], [0.0]], atol=1e-9)


@pytest.mark.parametrize("name", PAPERS)
def test_no_equation_at_all_leaves_everything_transparent(name: str) -> None:
    A, x, B = problem(2)
    result = SOLVERS[name](A, B, weights=np.zeros((1, 1)), x0=x, iterations=5)
    assert result.undetermined is not None
    assert result.undetermined.all()
    np.testing.assert_array_equal(result.x, 0)


@pytest.mark.parametrize("shape", [(3, 5), (5, 3), (3, 3)])
@pytest.mark.parametrize("views", [1, 2])
def test_row_reduction_determines_what_the_row_space_holds(shape: tuple[int, int], views: int) -> None:
    """With few views most voxels are undetermined: compare with unit vectors projected on the row space."""
    matrix = projections(shape, views, 8)
    matrix[3] = 0
    matrix[3, 7] = 1  # one beam through one voxel alone
    _, singular, rows = np.linalg.svd(matrix)
    null = rows[np.sum(singular > 1e-9) :]
    determined = np.linalg.norm(null, axis=0) < 1e-7
    assert 0 < determined.sum() < len(determined)
    x = np.random.default_rng(8).uniform(0.1, 0.4, (matrix.shape[1], 4))
    result = row_reduction(DenseOperator(matrix), light(matrix, x))
    np.testing.assert_array_equal(result.undetermined, np.repeat(~determined[:, None], 4, axis=1))
    np.testing.assert_allclose(result.x, np.where(determined[:, None], x, 0), atol=1e-9)


def test_row_reduction_leaves_a_sum_alone_transparent() -> None:
    A = DenseOperator(np.array([[1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    result = row_reduction(A, np.exp(-np.array([[0.7], [0.4]])))
    assert result.undetermined is not None
    assert result.undetermined.tolist() == [[True], [True], [False]]
    np.testing.assert_allclose(result.x, np.array([[0], [0], [0.4]]), atol=1e-12)


def test_row_reduction_refuses_large_cubes_with_the_limit_and_the_others() -> None:
    side = int(np.sqrt(LARGEST)) + 1
    A, B = DenseOperator(np.zeros((side, side))), np.ones((side, 1))
    with pytest.raises(InputError, match=r"at most 250000 numbers.* 501 x 501: .*gauss-seidel, sirt, cgls"):
        row_reduction(A, B)


def test_gauss_seidel_ends_with_something_sensible_where_everything_disagrees() -> None:
    A, _, _ = problem(1)
    shown = np.random.default_rng(9).uniform(0.05, 1.0, (77, 4))
    result = gauss_seidel(A, shown, iterations=60)
    assert len(result.residuals) == 60
    assert result.stop_reason == "iterations"
    assert np.all(np.isfinite(result.x))
    assert 0 < len(result.rejected) < shown.size
    remaining = np.ones(shown.shape, np.bool_)
    remaining[tuple(result.rejected.T)] = False
    misses = np.where(remaining, A.forward(result.x) + np.log(shown), 0)
    assert np.linalg.norm(misses) < 0.5 * np.linalg.norm(np.where(remaining, np.log(shown), 0))


@every_dtype
def test_a_sweep_is_the_plain_row_actions(dtype: type[np.floating]) -> None:
    """The kernel against the formula, with rows and columns switched off, more columns than a block holds."""
    rng = np.random.default_rng(10)
    equations, unknowns, columns = 11, 7, BLOCK + 3
    matrix = rng.uniform(0, 1, (equations, unknowns)) * (rng.random((equations, unknowns)) < 0.5)
    matrix[4] = 0
    b = rng.uniform(-1, 2, (equations, columns)).astype(dtype)
    x = rng.uniform(0.1, 0.9, (unknowns, columns)).astype(dtype)
    active, relaxation = rng.random((equations, columns)) < 0.7, rng.uniform(0, 1.5, columns).astype(dtype)
    norms = np.sum(matrix**2, axis=1)
    inverse = np.divide(1, norms, out=np.zeros(equations), where=norms > 0)
    order = rng.permutation(equations)

    plain = x.astype(np.float64)
    for column in range(columns):
        for row in order:
            if active[row, column]:
                step = relaxation[column] * inverse[row] * (b[row, column] - matrix[row] @ plain[:, column])
                plain[:, column] = np.clip(plain[:, column] + step * matrix[row], 0.1, 0.9)
    sparse = DenseOperator(matrix).to_sparse()
    sweep(
        sparse.indptr, sparse.indices, sparse.data.astype(dtype), inverse.astype(dtype), order,
        b, active, relaxation, dtype(0.1), dtype(0.9), x,
    )  # fmt: skip
    np.testing.assert_allclose(x, plain, atol=1e-5 if dtype == np.float32 else 1e-12)


# ---- On the real matrix ----


@every_solver
@every_dtype
@pytest.mark.parametrize("elevation", [0.0, 35.0])
def test_a_cubes_own_shadows_come_back(name: str, dtype: type[np.floating], elevation: float) -> None:
    """At least 60 dB in display values; lamp powers differ between views and colours."""
    grid = Grid((2, 3, 5), 0.7)
    projector = Projector(grid, turntable_views(grid, spread_angles(9, elevation=elevation), elevation=elevation))
    rng = np.random.default_rng(11)
    columns = 6 if elevation == 0 else 3
    x = (rng.uniform(0, 0.8, (projector.shape[1], columns)) * (rng.random((projector.shape[1], 1)) < 0.6)).astype(dtype)
    powers = rng.uniform(0.5, 2.0, (9, 3))
    lamp = powers[projector.view_of_row][:, np.arange(columns) % 3]
    wanted = (lamp * np.exp(-projector.forward(x))).astype(dtype)
    result = SOLVERS[name](
        projector, wanted, view_of_row=projector.view_of_row, lamp_bounds=(powers, powers), iterations=150
    )
    shown = lamp * np.exp(-projector.forward(result.x))
    psnr = -10 * np.log10(np.mean((encode(shown) - encode(wanted.astype(np.float64))) ** 2))
    assert psnr >= 60


# ---- Bad input ----


def refused(name: str, match: str, **changes: Any) -> None:
    A, _, B = problem(2)
    arguments: dict[str, Any] = {"B": B, **changes}
    with pytest.raises(InputError, match=match):
        SOLVERS[name](A, arguments.pop("B"), **arguments)


@every_solver
@pytest.mark.parametrize(
    ("match", "changes"),
    [
        (r"B must have shape \(77, columns\)", {"B": np.ones((76, 2))}),
        (r"B must have shape \(77, columns\)", {"B": np.ones(77)}),
        (r"B must have shape \(77, columns\)", {"B": np.ones((77, 0))}),
        ("B must be float32 or float64, not int64", {"B": np.ones((77, 2), np.int64)}),
        ("transmittance must be positive", {"B": np.zeros((77, 2))}),
        ("transmittance must be positive", {"B": np.full((77, 2), np.nan)}),
        (r"weights of shape \(76, 2\) do not fit", {"weights": np.ones((76, 2))}),
        ("weights must be finite and at least 0", {"weights": np.full((77, 1), -1.0)}),
        ("weights must be finite and at least 0", {"weights": np.full((77, 1), np.nan)}),
        ("x0 must be finite numbers of shape", {"x0": np.ones((15, 1))}),
        ("x0 must be finite numbers of shape", {"x0": np.full((15, 2), np.inf)}),
        ("bounds must be", {"bounds": (1.0, 0.0)}),
        ("bounds must be", {"bounds": (0.0, np.nan)}),
        ("bounds must be", {"bounds": (np.inf, np.inf)}),
        ("view_of_row must be 77 whole numbers", {"view_of_row": np.zeros(76, np.int64)}),
        ("view_of_row must be 77 whole numbers", {"view_of_row": np.zeros(77)}),
        ("view_of_row must count views from 0", {"view_of_row": np.full(77, -1)}),
        ("names 3 views, but there are lamp powers for 1", {
            "view_of_row": np.full(77, 2), "lamp_bounds": (np.ones((1, 1)), np.ones((1, 1)))
        }),
        ("lamp powers must be positive", {"lamp_bounds": (np.zeros((1, 1)), np.zeros((1, 1)))}),
        ("lamp powers must be positive", {"lamp_bounds": (np.ones(3), np.ones(3))}),
        ("iterations must be at least 1", {"iterations": 0}),
        ("iterations must be a whole number", {"iterations": 2.5}),
    ],
)  # fmt: skip
def test_bad_input_is_refused_with_a_sentence(name: str, match: str, changes: dict[str, Any]) -> None:
    refused(name, match, **changes)


@settings(max_examples=25, deadline=None)
@given(
    name=st.sampled_from(list(SOLVERS)),
    shape=st.tuples(st.integers(0, 3), st.integers(0, 3)).filter(lambda shape: shape not in {(1, 1), (1, 2)}),
)
def test_weights_of_any_other_shape_are_refused(name: str, shape: tuple[int, int]) -> None:
    refused(name, "weights", weights=np.ones(shape))


@settings(max_examples=25, deadline=None)
@given(
    name=st.sampled_from(list(SOLVERS)),
    where=st.tuples(st.integers(0, 76), st.integers(0, 1)),
    value=st.sampled_from([np.nan, np.inf, -np.inf, 0.0, -1e-30, -5.0]),
)
def test_light_that_is_none_is_refused_wherever_it_stands(name: str, where: tuple[int, int], value: float) -> None:
    shown = np.full((77, 2), 0.5)
    shown[where] = value
    refused(name, "transmittance", B=shown)


def test_every_method_has_the_one_signature() -> None:
    """The names of the parameters, their order and what they default to."""
    expected = list(inspect.signature(Solver.__call__).parameters.values())[1:]
    methods: list[Callable[..., Result]] = [row_reduction, gauss_seidel, sirt, cgls]
    for method in methods:
        got = list(inspect.signature(method).parameters.values())
        assert [(p.name, p.kind, p.default) for p in got] == [(p.name, p.kind, p.default) for p in expected]
