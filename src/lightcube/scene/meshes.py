"""Triangle meshes: checked, closed, and sorted into a tree of boxes."""

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError

#: A leaf of the tree holds at most so many triangles.
_LEAF = 4


class DoubtfulMesh(UserWarning):
    """A mesh may not be what is meant: it is open, or not all that its file holds could be read."""


def tidy(triangles: NDArray[np.floating], name: str = "mesh") -> NDArray[np.float64]:
    """Triangles ``(n, 3, 3)`` with corners that nearly coincide made equal.

    Triangles that are left with fewer than three corners are taken out.

    Raises
    ------
    InputError
        Where the shape is wrong, a number is not finite, or nothing is left.
    """
    corners = np.asarray(triangles, dtype=np.float64)
    if corners.ndim != 3 or corners.shape[1:] != (3, 3) or len(corners) == 0:
        raise InputError(f"{name} holds no triangles: give a mesh of at least one")
    if not np.all(np.isfinite(corners)) or np.max(np.abs(corners)) > 1e6:
        raise InputError(f"{name} holds corners that are not finite or beyond a million: mend or shrink the mesh")
    low = corners.reshape(-1, 3).min(axis=0)
    step = float(np.max(corners.reshape(-1, 3).max(axis=0) - low)) * 1e-7
    if step == 0:
        raise InputError(f"{name} is a single point: give a mesh with an extent")
    _, first, which = np.unique(
        np.rint((corners.reshape(-1, 3) - low) / step), axis=0, return_index=True, return_inverse=True
    )
    merged = corners.reshape(-1, 3)[first][which.reshape(-1)].reshape(-1, 3, 3)
    distinct = np.all(np.any(merged != np.roll(merged, 1, axis=1), axis=2), axis=1)
    if not np.any(distinct):
        raise InputError(f"{name} holds no triangle with three distinct corners: give a mesh with an extent")
    return np.ascontiguousarray(merged[distinct])


def is_closed(triangles: NDArray[np.float64]) -> bool:
    """Whether every edge of ``(n, 3, 3)`` is run through as often one way as the other."""
    _, corner = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    tail = corner.reshape(-1, 3).astype(np.int64)
    head = np.roll(tail, -1, axis=1)
    count = int(tail.max()) + 1
    forth = np.sort((tail * count + head).reshape(-1))
    back = np.sort((head * count + tail).reshape(-1))
    return bool(np.array_equal(forth, back))


def volume(triangles: NDArray[np.float64]) -> float:
    """Volume inside a closed mesh; negative where its normals point inward."""
    a, b, c = (triangles[:, k] - triangles[0, 0] for k in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6)


def outward(triangles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a closed mesh with its normals pointing outward."""
    return triangles if volume(triangles) >= 0 else np.ascontiguousarray(triangles[:, ::-1])


def tree(triangles: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Sort triangles into a tree of boxes by halving at the median of the longest side.

    Returns
    -------
    The triangles in the tree's order, the boxes ``(nodes, 6)`` (low and high corner) in depth-first order, and the
    links ``(nodes, 3)``: the node after this one's branch, first and last-plus-one triangle (equal but in leaves).
    """
    centres = triangles.mean(axis=1)
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    order: list[NDArray[np.intp]] = []
    boxes: list[NDArray[np.float64]] = []
    links: list[list[int]] = []
    placed = 0

    def branch(members: NDArray[np.intp]) -> None:
        nonlocal placed
        node = len(boxes)
        boxes.append(np.concatenate([low[members].min(axis=0), high[members].max(axis=0)]))
        links.append([0, placed, placed])
        if len(members) <= _LEAF:
            order.append(members)
            placed += len(members)
            links[node][2] = placed
        else:
            axis = int(np.argmax(np.ptp(centres[members], axis=0)))
            half = len(members) // 2
            sorted_members = members[np.argpartition(centres[members, axis], half)]
            branch(sorted_members[:half])
            branch(sorted_members[half:])
        links[node][0] = len(boxes)

    branch(np.arange(len(triangles)))
    return triangles[np.concatenate(order)], np.array(boxes), np.array(links, dtype=np.int64)
