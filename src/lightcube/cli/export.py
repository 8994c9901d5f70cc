"""The command `lightcube export`."""

from typing import Annotated, Any

import typer

from lightcube import io
from lightcube.cli.console import done, out, telling
from lightcube.cli.options import JSON, OUT, OVERWRITE, threaded
from lightcube.cli.prints import Prints
from lightcube.errors import InputError
from lightcube.fabrication import exporting as fabrication
from lightcube.fabrication.dots import Halftone
from lightcube.fabrication.films import FilmPages
from lightcube.fabrication.printers import Mode
from lightcube.fabrication.sidecar import Kind
from lightcube.fabrication.thinning import as_films, stack_of
from lightcube.io._places import place
from lightcube.optics.cube import Cube
from lightcube.verbs import exporting


@threaded
def export(
    kind: Annotated[
        str,
        typer.Argument(
            metavar="KIND",
            help="What is made: a volume (.vdb, .nrrd, .vti, .npy), a shell (.3mf, .ply), points for a glass laser "
            "(.ply), polyjet slices (a folder), printed films of a stack (.pdf), or the schedule of table and lamps "
            "(.csv, .json).",
        ),
    ],
    cube: Annotated[str, typer.Argument(help="A cube or a stack of films, or an exported volume or folder of slices.")],
    output: Annotated[str, OUT],
    unit: Annotated[
        str | None, typer.Option(help="Of a .vdb: mm, or m for programs that take a metre.  [default: mm]")
    ] = None,
    levels: Annotated[int | None, typer.Option(help="How many shells, 1 to 8.  [default: 3]")] = None,
    spacing_um: Annotated[
        float | None, typer.Option(help="How far points are apart at least, micrometres.  [default: 100]")
    ] = None,
    resins: Annotated[
        str | None,
        typer.Option(
            help="What slices are printed of: a material's file (TOML), or one that is known, such as polyjet.  "
            "[default: the dyes that the cube was solved in]",
            rich_help_panel="Material",
        ),
    ] = None,
    mode: Annotated[
        Mode | None, typer.Option(help="Of the printer.  [default: high-mix]", rich_help_panel="Material")
    ] = None,
    flip: Annotated[
        str | None, typer.Option(help="Mirror slices along axes, such as y or xz.  [default: none]")
    ] = None,
    prefix: Annotated[str | None, typer.Option(help="What names of slices begin with.  [default: slice]")] = None,
    seed: Annotated[int | None, typer.Option(help="Of droplets and points.  [default: 1]")] = None,
    films: Annotated[
        int | None,
        typer.Option(
            help="Solve the cube anew as so many films, and keep them beside as NAME.zarr.", rich_help_panel="Films"
        ),
    ] = None,
    paper: Annotated[
        str | None,
        typer.Option(help="Of films: a5 to a0, letter, legal, tabloid.  [default: a4]", rich_help_panel="Films"),
    ] = None,
    dpi: Annotated[
        int | None,
        typer.Option(
            help="Dots an inch, of which a cell is a whole number.  [default: 600, or the next that fits]",
            rich_help_panel="Films",
        ),
    ] = None,
    inks: Annotated[
        str | None,
        typer.Option(
            help="What films are printed with: a material's file (TOML), or one that is known, such as cmyk-film.  "
            "[default: what the stack was solved in, or red, green and blue light]",
            rich_help_panel="Films",
        ),
    ] = None,
    mirror: Annotated[
        bool, typer.Option("--mirror", help="Print on the side that lies below.", rich_help_panel="Films")
    ] = False,
    scale_x: Annotated[
        float | None,
        typer.Option(
            help="100 divided by what the printer makes of the first page's 100 mm along x.  [default: 1]",
            rich_help_panel="Films",
        ),
    ] = None,
    scale_y: Annotated[
        float | None, typer.Option(help="The same along y.  [default: 1]", rich_help_panel="Films")
    ] = None,
    halftone: Annotated[
        Halftone | None,
        typer.Option(
            help="none: levels, of which the printer makes dots; blue: dots of full ink.  [default: none]",
            rich_help_panel="Films",
        ),
    ] = None,
    no_score: Annotated[
        bool, typer.Option("--no-score", help="Do not score what the file casts, which takes time.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would be written, and write nothing.", rich_help_panel="Output")
    ] = False,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Write a cube for printers, lasers and other programs, with all that is to be known beside it."""
    chosen = _kind(kind)
    given: dict[str, Any] = {
        "unit": unit,
        "levels": levels,
        "spacing_um": spacing_um,
        "mode": mode,
        "flips": flip,
        "prefix": prefix,
        "seed": seed,
        "resins": None if resins is None else io.read_dyes(resins),
        "paper": paper,
        "dpi": dpi,
        "inks": None if inks is None else io.read_dyes(inks),
        "mirror": mirror or None,
        "scale_x": scale_x,
        "scale_y": scale_y,
        "halftone": halftone,
    }
    options = {name: value for name, value in given.items() if value is not None}
    at = place(output)
    fabrication.check(at, chosen, overwrite=overwrite)
    loaded = exporting.opened(cube)
    if films is not None:
        loaded, cube = _as_films(loaded, films, chosen, output, options, overwrite=overwrite, as_json=as_json)
    planned = fabrication.plan(loaded, at, chosen, options)
    if dry_run:
        _tell(output, {**planned.facts, "notes": list(planned.notes)}, as_json=as_json, verb="would be written")
        return
    with telling("writing", as_json=as_json) as tell:
        document = fabrication.write(
            loaded,
            at,
            chosen,
            planned,
            overwrite,
            tell,
            is_scored=not no_score,
            made_from=exporting.made_from(cube, output),
        )
    _tell(output, document, as_json=as_json, verb="is ready")


def _kind(said: str) -> Kind:
    """The kind that is named, or `InputError`."""
    found = next((kind for kind in fabrication.KINDS if kind == said), None)
    if found is None:
        raise InputError(f"{said} is nothing that is made of a cube: give one of {', '.join(fabrication.KINDS)}")
    return found


def _as_films(
    cube: Cube, films: int, kind: Kind, output: str, options: dict[str, Any], *, overwrite: bool, as_json: bool
) -> tuple[Cube, str]:
    """The stack that a cube is made of, and where it is kept: beside its pages."""
    if kind != "film":
        raise InputError(f"--films is of printed films: leave it out for a {kind}, or export film")
    kept = io.Output(Prints(output, overwrite=overwrite).cube, "cube", overwrite)
    kept.check()
    FilmPages(**options).laid_out(stack_of(cube, films), cube.rig)
    with telling("solving", as_json=as_json) as tell:
        stack = as_films(cube, films, tell=tell)
    kept.write(stack)
    if not as_json:
        for line in exporting.said_of_films(stack):
            out.print(line)
    return stack, str(kept.path)


def _tell(output: str, document: dict[str, Any], *, as_json: bool, verb: str) -> None:
    """Print what was written, or would be."""
    facts = {name: value for name, value in document.items() if name not in ("cube", "files")}
    done(as_json, f"{output} {verb}", out=output, **facts)
    if not as_json:
        for line in exporting.told(document):
            out.print(line)
