"""What the eye sees: least squares in display values, made convex.

With ``u = ln P - A x`` the ln of the light on the screen, ``u*`` the wanted one and ``g`` the display value as a
function of ``u``, the residual is ``g(u) - g(u*)`` where a beam is too bright, and its tangent ``g'(u*) (u - u*)``,
of slope at least 0.03, where it is too dark. Display values alone would leave a beam that became much too dark
without a gradient, a black speck for ever; logarithms alone would spend everything on darks that nobody can
tell apart. The square of the two-sided residual is convex in ``(x, ln P)`` but for a negligible kink at the toe of
the curve.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.absorption import absorbance
from lightcube.kernels import display
from lightcube.solvers._checks import (
    check_bounds,
    check_iterations,
    check_lamp,
    check_shapes,
    check_start,
    check_views,
    check_weights,
)
from lightcube.solvers.contract import Callback, Floats, Operator, Progress, Result
from lightcube.transfer import Transfer

#: The curvatures used hold as long as no beam's ln light rises by more than this.
_ROOM = 0.1
#: Curvatures are renewed after 1, 2, 3, 4, 5, 6, 8, 10, 13, ... iterations: each time costs an adjoint.
_RENEWAL = 1.25
#: How much longer the steps are than the majoriser allows, and the part of it that a rise of the objective leaves.
_STRIDE, _CAUTION = 1.3, 0.95
#: Momentum must not lead to beams of less absorbance than this: below 0 they are brighter than the lamp.
_LEAST_AHEAD = -0.5
#: Converged when this many iterations lower the objective by less than this part of it, or it is as good as 0.
_PATIENCE, _TOLERANCE, _PERFECT = 20, 1e-4, 1e-9


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
    transfer: Transfer = "srgb",
) -> Result:
    """Minimise half the weighted sum of squared two-sided residuals over ``lower <= x <= upper`` and the lamp powers.

    For any `x` the best lamp powers within their bounds are found exactly (a convex function of one number each, no
    product with A), so the objective is a function of `x` alone, whose curvature is no larger than with fixed
    powers. It is lowered by projected gradient with greedy momentum: every step starts from
    ``y = x + (x - x before)``. The step of an unknown is 1.3 over a diagonal majoriser,
    ``sum_i A_ij c_i sum_k A_ik`` with ``c_i`` a bound on the curvature of beam i's term. A column whose momentum
    points uphill or far out of the bounds, or whose objective rose, starts anew from ``y = x``, in the last case
    with a shorter stride. An iteration is one pass.

    Parameters
    ----------
    A, B, weights, view_of_row, lamp_bounds, x0, bounds, iterations, callback, transfer
        As in `lightcube.solvers.contract.Solver`.

    Returns
    -------
    `Result` with ``residuals`` = the objective after each iteration.

    References
    ----------
    A. Beck, M. Teboulle, A fast iterative shrinkage-thresholding algorithm, SIAM J. Imaging Sci. 2 (2009) 183-202.
    J. Liang, T. Luo, C.-B. Schönlieb, Improving "fast iterative shrinkage-thresholding algorithm": faster, smarter,
    and greedier, SIAM J. Sci. Comput. 44 (2022) A1069-A1091, for momentum and stride.
    G. Golub, V. Pereyra, Separable nonlinear least squares, Inverse Problems 19 (2003) R1-R26, for the lamp.
    """
    screen = _Screen.of(A, B, weights, view_of_row, lamp_bounds, transfer)
    lower, upper = check_bounds(bounds)
    x = check_start(x0, (A.shape[1], B.shape[1]), (lower, upper), B.dtype)
    reach = A.forward(np.ones((A.shape[1], 1), B.dtype))
    ax = A.forward(x)
    y, ay = x, ax
    lamp = np.clip(np.zeros_like(screen.low), screen.low, screen.high)
    slopes = np.empty_like(B)
    metric = steps = x
    stride = np.full(B.shape[1], _STRIDE, B.dtype)
    objective = np.full(B.shape[1], np.inf)
    history: list[float] = []
    enough = _PERFECT * float(np.sum(screen.weights, dtype=np.float64))
    renewal = 1
    for iteration in range(1, check_iterations(iterations) + 1):
        lamp = screen.best_lamp(ay, lamp)
        if iteration == renewal:
            metric = A.adjoint(screen.curvatures(ay, lamp, slopes) * reach)
            steps = _inverse(metric)
            renewal = int(iteration * _RENEWAL) + 1
        screen.descend(ay, lamp, slopes)
        new = np.clip(y - stride * steps * A.adjoint(slopes), lower, upper)
        a_new = A.forward(new)
        lamp = screen.best_lamp(a_new, lamp)
        before, objective = objective, screen.descend(a_new, lamp, slopes)
        rose = objective > before
        uphill = np.einsum("ij,ij,ij->j", y - new, metric, new - x) > 0
        stride[rose] = np.maximum(1, _CAUTION * stride[rose])
        if np.any(rose):
            renewal = iteration + 1
        too_far = np.min(2 * a_new - ax, axis=0) < _LEAST_AHEAD
        ahead = np.where(rose | uphill | too_far, 0, 1).astype(B.dtype)
        y, ay = new + ahead * (new - x), a_new + ahead * (a_new - ax)
        x, ax = new, a_new
        history.append(float(np.sum(objective)))
        progress = Progress(iteration, iterations, x, ax, history[-1], screen.powers(lamp))
        if callback is not None and callback(progress):
            return Result(x, screen.powers(lamp), np.array(history), stop_reason="callback")
        if _has_converged(history, enough):
            return Result(x, screen.powers(lamp), np.array(history), stop_reason="converged")
    return Result(x, screen.powers(lamp), np.array(history))


@dataclass(frozen=True)
class _Screen:
    """What is wanted of the screen, and the lamps that shine on it; lamp powers as ln P, ``(views, channels)``."""

    wanted: Floats
    weights: Floats
    views: NDArray[np.integer[Any]]
    #: The equations of view v are ``rows[starts[v]:starts[v + 1]]``.
    rows: NDArray[np.integer[Any]]
    starts: NDArray[np.integer[Any]]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    #: The same as powers.
    bounds: tuple[NDArray[np.float64], NDArray[np.float64]]
    #: Display values are sRGB, not linear light.
    srgb: bool

    @classmethod
    def of(
        cls,
        A: Operator,
        B: Floats,
        weights: Floats | None,
        view_of_row: NDArray[np.integer[Any]] | None,
        lamp_bounds: tuple[Floats, Floats] | None,
        transfer: Transfer,
    ) -> "_Screen":
        """Check what the solver was given; `InputError` names what cannot be used."""
        check_shapes(A, B)
        low, high = check_lamp(lamp_bounds, check_views(view_of_row, A.shape[0]))
        views = np.zeros(len(B), np.intp) if view_of_row is None else view_of_row
        rows = np.argsort(views, kind="stable")
        starts = np.searchsorted(views[rows], np.arange(len(low) + 1))
        wanted = -np.ascontiguousarray(absorbance(B))
        return cls(
            wanted,
            check_weights(weights, B),
            views,
            rows,
            starts,
            np.log(low),
            np.log(high),
            (low, high),
            transfer == "srgb",
        )

    def powers(self, lamp: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return P of ln P, within the bounds to the last digit."""
        return np.clip(np.exp(lamp), *self.bounds)

    def best_lamp(self, ax: Floats, start: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the best ln P for absorbance `ax`, found from `start`."""
        if np.array_equal(self.low, self.high):
            return self.low
        lamp = start.copy()
        data = (self.rows, self.starts, self.wanted, self.weights, self.srgb)
        display.fit_lamp(ax, *data, self.low, self.high, lamp)
        return lamp

    def descend(self, ax: Floats, lamp: NDArray[np.float64], slopes: Floats) -> NDArray[np.float64]:
        """Write the objective's derivative by the absorbance to `slopes`; return the objective per column."""
        return display.descend(ax, lamp.astype(ax.dtype), self.views, self.wanted, self.weights, self.srgb, slopes)

    def curvatures(self, ax: Floats, lamp: NDArray[np.float64], out: Floats) -> Floats:
        """Write to `out`, and return, bounds on the curvature of each entry's term."""
        display.curvatures(ax, lamp.astype(ax.dtype), self.views, self.wanted, self.weights, self.srgb, _ROOM, out)
        return out


def _inverse(metric: Floats) -> Floats:
    """``1 / metric``, and 0 for unknowns that no weighted beam meets: they stay where they are."""
    return np.divide(1, metric, out=np.zeros_like(metric), where=metric > 0)


def _has_converged(history: list[float], enough: float) -> bool:
    if history[-1] <= enough:
        return True
    if len(history) <= _PATIENCE:
        return False
    return history[-1 - _PATIENCE] - history[-1] <= _TOLERANCE * history[-1]
