"""A wall's pictures as people share them: large, in the dark, with a name below."""

import math
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from lightcube.optics.transfer import Transfer, decode, encode

Picture = NDArray[np.float32]
Font = ImageFont.FreeTypeFont | ImageFont.ImageFont

#: Shapes of movies that people share.
Format = Literal["square", "portrait", "wide"]
#: Their rows and columns.
SIZES: dict[Format, tuple[int, int]] = {"square": (1080, 1080), "portrait": (1920, 1080), "wide": (1080, 1920)}
#: Parts of the frame that a picture spans at most where there is something around it, and where there is nothing.
_SPAN, _ALL = 0.68, 0.84
#: The iris is open as far as this from the middle of the picture, in halves of its diagonal, and shut there.
_OPEN, _SHUT = 1.1, 1.5
#: A caption: its height and how far below the picture its middle is, in parts of the frame's shorter side; its light.
_LETTERS, _BELOW, _INK = 0.04, 0.05, 0.75


def poster(
    picture: Picture, window: NDArray[np.integer[Any]], size: tuple[int, int], transfer: Transfer, caption: str = ""
) -> Picture:
    """A picture large in a dark frame, its light kept to itself and its mat by a soft iris.

    Parameters
    ----------
    picture
        ``(row, column, channel)``, linear light.
    window
        Top, left, rows and columns of what was wanted in it.
    size
        Rows and columns of the frame.
    caption
        Stands below the picture.
    """
    rows, columns = int(window[2]), int(window[3])
    fits = min(size[0] / rows, size[1] / columns)
    whole = min(size[0] / picture.shape[0], size[1] / picture.shape[1])
    scale = min(_ALL * fits, max(_SPAN * fits, _ALL * whole))
    shown = _enlarged(np.clip(encode(picture, transfer), 0, None), window, size, scale)
    if caption:
        below = (size[0] + scale * rows) / 2 + _BELOW * min(size)
        shown = np.maximum(shown, np.float32(_INK) * lettering(caption, size, below)[..., None])
    return np.asarray(decode(shown, transfer), np.float32)


def _enlarged(
    picture: NDArray[np.floating[Any]], window: NDArray[np.integer[Any]], size: tuple[int, int], scale: float
) -> Picture:
    """The part of a picture around its window, enlarged to a frame, dark where there is nothing: display values."""
    top, left, rows, columns = (int(number) for number in window)
    down, across = (np.arange(count) + 0.5 for count in picture.shape[:2])
    kept = picture.astype(np.float32) * iris(down[:, None] - top, across - left, (rows, columns))[..., None]
    margin = math.ceil(max(size) / scale)
    padded = np.pad(kept, ((margin, margin), (margin, margin), (0, 0)))
    middle = np.array([left + columns / 2, top + rows / 2]) + margin
    half = np.array(size[::-1]) / 2 / scale
    box = (*(middle - half), *(middle + half))
    colours = [
        np.asarray(Image.fromarray(padded[..., c]).resize(size[::-1], Image.Resampling.BICUBIC, box=box))
        for c in range(padded.shape[2])
    ]
    return np.maximum(np.stack(colours, axis=2), np.float32(0))


def iris(down: NDArray[Any], across: NDArray[Any], window: tuple[int, int]) -> Picture:
    """What an iris lets through at some rows and columns of a picture, in display values; all within its window."""
    rows, columns = window
    away = np.hypot(down - rows / 2, across - columns / 2) / (math.hypot(rows, columns) / 2)
    part = np.clip((_SHUT - away) / (_SHUT - _OPEN), 0, 1)
    return np.asarray(part * part * (3 - 2 * part), np.float32)


def lettering(text: str, size: tuple[int, int], below: float) -> Picture:
    """``(row, column)`` from 0 to 1: a line of text, its middle in that row of a frame, cut where it is too long."""
    rows, columns = size
    font = ImageFont.load_default(max(9, round(_LETTERS * min(size))))
    line = in_line(text, font, 0.9 * columns)
    sheet = Image.new("L", (columns, rows))
    ImageDraw.Draw(sheet).text((columns / 2, below), line, 255, font, anchor="mm")
    return np.asarray(sheet, np.float32) / np.float32(255)


def in_line(text: str, font: Font, width: float) -> str:
    """A text as one line, cut where it is wider than so many pixels."""
    line = "".join(letter if letter.isprintable() else " " for letter in text)[:200].strip()
    while line and font.getlength(line) > width:
        line = line[:-2].rstrip("… ") + "…" if len(line) > 1 else ""
    return line
