"""Eight rays at a time on their way through a block of voxels, each in a lane of the processor's vectors.

One ray alone waits for its next face to be found before it can look for the one after: a vector of rays waits for all
of them at once. The vectors are LLVM's, as those of `lightcube.kernels.rows`.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload
from numpy.typing import NDArray

from lightcube.kernels.ray import AT, END, GAP, NEXT, SCALE, VOXEL, WAY, Triple, follow

Array = NDArray[Any]

#: Rays that march side by side.
ABREAST = 8
_I32, _I64 = ir.IntType(32), ir.IntType(64)
_REALS, _WHOLES = ir.VectorType(ir.DoubleType(), ABREAST), ir.VectorType(_I32, ABREAST)


def march(
    state: Array,
    size: Triple,
    strides: Triple,
    places: Array,
    shifts: Array,
    weights: Array,
    first: int,
    counts: Array,
    met: int,
) -> int:
    """Write the pieces of the rays in all lanes of `state`, as `follow` does: lane i's are ``first + i + 8 k``.

    Their numbers are ``counts[met + i]``; a lane whose end is -inf has none. Returns one after the
    last number of `places`, `shifts` and `weights` that may be written to.
    """
    for lane in range(ABREAST):
        counts[met + lane] = follow(state, lane, size, strides, places, shifts, weights, first + lane, ABREAST)
    return first + ABREAST * int(np.max(counts[met : met + ABREAST]) + 1)


@overload(march, inline="always")
def _compiled_march(  # type: ignore[no-untyped-def]
    state, size, strides, places, shifts, weights, first, counts, met
):
    def go(  # type: ignore[no-untyped-def]
        state, size, strides, places, shifts, weights, first, counts, met
    ):
        nx, ny, nz = size
        along_x, along_y, along_z = strides
        return _march(  # type: ignore[call-arg]
            state, nx, ny, nz, along_x, along_y, along_z, places, shifts, weights, first, counts, met
        )

    return go


@intrinsic
def _march(  # type: ignore[no-untyped-def]
    context, state, nx, ny, nz, stride_x, stride_y, stride_z, places, shifts, weights, first, counts, met
):
    number = types.int64
    sizes = (number,) * 6
    return number(state, *sizes, places, shifts, weights, number, counts, number), _emit


def _emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    """Emit the code of `_march`: a loop that takes every lane to its next face, while any has one."""
    state, places, shifts, weights, counts = (
        context.make_array(signature.args[i])(context, builder, args[i]).data for i in (0, 7, 8, 9, 11)
    )
    real = context.get_value_type(signature.args[9].dtype)
    nx, ny, nz, *strides = (_spread(builder, builder.trunc(each, _I32)) for each in args[1:7])
    endless = builder.icmp_unsigned("==", nz, ir.Constant(_WHOLES, None))
    end, scale = _field(builder, state, END), _field(builder, state, SCALE)
    gaps = [_field(builder, state, GAP + axis) for axis in range(3)]
    ways = [_whole(builder, _field(builder, state, WAY + axis)) for axis in range(3)]
    at = _kept(builder, _field(builder, state, AT))
    faces = [_kept(builder, _field(builder, state, NEXT + axis)) for axis in range(3)]
    voxels = [_kept(builder, _whole(builder, _field(builder, state, VOXEL + axis))) for axis in range(3)]
    count, here = _kept(builder, ir.Constant(_WHOLES, None)), _kept(builder, args[10])

    step, done = builder.append_basic_block("step"), builder.append_basic_block("done")
    builder.branch(step)
    builder.position_at_end(step)
    start, now, next_x, next_y, next_z = (builder.load(each) for each in (at, here, *faces))
    x, y, z = (builder.load(each) for each in voxels)
    stop = _less(builder, _less(builder, next_x, next_y), _less(builder, next_z, end))
    is_on = builder.fcmp_ordered("<", start, end)
    for inside in (
        builder.icmp_unsigned("<", x, nx),
        builder.icmp_unsigned("<", y, ny),
        builder.or_(builder.icmp_unsigned("<", z, nz), endless),
    ):
        is_on = builder.and_(is_on, inside)
    _write(builder, places, now, builder.add(builder.mul(x, strides[0]), builder.mul(y, strides[1])))
    _write(builder, shifts, now, builder.mul(z, strides[2]))
    _write(builder, weights, now, _as(builder, builder.fmul(builder.fsub(stop, start), scale), real))
    for axis in range(3):
        following, voxel = builder.load(faces[axis]), builder.load(voxels[axis])
        crossed = builder.fcmp_ordered("<=", following, stop)
        gap = builder.select(crossed, gaps[axis], ir.Constant(_REALS, None))
        way = builder.select(crossed, ways[axis], ir.Constant(_WHOLES, None))
        builder.store(builder.fadd(following, gap), faces[axis])
        builder.store(builder.add(voxel, way), voxels[axis])
    builder.store(stop, at)
    builder.store(builder.add(builder.load(count), builder.zext(is_on, _WHOLES)), count)
    builder.store(builder.add(now, ir.Constant(_I64, ABREAST)), here)
    left = builder.bitcast(builder.fcmp_ordered("<", stop, end), ir.IntType(ABREAST))
    builder.cbranch(builder.icmp_unsigned("!=", left, ir.Constant(left.type, 0)), step, done)

    builder.position_at_end(done)
    _write(builder, counts, args[12], builder.zext(builder.load(count), ir.VectorType(_I64, ABREAST)))
    return builder.load(here)


def _field(builder: Any, state: Any, row: int) -> Any:
    """Load a row of the state."""
    pointer = builder.gep(state, [ir.Constant(_I64, row * ABREAST)])
    loaded = builder.load(builder.bitcast(pointer, _REALS.as_pointer()))
    loaded.align = 8
    return loaded


def _whole(builder: Any, values: Any) -> Any:
    return builder.fptosi(values, _WHOLES)


def _as(builder: Any, values: Any, real: Any) -> Any:
    """Values as numbers of the type `real`."""
    return values if real == _REALS.element else builder.fptrunc(values, ir.VectorType(real, ABREAST))


def _kept(builder: Any, value: Any) -> Any:
    """A place for what changes from step to step, with its first value: a register, once LLVM has seen it."""
    place = cgutils.alloca_once(builder, value.type)
    builder.store(value, place)
    return place


def _less(builder: Any, one: Any, other: Any) -> Any:
    return builder.select(builder.fcmp_ordered("<", one, other), one, other)


def _spread(builder: Any, value: Any) -> Any:
    """`value` in all lanes."""
    one = builder.insert_element(ir.Constant(_WHOLES, ir.Undefined), value, ir.Constant(_I32, 0))
    return builder.shuffle_vector(one, one, ir.Constant(_WHOLES, [0] * ABREAST))


def _write(builder: Any, array: Any, index: Any, values: Any) -> None:
    """Store a vector from ``array[index]`` on."""
    pointer = builder.bitcast(builder.gep(array, [index]), values.type.as_pointer())
    builder.store(values, pointer).align = 4
