"""One ray through a block of voxels: which voxels, and for how long.

Lengths are in voxels' widths, places in voxels. The block fills ``[0, nx] x [0, ny] x [0, nz]``, its size being
``(nx, ny, nz)``; with nz = 0 it is endless along z: beams of one picture column are copies of each other moved up by
whole voxels, and whoever uses their pieces clips z. A ray is ``(px, py, pz, dx, dy, dz, first, last)``: the points
``p + t d``, ``first <= t <= last``, `d` being what one width of the way is in voxels: of length 1 where they are cubes.

A ray along a face is split into equal parts half a voxel to either side, which have the same lengths as the voxels that
touch the face.

References
----------
R. L. Siddon, Fast calculation of the exact radiological path for a three-dimensional CT array,
Medical Physics 12 (1985) 252-255; F. Jacobs et al., A fast algorithm to calculate the exact radiological path
through a pixel or voxel space, J. Computing and Information Technology 6 (1998) 89-94, for the increments.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled

Array = NDArray[Any]
Ray = tuple[float, float, float, float, float, float, float, float]
Triple = tuple[int, int, int]

#: A direction component below this is zero.
PARALLEL = 1e-12
#: A ray along a face counts as on it within this distance, in voxel sides.
ON_FACE = 1e-9
#: Into so many parts a ray is split at most: it runs along the faces of two axes at most.
MOST_PARTS = 4
#: What a lane of a state holds of a ray on its way: path parameters of where it is and where it leaves, and how long a
#: step of 1 is; then for each axis the parameter of the next face, and from face to face, which way the ray goes on
#: there, and the voxel that it is in. So many numbers in all.
AT, END, SCALE, NEXT, GAP, WAY, VOXEL, FIELDS = 0, 1, 2, 3, 6, 9, 12, 15


@compiled
def most_pieces(nx: int, ny: int, rise: int) -> int:
    """Upper bound on the pieces of a ray, or of a part of one, that crosses at most `rise` z faces."""
    return nx + ny + rise + 6


@compiled(inline="always")
def _crossings(p: float, d: float, n: int) -> tuple[float, float]:
    """Path parameters at which ``p + t d`` enters and leaves ``[0, n]``; empty (inf, -inf) where it misses."""
    if abs(d) < PARALLEL:
        if 0.0 < p < n:
            return -np.inf, np.inf
        return np.inf, -np.inf
    first, last = -p / d, (n - p) / d
    if first < last:
        return first, last
    return last, first


@compiled(inline="always")
def _faces(p: float, d: float, i: int) -> tuple[int, float, float]:
    """Which way a ray in cell `i` of one axis goes on, the path parameter of the next face, and from face to face."""
    if abs(d) < PARALLEL:
        return 0, np.inf, np.inf
    if d > 0.0:
        return 1, (i + 1 - p) / d, 1 / d
    return -1, (i - p) / d, -1 / d


@compiled(inline="always")
def _on_face(p: float, d: float) -> bool:
    """Whether a ray runs along a face of this axis."""
    return abs(d) < PARALLEL and abs(p - round(p)) <= ON_FACE


@compiled(inline="always")
def _beside(p: float, on: bool, side: int) -> float:
    """Half a voxel to either `side`, 0 or 1, of the face that a ray runs on; where it runs on none, `p`."""
    return round(p) + side - 0.5 if on else p


@compiled(inline="always")
def parts_of(ray: Ray) -> int:
    """Into how many parts a ray is split: 1, 2 or 4."""
    px, py, pz, dx, dy, dz, _, _ = ray
    return (1 + int(_on_face(px, dx))) * (1 + int(_on_face(py, dy))) * (1 + int(_on_face(pz, dz)))


@compiled
def enter(ray: Ray, size: Triple, scale: float, state: Array, lane: int) -> int:
    """Write where the parts of a ray enter the block to the lanes of `state` from `lane` on; return how many do."""
    px, py, pz, dx, dy, dz, first, last = ray
    if parts_of(ray) == 1:
        return _enter(ray, size, scale, state, lane)
    on_x, on_y, on_z = _on_face(px, dx), _on_face(py, dy), _on_face(pz, dz)
    part, count = scale / parts_of(ray), 0
    for sx in range(2 if on_x else 1):
        for sy in range(2 if on_y else 1):
            for sz in range(2 if on_z else 1):
                qx, qy, qz = _beside(px, on_x, sx), _beside(py, on_y, sy), _beside(pz, on_z, sz)
                count += _enter((qx, qy, qz, dx, dy, dz, first, last), size, part, state, lane + count)
    return count


@compiled
def _enter(ray: Ray, size: Triple, scale: float, state: Array, lane: int) -> int:
    """Do what `enter` does for a ray that runs along no face."""
    px, py, pz, dx, dy, dz, first, last = ray
    nx, ny, nz = size
    x_in, x_out = _crossings(px, dx, nx)
    y_in, y_out = _crossings(py, dy, ny)
    t, end = max(max(x_in, y_in), first), min(min(x_out, y_out), last)
    if nz:
        z_in, z_out = _crossings(pz, dz, nz)
        t, end = max(t, z_in), min(end, z_out)
    if not t < end:
        return 0
    x = min(max(math.floor(px + t * dx), 0), nx - 1)
    y = min(max(math.floor(py + t * dy), 0), ny - 1)
    z = math.floor(pz + t * dz)
    if nz:
        z = min(max(z, 0), nz - 1)
    state[AT, lane], state[END, lane], state[SCALE, lane] = t, end, scale
    state[VOXEL, lane], state[VOXEL + 1, lane], state[VOXEL + 2, lane] = x, y, z
    state[WAY, lane], state[NEXT, lane], state[GAP, lane] = _faces(px, dx, x)
    state[WAY + 1, lane], state[NEXT + 1, lane], state[GAP + 1, lane] = _faces(py, dy, y)
    state[WAY + 2, lane], state[NEXT + 2, lane], state[GAP + 2, lane] = _faces(pz, dz, z)
    return 1


@compiled
def follow(
    state: Array,
    lane: int,
    size: Triple,
    strides: Triple,
    places: Array,
    shifts: Array,
    weights: Array,
    first: int,
    step: int,
) -> int:
    """Write the pieces of the ray in a lane of `state`, `step` numbers apart from `first` on; return how many.

    One in voxel ``(x, y, z)`` has the place ``x * strides[0] + y * strides[1]``, the shift ``z * strides[2]``, and its
    length as weight. Where a ray meets several faces at once some may be of length 0.
    """
    t, end = state[AT, lane], state[END, lane]
    tx, ty, tz = state[NEXT, lane], state[NEXT + 1, lane], state[NEXT + 2, lane]
    x, y, z = int(state[VOXEL, lane]), int(state[VOXEL + 1, lane]), int(state[VOXEL + 2, lane])
    nx, ny, nz = size
    count = 0
    while t < end and 0 <= x < nx and 0 <= y < ny and (nz == 0 or 0 <= z < nz):
        stop = min(min(tx, ty), min(tz, end))
        at = first + count * step
        places[at], shifts[at] = x * strides[0] + y * strides[1], z * strides[2]
        weights[at] = (stop - t) * state[SCALE, lane]
        count += 1
        t = stop
        if tx <= stop:
            x, tx = x + int(state[WAY, lane]), tx + state[GAP, lane]
        if ty <= stop:
            y, ty = y + int(state[WAY + 1, lane]), ty + state[GAP + 1, lane]
        if tz <= stop:
            z, tz = z + int(state[WAY + 2, lane]), tz + state[GAP + 2, lane]
    return count


@compiled
def trace(ray: Ray, size: Triple, strides: Triple, scale: float, places: Array, shifts: Array, weights: Array) -> int:
    """Write all pieces of a ray that are longer than 0, as `follow` does; return how many there are.

    There must be room for `MOST_PARTS` times as many as `most_pieces`.
    """
    state = np.empty((FIELDS, MOST_PARTS))
    count = 0
    for lane in range(enter(ray, size, scale, state, 0)):
        made = follow(state, lane, size, strides, places, shifts, weights, count, 1)
        for k in range(count, count + made):
            places[count], shifts[count], weights[count] = places[k], shifts[k], weights[k]
            count += 1 if weights[k] > 0 else 0
    return count
