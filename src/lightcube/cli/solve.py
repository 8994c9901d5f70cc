"""The command `lightcube solve`."""

import shlex
import time
from typing import Annotated, Protocol

import typer

from lightcube.backward.job import Job
from lightcube.cli import arguments, printing
from lightcube.cli.console import Stopped, compiling, done, err, json_line, listening, out, telling
from lightcube.cli.fields import one_by_one
from lightcube.cli.making import Movie
from lightcube.cli.options import JSON, OUT, OVERWRITE, PICTURES, VERBOSE, threaded
from lightcube.cli.prints import Prints
from lightcube.drawing.poster import Format
from lightcube.errors import InputError
from lightcube.jobs import cluster, publishing, running
from lightcube.jobs.partial import check_partial, open_partial
from lightcube.jobs.reading import load
from lightcube.optics.cube import Cube
from lightcube.verbs import figures, solving, words
from lightcube.verbs.options import Options


@threaded
@one_by_one
def solve(
    pictures: PICTURES,
    output: Annotated[str, OUT],
    options: Options,
    dry_run: Annotated[
        bool,
        typer.Option("--dry-run", help="Say what memory and time it takes, no more.", rich_help_panel="Machine"),
    ] = False,
    memory: Annotated[
        str | None,
        typer.Option(
            help="Use at most so much memory, 2GB or 512MB, by solving in parts.  [default: 6GB]",
            rich_help_panel="Machine",
        ),
    ] = None,
    unit: Annotated[
        str | None,
        typer.Option(
            help="Solve only unit I of N, I/N; publish makes the cube when all are there.", rich_help_panel="Machine"
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            help="Let the workers of a dask scheduler solve, tcp://HOST:PORT, or local ones: local.",
            rich_help_panel="Machine",
        ),
    ] = None,
    start_from: Annotated[
        str | None,
        typer.Option(
            help="Start from this cube, of as many voxels: one picture changed, another material.",
            rich_help_panel="Quality",
        ),
    ] = None,
    making_of: Annotated[
        str | None,
        typer.Option(
            help="Also make a movie of pictures and cube, from clear to finished: .mp4, .webm, .gif, ...",
            rich_help_panel="Output",
        ),
    ] = None,
    movie_format: Annotated[
        Format | None,
        typer.Option(
            "--format", help="Of --making-of: 1080 x 1080, 1080 x 1920 or 1920 x 1080 pixels.", rich_help_panel="Output"
        ),
    ] = None,
    overwrite: Annotated[bool, OVERWRITE] = False,
    verbose: Annotated[bool, VERBOSE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Compute the cube whose shadows are the pictures; what was stopped or killed goes on where it was."""
    prints = Prints(output, overwrite=overwrite)
    prints.check(in_part=unit is not None)
    output = prints.cube
    publishing.check_output(output, overwrite=overwrite)
    check_partial(output)
    if unit is not None and (memory is not None or scheduler is not None):
        other = "--memory" if scheduler is None else "--scheduler"
        raise InputError(f"--unit and {other} both say how many units there are: leave one of them out")
    movie = Movie(making_of, movie_format, overwrite=overwrite)
    movie.check(elsewhere=unit is not None or scheduler is not None)
    which, units = (None, None) if unit is None else arguments.unit(unit)
    budget = None if memory is None else arguments.memory(memory)
    workers = 1 if scheduler is None else cluster.count_workers(scheduler)
    start = None if start_from is None else load(start_from)
    job, said = _asked(pictures, options, budget, units, start, as_json=as_json, quiet=as_json and dry_run)
    del start
    if units is None:
        job = solving.divided(job, output, workers, budget)
    movie.check_job(job)
    prints.check_job(job)
    if dry_run:
        with err.status("timing a smaller cube"), compiling(as_json=as_json):
            needs = solving.needs(job)
        done(as_json, words.needed(needs, verbose=verbose), **needs)
        return
    if scheduler in (None, cluster.LOCAL):
        job = solving.fitted(job, min(workers, job.units))
    if not as_json:
        for line in said(verbose=verbose):
            err.print(line)
    del said  # pictures as they were read
    began = time.monotonic()
    store = open_partial(output, job, overwrite=overwrite)
    pieces = job.pieces if which is None else job.pieces_of(which - 1)
    movie.begin(job)
    with listening("solving", as_json=as_json) as tell:
        finished = (
            running.run(job, pieces, store, tell, movie.making)
            if scheduler is None
            else cluster.run(job, scheduler, store, tell)
        )
    if not finished:
        raise Stopped(
            f"interrupted: {store.folder} holds what was reached; the same command goes on; to publish that, use\n"
            f"  lightcube publish {store.folder}"
        )
    if which is None:
        with compiling(as_json=as_json):
            solution = publishing.finish(job, store, output, overwrite=overwrite).solution
        made = [*movie.write(solution.cube, as_json=as_json), *prints.write(solution.cube, as_json=as_json)]
        seconds = time.monotonic() - began
        if as_json:
            json_line("result", out=output, seconds=seconds, **printing.facts(solution))
        else:
            printing.solved(solution, f"{output} is ready after {words.duration(seconds)}", verbose=verbose)
            for line in made:
                out.print(line)
            out.print(f"turn it by hand: lightcube view {shlex.quote(output)}")
    else:
        done(as_json, f"unit {which} of {units} is in {store.folder}", out=str(store.folder), unit=which, units=units)


class _Sayable(Protocol):
    """Makes what is to be said of a job before it starts."""

    def __call__(self, *, verbose: bool) -> list[str]: ...


def _asked(
    pictures: str,
    options: Options,
    memory: int | None,
    units: int | None,
    start: Cube | None,
    *,
    as_json: bool,
    quiet: bool,
) -> tuple[Job, "_Sayable"]:
    """The job that `solve` is asked for, and a function that makes what is to be said of it."""
    planning = solving.read(pictures, options, told=False)
    with telling("planning", as_json=as_json) as tell:
        planned = planning(solving.rehearsals(None if quiet else tell))
    film = solving.part(pictures, options) if planned.stage is None else None
    job = solving.job(planned, memory=memory, units=units, start=start, film=film)

    def said(*, verbose: bool) -> list[str]:
        remedies = {} if options.paper else words.remedies(planned, solving.rehearsals())
        advice = [] if options.paper else words.what_to_change(planned, remedies)
        numbers = figures.table(planned, planned.order, remedies) if verbose else []
        return [*words.in_short(planned, planned.order), *advice, *numbers]

    return job, said
