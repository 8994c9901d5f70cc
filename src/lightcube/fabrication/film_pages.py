"""Pages of films as a PDF: how they are put together, a wedge, and one page for each film, drawn in mm."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.fabrication.assembly import Assembly
from lightcube.fabrication.coverage import Printed
from lightcube.fabrication.paper import ARM_MM, MARGIN_MM, PIN_MM, Layout
from lightcube.io._pdf import POINTS

#: Width of lines, and heights of letters, mm: of words, of headings, of the number of a film.
_LINE, _WORDS, _HEADING, _LARGE = 0.1, 3.0, 5.0, 9.0
_FONT, _BOLD = "Helvetica", "Helvetica-Bold"
#: From one line of words to the next.
_LEAD = 4.4
#: Patches of the wedge: how many of each ink, and how large.
_STEPS, _PATCH_MM = 16, 10.0


@dataclass(frozen=True, eq=False)
class Sheets:
    """All that is drawn.

    Parameters
    ----------
    layout
        Where films lie on their pages.
    levels
        ``(film, y, x, colour)``.
    printed
        What those stand for.
    assembly
        What the first page says.
    scale
        How much larger everything is drawn, along x and y.
    is_mirrored
        Whether films' pages are mirrored.
    dots
        Makes a picture's dots ``(row, column, colour)`` of a film's levels.
    """

    layout: Layout
    levels: NDArray[np.uint8]
    printed: Printed
    assembly: Assembly
    scale: tuple[float, float]
    is_mirrored: bool
    dots: Callable[[int, NDArray[np.uint8]], NDArray[np.uint8]]


def reportlab() -> ModuleType:
    """The package that draws pages, or `InputError` where there is none."""
    try:
        import reportlab.pdfgen.canvas as canvas
    except ModuleNotFoundError:
        raise InputError("pages of films need one more package: pip install 'lightcube[fabricate]'") from None
    return canvas


def write_sheets(path: Path, sheets: Sheets, advance: Callable[[int, int], None]) -> None:
    """Write all pages: the same films give the same bytes."""
    films = len(sheets.levels)
    with _plain_streams():
        canvas = reportlab().Canvas(
            str(path),
            pagesize=[side * POINTS for side in sheets.layout.page_mm],
            pageCompression=1,
            invariant=1,  # no date
        )
        canvas.setTitle(_shown(sheets.assembly.title))
        canvas.setViewerPreference("PrintScaling", "None")  # programs that print then offer 100 %
        _assembly_pages(canvas, sheets)
        _wedge_page(canvas, sheets)
        for film in range(films):
            with _page(canvas, sheets, mirrored=sheets.is_mirrored):
                _film_page(canvas, sheets, film)
            advance(film + 1, films)
        canvas.save()


@contextmanager
def _plain_streams() -> Iterator[None]:
    """Let streams be bytes, not letters, which were a quarter longer."""
    from reportlab import rl_config

    before, rl_config.useA85 = rl_config.useA85, 0
    try:
        yield
    finally:
        rl_config.useA85 = before


@contextmanager
def _page(canvas: Any, sheets: Sheets, *, mirrored: bool = False) -> Iterator[None]:
    """A page in mm from its lower left corner, made larger about its middle."""
    canvas.saveState()
    canvas.scale(POINTS, POINTS)
    width, height = sheets.layout.page_mm
    across, along = sheets.scale
    if mirrored:
        canvas.translate(width, 0)
        canvas.scale(-1, 1)
    if sheets.scale != (1, 1):
        canvas.translate(width / 2 * (1 - across), height / 2 * (1 - along))
        canvas.scale(across, along)
    canvas.setLineWidth(_LINE)
    yield
    canvas.restoreState()
    canvas.showPage()


def _film_page(canvas: Any, sheets: Sheets, film: int) -> None:
    """A film, and what surrounds it."""
    from PIL import Image
    from reportlab.lib.utils import ImageReader

    where = sheets.layout
    (left, bottom), (width, height) = where.corner_mm, where.size_mm
    dots = sheets.dots(film, sheets.levels[film][::-1])  # rows of pictures go down
    mode = {1: "L", 3: "RGB", 4: "CMYK"}[dots.shape[2]]
    picture = Image.fromarray(dots[..., 0] if mode == "L" else dots, mode=mode)
    canvas.drawImage(ImageReader(picture), left, bottom, width, height)
    for x, y in where.crosses_mm:
        _cross(canvas, x, y, ARM_MM)
    for x, y in where.pins_mm:
        canvas.circle(x, y, PIN_MM)
        _cross(canvas, x, y, PIN_MM / 2)
    (first, wide), top = where.marks_mm, bottom + height + 4
    canvas.setFont(_FONT, _LARGE / 0.72)  # capitals are so high
    canvas.drawCentredString(first + 0.47 * wide, top, str(film + 1))
    canvas.drawCentredString(first + 0.77 * wide, top, "F")
    _arrow(canvas, first + 0.62 * wide, top, _LARGE)
    side = ", printed side down" if sheets.is_mirrored else ""
    which = f"film {film + 1} of {len(sheets.levels)}, {sheets.assembly.heights[film]}"
    told = f"{which}: print at 100 %, this side up{side}, arrow away from you"
    _words(canvas, where.page_mm[0] / 2, bottom - 17, told, where.page_mm[0] - 2 * MARGIN_MM, centred=True)


def _cross(canvas: Any, x: float, y: float, arm: float) -> None:
    canvas.line(x - arm, y, x + arm, y)
    canvas.line(x, y - arm, x, y + arm)


def _arrow(canvas: Any, x: float, y: float, length: float) -> None:
    """An arrow up."""
    canvas.setLineWidth(5 * _LINE)
    canvas.line(x, y, x, y + length)
    for side in (-1, 1):
        canvas.line(x, y + length, x + side * length / 5, y + 0.7 * length)
    canvas.setLineWidth(_LINE)


def _words(
    canvas: Any,
    x: float,
    y: float,
    said: str,
    room: float,
    size: float = _WORDS,
    *,
    centred: bool = False,
    font: str = _FONT,
) -> None:
    """A line of words, in smaller letters where there is too little room."""
    from reportlab.pdfbase.pdfmetrics import stringWidth

    said = _shown(said)
    size = min(size, size * room / max(stringWidth(said, font, size), 1e-9))
    canvas.setFont(font, size)
    (canvas.drawCentredString if centred else canvas.drawString)(x, y, said)


def _shown(said: str) -> str:
    """Letters that every PDF can show."""
    return said.encode("cp1252", "replace").decode("cp1252")


def _assembly_pages(canvas: Any, sheets: Sheets) -> None:
    """What is to be done and known, on as many pages as it takes."""
    width, height = sheets.layout.page_mm
    lines = list(_lines(sheets.assembly))
    first = True
    while lines or first:
        with _page(canvas, sheets):
            y = height - MARGIN_MM - _HEADING
            if first:
                y = _head(canvas, sheets, y)
            low = MARGIN_MM + 14
            while lines and y > low:
                said, size, font = lines.pop(0)
                _words(canvas, MARGIN_MM, y, said, width - 2 * MARGIN_MM - 14, size, font=font)
                y -= _LEAD * size / _WORDS
            _bars(canvas, sheets)
        first = False


def _lines(assembly: Assembly) -> Iterator[tuple[str, float, str]]:
    """Lines of words with the heights and kinds of their letters."""
    for heading, told in assembly.sections:
        yield "", _WORDS, _FONT
        yield heading, 3.6, _BOLD
        for line in told:
            yield line, _WORDS, _FONT


def _head(canvas: Any, sheets: Sheets, y: float) -> float:
    """Title, a large F, and the films from the side; returns what is left below."""
    width, _ = sheets.layout.page_mm
    _words(canvas, MARGIN_MM, y, sheets.assembly.title, width - 70, _HEADING, font=_BOLD)
    _words(canvas, MARGIN_MM, y - 7, sheets.assembly.subtitle, width - 70)
    canvas.setFont(_BOLD, 18 / 0.72)
    canvas.drawString(width - MARGIN_MM - 36, y - 13, "F")
    _words(canvas, width - MARGIN_MM - 40, y - 18, "seen from above", 30, 2.4)
    high = 46.0
    _side(canvas, sheets.assembly, (MARGIN_MM + 4, y - 20 - high), (width - 2 * MARGIN_MM - 24, high))
    return y - 20 - high - 4


def _side(canvas: Any, assembly: Assembly, corner: tuple[float, float], room: tuple[float, float]) -> None:
    """The films from the side with the light of each lamp, to scale."""
    heights = np.array(assembly.heights_mm)
    wide = assembly.size_mm[0]
    above = 0.35 * max(float(np.ptp(heights)), 0.15 * wide)
    high = float(np.ptp(heights)) + 2 * above
    scale = min(0.7 * room[0] / wide, room[1] / high)
    middle, ground = corner[0] + room[0] / 2 - 20, corner[1] + room[1] / 2
    centre = (heights[0] + heights[-1]) / 2
    canvas.setStrokeColorRGB(0.85, 0.6, 0.1)
    up = high / 2 * scale
    for slope in assembly.slopes:
        if abs(slope) * up < room[0]:
            canvas.line(middle - slope * up, ground + up, middle + slope * up, ground - up)
    canvas.setStrokeColorRGB(0.1, 0.3, 0.5)
    canvas.setLineWidth(4 * _LINE)
    labelled = _spread([ground + scale * (each - centre) for each in heights], 3.2)
    for number, (each, label) in enumerate(zip(heights, labelled, strict=True)):
        y = ground + scale * (each - centre)
        canvas.line(middle - scale * wide / 2, y, middle + scale * wide / 2, y)
        if len(heights) <= 16:
            told = f"{number + 1}: {assembly.heights[number]}"
            _words(canvas, middle + scale * wide / 2 + 3, label - 1, told, 40, 2.6)
    canvas.setStrokeColorRGB(0, 0, 0)
    canvas.setLineWidth(_LINE)


def _spread(places: Sequence[float], apart: float) -> list[float]:
    """Places of words beside lines, moved up until none covers another."""
    found: list[float] = []
    for place in places:
        found.append(max(place, found[-1] + apart) if found else place)
    shift = (found[-1] - places[-1]) / 2
    return [place - shift for place in found]


def _bars(canvas: Any, sheets: Sheets) -> None:
    """Bars of 100 mm along both sides, or of 50 where the page is small."""
    width, height = sheets.layout.page_mm
    long = 100 if min(width, height) > 130 else 50
    x, y = MARGIN_MM + 2, MARGIN_MM + 4
    canvas.line(x, y, x + long, y)
    far = width - MARGIN_MM - 4
    canvas.line(far, y, far, y + long)
    for step in range(0, long + 1, 10):
        tick = 3 if step % 50 == 0 else 1.5
        canvas.line(x + step, y, x + step, y + tick)
        canvas.line(far, y + step, far - tick, y + step)
    _words(canvas, x + 2, y + 4.5, f"{long} mm: measure both bars on the print", long - 4, 2.6)
    _words(canvas, far - 22, y + long + 2, f"{long} mm", 22, 2.6)


def _wedge_page(canvas: Any, sheets: Sheets) -> None:
    """Patches of each ink, in even steps of what is sent: what they let through says how the printer prints."""
    width, height = sheets.layout.page_mm
    with _page(canvas, sheets):
        top = height - MARGIN_MM - _HEADING
        room = width - 2 * MARGIN_MM
        _words(canvas, MARGIN_MM, top, "Wedge: even steps of each ink", room, _HEADING, font=_BOLD)
        told = "how this printer prints; the page by which its inks are measured is that of lightcube calibrate wedge"
        _words(canvas, MARGIN_MM, top - 7, told, room)
        patch = min(_PATCH_MM, (width - 2 * MARGIN_MM - 24) / _STEPS)
        for row, (name, colour) in enumerate(_inks(sheets.printed)):
            y = top - 14 - patch - (patch + 8) * row
            if y < MARGIN_MM:
                break
            _words(canvas, MARGIN_MM, y + patch / 2 - 1, name, 20)
            for step in range(_STEPS):
                _fill(canvas, colour(step / (_STEPS - 1)))
                canvas.rect(MARGIN_MM + 22 + step * patch, y, patch, patch, stroke=0, fill=1)
                canvas.setFillGray(0)
                middle = MARGIN_MM + 22 + (step + 0.5) * patch
                _words(canvas, middle, y - 3, f"{step / (_STEPS - 1):.0%}", patch - 1, 2.4, centred=True)
            canvas.rect(MARGIN_MM + 22, y, _STEPS * patch, patch)


def _inks(printed: Printed) -> Iterator[tuple[str, Callable[[float], tuple[float, ...]]]]:
    """Names of what pages are printed of, and the colour of a part of it."""
    if printed.space == "grey":
        yield printed.dyes.names[0] if printed.dyes else "black", lambda part: (1 - part,)
        return
    if printed.space == "cmyk":
        for place, name in enumerate(("cyan", "magenta", "yellow", "black")):
            yield name, lambda part, place=place: tuple(part * (place == each) for each in range(4))  # type: ignore[misc]
        return
    for place, name in enumerate(("red", "green", "blue")):
        yield f"less {name}", lambda part, place=place: tuple(1 - part * (place == each) for each in range(3))  # type: ignore[misc]
    yield "less light", lambda part: (1 - part,) * 3


def _fill(canvas: Any, colour: tuple[float, ...]) -> None:
    """What shapes are filled with: grey, three colours or four inks."""
    {1: canvas.setFillGray, 3: canvas.setFillColorRGB, 4: canvas.setFillColorCMYK}[len(colour)](*colour)
