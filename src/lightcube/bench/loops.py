"""The loops whose speed is a ceiling: multiply-adds from registers and from rows of a block, reading, triad."""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload
from numpy.typing import NDArray

from lightcube.kernels.compiled import compiled
from lightcube.kernels.rows import LANES, add_rows
from lightcube.kernels.tasks import run

Array = NDArray[Any]

#: Numbers in a row of a block: four vectors, as many as a projection holds in registers.
ROW = 64
#: Chains of multiply-adds that do not wait for each other: one of these keeps all units of a processor at work.
CHAINS = (4, 6, 10)
#: Work that is worth all threads, however little it is.
_LONG = 1 << 40


def multiply_adds(times: int, chains: int) -> float:
    """``times * chains * LANES`` multiply-adds of float32 that touch no memory; returns some of their result."""
    sums = np.arange(chains, dtype=np.float32)
    for _ in range(times):
        sums = sums * np.float32(0.5) + np.float32(1)
    return float(sums.sum())


@overload(multiply_adds)
def _compiled_multiply_adds(times, chains):  # type: ignore[no-untyped-def]
    def run(times, chains):  # type: ignore[no-untyped-def]
        if chains == CHAINS[0]:
            return _chains_4(times)
        if chains == CHAINS[1]:
            return _chains_6(times)
        return _chains_10(times)

    return run


def _chained(chains: int) -> Any:
    """Make `multiply_adds` with so many chains, compiled."""

    @intrinsic
    def run(context, times):  # type: ignore[no-untyped-def]
        def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            vector = ir.VectorType(ir.FloatType(), LANES)
            sums = [cgutils.alloca_once(builder, vector) for _ in range(chains)]
            for j in range(chains):
                builder.store(ir.Constant(vector, [float(j + lane) for lane in range(LANES)]), sums[j])
            with cgutils.for_range(builder, args[0], intp=ir.IntType(64)):
                for total in sums:
                    product = builder.fmul(builder.load(total), ir.Constant(vector, [0.5] * LANES), flags=("contract",))
                    added = builder.fadd(product, ir.Constant(vector, [1.0] * LANES), flags=("contract",))
                    builder.store(added, total)
            result = builder.load(sums[0])
            for total in sums[1:]:
                result = builder.fadd(result, builder.load(total))
            return builder.extract_element(result, ir.Constant(ir.IntType(32), 0))

        return types.float32(types.int64), emit

    return run


_chains_4, _chains_6, _chains_10 = (_chained(chains) for chains in CHAINS)


def from_registers(times: int, chains: int, threads: int) -> Array:
    """`multiply_adds` in every thread."""
    results = np.zeros(threads, np.float64)
    run(_from_registers, threads, _LONG, times, chains, results)
    return results


@compiled
def _from_registers(first: int, last: int, times: int, chains: int, results: Array) -> None:
    for thread in range(first, last):
        results[thread] = multiply_adds(times, chains)


def from_rows(times: int, sums: Array, blocks: Array, places: Array, shifts: Array, weights: Array) -> None:
    """Add the rows of `ROW` numbers at ``places[thread]`` of ``blocks[thread]``, weighted, to the thread's `sums`."""
    run(_from_rows, len(sums), _LONG, times, sums, blocks, places, shifts, weights)


@compiled
def _from_rows(
    first: int, last: int, times: int, sums: Array, blocks: Array, places: Array, shifts: Array, weights: Array
) -> None:
    for thread in range(first, last):
        for _ in range(times):
            add_rows(
                sums[thread],
                0,
                blocks[thread % len(blocks)],
                0,
                ROW,
                places[thread],
                shifts,
                weights,
                0,
                len(weights),
                1,
                0,
                0,
                0,
                ROW,
            )


def read(a: Array, threads: int) -> Array:
    """Sum all numbers."""
    results = np.zeros(threads, np.float32)
    run(_read, threads, _LONG, a, results)
    return results


@compiled
def _read(first: int, last: int, a: Array, results: Array) -> None:
    part = (len(a) + len(results) - 1) // len(results)
    for thread in range(first, last):
        results[thread] = _total(a[thread * part : (thread + 1) * part])


@compiled(fastmath=True)
def _total(a: Array) -> Any:
    total = np.float32(0)
    for i in range(len(a)):  # over the numbers themselves, numba takes one at a time
        total += a[i]
    return total


def triad(a: Array, b: Array, c: Array, threads: int) -> None:
    """``a = b + c / 2``."""
    run(_triad_parts, threads, _LONG, a, b, c, threads)


@compiled
def _triad_parts(first: int, last: int, a: Array, b: Array, c: Array, threads: int) -> None:
    part = (len(a) + threads - 1) // threads
    for thread in range(first, last):
        _triad(a[thread * part : (thread + 1) * part], b[thread * part :], c[thread * part :])


@compiled
def _triad(a: Array, b: Array, c: Array) -> None:
    for i in range(len(a)):
        a[i] = b[i] + np.float32(0.5) * c[i]
