"""Light that is thrown back inside a block of glass and leaves it elsewhere: ghosts beside and on the pictures.

A beam that enters one face and meets a neighbouring one is wholly thrown back there, where the index is above the root
of 2, and leaves through the face opposite to its own with one or two parts of its direction turned round. So ghosts
land elsewhere the farther the screen stands, unlike the picture. They are told, not computed with: stops that stand off
the faces' normals have none before a screen that is far enough away.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from lightcube.optics.arrays import Reals
from lightcube.optics.glass import Glass
from lightcube.optics.refraction import iors, known
from lightcube.optics.rig import Rig

#: Ghosts fainter than this, of a lamp of power 1, are not seen.
SEEN = 0.01
#: A direction's part below this is none; and so steeply light falls on a screen at least.
_NONE, _AWAY = 1e-9, 0.02


def ghosts(rig: Rig) -> Reals:
    """``(views, rows, columns)``: light of a lamp of power 1, the glass being clear, that is thrown back onto pixels.

    0 of all but blocks, whose sides are flat.
    """
    return np.stack([_ghosts(rig, view) for view in range(len(rig.views))])


def has_ghosts(rig: Rig) -> bool:
    """Whether on any pixel one falls that is seen."""
    return any(np.any(_ghosts(rig, view) > SEEN) for view in range(len(rig.views)))


def _ghosts(rig: Rig, view: int) -> Reals:
    """``(rows, columns)``: those of a view."""
    views, glass = rig.views, known(rig)
    shown = np.zeros(views.picture_shape)
    if glass.form != "block" or glass.size_mm is None:
        return shown
    half, ior = np.array(glass.size_mm) / 2, float(iors(rig)[view])
    light = views.lamps[view, :3] / np.linalg.norm(views.lamps[view, :3])
    normal = np.cross(views.column_steps_mm[view], views.row_steps_mm[view])
    normal /= np.linalg.norm(normal)
    places = _pixels(rig, view)
    for face, turned in product(range(3), product((1, -1), repeat=2)):
        aside = [axis for axis in range(3) if axis != face]
        way = light.copy()
        way[aside] *= turned
        falls = (way @ normal) / (light @ normal)
        dark = face == 2 and glass.bottom == "blocked"
        if turned == (1, 1) or abs(light[face]) < _NONE or falls < _AWAY or dark:
            continue
        if any(sign < 0 and abs(light[axis]) < _NONE for sign, axis in zip(turned, aside, strict=True)):
            continue
        lit = _comes(places, light, way, face, half, ior)
        shown += lit * _passes(abs(light[face]), ior) * falls
    return shown


def off_normals(angles_deg: Reals, glass: Glass | None) -> Reals:
    """Angles of a turntable, turned together by as little as brings them as far from a block's normals as can be.

    Those of other bodies, and of none, stay as they are.

    Examples
    --------
    >>> import numpy as np, lightcube as lc
    >>> from lightcube.optics.glare import off_normals
    >>> off_normals(np.array([3.0, 123, 243]), lc.Glass(1.5))
    array([ 15., 135., 255.])
    """
    if glass is None or glass.form != "block" or not glass.bends:
        return angles_deg
    within = np.sort(np.remainder(angles_deg, 90.0))
    gaps = np.diff(within, append=within[0] + 90.0)
    widest = gaps > gaps.max() - 1e-9
    middles = (within + gaps / 2)[widest]
    turns = 45.0 - np.remainder(middles + 45.0, 90.0)  # that bring such a middle to a normal
    return np.asarray(angles_deg + turns[np.argmin(np.abs(turns))])


def _comes(places: Reals, light: Reals, way: Reals, face: int, half: Reals, ior: float) -> Reals:
    """1 where light that leaves a face along `way` comes from a beam that entered the face opposite, else 0."""
    side = np.copysign(half[face], light[face])
    back = (side - places[..., face]) / way[face]
    leaves = places + back[..., None] * way
    inside = back < 0
    straight = np.sqrt(ior**2 - (1 - light[face] ** 2))
    for axis in range(3):
        if axis == face:
            continue
        inside &= np.abs(leaves[..., axis]) < half[axis]
        end = leaves[..., axis]
        if way[axis] != light[axis]:  # as if the block went on behind its wall
            end = 2 * np.copysign(half[axis], light[axis]) - end
        inside &= np.abs(end - 2 * half[face] * light[axis] / straight) < half[axis]
    return inside.astype(np.float64)


def _passes(cosine: float, ior: float) -> float:
    from lightcube.kernels.glass import let_through  # here: the compiler comes with it

    return float(let_through(cosine, ior))


def _pixels(rig: Rig, view: int) -> Reals:
    """``(rows, columns, 3)``: middles of a view's pixels, mm."""
    views = rig.views
    down, right = (np.arange(count) - (count - 1) / 2 for count in views.picture_shape)
    across = views.origins_mm[view] + right[:, None] * views.column_steps_mm[view]
    return np.asarray(across + down[:, None, None] * views.row_steps_mm[view])
