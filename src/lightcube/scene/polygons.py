"""Polygons cut into triangles: outlines with holes, and the faces of meshes."""

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError

#: Corners ``(n, 2)`` in order, the first one not repeated.
Polygon = NDArray[np.float64]

#: A face is cut as a fan where each triangle has at least this share of its area, else ear by ear.
_LEAST_SHARE = 1e-9


def area(ring: Polygon) -> float:
    """Area inside a ring; negative where it runs clockwise."""
    return float(0.5 * np.sum(_cross(ring, np.roll(ring, -1, axis=0))))


def _cross(a: Polygon, b: Polygon) -> NDArray[np.float64]:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def triangulated(outer: Polygon, holes: list[Polygon]) -> NDArray[np.float64]:
    """Triangles ``(n, 3, 2)``, counter-clockwise, of a polygon with holes: holes are cut open, then ears cut off.

    `outer` runs counter-clockwise, `holes` clockwise; every edge of theirs is an edge of one triangle.
    """
    ring = outer
    waiting = sorted(holes, key=lambda hole: -float(hole[:, 0].max()))
    while waiting:
        ring = _joined(ring, waiting.pop(0), waiting)
    return ring[ears(ring)]


def _joined(ring: Polygon, hole: Polygon, others: list[Polygon]) -> Polygon:
    """One ring of `ring` and `hole`, by a cut to and fro along the shortest straight line that crosses no edge."""
    rings = [ring, hole, *others]
    tails = np.concatenate(rings)
    heads = np.concatenate([np.roll(one, -1, axis=0) for one in rings])
    gaps = np.hypot(*(ring[:, None] - hole[None]).transpose(2, 0, 1))
    for pair in np.argsort(gaps, axis=None):
        i, j = np.unravel_index(pair, gaps.shape)
        if _free(ring[i], hole[j], tails, heads) and _inward(ring, int(i), hole[j]):
            return np.concatenate([ring[: i + 1], np.roll(hole, -j, axis=0), hole[j : j + 1], ring[i:]])
    raise InputError("an outline crosses itself and cannot be filled: use another text")


def _inward(ring: Polygon, i: int, target: Polygon) -> bool:
    """Whether the way from corner `i` of a counter-clockwise ring to `target` starts on the ring's inner side."""
    corner = ring[i]
    before, after, way = ring[i - 1] - corner, ring[(i + 1) % len(ring)] - corner, target - corner
    if _cross(after, before) >= 0:
        return bool(_cross(after, way) > 0 and _cross(way, before) > 0)
    return not bool(_cross(before, way) >= 0 and _cross(way, after) >= 0)


def _free(a: Polygon, b: Polygon, tails: Polygon, heads: Polygon) -> bool:
    """Whether the line from `a` to `b` touches no edge but those that end in `a` or `b`."""
    ends = np.any([np.all(points == end, axis=1) for points in (tails, heads) for end in (a, b)], axis=0)
    tails, heads = tails[~ends], heads[~ends]
    across = _cross(b - a, tails - a) * _cross(b - a, heads - a) <= 0
    along = _cross(heads - tails, a - tails) * _cross(heads - tails, b - tails) <= 0
    return not bool(np.any(across & along))


def ears(ring: Polygon) -> NDArray[np.intp]:
    """Corners ``(n, 3)`` of the triangles of a counter-clockwise ring without holes; it may touch itself along cuts."""
    left = list(range(len(ring)))
    triangles = []
    while len(left) > 3:
        ear = _next_ear(ring, left)
        triangles.append([left[ear - 1], left[ear], left[(ear + 1) % len(left)]])
        del left[ear]
    triangles.append(left)
    return np.array(triangles, dtype=np.intp)


def cut_faces(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Triangles ``(n, 3, 3)`` of faces ``(faces, corners, 3)`` of a mesh, which need be neither convex nor quite flat.

    Every edge of a face is an edge of one of its triangles, so that what was closed stays closed.
    """
    count = corners.shape[1]
    if count == 3:
        return corners
    fan = np.array([[0, i, i + 1] for i in range(1, count - 1)], dtype=np.intp)
    normals = _normals(corners)
    parts = corners[:, fan]
    crosses = np.cross(parts[:, :, 1] - parts[:, :, 0], parts[:, :, 2] - parts[:, :, 0])
    shares = np.einsum("fti,fi->ft", crosses, normals)
    bad = ~np.all(shares > _LEAST_SHARE * np.sum(normals**2, axis=1)[:, None], axis=1)
    cut = [face[ears(_flat(face, normal))] for face, normal in zip(corners[bad], normals[bad], strict=True)]
    return np.concatenate([parts[~bad].reshape(-1, 3, 3), *cut])


def _normals(faces: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of the plane that fits each face best, twice as long as its area is large (M. Newell)."""
    spokes = faces - faces[:, :1]
    return np.asarray(np.cross(spokes, np.roll(spokes, -1, axis=1)).sum(axis=1))


def _flat(face: NDArray[np.float64], normal: NDArray[np.float64]) -> Polygon:
    """A face as it is seen against its normal, counter-clockwise."""
    least = np.zeros(3)
    least[np.argmin(np.abs(normal))] = 1.0
    right = np.cross(least, normal)
    up = np.cross(normal, right)
    lengths = np.maximum(np.linalg.norm([right, up], axis=1), 1e-300)
    return np.asarray((face - face[0]) @ (np.array([right, up]) / lengths[:, None]).T)


def _next_ear(ring: Polygon, left: list[int]) -> int:
    """Place in `left` of the convex corner with the widest triangle that holds no other corner."""
    points = ring[left]
    before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    areas = _cross(points - before, after - points)
    for ear in np.argsort(-_roundness(before, points, after, areas)):
        if areas[ear] <= 0:
            continue
        a, b, c = before[ear], points[ear], after[ear]
        inside = (_cross(b - a, points - a) >= 0) & (_cross(c - b, points - b) >= 0) & (_cross(a - c, points - c) >= 0)
        corner = np.any([np.all(points == p, axis=1) for p in (a, b, c)], axis=0)
        if not np.any(inside & ~corner):
            return int(ear)
    return int(np.argmax(areas))


def _roundness(a: Polygon, b: Polygon, c: Polygon, areas: NDArray[np.float64]) -> NDArray[np.float64]:
    """Area over the square of the perimeter: how far a triangle is from a sliver."""
    perimeter = sum(np.hypot(*(q - p).T) for p, q in ((a, b), (b, c), (c, a)))
    return np.asarray(areas / np.maximum(perimeter, 1e-300) ** 2)
