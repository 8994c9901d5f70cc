"""Makers of what is taken away of cubes and films: tables from a name of `THINGS` to what makes the file."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Literal
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from lightcube import io
from lightcube.drawing import films
from lightcube.events import Progress, Said, Tell, counting
from lightcube.fabrication import exporting as fabrication
from lightcube.fabrication.sidecar import Kind
from lightcube.fabrication.thinning import as_films
from lightcube.io._places import place
from lightcube.optics.cube import Cube
from lightcube.optics.stack import Stack
from lightcube.scoring.metrics import mark
from lightcube.studio.offered import FILMS, Maker, Order
from lightcube.verbs import drawing, exporting, reporting, scoring, viewing
from lightcube.verbs.refitting import wanted_of
from lightcube.viewer.page import page


def of_pictures(cube: Cube) -> str:
    """How good the pictures of a cube are, in a sentence."""
    mean, least = cube.scores.get("psnr_mean"), cube.scores.get("psnr_min")
    if not isinstance(mean, float) or not isinstance(least, float):
        return "how good its pictures are is not known: the cube keeps no scores"
    return f"its pictures are {mark(mean)}: {mean:.1f} dB on average, the worst {least:.1f}"


def _page(order: Order[Cube]) -> list[str]:
    """The page in which the cube is turned."""
    cube = order.thing
    if isinstance(cube.grid, Stack):
        text, exact = page(cube, order.label), "its light is cast exactly"
    else:
        made = viewing.page(cube, order.label, order.tell)
        text, exact = made.text, f"its shadows are off by {made.worst_levels:.1f} of 255 levels at most"
    io.Output(order.target, "page", overwrite=True).write(text)
    return [of_pictures(cube), exact, "it opens in any browser, without a network: mail it, or put it on a stick"]


def _movie(shape: Literal["square", "portrait", "wide"] | None) -> Maker[Cube]:
    """A movie of the pictures in a shape, or of the room."""

    def make(order: Order[Cube]) -> list[str]:
        cube = order.thing
        if shape is None:
            film = films.film(cube, view="room")
        else:
            film = films.film(cube, format=shape, captions=order.captions)
        io.Output(order.target, "pictures", overwrite=True).write(
            _counted(film, len(film), order.tell),
            count=len(film),
            transfer=cube.transfer,
            fps=film.fps,
            scale=1,
            shared=True,
            views=film.show.views,
            names=film.show.names,
        )
        return [each for each in (of_pictures(cube), film.said, film.warning) if each]

    return make


def _counted(frames: films.Film, count: int, tell: Tell) -> Iterator[NDArray[np.float32] | NDArray[np.uint8]]:
    """Frames as they are, each told of."""
    advance = counting(tell)
    for number, frame in enumerate(frames):
        yield frame
        advance(number + 1, count)


def _report(order: Order[Cube]) -> list[str]:
    """All that is known of the cube."""
    made = reporting.report(order.thing, str(order.source), None, order.tell, order.label)
    io.Output(order.target, "page", overwrite=True).write(made.text)
    return [
        of_pictures(order.thing),
        "pictures beside what was wanted, curves, and the command that makes the cube again",
    ]


def _sheet(order: Order[Cube]) -> list[str]:
    """Each picture beside what was wanted."""
    targets = wanted_of(order.thing, None)
    found = scoring.score(order.thing, targets, order.tell)
    io.Output(order.target, "picture", overwrite=True).write(
        scoring.sheet(order.thing, targets, found, order.label.title)
    )
    return [of_pictures(order.thing)]


def _itself(order: Order[Cube]) -> list[str]:
    """The cube in one file."""
    io.Output(order.target, "cube", overwrite=True).write(order.thing)
    return [of_pictures(order.thing), "all of it, bit for bit, for this program"]


def _exported(kind: Kind, options: Mapping[str, Any] | None = None) -> Maker[Cube]:
    """A file for printers, lasers and other programs."""

    def make(order: Order[Cube]) -> list[str]:
        return _export(order, order.thing, kind, options or {}, order.target)

    return make


def _films(order: Order[Cube]) -> list[str]:
    """The cube solved anew as a few films, on pages to be printed."""
    stack = order.thing if isinstance(order.thing.grid, Stack) else as_films(order.thing, FILMS, tell=order.tell)
    said = [] if stack is order.thing else exporting.said_of_films(stack)
    return [*said, *_export(order, stack, "film", {}, order.target)]


def _assembly(order: Order[Cube]) -> list[str]:
    """How films are put together."""
    io.Output(order.target, "drawing", overwrite=True).write(drawing.of_films(order.thing))
    return [of_pictures(order.thing)]


def _slices(order: Order[Cube]) -> list[str]:
    """A folder of slices, in one file."""
    folder = order.target.with_suffix("")
    said = _export(order, order.thing, "polyjet", {"resins": io.read_dyes("polyjet")}, folder)
    order.tell(Said("packing", "packing"))
    files, advance = sorted(folder.iterdir()), counting(order.tell)
    with ZipFile(order.target, "w") as packed:  # as they are: pictures do not become smaller
        for number, file in enumerate(files):
            packed.write(file, file.name)
            file.unlink()  # so that the disk need not hold all of it twice
            advance(number + 1, len(files))
    shutil.rmtree(folder)
    return said


def _export(order: Order[Cube], cube: Cube, kind: Kind, options: Mapping[str, Any], target: Path) -> list[str]:
    """Write a file, and say what it casts."""

    def tell(event: Progress | Said) -> bool | None:
        stopping = order.tell(event)
        if isinstance(event, Progress) and event.done == event.of:
            order.tell(Said("looking at what it casts", "looking"))
        return stopping

    at = place(target)
    fabrication.check(at, kind, overwrite=True)
    planned = fabrication.plan(cube, at, kind, options)
    document = fabrication.write(cube, at, kind, planned, True, tell, is_scored=True, made_from=None)
    return exporting.told(document)


#: Of cubes.
OF_CUBES: Mapping[str, Maker[Cube]] = {
    "page": _page,
    "square": _movie("square"),
    "portrait": _movie("portrait"),
    "wide": _movie("wide"),
    "room": _movie(None),
    "sheet": _sheet,
    "report": _report,
    "cube": _itself,
    "films": _films,
    "shell": _exported("shell"),
    "slices": _slices,
    "points": _exported("points"),
    "blender": _exported("volume", {"unit": "m"}),
    "volume": _exported("volume"),
    "paraview": _exported("volume"),
    "schedule": _exported("schedule"),
}
#: Of films.
OF_FILMS: Mapping[str, Maker[Cube]] = {
    "print": _films,
    "assembly": _assembly,
    "page": _page,
    "room": _movie(None),
    "sheet": _sheet,
    "report": _report,
    "films": _itself,
}
