"""The command `lightcube check`."""

from typing import Annotated

import typer

from lightcube import io
from lightcube.cli.console import err, json_document, out, telling
from lightcube.cli.fields import one_by_one
from lightcube.cli.options import JSON, OVERWRITE, PICTURES, VERBOSE, threaded
from lightcube.verbs import checking, solving
from lightcube.verbs.options import Options


@threaded
@one_by_one
def check(
    pictures: PICTURES,
    options: Options,
    sheet: Annotated[
        str | None,
        typer.Option(
            help="Draw what will be asked for: each picture, what is cut off, what is left (PNG, WebP or JPEG).",
            rich_help_panel="Output",
        ),
    ] = None,
    overwrite: Annotated[bool, OVERWRITE] = False,
    verbose: Annotated[bool, VERBOSE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say before solving what can be known: how good it will be, what contradicts itself, or on a stage cannot be.

    The exit code is 2 where anything on a stage is impossible.
    """
    sheet_file = None if sheet is None else io.Output(sheet, "picture", overwrite)
    if sheet_file is not None:
        sheet_file.check()
    planning = solving.read(pictures, options)
    with telling("planning", as_json=as_json) as tell:
        small = solving.rehearsals(None if as_json else tell)  # a document is all that is printed
        # all that would help contradicts the paper
        planned = planning(small)
        found = checking.check(planned, small, advise=not options.paper)
    if sheet_file is not None:
        sheet_file.write(checking.sheet(planned))
    if as_json:
        json_document(found.facts)
    else:
        for line in [*found.lines, *(["", *found.figures] if verbose else [])]:
            out.print(line)
        for sentence in found.impossible:
            err.print(f"impossible: {sentence}")
    if found.impossible:
        raise typer.Exit(2)
