"""What can be taken away of each kind of thing, and what makes its file and says how good it is.

It is made in a process of its own, which `run` is the whole of.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from lightcube import io
from lightcube.events import Tell
from lightcube.jobs.reading import load
from lightcube.studio.away_cubes import CUBES, FILMS
from lightcube.studio.away_solids import PLATES, SOLIDS
from lightcube.studio.makers import without_commands
from lightcube.studio.offered import Order, Thing
from lightcube.studio.worker import telling
from lightcube.viewer.label import Label

#: What is offered, in the page's order, and what reads the thing that it is made of.
OFFERS: Mapping[str, tuple[Mapping[str, Thing[Any]], Callable[[str], Any]]] = {
    "cubes": (CUBES, load),
    "films": (FILMS, load),
    "solids": (SOLIDS, io.read_shape),
    "plates": (PLATES, io.read_relief),
}


def things(offer: str) -> Mapping[str, Thing[Any]]:
    """What can be taken away, by name."""
    return OFFERS[offer][0]


def make(
    offer: str, name: str, source: Path, target: Path, label: Label, tell: Tell, *, captions: bool
) -> Sequence[str]:
    """Make a thing's file of another one; returns what is to be said of it. `InputError` where it cannot be."""
    offered, read = OFFERS[offer]
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always", UserWarning)
        said = offered[name].make(Order(read(str(source)), source, target, label, captions, tell))
    noticed = (f"{each.message}" for each in warned if issubclass(each.category, UserWarning))
    return without_commands([*said, *noticed])


def run(pipe: Connection, offer: str, name: str, source: Path, target: Path, label: Label, captions: bool) -> None:
    """The whole of a process that makes a thing's file, and tells what is to be said of it."""
    with telling(pipe) as told:
        said = make(offer, name, source, target, label, told.pass_on, captions=captions)
        told("made", file=target.name, said=said)
