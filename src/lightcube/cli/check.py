"""The command `lightcube check`."""

from typing import Annotated

import typer

from lightcube.cli.console import err, json_document, out, telling
from lightcube.cli.fields import one_by_one
from lightcube.cli.options import JSON, PICTURES, VERBOSE, threaded
from lightcube.verbs import checking, solving
from lightcube.verbs.options import Options


@threaded
@one_by_one
def check(
    pictures: PICTURES,
    options: Options,
    verbose: Annotated[bool, VERBOSE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say before solving what can be known: how good it will be, what contradicts itself, or on a stage cannot be.

    The exit code is 2 where anything on a stage is impossible.
    """
    planning = solving.read(pictures, options)
    with telling("planning", as_json=as_json) as tell:
        small = solving.rehearsals(None if as_json else tell)  # a document is all that is printed
        # all that would help contradicts the paper
        found = checking.check(planning(small), small, advise=not options.paper)
    if as_json:
        json_document(found.facts)
    else:
        for line in [*found.lines, *(["", *found.figures] if verbose else [])]:
            out.print(line)
        for sentence in found.impossible:
            err.print(f"impossible: {sentence}")
    if found.impossible:
        raise typer.Exit(2)
