"""What a solver is given, checked once, with sentences for what cannot be used."""

import operator
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from lightcube.errors import InputError
from lightcube.kernels.layout import copied
from lightcube.solvers.contract import Bounds, Floats, Operator, State, Wanted
from lightcube.wording import counted


@dataclass(frozen=True)
class LinearProblem:
    """``A x = b`` within bounds, as methods that work on logarithms see it; all in the dtype of the light wanted."""

    #: ``(equations, columns)``, absorbance wanted.
    b: Floats
    #: ``(equations, columns)``, a read-only view where it was broadcast.
    weights: Floats
    #: ``(unknowns, columns)``, where to start: the solver's own array, within the bounds.
    x: Floats
    #: ``(columns,)``.
    lower: Floats
    upper: float
    #: ``(lamps, channels)``.
    lamp_powers: Floats


def check_fits(A: Operator, wanted: Wanted) -> None:
    """Raise `InputError` unless `wanted` is of as many equations as `A` has."""
    if wanted.equations != A.shape[0]:
        views, pictures = len(wanted.lighting.lamp), wanted.lighting.pictures
        raise InputError(
            f"light of shape {wanted.light.shape} in {counted(pictures, 'picture')} of {counted(views, 'view')} is of "
            f"{wanted.equations} equations, but the matrix is of shape {A.shape}: give it a row for each equation"
        )


def check_bounds(bounds: Bounds, columns: int) -> Bounds:
    """Return the bounds of `x`, or raise `InputError` unless there is a number between them in each of its columns."""
    least, upper = np.asarray(bounds[0], np.float64), float(bounds[1])
    if least.shape not in ((), (columns,)):
        raise InputError(f"lower bounds are one number, or one of each of the {columns} columns, not {least.shape}")
    if not (np.all(least <= upper) and np.all(least < np.inf) and upper > -np.inf):  # also refuses NaN
        raise InputError(f"bounds must be a lower bound and an upper bound that is not less, not ({least}, {upper})")
    return (least if least.ndim else float(least)), upper


def check_start(x0: Floats | None, shape: tuple[int, int], bounds: Bounds, dtype: np.dtype[np.floating[Any]]) -> Floats:
    """Return a fresh start of `shape` and `dtype` within `bounds` from `x0` (None = all 0), or raise `InputError`."""
    given = np.broadcast_to(dtype.type(0), shape) if x0 is None else np.asarray(x0)
    if given.shape != shape or not np.all(np.isfinite(given)):
        raise InputError(f"x0 must be finite numbers of shape {shape} (unknowns, columns), not {given.shape}")
    start = copied(given, dtype)
    return np.clip(start, *bounds, out=start)


def check_iterations(iterations: int) -> int:
    """Return `iterations`, or raise `InputError` unless it is a whole number of at least 1."""
    try:
        count = operator.index(iterations)
    except TypeError as error:
        raise InputError(f"iterations must be a whole number, not {iterations!r}") from error
    if count < 1:
        raise InputError(f"iterations must be at least 1, not {count}")
    return count


def check_state(
    state: State, iterations: int, needed: Mapping[str, tuple[tuple[int, ...], DTypeLike]]
) -> dict[str, NDArray[Any]]:
    """Return copies of the arrays of `state` that are `needed`, and its history, or raise `InputError`.

    Parameters
    ----------
    state
        As in `lightcube.solvers.contract.Solver`.
    iterations
        The history may be as long as this.
    needed
        Shape and dtype by name, the history left out.
    """
    names = ("history", *needed)
    for name in names:
        if name not in state:
            raise InputError(f"the state to continue from lacks {name!r}: it is another method's, start anew")
    copies = {name: copied(state[name]) for name in names}
    for name, (shape, kind) in {"history": ((copies["history"].size,), np.float64), **needed}.items():
        found, dtype = copies[name], np.dtype(kind)
        if (found.shape, found.dtype) != (shape, dtype):
            raise InputError(
                f"the state to continue from has {name!r} as {found.dtype} of shape {found.shape}, but this problem "
                f"needs {dtype} of shape {shape}: it is another problem's, start anew"
            )
    if not 1 <= len(copies["history"]) <= iterations:
        raise InputError(
            f"the state to continue from is that after {len(copies['history'])} iterations, "
            f"but this is to be a run of {iterations}: ask for at least as many"
        )
    return copies


def linear_problem(method: str, A: Operator, wanted: Wanted, x0: Floats | None, bounds: Bounds) -> LinearProblem:
    """Check what `method` was given and take logarithms; `InputError` names what cannot be used.

    The parameters are those of `lightcube.solvers.contract.Solver`.
    """
    if wanted.lighting.mixture is not None or wanted.lighting.loss is not None:
        raise InputError(f"method {method} takes logarithms, and light that adds up has none: use method display")
    check_fits(A, wanted)
    if not wanted.has_fixed_lamps:
        raise InputError(f"method {method} cannot choose lamp powers: fix them, or use method display")
    lower, upper = check_bounds(bounds, wanted.light.shape[1])
    return LinearProblem(
        b=np.ascontiguousarray(wanted.absorbance()),
        weights=wanted.weights,
        x=check_start(x0, (A.shape[1], wanted.light.shape[1]), (lower, upper), wanted.light.dtype),
        lower=np.full(wanted.light.shape[1], lower, wanted.light.dtype),
        upper=upper,
        lamp_powers=wanted.lamp_bounds[0],
    )
