"""The command `lightcube info`."""

from typing import Annotated

import typer

from lightcube import io
from lightcube.cli import arguments
from lightcube.cli.console import json_document, out
from lightcube.cli.options import JSON
from lightcube.jobs.reading import load
from lightcube.scoring import relief_facts
from lightcube.scoring.facts import facts


def info(
    cube: Annotated[str, typer.Argument(help="A cube, or a relief.")],
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say what is in the file of a cube or a relief."""
    known = relief_facts.facts(io.read_relief(cube)) if io.is_relief(cube) else facts(load(cube))
    if as_json:
        json_document(known)
        return
    for name, value in known.items():
        out.print(f"{name:>26}  {arguments.short(value)}")
