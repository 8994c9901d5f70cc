"""One ray of any direction through a block of voxels: which voxels, and for how long.

Lengths are in voxel sides, and the block fills ``[0, nx] x [0, ny] x [0, nz]``. The traversal is that of
`lightcube.kernels.beam`, with an end in every direction.
"""

import math
from typing import Any

from numba import njit
from numpy.typing import NDArray

from lightcube.kernels.beam import PARALLEL, crossings, faces, on_face


@njit(cache=True)
def most_pieces(nx: int, ny: int, nz: int) -> int:
    """Upper bound on the pieces of one ray, ties included, with room for one more."""
    return 4 * (nx + ny + nz + 5) + 1


@njit(cache=True)
def _trace_off_faces(
    px: float,
    py: float,
    pz: float,
    dx: float,
    dy: float,
    dz: float,
    first: float,
    last: float,
    nx: int,
    ny: int,
    nz: int,
    scale: float,
    strides: tuple[int, int, int],
    places: NDArray[Any],
    weights: NDArray[Any],
    count: int,
) -> int:
    """Append the pieces of a ray that runs along no face; return the new count. Free of branches on the numbers."""
    x_in, x_out = crossings(px, dx, nx)
    y_in, y_out = crossings(py, dy, ny)
    z_in, z_out = crossings(pz, dz, nz)
    t = max(max(x_in, y_in), max(z_in, first))
    end = min(min(x_out, y_out), min(z_out, last))
    if not t < end:
        return count
    ix = min(max(math.floor(px + t * dx), 0), nx - 1)
    iy = min(max(math.floor(py + t * dy), 0), ny - 1)
    iz = min(max(math.floor(pz + t * dz), 0), nz - 1)
    x_way, tx, x_gap = faces(px, dx, ix)
    y_way, ty, y_gap = faces(py, dy, iy)
    z_way, tz, z_gap = faces(pz, dz, iz)
    place = ix * strides[0] + iy * strides[1] + iz * strides[2]
    x_step, y_step, z_step = x_way * strides[0], y_way * strides[1], z_way * strides[2]
    while t < end:
        stop = min(min(tx, ty), min(tz, end))
        inside = (0 <= ix < nx) & (0 <= iy < ny) & (0 <= iz < nz)
        places[count] = place
        weights[count] = (stop - t) * scale
        count += 1 if (stop > t) & inside else 0
        t = max(t, stop)
        at_x, at_y, at_z = tx <= stop, ty <= stop, tz <= stop
        ix += x_way if at_x else 0
        iy += y_way if at_y else 0
        iz += z_way if at_z else 0
        place += (x_step if at_x else 0) + (y_step if at_y else 0) + (z_step if at_z else 0)
        tx += x_gap if at_x else 0.0
        ty += y_gap if at_y else 0.0
        tz += z_gap if at_z else 0.0
    return count


@njit(cache=True)
def trace_ray(
    px: float,
    py: float,
    pz: float,
    dx: float,
    dy: float,
    dz: float,
    first: float,
    last: float,
    nx: int,
    ny: int,
    nz: int,
    scale: float,
    strides: tuple[int, int, int],
    places: NDArray[Any],
    weights: NDArray[Any],
    count: int,
) -> int:
    """Append the pieces of the ray ``p + t d``, ``first <= t <= last`` (`d` of length 1); return how many there are.

    Piece ``k`` in voxel ``(x, y, z)`` has ``places[k] = x * strides[0] + y * strides[1] + z * strides[2]`` and is
    ``weights[k]`` long, in voxel sides times `scale`. A ray along a face is split as `trace_beam` splits a beam.
    There must be room for `most_pieces`.
    """
    if abs(dx) >= PARALLEL and abs(dy) >= PARALLEL and abs(dz) >= PARALLEL:
        return _trace_off_faces(px, py, pz, dx, dy, dz, first, last, nx, ny, nz, scale, strides, places, weights, count)
    on_x, on_y, on_z = on_face(px, dx), on_face(py, dy), on_face(pz, dz)
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
                count = _trace_off_faces(
                    qx, qy, qz, dx, dy, dz, first, last, nx, ny, nz, part, strides, places, weights, count
                )
    return count
