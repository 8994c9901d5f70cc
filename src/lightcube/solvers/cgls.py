"""Conjugate gradients on the normal equations, projected on the bounds."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.arrays import locked
from lightcube.solvers._checks import LinearProblem, check_iterations, check_state, linear_problem
from lightcube.solvers.contract import Bounds, Callback, Floats, Operator, Progress, Result, State, Wanted

#: A column has converged once the gradient that the bounds leave is this part of ``A.T W b``, in the 2-norm.
_TOLERANCE = {np.dtype(np.float32): 1e-6, np.dtype(np.float64): 1e-12}

PerColumn = NDArray[np.float64]


def cgls(
    A: Operator,
    wanted: Wanted,
    *,
    x0: Floats | None = None,
    bounds: Bounds = (0.0, np.inf),
    iterations: int = 100,
    callback: Callback | None = None,
    state: State | None = None,
) -> Result:
    """Minimise ``sum_i w_i (b - A x)_i^2`` within the bounds, ``b = ln P - ln light``, each column with its own steps.

    The parameters are those of `lightcube.solvers.contract.Solver`; `A` must hold no negative number and the lamp
    powers must be fixed. Without bounds this is CGLS: ``p <- g + (|g|^2 / |g before|^2) p``,
    ``x <- x + (g p / |A p|_W^2) p`` with ``g = A.T W (b - A x)``.

    With bounds it runs on the voxels strictly between them. A step that would leave them is clipped as a whole, or
    ends at the first bound it meets, whichever is better, and conjugate directions start anew on the voxels that
    are still free. Where the voxels at a bound that want to leave it outweigh the free ones comes a projected
    gradient step over all voxels, ``p = clip(x + g / d) - x`` with ``d = A.T W A 1``, which cannot go uphill.
    So the objective falls with every step. Where the minimum is not unique, the limit without bounds and from 0 is
    the minimiser of least 2-norm.

    Returns
    -------
    `Result` whose `residuals` are the square root of what is minimised, over all columns. It stops as
    ``"converged"`` once in every column the gradient that the bounds leave, ``g`` less what points out of them,
    is at most 1e-12 (float32: 1e-6) of ``A.T W b``, both in the 2-norm; a column that is there rests.

    References
    ----------
    A. Bjorck, Numerical Methods for Least Squares Problems (1996), 7.4; J. J. More, G. Toraldo, SIAM J. Optim. 1
    (1991); Z. Dostal, J. Schoberl, Comput. Optim. Appl. 30 (2005), for weighing the two parts of the gradient.
    """
    problem = linear_problem("cgls", A, wanted, x0, bounds)
    iterations = check_iterations(iterations)
    b, w, x, dtype = problem.b, problem.weights, problem.x, problem.x.dtype
    d = A.adjoint(w * A.forward(np.ones((A.shape[1], 1), dtype)))
    if state is None:
        ax, p = A.forward(x), np.zeros_like(x)
        small = _TOLERANCE[dtype] * np.maximum(_norms(A.adjoint(w * b)), _norms(A.adjoint(w * ax)))
        fresh, free_before = np.ones(x.shape[1], np.bool_), np.ones(x.shape[1])
        residuals: list[float] = []
    else:
        kept = check_state(state, iterations, _needed(x, b))
        x, ax, p, small, fresh, free_before = (kept[name] for name in _needed(x, b))
        residuals = kept["history"].tolist()

    def keep() -> State:
        values = (x, ax, p, small, fresh, free_before)
        return dict(zip(_needed(x, b), values, strict=True)) | {"history": np.array(residuals)}

    reason = ""
    while not reason:
        g = A.adjoint(w * (b - ax))
        free, leaving = _parts_of_gradient(problem, x, g)
        free_norm, leaving_norm = _norms(free), _norms(leaving)
        rests = np.hypot(free_norm, leaving_norm) <= small
        if len(residuals) == iterations or (residuals and np.all(rests)):
            reason = "converged" if np.all(rests) else "iterations"
            break
        project = leaving_norm > free_norm
        p = free + _ratio(~fresh * free_norm**2, free_before**2).astype(dtype) * p
        if np.any(project):
            p[:, project] = _projected_gradient(problem, project, x, g, d)
        p[:, rests] = 0
        x, ax, clipped = _step(A, problem, x, ax, g, p)
        fresh, free_before = project | clipped, free_norm
        residuals.append(float(np.sqrt(np.sum(w * (b - ax) ** 2, dtype=np.float64))))
        progress = Progress(len(residuals), iterations, x, ax, residuals[-1], problem.lamp_powers, keep)
        if callback is not None and callback(progress):
            reason = "callback"
    return Result(locked(x), problem.lamp_powers, np.array(residuals), stop_reason=reason)


#: The method as the table has it; how many arrays it holds is measured.
def _needed(x: Floats, b: Floats) -> dict[str, tuple[tuple[int, ...], np.dtype[Any]]]:
    """Shapes and dtypes of what iterates. A x is among it: steps add up in it."""
    per_column, number, flag = (x.shape[1],), np.dtype(np.float64), np.dtype(np.bool_)
    return {
        "x": (x.shape, x.dtype),
        "ax": (b.shape, x.dtype),
        "p": (x.shape, x.dtype),
        "small": (per_column, number),
        "fresh": (per_column, flag),
        "free_before": (per_column, number),
    }


def _step(
    A: Operator,
    problem: LinearProblem,
    x: Floats,
    ax: Floats,
    g: Floats,
    p: Floats,
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Step along `p` to the least of the objective, or to what the bounds leave of that: x, A x, and where they did."""
    q = A.forward(p)
    curvature = np.sum(problem.weights * q**2, axis=0, dtype=np.float64)
    length = _ratio(np.asarray(np.sum(g * p, axis=0, dtype=np.float64)), np.asarray(curvature)).astype(x.dtype)
    wanted = x + length * p
    x_new, ax_new = np.clip(wanted, problem.lower, problem.upper), ax + length * q
    clipped = np.any(x_new != wanted, axis=0)
    if np.any(clipped):
        x_new[:, clipped], ax_new[:, clipped] = _better_end(A, problem, clipped, x, ax, p, q, x_new)
    return x_new, ax_new, clipped


def _better_end(
    A: Operator,
    problem: LinearProblem,
    columns: NDArray[np.bool_],
    x: Floats,
    ax: Floats,
    p: Floats,
    q: Floats,
    x_clipped: Floats,
) -> tuple[Floats, Floats]:
    """Of some columns, the better of a clipped step and of one that ends at the first bound it meets: x and A x."""
    x, p, x_far = x[:, columns], p[:, columns], np.ascontiguousarray(x_clipped[:, columns])
    ax_far = A.forward(x_far)
    lower = problem.lower[columns]
    ahead = np.where(p > 0, problem.upper - x, lower - x)
    room = np.divide(ahead, p, out=np.full_like(p, np.inf), where=p != 0)
    length = room.min(axis=0)
    x_near = np.clip(x + length * p, lower, problem.upper)
    x_near = np.where(room == length, x_far, x_near)  # exactly on the bound that was met
    ax_near = ax[:, columns] + length * q[:, columns]
    b, w = problem.b[:, columns], problem.weights[:, columns]
    far = np.sum(w * (b - ax_far) ** 2, axis=0) <= np.sum(w * (b - ax_near) ** 2, axis=0)
    return np.where(far, x_far, x_near), np.where(far, ax_far, ax_near)


def _parts_of_gradient(problem: LinearProblem, x: Floats, g: Floats) -> tuple[Floats, Floats]:
    """`g` of the voxels strictly between the bounds, and of those at a bound that it would lead away from it."""
    low, high = x <= problem.lower, x >= problem.upper
    return np.where(low | high, 0, g), np.where((low & ~high & (g > 0)) | (high & ~low & (g < 0)), g, 0)


def _projected_gradient(problem: LinearProblem, columns: NDArray[np.bool_], x: Floats, g: Floats, d: Floats) -> Floats:
    """Of some columns, the direction of a gradient step, scaled by its majorant `d` and clipped to the bounds."""
    x, g, d = x[:, columns], g[:, columns], d[:, columns]
    step = np.divide(g, d, out=np.zeros_like(g), where=d > 0)
    return np.asarray(np.clip(x + step, problem.lower[columns], problem.upper) - x)


def _ratio(above: PerColumn, below: PerColumn) -> PerColumn:
    """`above` / `below`, and 0 where `below` is 0."""
    return np.divide(above, below, out=np.zeros_like(below), where=below > 0)


def _norms(values: Floats) -> PerColumn:
    """2-norm of each column."""
    return np.sqrt(np.sum(values**2, axis=0, dtype=np.float64))
