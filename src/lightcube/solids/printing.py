"""Whether a body can be printed and stand: how thick its walls are, and where its weight lies over its foot."""

import math
from dataclasses import dataclass

import numpy as np

from lightcube.solids.carving import landed
from lightcube.solids.mesh import Mesh
from lightcube.solids.shape import Shape

#: Walls are told to this part of a voxel, and what is so far beyond a ball's reach counts as reached.
_FINE, _SLACK = 0.25, 0.75
#: What is so near to the ground that a body stands on it, mm.
_FOOT_MM = 0.5
#: Thin places that are listed, at most.
_LISTED = 5


def thickest_wall_mm(shape: Shape, lost: float = 0.005) -> float:
    """How thick walls can be: what a ball of that size reaches, and hangs together, casts nearly all shadows still.

    All but the part `lost` of them, of which corners that no ball reaches are most; 0 where even voxels lose more.
    """
    from scipy import ndimage  # here: whoever prints nothing does without

    box = _box(shape)
    inside = np.pad(shape.inside[box], 1)
    deep = ndimage.distance_transform_edt(inside)
    whole = np.count_nonzero(landed(shape.inside, shape))

    def keeps(radius: float) -> bool:
        labels, count = ndimage.label(deep >= radius)
        if not count:
            return False
        largest = labels == 1 + int(np.argmax(np.bincount(labels.ravel())[1:]))
        opened = np.zeros_like(shape.inside)
        opened[box] = (inside & (ndimage.distance_transform_edt(~largest) <= radius + _SLACK))[1:-1, 1:-1, 1:-1]
        return int(np.count_nonzero(landed(opened, shape))) >= (1 - lost) * int(whole)

    low, high = 0, math.ceil(float(deep.max()) / _FINE)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if keeps(middle * _FINE) else (low, middle)
    # so deep a voxel is that far from the first one outside, which begins half a voxel before its middle
    return max(2 * low * _FINE - 1, 0.0) * shape.grid.voxel_mm


def _box(shape: Shape) -> tuple[slice, slice, slice]:
    """The part of the block that a body fills."""
    z, y, x = (slice(int(each.min()), int(each.max()) + 1) for each in np.nonzero(shape.inside))
    return z, y, x


@dataclass(frozen=True)
class Thin:
    """Where a body is thinner than walls are to be.

    Parameters
    ----------
    share
        Which part of its volume no ball of that width inside of it reaches.
    places_mm
        The middles ``(x, y, z)`` of the largest such parts, around the block's middle, and the volume of each, mm³.
    """

    share: float
    places_mm: tuple[tuple[tuple[float, float, float], float], ...]


def thin_places(shape: Shape, wall_mm: float) -> Thin:
    """What of a body no ball of `wall_mm` reaches that stays inside of it, but for its edges.

    Edges and corners, which no ball reaches, count where they are further than `_SLACK` voxels from one.
    """
    from scipy import ndimage

    box = _box(shape)
    inside = np.pad(shape.inside[box], 1)
    radius = wall_mm / 2 / shape.grid.voxel_mm + 0.5  # the first voxel outside begins half a voxel before its middle
    core = ndimage.distance_transform_edt(inside) >= radius - _FINE
    near = ndimage.distance_transform_edt(~core) if np.any(core) else np.full(inside.shape, np.inf)
    left = (inside & (near > radius + _SLACK))[1:-1, 1:-1, 1:-1]
    labels, count = ndimage.label(left, np.ones((3, 3, 3)))
    sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
    largest = [int(number) + 1 for number in np.argsort(-sizes, kind="stable")[:_LISTED]]
    middles = ndimage.center_of_mass(left, labels, largest)
    halves = (np.array(shape.grid.shape) - 1) / 2 - [each.start for each in box]
    sides = shape.grid.sides_mm
    voxel_mm3 = float(np.prod(sides))
    places = []
    for number, middle in zip(largest, middles, strict=True):
        x, y, z = ((np.array(middle) - halves)[::-1] * sides).tolist()
        places.append(((x, y, z), float(sizes[number - 1]) * voxel_mm3))
    return Thin(int(sizes.sum()) / max(int(np.count_nonzero(shape.inside)), 1), tuple(places))


def stands(mesh: Mesh) -> bool:
    """Whether a body's weight lies over what it stands on: it does not tip over on a level table."""
    from scipy.spatial import ConvexHull, QhullError

    corners = mesh.vertices_mm
    foot = corners[corners[:, 2] <= corners[:, 2].min() + _FOOT_MM, :2]
    middle = _centre_mm(mesh)[:2]
    try:
        sides = ConvexHull(foot).equations
    except (QhullError, ValueError):
        return False  # it stands on a line or a point
    return bool(np.all(sides[:, :2] @ middle + sides[:, 2] <= 0))


def _centre_mm(mesh: Mesh) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """The centre of mass ``(x, y, z)`` of what a closed mesh holds, by tetrahedra from its first corner."""
    start = mesh.vertices_mm[0]
    a, b, c = (mesh.vertices_mm - start)[mesh.faces.T]
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    centre: np.ndarray[tuple[int], np.dtype[np.float64]] = start + volumes @ (a + b + c) / 4 / volumes.sum()
    return centre
