"""Making a cube file of what is there of an unfinished one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from lightcube.backward.job import Job
from lightcube.backward.solution import Solution, merged
from lightcube.io._places import Place, place
from lightcube.io.outputs import Output
from lightcube.jobs.partial import DiskStore, begun_store, discard_partial, load_job, published_path
from lightcube.optics.checks import checked
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
    Output(out, "cube", overwrite).check()
    store = begun_store(place(partial))
    return finish(load_job(partial), store, out, overwrite=overwrite)


def finish(job: Job, store: DiskStore, out: str | Path, *, overwrite: bool = False) -> Published:
    """Save what a store has of the job of a cube; where that is all it is scored, and the partial folder removed."""
    done = len(store.names().intersection(job.unit_names))  # first: what others finish from here on is counted no more
    solution = merged(job, store)
    if done == job.units:
        scored = replace(solution.cube, scores=metrics.score(solution.cube, job.targets))
        solution = replace(solution, cube=scored)
    made = Published(place(out), solution, done, job.units)
    Output(made.path, "cube", overwrite).write(solution.cube)
    if made.is_whole:
        discard_partial(made.path)
    return made
