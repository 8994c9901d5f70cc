"""Kaczmarz row actions on many right-hand sides at once."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.integer[Any]]

#: Columns that one thread carries through a sweep together: some vector registers wide, a block that fits L2.
BLOCK = 32


@compiled
def sweep_block(
    indptr: Ints,
    indices: Ints,
    data: Floats,
    inverse_norms: Floats,
    order: Ints,
    b: Floats,
    active: NDArray[np.bool_],
    relaxation: Floats,
    lower: Floats,
    upper: float,
    x: Floats,
) -> None:
    """One sweep over the rows named in `order`, on contiguous `x` of ``(unknowns, width)``, in place.

    Each row action is ``x <- clip(x + relaxation * a_i (b_i - a_i x) / |a_i|^2)`` where `active`.
    """
    width = x.shape[1]
    step = np.empty(width, x.dtype)
    for row in order:
        any_active = False
        for j in range(width):
            step[j] = b[row, j]
            any_active = any_active or active[row, j]
        if not any_active:
            continue
        for p in range(indptr[row], indptr[row + 1]):
            length, voxel = data[p], indices[p]
            for j in range(width):
                step[j] -= length * x[voxel, j]
        for j in range(width):
            step[j] = step[j] * relaxation[j] * inverse_norms[row] if active[row, j] else 0.0
        for p in range(indptr[row], indptr[row + 1]):
            length, voxel = data[p], indices[p]
            for j in range(width):
                x[voxel, j] = min(max(x[voxel, j] + length * step[j], lower[j]), upper)


@compiled
def _sweep(
    first_block: int,
    last_block: int,
    indptr: Ints,
    indices: Ints,
    data: Floats,
    inverse_norms: Floats,
    order: Ints,
    b: Floats,
    active: NDArray[np.bool_],
    relaxation: Floats,
    lower: Floats,
    upper: float,
    x: Floats,
) -> None:
    """`sweep_block` on blocks of columns."""
    columns = x.shape[1]
    for block in range(first_block, last_block):
        first = block * BLOCK
        last = min(first + BLOCK, columns)
        mine = x[:, first:last].copy()
        sweep_block(
            indptr,
            indices,
            data,
            inverse_norms,
            order,
            b[:, first:last],
            active[:, first:last],
            relaxation[first:last],
            lower[first:last],
            upper,
            mine,
        )
        x[:, first:last] = mine


def sweep(
    indptr: Ints,
    indices: Ints,
    data: Floats,
    inverse_norms: Floats,
    order: Ints,
    b: Floats,
    active: NDArray[np.bool_],
    relaxation: Floats,
    lower: Any,
    upper: Any,
    x: Floats,
) -> None:
    """Sweep once over the rows in `order`, on every column by itself, in place; blocks of columns in parallel.

    Parameters
    ----------
    indptr, indices, data
        The matrix as compressed sparse rows; `data` and all that follows in the dtype of `x`.
    inverse_norms
        ``(rows,)``, one over the squared 2-norm of each row, 0 for an empty row.
    order
        The rows to act, one after the other.
    b, active
        ``(rows, columns)``, right-hand sides, and whether that row acts on that column.
    relaxation
        ``(columns,)``.
    lower, upper
        Bounds that every row action keeps; the lower one a number, or ``(columns,)``.
    x
        ``(unknowns, columns)``.
    """
    blocks, work = (x.shape[1] + BLOCK - 1) // BLOCK, len(data) * x.shape[1]
    system = indptr, indices, data, inverse_norms
    least = np.full(x.shape[1], lower, x.dtype)
    tasks.run(_sweep, blocks, work, *system, order, b, active, relaxation, least, upper, x)
