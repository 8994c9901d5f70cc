"""One beam through a block of voxels: which voxels, and for how long.

Lengths are in voxels' widths, places in voxels. The block fills ``[0, nx] x [0, ny]`` and is endless along z, because
beams of one picture column are copies of each other moved up by whole voxels: whoever uses the pieces clips z.

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

#: A direction component below this is zero.
PARALLEL = 1e-12
#: A beam along a face counts as on it within this distance, in voxel sides.
ON_FACE = 1e-9


@compiled
def max_pieces(nx: int, ny: int, rise: int) -> int:
    """Upper bound on the pieces of one beam that crosses at most `rise` z faces, ties included."""
    return 4 * (nx + ny + rise + 5)


@compiled(inline="always")
def crossings(p: float, d: float, n: int) -> tuple[float, float]:
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
def faces(p: float, d: float, i: int) -> tuple[int, float, float]:
    """Which way a beam in cell `i` of one axis goes on, the path parameter of the next face, and from face to face."""
    if abs(d) < PARALLEL:
        return 0, np.inf, np.inf
    if d > 0.0:
        return 1, (i + 1 - p) / d, 1 / d
    return -1, (i - p) / d, -1 / d


#: What a lane of a state holds of a beam on its way: path parameters of where it is and where it leaves, and how long a
#: step of 1 is; then for each axis the parameter of the next face, and from face to face, which way the beam goes on
#: there, and the voxel that it is in. So many numbers in all.
AT, END, SCALE, NEXT, GAP, WAY, VOXEL, FIELDS = 0, 1, 2, 3, 6, 9, 12, 15


@compiled
def begin(
    px: float,
    py: float,
    pz: float,
    dx: float,
    dy: float,
    dz: float,
    nx: int,
    ny: int,
    scale: float,
    state: NDArray[Any],
    lane: int,
) -> bool:
    """Write where a beam that runs along no face enters the block to a lane of `state`; False where it misses."""
    x_in, x_out = crossings(px, dx, nx)
    y_in, y_out = crossings(py, dy, ny)
    t = max(x_in, y_in)
    end = min(x_out, y_out)
    if not t < end:
        return False
    state[AT, lane], state[END, lane], state[SCALE, lane] = t, end, scale
    ix = min(max(math.floor(px + t * dx), 0), nx - 1)
    iy = min(max(math.floor(py + t * dy), 0), ny - 1)
    iz = math.floor(pz + t * dz)
    state[VOXEL, lane], state[VOXEL + 1, lane], state[VOXEL + 2, lane] = ix, iy, iz
    state[WAY, lane], state[NEXT, lane], state[GAP, lane] = faces(px, dx, ix)
    state[WAY + 1, lane], state[NEXT + 1, lane], state[GAP + 1, lane] = faces(py, dy, iy)
    state[WAY + 2, lane], state[NEXT + 2, lane], state[GAP + 2, lane] = faces(pz, dz, iz)
    return True


@compiled
def follow(
    state: NDArray[Any],
    lane: int,
    nx: int,
    ny: int,
    strides: tuple[int, int, int],
    places: NDArray[Any],
    shifts: NDArray[Any],
    weights: NDArray[Any],
    first: int,
    step: int,
) -> int:
    """Write the pieces of the beam in a lane of `state`, `step` numbers apart from `first` on; return how many.

    Where a beam meets several faces at once some may be of length 0.
    """
    t, end = state[AT, lane], state[END, lane]
    tx, ty, tz = state[NEXT, lane], state[NEXT + 1, lane], state[NEXT + 2, lane]
    ix, iy, iz = int(state[VOXEL, lane]), int(state[VOXEL + 1, lane]), int(state[VOXEL + 2, lane])
    count = 0
    while t < end and 0 <= ix < nx and 0 <= iy < ny:
        stop = min(min(tx, ty), min(tz, end))
        at = first + count * step
        places[at], shifts[at] = ix * strides[0] + iy * strides[1], iz * strides[2]
        weights[at] = (stop - t) * state[SCALE, lane]
        count += 1
        t = stop
        if tx <= stop:
            ix, tx = ix + int(state[WAY, lane]), tx + state[GAP, lane]
        if ty <= stop:
            iy, ty = iy + int(state[WAY + 1, lane]), ty + state[GAP + 1, lane]
        if tz <= stop:
            iz, tz = iz + int(state[WAY + 2, lane]), tz + state[GAP + 2, lane]
    return count


@compiled(inline="always")
def on_face(p: float, d: float) -> bool:
    """Whether a beam runs along a face of this axis."""
    return abs(d) < PARALLEL and abs(p - round(p)) <= ON_FACE


@compiled(inline="always")
def beside(p: float, on: bool, side: int) -> float:
    """Half a voxel to either `side`, 0 or 1, of the face that a beam runs on; where it runs on none, `p`."""
    return round(p) + side - 0.5 if on else p


@compiled
def trace_beam(
    px: float,
    py: float,
    pz: float,
    dx: float,
    dy: float,
    dz: float,
    nx: int,
    ny: int,
    scale: float,
    strides: tuple[int, int, int],
    places: NDArray[Any],
    shifts: NDArray[Any],
    weights: NDArray[Any],
    count: int,
) -> int:
    """Append the pieces of the beam ``p + t d`` after the first `count`; return how many there are.

    `d` is what one width of the way is in voxels: of length 1 where they are cubes.

    Piece ``k``, in voxel ``(x, y)`` of slice ``z`` (any whole number), has ``places[k] = x * strides[0] +
    y * strides[1]``, ``shifts[k] = z * strides[2]``, and is ``weights[k]`` long, in voxel sides times `scale`. A beam
    along a face is split into equal beams half a voxel to either side, which have the same lengths as the voxels that
    touch the face. There must be room for one more piece than `max_pieces`.
    """
    state = np.empty((FIELDS, 1))
    on_x, on_y, on_z = on_face(px, dx), on_face(py, dy), on_face(pz, dz)
    part = scale * 0.5 ** (int(on_x) + int(on_y) + int(on_z))
    for sx in range(2 if on_x else 1):
        for sy in range(2 if on_y else 1):
            for sz in range(2 if on_z else 1):
                qx, qy, qz = beside(px, on_x, sx), beside(py, on_y, sy), beside(pz, on_z, sz)
                if begin(qx, qy, qz, dx, dy, dz, nx, ny, part, state, 0):
                    made = follow(state, 0, nx, ny, strides, places, shifts, weights, count, 1)
                    count = _without_nothing(places, shifts, weights, count, count + made)
    return count


@compiled
def _without_nothing(places: NDArray[Any], shifts: NDArray[Any], weights: NDArray[Any], first: int, last: int) -> int:
    """Move pieces `first` to before `last` together, without those of length 0; return one after the last."""
    kept = first
    for k in range(first, last):
        places[kept], shifts[kept], weights[kept] = places[k], shifts[k], weights[k]
        kept += 1 if weights[k] > 0 else 0
    return kept
