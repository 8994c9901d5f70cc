"""The command `lightcube publish`."""

from typing import Annotated

import typer

from lightcube.cli import printing
from lightcube.cli.console import json_line, out
from lightcube.cli.options import JSON, OVERWRITE, VERBOSE
from lightcube.jobs import publishing
from lightcube.verbs import words


def publish(
    partial: Annotated[str, typer.Argument(help="The unfinished cube, NAME.zarr.partial.")],
    overwrite: Annotated[bool, OVERWRITE] = False,
    verbose: Annotated[bool, VERBOSE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Make a cube of what there is of an unfinished one, and say whether it is whole."""
    made = publishing.publish(partial, overwrite=overwrite)
    if as_json:
        facts = printing.facts(made.solution) if made.is_whole else {}
        units = {"whole": made.is_whole, "units_done": made.done, "units": made.units}
        json_line("result", out=str(made.path), **units, **facts)
    elif made.is_whole:
        printing.solved(made.solution, f"{made.path} is whole", verbose=verbose)
    else:
        out.print(words.holds(made))
