"""Where a line crosses the analytic shapes, and the normals there, in each shape's own axes.

Every shape is centred at the origin with its axis along z. A line is ``o + t d``; `d` need not have length 1, so
that ``t`` means the same point before and after an affine map. `crossings` writes the parameters at which the
line enters and leaves the solid, in order: (enter, leave) once, twice for a torus.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled

SPHERE, BOX, CONE, CAPSULE, TORUS, PLANE, MESH = range(7)

_NOTHING = (math.inf, -math.inf)
_EVERYTHING = (-math.inf, math.inf)
_NEWTON_STEPS = 60

Span = tuple[float, float]
Size = tuple[float, float, float]


@compiled
def _below(a: float, b: float, c: float) -> Span:
    """Between the roots of ``a t^2 + 2 b t + c`` for ``a > 0``, where it is at most 0."""
    root = b * b - a * c
    if root < 0.0:
        return _NOTHING
    # The sum without cancellation gives one root, the product of the roots the other.
    q = -(b + math.copysign(math.sqrt(root), b))
    if q == 0.0:
        return (0.0, 0.0)
    return (min(q / a, c / q), max(q / a, c / q))


@compiled
def _slab(o: float, d: float, half: float) -> Span:
    """Where ``|o + t d| <= half``."""
    if d == 0.0:
        return _EVERYTHING if abs(o) <= half else _NOTHING
    low, high = (-half - o) / d, (half - o) / d
    return (min(low, high), max(low, high))


@compiled
def _both(first: Span, second: Span) -> Span:
    """Intersection of two spans."""
    return (max(first[0], second[0]), min(first[1], second[1]))


@compiled
def _sphere(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, radius: float) -> Span:
    b = ox * dx + oy * dy + oz * dz
    return _below(dx * dx + dy * dy + dz * dz, b, ox * ox + oy * oy + oz * oz - radius * radius)


@compiled
def _cone(
    ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, low: float, high: float, half: float
) -> Span:
    """Frustum of radius `low` at ``z = -half`` and `high` at ``z = half``; equal radii make a cylinder."""
    slope = (low - high) / (2.0 * half)
    radius = 0.5 * (low + high) - slope * oz
    shrink = slope * dz  # the radius at t is radius - shrink t
    a = dx * dx + dy * dy - shrink * shrink
    b = ox * dx + oy * dy + shrink * radius
    c = ox * ox + oy * oy - radius * radius
    caps = _slab(oz, dz, half)
    if a > 0.0:
        return _both(_below(a, b, c), caps)
    if a == 0.0:
        if b == 0.0:
            return caps if c <= 0.0 else _NOTHING
        side = (-math.inf, -c / (2.0 * b)) if b > 0.0 else (-c / (2.0 * b), math.inf)
        return _both(side, caps)
    # The line is steeper than the side: inside are two half-lines, one per nappe; the radius grows along one.
    outside = _below(-a, -b, -c)
    if outside[0] > outside[1]:
        return caps
    return _both((outside[1], math.inf) if shrink < 0.0 else (-math.inf, outside[0]), caps)


@compiled
def _capsule(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, radius: float, half: float) -> Span:
    """Everything within `radius` of the axis from ``-half`` to ``half``: convex, so its parts' hull along the line."""
    low, high = _cone(ox, oy, oz, dx, dy, dz, radius, radius, half) if half > 0.0 else _NOTHING
    if low > high:
        low, high = _NOTHING
    for end in (-half, half):
        enter, leave = _sphere(ox, oy, oz - end, dx, dy, dz, radius)
        if enter <= leave:
            low, high = min(low, enter), max(high, leave)
    return (low, high)


@compiled
def _value(c4: float, c2: float, c1: float, c0: float, s: float) -> float:
    """``c4 s^4 + c2 s^2 + c1 s + c0``."""
    return ((c4 * s * s + c2) * s + c1) * s + c0


@compiled
def _slope(c4: float, c2: float, c1: float, s: float) -> float:
    """Derivative of `_value`."""
    return (4.0 * c4 * s * s + 2.0 * c2) * s + c1


@compiled
def _bracketed(c4: float, c2: float, c1: float, c0: float, low: float, high: float, turning: bool) -> float:
    """Root of `_value` (or of its derivative, where `turning`) in a bracket with a change of sign: safe Newton."""
    rises = (_slope(c4, c2, c1, high) if turning else _value(c4, c2, c1, c0, high)) > 0.0
    s = 0.5 * (low + high)
    for _ in range(_NEWTON_STEPS):
        if turning:
            value, slope = _slope(c4, c2, c1, s), 12.0 * c4 * s * s + 2.0 * c2
        else:
            value, slope = _value(c4, c2, c1, c0, s), _slope(c4, c2, c1, s)
        if (value > 0.0) == rises:
            high = s
        else:
            low = s
        new = s - value / slope if slope != 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - s) <= 1e-15 * (abs(new) + abs(s)) or new in (low, high):
            return new
        s = new
    return s


@compiled
def _torus(
    ox: float,
    oy: float,
    oz: float,
    dx: float,
    dy: float,
    dz: float,
    ring: float,
    tube: float,
    out: NDArray[np.float64],
) -> int:
    """Ring of radius `ring` about z, of a tube of radius `tube`; `o` is the line's point nearest to the origin.

    With unit direction and arc length s the surface is the quartic ``(s^2 + k)^2 = 4 ring^2 rho^2(s)``. Its turning
    points split the line into pieces that hold one crossing each.
    """
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    ux, uy = dx / length, dy / length
    away = ox * ox + oy * oy + oz * oz
    reach = (ring + tube) ** 2 - away
    if reach <= 0.0:
        return 0
    k = away + ring * ring - tube * tube
    c2 = 2.0 * k - 4.0 * ring * ring * (ux * ux + uy * uy)
    c1 = -8.0 * ring * ring * (ox * ux + oy * uy)
    c0 = k * k - 4.0 * ring * ring * (ox * ox + oy * oy)
    end = math.sqrt(reach) * (1.0 + 1e-9) + 1e-12 * ring
    bend = math.sqrt(-c2 / 6.0) if c2 < 0.0 else 0.0
    count = 0
    start = -end
    before = _value(1.0, c2, c1, c0, start)
    low = -end
    # Pieces between the bends of the curve hold one turning point each, pieces between turning points one crossing.
    for piece in range(4):
        if piece < 3:
            high = min(max((-bend, bend, end)[piece], low), end)
            if (_slope(1.0, c2, c1, low) > 0.0) == (_slope(1.0, c2, c1, high) > 0.0):
                low = high
                continue
            stop = _bracketed(1.0, c2, c1, c0, low, high, True)
            low = high
        else:
            stop = end
        after = _value(1.0, c2, c1, c0, stop)
        if (before > 0.0) != (after > 0.0) and count < 4:
            out[count] = _bracketed(1.0, c2, c1, c0, start, stop, False) / length
            count += 1
        start, before = stop, after
    return count - count % 2


@compiled
def crossings(
    kind: int,
    size: Size,
    ox: float,
    oy: float,
    oz: float,
    dx: float,
    dy: float,
    dz: float,
    out: NDArray[np.float64],
) -> int:
    """Write the crossings of a whole line with an analytic shape into `out` (4,), in order; return their number.

    `size` holds: sphere (radius); box (three half sides); cone and cylinder (low radius, high radius, half height);
    capsule (radius, half length of its axis); torus (ring radius, tube radius); a plane z = 0 needs none.
    """
    if kind == PLANE:
        if dz == 0.0:
            return 0
        out[0] = -oz / dz
        return 1
    # From the point nearest to the shape's centre: far away, the differences of large squares would cancel.
    shift = -(ox * dx + oy * dy + oz * dz) / (dx * dx + dy * dy + dz * dz)
    ox, oy, oz = ox + shift * dx, oy + shift * dy, oz + shift * dz
    if kind == TORUS:
        count = _torus(ox, oy, oz, dx, dy, dz, size[0], size[1], out)
        for i in range(count):
            out[i] += shift
        return count
    if kind == SPHERE:
        span = _sphere(ox, oy, oz, dx, dy, dz, size[0])
    elif kind == BOX:
        span = _both(_both(_slab(ox, dx, size[0]), _slab(oy, dy, size[1])), _slab(oz, dz, size[2]))
    elif kind == CONE:
        span = _cone(ox, oy, oz, dx, dy, dz, size[0], size[1], size[2])
    else:
        span = _capsule(ox, oy, oz, dx, dy, dz, size[0], size[1])
    if not span[0] < span[1]:
        return 0
    out[0], out[1] = span[0] + shift, span[1] + shift
    return 2


@compiled
def normal(kind: int, size: Size, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Outward normal, of any length, at a point of the surface of an analytic shape."""
    if kind == SPHERE:
        return (x, y, z)
    if kind == BOX:
        gap_x, gap_y, gap_z = size[0] - abs(x), size[1] - abs(y), size[2] - abs(z)
        if gap_x <= gap_y and gap_x <= gap_z:
            return (math.copysign(1.0, x), 0.0, 0.0)
        if gap_y <= gap_z:
            return (0.0, math.copysign(1.0, y), 0.0)
        return (0.0, 0.0, math.copysign(1.0, z))
    across = math.hypot(x, y)
    if kind == CONE:
        slope = (size[0] - size[1]) / (2.0 * size[2])
        side_gap = abs(0.5 * (size[0] + size[1]) - slope * z - across) / math.hypot(1.0, slope)
        if across == 0.0 or abs(size[2] - abs(z)) < side_gap:
            return (0.0, 0.0, math.copysign(1.0, z))
        return (x / across, y / across, slope)
    if kind == CAPSULE:
        return (x, y, z - min(max(z, -size[1]), size[1]))
    if kind == TORUS and across > 0.0:
        return (x - size[0] * x / across, y - size[0] * y / across, z)
    return (0.0, 0.0, 1.0)
