"""Contact sheets: wanted, shown and the difference of every view, as one picture."""

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont, ImageOps

from lightcube.optics.arrays import Images, Levels
from lightcube.optics.transfer import Transfer, encode, to_uint8
from lightcube.pictures.fitting import Fit, source_box
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.targets import Targets

#: Shorter side that a picture is enlarged to, by whole pixels; gap and line height in pixels.
_SIDE, _GAP, _LINE = 128, 8, 16
#: Longer side of what is shown of a picture as it was read, pixels.
_READ = 144
_PAPER, _INK = (250, 250, 248), (40, 40, 40)
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
        for index, picture in enumerate(triple(shown[view], targets, int(view))):
            tile = Image.fromarray(picture).resize((columns * scale, rows * scale), Image.Resampling.NEAREST)
            sheet.paste(tile, (left, top + 2 * _LINE + index * (rows * scale + 2)))
    return np.asarray(sheet)


def wanted_sheet(pictures: Pictures, targets: Targets, ways: Fit | Sequence[Fit], order: Sequence[int]) -> Levels:
    """Draw what will be asked for: each picture as it was read, dimmed where it is cut off, above what is left of it.

    Parameters
    ----------
    ways
        How pictures were fitted, all of them or each.
    order
        Number of the picture that each target is of.
    """
    fits = [ways] * len(pictures) if isinstance(ways, str) else list(ways)
    chosen = np.unique(np.linspace(0, len(targets) - 1, min(len(targets), MOST)).round().astype(int))
    tiles = []
    for view in chosen:
        rows, columns = (int(count) for count in targets.rig.stops.window[view])
        box = source_box(pictures.images[order[view]].shape[:2], (rows, columns), fits[order[view]], pictures.focus)
        read = _dimmed(pictures.images[order[view]], box, targets.transfer)
        weight = targets.weight[view][:rows, :columns, None] > 0
        kept = np.where(weight, to_uint8(targets.pictures[view][:rows, :columns], targets.transfer), 128)
        label = f"{targets.names[view]}"[:18], f"{targets.angles_deg[view]:.2f}°, {columns} x {rows}"
        tiles.append((label, read, Image.fromarray(kept.astype(np.uint8))))
    return _tiled(
        tiles, "what will be asked for: above as it was read, dark where it is cut off; below as it is wanted"
    )


def _dimmed(image: Images, box: tuple[float, float, float, float], transfer: Transfer) -> Image.Image:
    """A picture as it was read, small, dimmed outside of a box."""
    shown = Image.fromarray(to_uint8(image, transfer))
    small = ImageOps.contain(shown, (_READ, _READ))
    inside = [round(edge * small.width / shown.width) for edge in box]
    inside[1::2] = [round(edge * small.height / shown.height) for edge in box[1::2]]
    dim = small.point(lambda level: level // 4)
    dim.paste(small.crop(tuple(inside)), (inside[0], inside[1]))  # type: ignore[arg-type]
    return dim


def _tiled(tiles: Sequence[tuple[tuple[str, str], Image.Image, Image.Image]], title: str) -> Levels:
    """Tiles of two lines of words and two pictures, as even as can be."""
    lines = -(-len(tiles) // math.ceil(math.sqrt(len(tiles) * 2)))
    per_line = -(-len(tiles) // lines)
    cell_width, cell_height = _READ + 2 * _GAP, 2 * _READ + 2 * _LINE + 3 * _GAP
    font = ImageFont.load_default(12)
    wide = max(per_line * cell_width, round(font.getlength(title)) + 2 * _GAP)
    sheet = Image.new("RGB", (wide, lines * cell_height + 2 * _GAP + _LINE), _PAPER)
    draw = ImageDraw.Draw(sheet)
    draw.text((_GAP, _GAP), title, _INK, font)
    for place, (label, read, kept) in enumerate(tiles):
        line, column = divmod(place, per_line)
        left, top = column * cell_width + _GAP, line * cell_height + 2 * _GAP + _LINE
        for number, words in enumerate(label):
            draw.text((left, top + number * _LINE), words, _INK, font)
        scale = _READ / max(kept.size)
        shown = kept.resize((round(kept.width * scale), round(kept.height * scale)), Image.Resampling.NEAREST)
        for number, picture in enumerate((read, shown)):
            below = top + 2 * _LINE + number * (_READ + _GAP)
            sheet.paste(picture, (left + (_READ - picture.width) // 2, below + (_READ - picture.height) // 2))
    return np.asarray(sheet)


def triple(shown: NDArray[np.float32], targets: Targets, view: int) -> list[NDArray[np.uint8]]:
    """Wanted, shown and difference of one view, 8-bit RGB; grey where there is nothing wanted."""
    wanted, weight = targets.pictures[view], targets.weight[view][..., None] > 0
    difference = 0.5 + encode(shown, targets.transfer) - encode(wanted, targets.transfer)
    eighth = np.clip(np.rint(difference * 255), 0, 255).astype(np.uint8)
    pictures = [to_uint8(wanted, targets.transfer), to_uint8(shown, targets.transfer), eighth]
    return [np.broadcast_to(np.where(weight, p, 128), (*p.shape[:2], 3)).astype(np.uint8) for p in pictures]


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
