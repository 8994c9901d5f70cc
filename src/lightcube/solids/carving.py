"""Taking material out of a solid while all its shadows stay: a shell, or a lace of few voxels."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Counts, Flags, Integers, Volume, locked
from lightcube.optics.checks import checked
from lightcube.solids import projections
from lightcube.solids.shape import Shape

#: What is left of a solid: its skin, or as little as casts its shadows and hangs together.
Carving = Literal["shell", "lace"]
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


@checked
def carve(
    shape: Shape, how: Carving, *, wall_mm: float = 1.2, drain_mm: float = 3.0, deep: int = 3, seed: int = 0
) -> Shape:
    """Take material out of a solid that none of its shadows needs.

    Parameters
    ----------
    how
        ``"shell"`` keeps what is nearer to the surface than a wall, for a printer that works in liquid or powder with
        holes to drain what is inside. ``"lace"`` takes voxel after voxel, from outside, while each
        pixel of each shadow keeps `deep` of them and no piece falls apart: a light, open body.
    wall_mm, drain_mm
        How thick the shell is, and how wide two holes are in the wall of each of its cavities, below and above, where
        no shadow shows them; 0 = no holes.
    deep
        Voxels that are left on each ray of the lace that had as many; 1 makes threads of single voxels.
    seed
        Which voxels of the lace are tried first, where nothing else says so.

    Raises
    ------
    InputError
        Where a wall is not thicker than nothing, or `deep` is below 1.

    Examples
    --------
    >>> import numpy as np
    >>> import lightcube as lc
    >>> grid = lc.Grid((12, 12, 12))
    >>> whole = lc.hull(lc.Silhouettes(np.ones((3, 48, 48), bool), lc.walls(grid).rig(), ("F", "S", "T")), grid)
    >>> light = lc.carve(whole, "lace", deep=1)
    >>> int(whole.inside.sum()), int(light.inside.sum()) < 600, light.mesh.is_watertight
    (1728, True, True)
    """
    if not (0 < wall_mm <= _MOST_MM and 0 <= drain_mm <= _MOST_MM):
        raise InputError(
            f"a wall is thicker than 0 mm and a drain 0 mm or more, both at most {_MOST_MM:g}, "
            f"not {wall_mm:g} and {drain_mm:g}"
        )
    if how == "shell":
        hollow = _shell(shape.field, wall_mm / shape.grid.voxel_mm)
        return replace(shape, field=_drained(hollow, shape, drain_mm / 2 / shape.grid.voxel_mm))
    if deep < 1:
        raise InputError(f"at least one voxel must be left on each ray, not {deep}")
    left = _lace(shape, deep, seed)
    taken = shape.inside & ~left
    return replace(shape, field=locked(np.where(taken, _TAKEN, shape.field)))


def _shell(field: Volume, wall: float) -> Volume:
    """The part of a solid that is nearer to its surface than `wall` voxels."""
    thick = np.rint(wall * 256) / 256 + _HALF_STEP
    return locked(np.maximum(field, -field - np.float32(thick)).astype(np.float32))


def _lace(shape: Shape, deep: int, seed: int) -> Flags:
    """Voxels that cast all shadows and hang together, as few as one way of trying leaves."""
    from scipy import ndimage  # here: whoever carves nothing does without

    from lightcube.kernels import carving

    onto = projections.of_voxels(projections.matrices(shape.rig), shape.grid)
    solid, counts, size = np.pad(shape.inside, 1), landed(shape.inside, shape), shape.rig.picture_shape
    total = int(np.count_nonzero(solid))
    random = np.random.default_rng(seed)
    for _ in range(_PASSES):
        order = np.argwhere(solid)
        depth = ndimage.distance_transform_edt(solid)[tuple(order.T)]
        order = order[np.lexsort((random.random(len(order)), depth))]  # from outside
        gone = carving.carve(solid, order, onto, size, deep, True, counts)
        if gone < _WORTH * total:
            break
    left = solid[1:-1, 1:-1, 1:-1]
    return np.asarray(ndimage.binary_fill_holes(left)) & shape.inside  # what nothing can get out of may as well stay


def _drained(field: Volume, shape: Shape, radius: float) -> Volume:
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
            made = next((each for each in tried if np.array_equal(landed(each < 0, shape) > 0, before > 0)), made)
    return locked(made)


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
