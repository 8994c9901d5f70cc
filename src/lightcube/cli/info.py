"""The command `lightcube info`."""

from typing import Annotated

import typer

from lightcube import io
from lightcube.cli import arguments
from lightcube.cli.console import json_document, out
from lightcube.cli.options import JSON
from lightcube.jobs.reading import load
from lightcube.scoring import relief_facts
from lightcube.scoring.facts import facts, shape_facts


def info(
    thing: Annotated[str, typer.Argument(metavar="CUBE|SHAPE|RELIEF", help="A cube, a shape, or a relief.")],
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say what is in the file of a cube, a shape or a relief."""
    if io.is_shape(thing):
        known = shape_facts(io.read_shape(thing))
    elif io.is_relief(thing):
        known = relief_facts.facts(io.read_relief(thing))
    else:
        known = facts(load(thing))
    if as_json:
        json_document(known)
        return
    for name, value in known.items():
        out.print(f"{name:>26}  {arguments.short(value)}")
