"""Display values and linear light.

Light adds in linear light; pictures on disk and the eye's idea of an even step are display values.
``"srgb"`` is IEC 61966-2-1; ``"linear"`` takes display values as linear light, as the paper does.
Values above 1 (a screen brighter than white) follow the same formula and are never clipped here.
"""

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError

Transfer = Literal["srgb", "linear"]

#: The display value below which the sRGB curve is a straight line, and its slope there.
_TOE_DISPLAY, _TOE_LINEAR, _TOE_SLOPE = 0.04045, 0.0031308, 12.92
_OFFSET, _GAMMA = 0.055, 2.4


def check_transfer(name: str) -> Transfer:
    """Return `name` as a `Transfer`, or raise `InputError` naming what is allowed."""
    for known in get_args(Transfer):
        if name == known:
            return known
    raise InputError(f"unknown transfer {name!r}: use one of {', '.join(get_args(Transfer))}")


def decode(display: NDArray[np.floating], transfer: Transfer = "srgb") -> NDArray[np.floating]:
    """Display values (1 = white) to linear light, elementwise, keeping the dtype."""
    if transfer == "linear":
        return display
    powered = ((np.maximum(display, _TOE_DISPLAY) + _OFFSET) / (1 + _OFFSET)) ** _GAMMA
    return np.where(display <= _TOE_DISPLAY, display / _TOE_SLOPE, powered).astype(display.dtype, copy=False)


def encode(linear: NDArray[np.floating], transfer: Transfer = "srgb") -> NDArray[np.floating]:
    """Linear light (1 = white) to display values, elementwise, keeping the dtype: the inverse of `decode`."""
    if transfer == "linear":
        return linear
    powered = (1 + _OFFSET) * np.maximum(linear, _TOE_LINEAR) ** (1 / _GAMMA) - _OFFSET
    return np.where(linear <= _TOE_LINEAR, linear * _TOE_SLOPE, powered).astype(linear.dtype, copy=False)


def to_uint8(linear: NDArray[np.floating], transfer: Transfer = "srgb") -> NDArray[np.uint8]:
    """Linear light to 8-bit display levels, clipped to [0, 255] and rounded to the nearest level."""
    return np.clip(np.rint(encode(linear, transfer) * 255), 0, 255).astype(np.uint8)


def to_uint16(linear: NDArray[np.floating], transfer: Transfer = "srgb") -> NDArray[np.uint16]:
    """Linear light to 16-bit display levels, clipped to [0, 65535] and rounded to the nearest level."""
    return np.clip(np.rint(encode(linear, transfer) * 65535), 0, 65535).astype(np.uint16)


def from_levels(levels: NDArray[np.uint8] | NDArray[np.uint16], transfer: Transfer = "srgb") -> NDArray[np.float32]:
    """8- or 16-bit display levels to linear light, float32."""
    display = levels.astype(np.float32) / np.float32(np.iinfo(levels.dtype).max)
    return decode(display, transfer).astype(np.float32, copy=False)


#: The darkest that a screen can show, in display values: half a display level.
BLACK = 0.5 / 255
