"""Small problems that the tests of all solvers share: plain operators and a plain two-dimensional ray tracer."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from lightcube.solvers.contract import Bounds, Callback, Floats, Operator, Progress, Result, State, Wanted

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class DenseOperator:
    """A dense matrix as solvers see it."""

    matrix: Matrix

    @property
    def shape(self) -> tuple[int, int]:
        return self.matrix.shape[0], self.matrix.shape[1]

    def forward(self, x: Floats) -> Floats:
        assert x.ndim == 2
        return np.asarray(self.matrix.astype(x.dtype) @ x)

    def adjoint(self, b: Floats) -> Floats:
        assert b.ndim == 2
        return np.asarray(self.matrix.T.astype(b.dtype) @ b)

    def to_sparse(self) -> csr_array:
        return csr_array(self.matrix)


def ray_lengths(shape: tuple[int, int], through: Matrix, along: Matrix) -> Matrix:
    """Length of one ray in every pixel of a centred grid of unit pixels, by sorting all its crossings."""
    ny, nx = shape
    crossings = [
        (k - n / 2 - start) / step
        for n, start, step in ((nx, through[0], along[0]), (ny, through[1], along[1]))
        if abs(step) > 1e-12
        for k in range(n + 1)
    ]
    lengths = np.zeros(shape)
    for near, far in zip(sorted(crossings)[:-1], sorted(crossings)[1:], strict=True):
        x, y = through + (near + far) / 2 * along
        column, row = int(np.floor(x + nx / 2)), int(np.floor(y + ny / 2))
        if 0 <= column < nx and 0 <= row < ny:
            lengths[row, column] += far - near
    return lengths.ravel()


def projections(shape: tuple[int, int], views: int, beams: int, span_deg: float = 180.0) -> Matrix:
    """Matrix of `views` parallel views of a grid of unit pixels, half a step from 0 degrees; beams one pixel apart."""
    rows = []
    for angle_deg in np.radians((np.arange(views) + 0.5) * span_deg / views):
        along = np.array([np.cos(angle_deg), np.sin(angle_deg)])
        across = np.array([along[1], -along[0]])
        rows += [ray_lengths(shape, (k - (beams - 1) / 2) * across, along) for k in range(beams)]
    return np.array(rows)


def random_system(rng: np.random.Generator, equations: int, unknowns: int) -> Matrix:
    """A sparse, well-conditioned matrix without negative numbers; no row and no column is empty."""
    matrix = rng.uniform(0.5, 1.5, (equations, unknowns)) * (rng.random((equations, unknowns)) < 0.4)
    matrix[np.arange(equations), np.arange(equations) % unknowns] += 1.0
    return np.asarray(matrix)


def light(matrix: Matrix, x: Matrix, dtype: type[np.floating] = np.float64) -> Floats:
    """What a lamp of power 1 shows through `x`."""
    return np.asarray(np.exp(-matrix @ x).astype(dtype))


def full_rank(
    columns: int, dtype: type[np.floating] = np.float64, seed: int = 0
) -> tuple[DenseOperator, Matrix, Floats]:
    """A grid of 3 x 5 seen in 11 views of 7 beams, full rank: the matrix, a cube and its shadows."""
    matrix = projections((3, 5), 11, 7)
    assert np.linalg.matrix_rank(matrix) == 15
    x = np.random.default_rng(seed).uniform(0.1, 1.0, (15, columns)) / 3
    return DenseOperator(matrix), x, light(matrix, x, dtype)


def plain_descent(
    A: Operator,
    wanted: Wanted,
    *,
    x0: Floats | None = None,
    bounds: Bounds = (0.0, np.inf),
    iterations: int = 100,
    callback: Callback | None = None,
    state: State | None = None,
) -> Result:
    """Half the least squares of absorbance by projected gradient: a method as somebody else would write one."""
    b, weights, powers = wanted.absorbance(), wanted.weights, wanted.lamp_bounds[1]
    sums = A.adjoint(weights * A.forward(np.ones((A.shape[1], 1), b.dtype)))
    steps = np.divide(1, sums, out=np.zeros_like(sums), where=sums > 0)
    start = np.zeros((A.shape[1], b.shape[1])) if x0 is None else x0
    x, history = np.clip(start, *bounds).astype(b.dtype), []
    if state is not None:
        x, history = state["x"], state["history"].tolist()
    ax, asked = A.forward(x), False
    while not asked and len(history) < iterations:
        x = np.clip(x + steps * A.adjoint(weights * (b - ax)), *bounds)
        ax = A.forward(x)
        history.append(float(0.5 * np.sum(weights * (b - ax) ** 2, dtype=np.float64)))
        kept = {"x": x, "history": np.array(history)}
        progress = Progress(len(history), iterations, x, ax, history[-1], powers, kept.copy)
        asked = callback is not None and bool(callback(progress))
    return Result(x, powers, np.array(history), stop_reason="callback" if asked else "iterations")
