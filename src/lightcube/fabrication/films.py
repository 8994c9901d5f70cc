"""Printed films of a stack, as a PDF whose every page is one film, exact to a hundredth of a millimetre."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.fabrication import film_pages
from lightcube.fabrication.assembly import assembly
from lightcube.fabrication.coverage import Printed, levels_of
from lightcube.fabrication.dots import Halftone, blue_dots
from lightcube.fabrication.film_file import FilmFacts, stack_of
from lightcube.fabrication.paper import Layout, layout
from lightcube.fabrication.planned import Advance, File, Planned, named
from lightcube.io._files import Replaceable
from lightcube.io._places import Place
from lightcube.optics.arrays import Volume
from lightcube.optics.checks import check_fields
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack

#: How much larger or smaller a printer may have to be told to print.
_MOST_SCALE = 1.1
_RGB = (
    "pages are of red, green and blue light, of which the printer's driver makes inks by its own rules, and each ink "
    "absorbs more colours than one: four photographs came out at 21 dB; solve them in the inks that they are printed "
    "with (solve --material)"
)
_DOTS = "what dots of one film cover of another's by chance is left out of the score of a halftone"


@dataclass(frozen=True)
class FilmPages:
    """How films are printed.

    Parameters
    ----------
    paper
        One of `lightcube.fabrication.paper.PAPERS`.
    dpi
        Dots an inch of which cells are a whole number; None = 600, or the next that fits.
    inks
        What they are printed with; None = those that the stack was solved in, or else red, green and blue light.
    mirror
        Print on the side of the film that lies below.
    scale_x, scale_y
        How much larger everything is drawn, for a printer whose 100 mm are not: 100 / what it prints.
    halftone
        ``"none"``: levels, of which the printer makes dots; ``"blue"``: dots of full ink, as blue noise.
    """

    called: ClassVar[str] = "pages of films"
    suffixes: ClassVar[tuple[str, ...]] = (".pdf",)
    replaceable: ClassVar[Replaceable] = None

    paper: str = "a4"
    dpi: int | None = None
    inks: Dyes | None = None
    mirror: bool = False
    scale_x: float = 1.0
    scale_y: float = 1.0
    halftone: Halftone = "none"

    def __post_init__(self) -> None:
        check_fields(self)
        for name in ("scale_x", "scale_y"):
            value = getattr(self, name)
            if not 1 / _MOST_SCALE <= value <= _MOST_SCALE:
                raise InputError(
                    f"{name} is 100 mm divided by what the printer makes of them, from {1 / _MOST_SCALE:.2f} to "
                    f"{_MOST_SCALE:g}, not {value:g}"
                )

    def laid_out(self, grid: Grid, rig: Rig) -> tuple[Stack, Layout]:
        """The stack, and where its films lie on their pages; `InputError` where they do not fit, or are none."""
        film_pages.reportlab()
        if not isinstance(grid, Stack):
            raise InputError(
                "this is a cube, not a stack of films: make one of it (export film --films 16), or solve one "
                "for pictures (solve --films 5)"
            )
        return grid, layout(grid, rig, self.paper, self.dpi, (self.scale_x, self.scale_y))

    def plan(self, cube: Cube, at: Place) -> Planned:
        """What would be written."""
        stack, where = self.laid_out(cube.grid, cube.rig)
        told, scale = assembly(cube, stack, is_mirrored=self.mirror), (self.scale_x, self.scale_y)
        levels, printed, lost = levels_of(cube, self.inks)
        if self.halftone != "none" and printed.dyes is None:
            raise InputError("dots are of inks, and none are named: say which (--inks), or leave --halftone out")
        dots = _dots(self.halftone, where)
        sheets = film_pages.Sheets(where, levels, printed, told, scale, self.mirror, dots)
        facts = _facts(where, printed, scale, is_mirrored=self.mirror)

        def held(path: Path) -> tuple[Volume, Grid]:
            return stack_of(path, facts, stack.heights_mm, stack.index)[:2]

        def written(path: Path, advance: Advance) -> None:
            film_pages.write_sheets(path, sheets, advance)
            volume, grid = held(path)
            _check_same(path, volume * np.float32(grid.voxel_mm), levels, printed, self.halftone)

        known = {
            "films": stack.shape[0],
            "heights_mm": list(stack.heights_mm),
            "size_mm": named(stack.size_mm[::-1]),
            **_places(where),
            "film": facts.model_dump(),
            "halftone": self.halftone,
            **({"lost": lost} if lost else {}),
        }
        notes = [_RGB] if printed.dyes is None else printed.dyes.doubts
        notes += [_DOTS] * (self.halftone != "none")
        return Planned((File(at, written),), known, tuple(notes), held, is_relit=bool(lost))


def _dots(halftone: Halftone, where: Layout) -> Callable[[int, NDArray[np.uint8]], NDArray[np.uint8]]:
    """What makes dots of a film's levels."""

    def whole(_: int, levels: NDArray[np.uint8]) -> NDArray[np.uint8]:
        return np.repeat(np.repeat(levels, where.dots, axis=0), where.dots, axis=1)

    return whole if halftone == "none" else lambda film, levels: blue_dots(film, whole(film, levels))


def _facts(where: Layout, printed: Printed, scale: tuple[float, float], *, is_mirrored: bool) -> FilmFacts:
    """What is needed to read pages again."""
    corners = zip(where.corner_mm, where.size_mm, where.page_mm, scale, strict=True)
    middle = [page / 2 + (corner + size / 2 - page / 2) * larger for corner, size, page, larger in corners]
    return FilmFacts(
        cells=list(where.cells),
        middle_mm=middle,
        page_mm=list(where.page_mm),
        scale=list(scale),
        is_mirrored=is_mirrored,
        space=printed.space,
        inks=None if printed.dyes is None else printed.dyes.plain(),
    )


def _places(where: Layout) -> dict[str, Any]:
    """Where things stand on each page, mm from its lower left corner, as long as nothing is drawn larger."""
    return {
        "paper": where.paper,
        "dpi": [where.dpi, where.dpi],
        "dots_a_cell": where.dots,
        "picture_mm": {"corner": list(where.corner_mm), "size": list(where.size_mm)},
        "crosses_mm": [list(each) for each in where.crosses_mm],
        "pins_mm": [list(each) for each in where.pins_mm],
    }


def _check_same(
    path: Path, read: Volume, levels: NDArray[np.uint8], printed: Printed, halftone: Literal["none", "blue"]
) -> None:
    """Raise `InputError` where a file does not hold what it was to hold."""
    wanted = printed.absorbance(levels.astype(np.float64))
    if halftone == "none" and not np.allclose(read, wanted, rtol=1e-4, atol=1e-5):
        raise InputError(f"{path.name} does not hold what was written: try another version of reportlab")
