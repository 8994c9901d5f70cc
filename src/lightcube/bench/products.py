"""The projections themselves: seconds and multiply-adds."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.bench.clock import seconds
from lightcube.kernels import stacked, tasks
from lightcube.optics.grid import Grid
from lightcube.optics.views import spread_angles, turntable_views
from lightcube.projection.projector import Projector
from lightcube.projection.stacked import StackedBeams

#: Colours of the cube and its pictures.
CHANNELS = 3
#: Views that are counted at a time, to bound memory.
_COUNTED = 8


def projector(n: int, views: int, elevation_deg: float) -> Projector:
    """`views` pictures of an n-cube on a turntable, each the whole screen."""
    grid = Grid((n, n, n))
    return Projector(
        grid, turntable_views(grid, spread_angles(views, elevation_deg=elevation_deg), elevation_deg=elevation_deg)
    )


def columns_of(matrix: Projector) -> int:
    """Columns of the blocks that a cube in colour makes for this matrix."""
    return CHANNELS * int(np.prod(matrix.grid.shape)) // matrix.shape[1]


def product(matrix: Projector, count: int, ceiling: float, repeats: int) -> dict[str, Any]:
    """Time `forward` and `adjoint` with `count` threads; `ceiling` is the rate that shares are of."""
    x = np.random.default_rng(0).random((matrix.shape[1], columns_of(matrix)), dtype=np.float32)
    products = multiply_adds(matrix)
    with tasks.using(count):
        b = matrix.forward(x)
        there = seconds(lambda: matrix.forward(x), repeats)
        matrix.adjoint(b)
        back = seconds(lambda: matrix.adjoint(b), repeats)
    both = {name: there[name] + back[name] for name in there}
    figures = {}
    for name, took, made in (("forward", there, products), ("adjoint", back, products), ("pass", both, 2 * products)):
        speed = made / took["seconds"]
        figures[name] = {**took, "multiply_adds_per_second": speed, "share_of_l2": speed / ceiling}
    return {"threads": count, "multiply_adds": products, **figures}


def multiply_adds(matrix: Projector) -> int:
    """Multiply-adds of `forward`, counted: the numbers of the matrix that are not zero times the columns."""
    nz, rows = matrix.grid.shape[0], matrix.views.picture_shape[0]
    total = 0
    for view in range(0, len(matrix.views), _COUNTED):
        _, _, levels, _ = traced(matrix, view, view + _COUNTED)
        total += int(np.clip(np.minimum(rows, nz - levels) - np.maximum(0, -levels), 0, None).sum(dtype=np.int64))
    return total * CHANNELS


def traced(
    matrix: Projector, first: int = 0, last: int | None = None
) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int32], NDArray[np.float32]]:
    """Where each beam's pieces begin, and their voxels, levels and lengths, for the lowest row of some views."""
    beams = StackedBeams(matrix.grid, matrix.views.take(slice(first, last)))
    width = matrix.views.picture_shape[1]
    _, ny, nx = matrix.grid.shape
    where = (beams.beams, width, nx, ny, matrix.grid.voxel_mm, beams.rise)
    offsets = np.zeros(len(beams.beams) * width + 1, np.int64)
    none = np.empty(0, np.int32)
    stacked.trace_all(*where, offsets, none, none, np.empty(0, np.float32))
    pieces = int(offsets[-1])
    voxels, levels, lengths = np.empty(pieces, np.int32), np.empty(pieces, np.int32), np.empty(pieces, np.float32)
    stacked.trace_all(*where, offsets, voxels, levels, lengths)
    return offsets, voxels, levels, lengths
