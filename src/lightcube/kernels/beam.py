"""One beam through a block of voxels: which voxels, and for how long.

Lengths are in voxel sides. The block fills ``[0, nx] x [0, ny]`` and is endless along z, because beams of
one picture column are copies of each other moved up by whole voxels: whoever uses the pieces clips z.

References
----------
R. L. Siddon, Fast calculation of the exact radiological path for a three-dimensional CT array,
Medical Physics 12 (1985) 252-255.
"""

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

#: A direction component below this is zero.
PARALLEL = 1e-12
#: A beam along a face counts as on it within this distance, in voxel sides.
ON_FACE = 1e-9


@njit(cache=True)
def max_pieces(nx: int, ny: int, rise: int) -> int:
    """Upper bound on the pieces of one beam that crosses at most `rise` z faces, ties included."""
    return 4 * (nx + ny + rise + 5)


@njit(cache=True)
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


@njit(cache=True)
def _next_face(p: float, d: float, i: int) -> float:
    """Path parameter at which a beam inside cell `i` of one axis leaves it."""
    if abs(d) < PARALLEL:
        return np.inf
    if d > 0.0:
        return (i + 1 - p) / d
    return (i - p) / d


@njit(cache=True)
def _trace_off_faces(
    px: float,
    py: float,
    pz: float,
    dx: float,
    dy: float,
    dz: float,
    nx: int,
    ny: int,
    scale: float,
    voxels: NDArray[Any],
    levels: NDArray[Any],
    weights: NDArray[Any],
    count: int,
) -> int:
    """Append the pieces of a beam that runs along no face; return the new count."""
    x_in, x_out = _crossings(px, dx, nx)
    y_in, y_out = _crossings(py, dy, ny)
    t = max(x_in, y_in)
    end = min(x_out, y_out)
    if not t < end:
        return count
    ix = min(max(math.floor(px + t * dx), 0), nx - 1)
    iy = min(max(math.floor(py + t * dy), 0), ny - 1)
    iz = math.floor(pz + t * dz)
    tx, ty, tz = _next_face(px, dx, ix), _next_face(py, dy, iy), _next_face(pz, dz, iz)
    while t < end:
        stop = min(min(tx, ty), min(tz, end))
        if stop > t:
            voxels[count] = iy * nx + ix
            levels[count] = iz
            weights[count] = (stop - t) * scale
            count += 1
            t = stop
        if tx <= t:
            ix += 1 if dx > 0.0 else -1
            if ix < 0 or ix >= nx:
                break
            tx = _next_face(px, dx, ix)
        if ty <= t:
            iy += 1 if dy > 0.0 else -1
            if iy < 0 or iy >= ny:
                break
            ty = _next_face(py, dy, iy)
        if tz <= t:
            iz += 1 if dz > 0.0 else -1
            tz = _next_face(pz, dz, iz)
    return count


@njit(cache=True)
def _on_face(p: float, d: float) -> bool:
    """Whether a beam runs along a face of this axis."""
    return abs(d) < PARALLEL and abs(p - round(p)) <= ON_FACE


@njit(cache=True)
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
    voxels: NDArray[Any],
    levels: NDArray[Any],
    weights: NDArray[Any],
) -> int:
    """Write the pieces of the beam ``p + t d`` (`d` of length 1) and return how many there are.

    Piece ``k`` lies in voxel ``voxels[k] = y * nx + x`` of slice ``levels[k]`` (any whole number) and is
    ``weights[k]`` long, in voxel sides times `scale`. A beam along a face is split into equal beams half a
    voxel to either side, which have the same lengths as the voxels that touch the face.
    """
    on_x, on_y, on_z = _on_face(px, dx), _on_face(py, dy), _on_face(pz, dz)
    count = 0
    for sx in range(2 if on_x else 1):
        for sy in range(2 if on_y else 1):
            for sz in range(2 if on_z else 1):
                part = scale
                qx, qy, qz = px, py, pz
                if on_x:
                    part *= 0.5
                    qx = round(px) + sx - 0.5
                if on_y:
                    part *= 0.5
                    qy = round(py) + sy - 0.5
                if on_z:
                    part *= 0.5
                    qz = round(pz) + sz - 0.5
                count = _trace_off_faces(qx, qy, qz, dx, dy, dz, nx, ny, part, voxels, levels, weights, count)
    return count
