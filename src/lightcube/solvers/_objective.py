"""The display solver's objective where several views add up to a picture: no longer convex."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import display, light, objective
from lightcube.optics.law import Mixture
from lightcube.solvers._convex import ROOM
from lightcube.solvers.contract import Floats, Operator, Wanted

#: Newton's steps for the lamps' powers in each pass, at most; the longest one, and one so short that it is the last.
_STEPS, _LONGEST, _SHORT = 10, 1.0, 1e-3


@dataclass(frozen=True)
class Objective:
    """What is wanted of the screen, and the views that add up on it; lamp powers as ln P, ``(lamps, channels)``."""

    mixture: Mixture
    #: ``(views,)``.
    lamp_of_view: NDArray[np.integer[Any]]
    #: ln light, ``(pictures, entries)``.
    wanted: Floats
    weights: Floats
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    #: The same as powers.
    bounds: tuple[NDArray[np.float64], NDArray[np.float64]]
    curve: display.Curve
    #: Columns of the matrix equation.
    columns: int

    @classmethod
    def of(cls, wanted: Wanted, mixture: Mixture) -> "Objective":
        """Lay out what is wanted of pictures that views add up to."""
        low, high = wanted.lamp_bounds
        pictures = wanted.lighting.pictures
        logs = np.log(wanted.light).reshape(pictures, -1)
        heavy = np.ascontiguousarray(wanted.weights).reshape(pictures, -1) * _lit(mixture, logs.shape[1])
        curve = display.curve(wanted.transfer == "srgb", wanted.light.dtype.type)
        columns = wanted.light.shape[1]
        return cls(mixture, wanted.lighting.lamp, logs, heavy, np.log(low), np.log(high), (low, high), curve, columns)

    def powers(self, lamp: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return P of ln P, within the bounds to the last digit."""
        return np.clip(np.exp(lamp), *self.bounds)

    def best_lamp(self, ax: Floats, start: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return better ln P for absorbance `ax`, found from `start` by a few bounded steps."""
        lamp = np.clip(start, self.low, self.high)
        if np.array_equal(self.low, self.high):
            return lamp
        groups = np.cumsum(np.diff(self._picture * len(self.low) + self.lamp_of_view, prepend=-1) != 0) - 1
        lamp_of_group = self.lamp_of_view[np.unique(groups, return_index=True)[1]]
        for _ in range(_STEPS):
            sums = np.zeros((2, objective.PARTS, len(lamp_of_group), lamp.shape[1]))
            objective.pulls(self._mixed(lamp, ax), groups, *self._data(ax), sums)
            pulls = np.zeros((2, *lamp.shape))
            for both, found in zip(pulls, sums.sum(axis=1), strict=True):
                np.add.at(both, lamp_of_group, found)
            step = np.clip(-pulls[0] / (pulls[1] + 1e-30), -_LONGEST, _LONGEST)
            moved = np.clip(lamp + step, self.low, self.high) - lamp
            lamp += moved
            if np.max(np.abs(moved)) < _SHORT:
                break
        return lamp

    def arrive(
        self, last: Floats, ax: Floats, lamp: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the objective per column at absorbance `ax`, and the least if it changed from `last` once more."""
        before = last.reshape(len(self.lamp_of_view), -1)
        return objective.arrive(self._mixed(lamp, ax), before, *self._data(ax))

    def descend(self, ax: Floats, lamp: NDArray[np.float64]) -> Floats:
        """Write over `ax`, and return, the objective's derivative by the absorbance."""
        data = self._data(ax)
        objective.descend(self._mixed(lamp, ax), *data, data[0])
        return ax

    def curved(self, values: Floats, ax: Floats, lamp: NDArray[np.float64]) -> Floats:
        """Multiply `values`, and return them, by bounds on the curvature of each entry's term."""
        room = ax.dtype.type(ROOM)
        objective.curvatures(self._mixed(lamp, ax), *self._data(ax), room, values.reshape(len(self.lamp_of_view), -1))
        return values

    def lower_bound(self, A: Operator, ax: Floats, lamp: NDArray[np.float64], bounds: tuple[float, float]) -> None:
        """No bound is known: the problem is not convex."""

    @property
    def _picture(self) -> NDArray[np.intp]:
        return np.repeat(np.arange(len(self.wanted)), np.diff(self.mixture.starts))

    def _mixed(self, lamp: NDArray[np.float64], ax: Floats) -> light.Mixture:
        return self.mixture.under(np.exp(lamp)[self.lamp_of_view], ax.dtype)

    def _data(self, ax: Floats) -> tuple[Floats, int, Floats, Floats, display.Curve]:
        return ax.reshape(len(self.lamp_of_view), -1), self.columns, self.wanted, self.weights, self.curve


def _lit(mixture: Mixture, entries: int) -> NDArray[np.bool_]:
    """``(pictures, entries)``: where any light falls. Elsewhere no cube changes anything, so nothing is asked for."""
    falls = [mixture.light[first:last].T @ mixture.share[first:last] > 0 for first, last in pairwise(mixture.starts)]
    pixels = entries // mixture.share.shape[1]
    return np.stack([np.broadcast_to(each, (pixels, each.shape[1])).ravel() for each in falls])
