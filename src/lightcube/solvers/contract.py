"""What every solver takes and returns."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.transfer import Transfer

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Floats = NDArray[np.floating[Any]]
#: Everything that a stopped solver needs to go on, beside what it was called with: plain arrays by name.
State = Mapping[str, NDArray[Any]]


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

    def to_sparse(self) -> "csr_array":
        """The same matrix, float64, for methods that need single rows."""


@dataclass(frozen=True, eq=False)
class Mixture:
    """Views that add up to pictures: the equations of a view follow each other, and so do the views of a picture.

    A picture shows the sum over its views of ``P share light (1 - shadow (1 - e^-(A x)))``.

    Parameters
    ----------
    starts
        ``(pictures + 1,)``: the views of picture p are those from ``starts[p]`` to before ``starts[p + 1]``.
    lamp
        ``(views,)``: which of the lamp powers P each view has.
    share
        ``(views, channels)`` of at least 0.
    light, shadow
        ``(views, pixels)``, of at least 0 and in [0, 1]: a view's pixels in the order of its equations and columns.
    """

    starts: NDArray[np.intp]
    lamp: NDArray[np.intp]
    share: NDArray[np.float64]
    light: Floats
    shadow: Floats


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
    #: ``(views, channels)`` of this `x`.
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
        ``(views, channels)``.
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
    residuals: NDArray[np.float64]
    rejected: NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 2), np.int64))
    undetermined: NDArray[np.bool_] | None = None
    stop_reason: str = "iterations"
    lower_bound: float | None = None


class Solver(Protocol):
    """One signature for all methods.

    Parameters
    ----------
    A
        The matrix.
    B
        ``(equations, columns)``, what the screen shall show, linear light above 0: lamp power times transmittance.
        The colour channel of column ``j`` is ``j % channels``.
    weights
        At least 0, broadcastable to `B`; 0 = don't care; None = all 1.
    view_of_row
        ``(equations,)`` whole numbers: the view that each equation belongs to; None = all view 0.
    lamp_bounds
        Lower and upper bound of the lamp powers, each ``(views, channels)``; equal where the lamp is fixed.
        None = one channel per view, power 1.
    x0
        ``(unknowns, columns)`` to start from; None = all 0 (fully transparent).
    bounds
        Lower and upper bound of `x`; a method that cannot keep them says so.
    iterations
        At most so many.
    callback
        Called after each iteration.
    transfer
        How display values follow from light, for methods that reckon in display levels.
    state
        What `Progress.state` gave after some iteration of the same problem: go on from there instead of from `x0`.
        The result is the same, bit for bit, as that of a run that never stopped, history included. Arrays beyond
        those that the method keeps are ignored, none is written to.
    mixture
        Where several views add up to a picture: `B` and `weights` then have the equations of the pictures,
        `view_of_row` is not needed, and `lamp_bounds` is ``(lamps, channels)``. Only methods that reckon in light can.
    """

    def __call__(  # noqa: D102
        self,
        A: Operator,
        B: Floats,
        *,
        weights: Floats | None = None,
        view_of_row: NDArray[np.integer[Any]] | None = None,
        lamp_bounds: tuple[Floats, Floats] | None = None,
        x0: Floats | None = None,
        bounds: tuple[float, float] = (0.0, np.inf),
        iterations: int = 100,
        callback: Callback | None = None,
        transfer: Transfer = "srgb",
        state: State | None = None,
        mixture: Mixture | None = None,
    ) -> Result: ...
