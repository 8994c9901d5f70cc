"""What the eye sees: least squares in display values, made convex.

With ``u = ln P - A x`` the ln of the light on the goal, ``u*`` the wanted one and ``g`` the display value as a
function of ``u``, the residual is ``g(u) - g(u*)`` where a beam is too bright, and its tangent ``g'(u*) (u - u*)``,
of slope at least 0.03, where it is too dark. Display values alone would leave a beam that became much too dark
without a gradient, a black speck for ever; logarithms alone would spend everything on darks that nobody can
tell apart. The square of the two-sided residual is convex in ``(x, ln P)`` but for a negligible kink at the toe of
the curve.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from lightcube.kernels import descent, momentum
from lightcube.kernels.layout import copied, empty
from lightcube.optics.arrays import locked
from lightcube.solvers._checks import check_bounds, check_fits, check_iterations, check_start, check_state
from lightcube.solvers._convex import ConvexObjective
from lightcube.solvers._objective import Objective
from lightcube.solvers.contract import Bounds, Callback, Floats, Operator, Progress, Result, State, Wanted

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
    wanted: Wanted,
    *,
    x0: Floats | None = None,
    bounds: Bounds = (0.0, np.inf),
    iterations: int = 200,
    callback: Callback | None = None,
    state: State | None = None,
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
    A, wanted, x0, bounds, iterations, callback, state
        As in `lightcube.solvers.contract.Solver`.

    Returns
    -------
    `Result` with ``residuals`` = the objective after each iteration, each of which is one pass, and
    ``lower_bound``, below which no `x` and no lamp can bring the objective (three passes).

    Notes
    -----
    Where views add up the ln light is that of a sum, ``u = ln sum_v P_v (1 - a_v (1 - e^-(A x)_v))``: the objective is
    no longer convex, and no lower bound is known. Views under one lamp act as one view of their joint absorbance
    (`lightcube.kernels.joint`), whose lamp is found as exactly as any; where several lamps shine on a picture, theirs
    are found by bounded Newton steps, a few in each pass. All else is the same, with curvatures that bound those of the
    sum (`lightcube.kernels.objective`).

    References
    ----------
    A. De Pierro, A modified expectation maximization algorithm for penalized likelihood estimation in emission
    tomography, IEEE Trans. Med. Imaging 14 (1995) 132-137, for majorisers with such weights.
    A. Beck, M. Teboulle, A fast iterative shrinkage-thresholding algorithm, SIAM J. Imaging Sci. 2 (2009) 183-202.
    J. Liang, T. Luo, C.-B. Schönlieb, Improving "fast iterative shrinkage-thresholding algorithm": faster, smarter,
    and greedier, SIAM J. Sci. Comput. 44 (2022) A1069-A1091, for momentum and stride.
    G. Golub, V. Pereyra, Separable nonlinear least squares, Inverse Problems 19 (2003) R1-R26, for the lamp.
    """
    check_fits(A, wanted)
    mixture = wanted.lighting.mixture
    goal = ConvexObjective.of(wanted) if mixture is None else Objective.of(wanted, mixture)
    iterations = check_iterations(iterations)
    shape, dtype = (A.shape[1], wanted.light.shape[1]), wanted.light.dtype
    lower, upper = bounds = check_bounds(bounds, shape[1])
    limits: tuple[Any, ...] = (lower, dtype.type(upper))
    if state is None:
        at = _State.first(check_start(x0, shape, bounds, dtype), goal.low, goal.high)
    else:
        at = _State.kept(state, iterations, shape, dtype, goal.low.shape)
    ax = A.forward(at.x)
    ay = A.forward(at.before) if np.any(at.ahead) else copied(ax)
    momentum.run_ahead(ay, ax, at.ahead)
    if state is None:
        at.lamp = goal.best_lamp(goal.joint(ay), at.lamp)
    enough = _PERFECT * float(np.sum(goal.weights, dtype=np.float64))
    stop_reason = at.stop_reason(iterations, enough)
    while not stop_reason:
        joint = goal.joint(ay)
        if np.any(at.ahead):  # else these are the lamps already
            at.lamp = goal.best_lamp(joint, at.lamp)
        if at.iteration + 1 == at.renewal:
            at.renew(A, goal, ay, joint)
        slopes = goal.descend(ay, joint, at.lamp)
        uphill = descent.step(at.x, at.before, at.ahead, A.adjoint(slopes), at.steps, at.stride, *limits) > 0
        del ay, slopes, joint  # make room
        at.x, at.before = at.before, at.x
        a_new = A.forward(at.x)
        joint = goal.joint(a_new)
        at.lamp = goal.best_lamp(joint, at.lamp)
        objective, least = goal.arrive(ax, a_new, joint, at.lamp)
        del joint
        at.judge(objective, uphill, least)
        momentum.run_ahead(ax, a_new, at.ahead)
        ax, ay = a_new, ax
        asked = callback is not None and callback(
            Progress(at.iteration, iterations, at.x, ax, at.history[-1], goal.powers(at.lamp), at.arrays)
        )
        stop_reason = "callback" if asked else at.stop_reason(iterations, enough)
    x, lamp, history = at.x, at.lamp, np.array(at.history)
    del at, ay  # make room
    bound = goal.lower_bound(A, ax, lamp, bounds)
    return Result(locked(x), goal.powers(lamp), history, stop_reason=stop_reason, lower_bound=bound)


#: The method as the table has it; how many arrays it holds is measured.
@dataclass
class _State:
    """What iterates: from this, and nothing else, the solver can go on."""

    #: ``(unknowns, columns)``: the last point, the one before it, and how far a slope of 1 moves each unknown.
    x: Floats
    before: Floats
    steps: Floats
    #: ``(columns,)``: how much longer the steps are, how much of the last change to run ahead, and what was reached.
    stride: Floats
    ahead: Floats
    objective: NDArray[np.float64]
    #: ln P, ``(lamps, channels)``.
    lamp: NDArray[np.float64]
    #: The objective of all columns after each iteration.
    history: list[float]
    #: In which iteration the metric is renewed.
    renewal: int

    @classmethod
    def first(cls, x: Floats, low: NDArray[np.float64], high: NDArray[np.float64]) -> "_State":
        """Before the first iteration; `low` and `high` bound ln P."""
        columns = x.shape[1]
        return cls(
            x=x,
            before=copied(x),
            steps=empty(x.shape, x.dtype),
            stride=np.full(columns, _STRIDE, x.dtype),
            ahead=np.zeros(columns, x.dtype),
            objective=np.full(columns, np.inf),
            lamp=np.clip(np.zeros_like(low), low, high),
            history=[],
            renewal=1,
        )

    @classmethod
    def kept(
        cls, state: State, iterations: int, shape: tuple[int, int], dtype: np.dtype[Any], lamps: tuple[int, ...]
    ) -> "_State":
        """From what `arrays` gave, or raise `InputError`."""
        per_column = (shape[1],)
        needed: dict[str, tuple[tuple[int, ...], DTypeLike]] = {
            **dict.fromkeys(("x", "before", "steps"), (shape, dtype)),
            **dict.fromkeys(("stride", "ahead"), (per_column, dtype)),
            "objective": (per_column, np.float64),
            "lamp": (lamps, np.float64),
            "renewal": ((), np.int64),
        }
        arrays: dict[str, Any] = check_state(state, iterations, needed)
        return cls(**{**arrays, "history": arrays["history"].tolist(), "renewal": int(arrays["renewal"])})

    def arrays(self) -> State:
        """All of it as arrays, none of them a copy."""
        return {**vars(self), "history": np.array(self.history), "renewal": np.array(self.renewal, np.int64)}

    @property
    def iteration(self) -> int:
        """How many are done."""
        return len(self.history)

    def renew(self, A: Operator, goal: ConvexObjective | Objective, ay: Floats, joint: Floats) -> None:
        """Take the metric of where the solver stands now."""
        expected = self.steps
        descent.expect(self.x, _EXPECTED, expected)
        self.steps = A.adjoint(goal.curved(A.forward(expected), ay, joint, self.lamp))
        descent.divide(expected, self.steps)
        self.renewal = int((self.iteration + 1) * _RENEWAL) + 1

    def judge(self, objective: NDArray[np.float64], uphill: NDArray[np.bool_], least: NDArray[np.float64]) -> None:
        """End an iteration that reached `objective`: which columns start anew, and with what stride.

        `least` is the least absorbance that each column's momentum leads to.
        """
        rose = objective > self.objective
        self.stride[rose] = np.maximum(1, _CAUTION * self.stride[rose])
        self.history.append(float(np.sum(objective)))
        if np.any(rose & (self.ahead == 0)):  # not for the momentum: the bounds on the curvature are out of date
            self.renewal = self.iteration + 1
        self.ahead = np.where(rose | uphill | (least < _LEAST_AHEAD), 0, 1).astype(self.ahead.dtype)
        self.objective = objective

    def stop_reason(self, iterations: int, enough: float) -> str:
        """Why to stop here, or nothing."""
        if self.history and _has_converged(self.history, enough):
            return "converged"
        return "iterations" if self.iteration >= iterations else ""


def _has_converged(history: list[float], enough: float) -> bool:
    if history[-1] <= enough:
        return True
    if len(history) <= _PATIENCE:
        return False
    return abs(history[-1 - _PATIENCE] - history[-1]) <= _TOLERANCE * history[-1]
