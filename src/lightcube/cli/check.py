"""The command `lightcube check`."""

from typing import Annotated

import typer

from lightcube import io
from lightcube.cli.console import err, json_document, out
from lightcube.cli.options import FRAMES, JSON, one_by_one
from lightcube.optics.stage import Stage
from lightcube.pictures.frames import Frames
from lightcube.planning.placement import doubtful, facts, impossible
from lightcube.planning.reachable import sentences
from lightcube.verbs import solving, staging, words
from lightcube.verbs.options import Options


@one_by_one
def check(frames: FRAMES, options: Options, as_json: Annotated[bool, JSON] = False) -> None:
    """Say before solving what can be known: how good it will be, what contradicts itself, or on a stage cannot be.

    The exit code is 2 where anything on a stage is impossible.
    """
    if io.is_stage(frames):
        _stage(*io.read_stage_frames(frames, transfer=options.transfer), as_json=as_json)
        return
    options = solving.settled(options)
    with err.status("rehearsing"):
        planned = solving.prepare(frames, options)
        order = solving.another_order(planned)
    advice = [] if options.paper else words.what_to_change(planned)  # all that would help contradicts it
    known = words.facts(planned, order)
    if as_json:
        json_document({**known, "advice": advice})
        return
    for line in [*words.in_short(planned, order), "", *words.table(known), "", *advice]:
        out.print(line)


def _stage(stage: Stage, frames: Frames, *, as_json: bool) -> None:
    """Print what is known of a stage and its pictures; exit code 2 where something on it is impossible."""
    wrong, odd = impossible(stage), [*doubtful(stage), *sentences(frames)]
    if as_json:
        json_document({**facts(stage), "impossible": wrong, "doubtful": odd})
    else:
        for line in [*staging.table(stage), "", *odd]:
            out.print(line)
        for sentence in wrong:
            err.print(f"impossible: {sentence}")
        if not wrong:
            out.print("nothing here is impossible")
    if wrong:
        raise typer.Exit(2)
