"""The command line: parses, calls, prints."""

import sys
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from numpy.typing import NDArray

from lightcube import arguments, backward, between, demo, forward, io, metrics, plots, reports, solving
from lightcube.cli_options import (
    ANGLES,
    BLACK_LEVEL,
    ELEVATION,
    FIT,
    FRAME_WIDTH,
    FRAMES,
    HOLD,
    LAMP,
    LAMP_MAX,
    LAMP_POWER,
    MAX_EXTINCTION,
    ORDER,
    PAPER,
    SHAPE,
    SHIFT,
    SPAN,
    TRANSFER,
    N,
)
from lightcube.console import ctrl_c, err, json_document, json_line, out, plain_warnings, prepare, progress
from lightcube.cube import Cube
from lightcube.errors import InputError
from lightcube.fitting import check_fit, fit_to_views, frames_from_targets
from lightcube.frames import Frames
from lightcube.scene.tracer import scene_frames, scene_views
from lightcube.sheet import beside_targets, contact_sheet
from lightcube.units import Step

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Pictures in, a cube of coloured shadows out.",
)

OUT = typer.Option("-o", "--out", help="Where to write; the suffix says what.")
OVERWRITE = typer.Option("--overwrite", help="Replace the target if it exists.")
JSON = typer.Option("--json", help="Print JSON for machines.")
FPS = typer.Option("--fps", help="Pictures per second of a movie.")


@app.command()
def trace(
    scene: Annotated[
        str, typer.Argument(help="A scene file (TOML), or the name of a scene that comes with lightcube.")
    ],
    output: Annotated[Path, OUT],
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
    _done(as_json, f"{len(views)} pictures of {columns} x {rows} in {output}", out=str(output), frames=len(views))


@app.command()
def check(
    frames: FRAMES,
    n: N = None,
    shape: SHAPE = None,
    frame_width: FRAME_WIDTH = None,
    fit_mode: FIT = "crop",
    angles: ANGLES = None,
    span: SPAN = None,
    elevation: ELEVATION = None,
    paper: PAPER = False,
    order: ORDER = "given",
    shift: SHIFT = 0,
    lamp: LAMP = None,
    lamp_power: LAMP_POWER = None,
    lamp_max: LAMP_MAX = None,
    hold: HOLD = None,
    black: BLACK_LEVEL = None,
    max_extinction: MAX_EXTINCTION = None,
    transfer: TRANSFER = "srgb",
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say before solving what can be known: what contradicts itself, how full the cube is, how good it will be."""
    said = solving.Options(
        n=n,
        shape=shape,
        frame_width=frame_width,
        fit=fit_mode,
        angles=angles,
        span=span,
        elevation=elevation,
        paper=paper,
        order=order,
        shift=shift,
        lamp=lamp,
        lamp_power=lamp_power,
        lamp_max=lamp_max,
        hold=hold,
        black=black,
        max_extinction=max_extinction,
        transfer=transfer,
    )
    options = solving.settled(said)
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
def solve(
    frames: FRAMES,
    output: Annotated[Path, OUT],
    n: N = None,
    shape: SHAPE = None,
    size_mm: Annotated[float, typer.Option(help="Longest side of the cube in mm.")] = 100.0,
    frame_width: FRAME_WIDTH = None,
    fit_mode: FIT = "crop",
    angles: ANGLES = None,
    span: SPAN = None,
    elevation: ELEVATION = None,
    paper: PAPER = False,
    order: ORDER = "given",
    shift: SHIFT = 0,
    quality: Annotated[
        backward.Quality | None,
        typer.Option(help="At most 30, 200 or 1000 passes.  [default: normal]"),
    ] = None,
    method: Annotated[str, typer.Option(help=f"One of {', '.join(backward.METHODS)}.")] = "display",
    iterations: Annotated[int | None, typer.Option(help="At most so many passes, instead of --quality.")] = None,
    lamp: LAMP = None,
    lamp_power: LAMP_POWER = None,
    lamp_max: LAMP_MAX = None,
    hold: HOLD = None,
    black: BLACK_LEVEL = None,
    max_extinction: MAX_EXTINCTION = None,
    transfer: TRANSFER = "srgb",
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Compute the cube whose shadows are the frames."""
    io.check_cube_target(output, overwrite=overwrite)
    _check_partial(output, overwrite=overwrite)
    said = solving.Options(
        n=n,
        shape=shape,
        size_mm=size_mm,
        frame_width=frame_width,
        fit=fit_mode,
        angles=angles,
        span=span,
        elevation=elevation,
        paper=paper,
        order=order,
        shift=shift,
        method=method,
        lamp=lamp,
        lamp_power=lamp_power,
        lamp_max=lamp_max,
        hold=hold,
        black=black,
        max_extinction=max_extinction,
        quality=quality,
        iterations=iterations,
        transfer=transfer,
    )
    options = solving.settled(said)
    with err.status("rehearsing"):
        prepared = solving.prepare(frames, options)
    solving.check_room(prepared, options)
    if not as_json:
        for line in [*solving.in_short(prepared, options), *solving.what_to_change(prepared, options)]:
            err.print(line)
    began = time.monotonic()
    with ctrl_c() as stopped, progress("solving", as_json=as_json) as advance:
        looked = 0.0

        def step(step: Step) -> bool:
            nonlocal looked
            figures = {}
            if step.shown is not None and time.monotonic() - looked > 1.0:  # looking costs as much as half a pass
                figures = {"PSNR": metrics.mean_psnr(step.shown(), prepared.frames)}
                looked = time.monotonic()
            advance(round(step.done * step.iterations), step.iterations, **figures)
            return stopped()

        solution = solving.solve(prepared, options, callback=step, store=io.PartialStore(output))
    cube = solution.cube
    if cube.status == "interrupted":
        partial = io.partial_path(output)
        err.print(f"interrupted: {partial} holds what was reached; publish it with")
        err.print(f"  lightcube publish {partial}")
        raise typer.Exit(130)
    scores = metrics.score(cube, prepared.frames)
    io.publish(io.write_partial(output, replace(cube, scores=scores)), overwrite=overwrite)
    seconds = time.monotonic() - began
    if as_json:
        predicted = solving.said(prepared.plan.prediction)
        json_line("result", out=str(output), seconds=seconds, **reports.facts(solution), predicted=predicted, **scores)
    else:
        reports.solved(solution, scores, output, seconds)


@app.command()
def play(
    cube: Annotated[Path, typer.Argument(help="A cube.")],
    output: Annotated[Path, OUT],
    angles: Annotated[str | None, typer.Option(help="Turntable angles in degrees, A,B,C.")] = None,
    start: Annotated[float | None, typer.Option("--from", help="First angle in degrees.  [default: 0]")] = None,
    end: Annotated[float | None, typer.Option("--to", help="Where the turn ends, in degrees.  [default: 360]")] = None,
    count: Annotated[int | None, typer.Option(help="Number of pictures of the turn.  [default: 120 or more]")] = None,
    stops: Annotated[bool, typer.Option("--stops", help="Play just the views that the cube was made for.")] = False,
    scale: Annotated[
        int | None, typer.Option(help="Enlarge each pixel to a square of so many.  [default: movies about 256 high]")
    ] = None,
    target: Annotated[
        bool, typer.Option("--target", help="Put the wanted picture of the nearest stop to the right.")
    ] = False,
    no_mask: Annotated[bool, typer.Option("--no-mask", help="Show the whole screen, not the picture window.")] = False,
    fps: Annotated[float, FPS] = 25.0,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Cast the cube's shadows: a movie, a folder of PNGs, or .npy, by suffix."""
    io.check_pictures_target(output, overwrite=overwrite)
    if target and no_mask:
        raise InputError("--target shows the picture window: leave out --no-mask")
    loaded = io.load(cube)
    turned = arguments.play_angles(loaded, angles, start, end, count, stops=stops)
    views = forward.views_at(loaded, turned, whole_screen=no_mask) if not stops or no_mask else loaded.views
    powers = loaded.powers if stops else forward.lamp_at(loaded, turned)
    with progress("playing", as_json=as_json) as advance:
        pictures = forward.cast(loaded, views, powers)
        if target:
            pictures = beside_targets(pictures, frames_from_targets(loaded), turned)
        io.write_pictures(
            output,
            _counted(pictures, len(views), advance),
            count=len(views),
            transfer=loaded.transfer,
            fps=fps,
            scale=arguments.movie_scale(output, views) if scale is None else scale,
            views=None if target else views,
            names=loaded.names if stops else None,
            overwrite=overwrite,
        )
    _done(as_json, f"{len(views)} pictures in {output}", out=str(output), frames=len(views))


@app.command()
def score(
    cube: Annotated[Path, typer.Argument(help="A cube.")],
    frames: Annotated[
        Path | None, typer.Argument(help="The pictures it was made from; default its own targets.")
    ] = None,
    sheet: Annotated[
        Path | None, typer.Option(help="Draw a contact sheet: wanted, shown, difference (PNG, WebP or JPEG).")
    ] = None,
    between_frames: Annotated[
        bool, typer.Option("--between", help="Add PSNR and SSIM between the frames, and how far each one stands.")
    ] = False,
    robust: Annotated[bool, typer.Option("--robust", help="Add what a set-up that is a little off costs.")] = False,
    plot: Annotated[Path | None, typer.Option(help="Draw PSNR against the angle (PNG or SVG); --between.")] = None,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Compare what a cube really casts with what was wanted."""
    if sheet is not None:
        io.check_sheet_target(sheet, overwrite=overwrite)
    if plot is not None and plot == sheet:
        raise InputError(f"--sheet and --plot both name {plot}: give them two names")
    if plot is not None:
        io.check_figure_target(plot, overwrite=overwrite)
    loaded = io.load(cube)
    wanted = frames_from_targets(loaded) if frames is None else _refitted(loaded, frames)
    scores = metrics.score(loaded, wanted)
    if between_frames or plot is not None:
        curve = between.curve(loaded, wanted)
        columns = {"angles": curve.angles, "nearest": curve.nearest, "psnr": curve.psnr, "ssim": curve.ssim}
        scores["between"] = {name: column.tolist() for name, column in {**columns, "lobe_deg": curve.lobes}.items()}
        if plot is not None:
            io.write_figure(plot, plots.between_plot({"": curve}), overwrite=overwrite)
    if robust:
        scores["robust"] = between.robust(loaded, wanted)
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
    cube: Annotated[Path, typer.Argument(help="A cube.")],
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
    partial: Annotated[Path, typer.Argument(help="The unfinished cube, NAME.zarr.partial.")],
    overwrite: Annotated[bool, OVERWRITE] = False,
) -> None:
    """Turn the unfinished cube of an interrupted solve into a cube file."""
    out.print(f"{io.publish(partial, overwrite=overwrite)}")


@app.command("demo")
def demo_command(
    output: Annotated[Path, typer.Option("-o", "--out", help="Folder for what the demo makes.")] = Path("out"),
    paper: Annotated[bool, typer.Option("--paper", help="Redo the paper: a 3x3x3 cube, there and back.")] = False,
) -> None:
    """Make a cube of photographs and one of a traced scene, into a folder."""
    if paper:
        demo.paper(output)
    else:
        demo.run(output)


def main() -> None:
    """Run the command line: exit code 0, 2 for what the user can mend, 130 for Ctrl-C."""
    prepare()
    code: int | None = None
    try:
        with plain_warnings():
            code = app(args=sys.argv[1:] or ["--help"], standalone_mode=False)
    except InputError as error:
        err.print(f"lightcube: {error}")
        code = 2
    except typer.Exit as stop:
        code = stop.exit_code
        if isinstance(stop.__context__, KeyboardInterrupt):
            err.print("interrupted: no file was finished")
    except (KeyboardInterrupt, typer.Abort):
        err.print("interrupted: no file was finished")
        code = 130
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


def _done(as_json: bool, sentence: str, **fields: object) -> None:
    if as_json:
        json_line("result", **fields)
    else:
        out.print(sentence)


def _check_partial(output: Path, *, overwrite: bool) -> None:
    """Refuse to run over an interrupted solve unless it is to be replaced; never touch what is none."""
    partial = io.partial_path(output)
    if not partial.exists():
        return
    if not io.is_partial(partial):
        raise InputError(f"{partial} stands where the unfinished cube would, and is none: move it or use another name")
    if not overwrite:
        raise InputError(f"{partial} holds an interrupted solve: publish it, or use --overwrite to start anew")


def _counted(
    pictures: Iterable[NDArray[np.float32]], count: int, advance: Callable[..., None]
) -> Iterator[NDArray[np.float32]]:
    for number, picture in enumerate(pictures, 1):
        yield picture
        advance(number, count)


def _refitted(cube: Cube, frames: Path) -> Frames:
    """Pictures as `solve` fitted them to the cube, in its order."""
    pictures = io.read_pictures(frames, transfer=cube.transfer)
    order = cube.provenance.get("order", range(len(pictures)))
    if len(order) == len(pictures):
        images, names = (tuple(each[picture] for picture in order) for each in (pictures.images, pictures.names))
        pictures = replace(pictures, images=images, names=names)
    if pictures.angles is not None and len(pictures) == len(cube.views):
        apart = np.abs(np.remainder(pictures.angles - cube.views.angles + 180, 360) - 180)
        if np.max(apart) > 1e-6:
            raise InputError(
                f"{frames} says other angles than the cube was made for: give the pictures it was made from"
            )
    return fit_to_views(pictures, cube.views, check_fit(cube.provenance.get("fit", "crop")))
