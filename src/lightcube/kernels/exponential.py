"""e to the power of many float32 numbers, and their logarithms: the arithmetic that a picture's light costs.

The system's own functions take one number at a time; these are plain arithmetic, which the compiler does for as
many numbers at once as a vector of the processor holds.
"""

import math
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload

#: Beyond these, e^u is 0 or infinite to float32, nearly.
_LEAST, _MOST = np.float32(-87), np.float32(88)
_HALF, _ONE = np.float32(0.5), np.float32(1)
_LOG2_E = np.float32(1 / math.log(2))
#: ln 2 in two parts, of which small multiples of the first are exact (W. J. Cody, W. Waite, Software Manual for the
#: Elementary Functions, 1980).
_LN2_HIGH, _LN2_LOW = np.float32(0.693359375), np.float32(math.log(2) - 0.693359375)
#: Taylor's coefficients of e^r: |r| is at most ln(2) / 2, where the first one left out is 2e-8 of the sum.
_R2, _R3, _R4, _R5, _R6, _R7 = (np.float32(1 / math.factorial(k)) for k in range(2, 8))
#: The least number that float32 has in full.
_SMALLEST = np.float32(np.finfo(np.float32).tiny)
#: The bits of sqrt(1/2): what is left of a number between this and twice as much has a logarithm near 0.
_ROOT_BITS = np.int32(np.float32(math.sqrt(0.5)).view(np.int32))
#: The series of ln(1 + f) = 2 artanh(s) in s^2, where s = f / (2 + f) is at most 0.1716: s^9 / 9 times 2 is 3e-8.
_S3, _S5, _S7, _S9 = (np.float32(2 / k) for k in (3, 5, 7, 9))
_TWO = np.float32(2)


def exp(u: float) -> float:
    """e^u, of float32 within 2 units in its last place and float32 itself, from -87 to 88 and constant beyond."""
    return math.exp(u)


@overload(exp, jit_options={"fastmath": {"contract"}})
def _compiled_exp(u):  # type: ignore[no-untyped-def]
    if u != types.float32:
        return lambda u: math.exp(u)

    def single(u):  # type: ignore[no-untyped-def]
        u = min(max(u, _LEAST), _MOST)
        whole = np.int32(u * _LOG2_E + (_HALF if u >= 0 else -_HALF))
        r = u - np.float32(whole) * _LN2_HIGH - np.float32(whole) * _LN2_LOW
        rest = ((((_R7 * r + _R6) * r + _R5) * r + _R4) * r + _R3) * r + _R2
        return (rest * r * r + r + _ONE) * _power_of_two(whole)  # type: ignore[call-arg]

    return single


def log(x: float) -> float:
    """Ln x of a number above 0, of float32 within 2 units in its last place; from 1e-38 down it is constant."""
    return math.log(x)


@overload(
    log, jit_options={"error_model": "numpy", "fastmath": {"contract"}}
)  # else a division could end in an error, which no vector can
def _compiled_log(x):  # type: ignore[no-untyped-def]
    if x != types.float32:
        return lambda x: math.log(x)

    def single(x):  # type: ignore[no-untyped-def]
        bits = _bits_of(max(x, _SMALLEST))
        whole = np.int32(np.int32(bits - _ROOT_BITS) >> 23)
        f = _of_bits(np.int32(bits - np.int32(whole << 23))) - _ONE
        s = f / (_TWO + f)
        square = s * s
        rest = (((_S9 * square + _S7) * square + _S5) * square + _S3) * square
        # ln(1 + f) = f - s (f - rest): exact to first order, so that nothing is lost near 1
        near = f - s * (f - rest)
        return np.float32(whole) * _LN2_HIGH + (np.float32(whole) * _LN2_LOW + near)

    return single


def _recast(kind: Any, other: Any, name: str) -> Any:
    """Make a function that reads a number's bits as one of the `other` kind; kinds are types of numba and of LLVM."""

    def recast(context, number):  # type: ignore[no-untyped-def]
        def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return builder.bitcast(args[0], other[1])

        return other[0](kind[0]), emit

    recast.__name__ = name
    return intrinsic(recast)


_SINGLE, _INTEGER = (types.float32, ir.FloatType()), (types.int32, ir.IntType(32))
_bits_of, _of_bits = _recast(_SINGLE, _INTEGER, "_bits_of"), _recast(_INTEGER, _SINGLE, "_of_bits")


@intrinsic
def _power_of_two(context, whole):  # type: ignore[no-untyped-def]
    """2^whole as float32, from the bits of its exponent."""

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        bits = ir.IntType(32)
        exponent = builder.shl(builder.add(args[0], ir.Constant(bits, 127)), ir.Constant(bits, 23))
        return builder.bitcast(exponent, ir.FloatType())

    return types.float32(types.int32), emit
