"""What `check` finds: before solving, of pictures or of a stage."""

from dataclasses import dataclass
from typing import Any

from lightcube.drawing.crops import wanted_sheet
from lightcube.optics.arrays import Levels
from lightcube.planning.plan import Plan
from lightcube.planning.rehearsals import Rehearsals
from lightcube.verbs import figures, solving, words


@dataclass(frozen=True)
class Checked:
    """What can be known before solving.

    Parameters
    ----------
    facts
        All of it, for JSON.
    lines
        What is well, what is wrong and what to do, for people.
    figures
        The numbers behind it, aligned.
    impossible
        What cannot be at all, a sentence each.
    """

    facts: dict[str, Any]
    lines: list[str]
    figures: list[str]
    impossible: list[str]


def sheet(planned: Plan) -> Levels:
    """What will be asked for, as one picture ``(row, column, 3)`` of display levels, crops and all."""
    order = range(len(planned.targets)) if planned.order is None else list(map(int, planned.order.pictures))
    return wanted_sheet(planned.pictures, planned.targets, planned.fit, order)


def check(planned: Plan, small: Rehearsals, *, advise: bool = True) -> Checked:
    """What contradicts itself or cannot be, how full the cube is, how good it will be, what would help if asked."""
    order = solving.another_order(planned, small)
    remedies = words.remedies(planned, small) if advise else {}
    advice = words.what_to_change(planned, remedies) if advise else []
    lines = [*words.in_short(planned, order), *advice]
    if planned.stage is not None and not planned.impossible:
        lines.append("nothing here is impossible")
    known = {**figures.facts(planned, order), "advice": advice, "remedies": remedies}
    return Checked(known, lines, figures.table(planned, order, remedies), planned.impossible)
