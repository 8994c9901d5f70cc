"""What every solver takes and returns."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol, get_args

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.optics.absorption import absorbance
from lightcube.optics.arrays import Counts, Flags, Integers, Reals, keep
from lightcube.optics.checks import check_fields
from lightcube.optics.law import Mixture, within
from lightcube.optics.transfer import Transfer
from lightcube.wording import counted

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Floats = NDArray[np.floating[Any]]
#: Everything that a stopped solver needs to go on, beside what it was called with: plain arrays by name.
State = Mapping[str, NDArray[Any]]
#: Lower and upper bound of `x`; the lower one is a number, or one of each column, ``(columns,)``.
Bounds = tuple[float | NDArray[np.float64], float]


class Operator(Protocol):
    """The matrix A as solvers see it: ``B = A X`` for blocks of columns, which are independent of each other.

    Products are new arrays, which the solver may overwrite, and the same to the last bit whenever they are taken.
    """

    @property
    def shape(self) -> tuple[int, int]:
        """``(equations, unknowns)`` of one column."""

    def forward(self, x: Floats) -> Floats:
        """``A @ x`` for `x` of shape ``(unknowns, columns)``, in its dtype."""

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b`` for `b` of shape ``(equations, columns)``, in its dtype: the exact transpose of `forward`."""

    def to_sparse(self) -> csr_array:
        """The same matrix, float64, for methods that need single rows."""


@dataclass(frozen=True, eq=False)
class Lighting:
    """Which lamp shines in each view, and how views add up to pictures.

    The equations of a view follow each other, and each view has as many.

    Parameters
    ----------
    lamp
        ``(views,)`` whole numbers from 0: which of the lamps each view has.
    mixture
        How views add up; None where each one is a picture, under all of its lamp's light, or a known part of it.
    loss
        ``(equations, 1)``: absorbance that each pixel's light has beside the cube's, where views do not add up: minus
        the logarithm of that part. None = none. Only method display minds it.

    Raises
    ------
    InputError
        Where these are not whole numbers, or not of the same views.
    """

    lamp: NDArray[np.integer[Any]]
    mixture: Mixture | None = None
    loss: Floats | None = None

    def __post_init__(self) -> None:
        if self.loss is not None and (self.mixture is not None or not np.all(np.isfinite(self.loss))):
            raise InputError("a loss is finite, and of light that does not add up: leave one of the two out")
        if self.lamp.ndim != 1 or self.lamp.size == 0 or not np.issubdtype(self.lamp.dtype, np.integer):
            raise InputError(
                f"lamps must be whole numbers, one per view, not {self.lamp.dtype} of shape {self.lamp.shape}"
            )
        if self.lamp.min() < 0:
            raise InputError(f"lamps must count from 0, not from {self.lamp.min()}")
        if self.mixture is not None and len(self.mixture.light) != len(self.lamp):
            lit = counted(len(self.lamp), "view")
            raise InputError(
                f"lamps are named of {lit}, but {len(self.mixture.light)} add up to pictures: name as many"
            )

    @property
    def lamps(self) -> int:
        """How many lamps are named."""
        return int(self.lamp.max()) + 1

    @property
    def pictures(self) -> int:
        """How many pictures the views make."""
        return len(self.lamp if self.mixture is None else self.mixture.starts[1:])

    def lamp_of_row(self, equations: int) -> Counts:
        """``(equations,)``: the lamp of each of all views' equations."""
        return np.repeat(self.lamp.astype(np.intp, copy=False), equations // len(self.lamp))


@dataclass(frozen=True, eq=False, init=False)
class Wanted:
    """What a solver is to reach: light on the screen, how much each pixel counts, and the lamps there are.

    Parameters
    ----------
    light
        What the screen shall show, linear light above 0, float32 or float64: ``(equations, columns)``, or where views
        add up as many rows as one view has for each picture. The colour channel of column ``j`` is ``j % channels``.
    weights
        At least 0, broadcastable to `light`, and then of its shape and dtype; 0 = don't care; None = all 1.
    lighting
        Lamps and sums of the views; None = a single view.
    lamp_bounds
        Lower and upper bound of the lamps' powers, each ``(lamps, channels)``; equal where a lamp is fixed.
        None = one channel, power 1.
    transfer
        How display values follow from light, for methods that reckon in display levels.

    Raises
    ------
    InputError
        Where these do not fit together, or are out of range.
    """

    light: Floats
    weights: Floats
    lighting: Lighting
    lamp_bounds: tuple[Reals, Reals]
    transfer: Transfer

    def __init__(
        self,
        light: Floats,
        weights: Floats | None = None,
        lighting: Lighting | None = None,
        lamp_bounds: tuple[Floats, Floats] | None = None,
        transfer: Transfer = "srgb",
    ) -> None:
        views = Lighting(np.zeros(1, np.intp)) if lighting is None else lighting
        _check_light(light, views)
        if transfer not in get_args(Transfer):
            raise InputError(f"unknown transfer {transfer!r}: use one of {', '.join(get_args(Transfer))}")
        powers = _lamp_bounds(lamp_bounds, views)
        _check_mixture(views, light, powers[0].shape[1])
        given = {"light": light, "weights": _weights(weights, light), "lighting": views, "lamp_bounds": powers}
        for name, value in (given | {"transfer": transfer}).items():
            object.__setattr__(self, name, value)

    @property
    def channels(self) -> int:
        """Colours: column ``j`` is of the colour ``j % channels``."""
        return self.lamp_bounds[0].shape[1]

    @property
    def equations(self) -> int:
        """How many rows the matrix has of all views."""
        return len(self.light) // self.lighting.pictures * len(self.lighting.lamp)

    @property
    def has_fixed_lamps(self) -> bool:
        """Whether no lamp's power is left to choose."""
        return np.array_equal(*self.lamp_bounds)

    def absorbance(self) -> Floats:
        """``ln P - ln light``, ``(equations, columns)``, of pictures of one view each under lamps that are fixed.

        Negative where more light is wanted than the lamp has.
        """
        powers = self.lamp_bounds[1][self.lighting.lamp_of_row(len(self.light))]
        lamp = powers[:, np.arange(self.light.shape[1]) % self.channels]
        return absorbance(self.light / lamp.astype(self.light.dtype))


def _check_light(light: Floats, lighting: Lighting) -> None:
    if light.ndim != 2 or light.size == 0 or light.dtype not in (np.float32, np.float64):
        raise InputError(
            f"the light wanted must be float32 or float64 of shape (equations, columns), not {light.dtype} of shape "
            f"{light.shape}"
        )
    if len(light) % lighting.pictures:
        raise InputError(f"light of {len(light)} rows does not fit {lighting.pictures} pictures: give each as many")
    if not (light.min() > 0 and light.max() < np.inf):  # also refuses NaN
        raise InputError("light must be positive and finite: raise black pixels to the screen's black first")


def _check_mixture(lighting: Lighting, light: Floats, channels: int) -> None:
    mixture = lighting.mixture
    if mixture is None:
        return
    pixels, entries = mixture.light.shape[1], light.size // lighting.pictures
    fits = entries % channels == 0 if pixels == 1 else entries == pixels * channels
    if mixture.share.shape[1:] != (channels,) or not fits:
        raise InputError(
            f"views of {pixels} pixels, and shares of shape {mixture.share.shape}, do not fit light of shape "
            f"{light.shape} in {lighting.pictures} pictures of {channels} channels: give all of one rig"
        )


def _weights(weights: Floats | None, light: Floats) -> Floats:
    given = np.asarray(1.0 if weights is None else weights)
    try:
        whole = np.broadcast_to(given.astype(light.dtype, copy=False), light.shape)
    except ValueError as error:
        raise InputError(
            f"weights of shape {given.shape} do not fit light of shape {light.shape}: give one for each, or one for all"
        ) from error
    if not within(given, 0, np.inf):
        raise InputError("weights must be finite and at least 0: use 0 for don't care")
    return whole


def _lamp_bounds(bounds: tuple[Floats, Floats] | None, lighting: Lighting) -> tuple[Reals, Reals]:
    if bounds is None:
        return np.ones((lighting.lamps, 1)), np.ones((lighting.lamps, 1))
    low, high = (np.asarray(bound, dtype=np.float64) for bound in bounds)
    for powers in (low, high):
        if powers.ndim != 2 or powers.shape != low.shape or not np.all(np.isfinite(powers)) or np.any(powers <= 0):
            raise InputError("lamp powers must be positive and finite, in an array of shape (lamps, channels)")
    if len(low) < lighting.lamps:
        raise InputError(f"views name {lighting.lamps} lamps, but there are powers for {len(low)}: give each its own")
    if np.any(low > high):
        raise InputError("a lower bound of the lamp powers is above the upper one: swap them")
    return low, high


@dataclass(frozen=True)
class Progress:
    """Where a running solver stands; arrays are the solver's own: look while it waits, do not write, copy to keep."""

    iteration: int
    iterations: int
    x: Floats
    #: ``A x`` of this `x`.
    absorbance: Floats
    #: What the solver minimises, or the norm it reports.
    residual: float
    #: ``(lamps, channels)`` of this `x`.
    lamp_powers: Floats
    #: What `Solver` takes as `state` to go on from here, ``"x"`` and the residuals so far, ``"history"``, among it.
    #: These too are the solver's own arrays: write them out or copy them before the callback returns.
    state: Callable[[], State]


#: Called after each iteration; True asks the solver to stop and return what it has.
Callback = Callable[[Progress], bool | None]


@dataclass(frozen=True)
class Result:
    """What a solver returns.

    Parameters
    ----------
    x
        ``(unknowns, columns)``, extinction in 1/mm.
    lamp_powers
        ``(lamps, channels)``.
    residuals
        One figure per iteration, in the norm that the solver's docstring states.
    rejected
        ``(count, 2)`` whole numbers: the (equation, column) pairs that were thrown out as inconsistent.
    undetermined
        ``(unknowns, columns)`` bool: voxels that no remaining equation determines, or None where a method
        does not tell.
    stop_reason
        One of ``"converged"``, ``"iterations"``, ``"callback"``.
    lower_bound
        What no `x` within the bounds and no lamp can bring the last figure of `residuals` below, or None where a
        method does not tell.
    """

    x: Floats
    lamp_powers: Floats
    residuals: Reals
    rejected: Integers = field(default_factory=lambda: np.empty((0, 2), np.int64))
    undetermined: Flags | None = None
    stop_reason: str = "iterations"
    lower_bound: float | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        if np.ndim(self.x) != 2 or np.ndim(self.residuals) != 1:
            raise InputError(
                f"a result is x of shape (unknowns, columns) and one residual per iteration, not {np.shape(self.x)} "
                f"and {np.shape(self.residuals)}"
            )
        keep(self, x=None, lamp_powers=None, residuals=np.float64, rejected=np.int64, undetermined=np.bool_)


class Solver(Protocol):
    """What every method is: a function with these parameters.

    Parameters
    ----------
    A
        The matrix.
    wanted
        What it is to reach.
    x0
        ``(unknowns, columns)`` to start from; None = all 0 (fully transparent).
    bounds
        Lower and upper bound of `x`; a method that cannot keep them says so. The lower one is a number, or where
        colours differ in what the clear material absorbs one of each column, ``(columns,)``.
    iterations
        At most so many.
    callback
        Called after each iteration.
    state
        What `Progress.state` gave after some iteration of the same problem: go on from there instead of from `x0`.
        The result is the same, bit for bit, as that of a run that never stopped, history included. Arrays beyond
        those that the method keeps are ignored, none is written to, and each is taken once: the giver may forget it.
    """

    def __call__(  # noqa: D102
        self,
        A: Operator,
        wanted: Wanted,
        *,
        x0: Floats | None = None,
        bounds: Bounds = (0.0, np.inf),
        iterations: int = 100,
        callback: Callback | None = None,
        state: State | None = None,
    ) -> Result: ...
