"""A sheet of a relief: what was wanted, what each lamp shows, and what it shows where it stands too high."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from lightcube.drawing import sheet
from lightcube.optics.arrays import Reals
from lightcube.optics.transfer import to_uint8
from lightcube.scoring.metrics import nearness
from lightcube.scoring.reliefs import BLURS, OFF_DEG, blurred
from lightcube.solids.relief import Relief, side_of
from lightcube.solids.relief_light import coloured, shown

#: Longer side that pictures are enlarged to by whole pixels; and that which larger ones are drawn at.
_SIDE, _LONGEST = 256, 400
#: A usual size of pictures where pages are shared, its ground, and the gap between pictures on it.
_SHARED, _DARK, _SHARED_GAP = (1200, 630), (18, 19, 22), 24
#: So many pictures stand in a square, fewer side by side.
_SQUARE = 4
#: How the lamp of the third picture stands wrong.
_WRONG = "3 deg higher"


def relief_sheet(relief: Relief, scores: Mapping[str, Any], title: str) -> NDArray[np.uint8]:
    """Draw a relief's pictures, three of each; `scores` as `lightcube.score_relief`. ``(row, column, 3)`` levels."""
    seen = blurred(relief, shown(relief), BLURS["near"]), blurred(relief, shown(relief, OFF_DEG[_WRONG]), BLURS["near"])
    groups = [coloured(relief, light) for light in (relief.wanted, *seen)]
    tiles = [_tile([group[number] for group in groups]) for number in range(len(groups[0]))]
    if relief.is_colour:
        said = [(relief.names[0].removesuffix(" red"), in_words(scores["near_psnr_mean"], scores["psnr_mean"]))]
    else:
        said = [
            (each["name"], f"lamp {side_of(each['azimuth_deg'])}  ·  {in_words(each['near_psnr'], each['psnr'])}")
            for each in scores["pictures"]
        ]
    lines = (title, "left what was wanted, middle what the lamp shows, right what a lamp shows that is 3° too high")
    return np.asarray(sheet.laid_out(tiles, said, lines))


def relief_preview(relief: Relief) -> NDArray[np.uint8]:
    """What a relief's lamps show, side by side in the dark, ``(630, 1200, 3)`` levels: for who shares its page."""
    pictures = as_seen(relief, shown(relief))
    rows, columns = pictures.shape[1:3]
    across = len(pictures) if len(pictures) < _SQUARE else _SQUARE // 2
    counts = across, -(-len(pictures) // across)
    room = (side // count - _SHARED_GAP for side, count in zip(_SHARED, counts, strict=True))
    scale = min(space / side for space, side in zip(room, (columns, rows), strict=True))
    size = round(columns * scale), round(rows * scale)
    place, step = Image.new("RGB", _SHARED, _DARK), [side + _SHARED_GAP for side in size]
    first = [(w - count * s + _SHARED_GAP) // 2 for w, count, s in zip(_SHARED, counts, step, strict=True)]
    for number, picture in enumerate(pictures):
        at = first[0] + number % across * step[0], first[1] + number // across * step[1]
        place.paste(Image.fromarray(to_uint8(picture)).resize(size, Image.Resampling.BICUBIC), at)
    return np.asarray(place)


def in_words(near: float, far: float) -> str:
    """How good a picture is, by its PSNR seen from near by and from afar."""
    return f"{nearness(near)} near by ({near:.1f} dB), {nearness(far)} from afar ({far:.1f})"


def _tile(pictures: list[NDArray[np.float32]]) -> Image.Image:
    """Pictures side by side."""
    rows, columns = pictures[0].shape[:2]
    zoom = (
        max(1, round(_SIDE / max(rows, columns))) if max(rows, columns) <= _LONGEST else _LONGEST / max(rows, columns)
    )
    size = round(columns * zoom), round(rows * zoom)
    way = Image.Resampling.NEAREST if zoom >= 1 else Image.Resampling.LANCZOS
    tile = Image.new("RGB", (len(pictures) * (size[0] + sheet.BETWEEN) - sheet.BETWEEN, size[1]), sheet.PAPER)
    for number, picture in enumerate(pictures):
        tile.paste(Image.fromarray(to_uint8(picture)).resize(size, way), (number * (size[0] + sheet.BETWEEN), 0))
    return tile


def as_seen(relief: Relief, light: Reals) -> NDArray[np.float32]:
    """Linear light ``(picture, row, column)`` as an eye near by sees it, ``(picture, row, column, 3)``."""
    return coloured(relief, blurred(relief, light, BLURS["near"]))
