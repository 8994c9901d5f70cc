"""The display solver's objective where several views add up to a picture: no longer convex."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import display, joint, light, objective
from lightcube.kernels.layout import empty
from lightcube.optics.arrays import Counts
from lightcube.optics.law import Mixture
from lightcube.solvers._convex import ROOM, ConvexObjective
from lightcube.solvers.contract import Bounds, Floats, Lighting, Operator, Wanted

#: Newton's steps for the powers of several lamps in each pass, at most; the longest one, and one so short that it is
#: the last.
_STEPS, _LONGEST, _SHORT = 10, 1.0, 1e-3


@dataclass(frozen=True)
class Objective:
    """What is wanted of the screen, and the views that add up on it; lamp powers as ln P, ``(lamps, channels)``.

    Views of a picture and a lamp that follow each other are a group, and act as one view of their joint absorbance
    (`lightcube.kernels.joint`): lamps are found for these, and the objective is a function of them.
    """

    #: How views add up to groups, powers being their shares.
    views: light.Mixture
    #: The groups of picture p are ``starts[p]`` to before ``starts[p + 1]``, and each has one lamp.
    starts: Counts
    lamps: NDArray[np.integer[Any]]
    #: ln light, ``(pictures, entries)``.
    wanted: Floats
    weights: Floats
    #: Bounds on ln P, and the same as powers.
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    bounds: tuple[NDArray[np.float64], NDArray[np.float64]]
    curve: display.Curve
    #: Which entries of the groups count (`lightcube.kernels.joint.runs_of`).
    runs: NDArray[np.int64]
    #: Columns of the matrix equation.
    columns: int
    #: Of the joint absorbance, where each picture is one group.
    single: ConvexObjective | None

    @classmethod
    def of(cls, wanted: Wanted, mixture: Mixture) -> "Objective":
        """Lay out what is wanted of pictures that views add up to."""
        low, high = wanted.lamp_bounds
        pictures, dtype, lamps = wanted.lighting.pictures, wanted.light.dtype, wanted.lighting.lamp
        columns = wanted.light.shape[1]
        logs = np.log(wanted.light).reshape(pictures, -1)
        heavy = np.ascontiguousarray(wanted.weights).reshape(pictures, -1) * _lit(mixture, logs.shape[1])
        picture = np.repeat(np.arange(pictures), np.diff(mixture.starts))
        first = np.flatnonzero(np.diff(picture * len(low) + lamps, prepend=-1))  # of each group
        starts = np.searchsorted(first, mixture.starts)
        parts = (each.astype(dtype, copy=False) for each in (mixture.share, mixture.light, mixture.shadow))
        views = light.Mixture(np.append(first, len(lamps)), *parts)
        channels = views.powers.shape[1]
        counts = np.asarray(np.any((heavy > 0).reshape(pictures, -1, channels), axis=2))
        return cls(
            views=views,
            starts=starts,
            lamps=lamps[first],
            wanted=logs,
            weights=heavy,
            low=np.log(low),
            high=np.log(high),
            bounds=(low, high),
            curve=display.curve(wanted.transfer == "srgb", dtype.type),
            runs=joint.runs_of(counts, starts, views.starts, channels),
            columns=columns,
            single=_single(wanted, heavy, lamps[first]) if len(first) == pictures else None,
        )

    def powers(self, lamp: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return P of ln P, within the bounds to the last digit."""
        return np.clip(np.exp(lamp), *self.bounds)

    def joint(self, ax: Floats) -> Floats:
        """Return the joint absorbance of all groups, ``(groups * equations of a view, columns)``."""
        found = empty((len(self.lamps), self.wanted.shape[1]), ax.dtype)
        joint.join(self.runs, self.views, self._of_views(ax), found)
        return found.reshape(-1, self.columns)

    def best_lamp(self, joint: Floats, start: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the best ln P for a joint absorbance, found from `start`.

        Where several lamps shine on a picture, better ones, by a few bounded steps.
        """
        if self.single is not None:
            return self.single.best_lamp(joint, start)
        lamp = np.clip(start, self.low, self.high)
        if np.array_equal(self.low, self.high):
            return lamp
        for _ in range(_STEPS):
            pulls = np.zeros((2, *lamp.shape))
            for both, of_groups in zip(pulls, objective.pulls(*self._data(joint, lamp)), strict=True):
                np.add.at(both, self.lamps, of_groups)
            step = np.clip(-pulls[0] / (pulls[1] + 1e-30), -_LONGEST, _LONGEST)
            moved = np.clip(lamp + step, self.low, self.high) - lamp
            lamp += moved
            if np.max(np.abs(moved)) < _SHORT:
                break
        return lamp

    def arrive(
        self, last: Floats, ax: Floats, joint_ax: Floats, lamp: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the objective per column at absorbance `ax`, and the least if it changed from `last` once more."""
        least = joint.least_ahead(last, ax)
        if self.single is not None:
            return self.single.arrive(joint_ax, joint_ax, joint_ax, lamp)[0], least
        return objective.arrive(*self._data(joint_ax, lamp)), least

    def descend(self, ax: Floats, joint_ax: Floats, lamp: NDArray[np.float64]) -> Floats:
        """Write over `ax`, and return, the objective's derivative by the absorbance."""
        slopes, absorbance = np.empty_like(joint_ax), self._of_views(ax)
        if self.single is not None:
            self.single.slopes(joint_ax, lamp, slopes)
        else:
            objective.descend(*self._data(joint_ax, lamp), self._of_groups(slopes))
        of_groups = self._of_groups(joint_ax), self._of_groups(slopes)
        joint.spread(self.runs, self.views, absorbance, *of_groups, absorbance)
        return absorbance.reshape(ax.shape)

    def curved(self, values: Floats, ax: Floats, joint_ax: Floats, lamp: NDArray[np.float64]) -> Floats:
        """Multiply `values`, and return them, by bounds on the curvature of each entry's term."""
        room, data = ax.dtype.type(ROOM), self._data(joint_ax, lamp)
        objective.curvatures(*data, room, self.views, self._of_views(ax), self._of_views(values))
        return values

    def lower_bound(self, A: Operator, ax: Floats, lamp: NDArray[np.float64], bounds: Bounds) -> None:
        """No bound is known: the problem is not convex."""

    def _of_views(self, block: Floats) -> Floats:
        return block.reshape(len(self.views.powers), -1)

    def _of_groups(self, block: Floats) -> Floats:
        return block.reshape(len(self.lamps), -1)

    def _data(
        self, joint: Floats, lamp: NDArray[np.float64]
    ) -> tuple[Counts, Floats, Floats, int, Floats, Floats, display.Curve]:
        """The groups, their powers and joint absorbance, and what is wanted, as loops take them."""
        powers = np.exp(lamp)[self.lamps].astype(joint.dtype)
        return self.starts, powers, self._of_groups(joint), self.columns, self.wanted, self.weights, self.curve


def _single(wanted: Wanted, weights: Floats, lamps: NDArray[np.integer[Any]]) -> ConvexObjective:
    """The objective as a function of the joint absorbance, of pictures of one group each."""
    views = Lighting(lamps)
    return ConvexObjective.of(
        Wanted(wanted.light, weights.reshape(wanted.light.shape), views, wanted.lamp_bounds, wanted.transfer)
    )


def _lit(mixture: Mixture, entries: int) -> NDArray[np.bool_]:
    """``(pictures, entries)``: where any light falls. Elsewhere no cube changes anything, so nothing is asked for."""
    falls = [mixture.light[first:last].T @ mixture.share[first:last] > 0 for first, last in pairwise(mixture.starts)]
    pixels = entries // mixture.share.shape[1]
    return np.stack([np.broadcast_to(each, (pixels, each.shape[1])).ravel() for each in falls])
