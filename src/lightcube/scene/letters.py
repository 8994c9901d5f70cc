"""Text as a closed mesh: outlines of the built-in font, cut into triangles and extruded."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from skimage import measure

from lightcube.errors import InputError
from lightcube.scene.polygons import Polygon, area, triangulated

#: Size at which letters are drawn before they are traced, and how far their outline may be moved, in pixels.
_DRAWN, _TOLERANCE = 160, 0.25


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
