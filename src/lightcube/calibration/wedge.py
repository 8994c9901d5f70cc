"""A page of patches whose coverages are known: where each lies, and the page as a picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from lightcube.errors import InputError
from lightcube.optics.arrays import Bytes, Reals
from lightcube.optics.checks import check_fields
from lightcube.wording import counted

#: A4, mm.
PAGE_MM = (210.0, 297.0)
#: Side of a patch, and from one to the next, mm; the first one's middle; so many stand in a row, in so many rows.
PATCH_MM, PITCH_MM, _FIRST_MM, _ACROSS, _ROWS = 10.0, 12.0, (15.0, 34.0), 16, 20
#: Middles of the marks, which have one, two, three and four holes; and where the film is to be cut out.
MARKS_MM = np.array([(15.0, 15.0), (195.0, 15.0), (195.0, 282.0), (15.0, 282.0)])
WINDOWS_MM = np.array([(75.0, 282.0), (135.0, 282.0)])
#: Holes of a mark, from its middle, as parts of its side; and their radius.
_HOLES, _RADIUS = ((-0.22, -0.22), (0.22, 0.22), (0.22, -0.22), (-0.22, 0.22)), 0.11
#: The part of a mark that a hole is.
HOLE = math.pi * _RADIUS**2
#: What a page in red, green and blue can be printed in.
PROCESS = {
    "cyan": (0, 1, 1),
    "magenta": (1, 0, 1),
    "yellow": (1, 1, 0),
    "black": (0, 0, 0),
    "red": (1, 0, 0),
    "green": (0, 1, 0),
    "blue": (0, 0, 1),
}
#: Inks are laid over each other at these coverages; more inks than these at the full one only.
_OVER, _FEW = (1.0, 0.5), 4
STEPS = (16, 32)


@dataclass(frozen=True)
class Patch:
    """A patch: coverage of each ink as it is sent to the printer, its row and column from 1, and its middle, mm."""

    coverages: tuple[float, ...]
    row: int
    column: int

    @property
    def middle_mm(self) -> tuple[float, float]:
        """From the page's upper left, right and down."""
        return _FIRST_MM[0] + (self.column - 1) * PITCH_MM, _FIRST_MM[1] + (self.row - 1) * PITCH_MM


@dataclass(frozen=True)
class Wedge:
    """A page of patches of some inks.

    Parameters
    ----------
    inks
        Their names.
    steps
        How many coverages of each ink there are, even in coverage, none and all among them: 16 or 32.

    Raises
    ------
    InputError
        Where there are other steps, no ink, one twice, or more than the page has room for.
    """

    inks: tuple[str, ...]
    steps: int = 16

    def __post_init__(self) -> None:
        check_fields(self)
        if self.steps not in STEPS:
            raise InputError(f"a wedge has 16 or 32 steps, not {self.steps}")
        if not self.inks or len(set(self.inks)) < len(self.inks) or not all(name.strip() for name in self.inks):
            raise InputError(f"a wedge is of inks with names of their own, not of {', '.join(self.inks) or 'none'}")
        if len(self.patches) and self.patches[-1].row > _ROWS:
            many = counted(len(self.inks), "ink")
            raise InputError(f"{many} at {self.steps} steps are more than a page takes: print fewer, or 16 steps")

    @property
    def patches(self) -> list[Patch]:
        """All patches: each ink's steps and those of several inks, and the same again elsewhere, turned about."""
        single = [
            [self._only(ink, step / (self.steps - 1)) for step in range(first, first + _ACROSS)]
            for ink in range(len(self.inks))
            for first in range(0, self.steps, _ACROSS)
        ]
        several = self._several()
        free = -len(several) % _ACROSS or _ACROSS * (not several)
        several += [self._only(place % len(self.inks), 1.0) for place in range(free)]  # what matters most, once more
        rows = single + [several[first : first + _ACROSS] for first in range(0, len(several), _ACROSS)]
        again = [row[::-1] for row in reversed(rows)]
        return [
            Patch(coverages, number + 1, column + 1)
            for number, row in enumerate(rows + again)
            for column, coverages in enumerate(row)
        ]

    def _only(self, ink: int, coverage: float) -> tuple[float, ...]:
        return tuple(coverage if other == ink else 0.0 for other in range(len(self.inks)))

    def _several(self) -> list[tuple[float, ...]]:
        """Pairs and triples of inks over each other."""
        inks = range(len(self.inks))
        sets = [some for count in (2, 3) for some in combinations(inks, count)]
        over = _OVER if len(self.inks) <= _FEW else _OVER[:1]
        return [tuple(part if ink in some else 0.0 for ink in inks) for some in sets for part in over]

    def called(self, patch: Patch) -> str:
        """A patch as people are told of it."""
        inks = [f"{part:.0%} {ink}" for ink, part in zip(self.inks, patch.coverages, strict=True) if part]
        return f"the patch of {' and '.join(inks) or 'bare film'} in row {patch.row}, column {patch.column}"


def page(wedge: Wedge, dpi: int = 300) -> Bytes:
    """The page as a picture ``(row, column, 3)`` to be printed without scaling and without colour management.

    Raises
    ------
    InputError
        Where inks are none that red, green and blue stand for.
    """
    unknown = [ink for ink in wedge.inks if ink not in PROCESS]
    if unknown:
        raise InputError(
            f"a picture has no ink called {unknown[0]!r}: a page in red, green and blue prints {', '.join(PROCESS)}"
        )
    if not 50 <= dpi <= 1200:
        raise InputError(f"a page has 50 to 1200 dots an inch, not {dpi}")
    dots = dpi / 25.4
    size = (round(PAGE_MM[0] * dots), round(PAGE_MM[1] * dots))
    image = Image.new("RGB", size, "white")
    draw = ImageDraw.Draw(image)
    for patch in wedge.patches:
        _square(draw, patch.middle_mm, dots, _colour(wedge.inks, patch.coverages))
    for number, (x, y) in enumerate(MARKS_MM):
        _square(draw, (x, y), dots, _colour(wedge.inks, (1.0,) * len(wedge.inks)))
        for right, down in _HOLES[: number + 1]:
            _disc(draw, (x + right * PATCH_MM, y + down * PATCH_MM), _RADIUS * PATCH_MM, dots)
    _say(draw, wedge, dots)
    return np.asarray(image)


def _colour(inks: tuple[str, ...], coverages: tuple[float, ...]) -> tuple[int, ...]:
    """Red, green and blue of inks that cover such parts of white."""
    parts = np.prod(
        [1 - part * (1 - np.array(PROCESS[ink])) for ink, part in zip(inks, coverages, strict=True)], axis=0
    )
    return tuple(np.rint(255 * parts).astype(int).tolist())


def _square(draw: ImageDraw.ImageDraw, middle_mm: tuple[float, float], dots: float, colour: tuple[int, ...]) -> None:
    left, top, right, bottom = (round((along + way * PATCH_MM / 2) * dots) for way in (-1, 1) for along in middle_mm)
    draw.rectangle((left, top, right - 1, bottom - 1), colour)


def _disc(draw: ImageDraw.ImageDraw, middle_mm: tuple[float, float], radius_mm: float, dots: float) -> None:
    box = [(along + way * radius_mm) * dots for way in (-1, 1) for along in middle_mm]
    draw.ellipse(box, "white")


def _say(draw: ImageDraw.ImageDraw, wedge: Wedge, dots: float) -> None:
    """Write what the page is, and draw the windows that are to be cut out."""
    font, small = (ImageFont.load_default(size_mm * dots) for size_mm in (4.0, 3.0))
    lines = [
        (26.0, 11.0, font, f"lightcube: {', '.join(wedge.inks)}, {wedge.steps} steps"),
        (
            26.0,
            17.0,
            small,
            "Print at 100 % on film, best quality, no colour management. Cut out the dashed windows.",
        ),
        (
            26.0,
            21.0,
            small,
            "Photograph it flat before an even white light, sharp, nothing overexposed.",
        ),
        (84.0, 280.5, small, "cut out the two windows"),
    ]
    for x, y, face, text in lines:
        draw.text((x * dots, y * dots), text, "black", face)
    half = PATCH_MM / 2
    for x, y in WINDOWS_MM:
        corners = [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)]
        for begin, end in zip(corners, [*corners[1:], corners[0]], strict=True):
            for dash in range(5):
                ends = [np.array(begin) + (np.array(end) - begin) * (dash + part) / 5 for part in (0.2, 0.8)]
                draw.line([tuple(each * dots) for each in ends], (190, 190, 190), max(1, round(0.2 * dots)))


def bare_mm() -> Reals:
    """Places, mm, in the gaps between patches, where the film is bare: ``(place, 2)``."""
    across = _FIRST_MM[0] + PITCH_MM * (np.arange(_ACROSS - 1) + 0.5)
    down = _FIRST_MM[1] + PITCH_MM * (np.arange(_ROWS) - 0.5)
    return np.stack(np.meshgrid(across, down), axis=-1).reshape(-1, 2)
