"""The command `lightcube check`."""

from typing import Annotated

from lightcube import io
from lightcube.cli import stage
from lightcube.cli.console import compiling, err, json_document, out
from lightcube.cli.fields import one_by_one
from lightcube.cli.options import FRAMES, JSON
from lightcube.verbs import solving, words
from lightcube.verbs.options import Options


@one_by_one
def check(frames: FRAMES, options: Options, as_json: Annotated[bool, JSON] = False) -> None:
    """Say before solving what can be known: what contradicts itself, how full the cube is, how good it will be."""
    if io.is_stage(frames):
        stage.checked(*io.read_stage_frames(frames, transfer=options.transfer), as_json=as_json)
        return
    options = solving.settled(options)
    pictures = solving.read(frames, options)
    with err.status("rehearsing"), compiling(as_json=as_json):
        prepared = solving.prepare(pictures, options)
    advice = words.what_to_change(prepared, options)
    facts = words.facts(prepared, options)
    if as_json:
        json_document({**facts, "advice": advice})
        return
    for line in [*words.in_short(prepared, options), "", *words.table(facts), "", *advice]:
        out.print(line)
