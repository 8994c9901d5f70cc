"""Where light goes in a clear body: the straight piece of each pixel's beam inside it, and how much light it brings.

Lengths are in mm, in the body's own axes, its middle at 0. Light is parallel, of unit direction d outside, and meets an
index of refraction n inside. A pixel at q is lit by at most one beam through the body, which is found backwards and in
closed form, or by one root; so places are exact. Light that is thrown back inside and comes out elsewhere is left out
(`lightcube.optics.glare` says where it goes).

With n of at least the root of 2, light that enters a face of a block never leaves through one beside it: it leaves
through the one opposite, along d again. A cylinder about z bends light in the plane like a rod of index
``n_e = sqrt(n^2 - sin^2 e) / cos e`` in level light, e being the light's elevation (J. Bravais, 1847); a sphere does
in the plane through its middle. With b the distance from the axis where light meets them, as a part of the radius R,
``i = asin b`` and ``r = asin(b / n_e)``, the beam leaves at the angle ``2 r - i`` from the axis of the light, turned by
``2 (i - r)``. Light of neighbouring beams spreads as ``R db / dy``.

The light of a beam is that of a lamp of power 1 on the same screen without the body: what both surfaces let through
(A. Fresnel's formulas, of unpolarised light), how far the beams spread, and how aslant they fall.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled

Array = NDArray[Any]
#: Light that misses the body, light that comes through it, and where that enters and leaves the body.
Beam = tuple[float, float, float, float, float, float, float, float]

#: Forms: a block with six faces; a bath with two, square to the light; a cylinder about z; a sphere.
BLOCK, BATH, CYLINDER, SPHERE = 0, 1, 2, 3
#: A direction's component below this is zero.
_NONE = 1e-12
#: Roots are found to this, as a part of the radius; Newton's steps halve no interval more often.
_EXACT, _MOST_STEPS = 1e-14, 60
#: Nearer to the axis than this, as a part of the radius, things are as on it.
_AXIS = 1e-9
#: Beams that lie as near to each other, in voxels, are the same.
_SAME = 1e-7
_DARK = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@compiled
def let_through(cosine: float, ior: float) -> float:
    """The part of unpolarised light that passes two faces, aslant by the angle of this cosine outside both."""
    inside = math.sqrt(1.0 - (1.0 - cosine * cosine) / (ior * ior))
    across = (cosine - ior * inside) / (cosine + ior * inside)
    along = (inside - ior * cosine) / (inside + ior * cosine)
    return ((1.0 - across * across) ** 2 + (1.0 - along * along) ** 2) / 2


@compiled
def _through_block(q: Array, d: Array, half: Array, ior: float, blocked: bool) -> Beam:
    """The beam of a pixel behind a block; with its bottom `blocked` none comes through that."""
    first, last = -np.inf, np.inf
    for axis in range(3):
        if abs(d[axis]) < _NONE:
            if abs(q[axis]) >= half[axis]:
                last = -np.inf
        else:
            one, two = (-half[axis] - q[axis]) / d[axis], (half[axis] - q[axis]) / d[axis]
            first, last = max(first, min(one, two)), min(last, max(one, two))
    if not first < last:
        return 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    leaves, enters = np.empty(3), np.empty(3)
    for face in range(3):
        if abs(d[face]) < _NONE or (face == 2 and blocked):
            continue
        side = half[face] if d[face] > 0 else -half[face]
        straight = math.sqrt(ior * ior - (1.0 - d[face] * d[face]))  # the part along the face's normal, times n
        inside = True
        for axis in range(3):
            if axis == face:
                leaves[axis], enters[axis] = side, -side
                continue
            leaves[axis] = q[axis] + d[axis] * (side - q[face]) / d[face]
            enters[axis] = leaves[axis] - 2 * half[face] * d[axis] / straight
            inside = inside and abs(leaves[axis]) < half[axis] and abs(enters[axis]) < half[axis]
        if inside:
            light = let_through(abs(d[face]), ior)
            return 0.0, light, enters[0], enters[1], enters[2], leaves[0], leaves[1], leaves[2]
    return _DARK


@compiled
def _through_bath(q: Array, d: Array, half: Array, ior: float) -> Beam:
    """The beam of a pixel behind a bath as wide as ``2 half[0]``, whose faces stand square to the level light."""
    level = math.hypot(d[0], d[1])
    ahead_x, ahead_y = d[0] / level, d[1] / level
    back = (half[0] - (q[0] * ahead_x + q[1] * ahead_y)) / level
    leaves_x, leaves_y, leaves_z = q[0] + back * d[0], q[1] + back * d[1], q[2] + back * d[2]
    long = 2 * half[0]
    drop = long * d[2] / math.sqrt(ior * ior - d[2] * d[2])
    return (
        *(0.0, let_through(level, ior), leaves_x - long * ahead_x, leaves_y - long * ahead_y, leaves_z - drop),
        *(leaves_x, leaves_y, leaves_z),
    )


@compiled
def landing(beta: float, ior: float, away: float) -> tuple[float, float, float, float]:
    """Where a beam that meets a disc of radius 1 so far off the axis lands on a line `away` from its middle.

    Beyond the axis, on the other side of it; how fast that grows with `beta`; by how much the beam is turned, and at
    which angle from the axis it leaves the disc.
    """
    i, r = math.asin(beta), math.asin(beta / ior)
    turn, leaves = 2 * (i - r), 2 * r - i
    di = 1 / math.sqrt(max(1 - beta * beta, 1e-300))
    dr = 1 / math.sqrt(ior * ior - beta * beta)
    tangent, reach = math.tan(turn), away - math.cos(leaves)
    place = tangent * reach - math.sin(leaves)
    off = (2 * dr - di) * (tangent * math.sin(leaves) - math.cos(leaves))
    return place, 2 * (di - dr) * (1 + tangent * tangent) * reach + off, turn, leaves


@compiled
def meeting(place: float, ior: float, away: float, guess: float) -> float:
    """How far off the axis the beam meets the disc that lands at `place`, at least 0; below 0 where none does.

    The inverse of `landing`, for lines beyond the focus. A `guess` above 0 is where the root is looked for first.
    """
    quarter = math.sqrt(0.5)
    r = math.atan2(quarter, ior - quarter)  # a beam that is turned by a right angle, where there is one
    low, high = 0.0, min(ior * math.sin(r), 1.0) if ior > math.sqrt(2.0) else 1.0
    if ior <= math.sqrt(2.0) and landing(high, ior, away)[0] <= place:
        return -1.0
    beta = guess if 0 < guess < high else min(place / (away * 2 * (1 - 1 / ior) - 1), 0.9 * high)
    for _ in range(_MOST_STEPS):
        found, growth, _, _ = landing(beta, ior, away)
        if found > place:
            high = beta
        else:
            low = beta
        step = beta - (found - place) / growth
        if abs(step - beta) < _EXACT:
            return step
        beta = step if low < step < high else (low + high) / 2
    return beta


@compiled
def _through_cylinder(q: Array, d: Array, half: Array, ior: float, normal: Array, last: Array) -> Beam:
    """The beam of a pixel behind a cylinder about z of radius ``half[0]`` that stands on something.

    `last` has the root, its place and what `landing` says of it.
    """
    level = math.hypot(d[0], d[1])
    ahead_x, ahead_y = d[0] / level, d[1] / level
    radius, high, slope = half[0], half[2], d[2] / level
    away = (q[0] * ahead_x + q[1] * ahead_y) / radius
    aside = (q[1] * ahead_x - q[0] * ahead_y) / radius
    beside = 1.0
    if abs(aside) < 1:  # straight light through this pixel goes over or under it, or meets it
        chord = math.sqrt(1 - aside * aside)
        one, two = q[2] - slope * radius * (away + chord), q[2] - slope * radius * (away - chord)
        beside = 1.0 if min(one, two) > high or max(one, two) < -high else 0.0
    index = math.sqrt(ior * ior - d[2] * d[2]) / level
    if aside != last[1] or away != last[2]:  # on upright screens a column's pixels all have the same
        last[0] = meeting(abs(aside), index, away, last[0])
        last[1], last[2] = aside, away
        if last[0] >= 0:
            _, last[3], last[4], last[5] = landing(last[0], index, away)
    beta, growth, turn, leaves = last[0], last[3], last[4], last[5]
    if beta < 0:
        return beside, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    side = -1.0 if aside > 0 else 1.0  # of the axis, that the beam enters on
    leaves_z = q[2] - slope * radius * (away - math.cos(leaves)) / math.cos(turn)
    chord = 2 * math.sqrt(1 - (beta / index) ** 2)
    enters_z = leaves_z - chord * radius * d[2] / math.sqrt(ior * ior - d[2] * d[2])
    if abs(leaves_z) >= high or abs(enters_z) >= high:
        return beside, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    straight, across = math.cos(turn), -side * math.sin(turn)  # the level way out, along the light and to its left
    out_x, out_y = straight * ahead_x - across * ahead_y, straight * ahead_y + across * ahead_x
    aslant = abs(level * (out_x * normal[0] + out_y * normal[1]) + d[2] * normal[2])
    before = abs(d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2])
    root = math.sqrt(1 - beta * beta)
    light = let_through(level * root, ior) / (growth * straight) * aslant / before
    near, near_aside = -radius * root, side * radius * beta
    far, far_aside = radius * math.cos(leaves), side * radius * math.sin(leaves)
    return (
        *(beside, light, near * ahead_x - near_aside * ahead_y, near * ahead_y + near_aside * ahead_x, enters_z),
        *(far * ahead_x - far_aside * ahead_y, far * ahead_y + far_aside * ahead_x, leaves_z),
    )


@compiled
def _through_sphere(q: Array, d: Array, half: Array, ior: float, normal: Array, last: Array) -> Beam:
    """The beam of a pixel behind a sphere of radius ``half[0]``."""
    radius = half[0]
    away = (q[0] * d[0] + q[1] * d[1] + q[2] * d[2]) / radius
    x, y, z = q[0] / radius - away * d[0], q[1] / radius - away * d[1], q[2] / radius - away * d[2]
    aside = math.sqrt(x * x + y * y + z * z)
    beside = 1.0 if aside >= 1 else 0.0
    if aside > 0:
        x, y, z = x / aside, y / aside, z / aside
    beta = last[0] = meeting(aside, ior, away, last[0])
    if beta < 0:
        return beside, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    _, growth, turn, leaves = landing(beta, ior, away)
    straight, across = math.cos(turn), math.sin(turn)
    out_x, out_y, out_z = straight * d[0] + across * x, straight * d[1] + across * y, straight * d[2] + across * z
    aslant = abs(out_x * normal[0] + out_y * normal[1] + out_z * normal[2])
    before = abs(d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2])
    root, wider = math.sqrt(1 - beta * beta), growth if aside < _AXIS else aside / beta
    light = let_through(root, ior) / (wider * growth * straight) * aslant / before
    near, near_aside = -radius * root, -radius * beta
    far, far_aside = radius * math.cos(leaves), -radius * math.sin(leaves)
    return (
        *(beside, light, near * d[0] + near_aside * x, near * d[1] + near_aside * y, near * d[2] + near_aside * z),
        *(far * d[0] + far_aside * x, far * d[1] + far_aside * y, far * d[2] + far_aside * z),
    )


@compiled
def _beam(form: int, q: Array, d: Array, half: Array, ior: float, blocked: bool, normal: Array, last: Array) -> Beam:
    """The beam of a pixel at q, which sits on a screen of this unit normal; `last` what was found of the last."""
    if form == BLOCK:
        return _through_block(q, d, half, ior, blocked)
    if form == BATH:
        return _through_bath(q, d, half, ior)
    if form == CYLINDER:
        return _through_cylinder(q, d, half, ior, normal, last)
    return _through_sphere(q, d, half, ior, normal, last)


def beams(
    form: int, half: Array, blocked: bool, iors: Array, lights: Array, screens: Array, light: Array, lines: Array
) -> None:
    """Find the beams of all pixels of some views; every number of `light` and `lines` is written.

    Parameters
    ----------
    form, half, blocked
        Of the body: its form, half its sides (x, y, z) in mm, and whether no light leaves through its bottom.
    iors, lights
        ``(views,)`` and ``(views, 3)``: index of refraction, and unit direction of the light outside.
    screens
        ``(views, 3, 3)``: the pixel of the first row and column, and the steps to the next column and row, mm.
    light
        ``(views, rows, columns, 2)``: what reaches each pixel past the body, and through it.
    lines
        ``(views, rows, columns, 6)``: where the latter enters and leaves the body; 0 where there is none.
    """
    views, columns = light.shape[0], light.shape[2]
    work = 200 * light.size
    tasks.run(_beams, views * columns, work, form, half, blocked, iors, lights, screens, light, lines)


@compiled
def _beams(
    first: int,
    last: int,
    form: int,
    half: Array,
    blocked: bool,
    iors: Array,
    lights: Array,
    screens: Array,
    light: Array,
    lines: Array,
) -> None:
    """Do picture columns `first` to before `last`, counted through all views."""
    rows, columns = light.shape[1], light.shape[2]
    for line in range(first, last):
        view, column = line // columns, line % columns
        screen = screens[view]
        normal = np.cross(screen[1], screen[2])
        normal /= math.sqrt(np.sum(normal * normal))
        remembered = np.zeros(6)
        for row in range(rows):
            q = screen[0] + column * screen[1] + row * screen[2]
            found = _beam(form, q, lights[view], half, iors[view], blocked, normal, remembered)
            light[view, row, column, 0], light[view, row, column, 1] = found[0], found[1]
            for k in range(6):
                lines[view, row, column, k] = found[2 + k]


def columns(lines: Array, lit: Array, apart: int, ends: Array, together: Array) -> None:
    """Find the beam that the pixels of each picture column have in common, but for being moved up.

    Parameters
    ----------
    lines
        ``(views, rows, columns, 6)``: where beams enter and leave, in voxels.
    lit
        ``(views, rows, columns)``: pixels that have a beam.
    apart
        Slices from a row to the next.
    ends
        ``(views, columns, 6)``: set to the common beam, as that of the lowest row.
    together
        ``(views, rows, columns)``: set to whether a pixel has it.
    """
    tasks.run(_columns, len(lit), 20 * lit.size, lines, lit, apart, ends, together)


@compiled
def _columns(first: int, last: int, lines: Array, lit: Array, apart: int, ends: Array, together: Array) -> None:
    """Do views `first` to before `last`."""
    rows, width = lit.shape[1:]
    own = np.empty(6)
    for view in range(first, last):
        for column in range(width):
            found = False
            for row in range(rows):
                together[view, row, column] = False
                if not lit[view, row, column]:
                    continue
                own[:] = lines[view, row, column]
                lift = apart * (rows - 1 - row)
                own[2], own[5] = own[2] - lift, own[5] - lift
                if not found and row + 1 < rows and lit[view, row + 1, column]:
                    below = lines[view, row + 1, column]
                    found = (
                        abs(below[2] - own[2] - lift + apart) < _SAME and abs(below[5] - own[5] - lift + apart) < _SAME
                    )
                    for axis in (0, 1, 3, 4):
                        found = found and abs(below[axis] - own[axis]) < _SAME
                    if found:
                        ends[view, column] = own
                if found:
                    same = True
                    for axis in range(6):
                        same = same and abs(ends[view, column, axis] - own[axis]) < _SAME
                    together[view, row, column] = same
