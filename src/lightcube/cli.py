"""The command line: parses, calls, prints."""

import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from numpy.typing import NDArray

from lightcube import arguments, backward, between, consistency, demo, forward, io, metrics, plots
from lightcube.console import ctrl_c, err, json_document, json_line, out, plain_warnings, prepare, progress
from lightcube.cube import Cube
from lightcube.errors import InputError
from lightcube.fitting import Fit, check_fit, fit, fit_report, fit_to_views, frames_from_targets
from lightcube.frames import Frames, Pictures
from lightcube.geometry import held
from lightcube.problem import Lamp
from lightcube.scene.tracer import scene_frames, scene_views
from lightcube.sheet import beside_targets, contact_sheet
from lightcube.transfer import Transfer
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
_FIT = "Pictures of another aspect than the first: cut their edges, leave the rest of the frame free, or distort."
_LAMP = "One power per picture and colour, one per colour, or fixed.  [default: per-view]"
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
    _check_memory(24 * len(views) * views.picture_shape[0] * views.picture_shape[1])
    with progress("tracing", as_json=as_json) as advance:
        made = scene_frames(described, views, grid, callback=advance)
    io.write_pictures(output, made.pictures, fps=fps, views=views, overwrite=overwrite)
    rows, columns = views.picture_shape
    _done(as_json, f"{len(views)} pictures of {columns} x {rows} in {output}", out=str(output), frames=len(views))


@app.command()
def solve(
    frames: Annotated[Path, typer.Argument(help="A folder of pictures, an animated image or a video.")],
    output: Annotated[Path, OUT],
    n: Annotated[int | None, typer.Option("--n", help="Side of the cube in voxels.  [default: 128]")] = None,
    shape: Annotated[str | None, typer.Option(help="Voxels along each axis, NZ,NY,NX, instead of --n.")] = None,
    size_mm: Annotated[float, typer.Option(help="Longest side of the cube in mm.")] = 100.0,
    frame_width: Annotated[float, typer.Option(help="Width of the pictures as a fraction of the cube's.")] = 1.0,
    fit_mode: Annotated[Fit, typer.Option("--fit", help=_FIT)] = "crop",
    angles: Annotated[str | None, typer.Option(help="Turntable angles in degrees, A,B,C, one per picture.")] = None,
    span: Annotated[
        float | None, typer.Option(help="Degrees to spread the views over, evenly.  [default: 180, raised 360]")
    ] = None,
    elevation: Annotated[
        float | None, typer.Option(help="Elevation of the lamp in degrees; 0 is level, 35 holds most.  [default: 0]")
    ] = None,
    method: Annotated[str, typer.Option(help=f"One of {', '.join(backward.METHODS)}.")] = "display",
    iterations: Annotated[
        int | None, typer.Option(help="At most so many passes; default the method's own (display: 200).")
    ] = None,
    lamp: Annotated[Lamp | None, typer.Option(help=_LAMP)] = None,
    lamp_power: Annotated[float | None, typer.Option(help="Power of a fixed lamp, linear light; 1 is white.")] = None,
    lamp_max: Annotated[
        float | None, typer.Option(help="Largest power of the lamp, at least 1.  [default: 16]")
    ] = None,
    hold: Annotated[float, typer.Option(help="Degrees around its stop over which each picture shall stand.")] = 0.0,
    max_extinction: Annotated[
        float | None, typer.Option(help="Largest extinction of the material, 1/mm; default none.")
    ] = None,
    transfer: Annotated[Transfer, typer.Option(help="How picture values become linear light.")] = "srgb",
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Compute the cube whose shadows are the frames."""
    io.check_cube_target(output, overwrite=overwrite)
    _check_partial(output, overwrite=overwrite)
    most = np.inf if max_extinction is None else max_extinction
    backward.check_options(method, lamp, lamp_power, lamp_max, most, iterations)
    grid = arguments.grid(n, shape, size_mm)
    _check_memory(backward.memory_needed(method, grid, (1, 1), 1))
    pictures = io.read_pictures(frames, transfer=transfer)
    turned = None if angles is None else arguments.numbers(angles, "--angles")
    fitted = fit(pictures, grid, angles=turned, span=span, elevation=elevation, frame_width=frame_width, fit=fit_mode)
    raised = float(fitted.views.elevations[0])
    views = len(held(fitted.views, hold, grid))
    _check_memory(backward.memory_needed(method, grid, fitted.views.picture_shape, views, raised))
    if hold and not as_json:
        err.print(
            f"held {hold:g} degrees either way: {views // len(fitted)} angles a picture, and as many times the work"
        )
    _say_before(pictures, fitted, fit_mode, as_json=as_json)
    began = time.monotonic()
    with ctrl_c() as stopped, progress("solving", as_json=as_json) as advance:
        looked = 0.0

        def step(step: Step) -> bool:
            nonlocal looked
            figures = {}
            if step.shown is not None and time.monotonic() - looked > 1.0:  # looking costs as much as half a pass
                figures = {"PSNR": metrics.mean_psnr(step.shown(), fitted)}
                looked = time.monotonic()
            advance(round(step.done * step.iterations), step.iterations, **figures)
            return stopped()

        solution = backward.solve(
            fitted,
            grid,
            method=method,
            lamp=lamp,
            lamp_power=lamp_power,
            lamp_max=lamp_max,
            hold=hold,
            max_extinction=most,
            iterations=iterations,
            callback=step,
            store=io.PartialStore(output),
            provenance={"fit": fit_mode},
        )
    _finish(solution, fitted, output, time.monotonic() - began, overwrite=overwrite, as_json=as_json)


def _finish(
    solution: backward.Solution, frames: Frames, output: Path, seconds: float, *, overwrite: bool, as_json: bool
) -> None:
    """Score, write and report what `solve` found."""
    cube = solution.cube
    if cube.status == "interrupted":
        partial = io.partial_path(output)
        err.print(f"interrupted: {partial} holds what was reached; publish it with")
        err.print(f"  lightcube publish {partial}")
        raise typer.Exit(130)
    scores = metrics.score(cube, frames)
    io.publish(io.write_partial(output, replace(cube, scores=scores)), overwrite=overwrite)
    if as_json:
        json_line(
            "result",
            out=str(output),
            seconds=seconds,
            iterations=len(solution.residuals),
            residual=float(solution.residuals[-1]),
            stop_reason=solution.stop_reason,
            rejected=solution.rejected.tolist(),
            undetermined=solution.undetermined,
            **scores,
        )
        return
    if len(solution.rejected):
        out.print(f"{len(solution.rejected)} inconsistent pixel values thrown out: {_by_view(solution.rejected, cube)}")
    if solution.undetermined:
        out.print(f"{solution.undetermined} voxel values that nothing determines are transparent")
    out.print(
        f"{output}: PSNR {scores['psnr_mean']:.1f} dB (worst {scores['psnr_min']:.1f}), "
        f"SSIM {scores['ssim_mean']:.3f}, colour difference {scores['delta_e_mean']:.1f}; "
        f"{len(solution.residuals)} passes in {seconds:.0f} s",
    )


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
        _score_table(scores)


def _score_table(scores: dict[str, Any]) -> None:
    """Print one line per view, the means, and what was asked for besides."""
    lobes = scores["between"]["lobe_deg"] if "between" in scores else []
    out.print(f"{'view':>20} {'angle':>9} {'PSNR':>7} {'SSIM':>7} {'dE2000':>7}" + " 30 dB over" * bool(lobes))
    for number, view in enumerate(scores["views"]):
        figures = f"{view['angle']:9.3f} {view['psnr']:7.2f} {view['ssim']:7.4f} {view['delta_e']:7.2f}"
        lobe = f" {lobes[number]:9.2f}°" if lobes else ""
        out.print(f"{view['name'][:20]:>20} {figures}{lobe}")
    worst, mean = scores["psnr_min"], scores["psnr_mean"]
    out.print(
        f"mean PSNR {mean:.2f} dB (worst {worst:.2f}), SSIM {scores['ssim_mean']:.4f}, dE {scores['delta_e_mean']:.2f}"
    )
    for name, left in scores.get("robust", {}).items():
        figures = f"{left['psnr_mean']:6.2f} dB (worst {left['psnr_min']:5.2f})"
        out.print(f"  {figures}  {between.DISTURBANCES[name]}")


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


def _check_memory(needed: int) -> None:
    free = io.free_memory()
    if needed > free:
        raise InputError(
            f"this needs {needed / 1e9:.3g} GB of memory and {free / 1e9:.3g} GB are free: "
            "use a smaller cube, or fewer or smaller pictures"
        )


def _say_before(pictures: Pictures, frames: Frames, fit_mode: Fit, *, as_json: bool) -> None:
    """Print what was done to the pictures, and what no cube can do."""
    if not as_json:
        err.print(fit_report(pictures, frames, fit_mode))
    conflicts = consistency.mirror_conflicts(frames)
    if conflicts:
        first, second = (frames.names[view] for view in conflicts[0])
        more = f" (and {len(conflicts) - 1} more such pairs)" if len(conflicts) > 1 else ""
        err.print(
            f"note: {first} and {second} are half a turn apart, where a level lamp shows mirror images, but they are "
            f"different pictures{more}: use other angles or raise the lamp (--elevation)",
        )


def _by_view(rejected: NDArray[np.int64], cube: Cube) -> str:
    """The views with most rejected pixels, by name."""
    most = Counter(cube.names[view] for view in rejected[:, 0]).most_common(5)
    return ", ".join(f"{count} in {name}" for name, count in most)


def _counted(
    pictures: Iterable[NDArray[np.float32]], count: int, advance: Callable[..., None]
) -> Iterator[NDArray[np.float32]]:
    for number, picture in enumerate(pictures, 1):
        yield picture
        advance(number, count)


def _refitted(cube: Cube, frames: Path) -> Frames:
    """Pictures as `solve` fitted them to the cube."""
    pictures = io.read_pictures(frames, transfer=cube.transfer)
    if pictures.angles is not None and len(pictures) == len(cube.views):
        apart = np.abs(np.remainder(pictures.angles - cube.views.angles + 180, 360) - 180)
        if np.max(apart) > 1e-6:
            raise InputError(
                f"{frames} says other angles than the cube was made for: give the pictures it was made from"
            )
    return fit_to_views(pictures, cube.views, check_fit(cube.provenance.get("fit", "crop")))
