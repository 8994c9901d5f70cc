"""Absorbance of all beams from all voxels, and its transpose, over blocks of columns.

``x`` is ``(ny * nx, slices * channels)`` and ``b`` is ``(beams, rows * channels)``. Beam ``view * width + column``
starts at ``beams[view, 0] + column * beams[view, 1]`` and runs along ``beams[view, 2]`` (x, y, z in voxel sides) for
the lowest picture row; row ``j`` is the same beam ``j`` voxels higher. So a piece in slice ``level`` joins column
``i`` of ``b`` to column ``i + level * channels`` of ``x``.

A task owns a block of columns of its result: no two threads write the same number, and sums do not depend on
the number of threads.
"""

from typing import Any

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from lightcube.kernels.beam import max_pieces, trace_beam

Array = NDArray[Any]


@njit(cache=True)
def trace_column(
    beams: Array,
    width: int,
    beam: int,
    nx: int,
    ny: int,
    scale: float,
    voxels: Array,
    levels: Array,
    weights: Array,
) -> int:
    """Trace beam number `beam`, of `width` beams a view; as `trace_beam`."""
    view, column = beam // width, beam % width
    start, step, direction = beams[view, 0], beams[view, 1], beams[view, 2]
    return trace_beam(
        start[0] + column * step[0],
        start[1] + column * step[1],
        start[2] + column * step[2],
        direction[0],
        direction[1],
        direction[2],
        nx,
        ny,
        scale,
        voxels,
        levels,
        weights,
    )


@njit(cache=True, fastmath={"contract"})
def _add_shifted(source: Array, target: Array, shift: int, weight: Any) -> None:
    """``target[i] += weight * source[i + shift]`` wherever `source` has such a number."""
    start = max(0, -shift)
    stop = min(len(target), len(source) - shift)
    if stop <= start:
        return
    part = source[start + shift : stop + shift]
    into = target[start:stop]
    for i in range(len(into)):
        into[i] += weight * part[i]


@njit(cache=True, parallel=True)
def forward(
    beams: Array,
    width: int,
    nx: int,
    ny: int,
    scale: float,
    rise: int,
    x: Array,
    b: Array,
    channels: int,
    block: int,
    beams_per_task: int,
) -> None:
    """``b = A x``; every number of `b` is written. `rise` bounds the slices that one beam meets."""
    count, columns = b.shape
    chunks = (count + beams_per_task - 1) // beams_per_task
    for task in prange((columns + block - 1) // block * chunks):
        first = (task // chunks) * block
        start = (task % chunks) * beams_per_task
        most = max_pieces(nx, ny, rise)
        voxels, levels, weights = np.empty(most, np.int32), np.empty(most, np.int32), np.empty(most, x.dtype)
        sums = np.empty(min(block, columns - first), x.dtype)
        for beam in range(start, min(start + beams_per_task, count)):
            sums[:] = 0
            for k in range(trace_column(beams, width, beam, nx, ny, scale, voxels, levels, weights)):
                _add_shifted(x[voxels[k]], sums, first + levels[k] * channels, weights[k])
            b[beam, first : first + len(sums)] = sums


@njit(cache=True, parallel=True)
def adjoint(
    beams: Array,
    width: int,
    nx: int,
    ny: int,
    scale: float,
    rise: int,
    b: Array,
    x: Array,
    channels: int,
    block: int,
) -> None:
    """``x = A.T b``; every number of `x` is written. `rise` bounds the slices that one beam meets."""
    columns = x.shape[1]
    for task in prange((columns + block - 1) // block):
        first = task * block
        last = min(first + block, columns)
        most = max_pieces(nx, ny, rise)
        voxels, levels, weights = np.empty(most, np.int32), np.empty(most, np.int32), np.empty(most, b.dtype)
        x[:, first:last] = 0
        for beam in range(len(b)):
            for k in range(trace_column(beams, width, beam, nx, ny, scale, voxels, levels, weights)):
                _add_shifted(b[beam], x[voxels[k], first:last], first - levels[k] * channels, weights[k])


@njit(cache=True)
def trace_all(
    beams: Array,
    width: int,
    nx: int,
    ny: int,
    scale: float,
    rise: int,
    offsets: Array,
    voxels: Array,
    levels: Array,
    weights: Array,
) -> None:
    """Write the pieces of beam ``i`` to ``offsets[i]`` and on, or where there is no room only count them.

    With `voxels` of length 0, ``offsets[i + 1]`` is set to the number of pieces up to and with beam ``i``.
    """
    most = max_pieces(nx, ny, rise)
    v, z, w = np.empty(most, np.int32), np.empty(most, np.int32), np.empty(most, np.float64)
    for beam in range(len(offsets) - 1):
        count = trace_column(beams, width, beam, nx, ny, scale, v, z, w)
        if len(voxels) == 0:
            offsets[beam + 1] = offsets[beam] + count
        else:
            here = slice(offsets[beam], offsets[beam] + count)
            voxels[here], levels[here], weights[here] = v[:count], z[:count], w[:count]
