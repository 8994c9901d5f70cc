"""What can be built: pixels that no object casts while it keeps to the other silhouettes, and whether one piece does.

A connected object with just these silhouettes exists where one face-connected piece of the hull casts all of them: an
object lies in one piece, and what that casts lies between what the object casts and the silhouettes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Counts, Flags, Images, Integers, Reals, keep, locked
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.grid import Grid
from lightcube.solids import projections
from lightcube.solids.field import hull_field
from lightcube.solids.silhouettes import Silhouettes

#: How finely a gap between pieces is looked for, in voxels, and how far.
_FINE_GAP, _MOST_GAP = 1 / 16, 8
#: A shape narrower than twice this, in voxels, is thin; so much wider it may come back, for its corners.
_THIN, _SLACK = 1.0, 0.75


@dataclass(frozen=True, eq=False)
class Reach:
    """What can be built of silhouettes, in pixels of their pictures.

    Parameters
    ----------
    given
        ``(picture, row, column)``: pixels whose middles are inside.
    depth
        Where a given pixel is not cast by the hull, nor by any object: how far, in voxels, the other silhouettes lack
        where they lack least on its ray; 0 elsewhere, infinity where the ray misses the block.
    culprit
        The picture that lacks most there; -1 where none does, -2 where the ray misses the block.
    places
        ``(picture, row, column, 3)``: where on the ray that is, in voxels ``(z, y, x)``.
    pieces
        How many pieces the hull has that hang together by voxels' faces.
    is_one_piece
        Whether one of them casts all that the hull casts.
    gap
        By how many voxels all silhouettes must grow until one piece does, to 1/16; 0 where one does, None where 8 do
        not suffice, or there is no piece at all.
    parting
        The picture that lacks most where pieces are nearest to each other, and so keeps them apart; -1 where none does.
    """

    given: Flags
    depth: Images
    culprit: Counts
    places: Images
    pieces: int
    is_one_piece: bool
    gap: float | None
    parting: int = -1

    def __post_init__(self) -> None:
        check_fields(self)
        if self.gap is not None and not 0 <= self.gap <= _MOST_GAP:
            raise InputError(f"a gap between pieces is a number of voxels from 0 to 8, not {self.gap:g}")
        if not -1 <= self.parting < len(self.given):
            raise InputError(f"pieces are parted by a picture below {len(self.given)}, or -1, not {self.parting}")
        keep(self, given=np.bool_, depth=np.float32, culprit=np.intp, places=np.float32)

    def __repr__(self) -> str:
        pieces = "in one piece" if self.is_one_piece else f"in {self.pieces} pieces"
        return f"<{self.share:.2%} of {len(self.given)} silhouettes out of reach, {pieces}>"

    @property
    def unreachable(self) -> Flags:
        """``(picture, row, column)``: given pixels that no object casts."""
        return np.asarray(self.depth > 0)

    @property
    def shares(self) -> Reals:
        """``(picture,)``: which part of each silhouette no object casts."""
        lost, given = (np.count_nonzero(each, axis=(1, 2)) for each in (self.unreachable, self.given))
        return np.asarray(lost / np.maximum(given, 1), np.float64)

    @property
    def share(self) -> float:
        """Which part of all silhouettes no object casts."""
        return int(np.count_nonzero(self.unreachable)) / max(int(np.count_nonzero(self.given)), 1)

    @property
    def is_valid(self) -> bool:
        """Whether some object casts all that is given."""
        return not np.any(self.unreachable)

    def blamed(self, picture: int) -> list[tuple[int, float]]:
        """The pictures that are in the way of one, and of which part of it, the worst first."""
        own = self.culprit[picture][self.unreachable[picture]]
        numbers, counts = np.unique(own, return_counts=True)
        parts = counts / max(int(np.count_nonzero(self.given[picture])), 1)
        return [(int(numbers[at]), float(parts[at])) for at in np.argsort(-counts, kind="stable")]


@checked
def reach(silhouettes: Silhouettes, grid: Grid) -> Reach:
    """Say what can be built of silhouettes in a block, for any number of views, before anything is built.

    Examples
    --------
    >>> import numpy as np
    >>> import lightcube as lc
    >>> grid = lc.Grid((4, 4, 4))
    >>> inside = np.ones((3, 16, 16), bool)
    >>> inside[1, :8] = False  # the side has nothing in its upper half, which the front has
    >>> lc.reach(lc.Silhouettes(inside, lc.walls(grid).rig(), ("front", "side", "top")), grid).shares
    array([0.5, 0. , 0. ])
    """
    from lightcube.kernels import reach as kernels  # here: the compiler comes with it
    from lightcube.kernels import tasks

    rig, distances = silhouettes.rig, silhouettes.distances
    projections.check_rig(rig, grid)
    onto, through = projections.of_voxels(projections.matrices(rig), grid), projections.rays(rig, grid)
    widths = projections.voxels_a_pixel(rig, grid)
    lines = (len(rig), *rig.picture_shape)
    depth, culprit = np.empty(lines, np.float32), np.empty(lines, np.intp)
    places = np.zeros((*lines, 3), np.float32)
    given = silhouettes.pixels()
    work = 5 * int(np.count_nonzero(given)) * max(grid.shape) * len(rig)
    arguments = (distances, onto, widths, through, grid.shape, depth, culprit, places)
    tasks.run(kernels.depths, lines[0] * lines[1], work, *arguments)
    least = np.float32(np.finfo(np.float32).tiny)
    depth = np.where(culprit != kernels.NOTHING, np.maximum(depth, least), np.float32(0))
    field = hull_field(silhouettes, grid, is_skipping=False)
    numbers, count, common = _in_pieces(field < 0, silhouettes, through)
    gap = 0.0 if common else _gap(field, numbers, silhouettes, through) if count else None
    parting = _parting(field, gap, silhouettes, grid) if gap else -1
    return Reach(given, depth, culprit, places, count, common, gap, parting)


def count_pieces(inside: Flags) -> int:
    """How many pieces a body has that hang together by voxels' faces."""
    from scipy import ndimage  # here: whoever asks for nothing does without

    return int(ndimage.label(inside)[1])


def _in_pieces(inside: Flags, silhouettes: Silhouettes, through: Reals) -> tuple[Integers, int, bool]:
    """Pieces by the rays that meet them, a bit each, how many there are, and whether one casts all that all cast."""
    from scipy import ndimage

    from lightcube.kernels import reach as kernels
    from lightcube.kernels import tasks

    labels, count = ndimage.label(inside)
    order = np.argsort(-np.bincount(labels.ravel(), minlength=count + 1)[1:], kind="stable")
    ranks = np.zeros(count + 1, np.int32)
    ranks[1 + order] = np.arange(1, count + 1)
    labels = ranks[labels]
    met = np.empty((len(silhouettes), *silhouettes.rig.picture_shape), np.uint64)
    work = 2 * met.size * max(inside.shape)
    tasks.run(kernels.pieces_met, met.shape[0] * met.shape[1], work, labels, silhouettes.distances, through, met)
    cast = met[met > 0]
    told_apart = np.uint64(2**kernels.MOST_PIECES - 1)
    common = bool(len(cast)) and bool(np.bitwise_and.reduce(cast) & told_apart)
    return met.astype(np.int64), int(count), common


def _gap(field: Images, met: Integers, silhouettes: Silhouettes, through: Reals) -> float | None:
    """How far all silhouettes must grow until one piece casts all that the hull casts now, to `_FINE_GAP`."""
    from scipy import ndimage

    from lightcube.kernels import reach as kernels
    from lightcube.kernels import tasks

    def suffices(grown: float) -> bool:
        labels, count = ndimage.label(field < grown)
        if not count:
            return False
        sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
        largest = (labels == 1 + int(np.argmax(sizes))).astype(np.int32)
        cast = np.empty(met.shape, np.uint64)
        work = 2 * met.size * max(field.shape)
        tasks.run(kernels.pieces_met, met.shape[0] * met.shape[1], work, largest, silhouettes.distances, through, cast)
        return bool(np.all((met == 0) | (cast > 0)))

    low, high = 0, math.ceil(float(np.max(field)) / _FINE_GAP) - 1
    if not suffices(high * _FINE_GAP):
        return None
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if suffices(middle * _FINE_GAP) else (middle, high)
    return high * _FINE_GAP


def _parting(field: Images, gap: float, silhouettes: Silhouettes, grid: Grid) -> int:
    """The picture that lacks most where pieces meet when all grow by `gap`, the larger pieces counting for more."""
    from lightcube.kernels import reach as kernels

    places, worth = _meetings(field, gap)
    onto = projections.of_voxels(projections.matrices(silhouettes.rig), grid)
    widths = projections.voxels_a_pixel(silhouettes.rig, grid)
    votes = np.zeros(len(silhouettes))
    for place, weight in zip(places.astype(np.float64), worth, strict=True):
        _, who = kernels.lacking(silhouettes.distances, onto, widths, -1, place, np.inf)
        votes[who] += weight
    return int(np.argmax(votes)) if len(places) else -1


def _meetings(field: Images, gap: float) -> tuple[Integers, Integers]:
    """Voxels ``(z, y, x)`` at which pieces meet first that `gap` just joins, and the voxels of the smaller piece."""
    from scipy import ndimage

    labels, count = ndimage.label(field < gap - _FINE_GAP)
    sizes = np.bincount(labels.ravel(), minlength=count + 1)
    faces, nothing = ndimage.generate_binary_structure(3, 1), count + 1
    between = (labels == 0) & (field < gap)
    while True:
        most = ndimage.maximum_filter(labels, footprint=faces)
        least = ndimage.minimum_filter(np.where(labels == 0, nothing, labels), footprint=faces)
        met = between & (most > 0) & (least < most)
        if np.any(met):
            return np.argwhere(met).astype(np.int64), np.minimum(sizes[least[met]], sizes[most[met]]).astype(np.int64)
        reached = between & (labels == 0) & (most > 0)
        if not np.any(reached):  # no two pieces are joined: one grew into what was lacking
            return np.empty((0, 3), np.int64), np.empty(0, np.int64)
        labels = np.where(reached, most, labels)


def thin_part(silhouettes: Silhouettes, grid: Grid) -> Reals:
    """``(picture,)``: which part of each silhouette lies in strokes that are thinner than two voxels."""
    from scipy import ndimage

    widths = projections.voxels_a_pixel(silhouettes.rig, grid)
    parts = []
    for distances, width in zip(silhouettes.distances, widths, strict=True):
        inside = distances < 0
        core = width * distances <= -_THIN
        if not np.any(core):
            parts.append(1.0)
            continue
        back = width * ndimage.distance_transform_edt(~core) <= _THIN + _SLACK
        parts.append(int(np.count_nonzero(inside & ~back)) / max(int(np.count_nonzero(inside)), 1))
    return locked(np.array(parts))
