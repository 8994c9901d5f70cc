"""What `check` finds: before solving, of pictures or of a stage."""

from dataclasses import dataclass
from typing import Any

from lightcube.planning.plan import Plan
from lightcube.planning.rehearsals import Rehearsals
from lightcube.verbs import solving, words


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


def check(planned: Plan, small: Rehearsals, *, advise: bool = True) -> Checked:
    """What contradicts itself or cannot be, how full the cube is, how good it will be, what would help if asked."""
    order = solving.another_order(planned, small)
    advice = words.what_to_change(planned, small) if advise else []
    lines = [*words.in_short(planned, order), "", *words.table(planned), "", *advice]
    if planned.stage is not None and not planned.impossible:
        lines.append("nothing here is impossible")
    return Checked({**words.facts(planned, order), "advice": advice}, lines, planned.impossible)
