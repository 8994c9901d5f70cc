"""Solving a problem size after size and unit after unit, watched all the way."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from lightcube.coarse import enlarged, halved
from lightcube.cube import Cube
from lightcube.frames import Frames
from lightcube.geometry import Grid
from lightcube.problem import Problem
from lightcube.solvers import METHODS
from lightcube.solvers.contract import Callback, Progress, Result, Solver

#: Cubes longer than this start from the solution at half the size, found in so many passes.
COARSEST, COARSE_PASSES = 48, 100
#: Seconds from the start to the first checkpoint, and between checkpoints later on; the gaps double in between.
FIRST_CHECKPOINT_S, CHECKPOINT_S = 2.0, 30.0

Floats = NDArray[np.floating[Any]]


class Store(Protocol):
    """Where unfinished work is kept."""

    def keep(self, cube: Cube) -> None:
        """Keep `cube`, which is unfinished, in place of what was kept before."""


@dataclass(frozen=True)
class Step:
    """Where a running solve stands."""

    #: Of the cube itself; 0 while coarser ones are solved for its start.
    iteration: int
    iterations: int
    #: Part of all the work, in [0, 1].
    done: float
    #: What the method minimises, or the norm it reports.
    residual: float
    #: What the screen shows now: a function that returns ``(view, row, column, channel)``, linear light; None at first.
    shown: Callable[[], NDArray[np.float32]] | None


class Watch:
    """What solvers call after each iteration: progress, checkpoints, and the caller's callback.

    Parameters
    ----------
    ahead
        Work at coarser sizes, in passes of the cube itself.
    passes
        At most so many of the cube itself, or None where the method does not tell.
    enough
        Mean squared difference in display values at which a solver of the cube itself may stop.
    """

    def __init__(
        self,
        draft: Cube,
        callback: Callable[[Step], bool | None] | None,
        store: Store | None,
        ahead: float,
        passes: int | None,
        enough: float,
    ) -> None:
        self._draft, self._callback, self._store = draft, callback, store
        self._ahead, self._done, self._passes = ahead, 0.0, passes
        self._last, self._gap = time.monotonic(), FIRST_CHECKPOINT_S
        self._stopped = False
        self._enough = enough

    def cube(self, problem: Problem, x: Floats, powers: NDArray[Any]) -> Cube:
        """Make the cube of the unknowns `x`, unfinished."""
        every = np.array(np.broadcast_to(powers, (problem.stops, problem.channels)), dtype=np.float64)
        return replace(self._draft, extinction=problem.extinction(x), lamp_powers=every)

    def coarse(self, share: float) -> Callback:
        """For a solver at a coarser size, an iteration of which is so much of a pass."""

        def watch(progress: Progress) -> bool | None:
            self._done += share
            done = self._done / (self._ahead + (self._passes or 1))
            return self._tell(Step(0, self._passes or 0, done, progress.residual, None))

        return watch

    def whole(
        self, problem: Problem, x: Floats, seen: Floats, part: slice, powers: Floats | None, number: int, parts: int
    ) -> Callback:
        """For a solver of some columns of the cube; the others are in `x`, and what is seen through them in `seen`."""
        weight = float(np.sum(problem.weights[:, part], dtype=np.float64))
        enough = 0.5 * self._enough * weight if self._enough > 0 else -1.0  # an exact 0 is not enough by itself

        def watch(progress: Progress) -> bool | None:
            lamps = progress.lamp_powers if powers is None else powers
            if self._store is not None and time.monotonic() - self._last > self._gap:
                x[:, part] = progress.x
                self._store.keep(self.cube(problem, x, lamps))
                self._last, self._gap = time.monotonic(), min(2 * self._gap, CHECKPOINT_S)

            def shown() -> NDArray[np.float32]:
                seen[:, part] = progress.absorbance
                every = np.array(np.broadcast_to(lamps, (problem.stops, problem.channels)), np.float64)
                return problem.shown(seen, every)

            past = (number + progress.iteration / progress.iterations) / parts
            done = (self._ahead + past * progress.iterations) / (self._ahead + progress.iterations)
            stop = self._tell(Step(progress.iteration, progress.iterations, done, progress.residual, shown))
            return stop or progress.residual <= enough

        return watch

    def reason(self, result: Result) -> str:
        """Why the solver stopped."""
        return "enough" if result.stop_reason == "callback" and not self._stopped else result.stop_reason

    def _tell(self, step: Step) -> bool:
        """Once the callback has asked to stop, nothing goes on."""
        self._stopped = self._stopped or (self._callback is not None and bool(self._callback(step)))
        return self._stopped


def coarser(frames: Frames, grid: Grid, *, at_least: int) -> list[tuple[Frames, Grid]]:
    """The same at half the size, a quarter, ... until `COARSEST` is reached, `at_least` so often."""
    levels: list[tuple[Frames, Grid]] = []
    while max(grid.shape) > COARSEST or len(levels) < at_least:
        frames, grid = halved(frames, grid)
        levels.insert(0, (frames, grid))
    return levels


def solve_levels(
    levels: list[Problem], lamp_bounds: tuple[Floats, Floats], watch: Watch, **options: Any
) -> tuple[Floats | None, Floats, bool]:
    """Solve the same problem at growing sizes; returns extinction and lamp powers of the last, and False if stopped."""
    extinction, powers, going = None, lamp_bounds[1], True
    for size, problem in zip(range(len(levels), 0, -1), levels, strict=True):
        result = METHODS["display"](
            problem.matrix,
            problem.light,
            weights=problem.weights,
            view_of_row=problem.lamp_of_row,
            lamp_bounds=lamp_bounds,
            x0=None if extinction is None else problem.unknowns(enlarged(extinction, problem.matrix.grid.shape)),
            iterations=COARSE_PASSES,
            callback=watch.coarse(8.0**-size),
            **options,
        )
        extinction, powers = problem.extinction(result.x), result.lamp_powers
        going = result.stop_reason != "callback"
        if not going:  # what there is, at the last size
            for larger in levels[len(levels) - size + 1 :]:
                extinction = enlarged(extinction, larger.matrix.grid.shape)
            break
    return extinction, powers, going


def solve_units(
    solver: Solver,
    problem: Problem,
    lamp_bounds: tuple[Floats, Floats],
    x: Floats | None,
    parts: list[slice],
    watch: Watch,
    **options: Any,
) -> Result:
    """Solve for the columns of each part, one part after the other; starts from `x` and overwrites it."""
    if x is None:
        x = np.zeros((problem.matrix.shape[1], problem.light.shape[1]), problem.light.dtype)
    seen = np.empty_like(problem.light) if len(parts) == 1 else problem.matrix.forward(x)
    results = []
    for number, part in enumerate(parts):
        colours = part if problem.light.shape[1] == problem.channels else slice(None)
        low, high = (bound[:, colours] for bound in lamp_bounds)
        result = solver(
            problem.matrix,
            np.ascontiguousarray(problem.light[:, part]),
            weights=problem.weights[:, part],
            view_of_row=problem.lamp_of_row,
            lamp_bounds=(low, high),
            x0=x[:, part],
            callback=watch.whole(
                problem, x, seen, part, lamp_bounds[1] if len(parts) > 1 else None, number, len(parts)
            ),
            **options,
        )
        result = replace(result, stop_reason=watch.reason(result))
        if len(parts) == 1:
            return result
        results.append(result)
        x[:, part] = result.x
        if result.stop_reason == "callback":
            break
    longest = max(len(result.residuals) for result in results)
    padded = [np.pad(result.residuals, (0, longest - len(result.residuals)), "edge") for result in results]
    reasons = [result.stop_reason for result in results]
    return Result(
        x,
        lamp_bounds[1],
        np.sum(padded, axis=0),
        stop_reason=next(reason for reason in ("callback", "iterations", "enough", "converged") if reason in reasons),
        lower_bound=sum(result.lower_bound or 0.0 for result in results),
    )
