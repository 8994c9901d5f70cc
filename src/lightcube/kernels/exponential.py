"""e to the power of many float32 numbers: the arithmetic that a picture's light costs.

The system's own function takes one number at a time; this one is plain arithmetic, which the compiler does for as
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


def exp(u: float) -> float:
    """e^u, of float32 within 2 units in its last place and float32 itself, from -87 to 88 and constant beyond."""
    return math.exp(u)


@overload(exp)
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


@intrinsic
def _power_of_two(context, whole):  # type: ignore[no-untyped-def]
    """2^whole as float32, from the bits of its exponent."""

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        bits = ir.IntType(32)
        exponent = builder.shl(builder.add(args[0], ir.Constant(bits, 127)), ir.Constant(bits, 23))
        return builder.bitcast(exponent, ir.FloatType())

    return types.float32(types.int32), emit
