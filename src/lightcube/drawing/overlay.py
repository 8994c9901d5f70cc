"""Silhouettes before and after they were made to agree, one over the other."""

import math

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from lightcube.drawing.sheet import PAPER, laid_out
from lightcube.optics.arrays import Flags
from lightcube.solids.repair import Repaired
from lightcube.solids.silhouettes import FINE
from lightcube.wording import counted

#: Display levels of what was given and is cast, is not cast, and is cast beside it.
_BOTH, _LOST, _ADDED = (52, 55, 60), (236, 120, 70), (104, 160, 214)
#: Longer side of a tile, pixels, at least.
_SIDE = 420


def overlays(found: Repaired, title: str = "") -> NDArray[np.uint8]:
    """Draw each silhouette as given over what is cast in its place, with how far the two overlap.

    Returns
    -------
    ``(row, column, 3)`` 8-bit sRGB.
    """
    drawn = tiles(found)
    high, wide = (max(each.size[axis] for each in drawn) for axis in (1, 0))
    said = [(name, f"overlap {overlap:.0%}") for name, overlap in zip(found.given.names, found.overlaps, strict=True)]
    how = "dark: given and cast; orange: given, not cast; blue: cast beside it"
    head = title or f"{counted(len(drawn), 'silhouette')}, outlines moved by {found.moved_px:.1f} pixels"
    return np.asarray(laid_out([_in_middle(each, wide, high) for each in drawn], said, (head, how)))


def tiles(found: Repaired) -> list[Image.Image]:
    """Each silhouette as given over what is cast in its place."""
    windows = FINE * found.given.rig.stops.window
    pairs = zip(found.given.inside, found.shape.silhouettes.inside, windows, strict=True)
    return [tile(given[:rows, :columns], cast[:rows, :columns]) for given, cast, (rows, columns) in pairs]


def tile(given: Flags, cast: Flags) -> Image.Image:
    """One silhouette as given over what is cast in its place, each of its small pixels as large as the others."""
    levels = np.full((*given.shape, 3), PAPER, np.uint8)
    for where, colour in ((given & cast, _BOTH), (given & ~cast, _LOST), (cast & ~given, _ADDED)):
        levels[where] = colour
    times = math.ceil(_SIDE / max(given.shape))
    return Image.fromarray(levels.repeat(times, axis=0).repeat(times, axis=1))


def _in_middle(picture: Image.Image, wide: int, high: int) -> Image.Image:
    """A picture on paper of some size."""
    paper = Image.new("RGB", (wide, high), PAPER)
    paper.paste(picture, ((wide - picture.width) // 2, (high - picture.height) // 2))
    return paper
