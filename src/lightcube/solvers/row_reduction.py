"""The paper's row reduction for rectangular systems."""

from collections.abc import Iterator

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.sparse import csr_array, eye_array, hstack

from lightcube.errors import InputError
from lightcube.optics.arrays import locked
from lightcube.solvers._absorbance import half_level
from lightcube.solvers._checks import LinearProblem, check_iterations, check_state, linear_problem
from lightcube.solvers.contract import Bounds, Callback, Floats, Operator, Progress, Result, State, Wanted

#: The largest matrix, in equations times unknowns.
LARGEST = 250_000
#: What is left of a row counts as zero below this part of the matrix's largest number.
_RANK = 1e-9
#: In a finished pivot row, a number below this does not tie its voxel to one without a pivot.
_TIE = 1e-7
#: Equations that the least-disagreement fit meets to this part of the tolerance are reduced first.
_MET = 1e-3

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]


def row_reduction(
    A: Operator,
    wanted: Wanted,
    *,
    x0: Floats | None = None,
    bounds: Bounds = (0.0, np.inf),
    iterations: int = 100,
    callback: Callback | None = None,
    state: State | None = None,
) -> Result:
    """Solve ``A x = b``, ``b = ln P - ln light``, by Gauss-Jordan elimination in float64, for small cubes.

    The parameters are those of `lightcube.solvers.contract.Solver`; the lamp powers must be fixed. The method is
    direct: `iterations` do not count, and `x0` is only what columns show before they are finished. The callback is
    called for every few columns that are. The method cannot keep `bounds` while it solves: what leaves them is
    clipped at the end. Equations of weight 0 are absent.

    * All columns with the same equations are reduced at once, always by the largest number left as pivot; a row
      counts as reduced to 0 when nothing above 1e-9 of the matrix's largest number is left.
    * A row reduced to ``0 = c`` is inconsistent if ``|c|`` is more than half a display level as absorbance
      (`half_level` of its pixel). It is thrown out. ``c`` is by how much the solution misses that equation.
    * Which of the equations that disagree is reduced last, and so thrown out, is otherwise an accident. So a column
      with inconsistent rows is reduced again by itself, in the order in which its equations fit the ``x`` within
      `bounds` of least total disagreement ``sum w |b - A x|`` (a linear program): first, by largest pivots, those that
      it meets to a thousandth of the tolerance, then one after the other, the worst last.
    * A voxel is determined if the remaining equations leave it only one value: its unit vector lies in their row
      space. All others become 0 (or the bound next to it), fully transparent, also where only a sum of them is
      determined; the values of determined voxels do not depend on that.

    Returns
    -------
    `Result` with the equations thrown out and the undetermined voxels. `residuals` are the 2-norm of ``b - A x``
    over the remaining equations of the finished columns. It stops as ``"converged"`` or by the callback.

    Raises
    ------
    InputError
        Where the matrix has more than 250,000 numbers (equations times unknowns), or the input does not fit together.

    References
    ----------
    J. R. Rankin, M. Boyapati, Visual Hull Construction from Semitransparent Coloured Silhouettes;
    P. Bloomfield, W. Steiger, Least Absolute Deviations (1983), for the fit.
    """
    if A.shape[0] * A.shape[1] > LARGEST:
        raise InputError(
            f"method row-reduction takes at most {LARGEST} numbers (equations times unknowns), not "
            f"{A.shape[0]} x {A.shape[1]}: use a smaller cube, or method gauss-seidel, sirt, cgls or display"
        )
    problem = linear_problem("row-reduction", A, wanted, x0, bounds)
    check_iterations(iterations)
    x = problem.x
    columns = x.shape[1]
    undetermined = np.ones(x.shape, np.bool_)
    rejected = np.zeros(problem.b.shape, np.bool_)
    finished = np.zeros(columns, np.bool_)
    residuals: list[float] = []
    if state is not None:
        masks = {"undetermined": undetermined, "rejected": rejected, "finished": finished}
        kept = check_state(
            state, columns, {name: (array.shape, array.dtype) for name, array in {"x": x, **masks}.items()}
        )
        x, undetermined, rejected, finished = (kept[name] for name in ("x", *masks))
        residuals = kept["history"].tolist()

    def keep() -> State:
        arrays = {"x": x, "undetermined": undetermined, "rejected": rejected, "finished": finished}
        return {**arrays, "history": np.array(residuals)}

    reason = "converged"
    matrix, lower = A.to_sparse().toarray(), problem.lower
    tolerance = half_level(wanted.light, wanted.transfer).astype(np.float64)
    for some, values, free, out in _solve(matrix, problem, tolerance, finished.copy()):
        x[:, some] = np.clip(np.where(free, 0, values), lower[some], problem.upper)
        undetermined[:, some], rejected[:, some], finished[some] = free, out, True
        ax = A.forward(x)
        remaining = (problem.weights > 0) & ~rejected & finished
        residuals.append(float(np.linalg.norm((problem.b - ax)[remaining])))
        progress = Progress(int(np.sum(finished)), columns, x, ax, residuals[-1], problem.lamp_powers, keep)
        if callback is not None and callback(progress):
            reason = "callback"
            break
    return Result(
        locked(x), problem.lamp_powers, np.array(residuals), np.argwhere(rejected), locked(undetermined), reason
    )


#: The method as the table has it; how many arrays it holds is measured.
def _solve(
    matrix: Matrix, problem: LinearProblem, tolerance: Matrix, finished: Mask
) -> Iterator[tuple[NDArray[np.intp], Matrix, Mask, Mask]]:
    """For some unfinished columns after others: which, values, undetermined voxels and rejected equations."""
    b, lower = problem.b.astype(np.float64), problem.lower
    patterns, pattern_of_column = np.unique(problem.weights > 0, axis=1, return_inverse=True)
    for pattern, present in enumerate(patterns.T):
        rows, columns = np.flatnonzero(present), np.flatnonzero(pattern_of_column == pattern)
        if np.all(finished[columns]):
            continue
        # Finished columns too: pivots are the same, and rounding is.
        values, free, misses = _reduce(matrix[rows], b[np.ix_(rows, columns)], len(rows))
        bad = np.any(np.abs(misses) > tolerance[np.ix_(rows, columns)], axis=0)
        if not np.all(bad | finished[columns]):
            yield columns[~bad], values[:, ~bad], free, np.zeros((len(b), 1), np.bool_)
        for column in columns[bad & ~finished[columns]]:
            fit = _fit(matrix[rows], b[rows, column], problem.weights[rows, column], lower[column], problem.upper)
            disagreement = np.abs(b[rows, column] - matrix[rows] @ fit) / tolerance[rows, column]
            order = rows[np.argsort(disagreement, kind="stable")]
            met = int(np.sum(disagreement <= _MET))
            values, free, misses = _reduce(matrix[order], b[order, column][:, None], met)
            out = np.zeros((len(b), 1), np.bool_)
            out[order, 0] = np.abs(misses[:, 0]) > tolerance[order, column]
            yield np.array([column]), values, free, out


def _reduce(matrix: Matrix, right: Matrix, pivoted: int) -> tuple[Matrix, Mask, Matrix]:
    """Gauss-Jordan elimination: the first `pivoted` rows by largest pivots, then the others in their order.

    Returns
    -------
    Values ``(unknowns, columns)`` with the voxels without pivot at 0; undetermined voxels ``(unknowns, 1)``; and
    the ``c`` of rows that became ``0 = c``, ``(equations, columns)``, 0 for pivot rows.
    """
    unknowns = matrix.shape[1]
    work = np.concatenate([matrix, right], axis=1)
    left = work[:, :unknowns]
    small = _RANK * np.max(matrix, initial=0)
    pivot_row = np.full(unknowns, -1)
    unused = np.ones(len(work), np.bool_)

    def eliminate(row: int, column: int) -> None:
        pivot_row[column], unused[row] = row, False
        work[row] /= work[row, column]
        factors = work[:, column].copy()
        factors[row] = 0
        work[:] -= np.outer(factors, work[row])

    for _ in range(min(pivoted, unknowns)):
        candidates = np.abs(left[:pivoted]) * unused[:pivoted, None]
        row, column = divmod(int(np.argmax(candidates)), unknowns)
        if candidates[row, column] <= small:
            break
        eliminate(row, column)
    for row in range(pivoted, len(work)):
        column = int(np.argmax(np.abs(left[row])))
        if abs(left[row, column]) > small:
            eliminate(row, column)

    has_pivot = pivot_row >= 0
    values = np.zeros((unknowns, right.shape[1]))
    values[has_pivot] = work[pivot_row[has_pivot], unknowns:]
    free = ~has_pivot
    free[has_pivot] = np.any(np.abs(left[np.ix_(pivot_row[has_pivot], ~has_pivot)]) > _TIE, axis=1)
    return values, free[:, None], np.where(unused[:, None], work[:, unknowns:], 0)


def _fit(matrix: Matrix, b: Matrix, weights: Floats, lower: float, upper: float) -> Matrix:
    """Return the ``x`` within the bounds of least ``sum w |b - A x|``."""
    equations, unknowns = matrix.shape
    one = eye_array(equations)
    solution = scipy.optimize.linprog(
        np.concatenate([np.zeros(unknowns), weights, weights]),
        A_eq=hstack([csr_array(matrix), one, -one], format="csr"),
        b_eq=b,
        bounds=[(lower, upper)] * unknowns + [(0, None)] * (2 * equations),
    )
    if solution.x is None:
        raise ArithmeticError(f"the linear program that orders the equations has no solution: {solution.message}")
    return np.asarray(solution.x[:unknowns])
