"""What `check` finds: before solving, of pictures or of a stage."""

from dataclasses import dataclass
from typing import Any

from lightcube import io
from lightcube.optics.transfer import Transfer
from lightcube.pictures.pictures import Pictures
from lightcube.planning.placement import doubtful, facts, impossible
from lightcube.planning.reachable import sentences
from lightcube.verbs import solving, staging, words
from lightcube.verbs.options import Options


@dataclass(frozen=True)
class Checked:
    """What can be known before solving.

    Parameters
    ----------
    facts
        All of it, for JSON.
    lines
        The same for people.
    impossible
        What cannot be at all, a sentence each.
    """

    facts: dict[str, Any]
    lines: list[str]
    impossible: list[str]


def of_pictures(pictures: Pictures, options: Options) -> Checked:
    """What contradicts itself, how full the cube is, how good it will be, what would help; `options` are settled."""
    planned = solving.prepare(pictures, options)
    order = solving.another_order(planned)
    advice = [] if options.paper else words.what_to_change(planned)  # all that would help contradicts it
    known = words.facts(planned, order)
    lines = [*words.in_short(planned, order), "", *words.table(known), "", *advice]
    return Checked({**known, "advice": advice}, lines, [])


def of_stage(path: str, transfer: Transfer) -> Checked:
    """What is impossible on a stage, or probably not meant."""
    stage, targets = io.read_stage_targets(path, transfer=transfer)
    wrong, odd = impossible(stage), [*doubtful(stage), *sentences(targets)]
    known = {**facts(stage), "impossible": wrong, "doubtful": odd}
    return Checked(known, [*staging.table(stage), "", *odd], wrong)
