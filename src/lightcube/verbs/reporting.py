"""What `report` makes: the page that keeps all that is known of a cube."""

from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from lightcube import io
from lightcube.errors import without_secrets
from lightcube.events import Tell, counting
from lightcube.io._places import name_of
from lightcube.io._places import place as io_place
from lightcube.optics.cube import Cube
from lightcube.report.measuring import Findings, measure
from lightcube.report.opening import Heading
from lightcube.report.page import page
from lightcube.report.reliefs import measure_relief, relief_page
from lightcube.report.shapes import measure_shape, shape_page
from lightcube.solids.relief import Relief
from lightcube.solids.shape import Shape
from lightcube.verbs.refitting import wanted_of
from lightcube.verbs.reproducing import origins, reproducing
from lightcube.viewer.label import Label

#: In every language that a machine is set to, a report is in English.
_MONTHS = (
    *("January", "February", "March", "April", "May", "June"),
    *("July", "August", "September", "October", "November", "December"),
)


@dataclass(frozen=True, eq=False)
class Report:
    """A report: the whole HTML file, and the scores in it as `score` gives them, of a cube, a shape or a relief."""

    text: str
    scores: dict[str, Any]


def report(cube: Cube, place: str, source: str | None, tell: Tell, label: Label | None = None) -> Report:
    """Measure all that is known of a cube and put it into one page.

    Parameters
    ----------
    place
        Where the cube was read from.
    source
        Where the pictures are that it was made from; None = it is compared with its own targets.
    tell
        Is told how many pictures are compared, of how many as far as is known.
    label
        What it is called, by whom it is, and a word on it; None = it has the name of its file.

    Raises
    ------
    InputError
        Where the pictures cannot be read, or cannot be those that the cube is for.
    """
    wanted = wanted_of(cube, source)
    stage = io.read_stage(source, transfer=cube.transfer)[0] if source is not None and io.is_stage(source) else None
    found = measure(cube, wanted, stage, counting(tell))
    command = reproducing(cube, wanted, source, name_of(io_place(place.removesuffix(".partial"))))
    label = label or Label(io.bare_name(place))
    heading = Heading(label.title, label.by, _day(place), label.note)
    text = page(found, heading, _compared(found, source), command, [*origins(place, source)])
    return Report(text, found.scores)


def shape_report(shape: Shape, place: str, label: Label, tell: Tell) -> Report:
    """Measure all that is known of a shape and put it into one page; `place` is where it was read from."""
    found = measure_shape(shape, counting(tell))
    heading = Heading(label.title, label.by, _day(place), label.note)
    return Report(shape_page(found, heading, [*origins(place, None, "shape")]), found.certificate.facts)


def relief_report(relief: Relief, place: str, label: Label, tell: Tell) -> Report:
    """Measure all that is known of a relief and put it into one page; `place` is where it was read from."""
    found = measure_relief(relief, counting(tell))
    heading = Heading(label.title, label.by, _day(place), label.note)
    return Report(relief_page(found, heading, [*origins(place, None, "relief")]), dict(found.scores))


def _day(place: str) -> str:
    """On which day (UTC) a cube's file on this disk was written.

    The cube itself does not tell: it is the same whenever it is made.
    """
    path = Path(place)
    path = path / "zarr.json" if path.is_dir() else path
    if not path.exists():
        return ""
    day = datetime.fromtimestamp(path.stat().st_mtime, UTC)
    return f"{day.day} {_MONTHS[day.month - 1]} {day.year}"


def _compared(found: Findings, source: str | None) -> str:
    """What the cube was compared with, in a sentence."""
    if source is None:
        return "Compared with the pictures that its file keeps, of 16 bits."
    name = name_of(io_place(without_secrets(source)))
    if found.apart == 0:
        return f"Compared with the pictures in {name}, which are those that the cube was made from."
    off = "" if found.apart is None else f": they differ from these by up to {found.apart / 257:.2g} levels of 255"
    about = "which are not known to be those that it was made from"
    return f"Compared with the pictures in {name}, {about}{off}."
