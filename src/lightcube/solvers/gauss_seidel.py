"""The paper's adapted Gauss-Seidel: one beam after the other, inconsistent beams thrown out."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from lightcube.kernels.row_action import sweep
from lightcube.optics.arrays import locked
from lightcube.solvers._absorbance import half_level
from lightcube.solvers._checks import LinearProblem, check_iterations, check_state, linear_problem
from lightcube.solvers._momentum import run_ahead
from lightcube.solvers.contract import Bounds, Callback, Floats, Operator, Progress, Result, State, Wanted

#: A column has settled once a sweep changes it by at most this part of its largest number.
_SETTLED = {np.dtype(np.float32): 1e-6, np.dtype(np.float64): 1e-12}
#: A column is stuck after so many sweeps in which its disagreement has not shrunk by this factor.
_PATIENCE, _SHRINKS = 5, 0.8
#: Sweeps of halved relaxation that then lead it towards the point of least squares.
_CALMING = 4
#: Equations that disagree by at least this part of the worst are thrown out together.
_BATCH = 0.6


def gauss_seidel(
    A: Operator,
    wanted: Wanted,
    *,
    x0: Floats | None = None,
    bounds: Bounds = (0.0, np.inf),
    iterations: int = 100,
    callback: Callback | None = None,
    state: State | None = None,
) -> Result:
    """Solve ``A x = b``, ``b = ln P - ln light``, by row actions within the bounds, throwing out what is inconsistent.

    The parameters are those of `lightcube.solvers.contract.Solver`; an iteration is a sweep over all equations,
    and the lamp powers must be fixed. The row action of beam ``a`` is ``x <- clip(x + a (b - a x) / |a|^2)``, as in
    Kaczmarz's form of Gauss-Seidel; a sweep takes the beams in a random order, the same in every run and sweep.
    Between sweeps each column runs ahead along its last change (Nesterov's momentum), unless its residual has grown.
    Equations of weight 0 are absent; other weights matter only where equations disagree.

    Which equations are thrown out, in each column by itself:

    1. Two values agree within half a display level as absorbance (`half_level`).
    2. An equation that no ``x`` within the bounds satisfies is thrown out at once: a pixel brighter than the lamp,
       or a shadow where the beam misses the cube.
    3. Where the norm of the disagreement has not shrunk to 0.8 within 5 sweeps, four sweeps of relaxation 1/2, 1/4,
       1/8 and 1/16 lead towards the point of least squares. Then go the equations with the largest ``|b - a x|``
       divided by their weight, and with them all that disagree at least 0.6 times as much.
    4. As soon as the rest is consistent, every equation thrown out under 3 that agrees within half the tolerance
       after all is taken back.

    Pictures that are inconsistent everywhere thus lose equations every nine sweeps, until the rest is consistent or the
    sweeps are used up.

    Returns
    -------
    `Result` with the equations thrown out, and as `undetermined` the voxels that no remaining equation contains:
    they are 0 (or the bound next to it), fully transparent. `residuals` are the 2-norm of ``b - A x`` over the
    equations that remain. It stops as ``"converged"`` once all of them agree and a sweep changes no column by more
    than 1e-12 (float32: 1e-6) of its largest number.

    References
    ----------
    S. Kaczmarz, Bull. Acad. Polon. Sci. A35 (1937); Y. Censor, SIAM Review 23 (1981), for relaxation and least squares.
    """
    problem = linear_problem("gauss-seidel", A, wanted, x0, bounds)
    iterations = check_iterations(iterations)
    x, dtype = problem.x, problem.x.dtype
    rows = _Rows.of(A, dtype)
    judge = _Judge(problem, rows, half_level(wanted.light, wanted.transfer))
    limits: tuple[Any, Any] = problem.lower, dtype.type(problem.upper)
    start, settled = x, False
    residuals: list[float] = []
    if state is not None:
        unknowns = dict.fromkeys(("x", "start"), (x.shape, dtype))
        kept = check_state(state, iterations, {**unknowns, **judge.needed, "settled": ((), np.bool_)})
        judge.go_on(kept)
        x, start, settled = kept["x"], kept["start"], bool(kept["settled"])
        residuals = kept["history"].tolist()

    def keep() -> State:
        arrays = {"x": x, "start": start, "settled": np.array(settled), "history": np.array(residuals)}
        return {**arrays, **judge.arrays()}

    asked = False
    while not (asked or settled or len(residuals) == iterations):
        before, x = x, start.copy()
        relaxation = judge.relaxation.astype(dtype)
        sweep(*rows.csr, rows.inverse_norms, rows.order, problem.b, judge.active, relaxation, *limits, x)
        ax = A.forward(x)
        difference = np.abs(problem.b - ax)
        residuals.append(float(np.linalg.norm(difference[judge.active])))
        changed = judge.look(difference)
        still = np.max(np.abs(x - start), axis=0) <= _SETTLED[dtype] * np.max(np.abs(x), axis=0)
        settled = not changed and bool(np.all(still & judge.agrees))
        start = np.clip(x + judge.ahead.astype(dtype) * (x - before), *limits)
        asked = callback is not None and bool(
            callback(Progress(len(residuals), iterations, x, ax, residuals[-1], problem.lamp_powers, keep))
        )
    reason = "callback" if asked else "converged" if settled else "iterations"
    undetermined = A.adjoint(judge.active.astype(dtype)) == 0
    x = np.where(undetermined, np.clip(dtype.type(0), *limits), x)
    return Result(
        locked(x), problem.lamp_powers, np.array(residuals), np.argwhere(judge.rejected), locked(undetermined), reason
    )


#: The method as the table has it; how many arrays it holds is measured.
@dataclass(frozen=True)
class _Rows:
    """The matrix as the sweep takes it."""

    csr: tuple[NDArray[np.integer[Any]], NDArray[np.integer[Any]], Floats]
    inverse_norms: Floats
    sums: Floats
    order: NDArray[np.intp]

    @classmethod
    def of(cls, A: Operator, dtype: np.dtype[np.floating[Any]]) -> "_Rows":
        matrix = A.to_sparse()
        norms = np.asarray(matrix.multiply(matrix).sum(axis=1)).ravel()
        return cls(
            csr=(matrix.indptr, matrix.indices, matrix.data.astype(dtype)),
            inverse_norms=np.divide(1, norms, out=np.zeros_like(norms), where=norms > 0).astype(dtype),
            sums=np.asarray(matrix.sum(axis=1), dtype=np.float64).ravel(),
            # Neighbouring rows are nearly parallel, and momentum needs an order without rhythm.
            order=np.random.default_rng(0).permutation(len(norms)),
        )


class _Judge:
    """Which equations take part, and how far each column has come (rules 1 to 4 of `gauss_seidel`)."""

    def __init__(self, problem: LinearProblem, rows: _Rows, tolerance: Floats) -> None:
        present = problem.weights > 0
        with np.errstate(invalid="ignore"):  # a beam that misses the cube times an infinite bound
            least, most = (np.nan_to_num(rows.sums[:, None] * bound) for bound in (problem.lower, problem.upper))
        self._impossible = present & ((problem.b < least - tolerance) | (problem.b > most + tolerance))
        self._present, self._tolerance = present, tolerance
        self._importance = np.where(present, problem.weights, 1)
        self.active = present & ~self._impossible
        columns = problem.b.shape[1]
        self.agrees = np.zeros(columns, np.bool_)
        self._reference = np.full(columns, np.inf)
        self._age = np.zeros(columns, np.int64)
        self._residual = np.full(columns, np.inf, problem.b.dtype)
        self._momentum = np.ones(columns)
        #: How far each column's next sweep starts ahead, as a part of its last change.
        self.ahead = np.zeros(columns)

    @property
    def needed(self) -> dict[str, tuple[tuple[int, ...], DTypeLike]]:
        """Shapes and dtypes of `arrays`."""
        return {name: (array.shape, array.dtype) for name, array in self.arrays().items()}

    def arrays(self) -> dict[str, NDArray[Any]]:
        """All that changes from sweep to sweep and is not found anew."""
        return {
            "active": self.active,
            "reference": self._reference,
            "age": self._age,
            "residual": self._residual,
            "momentum": self._momentum,
        }

    def go_on(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take what `arrays` gave."""
        self.active, self._reference, self._age = arrays["active"], arrays["reference"], arrays["age"]
        self._residual, self._momentum = arrays["residual"], arrays["momentum"]

    @property
    def rejected(self) -> NDArray[np.bool_]:
        """The equations that were thrown out, ``(equations, columns)``."""
        return self._present & ~self.active

    @property
    def relaxation(self) -> Floats:
        """Of each column's next sweep."""
        return 0.5 ** np.maximum(self._age - _PATIENCE + 1, 0)

    def look(self, difference: Floats) -> bool:
        """Take ``|b - A x|`` after a sweep, reject and take back equations; True where any was."""
        bad = self.active & (difference > self._tolerance)
        self.agrees = ~np.any(bad, axis=0)
        disagreement = np.linalg.norm(np.where(bad, difference, 0), axis=0)
        shrinks = self.agrees | (disagreement < _SHRINKS * self._reference)
        self._reference = np.where(shrinks, disagreement, self._reference)
        self._age = np.where(shrinks, 0, self._age + 1)

        cause = np.where(bad, difference / self._importance, 0)
        out = bad & (self._age >= _PATIENCE + _CALMING) & (cause >= _BATCH * cause.max(axis=0))
        back = self.rejected & ~self._impossible & self.agrees & (difference <= 0.5 * self._tolerance)
        self.active = (self.active & ~out) | back
        touched = np.any(out | back, axis=0)
        self._reference[touched], self._age[touched] = np.inf, 0

        residual = np.linalg.norm(np.where(self.active, difference, 0), axis=0)
        restart = touched | (self._age >= _PATIENCE) | (residual > self._residual)
        self.ahead, self._momentum = run_ahead(self._momentum, restart)
        self._residual = residual
        return bool(np.any(touched))
