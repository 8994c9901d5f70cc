"""Rays of any direction through a block of voxels: which voxels, and for how long.

Lengths are in voxels' widths, places in voxels, and the block fills ``[0, nx] x [0, ny] x [0, nz]``, its `shape` being
``(nx, ny, nz)``. A ray is ``(px, py, pz, dx, dy, dz, first, last)``: the points ``p + t d``, ``first <= t <= last``,
`d` being what one width of the way is in voxels: of length 1 where they are cubes. The traversal is that of
`lightcube.kernels.beam`, with an end in every direction.

A step waits for the one before it (which face comes next?), so two rays are walked at a time: while one waits the other
goes on, and both together take little longer than one.
"""

import math
from typing import Any

from numpy.typing import NDArray

from lightcube.kernels.beam import PARALLEL, beside, crossings, faces, on_face
from lightcube.kernels.compiled import compiled

Array = NDArray[Any]
Ray = tuple[float, float, float, float, float, float, float, float]
Triple = tuple[int, int, int]
#: What stays while a ray is walked: its end, which way places and coordinates go at each face, and from face to face.
Way = tuple[float, int, int, int, int, int, int, float, float, float]
#: Where a ray is: its parameter, voxel, place, the parameters of the next faces, and the number of pieces so far.
At = tuple[float, int, int, int, int, float, float, float, int]


@compiled
def most_pieces(nx: int, ny: int, nz: int) -> int:
    """Upper bound on the pieces of one ray, ties included, with room for one more."""
    return 4 * (nx + ny + nz + 5) + 1


@compiled(inline="always")
def _enter(ray: Ray, shape: Triple, strides: Triple, count: int) -> tuple[Way, At]:
    """Where a ray that runs along no face enters the block; where it misses, its end is there too."""
    px, py, pz, dx, dy, dz, first, last = ray
    nx, ny, nz = shape
    x_in, x_out = crossings(px, dx, nx)
    y_in, y_out = crossings(py, dy, ny)
    z_in, z_out = crossings(pz, dz, nz)
    t = max(max(x_in, y_in), max(z_in, first))
    end = min(min(x_out, y_out), min(z_out, last))
    if not t < end:
        t = end = 0.0
    x = min(max(math.floor(px + t * dx), 0), nx - 1)
    y = min(max(math.floor(py + t * dy), 0), ny - 1)
    z = min(max(math.floor(pz + t * dz), 0), nz - 1)
    x_way, tx, x_gap = faces(px, dx, x)
    y_way, ty, y_gap = faces(py, dy, y)
    z_way, tz, z_gap = faces(pz, dz, z)
    place = x * strides[0] + y * strides[1] + z * strides[2]
    steps = x_way * strides[0], y_way * strides[1], z_way * strides[2]
    return (end, x_way, y_way, z_way, *steps, x_gap, y_gap, z_gap), (t, x, y, z, place, tx, ty, tz, count)


@compiled(inline="always")
def _advance(way: Way, at: At, shape: Triple, scale: float, places: Array, weights: Array) -> At:
    """Write the piece of a ray up to the next face, unless it has none left; free of branches on the numbers."""
    end, x_way, y_way, z_way, x_step, y_step, z_step, x_gap, y_gap, z_gap = way
    t, x, y, z, place, tx, ty, tz, count = at
    stop = min(min(tx, ty), min(tz, end))
    inside = (0 <= x < shape[0]) & (0 <= y < shape[1]) & (0 <= z < shape[2])
    places[count] = place
    weights[count] = (stop - t) * scale
    count += 1 if (stop > t) & inside else 0
    at_x, at_y, at_z = tx <= stop, ty <= stop, tz <= stop
    return (
        max(t, stop),
        x + (x_way if at_x else 0),
        y + (y_way if at_y else 0),
        z + (z_way if at_z else 0),
        place + (x_step if at_x else 0) + (y_step if at_y else 0) + (z_step if at_z else 0),
        tx + (x_gap if at_x else 0.0),
        ty + (y_gap if at_y else 0.0),
        tz + (z_gap if at_z else 0.0),
        count,
    )


@compiled
def _trace_off_faces(
    ray: Ray, shape: Triple, strides: Triple, scale: float, places: Array, weights: Array, count: int
) -> int:
    """Append the pieces of a ray that runs along no face; return the new count."""
    way, at = _enter(ray, shape, strides, count)
    while at[0] < way[0]:
        at = _advance(way, at, shape, scale, places, weights)
    return at[8]


@compiled(inline="always")
def _is_oblique(ray: Ray) -> bool:
    """Whether a ray cannot run along a face."""
    return abs(ray[3]) >= PARALLEL and abs(ray[4]) >= PARALLEL and abs(ray[5]) >= PARALLEL


@compiled
def trace_ray(ray: Ray, shape: Triple, strides: Triple, scale: float, places: Array, weights: Array) -> int:
    """Write the pieces of a ray; return how many there are.

    Piece ``k`` in voxel ``(x, y, z)`` has ``places[k] = x * strides[0] + y * strides[1] + z * strides[2]`` and is
    ``weights[k]`` long, in voxel sides times `scale`. A ray along a face is split as `trace_beam` splits a beam.
    There must be room for `most_pieces`.
    """
    if _is_oblique(ray):
        return _trace_off_faces(ray, shape, strides, scale, places, weights, 0)
    px, py, pz, dx, dy, dz, first, last = ray
    on_x, on_y, on_z = on_face(px, dx), on_face(py, dy), on_face(pz, dz)
    part = scale * 0.5 ** (int(on_x) + int(on_y) + int(on_z))
    count = 0
    for sx in range(2 if on_x else 1):
        for sy in range(2 if on_y else 1):
            for sz in range(2 if on_z else 1):
                qx, qy, qz = beside(px, on_x, sx), beside(py, on_y, sy), beside(pz, on_z, sz)
                half = (qx, qy, qz, dx, dy, dz, first, last)
                count = _trace_off_faces(half, shape, strides, part, places, weights, count)
    return count


@compiled
def trace_two(
    ray: Ray, other: Ray, shape: Triple, strides: Triple, scale: float, places: Array, weights: Array
) -> tuple[int, int]:
    """Write the pieces of two rays, as `trace_ray` does, to the rows of `places` and `weights`; return the counts."""
    if not (_is_oblique(ray) and _is_oblique(other)):
        first = trace_ray(ray, shape, strides, scale, places[0], weights[0])
        return first, trace_ray(other, shape, strides, scale, places[1], weights[1])
    places_a, weights_a, places_b, weights_b = places[0], weights[0], places[1], weights[1]
    way_a, a = _enter(ray, shape, strides, 0)
    way_b, b = _enter(other, shape, strides, 0)
    while (a[0] < way_a[0]) | (b[0] < way_b[0]):
        a = _advance(way_a, a, shape, scale, places_a, weights_a)
        b = _advance(way_b, b, shape, scale, places_b, weights_b)
    return a[8], b[8]
