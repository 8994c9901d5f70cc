"""From shapes cut out of pictures to silhouettes on the pictures of a rig."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, Images, locked
from lightcube.optics.checks import checked
from lightcube.optics.rig import Rig
from lightcube.pictures.fitting import Fit, fill
from lightcube.solids.cutting import Cut
from lightcube.solids.silhouettes import FINE, Silhouettes
from lightcube.wording import counted


@checked
def silhouettes(cuts: Sequence[Cut], rig: Rig, ways: Fit | Sequence[Fit] = "pad") -> Silhouettes:
    """Put shapes onto the pictures of a rig, one each.

    Parameters
    ----------
    ways
        As `lightcube.fit` takes them; what is left free around a picture is ground.
    """
    return Silhouettes(_standing([one.coverage for one in cuts], rig, ways), rig, tuple(one.name for one in cuts))


def held(cuts: Sequence[Cut], rig: Rig, ways: Fit | Sequence[Fit] = "pad") -> Flags | None:
    """``(picture, row, column)``: what is kept of shapes, put onto a rig as they are; None where nothing is."""
    if all(one.kept is None for one in cuts):
        return None
    fine = _standing([np.zeros_like(one.coverage) if one.kept is None else one.kept for one in cuts], rig, ways)
    rows, columns = rig.picture_shape
    kept = np.asarray(fine.reshape(len(rig), rows, FINE, columns, FINE).any(axis=(2, 4)))
    kept[[one.kept is not None and bool(np.all(one.kept > 0.5)) for one in cuts]] = True  # all around it too
    return kept


def _standing(pictures: Sequence[Images], rig: Rig, ways: Fit | Sequence[Fit]) -> Flags:
    """``(picture, FINE * row, FINE * column)``: where pictures are above 0.5 on a rig's screens, ground around them."""
    fits: list[Fit] = [ways] * len(pictures) if isinstance(ways, str) else list(ways)
    if not len(pictures) == len(fits) == len(rig):
        raise InputError(
            f"{counted(len(pictures), 'shape')} for {counted(len(rig), 'picture')} of a rig: give one each"
        )
    rows, columns = rig.picture_shape
    inside = np.zeros((len(rig), FINE * rows, FINE * columns), np.bool_)
    for shape, one, (high, wide), way in zip(inside, pictures, FINE * rig.stops.window, fits, strict=True):
        area = np.zeros((high, wide, 1), np.float32)
        fill(area, np.zeros((high, wide), np.float32), one[..., None], way, (0.5, 0.5))
        shape[:high, :wide] = area[..., 0] > 0.5
    return locked(inside)
