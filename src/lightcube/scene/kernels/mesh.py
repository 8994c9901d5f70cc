"""Lines against triangle meshes: a tree of boxes in depth-first order, and a watertight triangle test.

Each node holds the index of the node to go on with when its box is missed (``skip``); leaves hold triangles.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled


@compiled
def _box_hit(
    boxes: NDArray[np.float64],
    k: int,
    ox: float,
    oy: float,
    oz: float,
    dx: float,
    dy: float,
    dz: float,
    near: float,
    far: float,
) -> bool:
    """Whether the line meets box k ``(x0, y0, z0, x1, y1, z1)`` between `near` and `far`."""
    for o, d, low, high in (
        (ox, dx, boxes[k, 0], boxes[k, 3]),
        (oy, dy, boxes[k, 1], boxes[k, 4]),
        (oz, dz, boxes[k, 2], boxes[k, 5]),
    ):
        if d == 0.0:
            if o < low or o > high:
                return False
            continue
        first, second = (low - o) / d, (high - o) / d
        near, far = max(near, min(first, second)), min(far, max(first, second))
    # Rounding must not lose a triangle that lies in the box's face.
    return near <= far + 1e-12 * (abs(near) + abs(far))


@compiled
def _edge(ax: float, ay: float, bx: float, by: float) -> float:
    """Twice the area of (origin, a, b), and where that is 0 its sign for an origin moved by (e, e^2), e -> 0+.

    One rule for all triangles: a line through a shared edge or corner counts as inside exactly one of them.
    """
    area = ax * by - ay * bx
    if area != 0.0:
        return area
    if ay != by:
        return math.copysign(5e-324, ay - by)
    return math.copysign(5e-324, bx - ax) if bx != ax else 0.0


@compiled
def _triangle(
    corners: NDArray[np.float64], k: int, ox: float, oy: float, oz: float, sx: float, sy: float, depth: float, axis: int
) -> tuple[float, int]:
    """Where a line crosses triangle `k` of ``(n, 3, 3)``, and in which sense: 1 leaving, -1 entering, 0 not at all.

    The line is sheared onto `axis` (the largest component `depth` of its direction), where the test is 2-D. After
    S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, with a rule for ties.
    """
    kx, ky = (axis + 1) % 3, (axis + 2) % 3
    o = (ox, oy, oz)
    az, bz, cz = corners[k, 0, axis] - o[axis], corners[k, 1, axis] - o[axis], corners[k, 2, axis] - o[axis]
    ax, ay = corners[k, 0, kx] - o[kx] - sx * az, corners[k, 0, ky] - o[ky] - sy * az
    bx, by = corners[k, 1, kx] - o[kx] - sx * bz, corners[k, 1, ky] - o[ky] - sy * bz
    cx, cy = corners[k, 2, kx] - o[kx] - sx * cz, corners[k, 2, ky] - o[ky] - sy * cz
    u, v, w = _edge(bx, by, cx, cy), _edge(cx, cy, ax, ay), _edge(ax, ay, bx, by)
    if (u <= 0.0 or v <= 0.0 or w <= 0.0) and (u >= 0.0 or v >= 0.0 or w >= 0.0):
        return (math.inf, 0)
    total = u + v + w
    if abs(total) < 1e-300:
        return (math.inf, 0)
    return ((u / total * az + v / total * bz + w / total * cz) / depth, 1 if (total > 0.0) == (depth > 0.0) else -1)


@compiled
def _sheared(dx: float, dy: float, dz: float) -> tuple[float, float, float, int]:
    """``(sx, sy, depth, axis)`` of a direction for `_triangle`."""
    if abs(dx) >= abs(dy) and abs(dx) >= abs(dz):
        return (dy / dx, dz / dx, dx, 0)
    if abs(dy) >= abs(dz):
        return (dz / dy, dx / dy, dy, 1)
    return (dx / dz, dy / dz, dz, 2)


@compiled
def mesh_nearest(
    triangles: NDArray[np.float64],
    boxes: NDArray[np.float64],
    links: NDArray[np.int64],
    root: int,
    ox: float,
    oy: float,
    oz: float,
    dx: float,
    dy: float,
    dz: float,
    near: float,
    far: float,
) -> tuple[float, int]:
    """``(t, triangle)`` of the first crossing with ``near < t < far``; ``(inf, -1)`` where there is none."""
    sx, sy, depth, axis = _sheared(dx, dy, dz)
    best, found = far, -1
    node, end = root, links[root, 0]
    while node < end:
        if not _box_hit(boxes, node, ox, oy, oz, dx, dy, dz, near, best):
            node = links[node, 0]
            continue
        for i in range(links[node, 1], links[node, 2]):
            t, sense = _triangle(triangles, i, ox, oy, oz, sx, sy, depth, axis)
            if sense != 0 and near < t < best:
                best, found = t, i
        node += 1
    return (best if found >= 0 else math.inf, found)


@compiled
def mesh_inside(
    triangles: NDArray[np.float64],
    boxes: NDArray[np.float64],
    links: NDArray[np.int64],
    root: int,
    ox: float,
    oy: float,
    oz: float,
    dx: float,
    dy: float,
    dz: float,
    near: float,
    far: float,
) -> float:
    """How much of ``near < t < far`` (both finite) lies inside a closed mesh whose normals point outward.

    The sum of (leave - enter), each held to the range, needs no order; parts that overlap count twice.
    """
    sx, sy, depth, axis = _sheared(dx, dy, dz)
    total = 0.0
    node, end = root, links[root, 0]
    while node < end:
        if not _box_hit(boxes, node, ox, oy, oz, dx, dy, dz, near, math.inf):
            node = links[node, 0]
            continue
        for i in range(links[node, 1], links[node, 2]):
            t, sense = _triangle(triangles, i, ox, oy, oz, sx, sy, depth, axis)
            if sense != 0:
                total += sense * (min(max(t, near), far) - near)
        node += 1
    return total
