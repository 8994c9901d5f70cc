"""What a solver is given, checked once, with sentences for what cannot be used."""

import operator
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from lightcube.errors import InputError
from lightcube.kernels.layout import copied
from lightcube.solvers._absorbance import absorbance_wanted
from lightcube.solvers.contract import Floats, Mixture, Operator, State


@dataclass(frozen=True)
class LinearProblem:
    """``A x = b`` within bounds, as the methods that work on logarithms see it; all in the dtype of `B`."""

    #: ``(equations, columns)``, absorbance wanted.
    b: Floats
    #: ``(equations, columns)``, a read-only view where it was broadcast.
    weights: Floats
    #: ``(unknowns, columns)``, where to start: the solver's own array, within the bounds.
    x: Floats
    lower: float
    upper: float
    #: ``(views, channels)``.
    lamp_powers: Floats


def check_shapes(A: Operator, B: Floats) -> None:
    """Raise `InputError` unless `B` is a float matrix with as many rows as `A`."""
    if B.ndim != 2 or B.shape[0] != A.shape[0] or B.shape[1] == 0:
        raise InputError(f"B must have shape ({A.shape[0]}, columns) for a matrix of shape {A.shape}, not {B.shape}")
    if B.dtype not in (np.float32, np.float64):
        raise InputError(f"B must be float32 or float64, not {B.dtype}")


def check_weights(weights: Floats | None, B: Floats) -> Floats:
    """Return `weights` in the shape and dtype of `B` (None = all 1), finite and at least 0, else raise `InputError`."""
    given = np.asarray(1.0 if weights is None else weights)
    try:
        whole = np.broadcast_to(given.astype(B.dtype, copy=False), B.shape)
    except ValueError as error:
        raise InputError(f"weights of shape {given.shape} do not fit B of shape {B.shape}") from error
    if not np.all(np.isfinite(given)) or np.any(given < 0):
        raise InputError("weights must be finite and at least 0: use 0 for don't care")
    return whole


def check_views(view_of_row: NDArray[np.integer[Any]] | None, equations: int) -> int:
    """Return how many views `view_of_row` names (None: one), or raise `InputError`."""
    if view_of_row is None:
        return 1
    if view_of_row.shape != (equations,) or not np.issubdtype(view_of_row.dtype, np.integer):
        raise InputError(
            f"view_of_row must be {equations} whole numbers, one per equation, "
            f"not {view_of_row.dtype} of shape {view_of_row.shape}"
        )
    if view_of_row.min() < 0:
        raise InputError(f"view_of_row must count views from 0, not from {view_of_row.min()}")
    return int(view_of_row.max()) + 1


def check_bounds(bounds: tuple[float, float]) -> tuple[float, float]:
    """Return the bounds of `x` as floats, or raise `InputError` unless there is a number between them."""
    lower, upper = (float(bound) for bound in bounds)
    if not (lower <= upper and lower < np.inf and upper > -np.inf):  # also refuses NaN
        raise InputError(f"bounds must be a lower bound and an upper bound that is not less, not ({lower}, {upper})")
    return lower, upper


def check_lamp(
    lamp_bounds: tuple[Floats, Floats] | None, views: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the bounds of the lamp powers as float64 ``(views, channels)`` (None = power 1), or raise `InputError`."""
    if lamp_bounds is None:
        return np.ones((views, 1)), np.ones((views, 1))
    low, high = (np.asarray(bound, dtype=np.float64) for bound in lamp_bounds)
    for powers in (low, high):
        if powers.ndim != 2 or powers.shape != low.shape or not np.all(np.isfinite(powers)) or np.any(powers <= 0):
            raise InputError("lamp powers must be positive and finite, in an array of shape (views, channels)")
    if len(low) < views:
        raise InputError(f"view_of_row names {views} views, but there are lamp powers for {len(low)}")
    if np.any(low > high):
        raise InputError("a lower bound of the lamp powers is above the upper one: swap them")
    return low, high


def check_start(
    x0: Floats | None, shape: tuple[int, int], bounds: tuple[float, float], dtype: np.dtype[np.floating[Any]]
) -> Floats:
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


def linear_problem(
    method: str,
    A: Operator,
    B: Floats,
    weights: Floats | None,
    view_of_row: NDArray[np.integer[Any]] | None,
    lamp_bounds: tuple[Floats, Floats] | None,
    x0: Floats | None,
    bounds: tuple[float, float],
    mixture: Mixture | None = None,
) -> LinearProblem:
    """Check what `method` was given and take logarithms; `InputError` names what cannot be used.

    The parameters are those of `lightcube.solvers.contract.Solver`.
    """
    if mixture is not None:
        raise InputError(f"method {method} takes logarithms, and light that adds up has none: use method display")
    check_shapes(A, B)
    views = check_views(view_of_row, A.shape[0])
    lamp_powers, strongest = check_lamp(lamp_bounds, views)
    if not np.array_equal(lamp_powers, strongest):
        raise InputError(f"method {method} cannot choose lamp powers: fix them, or use method display")
    lower, upper = check_bounds(bounds)
    return LinearProblem(
        b=np.ascontiguousarray(absorbance_wanted(B, lamp_powers, view_of_row)),
        weights=check_weights(weights, B),
        x=check_start(x0, (A.shape[1], B.shape[1]), (lower, upper), B.dtype),
        lower=lower,
        upper=upper,
        lamp_powers=lamp_powers,
    )
