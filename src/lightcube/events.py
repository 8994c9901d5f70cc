"""What long work tells as it goes on: to a terminal, to a program that reads lines, to a browser."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Progress:
    """So much of the work is done.

    Parameters
    ----------
    done, of
        In whatever the work counts.
    figures
        How good things are, by name.
    left_s
        Seconds that are left, where they are known.
    """

    done: int
    of: int
    figures: Mapping[str, float] = field(default_factory=dict)
    left_s: float | None = None


@dataclass(frozen=True)
class Said:
    """A sentence for people, and for programs what happened and its facts, by name."""

    sentence: str
    what: str
    facts: Mapping[str, Any] = field(default_factory=dict)


#: Called with all that happens; True stops the work.
Tell = Callable[[Progress | Said], bool | None]


class Interrupted(Exception):  # noqa: N818 - nothing is wrong
    """Work was told to stop, and nothing of it is kept."""


def counting(tell: Tell) -> Callable[[int, int], None]:
    """Make a callback of how much of how much is done, which raises `Interrupted` where `tell` stops the work."""

    def advance(done: int, of: int) -> None:
        if tell(Progress(done, of)):
            raise Interrupted

    return advance
