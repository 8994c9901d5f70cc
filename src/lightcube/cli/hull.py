"""The command `lightcube hull`."""

import time
from collections.abc import Callable
from typing import Annotated, Any

import typer

from lightcube import io
from lightcube.cli import arguments
from lightcube.cli.console import done, err, json_line, out, telling
from lightcube.cli.fields import flag
from lightcube.cli.options import JSON, OVERWRITE, threaded
from lightcube.drawing.outlines import outlines
from lightcube.drawing.overlay import overlays
from lightcube.events import Progress
from lightcube.pictures.fitting import Fit
from lightcube.solids.carving import Carving
from lightcube.solids.printing import stands
from lightcube.solids.reach import count_pieces
from lightcube.solids.repair import Repaired, Way
from lightcube.solids.shape import Shape
from lightcube.verbs import hull_words, hulls, making, words
from lightcube.verbs.options import Options

SOURCES = Annotated[
    list[str],
    typer.Argument(
        metavar="PICTURES...", help="A folder of pictures, a video, a stage (TOML); or pictures one by one."
    ),
]
OUTS = typer.Option(
    "-o",
    "--out",
    help="Where to write: a mesh to print (.stl, .3mf, .obj, .ply), or all of the shape (.shape.zarr; in one file "
    ".shape.zarr.zip). It may be said several times.",
    rich_help_panel="Output",
)
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
REPAIR = typer.Option(
    help="Pictures that contradict each other: bend them (warp), leave out (trim) or add (grow) what is in the way, or "
    "none of it; auto trims what hardly shows, else bends.",
    rich_help_panel="Pictures",
)
KEEP = typer.Option(
    help="NAME or NAME=MASK: a picture that stays as it is if it can, or the part of it that is light in a mask. "
    "It may be said several times.",
    rich_help_panel="Pictures",
)
WALL = typer.Option(
    help="How thick walls are at least, mm, where pictures are bent or a shell is made.", rich_help_panel="Material"
)
CARVE = typer.Option(help="Take out what no shadow needs: shell or lace.", rich_help_panel="Material")
DEEP = typer.Option(help="Voxels that a lace keeps on each ray of light.", min=1, rich_help_panel="Material")
DRAIN = typer.Option(help="Width of the holes of a shell, mm; 0 = none.", rich_help_panel="Material")
BASE = typer.Option(
    help="A base below the pictures' lowest row, which none of them shows: its thickness, mm; none; or auto, where it "
    "would tip over.",
    rich_help_panel="Material",
)
OVERLAY = typer.Option(help="Draw what is cast over what was given (PNG).", rich_help_panel="Output")
#: Steps that are told of: to have read, to have made, to have written.
_READ, _MADE, _WRITTEN, _STEPS = 1, 17, 19, 20


@threaded
def hull(
    pictures: SOURCES,
    outputs: Annotated[list[str], OUTS],
    walls: Annotated[bool, WALLS] = False,
    threshold: Annotated[float | None, THRESHOLD] = None,
    invert: Annotated[bool | None, INVERT] = None,
    placement: Annotated[
        hulls.Place,
        typer.Option(
            help="With --walls: pictures as given, or another one on top, turned, as most of them can be cast.",
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
    repair: Annotated[Way, REPAIR] = "auto",
    keep: Annotated[list[str] | None, KEEP] = None,
    wall: Annotated[float, WALL] = 1.2,
    carve: Annotated[Carving, CARVE] = "none",
    keep_deep: Annotated[int, DEEP] = 3,
    drain: Annotated[float, DRAIN] = 3.0,
    base: Annotated[str, BASE] = "auto",
    overlay: Annotated[str | None, OVERLAY] = None,
    outline: Annotated[
        str | None,
        typer.Option(
            "--outlines",
            help="Also draw the silhouettes as they are cast, in mm, for cutters (.svg).",
            rich_help_panel="Output",
        ),
    ] = None,
    most: Annotated[int | None, flag("most")] = None,
    every: Annotated[int | None, flag("every")] = None,
    n: Annotated[int | None, flag("n")] = None,
    size_mm: Annotated[float | None, flag("size_mm")] = None,
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
    files = shape_files(outputs, overwrite=overwrite)
    beside = _beside(overlay, outline, overwrite=overwrite)
    how = making.Making(repair, wall, carve, keep_deep, drain, arguments.base_mm(base))
    angles = None if angles_deg is None else arguments.numbers(angles_deg, "--angles-deg")
    said: dict[str, Any] = {"most": most, "every": every, "n": n, "size_mm": size_mm, "span_deg": span_deg}
    options = Options(**said, elevation_deg=elevation_deg, angles_deg=angles)
    began = time.monotonic()

    def making_told(done: int, of: int) -> None:
        tell(Progress(_READ + (_MADE - _READ) * done // of, _STEPS))

    with telling("hull", as_json=as_json) as tell:
        wanted = hulls.read(pictures, options, hulls.Cutting(threshold, invert, walls, fit, placement, keep or ()))
        doubts = hull_words.doubts(wanted)
        if not as_json:
            for line in [*hull_words.in_short(wanted), *(f"note: {each}" for each in doubts)]:
                err.print(line)
        if not dry_run:
            tell(Progress(_READ, _STEPS))
            made = making.make(wanted, how, making_told)
            shape = made.shape
            tell(Progress(_MADE, _STEPS))
            for file in files:
                file.write(shape)
            for file, drawn in beside:
                file.write(drawn(made))
            tell(Progress(_WRITTEN, _STEPS))
            found, pieces = hulls.certificate(outputs[0], shape), count_pieces(shape.inside)
            tell(Progress(_STEPS, _STEPS))
    if dry_run:
        done(as_json, "nothing is written: this was a dry run", **wanted.facts, doubts=doubts)
        return
    seconds = time.monotonic() - began
    if as_json:
        mesh = shape.mesh
        facts: dict[str, Any] = {"volume_mm3": mesh.volume_mm3, "faces": len(mesh), "bad_edges": mesh.bad_edges}
        facts |= {
            "pieces": pieces,
            "stands": stands(mesh),
            "base_mm": shape.provenance["base_mm"],
            "repair": making.facts(made),
            "thin": _thin(shape),
        }
        json_line(
            "result",
            out=outputs[0],
            outs=outputs,
            seconds=seconds,
            **facts,
            **found.facts,
            **wanted.facts,
            doubts=doubts,
        )
        return
    out.print(f"{' and '.join(outputs)} {'is' if len(outputs) == 1 else 'are'} ready after {words.duration(seconds)}")
    for line in [*making.in_words(made, is_placed=bool(wanted.placed)), *hull_words.results(shape, found, pieces)]:
        out.print(line)
    kept = next((output for output in outputs if io.is_shape(output)), None)
    look = "add -o NAME.shape.zarr, and lightcube view" if kept is None else f"lightcube view {kept}"
    out.print(f"to look at it between its walls: {look}" + ("" if kept else " shows that"))


def shape_files(outputs: list[str], *, overwrite: bool) -> list[io.Output]:
    """Where a shape goes, each place once, checked."""
    files = [io.Output(output, "shape", overwrite) for output in dict.fromkeys(outputs)]
    for file in files:
        file.check()
    return files


def _beside(
    overlay: str | None, outline: str | None, *, overwrite: bool
) -> list[tuple[io.Output, Callable[[Repaired], Any]]]:
    """Where drawings of what is made go, checked, and what makes them."""
    asked: list[tuple[io.Output, Callable[[Repaired], Any]]] = []
    if overlay is not None:
        asked.append((io.Output(overlay, "picture", overwrite), overlays))
    if outline is not None:
        asked.append((io.Output(outline, "drawing", overwrite), lambda made: outlines(made.shape.silhouettes)))
    for file, _ in asked:
        file.check()
    return asked


def _thin(shape: Shape) -> dict[str, Any] | None:
    """Where a shape is thinner than its walls are to be, for JSON."""
    found = hull_words.thin_of(shape)
    if found is None:
        return None
    return {"share": found.share, "places": [{"at_mm": at, "volume_mm3": volume} for at, volume in found.places_mm]}
