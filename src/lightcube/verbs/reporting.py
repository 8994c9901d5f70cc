"""What `report` makes: the page that keeps all that is known of a cube."""

from dataclasses import dataclass
from typing import Any

from lightcube import io
from lightcube.errors import without_secrets
from lightcube.events import Tell, counting
from lightcube.io._places import name_of
from lightcube.io._places import place as io_place
from lightcube.optics.cube import Cube
from lightcube.report.measuring import Findings, measure
from lightcube.report.page import page
from lightcube.verbs.refitting import wanted_of
from lightcube.verbs.reproducing import origins, reproducing


@dataclass(frozen=True, eq=False)
class Report:
    """A report: the whole HTML file, and the scores in it as `lightcube.score` gives them."""

    text: str
    scores: dict[str, Any]


def report(cube: Cube, place: str, source: str | None, tell: Tell) -> Report:
    """Measure all that is known of a cube and put it into one page.

    Parameters
    ----------
    place
        Where the cube was read from.
    source
        Where the pictures are that it was made from; None = it is compared with its own targets.
    tell
        Is told how many pictures are compared, of how many as far as is known.

    Raises
    ------
    InputError
        Where the pictures cannot be read, or cannot be those that the cube is for.
    """
    wanted = wanted_of(cube, source)
    stage = io.read_stage(source, transfer=cube.transfer)[0] if source is not None and io.is_stage(source) else None
    found = measure(cube, wanted, stage, counting(tell))
    command = reproducing(cube, wanted, source, name_of(io_place(place.removesuffix(".partial"))))
    text = page(found, io.bare_name(place), _compared(found, source), command, [*origins(place, source)])
    return Report(text, found.scores)


def _compared(found: Findings, source: str | None) -> str:
    """What the cube was compared with, in a sentence."""
    if source is None:
        return (
            "Compared with the 8-bit pictures that the cube keeps, which cap PSNR at about 59 dB where they were "
            "resampled."
        )
    name = name_of(io_place(without_secrets(source)))
    if found.apart == 0:
        return f"Compared with the pictures in {name}, which are those that the cube was made from."
    off = "" if found.apart is None else f": they differ from these by up to {found.apart / 257:.2g} levels of 255"
    about = "which are not known to be those that it was made from"
    return f"Compared with the pictures in {name}, {about}{off}."
