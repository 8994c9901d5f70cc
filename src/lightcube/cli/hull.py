"""The command `lightcube hull`."""

import time
from typing import Annotated, Any

import typer

from lightcube import io
from lightcube.cli import arguments
from lightcube.cli.console import done, err, json_line, out, telling
from lightcube.cli.fields import flag
from lightcube.cli.options import JSON, OUT, OVERWRITE, threaded
from lightcube.events import Progress
from lightcube.pictures.fitting import Fit
from lightcube.solids.reach import count_pieces
from lightcube.verbs import hulls, words
from lightcube.verbs.options import Options

SOURCES = Annotated[
    list[str],
    typer.Argument(
        metavar="PICTURES...", help="A folder of pictures, a video, a stage (TOML); or pictures one by one."
    ),
]
WALLS = typer.Option("--walls", help="Three pictures: front, side and top.", rich_help_panel="Pictures")
THRESHOLD = typer.Option(
    help="Where shape ends and ground begins, as a part of white, 0 to 1.  [default: by each picture's greys]",
    rich_help_panel="Pictures",
)
INVERT = typer.Option(
    "--invert/--no-invert",
    help="Whether what is light is the shape.  [default: what covers less of the border]",
    rich_help_panel="Pictures",
)
#: Steps that are told of.
_STEPS = 4


@threaded
def hull(
    pictures: SOURCES,
    output: Annotated[str, OUT],
    walls: Annotated[bool, WALLS] = False,
    threshold: Annotated[float | None, THRESHOLD] = None,
    invert: Annotated[bool | None, INVERT] = None,
    placement: Annotated[
        hulls.Place,
        typer.Option(
            help="With --walls: pictures as given, or on other walls or mirrored, as most of them can be cast.",
            rich_help_panel="Pictures",
        ),
    ] = "given",
    fit: Annotated[
        Fit | None,
        typer.Option(
            help="Pictures of another shape than the first: pad with ground, crop, or stretch.  [default: pad]",
            rich_help_panel="Pictures",
        ),
    ] = None,
    most: Annotated[int | None, flag("most")] = None,
    every: Annotated[int | None, flag("every")] = None,
    n: Annotated[int | None, flag("n")] = None,
    size_mm: Annotated[float, flag("size_mm")] = 100.0,
    elevation_deg: Annotated[float | None, flag("elevation_deg")] = None,
    span_deg: Annotated[float | None, flag("span_deg")] = None,
    angles_deg: Annotated[str | None, flag("angles_deg")] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say how pictures are read, no more.", rich_help_panel="Output")
    ] = False,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Carve the largest solid whose shadows stay within silhouettes: a mesh to print, or a shape, by suffix."""
    file = io.Output(output, "shape", overwrite)
    file.check()
    angles = None if angles_deg is None else arguments.numbers(angles_deg, "--angles-deg")
    said: dict[str, Any] = {"most": most, "every": every, "n": n, "size_mm": size_mm, "span_deg": span_deg}
    options = Options(**said, elevation_deg=elevation_deg, angles_deg=angles)
    began = time.monotonic()
    with telling("hull", as_json=as_json) as tell:
        wanted = hulls.read(pictures, options, hulls.Cutting(threshold, invert, walls, fit, placement))
        doubts = hulls.doubts(wanted)
        if not as_json:
            for line in [*hulls.in_short(wanted), *(f"note: {each}" for each in doubts)]:
                err.print(line)
        if not dry_run:
            tell(Progress(1, _STEPS))
            shape = hulls.build(wanted)
            tell(Progress(2, _STEPS))
            file.write(shape)
            tell(Progress(3, _STEPS))
            found, pieces = hulls.certificate(output, shape), count_pieces(shape.inside)
            tell(Progress(_STEPS, _STEPS))
    if dry_run:
        done(as_json, f"{output} is not written: this was a dry run", **wanted.facts, doubts=doubts)
        return
    seconds = time.monotonic() - began
    if as_json:
        mesh = shape.mesh
        facts = {"volume_mm3": mesh.volume_mm3, "faces": len(mesh), "bad_edges": mesh.bad_edges, "pieces": pieces}
        json_line("result", out=output, seconds=seconds, **facts, **found.facts, **wanted.facts, doubts=doubts)
        return
    out.print(f"{output} is ready after {words.duration(seconds)}")
    for line in hulls.results(shape, found, pieces):
        out.print(line)
