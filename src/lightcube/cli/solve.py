"""The commands that make cubes: `solve`, `merge`, `publish`."""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from lightcube import io
from lightcube.backward.job import Job
from lightcube.backward.needs import job_memory
from lightcube.backward.solution import merged
from lightcube.cli import arguments, printing
from lightcube.cli.console import Stopped, compiling, done, err, json_line, listening, out
from lightcube.cli.fields import one_by_one
from lightcube.cli.options import FRAMES, JSON, OUT, OVERWRITE
from lightcube.errors import InputError
from lightcube.jobs import cluster, cubes, running
from lightcube.jobs.partial import DiskStore, check_partial, discard_partial, load_job, open_partial, published_path
from lightcube.scoring import metrics
from lightcube.verbs import solving, staging, words
from lightcube.verbs.options import Options


@one_by_one
def solve(
    frames: FRAMES,
    output: Annotated[str, OUT],
    options: Options,
    memory: Annotated[
        str | None, typer.Option(help="Use at most so much, 2GB or 512MB, by solving in parts.  [default: 4GB]")
    ] = None,
    unit: Annotated[
        str | None, typer.Option(help="Solve only unit I of N, I/N; merge makes the cube when all are there.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(help="Let the workers of a dask scheduler solve, tcp://HOST:PORT, or local ones: local."),
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what memory and time it takes, and solve nothing.")
    ] = False,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Compute the cube whose shadows are the frames; what was stopped or killed goes on where it was."""
    io.check_cube_target(output, overwrite=overwrite)
    check_partial(output)
    if unit is not None and (memory is not None or scheduler is not None):
        other = "--memory" if scheduler is None else "--scheduler"
        raise InputError(f"--unit and {other} both say how many units there are: leave one of them out")
    which, units = (None, None) if unit is None else arguments.unit(unit)
    budget = None if memory is None else arguments.memory(memory)
    workers = 1 if scheduler is None else cluster.count_workers(scheduler)
    job, said = _asked(frames, options, budget, units, as_json=as_json)
    if units is None:
        job = solving.divided(job, output, workers, budget)
    if dry_run:
        with err.status("timing a smaller cube"), compiling(as_json=as_json):
            needs = solving.needs(job)
        done(as_json, words.needed(needs), **needs)
        return
    if scheduler in (None, cluster.LOCAL):
        solving.check_memory(job_memory(job) * min(workers, job.units))
    if not as_json:
        for line in said():
            err.print(line)
    del said  # pictures as they were read
    began = time.monotonic()
    store = open_partial(output, job, overwrite=overwrite)
    pieces = job.pieces if which is None else job.pieces_of(which - 1)
    with listening("solving", as_json=as_json) as tell:
        finished = (
            running.run(job, pieces, store, tell) if scheduler is None else cluster.run(job, scheduler, store, tell)
        )
    if not finished:
        raise Stopped(
            f"interrupted: {store.folder} holds what was reached; the same command goes on; to publish that, use\n"
            f"  lightcube publish {store.folder}"
        )
    if which is None:
        _finish(job, store, output, time.monotonic() - began, overwrite=overwrite, as_json=as_json)
    else:
        done(as_json, f"unit {which} of {units} is in {store.folder}", out=str(store.folder), unit=which, units=units)


def merge(
    partial: Annotated[str, typer.Argument(help="The unfinished cube, NAME.zarr.partial, with all its units.")],
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Make the cube of units that were solved one by one."""
    output = published_path(partial)
    io.check_cube_target(output, overwrite=overwrite)
    began, store = time.monotonic(), DiskStore(partial)
    job = load_job(partial)
    missing = [str(number) for number, name in enumerate(job.unit_names, 1) if name not in store.names()]
    if missing:
        raise InputError(
            f"{partial} lacks unit {', '.join(missing)} of {job.units}: solve with --unit {missing[0]}/{job.units}"
        )
    _finish(job, store, output, time.monotonic() - began, overwrite=overwrite, as_json=as_json)


def publish(
    partial: Annotated[str, typer.Argument(help="The unfinished cube, NAME.zarr.partial.")],
    overwrite: Annotated[bool, OVERWRITE] = False,
) -> None:
    """Turn the unfinished cube of an interrupted solve into a cube file."""
    out.print(f"{cubes.publish(partial, overwrite=overwrite)}")


def _asked(
    frames: str, options: Options, memory: int | None, units: int | None, *, as_json: bool
) -> tuple[Job, Callable[[], list[str]]]:
    """The job that `solve` is asked for, and a function that makes what is to be said of it."""
    if io.is_stage(frames):
        stage, wanted = staging.read(frames, options)
        return staging.job(stage, wanted, options, memory=memory, units=units), lambda: staging.in_short(stage, wanted)
    options = solving.settled(options)
    pictures = solving.read(frames, options)
    with err.status("rehearsing"), compiling(as_json=as_json):
        prepared = solving.prepare(pictures, options)
    job = solving.job(prepared, options, memory=memory, units=units)
    return job, lambda: [*words.in_short(prepared, options), *words.what_to_change(prepared, options)]


def _finish(job: Job, store: DiskStore, output: str | Path, seconds: float, *, overwrite: bool, as_json: bool) -> None:
    """Make the cube of a job that is finished, score it, and say so."""
    solution = merged(job, store)
    with compiling(as_json=as_json):
        scores = metrics.score(solution.cube, job.frames)
    io.save(replace(solution.cube, scores=scores), output, overwrite=overwrite)
    discard_partial(output)
    if as_json:
        predicted = solution.cube.provenance.get("predicted")
        json_line("result", out=str(output), seconds=seconds, **printing.facts(solution), predicted=predicted, **scores)
    else:
        printing.solved(solution, scores, output, seconds)
