"""A base for a solid that would tip over: below where its pictures end, and in none of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, Volume, locked
from lightcube.optics.checks import checked
from lightcube.optics.grid import Grid
from lightcube.solids import projections
from lightcube.solids.certificate import cast_mesh
from lightcube.solids.printing import stands
from lightcube.solids.shape import Shape
from lightcube.solids.silhouettes import FINE, Silhouettes

#: Fields count in steps of 1/256 and are never 0; what is far outside, and what is just outside of a face.
_STEP, _FAR, _BESIDE = 256, 8.0, 0.5
#: A base keeps so far from what would show it, in voxels.
_CLEAR = 0.25
#: Small pixels that a base may add to a picture, as a part of its silhouette: edges are rounded.
_SHOWN = 0.005


@checked
def with_base(shape: Shape, thick_mm: float) -> Shape:
    """Let a solid stand on a base that no picture shows.

    Upright pictures end at the row where the solid's shadow does: what is cast below that is on no screen. There the
    base lies, no wider than the solid, and inside all silhouettes that it would show in, such as that of a lamp above.

    Parameters
    ----------
    thick_mm
        How thick it is.

    Raises
    ------
    InputError
        Where a base is thicker than the block is high, no picture is upright, or it would not stand on what is hidden.

    Examples
    --------
    >>> import numpy as np
    >>> import lightcube as lc
    >>> grid = lc.Grid((12, 12, 12))
    >>> corner = np.ones((3, 48, 48), bool)
    >>> corner[0, 8:, 8:] = corner[1, 8:, 16:] = False  # a wide top on a thin leg at its corner
    >>> whole = lc.hull(lc.Silhouettes(corner, lc.walls(grid).rig(), ("front", "side", "top")), grid)
    >>> round(lc.with_base(whole, 2.0).mesh.size_mm[2] - whole.mesh.size_mm[2], 1)
    2.0
    """
    high_mm = shape.grid.size_mm[0]
    if not 0 < thick_mm <= high_mm:
        raise InputError(f"a base is thicker than 0 mm and at most {high_mm:g}, as the block, not {thick_mm:g}")
    side_mm = float(shape.grid.sides_mm[2])
    layers = max(1, round(thick_mm / side_mm))
    lower = _with_room(_ending(shape), layers + 1)
    first = int(np.flatnonzero(np.any(lower.inside, axis=(1, 2)))[0])
    own = slice(first - layers - 1, first + 1)
    field = lower.field.copy()
    field[own] = np.minimum(field[own], _hidden(lower, own))
    made = replace(lower, field=locked(_joined(field, lower)))
    if not np.any(made.inside & ~lower.inside) or not stands(made.mesh):
        raise InputError(
            "it does not stand on what is hidden from all its lamps: lay it down, or glue it to a foot that none sees"
        )
    _check_hidden(made, lower)
    return made


def _upright(shape: Shape) -> Flags:
    """``(picture,)``: whether rows of a picture go downwards."""
    steps = shape.rig.views.row_steps_mm
    return np.asarray(-steps[:, 2] > 0.5 * np.linalg.norm(steps, axis=1))


def _ending(shape: Shape) -> Shape:
    """The same on screens that end, where they are upright, at the last whole row of the shadow."""
    upright = _upright(shape)
    if not np.any(upright):
        raise InputError("no picture is upright, and a base would show in all of them: leave it out")
    rows = np.any(cast_mesh(shape.mesh, shape.rig), axis=2)
    ends = (rows.shape[1] - np.argmax(rows[:, ::-1], axis=1)) // FINE
    window = shape.rig.stops.window.copy()
    window[:, 0] = np.where(upright, np.clip(ends, 1, window[:, 0]), window[:, 0])
    rig = replace(shape.rig, stops=replace(shape.rig.stops, window=locked(window)))
    inside = shape.silhouettes.inside & rig.inside.repeat(FINE, axis=1).repeat(FINE, axis=2)
    return replace(shape, silhouettes=Silhouettes(locked(inside), rig, shape.names))


def _with_room(shape: Shape, layers: int) -> Shape:
    """The same in a block that is higher, above as below, where there are fewer layers below the solid."""
    first = int(np.flatnonzero(np.any(shape.inside, axis=(1, 2)))[0])
    more = max(0, layers - first)
    if not more:
        return shape
    nz, ny, nx = shape.grid.shape
    field = np.pad(shape.field, ((more, more), (0, 0), (0, 0)), constant_values=_FAR)
    for beyond, edge in ((more - 1, more), (-more, -more - 1)):
        field[beyond] = np.where(field[edge] < 0, _BESIDE, field[beyond])
    return replace(shape, field=locked(field), grid=Grid((nz + 2 * more, ny, nx), shape.grid.voxel_mm, shape.grid.tall))


def _hidden(shape: Shape, layers: slice) -> Volume:
    """A field of layers around a base: below 0 where what stands there shows in no picture."""
    from scipy import ndimage  # here: whoever needs no base does without
    from scipy.spatial import ConvexHull

    from lightcube.kernels.hull import MARGIN

    given, grid = shape.silhouettes, shape.grid
    depth, wide = grid.shape[1:]
    z, y, x = (each.astype(float) for each in np.mgrid[layers, :depth, :wide])
    places = np.stack([z.ravel(), y.ravel(), x.ravel(), np.ones(z.size)])
    onto = projections.of_voxels(projections.matrices(shape.rig), grid)
    found = np.full(z.size, -_FAR)
    for number, width in enumerate(projections.voxels_a_pixel(shape.rig, grid)):
        across, down, w = onto[number] @ places
        row, column = down / w, across / w
        rows, columns = shape.rig.stops.window[number]
        own = ndimage.map_coordinates(
            given.distances[number], np.stack([row, column]) + MARGIN, order=1, mode="nearest"
        )
        beside = np.minimum.reduce([row + 0.5, rows - 0.5 - row, column + 0.5, columns - 0.5 - column])
        found = np.maximum(found, width * np.minimum(own, beside) + _CLEAR)
    under = np.argwhere(np.any(shape.inside, axis=0))
    corners = np.concatenate([under + corner for corner in ((-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5))])
    outline = ConvexHull(corners).equations
    around = np.max(outline[:, :2] @ places[1:3] + outline[:, 2:], axis=0)
    found = np.maximum(found, around).reshape(z.shape)
    found = np.maximum(found, layers.start + _BESIDE - z)  # the first of them is below the base
    steps = np.clip(np.rint(_STEP * found) / _STEP, -_FAR, _FAR)
    return np.asarray(np.where(steps == 0, 1 / _STEP, steps), np.float32)


def _joined(field: Volume, shape: Shape) -> Volume:
    """A field without what is new and hangs on nothing that was there."""
    from scipy import ndimage

    labels, count = ndimage.label(field < 0)
    kept = np.zeros(count + 1, np.bool_)
    kept[np.unique(labels[shape.inside])] = True
    return np.where((labels > 0) & ~kept[labels], shape.field, field).astype(np.float32)


def _check_hidden(made: Shape, before: Shape) -> None:
    """Raise `InputError` where a picture shows what was added."""
    on = made.rig.inside.repeat(FINE, axis=1).repeat(FINE, axis=2)
    added = cast_mesh(made.mesh, made.rig) & on & ~cast_mesh(before.mesh, before.rig) & ~made.silhouettes.inside
    parts = np.count_nonzero(added, axis=(1, 2)) / np.count_nonzero(made.silhouettes.inside, axis=(1, 2))
    worst = int(np.argmax(parts))
    if parts[worst] > _SHOWN:
        raise InputError(
            f"a base would show in {made.names[worst]}, as {parts[worst]:.1%} of its shape: leave it out, or take more "
            "voxels"
        )
