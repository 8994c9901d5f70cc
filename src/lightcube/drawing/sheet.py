"""Contact sheets: wanted, shown and the difference of every view, as one picture."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from lightcube.optics.transfer import encode, to_uint8
from lightcube.pictures.targets import Targets

#: Shorter side that a picture is enlarged to, by whole pixels; gap and line height in pixels.
_SIDE, _GAP, _LINE = 128, 8, 16
_PAPER, _INK = (250, 250, 248), (40, 40, 40)
#: Level of pixels that nobody cares about.
_FREE = 128
#: Views shown at most: of more, so many evenly chosen ones.
MOST = 32


def contact_sheet(shown: NDArray[np.float32], targets: Targets, psnr: list[float]) -> NDArray[np.uint8]:
    """Draw wanted, shown and difference of each view, with its name and PSNR (dB).

    Parameters
    ----------
    shown
        ``(view, row, column, channel)`` in linear light.
    targets
        What was wanted.
    psnr
        One figure per view.

    Returns
    -------
    ``(row, column, 3)`` 8-bit sRGB. The difference of display values is drawn around mid grey. Of more than 32
    views, 32 are shown.
    """
    count = len(targets)
    chosen = np.unique(np.linspace(0, count - 1, min(count, MOST)).round().astype(int))
    rows, columns = targets.rig.picture_shape
    scale = max(1, round(_SIDE / min(rows, columns)))
    cell_height, cell_width = rows * scale * 3 + 2 * _LINE + 2 * _GAP, max(columns * scale, 96) + _GAP
    per_line = max(1, min(len(chosen), 1800 // cell_width))
    lines = -(-len(chosen) // per_line)
    per_line = -(-len(chosen) // lines)
    sheet = Image.new("RGB", (per_line * cell_width + _GAP, lines * cell_height + _GAP + _LINE), _PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(11)
    draw.text((_GAP, 3), "from top to bottom: wanted, shown, difference (around grey; flat grey is free)", _INK, font)
    for place, view in enumerate(chosen):
        left = _GAP + place % per_line * cell_width
        top = _GAP + _LINE + place // per_line * cell_height
        label = f"{targets.names[view]}"[:16]
        draw.text((left, top), label, _INK, font)
        draw.text((left, top + _LINE - 3), f"{targets.angles_deg[view]:.2f}°  {psnr[view]:.1f} dB", _INK, font)
        for index, picture in enumerate(pair(shown[view], targets, int(view))):
            tile = Image.fromarray(picture).resize((columns * scale, rows * scale), Image.Resampling.NEAREST)
            sheet.paste(tile, (left, top + 2 * _LINE + index * (rows * scale + 2)))
    return np.asarray(sheet)


def pair(shown: NDArray[np.float32], targets: Targets, view: int) -> list[NDArray[np.uint8]]:
    """Wanted and shown of one view, 8-bit RGB; grey where there is nothing wanted."""
    weighed = targets.weight[view][..., None] > 0
    levels = [to_uint8(light, targets.transfer) for light in (targets.pictures[view], shown)]
    return [_as_colours(np.where(weighed, each, _FREE)) for each in levels]


def difference(shown: NDArray[np.float32], targets: Targets, view: int, gain: float = 1) -> NDArray[np.uint8]:
    """How far display values are off what was wanted, so many times as large, around mid grey: 8-bit RGB."""
    off = gain * (encode(shown, targets.transfer) - encode(targets.pictures[view], targets.transfer))
    levels = np.clip(np.rint((0.5 + off) * 255), 0, 255)
    return _as_colours(np.where(targets.weight[view][..., None] > 0, levels, _FREE))


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
