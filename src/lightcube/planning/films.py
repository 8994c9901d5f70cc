"""What is probably not meant of a stack of films: all from how many there are, and how they lie."""

from __future__ import annotations

import math

import numpy as np

from lightcube.optics.ghosts import ghosts
from lightcube.optics.stack import Stack
from lightcube.optics.stage import Stage
from lightcube.wording import counted

#: Loose films whose reflected light is more than this part of what goes through are better bonded.
_MANY_GHOSTS = 0.1
#: Cells narrower than this, mm, do not stay where they belong when films are laid by hand.
_NARROW_MM = 1.0


def load(stage: Stage) -> float:
    """Pictures for each cell that a pixel's beams meet: above 1 films cannot show them all."""
    films, cells = stage.grid.shape[0], cells_a_pixel(stage)
    return len(stage.shots) / (films * cells**2)


def cells_a_pixel(stage: Stage) -> float:
    """Cells along a pixel's side."""
    return float(np.min(stage.rig().views.pixel_in(stage.grid)))


def doubtful(stage: Stage) -> list[str]:
    """Say what is probably not meant, a sentence each: too many pictures, cells too wide or narrow, too many films."""
    stack = stage.grid
    assert isinstance(stack, Stack)  # noqa: S101 - nobody asks of anything else
    return [*_crowded(stage), *_sizes(stage), *_loose(stack)]


def _crowded(stage: Stage) -> list[str]:
    """Whether there are too many pictures for so many films."""
    films, pictures = stage.grid.shape[0], len(stage.shots)
    if load(stage) > 1:
        need = math.ceil(pictures / cells_a_pixel(stage) ** 2)
        what = f"{counted(films, 'film')} hold {counted(pictures, 'picture')} poorly, less than 25 dB"
        return [f"{what}: take {need} films or more, narrower cells, or fewer pictures"]
    return []


def _sizes(stage: Stage) -> list[str]:
    """Whether cells are of a size that can be made."""
    said, cell = [], stage.grid.voxel_mm
    if cells_a_pixel(stage) < 2:
        said.append("cells are as wide as pixels, which shows pictures poorly: take 2 cells a pixel")
    if cell < _NARROW_MM:
        said.append(
            f"cells are {cell:.2g} mm wide, and films laid by hand lie 0.1 to 0.2 mm off: make pictures larger, or of "
            "fewer pixels"
        )
    return said


def _loose(stack: Stack) -> list[str]:
    """Whether light that is reflected between films matters."""
    films = stack.shape[0]
    found = ghosts(films, density=0.0, loose=stack.index == 1)
    if found.displaced <= _MANY_GHOSTS:
        return []
    how = "loose films" if stack.index == 1 else "films in plates"
    what = f"{counted(films, 'clear film')} as {how} let {found.through:.0%} through"
    return [f"{what} and reflect {found.displaced:.0%} of that to where it does not belong: bond them, or take fewer"]
