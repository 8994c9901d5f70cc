"""Text as a closed mesh: outlines of the built-in font, cut into triangles and extruded."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from skimage import measure

from lightcube.errors import InputError

#: Size at which letters are drawn before they are traced, and how far their outline may be moved, in pixels.
_DRAWN, _TOLERANCE = 160, 0.25

Polygon = NDArray[np.float64]


def text_mesh(text: str, height: float, depth: float) -> NDArray[np.float64]:
    """Closed mesh ``(n, 3, 3)`` of `text` in the x-z plane, centred, `depth` thick along y.

    `height` is that of the letter H. The letters are read from where y is negative, x to the right.

    Raises
    ------
    InputError
        Where the font does not know a letter, or there is nothing but spaces.
    """
    font = ImageFont.load_default(size=_DRAWN)
    # The font draws the same box for whatever it does not know.
    unknown = bytes(font.getmask("\uffff"))
    for letter in text:
        if letter != " " and bytes(font.getmask(letter)) == unknown:
            raise InputError(f"the built-in font has no letter {letter!r}: use another one")
    left, top, right, bottom = font.getbbox(text)
    image = Image.new("L", (int(right - left) + 8, int(bottom - top) + 8))
    ImageDraw.Draw(image).text((4 - left, 4 - top), text, font=font, fill=255)
    rings = outlines(np.asarray(image, dtype=np.float64) / 255)
    if not rings:
        raise InputError("there is nothing to see in a text of spaces: give it letters")
    corners = np.concatenate(rings)
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    capital = font.getbbox("H")
    unit = height / (capital[3] - capital[1])
    pieces = [extruded(outer, holes, depth / unit) for outer, holes in _nested(rings)]
    mesh = np.concatenate(pieces)
    mesh[..., [0, 2]] -= middle
    return np.asarray(mesh * unit)


def outlines(picture: NDArray[np.float64]) -> list[Polygon]:
    """Rings ``(corners, 2)`` (x right, z up; not repeated at the end) around what is above 0.5 in a picture.

    Rings run counter-clockwise around what is bright and clockwise around holes in it.
    """
    rings = []
    for contour in measure.find_contours(picture, 0.5):
        ring = measure.approximate_polygon(contour, _TOLERANCE)[:-1]
        if len(ring) >= 3:
            rings.append(np.column_stack([ring[:, 1], -ring[:, 0]]))
    if sum(area(ring) for ring in rings) < 0:
        rings = [ring[::-1] for ring in rings]
    return rings


def area(ring: Polygon) -> float:
    """Area inside a ring; negative where it runs clockwise."""
    return float(0.5 * np.sum(_cross(ring, np.roll(ring, -1, axis=0))))


def _cross(a: Polygon, b: Polygon) -> NDArray[np.float64]:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _contains(ring: Polygon, point: Polygon) -> bool:
    """Whether a point is inside a ring, by the parity of crossings to its right."""
    a, b = ring, np.roll(ring, -1, axis=0)
    straddles = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    rise = np.where(straddles, b[:, 1] - a[:, 1], 1.0)
    x = a[:, 0] + (point[1] - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
    return bool(np.count_nonzero(straddles & (x > point[0])) % 2)


def _nested(rings: list[Polygon]) -> list[tuple[Polygon, list[Polygon]]]:
    """Each outer ring with the holes whose nearest enclosing ring it is."""
    outers = sorted((ring for ring in rings if area(ring) > 0), key=area)
    holes: list[list[Polygon]] = [[] for _ in outers]
    for hole in rings:
        if area(hole) < 0:
            owner = next((i for i, outer in enumerate(outers) if _contains(outer, hole[0])), None)
            if owner is not None:
                holes[owner].append(hole)
    return list(zip(outers, holes, strict=True))


def extruded(outer: Polygon, holes: list[Polygon], depth: float) -> NDArray[np.float64]:
    """Closed mesh of a polygon with holes, from ``y = -depth / 2`` to ``depth / 2``, normals outward."""
    front = triangulated(outer, holes)

    def at(points: Polygon, y: float) -> NDArray[np.float64]:
        return np.stack([points[..., 0], np.full(points.shape[:-1], y), points[..., 1]], axis=-1)

    # Counter-clockwise in (x, z) faces -y.
    faces = [at(front, -depth / 2), at(front, depth / 2)[:, ::-1]]
    for ring in [outer, *holes]:
        a, b = ring, np.roll(ring, -1, axis=0)
        near_a, near_b, far_a, far_b = at(a, -depth / 2), at(b, -depth / 2), at(a, depth / 2), at(b, depth / 2)
        faces += [np.stack([near_a, far_a, far_b], axis=1), np.stack([near_a, far_b, near_b], axis=1)]
    return np.concatenate(faces)


def triangulated(outer: Polygon, holes: list[Polygon]) -> NDArray[np.float64]:
    """Triangles ``(n, 3, 2)``, counter-clockwise, of a polygon with holes: holes are cut open, then ears cut off.

    `outer` runs counter-clockwise, `holes` clockwise; every edge of theirs is an edge of one triangle.
    """
    ring = outer
    waiting = sorted(holes, key=lambda hole: -float(hole[:, 0].max()))
    while waiting:
        ring = _joined(ring, waiting.pop(0), waiting)
    return _ears(ring)


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


def _ears(ring: Polygon) -> NDArray[np.float64]:
    """Triangles of a counter-clockwise ring without holes; it may touch itself along cuts."""
    left = list(range(len(ring)))
    triangles = []
    while len(left) > 3:
        ear = _next_ear(ring, left)
        triangles.append(ring[[left[ear - 1], left[ear], left[(ear + 1) % len(left)]]])
        del left[ear]
    triangles.append(ring[left])
    return np.array(triangles)


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
