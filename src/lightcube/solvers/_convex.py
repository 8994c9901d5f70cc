"""What the screen shows and what it should: the objective of the display solver, entry by entry."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import convex, display
from lightcube.solvers.contract import Bounds, Floats, Operator, Wanted

#: The curvatures used hold as long as no beam's ln light rises by more than this.
ROOM = 0.1


@dataclass(frozen=True)
class ConvexObjective:
    """What is wanted of the screen, and the lamps that shine on it; lamp powers as ln P, ``(lamps, channels)``."""

    #: ln light.
    wanted: Floats
    weights: Floats
    #: ``(equations,)``.
    lamps: NDArray[np.integer[Any]]
    #: The equations of lamp l that count are ``rows[starts[l]:starts[l + 1]]``.
    rows: NDArray[np.integer[Any]]
    starts: NDArray[np.integer[Any]]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    #: The same as powers.
    bounds: tuple[NDArray[np.float64], NDArray[np.float64]]
    #: How display values follow from ln light.
    curve: display.Curve
    #: Absorbance beside the cube's, ``(equations, 1)``.
    loss: Floats | None

    @classmethod
    def of(cls, wanted: Wanted) -> "ConvexObjective":
        """Lay out what is wanted of pictures of one view each."""
        low, high = wanted.lamp_bounds
        lamps = wanted.lighting.lamp_of_row(len(wanted.light))
        rows = np.argsort(lamps, kind="stable")
        rows = rows[np.any(wanted.weights[rows] > 0, axis=1)]
        return cls(
            np.ascontiguousarray(np.log(wanted.light)),
            wanted.weights,
            lamps,
            rows,
            np.searchsorted(lamps[rows], np.arange(len(low) + 1)),
            np.log(low),
            np.log(high),
            (low, high),
            display.curve(wanted.transfer == "srgb", wanted.light.dtype.type),
            None if wanted.lighting.loss is None else wanted.lighting.loss.astype(wanted.light.dtype),
        )

    def powers(self, lamp: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return P of ln P, within the bounds to the last digit."""
        return np.clip(np.exp(lamp), *self.bounds)

    def joint(self, ax: Floats) -> Floats:
        """Return the absorbance of each picture's light: that of its one view, and what is lost beside the cube."""
        return ax if self.loss is None else ax + self.loss

    def best_lamp(self, joint: Floats, start: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the best ln P for absorbance `joint`, found from `start`."""
        if np.array_equal(self.low, self.high):
            return self.low
        lamp = start.copy()
        data = (self.rows, self.starts, self.wanted, self.weights, self.curve)
        convex.fit_lamp(joint, *data, self.low, self.high, lamp)
        return lamp

    def arrive(
        self, last: Floats, ax: Floats, joint: Floats, lamp: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the objective per column at absorbance `ax`, and the least if it changed from `last` once more."""
        before, lamps = self.joint(last), lamp.astype(ax.dtype)
        return convex.arrive(before, joint, lamps, self.lamps, self.wanted, self.weights, self.curve)

    def descend(self, ax: Floats, joint: Floats, lamp: NDArray[np.float64]) -> Floats:
        """Write over `ax`, and return, the objective's derivative by the absorbance."""
        self.slopes(joint, lamp, ax)
        return ax

    def slopes(self, joint: Floats, lamp: NDArray[np.float64], slopes: Floats) -> None:
        """Write the objective's derivative by the absorbance to `slopes`, which may be `joint` itself."""
        convex.descend(joint, lamp.astype(joint.dtype), self.lamps, self.wanted, self.weights, self.curve, slopes)

    def curved(self, values: Floats, ax: Floats, joint: Floats, lamp: NDArray[np.float64]) -> Floats:
        """Multiply `values`, and return them, by bounds on the curvature of each entry's term."""
        data = (self.lamps, self.wanted, self.weights, self.curve)
        convex.curvatures(joint, lamp.astype(ax.dtype), *data, ax.dtype.type(ROOM), values)
        return values

    def lower_bound(self, A: Operator, ax: Floats, lamp: NDArray[np.float64], bounds: Bounds) -> float:
        """A number that the objective cannot fall below, by duality from the derivatives at `ax`; at least 0.

        For any s, the objective is at least ``min over lamps of s.lnP + min over x of -(A's).x - sum of conjugates``
        (R. T. Rockafellar, Convex Analysis, 1970, section 31). Writes over `ax`.
        """
        lower, upper = bounds
        if np.any(lower == -np.inf):
            return 0.0
        pull = self.descend(ax, self.joint(ax), lamp)
        np.negative(pull, out=pull)
        if upper == np.inf:
            self._make_feasible(A, pull)
        back = A.adjoint(pull)
        least = -float(np.sum(lower * np.sum(np.minimum(back, 0), axis=0, dtype=np.float64)))
        if upper < np.inf:
            least -= upper * float(np.sum(np.maximum(back, 0), dtype=np.float64))
        if self.loss is not None:
            least -= float(np.sum(pull * self.loss, dtype=np.float64))
        rows_of_lamp = (self.rows[first:last] for first, last in pairwise(self.starts))
        per_column = np.stack([np.sum(pull[rows], axis=0, dtype=np.float64) for rows in rows_of_lamp])
        per_lamp = per_column.reshape(len(self.low), -1, self.low.shape[1]).sum(axis=1)
        least += float(np.sum(np.minimum(per_lamp * self.low, per_lamp * self.high)))
        bound = 0.0
        for part in (0.3, 0.5, 0.7, 0.85, 1.0):  # concave, and 0 at 0: once it falls, it falls on
            reached = part * least - self._conjugates(part * pull)
            if reached <= bound:
                break
            bound = reached
        return bound

    def _make_feasible(self, A: Operator, pull: Floats) -> None:
        """Lower `pull`, along the beams through the unknowns where ``A'pull`` is above 0, until it is nowhere."""
        rising = A.adjoint(pull)
        np.maximum(rising, 0, out=rising)
        heard = (self.weights > 0).astype(pull.dtype)
        reach = A.adjoint(heard)
        reach = np.divide(rising, reach, out=reach, where=reach > 0)
        beams = A.forward(np.square(reach, out=reach))
        mean = np.mean(beams, axis=0)
        # Part along those beams and part along all: of the mixtures tried, the one with the best bounds.
        beams /= np.where(mean > 0, mean, 1)
        beams += pull.dtype.type(0.3)
        beams *= heard
        del heard, reach  # make room
        back = A.adjoint(beams)
        beams *= (1 + 1e-5) * np.max(np.divide(rising, back, out=back, where=back > 0), axis=0)
        pull -= beams

    def _conjugates(self, pull: Floats) -> float:
        return float(np.sum(display.conjugates(pull, self.wanted, self.weights, self.curve)))
