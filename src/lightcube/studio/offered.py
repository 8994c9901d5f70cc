"""Something to be taken away, and what is asked of whoever makes its file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, Literal, TypeVar

from lightcube.events import Tell
from lightcube.viewer.label import Label

#: What files are made of: a cube, a shape, or a relief.
Made = TypeVar("Made")


@dataclass(frozen=True)
class Order(Generic[Made]):
    """What is asked for: of which thing, where its file lies, the file to be made, its label, and what is chosen."""

    thing: Made
    source: Path
    target: Path
    label: Label
    captions: bool
    tell: Tell


@dataclass(frozen=True)
class Thing(Generic[Made]):
    """Something to be taken away.

    Parameters
    ----------
    title, said
        For people: what it is called, what it is for.
    suffix
        Of its file.
    group
        Which of the page's rows it stands in.
    make
        Makes the file and returns sentences: how good it is, and what is to be known of it.
    """

    title: str
    said: str
    suffix: str
    group: Literal["show", "know", "make"]
    make: Callable[[Order[Made]], list[str]]
