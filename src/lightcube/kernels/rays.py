"""Absorbance of rays in any direction from all voxels, and its transpose, for a few columns.

``x`` is ``(ny * nx * nz, columns)`` and ``b`` is ``(views * width * height, columns)``: picture columns from the left,
rows bottom-up in each. In voxels, pixel ``(column, row)`` of a view lies at ``corner + column * right + row * up``
with ``corner, right, up = screens[view]``. Where ``lamps[view, 3]`` is 0 its ray is the whole line along
``lamps[view, :3]``, else the stretch from the lamp there to the pixel. A voxel is `scale` wide and `tall` times as
high; directions are of length 1 in voxels' widths, their part along z in slices. ``heard`` says which pixels count:
the equations of the others are empty.

Where light is bent, ``lines``, ``(views * width, height, 6)``, has for each pixel where its ray enters and leaves what
bends it, in voxels, and lamps and screens are not asked; else it is ``(1, 0, 6)``. ``boxes`` then has for each view and
brick which pixels may meet it, ``(views, bricks, 4)``, else it is ``(1, 0, 4)``.

Rays of a picture column are traced eight at a time. Forward, each gathers what it meets. Backward, each task owns a
brick of voxels and walks the rays that meet it, view by view: no two threads write the same number, and sums do not
depend on how many threads there are. Voxels are numbered by 32 bits.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled
from lightcube.kernels.marching import ABREAST, march
from lightcube.kernels.ray import END, FIELDS, Ray, Triple, enter, most_pieces, parts_of
from lightcube.kernels.ray import trace as trace_one
from lightcube.kernels.tiles import Traced, paper

Array = NDArray[Any]

#: Voxels along the side of a brick (measured).
BRICK = 32
#: Meets nothing, and runs along no face.
NO_RAY = (0.0, 0.0, 0.0, 0.6, 0.6, 0.5, 0.0, 0.0)


@compiled(inline="always")
def _ray(lamp: Array, screen: Array, column: int, row: int, low: Triple, tall: float) -> Ray:
    """The ray of a pixel, seen from the corner `low` of a brick, and from the pixel: lamps may be far away."""
    qx = screen[0, 0] + column * screen[1, 0] + row * screen[2, 0]
    qy = screen[0, 1] + column * screen[1, 1] + row * screen[2, 1]
    qz = screen[0, 2] + column * screen[1, 2] + row * screen[2, 2]
    px, py, pz = qx - low[0], qy - low[1], qz - low[2]
    if lamp[3] == 0:
        return px, py, pz, lamp[0], lamp[1], lamp[2], -np.inf, np.inf
    dx, dy, dz = qx - lamp[0], qy - lamp[1], qz - lamp[2]
    high = dz * tall
    length = math.sqrt(dx * dx + dy * dy + high * high)
    if length == 0.0:  # the lamp stands on the pixel: there is no way between them
        return NO_RAY
    return px, py, pz, dx / length, dy / length, dz / length, -length, 0.0


@compiled(inline="always")
def _piece(line: Array, low: Triple, tall: float) -> Ray:
    """The ray from a place to another, seen from the corner `low` of a brick."""
    dx, dy, dz = line[3] - line[0], line[4] - line[1], line[5] - line[2]
    high = dz * tall
    length = math.sqrt(dx * dx + dy * dy + high * high)
    if length == 0.0:
        return NO_RAY
    px, py, pz = line[0] - low[0], line[1] - low[1], line[2] - low[2]
    return px, py, pz, dx / length, dy / length, dz / length, 0.0, length


@compiled
def trace(
    lamps: Array,
    screens: Array,
    lines: Array,
    shape: tuple[int, int],
    index: int,
    grid: Triple,
    scale: float,
    tall: float,
    places: Array,
    weights: Array,
) -> int:
    """Trace ray number `index` through the whole grid ``(nz, ny, nx)``; return how many pieces it has."""
    width, height = shape
    nz, ny, nx = grid
    view, pixel = index // (width * height), index % (width * height)
    own, column, row = lines[index // height % len(lines)], pixel // height, pixel % height
    ray = (
        _piece(own[row], (0, 0, 0), tall)
        if len(own)
        else _ray(lamps[view], screens[view], column, row, (0, 0, 0), tall)
    )
    shifts = np.empty_like(places)
    count = trace_one(ray, (nx, ny, nz), (nz, nx * nz, 1), scale, places, shifts, weights)
    places[:count] += shifts[:count]
    return count


@compiled
def trace_rows(
    lamp: Array,
    screen: Array,
    lines: Array,
    heard: Array,
    column: int,
    row: int,
    top: int,
    low: Triple,
    size: Triple,
    strides: Triple,
    scale: float,
    tall: float,
    state: Array,
    traced: Traced,
) -> tuple[int, int]:
    """Trace the rays of the pixels from `row` to before `top` of a column that are heard, as many as go abreast.

    `lines` are the column's, of which there are none where light is straight. Returns the row to go on with, and how
    many rays meet the block; ``traced.rays`` are their rows.
    """
    met = 0
    while row < top:
        if heard[row]:
            ray = _piece(lines[row], low, tall) if len(lines) else _ray(lamp, screen, column, row, low, tall)
            if met + parts_of(ray) > ABREAST:
                break
            for _ in range(enter(ray, size, scale, state, met)):
                traced.rays[met] = row
                met += 1
        row += 1
    if met:
        state[END, met:] = -np.inf  # no ray
        march(state, size, strides, traced.places, traced.shifts, traced.weights, 0, traced.counts, 0)
    return row, met


@compiled
def _gather(x: Array, traced: Traced, lane: int, sums: Array) -> None:
    """``sums += sum_k weights[k] x[places[k] + shifts[k]]`` over the pieces of the ray in a lane."""
    last = lane + ABREAST * traced.counts[lane]
    if len(sums) == 3:  # the colours of most cubes: in registers
        red, green, blue = sums[0], sums[1], sums[2]
        for k in range(lane, last, ABREAST):
            place, weight = np.uint32(traced.places[k] + traced.shifts[k]), traced.weights[k]
            red += weight * x[place, 0]
            green += weight * x[place, 1]
            blue += weight * x[place, 2]
        sums[0], sums[1], sums[2] = red, green, blue
    else:
        for k in range(lane, last, ABREAST):
            for column in range(len(sums)):
                sums[column] += traced.weights[k] * x[traced.places[k] + traced.shifts[k], column]


@compiled
def _scatter(x: Array, traced: Traced, lane: int, values: Array) -> None:
    """``x[places[k] + shifts[k]] += weights[k] values`` for the pieces of the ray in a lane."""
    last = lane + ABREAST * traced.counts[lane]
    if len(values) == 3:
        red, green, blue = values[0], values[1], values[2]
        for k in range(lane, last, ABREAST):
            place, weight = np.uint32(traced.places[k] + traced.shifts[k]), traced.weights[k]
            x[place, 0] += weight * red
            x[place, 1] += weight * green
            x[place, 2] += weight * blue
    else:
        for k in range(lane, last, ABREAST):
            for column in range(len(values)):
                x[traced.places[k] + traced.shifts[k], column] += traced.weights[k] * values[column]


def forward(
    lamps: Array,
    screens: Array,
    lines: Array,
    shape: tuple[int, int],
    heard: Array,
    grid: Triple,
    scale: float,
    tall: float,
    x: Array,
    b: Array,
) -> None:
    """``b = A x``; every number of `b` is written. `heard`, ``(views * width, height)``, is 0 where none counts."""
    work = _work(heard, grid)
    tasks.run(_forward, len(lamps) * shape[0], work, lamps, screens, lines, shape, heard, grid, scale, tall, x, b)


def _work(heard: Array, grid: Triple) -> int:
    """Nanoseconds that a product takes, roughly: some for each piece of each ray."""
    return 3 * heard.size * sum(grid)


@compiled
def _forward(
    first: int,
    last: int,
    lamps: Array,
    screens: Array,
    lines: Array,
    shape: tuple[int, int],
    heard: Array,
    grid: Triple,
    scale: float,
    tall: float,
    x: Array,
    b: Array,
) -> None:
    """Gather along the rays of picture columns `first` to before `last`, counted through all views."""
    width, height = shape
    nz, ny, nx = grid
    whole, size, strides = (0, 0, 0), (nx, ny, nz), (nz, nx * nz, 1)
    state, traced = np.zeros((FIELDS, ABREAST)), paper(0, most_pieces(nx, ny, nz), x)
    for line in range(first, last):
        lamp, screen, column = lamps[line // width], screens[line // width], line % width
        own, sums = lines[line % len(lines)], b[line * height : (line + 1) * height]
        sums[:] = 0
        row = 0
        while row < height:
            row, met = trace_rows(
                lamp, screen, own, heard[line], column, row, height, whole, size, strides, scale, tall, state, traced
            )
            for lane in range(met):
                _gather(x, traced, lane, sums[traced.rays[lane]])


def adjoint(
    lamps: Array,
    screens: Array,
    lines: Array,
    shadows: Array,
    boxes: Array,
    shape: tuple[int, int],
    heard: Array,
    grid: Triple,
    scale: float,
    tall: float,
    b: Array,
    x: Array,
) -> None:
    """``x = A.T b``; every number of `x` is written.

    ``shadows[view]`` is the 3 x 4 matrix that takes a point ``(x, y, z, 1)`` to ``(column, row, 1)`` of its shadow
    times a number, which is above 0 where the point lies between lamp and screen or beyond the screen.
    """
    bricks = math.prod((side + BRICK - 1) // BRICK for side in grid)
    data = lamps, screens, lines, shadows, boxes, shape, heard
    tasks.run(_adjoint, bricks, _work(heard, grid), *data, grid, scale, tall, b, x)


@compiled
def _adjoint(
    first: int,
    last: int,
    lamps: Array,
    screens: Array,
    lines: Array,
    shadows: Array,
    boxes: Array,
    shape: tuple[int, int],
    heard: Array,
    grid: Triple,
    scale: float,
    tall: float,
    b: Array,
    x: Array,
) -> None:
    """Do bricks `first` to before `last`."""
    width, height = shape
    nz, ny, nx = grid
    across, along = (nx + BRICK - 1) // BRICK, (ny + BRICK - 1) // BRICK
    state, traced = np.zeros((FIELDS, ABREAST)), paper(0, most_pieces(BRICK, BRICK, BRICK), x)
    for brick in range(first, last):
        low_x, low_y = brick % across * BRICK, brick // across % along * BRICK
        low_z = brick // (across * along) * BRICK
        size_x, size_y, size_z = min(BRICK, nx - low_x), min(BRICK, ny - low_y), min(BRICK, nz - low_z)
        for y in range(low_y, low_y + size_y):
            for each in range(low_x, low_x + size_x):
                start = (y * nx + each) * nz + low_z
                x[start : start + size_z] = 0
        brick_x = x[(low_y * nx + low_x) * nz + low_z :]
        low, size, strides = (low_x, low_y, low_z), (size_x, size_y, size_z), (nz, nx * nz, 1)
        for view in range(len(lamps)):
            lamp, screen = lamps[view], screens[view]
            box = boxes[view % len(boxes)]
            if len(box):
                left, right, bottom, top = box[brick, 0], box[brick, 1], box[brick, 2], box[brick, 3]
            else:
                left, right, bottom, top = _shadow(shadows[view], shape, low, size)
            for column in range(left, right):
                line, row = view * width + column, bottom
                while row < top:
                    own = lines[line % len(lines)]
                    row, met = trace_rows(
                        *(lamp, screen, own, heard[line], column, row, top, low, size, strides, scale, tall),
                        *(state, traced),
                    )
                    for lane in range(met):
                        _scatter(brick_x, traced, lane, b[line * height + traced.rays[lane]])


@compiled
def _shadow(shadow: Array, shape: tuple[int, int], low: Triple, size: Triple) -> tuple[int, int, int, int]:
    """First column, one after the last, and the same of rows, of the pixels whose rays may meet a brick."""
    left, right, bottom, top = np.inf, -np.inf, np.inf, -np.inf
    for corner in range(8):
        x = float(low[0] + (size[0] if corner & 1 else 0))
        y = float(low[1] + (size[1] if corner & 2 else 0))
        z = float(low[2] + (size[2] if corner & 4 else 0))
        far = shadow[2, 0] * x + shadow[2, 1] * y + shadow[2, 2] * z + shadow[2, 3]
        if far < 1e-9:  # beside or behind the lamp
            return 0, shape[0], 0, shape[1]
        column = (shadow[0, 0] * x + shadow[0, 1] * y + shadow[0, 2] * z + shadow[0, 3]) / far
        row = (shadow[1, 0] * x + shadow[1, 1] * y + shadow[1, 2] * z + shadow[1, 3]) / far
        left, right, bottom, top = min(left, column), max(right, column), min(bottom, row), max(top, row)
    most = float(max(shape))
    return (
        int(min(max(math.floor(left - 1e-6), 0.0), most)),
        int(min(max(math.ceil(right + 1e-6) + 1, 0.0), float(shape[0]))),
        int(min(max(math.floor(bottom - 1e-6), 0.0), most)),
        int(min(max(math.ceil(top + 1e-6) + 1, 0.0), float(shape[1]))),
    )


def boxes(lines: Array, heard: Array, shape: tuple[int, int], grid: Triple) -> Array:
    """Which pixels of each view may meet each brick, ``(views, bricks, 4)``: as `_shadow` says of straight light."""
    bricks = tuple((side + BRICK - 1) // BRICK for side in grid[::-1])
    found = np.empty((len(lines) // shape[0], math.prod(bricks), 4), np.int64)
    tasks.run(_boxes, len(found), 20 * heard.size * math.prod(bricks), lines, heard, shape, grid, bricks, found)
    return found


@compiled
def _boxes(
    first: int,
    last: int,
    lines: Array,
    heard: Array,
    shape: tuple[int, int],
    grid: Triple,
    bricks: Triple,
    found: Array,
) -> None:
    """Do views `first` to before `last`."""
    width, height = shape
    sides = (grid[2], grid[1], grid[0])
    for view in range(first, last):
        found[view, :, 0], found[view, :, 1], found[view, :, 2], found[view, :, 3] = width, 0, height, 0
        for column in range(width):
            for row in range(height):
                if not heard[view * width + column, row]:
                    continue
                line = lines[view * width + column, row]
                for brick in range(found.shape[1]):
                    place = (brick % bricks[0], brick // bricks[0] % bricks[1], brick // (bricks[0] * bricks[1]))
                    enters, leaves = 0.0, 1.0
                    for axis in range(3):
                        low = place[axis] * BRICK - 1e-6
                        high = min((place[axis] + 1) * BRICK, sides[axis]) + 1e-6
                        way = line[3 + axis] - line[axis]
                        if abs(way) < 1e-300:
                            if not low < line[axis] < high:
                                leaves = -1.0
                        else:
                            one, two = (low - line[axis]) / way, (high - line[axis]) / way
                            enters, leaves = max(enters, min(one, two)), min(leaves, max(one, two))
                    if enters <= leaves:
                        box = found[view, brick]
                        box[0], box[1] = min(box[0], column), max(box[1], column + 1)
                        box[2], box[3] = min(box[2], row), max(box[3], row + 1)
