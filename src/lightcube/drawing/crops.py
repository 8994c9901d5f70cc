"""The sheet of what will be asked for: pictures as they were read, what is cut off, and what is left of them."""

from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageOps

from lightcube.drawing.sheet import BETWEEN, FREE, MOST, PAPER, laid_out
from lightcube.optics.arrays import Images, Levels
from lightcube.optics.naming import told_apart
from lightcube.optics.transfer import Transfer, to_uint8
from lightcube.pictures.fitting import Fit, source_box
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.targets import Targets
from lightcube.wording import counted

#: Longer side of what is shown of a picture, pixels.
_SIDE = 240
_NOTE = "left as they were read, dark where they are cut off; right as they are wanted"


def wanted_sheet(pictures: Pictures, targets: Targets, ways: Fit | Sequence[Fit], order: Sequence[int]) -> Levels:
    """Draw what will be asked for: each picture as it was read, dimmed where it is cut off, beside what is left of it.

    Parameters
    ----------
    ways
        How pictures were fitted, all of them or each.
    order
        Number of the picture that each target is of.
    """
    fits = [ways] * len(pictures) if isinstance(ways, str) else list(ways)
    chosen = np.unique(np.linspace(0, len(targets) - 1, min(len(targets), MOST)).round().astype(int))
    tiles, said, told = [], [], told_apart(targets.rig)
    for view in chosen:
        rows, columns = (int(count) for count in targets.rig.stops.window[view])
        box = source_box(pictures.images[order[view]].shape[:2], (rows, columns), fits[order[view]], pictures.focus)
        read = _dimmed(pictures.images[order[view]], box, targets.transfer)
        weight = targets.weight[view][:rows, :columns, None] > 0
        kept = np.where(weight, to_uint8(targets.pictures[view][:rows, :columns], targets.transfer), FREE)
        size = max(1, round(_SIDE * columns / max(rows, columns))), max(1, round(_SIDE * rows / max(rows, columns)))
        tiles.append(_beside(read, Image.fromarray(kept.astype(np.uint8)).resize(size, Image.Resampling.NEAREST)))
        said.append((targets.names[view], f"{told[view]}  ·  {columns} x {rows}"))
    return np.asarray(laid_out(tiles, said, (f"{counted(len(targets), 'picture')} that will be asked for", _NOTE)))


def _dimmed(image: Images, box: tuple[float, float, float, float], transfer: Transfer) -> Image.Image:
    """A picture as it was read, small, dimmed outside of a box."""
    shown = Image.fromarray(to_uint8(image, transfer))
    small = ImageOps.contain(shown, (_SIDE, _SIDE))
    inside = [round(edge * small.width / shown.width) for edge in box]
    inside[1::2] = [round(edge * small.height / shown.height) for edge in box[1::2]]
    dim = small.point(lambda level: level // 4)
    dim.paste(small.crop(tuple(inside)), (inside[0], inside[1]))  # type: ignore[arg-type]
    return dim


def _beside(read: Image.Image, kept: Image.Image) -> Image.Image:
    """Two pictures, each in the middle of a square."""
    tile = Image.new("RGB", (2 * _SIDE + BETWEEN, _SIDE), PAPER)
    for number, picture in enumerate((read, kept)):
        left, top = (_SIDE - picture.width) // 2, (_SIDE - picture.height) // 2
        tile.paste(picture, (number * (_SIDE + BETWEEN) + left, top))
    return tile
