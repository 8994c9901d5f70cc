"""A camera, and a canvas that knows how far away everything on it is.

Lengths are mm in the room's axes. Depth is measured along the camera's axis, and kept as its inverse: over a plane,
and along a line, that is linear in the picture.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lightcube.errors import InputError
from lightcube.optics.views import unit

Vector = tuple[float, float, float]
Reals = NDArray[np.float64]
Floats = NDArray[np.float32]
Region = tuple[slice, slice]

#: Samples along the side of a pixel.
FINE = 2
#: Lines are drawn over what they lie on: so much nearer, relatively.
_LIFT = 2e-3


@dataclass(frozen=True)
class Camera:
    """An eye that looks at a point.

    Parameters
    ----------
    eye, target
        Where it is and where it looks, mm.
    up
        What is up in its picture.
    field_deg
        Angle that the picture's width spans, degrees.
    size
        Rows and columns of the picture.

    Raises
    ------
    InputError
        Where it looks nowhere, or a number is out of its range.
    """

    eye: Vector
    target: Vector
    up: Vector
    field_deg: float
    size: tuple[int, int]

    def __post_init__(self) -> None:
        way = np.subtract(self.target, self.eye)
        if not np.all(np.isfinite([*way, *self.up])) or not np.linalg.norm(np.cross(way, self.up)) > 0:
            raise InputError(
                f"a camera at {self.eye} cannot look at {self.target} with {self.up} up: give it another eye or up"
            )
        if not 0 < self.field_deg < 180:
            raise InputError(f"a camera's field must lie between 0 and 180 degrees, not {self.field_deg:g}")
        if min(self.size) < 1:
            raise InputError(f"a camera's picture has at least 1 row and 1 column, not {self.size}")

    @property
    def axes(self) -> Reals:
        """``(3, 3)``: unit vectors to the right in its picture, up, and ahead."""
        ahead = unit(np.subtract(self.target, self.eye))
        right = unit(np.cross(ahead, self.up))
        return np.stack([right, np.cross(right, ahead), ahead])

    @property
    def spread(self) -> tuple[float, float]:
        """Half the picture's width and height where it is 1 away."""
        across = math.tan(math.radians(self.field_deg) / 2)
        return across, across * self.size[0] / self.size[1]


class Canvas:
    """The samples of a picture.

    Attributes
    ----------
    light
        ``(row, column, 3)`` linear light.
    near
        ``(row, column)``: inverse depth (1/mm) of the solid thing that is seen there; 0 = none.
    glass
        ``(row, column)``: inverse depth at which the ray enters the cube; 0 = it does not.
    beyond
        ``(row, column)``: inverse depth at which it leaves the cube.
    """

    camera: Camera
    axes: Reals
    eye: Reals
    focal: float
    light: Floats
    near: Floats
    glass: Floats
    beyond: Floats

    def __init__(self, camera: Camera) -> None:
        rows, columns = (FINE * count for count in camera.size)
        self.camera, self.axes, self.eye = camera, camera.axes, np.array(camera.eye)
        self.focal = columns / 2 / camera.spread[0]
        self.light = np.zeros((rows, columns, 3), np.float32)
        self.near = np.zeros((rows, columns), np.float32)
        self.glass = np.zeros((rows, columns), np.float32)
        self.beyond = np.zeros((rows, columns), np.float32)

    def copy(self) -> "Canvas":
        """Another one with the same on it."""
        other = Canvas(self.camera)
        for name in ("light", "near", "glass", "beyond"):
            getattr(other, name)[...] = getattr(self, name)
        return other

    def picture(self) -> Floats:
        """``(row, column, 3)``: the mean of each pixel's samples, light above white cut off."""
        seen = np.minimum(self.light, 1)
        total = sum(seen[i::FINE, j::FINE] for i in range(FINE) for j in range(FINE))
        return np.asarray(total / np.float32(FINE**2), np.float32)

    @property
    def whole(self) -> Region:
        """All of it."""
        return slice(0, self.near.shape[0]), slice(0, self.near.shape[1])

    def seen(self, points: ArrayLike) -> Reals:
        """``(points, 3)``: column, row (the first sample lies at 0.5) and inverse depth, which is 0 behind the eye."""
        right, up, ahead = ((np.atleast_2d(points) - self.eye) @ self.axes.T).T
        near = np.where(ahead > 0, 1 / np.where(ahead > 0, ahead, 1), 0.0)
        rows, columns = self.near.shape
        return np.stack([columns / 2 + self.focal * right * near, rows / 2 - self.focal * up * near, near], axis=1)

    def around(self, points: ArrayLike, margin: float = 1.0) -> Region:
        """The region that holds what lies between the points, and so many samples more."""
        places = self.seen(points)
        if np.any(places[:, 2] == 0):
            return self.whole
        low, high = places[:, :2].min(axis=0) - margin, places[:, :2].max(axis=0) + margin
        (left, top), (right, bottom) = (
            np.clip(each, 0, self.near.shape[::-1]).astype(int) for each in (np.floor(low), np.ceil(high))
        )
        return slice(top, bottom), slice(left, right)

    def along(self, vector: ArrayLike, region: Region) -> Floats:
        """``(row, column)``: each sample's ray, 1 deep, times a vector."""
        right, up, ahead = self.axes @ np.asarray(vector, np.float64)
        rows, columns = (np.arange(each.start, each.stop) + 0.5 for each in region)
        height, width = self.near.shape
        along = ahead + up * (height / 2 - rows[:, None]) / self.focal + right * (columns - width / 2) / self.focal
        return along.astype(np.float32)

    def ways(self, region: Region, every: int = 1) -> Reals:
        """``(row, column, 3)``: rays through the middles of a region's pixels, or of squares of `every` x `every`."""
        right, up, ahead = self.axes
        height, width = self.near.shape
        side = every * FINE
        rows, columns = (np.arange(each.start, each.stop, side) + side / 2 for each in region)
        aside = right * ((columns - width / 2) / self.focal)[:, None]
        return np.asarray(ahead + aside + up * ((height / 2 - rows) / self.focal)[:, None, None])

    def plane(self, middle: ArrayLike, right: Reals, down: Reals, region: Region) -> tuple[Floats, Floats, Floats]:
        """Inverse depth of a plane (not above 0 where the ray never meets it), and how many steps off its middle.

        `right` and `down` stand upright on each other; their lengths are one step.
        """
        normal = np.cross(right, down)
        way = np.asarray(middle, np.float64) - self.eye
        height = float(way @ normal)
        if abs(height) < 1e-9 * float(np.linalg.norm(way) * np.linalg.norm(normal)):  # seen edge-on
            nothing = np.zeros_like(self.near[region])
            return nothing, nothing, nothing
        near = self.along(normal / height, region)
        far = np.float32(1) / np.where(near > 0, near, np.float32(np.inf))
        across, below = (
            np.asarray(far * self.along(step / (step @ step), region) - way @ step / (step @ step), np.float32)
            for step in (right, down)
        )
        return near, across, below

    def blend(self, region: Region, near: Floats | float, light: ArrayLike, part: Floats, front: bool | None) -> None:
        """Lay light over the samples of a region, where nothing solid hides it.

        Only what lies before the glass if `front`, only what lies behind it if not, either if it is None.
        """
        there = self.shown(self.near[region], self.glass[region], near, front)
        part = np.where(there, part, np.float32(0))[..., None]
        self.light[region] += part * (np.asarray(light, np.float32) - self.light[region])

    def line(
        self, points: ArrayLike, light: ArrayLike, parts: tuple[float, float], width: float, front: bool | None
    ) -> None:
        """Draw a straight line between two points, `width` pixels wide, as `blend` lays it over.

        `parts` is how strong it is at either end.
        """
        kept = self._ahead(np.array(points, np.float64))
        if kept is None:
            return
        ends = np.column_stack([self.seen(kept), parts])
        steep = int(abs(ends[1, 1] - ends[0, 1]) > abs(ends[1, 0] - ends[0, 0]))
        ends = ends[np.argsort(ends[:, steep])]
        first, last = ends[:, steep]
        most = self.near.shape[1 - steep]
        steps = np.arange(max(math.ceil(first - 0.5), 0), min(math.floor(last - 0.5) + 1, most))
        if not len(steps):
            return
        along = ((steps + 0.5 - first) / (last - first))[:, None]
        middle = ends[0, 1 - steep] + along * (ends[1, 1 - steep] - ends[0, 1 - steep])
        half = width * FINE / 2
        reach = math.ceil(half + 1) * 2
        beside = np.floor(middle).astype(int) + np.arange(-reach, reach + 1)
        slant = (last - first) / np.hypot(*(ends[1, :2] - ends[0, :2]))
        cover = np.clip(half + 0.5 - np.abs(beside + 0.5 - middle) * slant, 0, 1)
        inside = (cover > 0) & (beside >= 0) & (beside < self.near.shape[steep])
        place = np.broadcast_to(steps[:, None], inside.shape)[inside], beside[inside]
        rows, columns = place if steep else place[::-1]
        depths = np.broadcast_to(ends[0, 2] + along * (ends[1, 2] - ends[0, 2]), inside.shape)
        near = depths[inside].astype(np.float32)
        there = self.shown(self.near[rows, columns], self.glass[rows, columns], near, front)
        strength = cover * (ends[0, 3] + along * (ends[1, 3] - ends[0, 3]))
        laid = np.where(there, strength[inside], 0).astype(np.float32)[:, None]
        self.light[rows, columns] += laid * (np.asarray(light, np.float32) - self.light[rows, columns])

    def _ahead(self, points: Reals) -> Reals | None:
        """The part of a line that lies ahead of the eye, None where none does."""
        depth = (points - self.eye) @ self.axes[2]
        least = 1e-3 * float(np.abs(depth).max())
        if np.all(depth <= least):
            return None
        for i in (0, 1):
            if depth[i] < least:
                points[i] += (least - depth[i]) / (depth[1 - i] - depth[i]) * (points[1 - i] - points[i])
        return points

    @staticmethod
    def shown(solid: Floats, glass: Floats, near: Floats | float, front: bool | None) -> NDArray[np.bool_]:
        """Where something so near is seen: no solid thing is nearer, and it lies on the side of the glass asked for."""
        lifted = np.float32(1 + _LIFT) * near
        seen = (lifted >= solid) & (lifted > 0)
        return np.asarray(seen if front is None else seen & ((lifted >= glass) == front))


def fitting(points: Reals, axes: Reals, spread: tuple[float, float], margin: float) -> Reals:
    """The nearest eye with these axes that sees all points, in the middle of its picture.

    `margin` is the part of the picture's width and height that stays free on each side. To see p to the right of it,
    an eye at e needs ``p.r - s p.f <= e.r - s e.f``, with r to the right, f ahead, and s the spread; and so on.
    """
    right, up, ahead = axes @ points.T
    beside, back = [], []
    for along, half in ((right, spread[0]), (up, spread[1])):
        free = half * (1 - 2 * margin)
        most, least = float(np.max(along - free * ahead)), float(np.max(-along - free * ahead))
        beside.append((most - least) / 2)
        back.append(-(most + least) / (2 * free))
    return np.asarray(np.array([*beside, min(back)]) @ axes)
