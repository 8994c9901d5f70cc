"""A wall's pictures as people share them: large, in the dark, with a name below."""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from lightcube.drawing.lettering import write
from lightcube.optics.transfer import Transfer, decode, encode

Picture = NDArray[np.float32]

#: Shapes of movies that people share.
Format = Literal["square", "portrait", "wide"]
#: Their rows and columns.
SIZES: dict[Format, tuple[int, int]] = {"square": (1080, 1080), "portrait": (1920, 1080), "wide": (1080, 1920)}
#: What an iris lets through spans at most this part of a frame, in its middle: a caption has half of the rest below.
_SPAN = 0.8
#: A mat is seen so far around a picture, in parts of its shorter side, fading.
_MAT = 0.1
#: A caption: its height and how far below the iris its middle is, in parts of the frame's shorter side; its light.
_LETTERS, _BELOW, _INK = 0.04, 0.05, 0.75


def poster(
    picture: Picture,
    window: NDArray[np.integer[Any]],
    size: tuple[int, int],
    transfer: Transfer,
    caption: str = "",
    *,
    mat: bool = False,
) -> Picture:
    """A picture large in a black frame, its light kept to itself, and to its mat, by an iris.

    Parameters
    ----------
    picture
        ``(row, column, channel)``, linear light.
    window
        Top, left, rows and columns of what was wanted in it.
    size
        Rows and columns of the frame.
    caption
        Stands below what the iris lets through, in the black.
    mat
        Whether a mat worth looking at surrounds what was wanted: the iris opens softly onto it.
    """
    top, left, rows, columns = (int(number) for number in window)
    around = mat_pixels((rows, columns)) if mat else 0
    values = np.clip(encode(picture, transfer), 0, None).astype(np.float32)
    if around:
        values = np.pad(values, ((around, around), (around, around), (0, 0)))
    kept = values[top : top + rows + 2 * around, left : left + columns + 2 * around]
    scale = _SPAN * min(size[0] / kept.shape[0], size[1] / kept.shape[1])
    high, wide = (max(1, round(scale * each)) for each in kept.shape[:2])
    above, before = (size[0] - high) // 2, (size[1] - wide) // 2
    shown = np.zeros((*size, picture.shape[2]), np.float32)
    shown[above : above + high, before : before + wide] = _enlarged(kept, (high, wide)) * _iris(
        (high, wide), scale * around
    )
    if caption:
        ink = lettering(caption, size, above + high + _BELOW * min(size))
        shown = np.maximum(shown, np.float32(_INK) * ink[..., None])
    return np.asarray(decode(shown, transfer), np.float32)


def mat_pixels(shape: tuple[int, int]) -> int:
    """So many pixels of a mat are seen on each side of a picture of so many rows and columns."""
    return max(1, round(_MAT * min(shape)))


def _enlarged(values: Picture, size: tuple[int, int]) -> Picture:
    """Display values, smoothly enlarged to so many rows and columns."""
    colours = [
        np.asarray(Image.fromarray(np.ascontiguousarray(values[..., c])).resize(size[::-1], Image.Resampling.BICUBIC))
        for c in range(values.shape[2])
    ]
    return np.maximum(np.stack(colours, axis=2), np.float32(0))


def _iris(size: tuple[int, int], soft: float) -> Picture:
    """``(row, column, 1)``: what passes an iris of so many pixels: all but for its rim, over which it falls to 0."""
    if not soft:
        return np.ones((*size, 1), np.float32)
    down, across = (np.clip(soft - _from_edge(count), 0, None) for count in size)
    part = np.clip(1 - np.hypot(down[:, None], across) / soft, 0, 1)
    return np.asarray(part * part * (3 - 2 * part), np.float32)[..., None]


def _from_edge(count: int) -> NDArray[np.float64]:
    """How far the middles of so many pixels in a row are from its nearer end."""
    along = np.arange(count) + 0.5
    return np.minimum(along, count - along)


def lettering(text: str, size: tuple[int, int], below: float) -> Picture:
    """``(row, column)`` from 0 to 1: a line of text, its middle in that row of a frame, cut where it is too long."""
    rows, columns = size
    sheet = Image.new("L", (columns, rows))
    letters = max(9, round(_LETTERS * min(size)))
    write(ImageDraw.Draw(sheet), (columns / 2, below), text, letters, 255, 0.9 * columns, "mm")
    return np.asarray(sheet, np.float32) / np.float32(255)
