"""The command `lightcube materials`."""

from typing import Annotated, Literal

import typer

from lightcube import io
from lightcube.cli import arguments
from lightcube.cli.console import done, err, json_document, out
from lightcube.cli.options import JSON, OVERWRITE
from lightcube.errors import InputError
from lightcube.io.materials import read_material
from lightcube.io.palettes import read_palette
from lightcube.verbs import materials as verb

WHAT = typer.Argument(
    metavar="list|show|import", help="List the materials that come along, show one, or import other programs' files."
)
NAME = typer.Argument(
    metavar="NAME|FILE|pixestl:FILE|hueforge:FILE",
    help="Of show: a name or a file (TOML). Of import: a palette of PIXEstL or a library of HueForge.",
    show_default=False,
)
OUT = typer.Option("-o", "--out", help="Of import: where to write (TOML).", rich_help_panel="Output")
ONLY = typer.Option(help="Of import: these filaments, by name, with commas.", rich_help_panel="Material")
SKIP = typer.Option("--skip", help="Of import: leave out what says nothing usable.", rich_help_panel="Material")
LAYER = typer.Option(help="Of import: how high the layers of a palette are, mm.", rich_help_panel="Material")


def materials(
    what: Annotated[Literal["list", "show", "import"], WHAT] = "list",
    name: Annotated[str | None, NAME] = None,
    output: Annotated[str | None, OUT] = None,
    only: Annotated[str | None, ONLY] = None,
    skip: Annotated[bool, SKIP] = False,
    layer_mm: Annotated[float, LAYER] = 0.1,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say what inks, resins and filaments there are, and what each absorbs; import those of other programs."""
    if what != "import" and (output or only or skip):
        raise InputError(f"lightcube materials {what} writes nothing and leaves nothing out: that is for import")
    if what == "import":
        chosen = () if only is None else tuple(only.split(","))
        _import(name, output, chosen, skip=skip, layer_mm=layer_mm, overwrite=overwrite, as_json=as_json)
    elif what == "list":
        _list(name, as_json=as_json)
    else:
        _show(name, as_json=as_json)


def _list(name: str | None, *, as_json: bool) -> None:
    if name is not None:
        raise InputError(f"lightcube materials list takes no name: lightcube materials show {name} says more of it")
    if as_json:
        json_document({"materials": io.material_names()})
        return
    for line in verb.listed():
        out.print(line)


def _show(name: str | None, *, as_json: bool) -> None:
    if name is None:
        raise InputError("lightcube materials show takes the name or the file of a material, as in show polyjet")
    dyes = io.read_dyes(name)
    known = verb.facts(dyes) | read_material(name).measured
    if as_json:
        json_document(known)
        return
    for key, value in known.items():
        out.print(f"{key:>26}  {arguments.short(value)}")
    for line in verb.in_words(dyes):
        out.print(line)


def _import(
    source: str | None,
    output: str | None,
    only: tuple[str, ...],
    *,
    skip: bool,
    layer_mm: float,
    overwrite: bool,
    as_json: bool,
) -> None:
    if source is None or output is None:
        raise InputError(
            "lightcube materials import takes a file and -o, as in import pixestl:palette.json -o pla.toml"
        )
    target = io.Output(output, "material", overwrite)
    target.check()
    found = read_palette(source, only=only, skip=skip, layer_mm=layer_mm)
    target.write(found.dyes)
    if not as_json:
        for line in [*found.said, *verb.in_words(found.dyes)]:
            err.print(line)
    said = f"{output} is a hint, {found.dyes.calibration}: a spool, a camera and a lamp of your own differ"
    done(as_json, said, out=output, said=found.said, dyes=found.dyes.plain())
