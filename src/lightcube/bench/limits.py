"""What the machine allows: multiply-adds from registers, caches and memory, and bytes from memory."""

import numpy as np
from numpy.typing import NDArray

from lightcube.bench import loops
from lightcube.bench.clock import rate
from lightcube.kernels import tasks
from lightcube.kernels.rows import LANES

#: Bytes of the blocks that rows are taken from: in the first cache, in the second, in none.
L1, L2, MEMORY = 16 << 10, 512 << 10, 256 << 20
#: Rows that are added up in one go.
_ROWS = 2048


def ceilings(count: int, lasting: float, repeats: int) -> dict[str, float]:
    """Multiply-adds a second by where the rows come from, and bytes a second read and copied, of `count` threads.

    Rows are 64 float32 numbers in random order, each from a multiple of 64 bytes on, added up by the projections' own
    vector kernel. The blocks that fit into a cache are each thread's own; one that fits into none is shared.
    """
    with tasks.using(count):
        return {
            "registers": _registers(count, lasting, repeats),
            "l1": _rows(L1, count, count, lasting, repeats),
            "l2": _rows(L2, count, count, lasting, repeats),
            "memory": _rows(MEMORY, 1, count, lasting, repeats),
            **_bytes(count, lasting, repeats),
        }


def _registers(count: int, lasting: float, repeats: int) -> float:
    steps = 1000

    def chained(chains: int) -> float:
        each = rate(lambda times: loops.from_registers(times * steps, chains, count), lasting, repeats)
        return each * steps * chains * LANES * count

    return max(chained(chains) for chains in loops.CHAINS)


def _rows(size: int, blocks: int, count: int, lasting: float, repeats: int) -> float:
    random = np.random.default_rng(0)
    rows = max(size // (4 * loops.ROW), 1)
    block = _aligned(blocks * rows * loops.ROW).reshape(blocks, -1)
    # enough different rows for a block to be gone from the caches before one of them comes again
    taken = max(_ROWS, rows // 4)
    order = [random.permutation(max(rows, taken))[:taken] % rows * loops.ROW for _ in range(count)]
    places = np.array(order, np.int32)
    shifts, weights = np.zeros(taken, np.int32), np.ones(taken, np.float32)
    sums = _aligned(count * loops.ROW).reshape(count, -1)
    each = rate(lambda times: loops.from_rows(times, sums, block, places, shifts, weights), lasting, repeats)
    return each * taken * loops.ROW * count


def _aligned(count: int) -> NDArray[np.float32]:
    """So many numbers from a multiple of 64 bytes on; not zeros, which would all be the same page of memory."""
    room = np.full(count + 16, 0.5, np.float32)
    start = -room.ctypes.data % 64 // 4
    return room[start : start + count]


def _bytes(count: int, lasting: float, repeats: int) -> dict[str, float]:
    a, b, c = (np.full(MEMORY // 4, number, np.float32) for number in (0, 1, 2))

    def reading(times: int) -> None:
        for _ in range(times):
            loops.read(a, count)

    def copying(times: int) -> None:
        for _ in range(times):
            loops.triad(a, b, c, count)

    return {
        "read": rate(reading, lasting, repeats) * a.nbytes,
        "triad": rate(copying, lasting, repeats) * 3 * a.nbytes,
    }
