"""The command `lightcube info`."""

from typing import Annotated

import typer

from lightcube.cli import arguments
from lightcube.cli.console import json_document, out
from lightcube.cli.options import JSON
from lightcube.jobs.reading import load
from lightcube.scoring.facts import facts


def info(
    cube: Annotated[str, typer.Argument(help="A cube.")],
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say what is in a cube file."""
    known = facts(load(cube))
    if as_json:
        json_document(known)
        return
    for name, value in known.items():
        out.print(f"{name:>26}  {arguments.short(value)}")
