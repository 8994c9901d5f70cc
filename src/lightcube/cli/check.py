"""The command `lightcube check`."""

from typing import Annotated

import typer

from lightcube import io
from lightcube.cli.console import err, json_document, out
from lightcube.cli.options import FRAMES, JSON, one_by_one
from lightcube.verbs import checking
from lightcube.verbs.options import Options


@one_by_one
def check(frames: FRAMES, options: Options, as_json: Annotated[bool, JSON] = False) -> None:
    """Say before solving what can be known: how good it will be, what contradicts itself, or on a stage cannot be.

    The exit code is 2 where anything on a stage is impossible.
    """
    stage = io.is_stage(frames)
    if stage:
        found = checking.of_stage(frames, options.transfer)
    else:
        with err.status("rehearsing"):
            found = checking.of_pictures(frames, options)
    if as_json:
        json_document(found.facts)
    else:
        for line in found.lines:
            out.print(line)
        for sentence in found.impossible:
            err.print(f"impossible: {sentence}")
        if stage and not found.impossible:
            out.print("nothing here is impossible")
    if found.impossible:
        raise typer.Exit(2)
