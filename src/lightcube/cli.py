"""The command line: parses, calls, prints."""

import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from lightcube import (
    arguments,
    between,
    cli_play,
    cli_report,
    cli_stage,
    cli_view,
    cluster,
    demo,
    forward,
    io,
    metrics,
    plots,
    reports,
    running,
    solving,
    staging,
)
from lightcube.cli_options import FPS, FRAMES, JSON, OUT, OVERWRITE, Options, one_by_one, threaded
from lightcube.console import done, err, json_document, json_line, out, plain_warnings, prepare, progress
from lightcube.errors import InputError
from lightcube.fitting import frames_from_targets
from lightcube.job import Job
from lightcube.needs import job_memory
from lightcube.scene.tracer import scene_frames, scene_views
from lightcube.sheet import contact_sheet
from lightcube.solution import merged

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Pictures in, a cube of coloured shadows out.",
)


@app.command()
@threaded
def trace(
    scene: Annotated[
        str, typer.Argument(help="A scene file (TOML), or the name of a scene that comes with lightcube.")
    ],
    output: Annotated[str, OUT],
    frames: Annotated[int | None, typer.Option(help="Number of pictures; default the scene's own.")] = None,
    size: Annotated[
        str | None, typer.Option(help="Size of the pictures, WIDTHxHEIGHT; default the scene's own.")
    ] = None,
    span: Annotated[float | None, typer.Option(help="Degrees that the views are spread over.")] = None,
    elevation: Annotated[float | None, typer.Option(help="Elevation of the lamp in degrees.")] = None,
    fps: Annotated[float, FPS] = 25.0,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Ray-trace a moving scene: a folder of PNGs, or a movie by suffix."""
    described = io.read_scene(scene)
    io.check_pictures_target(output, overwrite=overwrite)
    shape = None
    if size is not None:
        width, height = arguments.whole_numbers(size, "x", "--size", 2)
        shape = (width, height)
    grid, views = scene_views(described, frames, shape, span, elevation)
    solving.check_memory(24 * len(views) * views.picture_shape[0] * views.picture_shape[1])
    with progress("tracing", as_json=as_json) as advance:
        made = scene_frames(described, views, grid, callback=advance)
    io.write_pictures(output, made.pictures, fps=fps, views=views, overwrite=overwrite)
    rows, columns = views.picture_shape
    done(as_json, f"{len(views)} pictures of {columns} x {rows} in {output}", out=str(output), frames=len(views))


@app.command()
@threaded
@one_by_one
def check(frames: FRAMES, options: Options, as_json: Annotated[bool, JSON] = False) -> None:
    """Say before solving what can be known: what contradicts itself, how full the cube is, how good it will be."""
    if io.is_stage(frames):
        cli_stage.checked(*io.read_stage_frames(frames, transfer=options.transfer), as_json=as_json)
        return
    options = solving.settled(options)
    with err.status("rehearsing"):
        prepared = solving.prepare(frames, options)
    advice = solving.what_to_change(prepared, options)
    facts = solving.facts(prepared, options)
    if as_json:
        json_document({**facts, "advice": advice})
        return
    for line in [*solving.in_short(prepared, options), "", *solving.table(facts), "", *advice]:
        out.print(line)


@app.command()
@threaded
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
    io.check_partial(output)
    if unit is not None and (memory is not None or scheduler is not None):
        other = "--memory" if scheduler is None else "--scheduler"
        raise InputError(f"--unit and {other} both say how many units there are: leave one of them out")
    which, units = (None, None) if unit is None else arguments.unit(unit)
    budget = None if memory is None else arguments.memory(memory)
    workers = 1 if scheduler is None else cluster.count_workers(scheduler)
    job, said = _asked(frames, options, budget, units)
    if units is None:
        job = solving.divided(job, output, workers, budget)
    if dry_run:
        with err.status("timing a smaller cube"):
            needs = solving.needs(job)
        done(as_json, reports.needed(needs), **needs)
        return
    if scheduler in (None, cluster.LOCAL):
        solving.check_memory(job_memory(job) * min(workers, job.units))
    if not as_json:
        for line in said():
            err.print(line)
    del said  # pictures as they were read
    began = time.monotonic()
    store = io.open_partial(output, job, overwrite=overwrite)
    pieces = job.pieces if which is None else job.pieces_of(which - 1)
    if not (
        running.run(job, pieces, store, as_json=as_json)
        if scheduler is None
        else cluster.run(job, scheduler, store, as_json=as_json)
    ):
        raise _Stopped(
            f"interrupted: {store.folder} holds what was reached; the same command goes on; to publish that, use\n"
            f"  lightcube publish {store.folder}"
        )
    if which is None:
        _finish(job, store, output, time.monotonic() - began, overwrite=overwrite, as_json=as_json)
    else:
        done(as_json, f"unit {which} of {units} is in {store.folder}", out=str(store.folder), unit=which, units=units)


@app.command()
@threaded
def merge(
    partial: Annotated[str, typer.Argument(help="The unfinished cube, NAME.zarr.partial, with all its units.")],
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Make the cube of units that were solved one by one."""
    output = io.published_path(partial)
    io.check_cube_target(output, overwrite=overwrite)
    began, store = time.monotonic(), io.DiskStore(partial)
    job = io.load_job(partial)
    missing = [str(number) for number, name in enumerate(job.unit_names, 1) if name not in store.names()]
    if missing:
        raise InputError(
            f"{partial} lacks unit {', '.join(missing)} of {job.units}: solve with --unit {missing[0]}/{job.units}"
        )
    _finish(job, store, output, time.monotonic() - began, overwrite=overwrite, as_json=as_json)


for _command in (cli_play.play, cli_view.view, cli_report.report):
    app.command()(threaded(_command))


@app.command()
@threaded
def score(
    cube: Annotated[str, typer.Argument(help="A cube.")],
    frames: Annotated[
        str | None, typer.Argument(help="The pictures it was made from; default its own targets.")
    ] = None,
    sheet: Annotated[
        str | None, typer.Option(help="Draw a contact sheet: wanted, shown, difference (PNG, WebP or JPEG).")
    ] = None,
    between_frames: Annotated[
        bool, typer.Option("--between", help="Add PSNR and SSIM between the frames, and how far each one stands.")
    ] = False,
    robust: Annotated[bool, typer.Option("--robust", help="Add what a set-up that is a little off costs.")] = False,
    plot: Annotated[str | None, typer.Option(help="Draw PSNR against the angle (PNG or SVG); --between.")] = None,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Compare what a cube really casts with what was wanted."""
    if sheet is not None:
        io.check_sheet_target(sheet, overwrite=overwrite)
    if plot is not None and sheet is not None and Path(plot) == Path(sheet):
        raise InputError(f"--sheet and --plot both name {plot}: give them two names")
    if plot is not None:
        io.check_figure_target(plot, overwrite=overwrite)
    loaded = io.load(cube)
    wanted = frames_from_targets(loaded) if frames is None else cli_report.refitted(loaded, frames)
    scores = metrics.score(loaded, wanted)
    if between_frames or plot is not None:
        with progress("between the frames", as_json=False) as advance:  # what is printed is one document
            curve = between.curve(loaded, wanted, callback=advance)
        columns = {"angles": curve.angles, "nearest": curve.nearest, "psnr": curve.psnr, "ssim": curve.ssim}
        scores["between"] = {name: column.tolist() for name, column in {**columns, "lobe_deg": curve.lobes}.items()}
        if plot is not None:
            io.write_figure(plot, plots.between_plot({"": curve}), overwrite=overwrite)
    if robust:
        with progress("a set-up that is off", as_json=False) as advance:
            scores["robust"] = between.robust(loaded, wanted, callback=advance)
    if sheet is not None:
        shown = forward.play(loaded)
        picture = contact_sheet(shown, wanted, [view["psnr"] for view in scores["views"]])
        io.write_sheet(sheet, picture, overwrite=overwrite)
    if as_json:
        json_document(scores)
    else:
        reports.scored(scores)


@app.command()
def info(
    cube: Annotated[str, typer.Argument(help="A cube.")],
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say what is in a cube file."""
    facts = metrics.facts(io.load(cube))
    if as_json:
        json_document(facts)
        return
    for name, value in facts.items():
        out.print(f"{name:>26}  {arguments.short(value)}")


@app.command()
def publish(
    partial: Annotated[str, typer.Argument(help="The unfinished cube, NAME.zarr.partial.")],
    overwrite: Annotated[bool, OVERWRITE] = False,
) -> None:
    """Turn the unfinished cube of an interrupted solve into a cube file."""
    out.print(f"{io.publish(partial, overwrite=overwrite)}")


@app.command()
@threaded
def bench(
    n: Annotated[int, typer.Option("--n", min=2, max=2000, help="Voxels along each side of the cube.")] = 300,
    views: Annotated[
        int | None, typer.Option(min=1, max=100_000, help="Number of pictures.  [default: as many as voxels]")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Time everything once only; the figures scatter.")] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Measure this machine and what lightcube makes of it, beside others: tables in Markdown."""
    from lightcube import bench as benches
    from lightcube.bench.report import markdown

    pictures = n if views is None else views
    solving.check_memory(benches.memory(n, pictures))
    found = benches.measure(n, pictures, lambda what: err.print(f"{what} ..."), quick=quick)
    if as_json:
        json_document(found)
    else:
        out.print("\n".join(markdown(found)))


app.add_typer(cli_stage.app, name="stage")


@app.command("demo")
@threaded
def demo_command(
    output: Annotated[Path, typer.Option("-o", "--out", help="Folder for what the demo makes.")] = Path("out"),
    paper: Annotated[bool, typer.Option("--paper", help="Redo the paper: a 3x3x3 cube, there and back.")] = False,
) -> None:
    """Make a cube of photographs and one of a traced scene, into a folder."""
    if paper:
        demo.paper(output)
    else:
        demo.run(output)


#: The exit code after Ctrl-C.
_INTERRUPTED = 130


class _Stopped(Exception):  # noqa: N818 - nothing is wrong
    """Ctrl-C, where something is kept: says what."""


def main() -> None:
    """Run the command line: exit code 0, 2 for what the user can mend, 130 for Ctrl-C."""
    prepare()
    code: int | None = None
    try:
        with plain_warnings():
            code = app(args=sys.argv[1:] or ["--help"], standalone_mode=False)
        if code == _INTERRUPTED:  # what typer makes of Ctrl-C
            err.print("interrupted: no file was finished")
    except InputError as error:
        err.print(f"lightcube: {error}")
        code = 2
    except _Stopped as stop:
        err.print(stop)
        code = _INTERRUPTED
    except (KeyboardInterrupt, typer.Abort):
        err.print("interrupted: no file was finished")
        code = _INTERRUPTED
    except typer.TyperException as error:
        err.print(f"lightcube: {error.format_message()}".replace("Value error, ", ""))
        code = 2
    except OSError as error:
        err.print(f"lightcube: {error.filename or 'the system'}: {error.strerror or error}")
        code = 2
    except MemoryError:
        err.print("lightcube: the machine has not enough memory for this: use a smaller cube or fewer pictures")
        code = 2
    sys.exit(code or 0)


def _asked(frames: str, options: Options, memory: int | None, units: int | None) -> tuple[Job, Callable[[], list[str]]]:
    """The job that `solve` is asked for, and a function that makes what is to be said of it."""
    if io.is_stage(frames):
        stage, wanted = staging.read(frames, options)
        return staging.job(stage, wanted, options, memory=memory, units=units), lambda: staging.in_short(stage, wanted)
    options = solving.settled(options)
    with err.status("rehearsing"):
        prepared = solving.prepare(frames, options)
    job = solving.job(prepared, options, memory=memory, units=units)
    return job, lambda: [*solving.in_short(prepared, options), *solving.what_to_change(prepared, options)]


def _finish(
    job: Job, store: io.DiskStore, output: str | Path, seconds: float, *, overwrite: bool, as_json: bool
) -> None:
    """Make the cube of a job that is finished, score it, and say so."""
    solution = merged(job, store)
    scores = metrics.score(solution.cube, job.frames)
    io.save(replace(solution.cube, scores=scores), output, overwrite=overwrite)
    io.discard_partial(output)
    if as_json:
        predicted = solution.cube.provenance.get("predicted")
        json_line("result", out=str(output), seconds=seconds, **reports.facts(solution), predicted=predicted, **scores)
    else:
        reports.solved(solution, scores, output, seconds)
