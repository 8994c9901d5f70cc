"""What the paper's two methods do with false equations and undetermined voxels."""

import numpy as np
import pytest
from numba import config

from lightcube.errors import InputError
from lightcube.kernels.row_action import BLOCK, sweep
from lightcube.optics.transfer import encode
from lightcube.solvers._absorbance import half_level
from lightcube.solvers.contract import Solver, Wanted
from lightcube.solvers.gauss_seidel import gauss_seidel
from lightcube.solvers.row_reduction import LARGEST, row_reduction
from tests.helpers.solver_problems import DenseOperator, full_rank, light, projections

SOLVERS: dict[str, Solver] = {"row-reduction": row_reduction, "gauss-seidel": gauss_seidel}

every_dtype = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def pairs(mask: np.ndarray) -> list[list[int]]:
    return np.argwhere(mask).tolist()


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


@pytest.mark.parametrize("name", SOLVERS)
@every_dtype
@pytest.mark.parametrize(
    ("shape", "views", "beams", "false"), [((3, 5), 13, 7, 5), ((3, 5), 13, 7, 8), ((3, 3), 8, 5, 2), ((5, 3), 9, 6, 1)]
)
def test_planted_false_equations_are_exactly_those_rejected(
    name: str, dtype: type[np.floating], shape: tuple[int, int], views: int, beams: int, false: int
) -> None:
    matrix = projections(shape, views, beams)
    x, shown, mask = planted(matrix, 7, false, dtype)
    result = SOLVERS[name](DenseOperator(matrix), Wanted(shown), iterations=400)
    assert result.rejected.dtype == np.int64
    assert result.rejected.tolist() == pairs(mask)
    np.testing.assert_allclose(result.x, x, atol=2e-3 * x.max() if dtype == np.float32 else 1e-8)
    assert result.undetermined is not None
    assert not result.undetermined.any()
    assert result.stop_reason == "converged"


@pytest.mark.parametrize("name", SOLVERS)
def test_many_false_equations_in_a_larger_cube(name: str) -> None:
    size = 4 if config.DISABLE_JIT else 9  # type: ignore[attr-defined]
    matrix = projections((size, size + 1), 3 * size, size + 6)
    x, shown, mask = planted(matrix, 3, size, seed=1)
    result = SOLVERS[name](DenseOperator(matrix), Wanted(shown), iterations=400)
    assert result.rejected.tolist() == pairs(mask)
    np.testing.assert_allclose(result.x, x, atol=1e-5)


@pytest.mark.parametrize("name", SOLVERS)
def test_a_disagreement_of_less_than_half_a_level_is_none(name: str) -> None:
    A, x, B = full_rank(3)
    row = 5 * 7 + 3
    for levels, count in ((0.3, 0), (30.0, 3)):
        shown = B.copy()
        shown[row] *= np.exp(-2 * levels * half_level(B[row]))
        result = SOLVERS[name](A, Wanted(shown), iterations=400)
        assert len(result.rejected) == count
    np.testing.assert_allclose(result.x, x, atol=1e-8)


def test_half_a_level_is_half_a_level() -> None:
    shown = np.array([0.004, 0.05, 0.3, 1.0, 2.5])
    step = half_level(shown)
    levels = (encode(shown * np.exp(step / 100)) - encode(shown)) * 255 * 100
    np.testing.assert_allclose(levels, 0.5, rtol=1e-3)
    np.testing.assert_array_equal(half_level(np.array([1e-9, 1e-3])), half_level(np.array([0.0031308]))[0])
    assert half_level(shown.astype(np.float32)).dtype == np.float32


@pytest.mark.parametrize("name", SOLVERS)
def test_weights_say_which_of_two_equal_equations_goes(name: str) -> None:
    """One voxel, two beams through it that disagree: only their weights tell them apart."""
    A = DenseOperator(np.array([[1.0], [1.0]]))
    B = np.exp(-np.array([[0.2, 0.2], [0.6, 0.6]]))
    result = SOLVERS[name](A, Wanted(B, weights=np.array([[1.0, 0.1], [0.1, 1.0]])), iterations=60)
    assert result.rejected.tolist() == [[0, 1], [1, 0]]
    np.testing.assert_allclose(result.x, [[0.2, 0.6]], atol=1e-9)


@pytest.mark.parametrize("name", SOLVERS)
def test_impossible_equations_go_and_take_nothing_with_them(name: str) -> None:
    """A shadow where the beam misses the cube, and a pixel brighter than the lamp."""
    A, x, B = full_rank(2)
    matrix = np.concatenate([A.matrix, np.zeros((1, 15))])
    shown = np.concatenate([B, [[0.5, 1.0]]])
    shown[38, 1] = 1.7
    result = SOLVERS[name](DenseOperator(matrix), Wanted(shown), iterations=400)
    assert result.rejected.tolist() == [[38, 1], [77, 0]]
    np.testing.assert_allclose(result.x, x, atol=1e-8)
    if name == "gauss-seidel":
        assert gauss_seidel(DenseOperator(matrix), Wanted(shown), iterations=1).rejected.tolist() == [[38, 1], [77, 0]]


@pytest.mark.parametrize("name", SOLVERS)
def test_what_the_bounds_forbid_goes_before_what_weighs_less(name: str) -> None:
    """Two beams through one voxel: the one of more weight asks for more light than the lamp has."""
    A = DenseOperator(np.ones((2, 1)))
    B = np.exp(-np.array([[-0.4], [0.3]]))
    result = SOLVERS[name](A, Wanted(B, weights=np.array([[1.5], [1.0]])), iterations=60)
    assert result.rejected.tolist() == [[0, 0]]
    np.testing.assert_allclose(result.x, [[0.3]], atol=1e-9)


@pytest.mark.parametrize("name", SOLVERS)
def test_voxels_without_equations_are_transparent(name: str) -> None:
    """Voxels 4 and 9 are met by no beam, voxel 11 only by beams that do not count in column 1."""
    A, x, B = full_rank(3)
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
        DenseOperator(matrix), Wanted(light(matrix, x), weights=weights), x0=np.full(x.shape, 0.3), iterations=3000
    )
    np.testing.assert_array_equal(result.undetermined, expected)
    np.testing.assert_allclose(result.x, np.where(expected, 0, x), atol=1e-8)


@pytest.mark.parametrize("name", SOLVERS)
def test_voxels_of_rejected_equations_only_are_transparent(name: str) -> None:
    """Voxel 2 is seen by one beam alone, and that beam asks for more light than the lamp has."""
    A = DenseOperator(np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 1.0]]))
    B = np.exp(-np.array([[0.3], [0.8], [0.5], [-2.0]]))
    result = SOLVERS[name](A, Wanted(B), x0=np.full((3, 1), 0.2), iterations=200)
    if name == "gauss-seidel":
        assert result.rejected.tolist() == [[3, 0]]
        assert result.undetermined is not None
        assert result.undetermined.tolist() == [[False], [False], [True]]
    np.testing.assert_allclose(result.x, [[0.3], [0.5], [0.0]], atol=1e-9)


@pytest.mark.parametrize("name", SOLVERS)
def test_no_equation_at_all_leaves_everything_transparent(name: str) -> None:
    A, x, B = full_rank(2)
    result = SOLVERS[name](A, Wanted(B, weights=np.zeros((1, 1))), x0=x, iterations=5)
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
    result = row_reduction(DenseOperator(matrix), Wanted(light(matrix, x)))
    np.testing.assert_array_equal(result.undetermined, np.repeat(~determined[:, None], 4, axis=1))
    np.testing.assert_allclose(result.x, np.where(determined[:, None], x, 0), atol=1e-9)


def test_row_reduction_leaves_a_sum_alone_transparent() -> None:
    A = DenseOperator(np.array([[1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    result = row_reduction(A, Wanted(np.exp(-np.array([[0.7], [0.4]]))))
    assert result.undetermined is not None
    assert result.undetermined.tolist() == [[True], [True], [False]]
    np.testing.assert_allclose(result.x, np.array([[0], [0], [0.4]]), atol=1e-12)


def test_row_reduction_refuses_large_cubes_with_the_limit_and_the_others() -> None:
    side = int(np.sqrt(LARGEST)) + 1
    A, B = DenseOperator(np.zeros((side, side))), np.ones((side, 1))
    with pytest.raises(InputError, match=r"at most 250000 numbers.* 501 x 501: .*gauss-seidel, sirt, cgls"):
        row_reduction(A, Wanted(B))


def test_gauss_seidel_ends_with_something_sensible_where_everything_disagrees() -> None:
    A, _, _ = full_rank(1)
    shown = np.random.default_rng(9).uniform(0.05, 1.0, (77, 4))
    result = gauss_seidel(A, Wanted(shown), iterations=60)
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
