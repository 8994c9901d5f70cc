"""The sheet of what will be asked for: pictures as they were read, what is cut off, and what is left of them."""

import math
from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageDraw, ImageFont, ImageOps

from lightcube.drawing.sheet import MOST
from lightcube.optics.arrays import Images, Levels
from lightcube.optics.transfer import Transfer, to_uint8
from lightcube.pictures.fitting import Fit, source_box
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.targets import Targets

#: Longer side of what is shown of a picture, gap and line height, pixels.
_READ, _GAP, _LINE = 144, 8, 16
_PAPER, _INK = (250, 250, 248), (40, 40, 40)


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
