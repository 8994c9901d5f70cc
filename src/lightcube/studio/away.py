"""What makes the files of things that are taken away, and says how good they are.

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
from lightcube.studio.away_cubes import OF_CUBES, OF_FILMS
from lightcube.studio.away_solids import OF_PLATES, OF_SOLIDS
from lightcube.studio.makers import without_commands
from lightcube.studio.offered import Maker, Order
from lightcube.studio.worker import telling
from lightcube.viewer.label import Label

#: Who makes what `THINGS` offers, and what reads the thing that it is made of.
MAKERS: Mapping[str, tuple[Mapping[str, Maker[Any]], Callable[[str], Any]]] = {
    "cubes": (OF_CUBES, load),
    "films": (OF_FILMS, load),
    "solids": (OF_SOLIDS, io.read_shape),
    "plates": (OF_PLATES, io.read_relief),
}


def make(
    offer: str, name: str, source: Path, target: Path, label: Label, tell: Tell, *, captions: bool
) -> Sequence[str]:
    """Make a thing's file of another one; returns what is to be said of it. `InputError` where it cannot be."""
    makers, read = MAKERS[offer]
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always", UserWarning)
        said = makers[name](Order(read(str(source)), source, target, label, captions, tell))
    noticed = (f"{each.message}" for each in warned if issubclass(each.category, UserWarning))
    return without_commands([*said, *noticed])


def run(pipe: Connection, offer: str, name: str, source: Path, target: Path, label: Label, captions: bool) -> None:
    """The whole of a process that makes a thing's file, and tells what is to be said of it."""
    with telling(pipe) as told:
        said = make(offer, name, source, target, label, told.pass_on, captions=captions)
        told("made", file=target.name, said=said)
