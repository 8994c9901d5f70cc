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
from lightcube.kernels import descent, display
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
#: The metric is renewed after 1, 2, 4, 7, 11, 17, 26, ... iterations: each time costs as much as an iteration.
_RENEWAL = 1.5
#: How far an empty voxel is expected to move, as a part of its column's mean extinction.
_EXPECTED = 0.5
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
    ``sum_i A_ij c_i sum_k A_ik e_k / e_j`` with ``c_i`` a bound on the curvature of beam i's term and ``e`` how far
    the unknowns are expected to move, which any positive numbers make a majoriser: here x and half its mean, so that
    the many empty voxels do not shorten the steps of the others. A column whose momentum points uphill or far out of
    the bounds, or whose objective rose, starts anew from ``y = x``, in the last case with a shorter stride.

    Parameters
    ----------
    A, B, weights, view_of_row, lamp_bounds, x0, bounds, iterations, callback, transfer
        As in `lightcube.solvers.contract.Solver`.

    Returns
    -------
    `Result` with ``residuals`` = the objective after each iteration, each of which is one pass, and
    ``lower_bound``, below which no `x` and no lamp can bring the objective (two passes).

    References
    ----------
    A. De Pierro, A modified expectation maximization algorithm for penalized likelihood estimation in emission
    tomography, IEEE Trans. Med. Imaging 14 (1995) 132-137, for majorisers with such weights.
    A. Beck, M. Teboulle, A fast iterative shrinkage-thresholding algorithm, SIAM J. Imaging Sci. 2 (2009) 183-202.
    J. Liang, T. Luo, C.-B. Schönlieb, Improving "fast iterative shrinkage-thresholding algorithm": faster, smarter,
    and greedier, SIAM J. Sci. Comput. 44 (2022) A1069-A1091, for momentum and stride.
    G. Golub, V. Pereyra, Separable nonlinear least squares, Inverse Problems 19 (2003) R1-R26, for the lamp.
    """
    screen = _Screen.of(A, B, weights, view_of_row, lamp_bounds, transfer)
    lower, upper = check_bounds(bounds)
    x = check_start(x0, (A.shape[1], B.shape[1]), (lower, upper), B.dtype)
    before = x.copy()
    ax = A.forward(x)
    ay = ax
    lamp = np.clip(np.zeros_like(screen.low), screen.low, screen.high)
    slopes = np.empty_like(B)
    steps = x
    stride = np.full(B.shape[1], _STRIDE, B.dtype)
    ahead = np.zeros(B.shape[1], B.dtype)
    objective = np.full(B.shape[1], np.inf)
    history: list[float] = []
    enough = _PERFECT * float(np.sum(screen.weights, dtype=np.float64))
    limits: tuple[Any, Any] = (B.dtype.type(lower), B.dtype.type(upper))
    renewal, stop_reason = 1, "iterations"
    for iteration in range(1, check_iterations(iterations) + 1):
        lamp = screen.best_lamp(ay, lamp)
        if iteration == renewal:
            expected = _expected_change(x)
            metric = A.adjoint(screen.curvatures(ay, lamp, slopes) * A.forward(expected))
            steps = np.divide(expected, metric, out=np.zeros_like(metric), where=metric > 0)
            del expected, metric
            renewal = int(iteration * _RENEWAL) + 1
        screen.descend(ay, lamp, slopes)
        uphill = descent.step(x, before, ahead, A.adjoint(slopes), steps, stride, *limits) > 0
        x, before = before, x
        a_new = A.forward(x)
        lamp = screen.best_lamp(a_new, lamp)
        last, objective = objective, screen.descend(a_new, lamp, slopes)
        rose = objective > last
        stride[rose] = np.maximum(1, _CAUTION * stride[rose])
        if np.any(rose & (ahead == 0)):  # not for the momentum: the bounds on the curvature are out of date
            renewal = iteration + 1
        too_far = np.min(2 * a_new - ax, axis=0) < _LEAST_AHEAD
        ahead = np.where(rose | uphill | too_far, 0, 1).astype(B.dtype)
        ax, ay = a_new, a_new + ahead * (a_new - ax)
        history.append(float(np.sum(objective)))
        progress = Progress(iteration, iterations, x, ax, history[-1], screen.powers(lamp))
        if callback is not None and callback(progress):
            stop_reason = "callback"
            break
        if _has_converged(history, enough):
            stop_reason = "converged"
            break
    bound = screen.lower_bound(A, ax, lamp, slopes, (lower, upper))
    return Result(x, screen.powers(lamp), np.array(history), stop_reason=stop_reason, lower_bound=bound)


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

    def lower_bound(
        self, A: Operator, ax: Floats, lamp: NDArray[np.float64], slopes: Floats, bounds: tuple[float, float]
    ) -> float:
        """A number that the objective cannot fall below, by duality from the derivatives at `ax`; at least 0.

        For any s, the objective is at least ``min over lamps of s.lnP + min over x of -(A's).x - sum of conjugates``
        (R. T. Rockafellar, Convex Analysis, 1970, section 31).
        """
        lower, upper = bounds
        if lower == -np.inf:
            return 0.0
        self.descend(ax, lamp, slopes)
        pull = -slopes
        if upper == np.inf:
            self._make_feasible(A, pull)
        back = A.adjoint(pull).astype(np.float64)
        least_x = -lower * np.sum(np.minimum(back, 0))
        if upper < np.inf:
            least_x -= upper * np.sum(np.maximum(back, 0))
        per_view = np.zeros((len(self.low), ax.shape[1]))
        np.add.at(per_view, self.views, pull)
        per_lamp = per_view.reshape(len(self.low), -1, self.low.shape[1]).sum(axis=1)
        least = float(least_x + np.sum(np.minimum(per_lamp * self.low, per_lamp * self.high)))
        return max(0.0, *(part * least - self._conjugates(part * pull) for part in (1.0, 0.85, 0.7, 0.5, 0.3)))

    def _make_feasible(self, A: Operator, pull: Floats) -> None:
        """Lower `pull`, along the beams through the unknowns where ``A'pull`` is above 0, until it is nowhere."""
        rising = np.maximum(A.adjoint(pull), 0)
        heard = (self.weights > 0).astype(pull.dtype)
        reach = A.adjoint(heard)
        beams = A.forward(np.divide(rising, reach, out=np.zeros_like(rising), where=reach > 0) ** 2)
        mean = np.mean(beams, axis=0)
        # Part along those beams and part along all: of the mixtures tried, the one with the best bounds.
        beams = heard * (beams / np.where(mean > 0, mean, 1) + pull.dtype.type(0.3))
        back = A.adjoint(beams)
        lowered = np.max(np.divide(rising, back, out=np.zeros_like(rising), where=back > 0), axis=0)
        pull -= (1 + 1e-5) * lowered * beams

    def _conjugates(self, pull: Floats) -> float:
        return float(np.sum(display.conjugates(pull, self.wanted, self.weights, self.srgb)))

    def curvatures(self, ax: Floats, lamp: NDArray[np.float64], out: Floats) -> Floats:
        """Write to `out`, and return, bounds on the curvature of each entry's term."""
        display.curvatures(ax, lamp.astype(ax.dtype), self.views, self.wanted, self.weights, self.srgb, _ROOM, out)
        return out


def _expected_change(x: Floats) -> Floats:
    """How far each unknown is expected to move, relative to the others of its column; above 0."""
    mean = np.mean(np.abs(x), axis=0, keepdims=True)
    return np.abs(x) + np.where(mean > 0, _EXPECTED * mean, 1).astype(x.dtype)


def _has_converged(history: list[float], enough: float) -> bool:
    if history[-1] <= enough:
        return True
    if len(history) <= _PATIENCE:
        return False
    return abs(history[-1 - _PATIENCE] - history[-1]) <= _TOLERANCE * history[-1]
