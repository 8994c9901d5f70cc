"""The command `lightcube info`."""

from typing import Annotated

import typer

from lightcube import io
from lightcube.cli import arguments
from lightcube.cli.console import json_document, out
from lightcube.cli.options import JSON
from lightcube.jobs.reading import load
from lightcube.scoring.facts import facts, shape_facts


def info(
    thing: Annotated[str, typer.Argument(metavar="CUBE|SHAPE", help="A cube, or a shape.")],
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say what is in the file of a cube or of a shape."""
    known = shape_facts(io.read_shape(thing)) if io.is_shape(thing) else facts(load(thing))
    if as_json:
        json_document(known)
        return
    for name, value in known.items():
        out.print(f"{name:>26}  {arguments.short(value)}")
