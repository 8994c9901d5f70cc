"""A loop that takes voxels away while every pixel of every shadow keeps enough of them."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled

Array = NDArray[Any]


@compiled(error_model="numpy")
def land(matrices: Array, view: int, z: int, y: int, x: int, shape: tuple[int, int]) -> int:
    """The pixel, counted along rows, that a voxel's middle lands on in a view; -1 beside the picture."""
    w = matrices[view, 2, 0] * z + matrices[view, 2, 1] * y + matrices[view, 2, 2] * x + matrices[view, 2, 3]
    across = matrices[view, 0, 0] * z + matrices[view, 0, 1] * y + matrices[view, 0, 2] * x + matrices[view, 0, 3]
    down = matrices[view, 1, 0] * z + matrices[view, 1, 1] * y + matrices[view, 1, 2] * x + matrices[view, 1, 3]
    row, column = math.floor(down / w + 0.5), math.floor(across / w + 0.5)
    if row < 0 or row >= shape[0] or column < 0 or column >= shape[1]:
        return -1
    return int(row * shape[1] + column)


@compiled
def count(solid: Array, matrices: Array, shape: tuple[int, int], counts: Array) -> None:
    """How many voxels of a solid with a margin of one land on each pixel.

    Parameters
    ----------
    counts
        ``(views, pixels)``, added to.
    """
    for z in range(1, solid.shape[0] - 1):
        for y in range(1, solid.shape[1] - 1):
            for x in range(1, solid.shape[2] - 1):
                if not solid[z, y, x]:
                    continue
                for view in range(len(matrices)):
                    at = land(matrices, view, z - 1, y - 1, x - 1, shape)
                    if at >= 0:
                        counts[view, at] += 1


@compiled
def hangs_together(solid: Array, z: int, y: int, x: int, near: Array, stack: Array) -> bool:
    """Whether a voxel's neighbours by faces hang together by faces among those that share a face or an edge with it.

    Then what is left stays in one piece without it. `near` ``(5, 5, 5)`` and `stack` ``(32, 3)`` are room.
    """
    count, first_z, first_y, first_x = 0, 0, 0, 0
    near[:] = 0
    for dz in range(-1, 2):
        for dy in range(-1, 2):
            for dx in range(-1, 2):
                apart = abs(dz) + abs(dy) + abs(dx)
                if 1 <= apart <= 2 and solid[z + dz, y + dy, x + dx]:
                    near[dz + 2, dy + 2, dx + 2] = 1
                    if apart == 1:
                        count += 1
                        first_z, first_y, first_x = dz + 2, dy + 2, dx + 2
    if count == 0:
        return False
    near[first_z, first_y, first_x] = 2
    stack[0, 0], stack[0, 1], stack[0, 2] = first_z, first_y, first_x
    top, met = 1, 1
    while top:
        top -= 1
        a, b, c = stack[top, 0], stack[top, 1], stack[top, 2]
        for side in range(6):
            step = 1 - 2 * (side % 2)
            i, j, k = a + step * (side // 2 == 0), b + step * (side // 2 == 1), c + step * (side // 2 == 2)
            if near[i, j, k] == 1:
                near[i, j, k] = 2
                stack[top, 0], stack[top, 1], stack[top, 2] = i, j, k
                top += 1
                met += abs(i - 2) + abs(j - 2) + abs(k - 2) == 1
    return met == count


@compiled
def carve(
    solid: Array, order: Array, matrices: Array, shape: tuple[int, int], deep: int, is_one_piece: bool, counts: Array
) -> int:
    """Take voxels away in an order while each pixel that one lands on keeps `deep`; returns how many went.

    Parameters
    ----------
    solid
        ``(nz + 2, ny + 2, nx + 2)`` with a margin of nothing, changed.
    order
        ``(voxels, 3)``: z, y, x in it.
    is_one_piece
        Whether none may go by which a piece would fall apart.
    counts
        ``(views, pixels)``, how many land on each, changed.
    """
    near, stack = np.zeros((5, 5, 5), np.uint8), np.empty((32, 3), np.int64)
    landed = np.empty(len(matrices), np.int64)
    gone = 0
    for number in range(len(order)):
        z, y, x = order[number, 0], order[number, 1], order[number, 2]
        if not solid[z, y, x]:
            continue
        may_go = True
        for view in range(len(matrices)):
            landed[view] = land(matrices, view, z - 1, y - 1, x - 1, shape)
            may_go = may_go and (landed[view] < 0 or counts[view, landed[view]] > deep)
        if not may_go or (is_one_piece and not hangs_together(solid, z, y, x, near, stack)):
            continue
        solid[z, y, x] = False
        gone += 1
        for view in range(len(matrices)):
            if landed[view] >= 0:
                counts[view, landed[view]] -= 1
    return gone


@compiled
def cross(corners: Array, crossed: Array) -> None:
    """Toggle, for each column of voxels' middles that a triangle meets, the first voxel above the place where it does.

    Columns are moved by less than a thousandth of a voxel, so that edges are met by one of two triangles.

    Parameters
    ----------
    corners
        ``(triangles, 3, 3)``: places z, y, x in voxels.
    crossed
        ``(nz + 1, ny, nx)`` of bool, changed.
    """
    nz, ny, nx = crossed.shape[0] - 1, crossed.shape[1], crossed.shape[2]
    off_y, off_x = 7.31e-4, 4.17e-4
    for number in range(len(corners)):
        az, ay, ax = corners[number, 0]
        bz, by, bx = corners[number, 1]
        cz, cy, cx = corners[number, 2]
        area = (by - ay) * (cx - ax) - (bx - ax) * (cy - ay)
        if area == 0:
            continue
        for y in range(max(0, math.floor(min(ay, by, cy))), min(ny - 1, math.ceil(max(ay, by, cy))) + 1):
            for x in range(max(0, math.floor(min(ax, bx, cx))), min(nx - 1, math.ceil(max(ax, bx, cx))) + 1):
                v, u = y + off_y, x + off_x
                b = ((v - ay) * (cx - ax) - (u - ax) * (cy - ay)) / area
                c = ((by - ay) * (u - ax) - (bx - ax) * (v - ay)) / area
                if b < 0 or c < 0 or b + c > 1:
                    continue
                at = az + b * (bz - az) + c * (cz - az)
                first = min(max(math.ceil(at), 0), nz)
                crossed[first, y, x] = not crossed[first, y, x]
