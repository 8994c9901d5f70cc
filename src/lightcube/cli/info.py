"""The command `lightcube info`."""

from typing import Annotated

import typer

from lightcube import io
from lightcube.cli import arguments
from lightcube.cli.console import json_document, out
from lightcube.cli.options import JSON
from lightcube.errors import InputError
from lightcube.jobs.reading import load
from lightcube.report import bending
from lightcube.scoring import relief_facts
from lightcube.scoring.facts import facts, shape_facts
from lightcube.verbs import materials

MATERIAL = typer.Option(
    help="Also say how much of a cube these dyes cannot make: a material's file, or its name.",
    rich_help_panel="Material",
)


def info(
    thing: Annotated[str, typer.Argument(metavar="CUBE|SHAPE|RELIEF", help="A cube, a shape, or a relief.")],
    material: Annotated[str | None, MATERIAL] = None,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say what is in the file of a cube, a shape or a relief."""
    dyes, reach = (None if material is None else io.read_dyes(material)), ""
    if dyes is not None and (io.is_shape(thing) or io.is_relief(thing)):
        raise InputError(f"--material is for cubes, and {thing} is none: leave it out")
    if io.is_shape(thing):
        known = shape_facts(io.read_shape(thing))
    elif io.is_relief(thing):
        known = relief_facts.facts(io.read_relief(thing))
    else:
        cube = load(thing)
        known = facts(cube) | bending.facts(cube.rig) | materials.amounts(cube)
        if dyes is not None:
            made_of = materials.reach(cube, dyes)
            known, reach = known | made_of, materials.reach_in_words(made_of, dyes.names)
    if as_json:
        json_document(known)
        return
    for name, value in known.items():
        out.print(f"{name:>26}  {arguments.short(value)}")
    if reach:
        out.print(reach)
