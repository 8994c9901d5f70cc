"""Cubes that are still being made: loading and publishing them."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from pathlib import Path

from lightcube.backward.job import Job
from lightcube.backward.solution import Solution, merged
from lightcube.errors import InputError
from lightcube.io._files import PARTIAL_SUFFIX
from lightcube.io._places import Place, name_of, place
from lightcube.io.cubes import read_cube
from lightcube.io.outputs import Output
from lightcube.jobs.partial import DiskStore, discard_partial, load_job, published_path
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.scoring import metrics


class UnfinishedCube(UserWarning):
    """A cube that was loaded is a partial one, or its solver was stopped early."""


@checked
def load(path: str | Path) -> Cube:
    """Load a cube from a file that `lightcube.io.save` wrote, or from a ``.partial`` folder of one that is being made.

    Of the latter there is what is finished, the state of the unit that is being solved, and for the rest what it
    would start from.

    Warns
    -----
    UnfinishedCube
        Where the cube is a partial one, or its solver was stopped early.

    Raises
    ------
    InputError
        Where there is no such file, it is no light cube, it is damaged, or a newer version wrote it.
    """
    at = place(path)
    partial = name_of(at).lower().endswith(PARTIAL_SUFFIX)
    cube = _load_partial(at) if partial else read_cube(path)
    if partial or cube.status != "complete":
        why = "it is still being made" if partial else "its solver was stopped early"
        warnings.warn(f"the cube {path} is unfinished: {why}", UnfinishedCube, stacklevel=3)
    return cube


def _load_partial(at: Place) -> Cube:
    """The cube of what there is of an unfinished one."""
    store = _begun(at)
    return merged(load_job(at), store).cube


def _begun(at: Place) -> DiskStore:
    """The store of an unfinished cube; `InputError` where there is nothing in it."""
    store = DiskStore(at)
    if store.is_empty():
        raise InputError(f"{at} has nothing of a cube in it yet: start again without it")
    return store


@dataclass(frozen=True, eq=False)
class Published:
    """A cube that was made of an unfinished one.

    Parameters
    ----------
    path
        Where it is now.
    solution
        The cube, with its scores where it is whole, and how it was reached.
    done, units
        How many of how many units are finished.
    """

    path: Place
    solution: Solution
    done: int
    units: int

    @property
    def is_whole(self) -> bool:
        """Whether all of the cube is finished."""
        return self.done == self.units


@checked
def publish(partial: str | Path, *, overwrite: bool = False) -> Published:
    """Make a cube of what there is of ``NAME.zarr.partial`` (or ``NAME.zarr.zip.partial``, ``NAME.npz.partial``).

    It is saved as NAME, as `load` puts it together: scored where all is finished, with the status ``"interrupted"``
    where not. Then the partial folder is removed.

    Raises
    ------
    InputError
        Where there is no such folder, nothing of a cube in it, or NAME exists and `overwrite` is not asked for;
        the partial folder is kept then.
    """
    out = published_path(partial)
    Output(out, "cube", overwrite).check()
    store = _begun(place(partial))
    return finish(load_job(partial), store, out, overwrite=overwrite)


def finish(job: Job, store: DiskStore, out: str | Path, *, overwrite: bool = False) -> Published:
    """Save what a store has of the job of a cube, scored where that is all, and remove the cube's partial folder."""
    solution = merged(job, store)
    done = len(store.names().intersection(job.unit_names))
    if done == job.units:
        scored = replace(solution.cube, scores=metrics.score(solution.cube, job.targets))
        solution = replace(solution, cube=scored)
    at = place(out)
    Output(at, "cube", overwrite).write(solution.cube)
    discard_partial(at)
    return Published(at, solution, done, job.units)
