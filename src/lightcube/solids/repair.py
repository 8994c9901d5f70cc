"""From silhouettes that contradict each other to some that one object casts: bent, trimmed or added to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, Reals, Volume, locked
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.grid import Grid
from lightcube.solids import projections
from lightcube.solids.certificate import cast_mesh
from lightcube.solids.field import hull_field
from lightcube.solids.reach import reach
from lightcube.solids.shape import Shape, hull
from lightcube.solids.silhouettes import FINE, Silhouettes
from lightcube.solids.warp import Warped, check_wall, warp
from lightcube.wording import counted

#: How silhouettes are made to agree: bent, what no object casts left out, or what is in the way added.
Way = Literal["auto", "none", "trim", "grow", "warp"]
#: So much of the silhouettes, at most, is left out rather than that they are bent.
_LITTLE = 0.005
#: More pictures than this that contradict each other lose their shape when they are bent (measured: 6 do).
MOST_BENT = 5
#: Times that bridges are built between pieces, and the pieces that are worth one, in voxels.
_ROUNDS, _PIECE = 3, 8
#: How steeply a way through what is outside costs more the further outside it is, a voxel.
_STEEP = 1.2
#: Pictures may gain so much until all can be cast, a layer of pixels each time.
_MOST_GROWN = 200


@dataclass(frozen=True, eq=False)
class Repaired:
    """Silhouettes made to agree, and the object that casts them.

    Parameters
    ----------
    given
        What was asked for.
    shape
        What casts `shape.silhouettes`, which stand for them.
    way
        How they were made to agree.
    warped
        How they were bent; None where they were not.
    """

    given: Silhouettes
    shape: Shape
    way: Way
    warped: Warped | None

    def __post_init__(self) -> None:
        check_fields(self)

    def __repr__(self) -> str:
        return f"<{counted(len(self.given), 'silhouette')} by {self.way}, overlap {self.overlaps.min():.1%} and more>"

    @property
    def overlaps(self) -> Reals:
        """``(picture,)``: shared part of what is cast and what was given, of all that is one of the two."""
        cast, given = self.shape.silhouettes.inside, self.given.inside
        shared, either = (np.count_nonzero(each, axis=(1, 2)) for each in (cast & given, cast | given))
        return np.asarray(shared / either)

    @property
    def moved_px(self) -> float:
        """How far outlines are from where they were given, on average, in pixels."""
        pairs = zip(self.given.inside, self.shape.silhouettes.inside, strict=True)
        return float(np.mean([_apart(one, other) for one, other in pairs])) / FINE

    @property
    def kept_forms(self) -> tuple[bool, ...]:
        """Of each picture, whether it has as many parts and holes as was given."""
        pairs = zip(self.given.inside, self.shape.silhouettes.inside, strict=True)
        return tuple(form(one) == form(other) for one, other in pairs)


def form(inside: Flags) -> tuple[int, int]:
    """How many parts a silhouette has, touching at corners too, and how many holes."""
    from scipy import ndimage  # here: whoever repairs nothing does without

    _, parts = ndimage.label(inside, np.ones((3, 3)))
    _, outside = ndimage.label(np.pad(~inside, 1, constant_values=True))
    return int(parts), int(outside) - 1


def _apart(one: Flags, other: Flags) -> float:
    """Mean distance from the outline of one silhouette to the other's, and back."""
    from scipy import ndimage

    outlines = [each & ~ndimage.binary_erosion(each) for each in (one, other)]
    away = [ndimage.distance_transform_edt(~each) for each in outlines]
    return float(np.mean(np.concatenate([away[1][outlines[0]], away[0][outlines[1]]])))


@checked
def repair(
    silhouettes: Silhouettes,
    grid: Grid,
    way: Way = "auto",
    *,
    wall_px: float = 0.0,
    held: Flags | None = None,
    told: Callable[[int, int], None] | None = None,
) -> Repaired:
    """Make silhouettes agree, so that one object casts them all.

    Parameters
    ----------
    way
        ``"trim"`` leaves out what no object casts, ``"grow"`` adds to the others what is in its way, ``"warp"`` bends
        all as little as can be and joins their pieces; ``"auto"`` trims where hardly anything is lost, or where there
        are more than `MOST_BENT`, else bends.
    wall_px, held, told
        As `warp` takes them.
    """
    check_wall(wall_px)
    if way == "none":
        return Repaired(silhouettes, hull(silhouettes, grid), way, None)
    if way == "grow":
        return Repaired(silhouettes, _trimmed(hull(_grown(silhouettes, grid), grid)), way, None)
    if way == "trim" or (way == "auto" and _may_be_trimmed(silhouettes, grid)):
        trimmed = Repaired(silhouettes, _trimmed(hull(silhouettes, grid)), "trim", None)
        if way == "trim" or all(trimmed.kept_forms) or len(silhouettes) > MOST_BENT:
            return trimmed
    return _warped(silhouettes, grid, partial(warp, silhouettes, grid, wall_px=wall_px, held=held, told=told))


def _may_be_trimmed(silhouettes: Silhouettes, grid: Grid) -> bool:
    """Whether hardly anything is lost by it, or they are too many to be bent."""
    found = reach(silhouettes, grid)
    return len(silhouettes) > MOST_BENT or (found.share <= _LITTLE and found.is_one_piece)


def _warped(silhouettes: Silhouettes, grid: Grid, bend: Callable[..., Warped]) -> Repaired:
    """Silhouettes bent until one piece casts them, and again where parts or holes have come or gone."""
    bent, joined = bend(), np.empty((0, 3))
    for _ in range(_ROUNDS):
        if reach(bent.silhouettes, grid).is_one_piece:
            break
        joined = np.concatenate([joined, bridges(hull_field(bent.silhouettes, grid))])
        bent = bend(start=bent, joined=joined)
    best = Repaired(silhouettes, _trimmed(hull(bent.silhouettes, grid)), "warp", bent)
    for _ in range(_ROUNDS):
        if all(best.kept_forms):
            break
        bent = bend(start=bent, joined=joined, urgent=_lost(bent.silhouettes, best.shape.silhouettes))
        other = Repaired(silhouettes, _trimmed(hull(bent.silhouettes, grid)), "warp", bent)
        best = other if sum(other.kept_forms) >= sum(best.kept_forms) else best
    return best


def _lost(bent: Silhouettes, cast: Silhouettes) -> Flags:
    """``(picture, row, column)``: pixels near which something is lost that was to be cast."""
    from scipy import ndimage

    rows, columns = bent.rig.picture_shape
    lost = bent.inside & ~cast.inside
    coarse = np.any(lost.reshape(len(bent), rows, FINE, columns, FINE), axis=(2, 4))
    return np.asarray(ndimage.binary_dilation(np.asarray(coarse), np.ones((1, 3, 3), np.bool_)))


def _trimmed(shape: Shape) -> Shape:
    """The same object for what it casts of its silhouettes."""
    cast = cast_mesh(shape.mesh, shape.rig) & shape.silhouettes.inside
    if not np.all(np.any(cast, axis=(1, 2))):
        name = next(name for name, each in zip(shape.names, cast, strict=True) if not np.any(each))
        raise InputError(f"nothing of {name} is left when what no object casts is left out: bend them (--repair warp)")
    left = Silhouettes(locked(cast), shape.rig, shape.names)
    return Shape(shape.field, shape.grid, left, shape.provenance)


def bridges(field: Volume) -> Reals:
    """``(place, 3)``: voxels on the ways that are least far outside, from each piece of a hull to its largest one."""
    from scipy import ndimage
    from skimage.graph import MCP

    labels, count = ndimage.label(field < 0)
    sizes = np.bincount(labels.ravel(), minlength=count + 1)
    sizes[0] = 0
    order = [int(piece) for piece in np.argsort(-sizes, kind="stable") if sizes[piece] >= _PIECE]
    if len(order) < 2:
        return np.empty((0, 3))
    steep = MCP(np.exp(_STEEP * np.clip(field, -0.5, None)).astype(np.float64), fully_connected=False)
    costs, _ = steep.find_costs(np.argwhere(labels == order[0]))
    ways = []
    for piece in order[1:]:
        own = np.argwhere(labels == piece)
        nearest = own[int(np.argmin(costs[tuple(own.T)]))]
        ways.append(np.array(steep.traceback(nearest), np.float64))
    return np.concatenate(ways)


def _grown(silhouettes: Silhouettes, grid: Grid) -> Silhouettes:
    """What is in the way of pixels added to the other pictures, the nearest first, until all are cast."""
    onto = projections.of_voxels(projections.matrices(silhouettes.rig), grid)
    inside = silhouettes.inside.copy()
    rows, columns = silhouettes.rig.picture_shape
    for _ in range(_MOST_GROWN):
        found = reach(Silhouettes(inside.copy(), silhouettes.rig, silhouettes.names), grid)
        lacking = found.unreachable & np.isfinite(found.depth)
        if not np.any(lacking):
            break
        nearest = lacking & (found.depth <= found.depth[lacking].min() + 1)
        places = np.column_stack([found.places[nearest], np.ones(np.count_nonzero(nearest))])
        for picture, matrix in enumerate(onto):
            across, down, w = matrix @ places.T
            i, j = (np.rint(each / w).astype(int) for each in (down, across))
            seen = (i >= 0) & (i < rows) & (j >= 0) & (j < columns)
            for fine_i in range(FINE):
                for fine_j in range(FINE):
                    inside[picture, FINE * i[seen] + fine_i, FINE * j[seen] + fine_j] = True
    return Silhouettes(locked(inside), silhouettes.rig, silhouettes.names)
