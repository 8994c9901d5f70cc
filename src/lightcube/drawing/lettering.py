"""Words on pictures: in Pillow's own font, or in one of this machine's where that has not all of their letters."""

import math
import unicodedata
from collections.abc import Iterator
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

from PIL import ImageDraw, ImageFont

Font = ImageFont.FreeTypeFont | ImageFont.ImageFont

#: Files of fonts with many letters, which Pillow looks for where the system keeps its fonts; matplotlib has the first.
_FILES = ("DejaVuSans.ttf", "NotoSans-Regular.ttf", "arial.ttf", "Arial Unicode.ttf", "NotoSansCJK-Regular.ttc")
#: More letters than these no line has.
_MOST = 200


def write(
    draw: ImageDraw.ImageDraw,
    place: tuple[float, float],
    text: str,
    size: float,
    ink: int | tuple[int, int, int],
    width: float,
    anchor: str = "la",
) -> None:
    """Draw a text as one line in letters of so many pixels, cut where it is wider than `width`."""
    plain, font = spelled(text, size)
    draw.text(place, cut(plain, font, width), ink, font, anchor)


def spelled(text: str, size: float) -> tuple[str, Font]:
    """A text as one line, and the first font that has most of its letters.

    What it does not have is written without what is above and below it, and what is unknown then, too, as ``?``.
    """
    whole = unicodedata.normalize("NFC", text)  # names of files have letters and accents apart on some systems
    line = "".join(letter if letter.isprintable() else " " for letter in whole)[:_MOST].strip()
    font: Font = ImageFont.load_default(size)
    unknown: float = math.inf
    for other in _fonts(size):
        count = sum(not _has(other, letter) for letter in line)
        font, unknown = (other, count) if count < unknown else (font, unknown)
        if not unknown:
            break
    return "".join(_nearest(font, letter) for letter in line), font


def _nearest(font: Font, letter: str) -> str:
    """A letter, or what is like it, as a font has it."""
    bare = "".join(each for each in unicodedata.normalize("NFKD", letter) if not unicodedata.combining(each))
    likes = (each for each in (letter, bare) if each and all(_has(font, part) for part in each))
    return next(likes, "?")


def cut(line: str, font: Font, width: float) -> str:
    """A line, cut where it is wider than so many pixels."""
    while line and font.getlength(line) > width:
        line = line[:-2].rstrip("… ") + "…" if len(line) > 1 else ""
    return line


def _fonts(size: float) -> Iterator[Font]:
    """The built-in font, and those of the machine, each when it is asked for."""
    yield ImageFont.load_default(size)
    plots = find_spec("matplotlib")
    beside = [] if plots is None else [str(Path(str(plots.origin)).parent / "mpl-data" / "fonts" / "ttf" / _FILES[0])]
    for file in (*beside, *_FILES):
        with suppress(OSError):
            yield ImageFont.truetype(file, size)


def _has(font: Font, letter: str) -> bool:
    """Whether a font knows a letter: it draws the same box for whatever it does not know."""
    return letter == " " or bytes(font.getmask(letter)) != bytes(font.getmask("\uffff"))
