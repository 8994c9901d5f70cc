"""The command `lightcube relief`."""

from typing import Annotated

import typer

from lightcube import io
from lightcube.cli import arguments
from lightcube.cli.console import compiling, done, err, json_line, out, telling
from lightcube.cli.options import JSON, OVERWRITE, threaded
from lightcube.drawing.relief_sheet import relief_sheet
from lightcube.errors import InputError
from lightcube.io.outputs import Thing
from lightcube.scoring import relief_facts
from lightcube.scoring.reliefs import score_relief
from lightcube.solids import relief_making
from lightcube.solids.relief import Method, Relief, ReliefRecipe
from lightcube.verbs import reliefs

_DEFAULT = ReliefRecipe()


@threaded
def relief(
    pictures: Annotated[list[str], typer.Argument(help="One to four pictures, or a folder of them.")],
    outputs: Annotated[
        list[str],
        typer.Option(
            "-o",
            "--out",
            help="Where to write: a mesh (.stl, .3mf, .obj, .ply), all that is known (.relief.zarr), heights (.png). "
            "It may be said several times.",
            rich_help_panel="Output",
        ),
    ],
    sheet: Annotated[
        str | None,
        typer.Option(
            help="Draw wanted pictures, what lamps show, and what they show 3 degrees too high (PNG, WebP, JPEG).",
            rich_help_panel="Output",
        ),
    ] = None,
    colour: Annotated[
        bool,
        typer.Option(
            "--colour",
            help="Show one picture in colour, by a red, a green and a blue lamp.",
            rich_help_panel="Pictures",
        ),
    ] = False,
    black: Annotated[
        str,
        typer.Option(
            help="The display value of the pictures' black, 0 to 0.95, or auto: as dark as the relief allows.",
            rich_help_panel="Pictures",
        ),
    ] = "auto",
    columns: Annotated[
        int, typer.Option(help="Columns along a side of the plate.", rich_help_panel="Geometry")
    ] = _DEFAULT.side,
    pitch_mm: Annotated[
        float, typer.Option(help="A column's side: two widths of the nozzle, or more.", rich_help_panel="Geometry")
    ] = _DEFAULT.pitch_mm,
    relief_px: Annotated[
        float,
        typer.Option("--relief", help="How high the relief is, in columns of shadow.", rich_help_panel="Geometry"),
    ] = _DEFAULT.relief_px,
    steepest: Annotated[
        float | None,
        typer.Option(
            help="The greatest step between neighbours, in columns of shadow.  [default: any]",
            rich_help_panel="Geometry",
        ),
    ] = None,
    layer_mm: Annotated[
        float | None,
        typer.Option(help="Round heights to the printer's layers.  [default: not rounded]", rich_help_panel="Geometry"),
    ] = None,
    base_mm: Annotated[
        float, typer.Option(help="How thick the plate below is.", rich_help_panel="Geometry")
    ] = _DEFAULT.base_mm,
    frame_mm: Annotated[
        float, typer.Option(help="How far the plate stands out around the picture.", rich_help_panel="Geometry")
    ] = _DEFAULT.frame_mm,
    elevation_deg: Annotated[
        float, typer.Option(help="How high the lamps stand, in degrees.", rich_help_panel="Lamp")
    ] = _DEFAULT.elevation_deg,
    tolerance_deg: Annotated[
        float, typer.Option(help="How much too high or too low they may stand, in degrees.", rich_help_panel="Lamp")
    ] = _DEFAULT.tolerance_deg,
    bounce: Annotated[
        float,
        typer.Option(
            help="How much of its mean light the plate throws into its own shadows, 0 to 0.5.",
            rich_help_panel="Lamp",
        ),
    ] = _DEFAULT.bounce,
    method: Annotated[
        Method,
        typer.Option(
            help="Global for photographs; local, walls and floors, exact, for one or two flat pictures.",
            rich_help_panel="Quality",
        ),
    ] = _DEFAULT.method,
    sweeps: Annotated[
        int, typer.Option(help="How often each column is offered another height.", rich_help_panel="Quality")
    ] = _DEFAULT.sweeps,
    smooth: Annotated[
        float, typer.Option(help="How much steps between columns count.", rich_help_panel="Quality")
    ] = _DEFAULT.smooth,
    seed: Annotated[int, typer.Option(help="Of the random numbers.", rich_help_panel="Quality")] = _DEFAULT.seed,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what is to be expected, no more.", rich_help_panel="Output")
    ] = False,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Make one relief that shows a picture under each of up to four low lamps."""
    recipe = ReliefRecipe(
        side=columns,
        method=method,
        relief_px=relief_px,
        black=arguments.number_or_auto(black, "--black"),
        elevation_deg=elevation_deg,
        tolerance_deg=tolerance_deg,
        pitch_mm=pitch_mm,
        layer_mm=layer_mm,
        bounce=bounce,
        **({} if steepest is None else {"steepest_px": steepest}),
        smooth=smooth,
        sweeps=sweeps,
        seed=seed,
        base_mm=base_mm,
        frame_mm=frame_mm,
    )
    files, drawn = _files(outputs, sheet, overwrite=overwrite)
    read = reliefs.read(pictures)
    if dry_run:
        with compiling(as_json=as_json):
            expected = reliefs.expected(read, recipe, colour=colour)
        for line in [] if as_json else reliefs.foretold(expected):
            out.print(line)
        done(as_json, "nothing is written: this was a dry run", **expected)
        return
    with telling("shaping", as_json=as_json) as tell:
        made = relief_making.relief(read, recipe, colour=colour, tell=tell)
    with compiling(as_json=as_json):
        scores = score_relief(made, off=True)
    things: list[tuple[io.Output, Thing]] = [(file, made) for file in files]
    things += [(file, relief_sheet(made, scores, _title(made))) for file in drawn]
    io.write_together(*things)
    if as_json:
        json_line("result", out=outputs, **relief_facts.facts(made), scores=scores)
        return
    out.print(f"{' and '.join(outputs)} {'is' if len(outputs) == 1 else 'are'} ready")
    for line in reliefs.told(made, scores):
        out.print(line)
    if not any(io.is_relief(output) for output in outputs):
        err.print("note: -o NAME.relief.zarr too keeps what lightcube play, score and info want")


def _files(outputs: list[str], sheet: str | None, *, overwrite: bool) -> tuple[list[io.Output], list[io.Output]]:
    """What is written, and the sheet, if any; `InputError` where one cannot be."""
    files = [io.Output(output, "relief", overwrite) for output in outputs]
    drawn = [] if sheet is None else [io.Output(sheet, "picture", overwrite)]
    names = [str(file.path) for file in (*files, *drawn)]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"{twice} is named twice: give two names")
    for file in (*files, *drawn):
        file.check()
    return files, drawn


def _title(made: Relief) -> str:
    """What the sheet is called."""
    rows, across = made.heights_px.shape
    return f"{'One colour picture' if made.is_colour else 'One plate'}, {across} x {rows} columns"
