"""Taking material out of a solid while all its shadows stay: a shell, or a lace of few voxels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Counts, Flags, Integers, Reals, Volume, locked
from lightcube.optics.checks import checked
from lightcube.solids import projections
from lightcube.solids.field import hull_field
from lightcube.solids.reach import count_pieces
from lightcube.solids.shape import Shape

#: What is left of a solid: its skin, or as little as casts its shadows and hangs together; or no such is asked for.
Carving = Literal["none", "shell", "lace"]
#: No wall and no drain is wider, mm.
_MOST_MM = 1e6
#: Fields count in steps of 1/256 and are never 0: half a step more keeps them so.
_HALF_STEP = 1 / 512
#: What a voxel that was taken away is outside by: what is left is a little fatter than its voxels, and stays one.
_TAKEN = np.float32(0.25)
#: Places that are tried for a drain, and the fewest voxels of a cavity that gets one.
_TRIED, _CAVITY = 60, 30
#: Times that all voxels are tried, and the part of them that must go for another time.
_PASSES, _WORTH = 6, 0.001
#: What is further outside of the hull, in voxels, is no part of it: a base.
_BASE = 0.5


@checked
def carve(
    shape: Shape,
    how: Carving,
    *,
    wall_mm: float = 1.2,
    drain_mm: float = 3.0,
    deep: int = 3,
    seed: int = 0,
    where: Flags | None = None,
    rays: Sequence[tuple[int, int, int]] = (),
    anew: bool = False,
) -> Shape:
    """Take material out of a solid that none of its shadows needs.

    Parameters
    ----------
    how
        ``"shell"`` keeps what is nearer to the surface than a wall, for a printer that works in liquid or powder with
        holes to drain what is inside. ``"lace"`` takes voxel after voxel, from outside, while each
        pixel of each shadow keeps `deep` of them and no piece falls apart: a light, open body. ``"none"`` does
        neither.
    wall_mm, drain_mm
        How thick the shell is, and how wide two holes are in the wall of each of its cavities, below and above, where
        no shadow shows them; 0 = no holes.
    deep
        Voxels that are left on each ray of the lace that had as many; 1 makes threads of single voxels.
    seed
        Which voxels of the lace are tried first, where nothing else says so.
    where
        ``(z, y, x)``: the only voxels that may be taken; default all of them. A base, which stands outside of the hull,
        always stays.
    rays
        ``(picture, row, column)``: pixels, from 0, whose rays give what they do not need, as a lace would.
    anew
        Whether to begin with the whole hull of its silhouettes: what was taken out before is given back.

    Raises
    ------
    InputError
        Where a wall is not thicker than nothing, `deep` is below 1, nothing is to be taken, there is no such pixel, or
        a brush leaves something loose in a shell.

    Examples
    --------
    >>> import numpy as np
    >>> import lightcube as lc
    >>> grid = lc.Grid((12, 12, 12))
    >>> whole = lc.hull(lc.Silhouettes(np.ones((3, 48, 48), bool), lc.walls(grid).rig(), ("F", "S", "T")), grid)
    >>> light = lc.carve(whole, "lace", deep=1)
    >>> int(whole.inside.sum()), int(light.inside.sum()) < 600, light.mesh.is_watertight
    (1728, True, True)
    >>> again = lc.carve(light, "none", anew=True)
    >>> int(again.inside.sum())
    1728
    """
    _check(shape, how, wall_mm, drain_mm, deep, where, rays, anew=anew)
    hull = hull_field(shape.silhouettes, shape.grid)
    if anew:
        shape = replace(shape, field=locked(np.minimum(hull, shape.field)))
    free = np.asarray(hull < _BASE) if where is None else where & (hull < _BASE)
    if how == "shell":
        shape = _hollowed(shape, free, wall_mm, drain_mm)
    if how == "lace":
        shape = _without(shape, _lace(shape, free, deep, seed))
    if rays:
        depths = _depths_on(shape, rays)
        shape = _without(shape, _lace(shape, free & (depths >= 0), deep, seed, depths))
    return shape


def _check(
    shape: Shape,
    how: Carving,
    wall_mm: float,
    drain_mm: float,
    deep: int,
    where: Flags | None,
    rays: Sequence[tuple[int, int, int]],
    *,
    anew: bool,
) -> None:
    """Raise `InputError` for what `carve` cannot do."""
    if not (0 < wall_mm <= _MOST_MM and 0 <= drain_mm <= _MOST_MM):
        raise InputError(
            f"a wall is thicker than 0 mm and a drain 0 mm or more, both at most {_MOST_MM:g}, "
            f"not {wall_mm:g} and {drain_mm:g}"
        )
    if deep < 1:
        raise InputError(f"at least one voxel must be left on each ray, not {deep}")
    if how == "none" and not rays and not anew:
        raise InputError("nothing is to be taken out: say shell or lace, name rays, or begin anew with the whole hull")
    if where is not None and where.shape != shape.grid.shape:
        raise InputError(f"a brush has shape {where.shape}, not {shape.grid.shape} as the shape's voxels (z, y, x)")
    windows = shape.rig.stops.window
    for picture, row, column in rays:
        if not 0 <= picture < len(windows):
            raise InputError(f"there is no picture {picture} among {len(windows)}, counted from 0: name another")
        high, wide = windows[picture].tolist()
        if not (0 <= row < high and 0 <= column < wide):
            raise InputError(
                f"picture {shape.names[picture]} has {high} x {wide} pixels, counted from 0, "
                f"and none in row {row}, column {column}: name another"
            )


def _without(shape: Shape, left: Flags) -> Shape:
    """What is left of a shape, a little fatter than its voxels, so that it stays one."""
    taken = shape.inside & ~left
    return replace(shape, field=locked(np.where(taken, _TAKEN, shape.field)))


def _depths_on(shape: Shape, rays: Sequence[tuple[int, int, int]]) -> Volume:
    """``(z, y, x)``: of voxels whose middles land on pixels, how many are before each from the nearer end; else -1."""
    onto = projections.of_voxels(projections.matrices(shape.rig), shape.grid)
    places = np.argwhere(shape.inside)
    depths = np.full(shape.grid.shape, -1, np.float32)
    for picture, row, column in rays:
        across, down, w = onto[picture] @ np.column_stack([places, np.ones(len(places))]).T
        (met,) = np.nonzero((np.floor(down / w + 0.5) == row) & (np.floor(across / w + 0.5) == column))
        along = np.argsort(np.argsort(places[met] @ _way(onto[picture]), kind="stable"))
        depths[tuple(places[met].T)] = np.minimum(along, len(met) - 1 - along)
    return depths


def _way(onto: Reals) -> Reals:
    """The way ``(z, y, x)`` of light through the block's middle: along it nothing moves on the picture."""
    return np.asarray(np.cross(onto[0, :3], onto[1, :3]))


def _shell(field: Volume, wall: float) -> Volume:
    """The part of a solid that is nearer to its surface than `wall` voxels."""
    thick = np.rint(wall * 256) / 256 + _HALF_STEP
    return locked(np.maximum(field, -field - np.float32(thick)).astype(np.float32))


def _hollowed(shape: Shape, free: Flags, wall_mm: float, drain_mm: float) -> Shape:
    """A shell with drains, of what is free to go."""
    voxel_mm = shape.grid.voxel_mm
    hollow = locked(np.where(free, _shell(shape.field, wall_mm / voxel_mm), shape.field))
    made = replace(shape, field=_drained(hollow, shape, drain_mm / 2 / voxel_mm, free))
    if count_pieces(made.inside) > count_pieces(shape.inside):
        raise InputError("the brush would leave something loose in a cavity: let it cover that too")
    return made


def _lace(shape: Shape, free: Flags, deep: int, seed: int, depths: Volume | None = None) -> Flags:
    """Voxels that cast all shadows and hang together, as few as one way of trying leaves of those that may go.

    They are tried by their `depths`; default how far they are from what is outside.
    """
    from scipy import ndimage  # here: whoever carves nothing does without

    from lightcube.kernels import carving

    onto = projections.of_voxels(projections.matrices(shape.rig), shape.grid)
    solid, counts, size = np.pad(shape.inside, 1), landed(shape.inside, shape), shape.rig.picture_shape
    total = int(np.count_nonzero(solid))
    random = np.random.default_rng(seed)
    for _ in range(_PASSES):
        order = np.argwhere(solid & np.pad(free, 1))
        far = ndimage.distance_transform_edt(solid) if depths is None else np.pad(depths, 1)
        depth = far[tuple(order.T)]
        order = order[np.lexsort((random.random(len(order)), depth))]  # from outside
        gone = carving.carve(solid, order, onto, size, deep, True, counts)
        if gone < _WORTH * total:
            break
    left = solid[1:-1, 1:-1, 1:-1]
    return np.asarray(ndimage.binary_fill_holes(left)) & shape.inside  # what nothing can get out of may as well stay


def _drained(field: Volume, shape: Shape, radius: float, free: Flags) -> Volume:
    """A shell with a hole of a radius in voxels below and above each cavity, where all its shadows stay."""
    from scipy import ndimage

    if radius == 0:
        return field
    before = landed(field < 0, shape)
    numbers, count = ndimage.label(field > 0)
    labels = numbers.astype(np.int64)
    outside = set(np.unique(np.concatenate([side.ravel() for axis in range(3) for side in _ends(labels, axis)])))
    made = field
    for cavity in range(1, count + 1):
        places = np.argwhere(labels == cavity)
        if cavity in outside or len(places) < _CAVITY:
            continue
        for way in (1, -1):  # the lowest, the highest
            order = places[np.argsort(way * places[:, 0], kind="stable")]
            tried = (_holed(made, place, way, radius) for place in order[:: max(1, len(order) // _TRIED)])
            made = next((each for each in tried if _is_hidden(each, made, free, before, shape)), made)
    return locked(made)


def _is_hidden(holed: Volume, before: Volume, free: Flags, landed_before: Counts, shape: Shape) -> bool:
    """Whether a hole takes nothing that must stay, and no shadow shows it."""
    if np.any((before < 0) & (holed >= 0) & ~free):
        return False
    return bool(np.array_equal(landed(holed < 0, shape) > 0, landed_before > 0))


def _ends(labels: Integers, axis: int) -> tuple[Integers, Integers]:
    """The first and last layers along an axis."""
    return np.take(labels, 0, axis), np.take(labels, -1, axis)


def _holed(field: Volume, place: Counts, way: int, radius: float) -> Volume:
    """A field with an upright hole from a place down (1) or up (-1)."""
    z, y, x = (np.arange(count) - at for count, at in zip(field.shape, place, strict=True))
    inside = radius - np.hypot(y[:, None], x[None])
    hole = (np.rint(inside * 256) / 256 + _HALF_STEP).astype(np.float32)
    made = field.copy()
    within = way * z <= 0
    made[within] = np.maximum(made[within], hole)
    return made


def landed(inside: Flags, shape: Shape) -> Counts:
    """``(picture, pixel)``: how many voxels' middles land on each pixel of a shape's pictures."""
    from lightcube.kernels import carving  # here: the compiler comes with it

    onto = projections.of_voxels(projections.matrices(shape.rig), shape.grid)
    rows, columns = shape.rig.picture_shape
    counts = np.zeros((len(onto), rows * columns), np.int64)
    carving.count(np.pad(inside, 1), onto, (rows, columns), counts)
    return counts
