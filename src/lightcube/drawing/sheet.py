"""Contact sheets: every picture as it is shown, beside what was wanted; and pictures beside each other in movies."""

import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from lightcube.drawing.lettering import spelled, write
from lightcube.optics.naming import told_apart
from lightcube.optics.transfer import encode, to_uint8
from lightcube.pictures.targets import Targets
from lightcube.wording import counted

#: Longer side that pictures are enlarged to by whole pixels, and the longest one that is left as it is; pixels.
_SIDE, _LONGEST = 240, 400
#: What stays free around pairs, and between the two of a pair; the least width of a pair, for its name.
_GAP, BETWEEN, _NARROWEST = 44, 6, 230
#: Letters of title, note, names and figures, pixels; each line of them is so many times as high.
_TITLE, _NOTE, _NAME, _FIGURE, _LINE = 54, 26, 28, 22, 1.35
#: Width of a sheet over its height, about: that of paper.
_PAPER_SHAPE = math.sqrt(2)
PAPER, _INK, _QUIET = (252, 251, 248), (35, 38, 41), (104, 108, 112)
#: Level of pixels that nobody cares about.
FREE = 128
#: Views shown at most: of more, so many evenly chosen ones.
MOST = 32


def contact_sheet(
    shown: NDArray[np.float32], targets: Targets, psnr: list[float], title: str = ""
) -> NDArray[np.uint8]:
    """Draw each picture as it is shown beside what was wanted, with its name, what tells it apart, and PSNR (dB).

    Parameters
    ----------
    shown
        ``(view, row, column, channel)`` in linear light.
    targets
        What was wanted.
    psnr
        One figure per view.
    title
        Stands above; empty = how many pictures there are.

    Returns
    -------
    ``(row, column, 3)`` 8-bit sRGB. Of more than 32 views, 32 are shown.
    """
    count = len(targets)
    chosen = np.unique(np.linspace(0, count - 1, min(count, MOST)).round().astype(int))
    many = counted(count, "picture") if len(chosen) == count else f"{len(chosen)} of {counted(count, 'picture')}"
    note = "left what was wanted, right what the wall shows"
    lines = (title, f"{many}: {note}") if title else (many, note)
    tiles = [_pair_tile(pair(shown[view], targets, int(view)), targets, int(view)) for view in chosen]
    told = told_apart(targets.rig)
    said = [(targets.names[view], f"{told[view]}  ·  {psnr[view]:.1f} dB") for view in chosen]
    return np.asarray(laid_out(tiles, said, lines))


def _pair_tile(levels: list[NDArray[np.uint8]], targets: Targets, view: int) -> Image.Image:
    """Wanted and shown side by side, as wide and high as those of all other views; smaller ones stand in the middle."""
    largest = targets.rig.picture_shape
    rows, columns = (int(side) for side in targets.rig.stops.window[view])
    wide, high = (round(side * _zoom(*largest)) for side in largest[::-1])
    zoom = min(_zoom(rows, columns), wide / columns, high / rows)
    zoom = math.floor(zoom) if zoom >= 1 else zoom
    size = max(1, round(columns * zoom)), max(1, round(rows * zoom))
    way = Image.Resampling.NEAREST if zoom >= 1 else Image.Resampling.LANCZOS
    tile = Image.new("RGB", (max(2 * wide + BETWEEN, _NARROWEST), high), PAPER)
    for number, picture in enumerate(levels):
        image = Image.fromarray(np.ascontiguousarray(picture[:rows, :columns])).resize(size, way)
        tile.paste(image, (number * (wide + BETWEEN) + (wide - size[0]) // 2, (high - size[1]) // 2))
    return tile


def _zoom(rows: int, columns: int) -> float:
    """How many times as large a picture is drawn: a whole number, unless it is too large."""
    longest = max(rows, columns)
    return max(1, round(_SIDE / longest)) if longest <= _LONGEST else _LONGEST / longest


def laid_out(tiles: list[Image.Image], said: list[tuple[str, str]], lines: tuple[str, str]) -> Image.Image:
    """Tiles of one size with a name and figures below each, under a title and a note."""
    count, (wide, high) = len(tiles), tiles[0].size
    name, figure, title, note = (math.ceil(_LINE * size) for size in (_NAME, _FIGURE, _TITLE, _NOTE))
    top, step = title + note + 2 * _GAP, (wide + _GAP, high + name + figure + _GAP)

    def unlike_paper(across: int) -> float:
        """How far off the shape of paper a sheet is, and how much of its last line is empty."""
        lines = -(-count // across)
        shape = (across * step[0] + _GAP) / (lines * step[1] + top)
        return abs(math.log(shape / _PAPER_SHAPE)) + 4 * (across * lines - count) / count

    across = min(range(1, count + 1), key=unlike_paper)
    width, height = across * step[0] + _GAP, -(-count // across) * step[1] + top
    note_line, note_font = spelled(lines[1], _NOTE)
    width = max(width, math.ceil(note_font.getlength(note_line)) + 2 * _GAP)
    sheet = Image.new("RGB", (width, height), PAPER)
    draw = ImageDraw.Draw(sheet)

    write(draw, (_GAP, _GAP), lines[0], _TITLE, _INK, width - 2 * _GAP)
    write(draw, (_GAP, _GAP + title), lines[1], _NOTE, _QUIET, width - 2 * _GAP)
    for place, (tile, (called, figures)) in enumerate(zip(tiles, said, strict=True)):
        left, above = _GAP + place % across * step[0], top + place // across * step[1]
        sheet.paste(tile, (left, above))
        write(draw, (left, above + high + 6), called, _NAME, _INK, wide)
        write(draw, (left, above + high + name + 2), figures, _FIGURE, _QUIET, wide)
    return sheet


def pair(shown: NDArray[np.float32], targets: Targets, view: int) -> list[NDArray[np.uint8]]:
    """Wanted and shown of one view, 8-bit RGB; grey where there is nothing wanted."""
    weighed = targets.weight[view][..., None] > 0
    levels = [to_uint8(light, targets.transfer) for light in (targets.pictures[view], shown)]
    return [_as_colours(np.where(weighed, each, FREE)) for each in levels]


def difference(shown: NDArray[np.float32], targets: Targets, view: int, gain: float = 1) -> NDArray[np.uint8]:
    """How far display values are off what was wanted, so many times as large, around mid grey: 8-bit RGB."""
    off = gain * (encode(shown, targets.transfer) - encode(targets.pictures[view], targets.transfer))
    levels = np.clip(np.rint((0.5 + off) * 255), 0, 255)
    return _as_colours(np.where(targets.weight[view][..., None] > 0, levels, FREE))


def _as_colours(levels: NDArray[Any]) -> NDArray[np.uint8]:
    return np.broadcast_to(levels, (*levels.shape[:2], 3)).astype(np.uint8)


def beside_targets(
    shown: Iterable[NDArray[np.float32]], targets: Targets, angles_deg: NDArray[np.float64], zoom: int = 1
) -> Iterator[NDArray[np.float32]]:
    """Yield each picture with the wanted one of the nearest stop to its right, between them two black columns.

    Parameters
    ----------
    shown
        ``(row, column, channel)`` in linear light. Where it is higher than what was wanted, that stands in the middle.
    angles_deg
        Of what is shown, degrees.
    zoom
        Parts a side that the pixels of what is shown are in: those of what was wanted are as large.

    Notes
    -----
    Pixels that nobody cares about are grey.
    """
    for picture, angle_deg in zip(shown, angles_deg, strict=True):
        apart = np.abs(np.remainder(targets.angles_deg - angle_deg + 180, 360) - 180)
        nearest = int(np.argmin(apart))
        wanted = np.where(targets.weight[nearest][..., None] > 0, targets.pictures[nearest], np.float32(0.2))
        wanted = wanted.repeat(zoom, axis=0).repeat(zoom, axis=1)
        spare = len(picture) - len(wanted)
        yield np.concatenate([picture, np.pad(wanted, ((spare // 2, spare - spare // 2), (2, 0), (0, 0)))], axis=1)


def beside_each_other(pictures: list[NDArray[np.float32]], windows: NDArray[np.integer[Any]]) -> NDArray[np.float32]:
    """One picture of several, each cut to its window ``(rows, columns)`` from its upper left, with black gaps."""
    cut = [picture[:rows, :columns] for picture, (rows, columns) in zip(pictures, windows, strict=True)]
    high, gap = max(len(picture) for picture in cut), 2
    padded = [
        np.pad(picture, ((high - len(picture), 0), (0, gap if number + 1 < len(cut) else 0), (0, 0)))
        for number, picture in enumerate(cut)
    ]
    return np.concatenate(padded, axis=1)
