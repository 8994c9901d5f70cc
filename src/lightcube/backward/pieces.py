"""Solving the pieces of a job, one call of a solver each: watched, checkpointed, and continued where they stopped."""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.backward.job import Job, level_name
from lightcube.backward.kept import EARLIER, HISTORY, LOOKS, POWERS, VOXELS, result_of, shape_of, state_of
from lightcube.backward.problem import Problem, pose, powers_of_pictures, voxels_from_unknowns
from lightcube.backward.recipe import Recipe
from lightcube.backward.reckoning import Reckoning, is_look, is_look_ahead
from lightcube.backward.store import Arrays, Store
from lightcube.backward.units import Part, coarse_shape, coarser
from lightcube.optics.arrays import Reals
from lightcube.optics.cube import Cube
from lightcube.optics.stack import Stack
from lightcube.pictures.resampling import enlarged
from lightcube.solvers.contract import Progress, Result

#: Seconds from the start of a piece to its first checkpoint, and at most between later ones; gaps double in between.
FIRST_CHECKPOINT_S, CHECKPOINT_S = 2.0, 30.0
#: Checkpoints that take long are rarer: between two lie so many times as many seconds as one took, at most so many.
_PATIENCE, _LATEST_S = 20.0, 60.0
#: Pictures are enough so much above what is asked for, dB: what is cast is looked at more and more rarely.
_SPARE_DB = 0.5
#: The solver ends where the mean squared difference was never so much smaller than it has been for so many passes, and
#: for so large a part of all of them: some turns take long.
_BETTER, _IN_VAIN, _PART_IN_VAIN = 0.99, 30, 1 / 3

#: The largest absorbance of the random films that a stack starts from: 0.02 to 1 are as good, 0 is not (measured).
_RANDOM = np.float32(0.3)

Floats = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class Step:
    """Where a running job stands."""

    #: Of the unit that is being solved; 0 while coarser cubes are solved for its start.
    iteration: int
    iterations: int
    #: Part of all the work, in [0, 1].
    done: float
    #: What the method minimises, or the norm it reports: of the unit.
    residual: float
    #: What the screen shows now in the `window` of its pictures: a function that returns ``(view, row, column,
    #: channel)``, linear light; None while coarser cubes are solved.
    shown: Callable[[], NDArray[np.float32]] | None
    #: Rows and colours of the pictures that the unit is seen in.
    window: tuple[slice, slice]
    #: The cube as it is now, of the size that is being solved: a function that returns a copy. None where it is solved
    #: in several units, since only a part is known.
    cube: Callable[[], Cube] | None


#: Called after each iteration; True stops the job.
Watching = Callable[[Step], bool | None]


def solve_pieces(
    job: Job, names: list[str], store: Store, callback: Watching | None = None, *, checkpoints: bool = True
) -> bool:
    """Solve pieces one after the other, as `solve_piece` does; False where the callback stopped it."""
    asked = False

    def watching(step: Step) -> bool:
        nonlocal asked
        asked = asked or (callback is not None and bool(callback(step)))
        return asked

    return all(not asked and solve_piece(job, name, store, watching, checkpoints=checkpoints) for name in names)


def solve_piece(
    job: Job, name: str, store: Store, callback: Watching | None = None, *, checkpoints: bool = True
) -> bool:
    """Solve a piece, or what is left of it, unless it is finished; False where the callback stopped it.

    Parameters
    ----------
    name
        One of ``job.pieces``, those it needs being finished.
    store
        Has what is finished and the piece's checkpoint, and gets the result. A piece that was stopped or killed and
        then continued comes out the same, bit for bit.
    checkpoints
        Whether unfinished work is kept while it goes on, after 2 s and then ever more seldom up to every 30 s, and
        not only where the callback stops it.
    """
    if name in store.names():
        return True
    watch = _Watch(job, name, store, callback, checkpoints=checkpoints)
    state = state_of(job, store, name)
    earlier = watch.go_on_from(state)
    start, phases = None if state else _start(job, name, store), job.phases(name)
    for number in range(1 if len(earlier) else 0, len(phases)):
        phase = phases[number]
        problem, bounds = _posed(job, name, store, phase.recipe)
        if start is not None and isinstance(job.grid, Stack):
            start = start * problem.is_lit  # where no light goes through, films are clear
        watch.begin(problem, number, earlier)
        options: dict[str, Any] = {} if phase.passes is None else {"iterations": phase.passes}
        result = problem.solve(
            job.recipe.solver,
            bounds,
            job.bounds(problem.part, problem.light.shape[1]),
            x0=None if start is None else problem.unknowns(start),
            callback=watch,
            state=_handed(state),
            **options,
        )
        if watch.stopped:
            return False
        start, state = problem.voxels(result.x), None
        earlier = np.concatenate([earlier, result.residuals])
    store.finish(name, _bundle(problem, result, earlier, watch.reason or result.stop_reason))
    return True


def _start(job: Job, name: str, store: Store) -> Floats | None:
    """Voxels that a piece starts from, if any."""
    kind, number = name.split("-")
    if kind == "level":
        return start_of(job, store, int(number), _whole(job, int(number)))
    return start_of(job, store, 0, job.parts[int(number)])


def _whole(job: Job, level: int) -> Part:
    """All of the cube halved so often."""
    return Part(slice(0, job.channels), slice(0, coarse_shape(job.grid.shape, level)[0]))


def _posed(job: Job, name: str, store: Store, recipe: Recipe) -> tuple[Problem, tuple[Floats, Floats]]:
    """Problem of a piece, and bounds of its lamps."""
    kind, number = name.split("-")
    if kind == "level":
        (targets, grid), part = coarser(job.targets, job.grid, int(number)), None
    else:
        (targets, grid), part = (job.targets, job.grid), job.parts[int(number)]
    own = recipe if job.dyes is None else recipe.for_any_size(job.grid)
    problem = pose(targets, grid, own, part, room=job.room)
    bounds = job.lamp_bounds
    if kind == "unit" and job.frozen:
        powers = _finished(job, store, level_name(1))[POWERS]
        bounds = (powers, powers)
    low, high = (bound[:, problem.part.colours] for bound in bounds)
    return problem, (low, high)


def start_of(job: Job, store: Store, level: int, part: Part) -> Floats | None:
    """Voxels that a part of the cube halved `level` times starts from, if any.

    What the job was given, or the next smaller cube, enlarged, which is finished; films start at random.
    """
    own = job.kinds_of(part)
    if level == 0 and job.start is not None:
        return np.clip(job.start[own, part.slices], 0, job.most[own])
    if isinstance(job.grid, Stack):
        return np.minimum(_at_random(job)[own], job.most[own])
    if level >= job.levels:
        return None
    whole = _finished(job, store, level_name(level + 1))[VOXELS]
    return enlarged(whole[own], coarse_shape(job.grid.shape, level), part.slices)


def _at_random(job: Job) -> Floats:
    """Films of random cells: clear ones are alike within a pixel, and a solver could never tell them apart."""
    shape = job.kinds, *job.grid.shape
    strongest = 1.0 if job.dyes is None else job.dyes.extinction.max(axis=1)[:, None, None, None]
    absorbance = _RANDOM * np.random.default_rng(job.recipe.seed).random(shape, np.float32)
    return (absorbance / (job.grid.voxel_mm * strongest)).astype(np.float32)


def known(job: Job, store: Store, name: str) -> Arrays | None:
    """What there is of a piece: its result, else voxels, powers and history of its checkpoint, else None."""
    found = result_of(job, store, name)
    if found is not None:
        return found
    state = state_of(job, store, name)
    if state is None:
        return None
    channels, *shape = shape_of(job, name)
    voxels = voxels_from_unknowns(state["x"], (shape[0], shape[1], shape[2]), channels, job.dyes)
    return {VOXELS: voxels, POWERS: state[POWERS], HISTORY: np.concatenate([state[EARLIER], state[HISTORY]])}


def _handed(arrays: Arrays | None) -> Mapping[str, NDArray[Any]] | None:
    return None if arrays is None else _Handed(arrays)


class _Handed(Mapping[str, NDArray[Any]]):
    """Arrays that are given away once: they need not stay beside the copies that a solver makes of them."""

    def __init__(self, arrays: Arrays) -> None:
        self._arrays = dict(arrays)

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._arrays.pop(name)

    def __contains__(self, name: object) -> bool:
        return name in self._arrays

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)


def _finished(job: Job, store: Store, name: str) -> Arrays:
    found = result_of(job, store, name)
    if found is None:
        raise KeyError(f"{name} is needed and not finished")
    return found


def _bundle(problem: Problem, result: Result, history: Reals, stop_reason: str) -> dict[str, NDArray[Any]]:
    """What is kept of a piece that is finished."""
    bundle: dict[str, NDArray[Any]] = {
        VOXELS: problem.voxels(result.x),
        POWERS: result.lamp_powers,
        HISTORY: history,
        "rejected": problem.pixels(result.rejected),
        "undetermined": np.array(0 if result.undetermined is None else np.sum(result.undetermined)),
        "stop_reason": np.array(stop_reason),
    }
    return bundle if result.lower_bound is None else bundle | {"lower_bound": np.array(result.lower_bound)}


class _Watch:
    """What the solver of a piece calls after each iteration: checkpoints, and the caller's callback.

    Attributes
    ----------
    reason
        ``"enough"`` where the pictures are as good as was asked for, ``"best"`` where what is cast becomes worse again;
        else nothing.
    stopped
        Whether the callback said so before that.
    """

    def __init__(self, job: Job, name: str, store: Store, callback: Watching | None, *, checkpoints: bool) -> None:
        self._name, self._job, self._store, self._callback = name, job, store, callback
        self._level, self._most = name.startswith("level"), job.recipe.passes or 0
        self._checkpoints, self._last, self._gap = checkpoints, time.monotonic(), FIRST_CHECKPOINT_S
        self._wanted = 10 ** (-(job.recipe.enough_db + _SPARE_DB) / 10)
        self._reckoning = Reckoning(job, name, self._wanted)
        self._least, self._best_at = np.inf, 0.0
        self.reason, self.stopped = "", False

    def go_on_from(self, state: Arrays | None) -> Reals:
        """Take up what was known where the solver stopped; return the history of the phases before."""
        if state is None:
            return np.empty(0)
        self._least, self._best_at = (float(each) for each in state[LOOKS])
        return state[EARLIER]

    def begin(self, problem: Problem, number: int, earlier: Reals) -> None:
        """Watch the phase of such a number, after others of such a history; at what the last one casts it looks."""
        self._problem, self._earlier = problem, earlier
        self._reckoning.begin(number)
        self._is_last = number + 1 == len(self._job.phases(self._name))

    def __call__(self, progress: Progress) -> bool:
        """Tell the solver whether it is to stop."""
        if self._job.looks and not self._level:
            if self._is_last and is_look(progress.iteration):
                self._look(progress)
            elif not self._is_last and is_look_ahead(progress.iteration, progress.iterations):
                self._reckoning.looked_ahead(self._problem.error(progress.x, progress.lamp_powers))
        asked = self._callback is not None and bool(self._callback(self._step(progress)))
        if self.reason:  # finished, whatever the callback says of the pieces to come
            return True
        self.stopped = asked
        if asked or (self._checkpoints and time.monotonic() - self._last > self._gap):
            self._keep(progress)
        return asked

    def _look(self, progress: Progress) -> None:
        """Judge what is cast: whether it is enough, or has been better before.

        It becomes worse in the end: a cube fits itself to the points that it is solved for, and to its mats.
        """
        error = self._problem.error(progress.x, progress.lamp_powers)
        self._reckoning.looked(progress.iteration, error)
        if 0 < error <= self._wanted:  # an exact 0 is not enough by itself
            self.reason = "enough"
        if error < _BETTER * self._least:
            self._best_at = progress.iteration
        self._least = min(self._least, error)
        if progress.iteration - self._best_at > max(_IN_VAIN, _PART_IN_VAIN * progress.iteration) and not self.reason:
            self.reason = "best"

    def _keep(self, progress: Progress) -> None:
        began = time.monotonic()
        kept = {POWERS: progress.lamp_powers, LOOKS: np.array([self._least, self._best_at]), EARLIER: self._earlier}
        self._store.keep(self._name, {**progress.state(), **kept})
        self._last = time.monotonic()
        self._gap = min(max(min(2 * self._gap, CHECKPOINT_S), _PATIENCE * (self._last - began)), _LATEST_S)

    def _step(self, progress: Progress) -> Step:
        passes = len(self._earlier) + progress.iteration
        done = self._reckoning.done(progress.iteration, progress.iterations)
        window = self._problem.rows, self._problem.part.colours
        cube = partial(self._cube, progress) if self._job.units == 1 else None
        if self._level:
            return Step(0, self._most, done, progress.residual, None, window, cube)

        def shown() -> NDArray[np.float32]:
            return self._problem.shown(progress.x, progress.lamp_powers)

        return Step(passes, self._most or progress.iterations, done, progress.residual, shown, window, cube)

    def _cube(self, progress: Progress) -> Cube:
        """The cube that the solver has reached."""
        job, problem = self._job, self._problem
        return Cube(
            extinction=problem.extinction(progress.x).astype(np.float32),
            grid=problem.matrix.grid,
            rig=problem.targets.rig,
            lamp_powers=powers_of_pictures(problem.targets, progress.lamp_powers, job.recipe).copy(),
            names=problem.targets.names,
            transfer=problem.targets.transfer,
            status="interrupted",
            hold_deg=job.recipe.hold_deg,
        )
