"""How films lie on pages of paper: whole dots, margins, crosses, pin holes. All in mm, from a page's lower left corner.

All films lie in the same place and the same way round: what a printer does wrong, as the 0.6 % by which a laser
printer's rectangle is a trapezoid, it then does wrong to all of them alike.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack

#: Width and height of paper by name, mm.
PAPERS = {
    "a5": (148.0, 210.0),
    "a4": (210.0, 297.0),
    "a3": (297.0, 420.0),
    "a2": (420.0, 594.0),
    "a1": (594.0, 841.0),
    "a0": (841.0, 1189.0),
    "letter": (215.9, 279.4),
    "legal": (215.9, 355.6),
    "tabloid": (279.4, 431.8),
}
#: No printer of these reaches further out; and above and below films there is so much room for marks and words.
MARGIN_MM, STRIP_MM = 6.0, 22.0
#: Dots an inch where nothing is said; printers have so few and so many.
_USUAL_DPI, _LEAST_DPI, _MOST_DPI = 600, 72, 2400
#: Where the usual dots do not fit cells, others between these are taken.
_SOME_DPI = (300, 1200)
#: Whole dots may make a film so much larger or smaller, mm.
_OFF_MM = 0.01
#: Crosses stand so far from a film's edge and in from its sides, pin holes in the same rows; and how large both are.
_OUT_MM, _IN_MM, ARM_MM, PIN_MM = 8.0, 6.0, 3.0, 2.5
#: Marks go so far from left to right at least.
_MARKS_MM = 90.0
#: Where pin holes are, as parts of that, above and below: no turn and no mirror takes them to each other.
_PINS = (0.25, 0.6)
#: More dots on a page than this fill the memory.
_MOST_DOTS = 1 << 28
_INCH = 25.4


@dataclass(frozen=True)
class Layout:
    """Where a film lies on a page.

    Parameters
    ----------
    paper
        Its name, one of `PAPERS`.
    page_mm
        Width and height of the page.
    dpi
        Dots an inch of the picture.
    dots
        Dots along a cell's side.
    cells
        ``(ny, nx)``.
    """

    paper: str
    page_mm: tuple[float, float]
    dpi: int
    dots: int
    cells: tuple[int, int]

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of a film's picture."""
        ny, nx = self.cells
        return nx * self.dots * _INCH / self.dpi, ny * self.dots * _INCH / self.dpi

    @property
    def corner_mm(self) -> tuple[float, float]:
        """The picture's lower left corner, on a whole dot; the picture is in the middle of the page."""
        dot = _INCH / self.dpi
        (width, height), (wide, high) = self.page_mm, self.size_mm
        return round((width - wide) / 2 / dot) * dot, round((height - high) / 2 / dot) * dot

    @property
    def marks_mm(self) -> tuple[float, float]:
        """Where marks begin from the left, and how far they go: as wide as the film, or where that is small, wider."""
        wide = max(self.size_mm[0], _MARKS_MM)
        return self.corner_mm[0] + (self.size_mm[0] - wide) / 2, wide

    @property
    def crosses_mm(self) -> tuple[tuple[float, float], ...]:
        """Middles of four crosses, above and below the film, on whole dots."""
        (_, bottom), (_, height), (left, width) = self.corner_mm, self.size_mm, self.marks_mm
        across = left + _IN_MM, left + width - _IN_MM
        along, dot = (bottom - _OUT_MM, bottom + height + _OUT_MM), _INCH / self.dpi
        return tuple((round(x / dot) * dot, round(y / dot) * dot) for y in along for x in across)

    @property
    def pins_mm(self) -> tuple[tuple[float, float], ...]:
        """Middles of two pin holes, one above the film and one below."""
        (_, bottom), (_, height), (left, width) = self.corner_mm, self.size_mm, self.marks_mm
        above, below = _PINS
        return (left + above * width, bottom + height + _OUT_MM), (left + below * width, bottom - _OUT_MM)


def layout(stack: Stack, rig: Rig, paper: str, dpi: int | None, scale: tuple[float, float] = (1.0, 1.0)) -> Layout:
    """Find how films lie on pages of a paper, upright if they can.

    Parameters
    ----------
    rig
        Whose pictures they cast: which other size would fit is told as theirs.
    dpi
        None = 600, or the next number of dots that makes whole cells.
    scale
        How much larger everything is drawn, along x and y.

    Raises
    ------
    InputError
        Where there is no such paper, films are larger than it, or cells are not whole dots.
    """
    if paper not in PAPERS:
        raise InputError(f"there is no paper {paper!r}: take one of {', '.join(PAPERS)}")
    dpi = _dpi(stack, rig, dpi)
    found = Layout(paper, PAPERS[paper], dpi, round(_dots(stack, dpi)), (stack.shape[1], stack.shape[2]))
    need = np.multiply(found.size_mm, scale)
    need[1] += 2 * STRIP_MM
    pages = [page for page in (PAPERS[paper], PAPERS[paper][::-1]) if _fits(need, page)]
    if not pages:
        raise InputError(_too_large(found, need, rig))
    ny, nx = found.cells
    if ny * nx * found.dots**2 > _MOST_DOTS:
        raise InputError(
            f"a film of {found.size_mm[0]:.0f} x {found.size_mm[1]:.0f} mm at {dpi} dpi has "
            f"{ny * nx * found.dots**2 / 1e6:.0f} million dots, {_MOST_DOTS / 1e6:.0f} are the most: take fewer (--dpi)"
        )
    return Layout(paper, pages[0], dpi, found.dots, found.cells)


def _fits(need: Reals, page: tuple[float, float]) -> bool:
    return bool(np.all(need <= np.array(page) - 2 * MARGIN_MM + 1e-9))


def _dots(stack: Stack, dpi: int) -> float:
    """Dots along a cell's side."""
    return stack.voxel_mm * dpi / _INCH


def _is_whole(stack: Stack, dpi: int) -> bool:
    """Whether whole dots make a film that is as large as it should be."""
    dots = _dots(stack, dpi)
    off_mm = abs(dots - round(dots)) * max(stack.shape[1:]) * _INCH / dpi
    return round(dots) >= 1 and off_mm <= _OFF_MM


def _dpi(stack: Stack, rig: Rig, dpi: int | None) -> int:
    """Dots an inch of which cells are whole ones, or `InputError`."""
    low, high = _SOME_DPI
    others = sorted(range(low, high + 1), key=lambda each: (abs(each - (dpi or _USUAL_DPI)), each))
    fitting = next((each for each in others if _is_whole(stack, each)), None)
    if dpi is None and fitting is not None:
        return fitting
    if dpi is not None and not _LEAST_DPI <= dpi <= _MOST_DPI:
        raise InputError(f"pages have {_LEAST_DPI} to {_MOST_DPI} dots an inch, not {dpi}: mend --dpi")
    if dpi is not None and _is_whole(stack, dpi):
        return dpi
    said = dpi or _USUAL_DPI
    dots = _dots(stack, said)
    size = _picture_mm(rig) * max(round(dots), 1) / dots
    take = f"take --dpi {fitting}, or make pictures" if fitting is not None else "make pictures"
    raise InputError(
        f"cells of {stack.voxel_mm:.6g} mm are {dots:.2f} dots at {said} dpi, which are not whole ones: {take} "
        f"{size:.6g} mm large (solve --size-mm {size:.6g})"
    )


def _picture_mm(rig: Rig) -> float:
    """The longest side of a rig's pictures."""
    rows, columns = rig.picture_shape
    views = rig.views
    across, along = (np.linalg.norm(steps[0]) for steps in (views.column_steps_mm, views.row_steps_mm))
    return float(max(columns * across, rows * along))


def _too_large(found: Layout, need: Reals, rig: Rig) -> str:
    """What would fit, in a sentence."""
    width, height = (page - 2 * MARGIN_MM for page in found.page_mm)
    over = min(max(need[0] - width, need[1] - height), max(need[0] - height, need[1] - width))
    larger = [name for name, page in PAPERS.items() if _fits(need, page) or _fits(need, page[::-1])]
    ways = [f"take --paper {min(larger, key=lambda name: math.prod(PAPERS[name]))}"] if larger else []
    smaller = math.floor(_picture_mm(rig) - over - 2 * found.dots * _INCH / found.dpi)
    ways += [f"make pictures {smaller} mm large (solve --size-mm {smaller})"] if smaller > 0 else []
    ways = ways or ["let lamps stand more upright, or films lie nearer to each other"]
    films = " x ".join(f"{side:.1f}" for side in found.size_mm)
    return (
        f"films of {films} mm, with {STRIP_MM:g} mm for marks above and below, do not fit {found.paper}, which has "
        f"{width:g} x {height:g} mm inside its margins: {', or '.join(ways)}"
    )
