"""Weighted sums of rows, held in vector registers: what all the time of a projection goes into.

A loop over columns that numba compiles keeps its sums in memory; here up to four vectors of sixteen sums stay in
registers while the rows go by. The vectors are LLVM's, which any processor gets in the width it has.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload
from numpy.typing import NDArray

Array = NDArray[Any]

#: Numbers in a vector.
LANES = 16
_I32, _I64 = ir.IntType(32), ir.IntType(64)


def add_rows(
    target: Array,
    at: int,
    source: Array,
    base: int,
    columns: int,
    places: Array,
    shifts: Array,
    weights: Array,
    first: int,
    count: int,
    step: int,
    low: int,
    high: int,
    start: int,
    stop: int,
) -> None:
    """``target[at + c] += sum_k weights[k] source[base + places[k] + shifts[k] + c]`` for ``start <= c < stop``.

    The sum is over the `count` pieces ``k = first, first + step, ...`` and leaves out what lies beside the row of
    `columns` numbers that it is taken from: ``c + shifts[k]`` must be in ``[0, columns)``. Shifts are from `low` to
    `high`. `target` and `source` have one axis.
    """
    for k in range(first, first + count * step, step):
        first_c, last_c = max(start, -shifts[k]), min(stop, columns - shifts[k])
        if first_c < last_c:
            there = base + places[k] + shifts[k]
            target[at + first_c : at + last_c] += weights[k] * source[there + first_c : there + last_c]


def _summing(vectors: int, *, cut: bool, ragged: bool) -> Any:
    """Make `add_rows` for `vectors` vectors of columns from `start` on, compiled.

    Where not `cut`, `stop` is not before the end of the last one; where not `ragged`, all rows have all their numbers.
    """

    @intrinsic
    def add(  # type: ignore[no-untyped-def]
        context, target, at, source, base, columns, places, shifts, weights, first, count, step, start, stop
    ):
        number = types.int64
        signature = types.void(target, number, source, number, number, places, shifts, weights, *[number] * 5)
        return signature, lambda *emitter: _emit(vectors, cut, ragged, *emitter)

    return add


def _emit(vectors: int, cut: bool, ragged: bool, context: Any, builder: Any, signature: Any, args: Any) -> Any:
    """Emit the code of `_summing`."""
    at, base, columns, first, count, step, start, stop = (args[i] for i in (1, 3, 4, *range(8, 13)))
    target, source, places, shifts, weights = (
        context.make_array(signature.args[i])(context, builder, args[i]).data for i in (0, 2, 5, 6, 7)
    )
    real = context.get_value_type(signature.args[0].dtype)
    size = signature.args[0].dtype.bitwidth // 8
    vector = ir.VectorType(real, LANES)
    here = builder.gep(target, [builder.add(at, start)])
    there = builder.gep(source, [builder.add(base, start)])
    wanted = [_inside(builder, start, stop, j) if cut else None for j in range(vectors)]
    sums = [cgutils.alloca_once(builder, vector) for _ in range(vectors)]
    for j in range(vectors):
        builder.store(_load(builder, vector, size, _at(builder, here, j), wanted[j]), sums[j])
    last = builder.add(first, builder.mul(count, step))
    with cgutils.for_range_slice(builder, first, last, step, intp=_I64) as (k, _):
        place = builder.sext(builder.load(builder.gep(places, [k])), _I64)
        shift = builder.sext(builder.load(builder.gep(shifts, [k])), _I64)
        weight = _spread(builder, builder.load(builder.gep(weights, [k])), vector)
        row = builder.gep(there, [builder.add(place, shift)])
        for j in range(vectors):
            known = _inside(builder, builder.add(start, shift), columns, j) if ragged else None
            values = _load(builder, vector, size, _at(builder, row, j), known)
            product = builder.fmul(values, weight, flags=("contract",))
            builder.store(builder.fadd(builder.load(sums[j]), product, flags=("contract",)), sums[j])
    for j in range(vectors):
        _store(builder, builder.load(sums[j]), size, _at(builder, here, j), wanted[j])
    return context.get_dummy_value()


def _at(builder: Any, pointer: Any, j: int) -> Any:
    """Where vector number `j` from `pointer` on begins."""
    return builder.gep(pointer, [ir.Constant(_I64, j * LANES)])


def _spread(builder: Any, value: Any, vector: Any) -> Any:
    """`value` in all lanes."""
    one = builder.insert_element(ir.Constant(vector, ir.Undefined), value, ir.Constant(_I32, 0))
    return builder.shuffle_vector(one, one, ir.Constant(ir.VectorType(_I32, LANES), [0] * LANES))


def _inside(builder: Any, start: Any, count: Any, j: int) -> Any:
    """Which lanes of vector number `j` from `start` on are in ``[0, count)``."""
    lanes = ir.VectorType(_I32, LANES)
    numbers = ir.Constant(lanes, list(range(j * LANES, (j + 1) * LANES)))
    numbers = builder.add(_spread(builder, builder.trunc(start, _I32), lanes), numbers)
    return builder.icmp_unsigned("<", numbers, _spread(builder, builder.trunc(count, _I32), lanes))


def _load(builder: Any, vector: Any, size: int, pointer: Any, mask: Any) -> Any:
    """Load a vector of numbers of `size` bytes; lanes that the mask leaves out are 0 and not read."""
    pointer = builder.bitcast(pointer, vector.as_pointer())
    if mask is None:
        loaded = builder.load(pointer)
        loaded.align = size
        return loaded
    kind = ir.FunctionType(vector, [pointer.type, _I32, mask.type, vector])
    load = cgutils.get_or_insert_function(builder.module, kind, f"llvm.masked.load.v{LANES}f{8 * size}.p0")
    return builder.call(load, [pointer, ir.Constant(_I32, size), mask, ir.Constant(vector, [0.0] * LANES)])


def _store(builder: Any, values: Any, size: int, pointer: Any, mask: Any) -> None:
    """Store a vector; lanes that the mask leaves out are not written."""
    pointer = builder.bitcast(pointer, values.type.as_pointer())
    if mask is None:
        builder.store(values, pointer).align = size
        return
    kind = ir.FunctionType(ir.VoidType(), [values.type, pointer.type, _I32, mask.type])
    store = cgutils.get_or_insert_function(builder.module, kind, f"llvm.masked.store.v{LANES}f{8 * size}.p0")
    builder.call(store, [values, pointer, ir.Constant(_I32, size), mask])


_whole = _summing(4, cut=False, ragged=False)
_cut_1, _cut_2, _cut_3, _cut_4 = (_summing(vectors, cut=True, ragged=False) for vectors in range(1, 5))
_some_1, _some_2, _some_3, _some_4 = (_summing(vectors, cut=True, ragged=True) for vectors in range(1, 5))


@overload(add_rows, inline="always")
def _compiled_add_rows(  # type: ignore[no-untyped-def]
    target, at, source, base, columns, places, shifts, weights, first, count, step, low, high, start, stop
):
    def add(  # type: ignore[no-untyped-def]
        target, at, source, base, columns, places, shifts, weights, first, count, step, low, high, start, stop
    ):
        c, end = max(start, -high), min(stop, columns - low)  # elsewhere no row has a number
        while c < end:
            rest = end - c
            if c + low >= 0 and c + high + min((rest + LANES - 1) // LANES, 4) * LANES <= columns:
                if rest >= 64:
                    _whole(target, at, source, base, columns, places, shifts, weights, first, count, step, c, end)
                elif rest > 48:
                    _cut_4(target, at, source, base, columns, places, shifts, weights, first, count, step, c, end)
                elif rest > 32:
                    _cut_3(target, at, source, base, columns, places, shifts, weights, first, count, step, c, end)
                elif rest > 16:
                    _cut_2(target, at, source, base, columns, places, shifts, weights, first, count, step, c, end)
                else:
                    _cut_1(target, at, source, base, columns, places, shifts, weights, first, count, step, c, end)
            elif rest > 48:
                _some_4(target, at, source, base, columns, places, shifts, weights, first, count, step, c, end)
            elif rest > 32:
                _some_3(target, at, source, base, columns, places, shifts, weights, first, count, step, c, end)
            elif rest > 16:
                _some_2(target, at, source, base, columns, places, shifts, weights, first, count, step, c, end)
            else:
                _some_1(target, at, source, base, columns, places, shifts, weights, first, count, step, c, end)
            c += 64

    return add


def prefetch(array: Array, index: int) -> None:
    """Ask for ``array[index]`` to be brought near: it will be wanted soon."""


@overload(prefetch, inline="always")
def _compiled_prefetch(array, index):  # type: ignore[no-untyped-def]
    def bring(array, index):  # type: ignore[no-untyped-def]
        _bring(array, index)  # type: ignore[call-arg]

    return bring


@intrinsic
def _bring(context, array, index):  # type: ignore[no-untyped-def]
    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, args[0]).data
        byte = builder.bitcast(builder.gep(data, [args[1]]), ir.IntType(8).as_pointer())
        kind = ir.FunctionType(ir.VoidType(), [byte.type, _I32, _I32, _I32])
        read, near, data_not_code = ir.Constant(_I32, 0), ir.Constant(_I32, 3), ir.Constant(_I32, 1)
        bring = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
        builder.call(bring, [byte, read, near, data_not_code])
        return context.get_dummy_value()

    return types.void(array, types.int64), emit
