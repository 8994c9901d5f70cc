"""Loops over silhouettes, voxels and triangles: signed distances, the hull's field, what triangles cast.

A view's matrix ``(3, 4)`` takes ``(a, b, c, 1)`` to ``(column * w, row * w, w)``; w is 1 in parallel light.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled

Array = NDArray[Any]

#: Voxels along the side of a brick, which is skipped as a whole where some view lets nothing of it stand.
BRICK = 8
#: Pixels around each picture of signed distances, all of them outside.
MARGIN = 2
#: What bilinear values between pixels may be off a distance's own bound, in pixels: two diagonals.
_OFF = 2 * math.sqrt(2)
#: The field counts in steps of this, never 0, up to so much: its sign is that of the field itself.
STEP, MOST = 1 / 256, 8.0


@compiled
def _column_distances(inside: Array, wanted: bool, apart: Array) -> None:
    """How many rows the nearest pixel is away in the same column that is (not) inside; many where there is none."""
    rows, columns = inside.shape
    far = rows + columns
    for column in range(columns):
        near = far
        for row in range(rows):
            near = 0 if inside[row, column] == wanted else min(near + 1, far)
            apart[row, column] = near
        for row in range(rows - 2, -1, -1):
            apart[row, column] = min(apart[row, column], apart[row + 1, column] + 1)


@compiled
def _row_distances(apart: Array, row: int, starts: Array, bounds: Array, out: Array) -> None:
    """Distances along a row, each to the nearest of parabolas over `apart` (A. Meijster et al., 2000)."""
    columns = apart.shape[1]
    last = 0
    starts[0], bounds[0] = 0, -np.inf
    for column in range(1, columns):
        own = float(apart[row, column]) ** 2
        while True:
            other = starts[last]
            meet = (own - float(apart[row, other]) ** 2 + (column * column - other * other)) / (2 * (column - other))
            if meet > bounds[last] or last == 0:
                break
            last -= 1
        if meet > bounds[last]:
            last += 1
        starts[last] = column
        bounds[last] = meet if last else -np.inf
    at = 0
    for column in range(columns):
        while at < last and bounds[at + 1] < column:
            at += 1
        out[column] = math.hypot(column - starts[at], apart[row, starts[at]])


@compiled
def signed_distances(first: int, last: int, inside: Array, times: int, out: Array) -> None:
    """Signed distances, in pixels, to the edges of views `first` to before `last`; below 0 inside.

    `inside` has `times`, an even number, pixels for each of `out`'s along a side, and `MARGIN` of `out`'s around it
    that are all outside. A value is that at a pixel's middle, the mean of the four small ones around it.
    """
    rows, columns = inside.shape[1:]
    apart = np.empty((2, rows, columns), np.int32)
    starts, bounds = np.empty(columns, np.int64), np.empty(columns)
    found = np.empty((2, 2, columns))
    for view in range(first, last):
        for side in range(2):
            _column_distances(inside[view], side == 0, apart[side])
        for row in range(out.shape[1]):
            upper = row * times + times // 2 - 1
            for below in range(2):
                for side in range(2):
                    _row_distances(apart[side], upper + below, starts, bounds, found[below, side])
            for column in range(out.shape[2]):
                left = column * times + times // 2 - 1
                total = 0.0
                for below in range(2):
                    for at in range(left, left + 2):
                        out_of, within = found[below, 0, at], found[below, 1, at]
                        total += out_of - 0.5 if out_of > 0 else 0.5 - within
                out[view, row, column] = total / (4 * times)


@compiled(inline="always")
def looked_up(distances: Array, row: float, column: float) -> float:
    """Bilinear signed distance at a place of a picture without its margin; further out it grows with the way."""
    rows, columns = distances.shape[0] - 1, distances.shape[1] - 1
    v, u = row + MARGIN, column + MARGIN
    beyond = 0.0
    if not (0 <= v <= rows and 0 <= u <= columns):
        near_v, near_u = min(max(v, 0.0), float(rows)), min(max(u, 0.0), float(columns))
        beyond = math.hypot(v - near_v, u - near_u)
        v, u = near_v, near_u
    i, j = min(int(v), rows - 1), min(int(u), columns - 1)
    p, q = v - i, u - j
    upper = (1 - q) * distances[i, j] + q * distances[i, j + 1]
    lower = (1 - q) * distances[i + 1, j] + q * distances[i + 1, j + 1]
    return (1 - p) * upper + p * lower + beyond


@compiled(inline="always")
def projected(matrices: Array, view: int, a: float, b: float, c: float) -> tuple[float, float]:
    """Row and column that a point lands on."""
    m = matrices[view]
    w = m[2, 0] * a + m[2, 1] * b + m[2, 2] * c + m[2, 3]
    column = m[0, 0] * a + m[0, 1] * b + m[0, 2] * c + m[0, 3]
    row = m[1, 0] * a + m[1, 1] * b + m[1, 2] * c + m[1, 3]
    return row / w, column / w


@compiled
def _is_empty(distances: Array, matrices: Array, z: float, y: float, x: float, half: float) -> bool:
    """Whether some view lets nothing stand in a cube of ``2 * half`` voxels around a place.

    What a distance says at the middle holds, less the way, for whatever lands so near to it.
    """
    for view in range(len(matrices)):
        row, column = projected(matrices, view, z, y, x)
        reach = 0.0
        for corner in range(8):
            r, c = projected(
                matrices,
                view,
                z + (half if corner & 1 else -half),
                y + (half if corner & 2 else -half),
                x + (half if corner & 4 else -half),
            )
            reach = max(reach, math.hypot(r - row, c - column))
        if looked_up(distances[view], row, column) > reach + _OFF:
            return True
    return False


@compiled
def _take_greater(distances: Array, matrix: Array, width: float, z: int, y: int, low_x: int, most: Array) -> None:
    """Let voxels in a row, from `low_x` on, take a view's distances where those are greater."""
    column = matrix[0, 0] * z + matrix[0, 1] * y + matrix[0, 2] * low_x + matrix[0, 3]
    row = matrix[1, 0] * z + matrix[1, 1] * y + matrix[1, 2] * low_x + matrix[1, 3]
    away = matrix[2, 0] * z + matrix[2, 1] * y + matrix[2, 2] * low_x + matrix[2, 3]
    for at in range(len(most)):
        w = 1 / (away + at * matrix[2, 2])
        v, u = (row + at * matrix[1, 2]) * w, (column + at * matrix[0, 2]) * w
        most[at] = max(most[at], width * looked_up(distances, v, u))


@compiled
def hull_field(
    first: int, last: int, distances: Array, matrices: Array, widths: Array, is_skipping: bool, field: Array
) -> None:
    """The greatest signed distance over views, in voxels, in layers of bricks `first` to before `last`.

    The block's own faces count as one view more. Values are rounded to `STEP` away from 0, to `MOST` at most. In bricks
    that are skipped they are `MOST`: neither they nor any voxel next to them can stand.

    Parameters
    ----------
    matrices
        ``(views, 3, 4)``, of voxels' places ``(z, y, x)``.
    widths
        ``(views,)``: how many voxels a pixel is wide in the block's middle.
    field
        ``(nz, ny, nx)``, written.
    """
    nz, ny, nx = field.shape
    most = np.empty(BRICK)
    for layer in range(first, last):
        low_z, high_z = layer * BRICK, min((layer + 1) * BRICK, nz)
        for low_y in range(0, ny, BRICK):
            high_y = min(low_y + BRICK, ny)
            for low_x in range(0, nx, BRICK):
                high_x = min(low_x + BRICK, nx)
                middle = (low_z + high_z - 1) / 2, (low_y + high_y - 1) / 2, (low_x + high_x - 1) / 2
                if is_skipping and _is_empty(distances, matrices, middle[0], middle[1], middle[2], BRICK / 2 + 0.5):
                    field[low_z:high_z, low_y:high_y, low_x:high_x] = MOST
                    continue
                for z in range(low_z, high_z):
                    for y in range(low_y, high_y):
                        row = most[: high_x - low_x]
                        for x in range(low_x, high_x):
                            edge = min(min(z, nz - 1 - z), min(min(y, ny - 1 - y), min(x, nx - 1 - x)))
                            row[x - low_x] = -0.5 - edge
                        for view in range(len(matrices)):
                            _take_greater(distances[view], matrices[view], widths[view], z, y, low_x, row)
                        for x in range(low_x, high_x):
                            steps = max(math.floor(abs(row[x - low_x]) / STEP + 0.5), 1.0)
                            field[z, y, x] = math.copysign(min(steps * STEP, MOST), row[x - low_x])


@compiled
def cast_triangles(first: int, last: int, vertices: Array, faces: Array, matrices: Array, out: Array) -> None:
    """What triangles cast, in views `first` to before `last`: pixels whose middle lies in one of them, edges included.

    Parameters
    ----------
    vertices
        ``(vertices, 3)``, of whatever the matrices take.
    out
        ``(views, rows, columns)`` of False, written.
    """
    rows, columns = out.shape[1:]
    landed = np.empty((len(vertices), 2))
    for view in range(first, last):
        for number in range(len(vertices)):
            landed[number] = projected(matrices, view, vertices[number, 0], vertices[number, 1], vertices[number, 2])
        for face in range(len(faces)):
            ar, ac = landed[faces[face, 0]]
            br, bc = landed[faces[face, 1]]
            cr, cc = landed[faces[face, 2]]
            area = (bc - ac) * (cr - ar) - (br - ar) * (cc - ac)
            if area == 0:
                continue
            for row in range(max(0, math.ceil(min(ar, br, cr))), min(rows - 1, math.floor(max(ar, br, cr))) + 1):
                for column in range(
                    max(0, math.ceil(min(ac, bc, cc))), min(columns - 1, math.floor(max(ac, bc, cc))) + 1
                ):
                    a = ((cc - bc) * (row - br) - (cr - br) * (column - bc)) / area
                    b = ((ac - cc) * (row - cr) - (ar - cr) * (column - cc)) / area
                    c = ((bc - ac) * (row - ar) - (br - ar) * (column - ac)) / area
                    if a >= 0 and b >= 0 and c >= 0:
                        out[view, row, column] = True


@compiled
def shade_triangles(corners: Array, bright: Array, faces: Array, depth: Array, out: Array) -> None:
    """Draw triangles, the nearest in front, brightness between corners linear.

    Parameters
    ----------
    corners
        ``(vertices, 3)``: column, row and how near each is.
    depth
        ``(rows, columns)``: how near what is drawn is, changed.
    out
        ``(rows, columns)``: how bright it is, changed.
    """
    rows, columns = out.shape
    for face in range(len(faces)):
        ac, ar, an = corners[faces[face, 0]]
        bc, br, bn = corners[faces[face, 1]]
        cc, cr, cn = corners[faces[face, 2]]
        area = (bc - ac) * (cr - ar) - (br - ar) * (cc - ac)
        if area == 0:
            continue
        for row in range(max(0, math.ceil(min(ar, br, cr))), min(rows - 1, math.floor(max(ar, br, cr))) + 1):
            for column in range(max(0, math.ceil(min(ac, bc, cc))), min(columns - 1, math.floor(max(ac, bc, cc))) + 1):
                a = ((cc - bc) * (row - br) - (cr - br) * (column - bc)) / area
                b = ((ac - cc) * (row - cr) - (ar - cr) * (column - cc)) / area
                c = 1 - a - b
                near = a * an + b * bn + c * cn
                if a >= 0 and b >= 0 and c >= 0 and near > depth[row, column]:
                    depth[row, column] = near
                    out[row, column] = (
                        a * bright[faces[face, 0]] + b * bright[faces[face, 1]] + c * bright[faces[face, 2]]
                    )
