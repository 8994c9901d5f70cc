"""What the eye sees: least squares in display values, made convex.

With ``u = ln P - A x`` the ln of the light on the screen, ``u*`` the wanted one and ``g`` the sRGB display value as a
function of ``u``, the residual is ``g(u) - g(u*)`` where a beam is too bright, and its tangent ``g'(u*) (u - u*)``,
of slope at least 0.03, where it is too dark. Display values alone would leave a beam that became much too dark
without a gradient, a black speck for ever; logarithms alone would spend everything on darks that nobody can
tell apart. The square of the two-sided residual is convex in ``x`` (but for a negligible kink at the toe of the curve).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import display
from lightcube.solvers._checks import check_iterations, linear_problem
from lightcube.solvers.contract import Callback, Floats, Operator, Progress, Result

#: The curvatures used hold as long as no beam's ln light rises by more than this.
_ROOM = 0.1
#: Curvatures are renewed after 1, 2, 3, 4, 5, 6, 8, 10, 13, ... iterations: each time costs an adjoint.
_RENEWAL = 1.25
#: Converged when this many iterations lower the objective by less than this part of it.
_PATIENCE, _TOLERANCE = 20, 1e-4


def display_values(
    A: Operator,
    B: Floats,
    *,
    weights: Floats | None = None,
    view_of_row: NDArray[np.integer[Any]] | None = None,
    lamp_bounds: tuple[Floats, Floats] | None = None,
    x0: Floats | None = None,
    bounds: tuple[float, float] = (0.0, np.inf),
    iterations: int = 200,
    callback: Callback | None = None,
) -> Result:
    """Minimise half the weighted sum of squared two-sided residuals over ``lower <= x <= upper``.

    Accelerated projected gradient (FISTA) whose step per unknown is the inverse of a diagonal majoriser,
    ``sum_i A_ij c_i sum_k A_ik`` with ``c_i`` a bound on the curvature of beam i's term; a column whose momentum
    points uphill, or whose objective rose, starts its momentum anew. An iteration is one pass.

    Parameters
    ----------
    A, B, weights, view_of_row, lamp_bounds, x0, bounds, iterations, callback
        As in `lightcube.solvers.contract.Solver`; lamp powers must be fixed (equal bounds).

    Returns
    -------
    `Result` with ``residuals`` = the objective after each iteration.

    References
    ----------
    A. Beck, M. Teboulle, A fast iterative shrinkage-thresholding algorithm, SIAM J. Imaging Sci. 2 (2009) 183-202.
    B. O'Donoghue, E. Candès, Adaptive restart for accelerated gradient schemes, Found. Comput. Math. 15 (2015) 715-732.
    """
    problem = linear_problem("display", A, B, weights, view_of_row, lamp_bounds, x0, bounds)
    views = np.zeros(len(B), np.intp) if view_of_row is None else view_of_row
    data = (np.log(problem.lamp_powers).astype(B.dtype), views, np.log(B), problem.weights)
    reach = A.forward(np.ones((A.shape[1], 1), B.dtype))

    x = problem.x
    ax = A.forward(x)
    y, ay = x, ax
    slopes = np.empty_like(B)
    steps = x
    momentum = np.ones(B.shape[1])
    objective = np.full(B.shape[1], np.inf)
    history: list[float] = []
    renewal = 1
    for iteration in range(1, check_iterations(iterations) + 1):
        if iteration == renewal:
            display.curvatures(ay, *data, _ROOM, slopes)
            steps = _inverse(A.adjoint(slopes * reach))
            renewal = int(iteration * _RENEWAL) + 1
        display.descend(ay, *data, slopes)
        new = np.clip(y - steps * A.adjoint(slopes), problem.lower, problem.upper)
        a_new = A.forward(new)
        before, objective = objective, display.descend(a_new, *data, slopes)
        uphill = np.einsum("ij,ij,ij->j", y - new, _inverse(steps), new - x) > 0
        if np.any(objective > before):
            renewal = iteration + 1
        momentum[uphill | (objective > before)] = 1
        following = (1 + np.sqrt(1 + 4 * momentum**2)) / 2
        ahead = ((momentum - 1) / following).astype(B.dtype)
        y, ay = new + ahead * (new - x), a_new + ahead * (a_new - ax)
        x, ax, momentum = new, a_new, following
        history.append(float(np.sum(objective)))
        if callback is not None and callback(Progress(iteration, iterations, x, ax, history[-1])):
            return Result(x, problem.lamp_powers, np.array(history), stop_reason="callback")
        if _has_converged(history):
            return Result(x, problem.lamp_powers, np.array(history), stop_reason="converged")
    return Result(x, problem.lamp_powers, np.array(history))


def _inverse(steps: Floats) -> Floats:
    """``1 / steps``, and 0 for unknowns that no weighted beam meets: they stay where they are."""
    return np.divide(1, steps, out=np.zeros_like(steps), where=steps > 0)


def _has_converged(history: list[float]) -> bool:
    if len(history) <= _PATIENCE:
        return False
    return history[-1 - _PATIENCE] - history[-1] <= _TOLERANCE * history[-1]
