"""Simultaneous iterative reconstruction: all beams correct all voxels at once."""

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.arrays import locked
from lightcube.solvers._checks import check_iterations, check_state, linear_problem
from lightcube.solvers._momentum import run_ahead
from lightcube.solvers.contract import Bounds, Callback, Floats, Operator, Progress, Result, State, Wanted

#: A column has converged once a step is shorter than this part of its right-hand side (both in the method's norms).
_TOLERANCE = {np.dtype(np.float32): 1e-6, np.dtype(np.float64): 1e-12}


def sirt(
    A: Operator,
    wanted: Wanted,
    *,
    x0: Floats | None = None,
    bounds: Bounds = (0.0, np.inf),
    iterations: int = 100,
    callback: Callback | None = None,
    state: State | None = None,
) -> Result:
    """Minimise ``sum_i w_i / r_i * (b - A x)_i^2`` within bounds, ``b = ln P - ln light`` and ``r`` the row sums of A.

    The parameters are those of `lightcube.solvers.contract.Solver`; `A` must hold no negative number and the
    lamp powers must be fixed. The update is ``x <- clip(y + C A^T R W (b - A y))`` with ``R = 1 / r`` and ``C``
    one over the column sums of ``W A``, from a point ``y`` that runs ahead of ``x``: Nesterov's momentum, dropped
    for a column whenever it points uphill. Momentum changes the way but not the minimum. Where the minimum is not
    unique, without bounds and from 0, the limit is the minimiser of least ``sum_j x_j^2 / C_j``; a voxel that no
    weighted beam meets keeps its start.

    Returns
    -------
    `Result` whose `residuals` are the square root of what is minimised, over all columns. It stops as
    ``"converged"`` once every column's step is at most 1e-12 (float32: 1e-6) of its right-hand side, the step
    measured as ``sqrt(sum d_j^2 / C_j)`` and the right-hand side in the norm that is minimised.

    References
    ----------
    P. Gilbert, J. Theor. Biol. 36 (1972); A. van der Sluis, H. A. van der Vorst, Linear Algebra Appl. 130 (1990);
    B. O'Donoghue, E. Candes, Found. Comput. Math. 15 (2015), for the restart.
    """
    problem = linear_problem("sirt", A, wanted, x0, bounds)
    iterations = check_iterations(iterations)
    b, x, dtype = problem.b, problem.x, problem.x.dtype
    columns = x.shape[1:]
    row_weights = problem.weights * _inverse(A.forward(np.ones((A.shape[1], 1), dtype)))
    column_sums = _column_sums(A, problem.weights)
    C = _inverse(column_sums)
    if state is None:
        before, ahead, momentum = x, np.zeros(columns), np.ones(columns)
        ax = ax_before = A.forward(x)
        small = _TOLERANCE[dtype] * np.maximum(_norms(row_weights, b), _norms(row_weights, ax))
        residuals: list[float] = []
        settled = False
    else:
        per_column = dict.fromkeys(("ahead", "momentum", "small"), (columns, np.float64))
        unknowns = dict.fromkeys(("x", "before"), (x.shape, x.dtype))
        kept = check_state(state, iterations, {**unknowns, **per_column, "settled": ((), np.bool_)})
        x, before, ahead, momentum, small = (kept[name] for name in ("x", "before", "ahead", "momentum", "small"))
        ax, ax_before = A.forward(x), A.forward(before)
        residuals, settled = kept["history"].tolist(), bool(kept["settled"])

    def keep() -> State:
        arrays = {"x": x, "before": before, "ahead": ahead, "momentum": momentum, "small": small}
        return {**arrays, "settled": np.array(settled), "history": np.array(residuals)}

    asked = False
    while not (asked or settled or len(residuals) == iterations):
        y = x + ahead.astype(dtype) * (x - before)
        ay = ax + ahead.astype(dtype) * (ax - ax_before)
        before, ax_before = x, ax
        x = np.clip(y + C * A.adjoint(row_weights * (b - ay)), problem.lower, problem.upper)
        ax = A.forward(x)
        step = x - y
        residuals.append(float(np.linalg.norm(_norms(row_weights, b - ax))))
        settled = bool(np.all(_norms(column_sums, step) <= small))
        uphill = np.sum(column_sums * step * (x - before), axis=0) < 0
        ahead, momentum = run_ahead(momentum, uphill)
        asked = callback is not None and bool(
            callback(Progress(len(residuals), iterations, x, ax, residuals[-1], problem.lamp_powers, keep))
        )
    reason = "callback" if asked else "converged" if settled else "iterations"
    return Result(locked(x), problem.lamp_powers, np.array(residuals), stop_reason=reason)


#: The method as the table has it; how many arrays it holds is measured.
def _column_sums(A: Operator, weights: Floats) -> Floats:
    """Column sums of ``W A``, ``(unknowns, columns)``, or ``(unknowns, 1)`` where all columns have the same weights."""
    same = np.array_equal(weights, np.broadcast_to(weights[:, :1], weights.shape))
    return A.adjoint(np.ascontiguousarray(weights[:, :1] if same else weights))


def _inverse(sums: Floats) -> Floats:
    """One over `sums`, and 0 where they are 0: a beam without voxels, a voxel without beams."""
    return np.divide(1, sums, out=np.zeros_like(sums), where=sums > 0)


def _norms(weights: Floats, values: Floats) -> NDArray[np.float64]:
    """Weighted 2-norm of each column."""
    return np.sqrt(np.sum(weights * values**2, axis=0, dtype=np.float64))
