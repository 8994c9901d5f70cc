"""What `view` makes: the page in which a cube is turned by hand, and how exactly it shows the cube."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing.tableau import tableau
from lightcube.events import Tell, counting
from lightcube.optics.cube import Cube
from lightcube.optics.stack import Stack
from lightcube.optics.transfer import to_uint8
from lightcube.solids.shape import is_opaque
from lightcube.viewer import smaller
from lightcube.viewer.label import Label
from lightcube.viewer.page import contents, page_of


@dataclass(frozen=True)
class Page:
    """A page, and what it holds.

    Parameters
    ----------
    text
        The whole HTML file.
    shape
        Voxels ``(nz, ny, nx)`` of the cube in it.
    worst_levels, rms_levels
        By how many display levels of 255 its shadows are off, at most and on average.
    """

    text: str
    shape: tuple[int, int, int]
    worst_levels: float
    rms_levels: float


def is_solved_anew(cube: Cube, *, full: bool) -> bool:
    """Whether a page holds a smaller cube, which is solved for it; not where all voxels are asked for."""
    return not (full or is_opaque(cube) or isinstance(cube.grid, Stack)) and cube.grid.longest > smaller.MOST_SIDE


def page(cube: Cube, label: str | Label, tell: Tell, *, full: bool = False) -> Page:
    """The page of a cube; takes and raises what `lightcube.page` does, and tells how far a smaller cube is solved."""
    advance = counting(tell)
    description, packed = contents(cube, label, full=full, callback=lambda step: advance(round(1000 * step.done), 1000))
    nz, ny, nx = description["voxels"]["shape"]
    kept = description["kept"]
    return Page(page_of(Label.of(label), description, packed), (nz, ny, nx), kept["worst_levels"], kept["rms_levels"])


def preview(cube: Cube) -> NDArray[np.uint8]:
    """The cube in its room at its first stop, ``(630, 1200, 3)`` levels: a usual size where pages are shared."""
    return to_uint8(tableau(cube, float(cube.angles_deg[0]), (630, 1200)))
