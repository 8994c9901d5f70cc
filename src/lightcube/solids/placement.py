"""Which of three pictures is seen from above, and how it is turned: what can be built depends on it.

On three walls a pixel of one picture is cast by the hull where some pixel of each of the two others lies on its ray: a
product of boolean matrices for each picture, and no voxel is touched.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags
from lightcube.pictures.fitting import fill
from lightcube.solids.cutting import Cut

#: Placements are compared on pictures of so many pixels a side: whatever the block's proportions, it is the same.
_SIDE = 64
#: Pieces that are tried, the largest first.
_TRIED = 3


@dataclass(frozen=True)
class Placement:
    """Three pictures on three walls.

    Parameters
    ----------
    order
        The numbers of those at the front, the side and the top.
    is_mirrored, quarters
        Whether the top's is mirrored (its lamp stands below, or the floor is looked at from beneath), and by how many
        quarters it is turned then, counter-clockwise.
    share
        Which part of them no object casts.
    is_one_piece
        Whether one piece casts all that can be.
    """

    order: tuple[int, ...]
    is_mirrored: bool
    quarters: int
    share: float
    is_one_piece: bool

    def of(self, cuts: Sequence[Cut]) -> tuple[Cut, ...]:
        """Shapes as they are placed, front, side and top."""
        front, side, top = (cuts[number] for number in self.order)
        return front, side, (top.mirrored() if self.is_mirrored else top).turned(self.quarters)


def placements(cuts: Sequence[Cut]) -> list[Placement]:
    """All 24 placements of three shapes on three walls, the given one first, all others from the best to the worst.

    One of three is on top, mirrored or not, in four quarter turns. With that all ways are tried in which upright ones
    are mirrored or change places: to mirror the front, or the side, is to mirror the top, seen in a mirror; and who
    walks around a corner sees front and side change places, one of them mirrored, and the top turned by a quarter. The
    best are in one piece, and of those the ones of which least is lost.
    """
    if len(cuts) != 3:
        raise InputError(f"three walls take three pictures, not {len(cuts)}: give three")
    given = [_square(one) for one in cuts]
    found = []
    for order in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
        front, side, top = (given[number] for number in order)
        for is_mirrored, quarters in itertools.product((False, True), range(4)):
            turned = np.rot90(top[:, ::-1] if is_mirrored else top, quarters)
            found.append(_placement(order, (front, side, turned), is_mirrored, quarters))
    return [found[0], *sorted(found[1:], key=_rank)]


def _rank(one: Placement) -> tuple[bool, float, bool, int]:
    """The better the less; of those that are as good the one that is turned least."""
    return not one.is_one_piece, one.share, one.is_mirrored, one.quarters % 4 and 1


def best(found: Sequence[Placement]) -> Placement:
    """The best of what `placements` found: the given one where no other is better."""
    return min(found, key=_rank)


def reachable(front: Flags, side: Flags, top: Flags) -> tuple[Flags, Flags, Flags]:
    """Pixels of pictures on three walls that the hull casts, and so any object at all.

    Pictures are ``(row, column)`` as they are seen, of as many voxels as the block has there.
    """
    across = [np.asarray(picture[::-1].T, np.float32) for picture in (front, side, top)]  # (x, z), (y, z), (x, y)
    f, s, t = across
    shown = ((t @ s) * f > 0, (t.T @ f) * s > 0, (f @ s.T) * t > 0)
    one, two, three = (np.asarray(each.T[::-1]) for each in shown)
    return one, two, three


def _placement(
    order: tuple[int, ...], placed: tuple[Flags, Flags, Flags], is_mirrored: bool, quarters: int
) -> Placement:
    """How good a placement of square pictures is."""
    shown = reachable(*placed)
    kept, given = (sum(int(np.count_nonzero(each)) for each in pictures) for pictures in (shown, placed))
    return Placement(order, is_mirrored, quarters, 1 - kept / given, _is_one_piece(*shown))


def _is_one_piece(front: Flags, side: Flags, top: Flags) -> bool:
    """Whether one piece of the hull casts all of pictures that the hull casts."""
    from scipy import ndimage  # here: whoever places nothing does without

    f, s, t = front[::-1], side[::-1], top[::-1]  # (z, x), (z, y), (y, x)
    hull = f[:, None, :] & s[:, :, None] & t[None]
    labels, count = ndimage.label(hull)
    sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
    wanted = [int(np.count_nonzero(each)) for each in (f, s, t)]
    for number in np.argsort(-sizes, kind="stable")[:_TRIED]:
        if sizes[number] < max(wanted):
            break
        piece = labels == number + 1
        if [int(np.count_nonzero(piece.any(axis=axis))) for axis in (1, 2, 0)] == wanted:
            return True
    return False


def _square(one: Cut) -> Flags:
    """A shape trimmed and stretched to a square of `_SIDE` pixels."""
    area = np.zeros((_SIDE, _SIDE, 1), np.float32)
    fill(area, np.zeros((_SIDE, _SIDE), np.float32), one.trimmed().coverage[..., None], "stretch", (0.5, 0.5))
    return np.asarray(area[..., 0] > 0.5)
