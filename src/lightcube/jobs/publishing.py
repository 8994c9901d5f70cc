"""Making a cube file of what is there of an unfinished one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from lightcube.backward.job import Job
from lightcube.backward.solution import Solution, merged
from lightcube.errors import InputError
from lightcube.io._places import Place, exists, is_folder, place
from lightcube.io.cubes import read_cube
from lightcube.io.outputs import Output
from lightcube.jobs.partial import DiskStore, begun_store, discard_partial, is_finished, load_job, published_path
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.scoring import metrics


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

    It is saved as NAME, as `load` puts it together. Where all is finished it is scored, and the partial folder is
    removed; where not its status is ``"interrupted"``, and the folder stays, so that its solving can go on.

    Raises
    ------
    InputError
        Where there is no such folder, nothing of a cube in it, or NAME exists and `overwrite` is not asked for;
        the partial folder is kept then.
    """
    out = published_path(partial)
    if not is_folder(place(partial)) and exists(out):
        raise InputError(f"there is no {partial}, but {out} is there: it is published already")
    check_output(out, overwrite=overwrite)
    store = begun_store(place(partial))
    return finish(load_job(partial), store, out, overwrite=overwrite)


def check_output(out: str | Path, *, overwrite: bool = False) -> None:
    """Raise `InputError` unless a cube could be written as `out`, or may be there already.

    Killed between the writing of a cube and the removal of its partial folder, a job is finished and its cube is there:
    `finish` sees whether it is that one.
    """
    Output(out, "cube", overwrite or is_finished(out)).check()


def finish(job: Job, store: DiskStore, out: str | Path, *, overwrite: bool = False) -> Published:
    """Save what a store has of the job of a cube; where that is all it is scored, and the partial folder removed."""
    done = len(store.names().intersection(job.unit_names))  # first: what others finish from here on is counted no more
    solution = merged(job, store)
    if done == job.units:
        scored = replace(solution.cube, scores=metrics.score(solution.cube, job.targets))
        solution = replace(solution, cube=scored)
    made = Published(place(out), solution, done, job.units)
    if overwrite or not (made.is_whole and _is_there(made.path, solution.cube)):
        Output(made.path, "cube", overwrite).write(solution.cube)
    if made.is_whole:
        discard_partial(made.path)
    return made


def _is_there(path: Place, cube: Cube) -> bool:
    """Whether this very cube stands there already."""
    try:
        found = read_cube(path)
    except InputError:
        return False
    return np.array_equal(found.extinction, cube.extinction) and np.array_equal(found.powers, cube.powers)
