"""The steps of method display: what they compute, and how much memory they take."""

import tracemalloc

import numpy as np
import pytest
from numba import config
from scipy.sparse import csr_array

from lightcube.kernels import convex, descent, display, momentum
from lightcube.solvers.contract import Floats, Lighting, Wanted
from lightcube.solvers.display import display_values
from tests.conftest import INTERPRETED
from tests.helpers.solver_problems import full_rank


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


#: Fewer columns than fill a vector, walked as one run with others; rows that are no whole runs; more than a run has.
BLOCKS = [(70, 4), (50_000, 3), (7, 1), (130, 700)] if not INTERPRETED else [(70, 4), (7, 1)]


@pytest.mark.parametrize("shape", BLOCKS)
def test_a_step_is_what_its_formulas_say(shape: tuple[int, int]) -> None:
    """Kept between the bounds; what has no step stays."""
    random = np.random.default_rng(4)
    x, before, slopes = (random.normal(size=shape) for _ in range(3))
    steps = random.random(shape) * (random.random(shape) < 0.9)
    ahead, stride = random.choice([0.0, 1.0], shape[1]), random.uniform(0.5, 1.3, shape[1])
    start = x + ahead * (x - before)
    expected = np.where(steps > 0, np.clip(start - stride * steps * slopes, -1.0, 0.8), x)
    uphill = np.divide((start - expected) * (expected - x), steps, out=np.zeros(shape), where=steps > 0)
    found = descent.step(x.copy(), before, ahead, slopes, steps, stride, -1.0, 0.8)
    np.testing.assert_allclose(before, expected)
    np.testing.assert_allclose(found, np.sum(uphill, axis=0), rtol=1e-9)


@pytest.mark.parametrize("shape", BLOCKS)
def test_momentum_leads_on_by_what_each_column_is_given(shape: tuple[int, int]) -> None:
    random = np.random.default_rng(5)
    last, now = random.normal(size=(2, *shape))
    ahead = random.uniform(0, 1, shape[1])
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
    A, _, B = full_rank(6, np.float32)
    by_row = np.linspace(0, 1, len(B), dtype=np.float32)[:, None]
    strided = np.repeat(by_row, 12, axis=1)[:, ::2]
    one, other = (display_values(A, Wanted(B, weights), iterations=13) for weights in (by_row, strided))
    np.testing.assert_array_equal(one.x, other.x)
    np.testing.assert_array_equal(one.residuals, other.residuals)
    assert one.lower_bound == other.lower_bound


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
    wanted = Wanted(B, np.ones((1, 1), np.float32), Lighting(np.arange(3)), lamps)
    display_values(A, wanted, iterations=4)


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
