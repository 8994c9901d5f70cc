"""The order of numbers in memory: pictures and volumes as the columns of one matrix equation.

The unknowns are a block of ``(ny * nx)`` rows and ``(nz * channels)`` columns, the pictures a block of
``(views * picture columns)`` rows and ``(picture rows * channels)`` columns whose picture rows run bottom-up
like z. The innermost axis is the colour channel in both, so a block of columns is contiguous.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

Floats = NDArray[np.floating]
#: Bytes that a processor reads at a time: a cache line.
LINE = 64
#: Rows of fewer lines are not worth a longer copy.
_LEAST_LINES = 8


def empty(shape: tuple[int, ...], dtype: DTypeLike) -> NDArray[Any]:
    """An array like numpy's, but begun at a whole cache line: the kernels' vectors then do not straddle two."""
    size = math.prod(shape) * np.dtype(dtype).itemsize
    room = np.empty(size + LINE, np.uint8)
    start = -room.ctypes.data % LINE
    return room[start : start + size].view(dtype).reshape(shape)


def copied(array: NDArray[Any], dtype: DTypeLike | None = None) -> NDArray[Any]:
    """A contiguous copy of an array, of its own dtype unless another one is given, begun as `empty` begins one."""
    copy = empty(array.shape, array.dtype if dtype is None else dtype)
    copy[...] = array
    return copy


class _Shared:
    """Memory of an array, called writable."""

    def __init__(self, array: Floats) -> None:
        self.array = array
        self.__array_interface__ = {**array.__array_interface__, "data": (array.ctypes.data, False)}


def as_writable(array: Floats) -> Floats:
    """The same memory as an array that could be written to, for loops that read it.

    Of those that cannot be written to numba makes another type, and compiles every loop anew for it.
    """
    return array if array.flags.writeable else np.asarray(_Shared(array))


def is_worth_lines(row: float) -> bool:
    """Whether rows of so many bytes are quicker to add up from a copy in which each begins at a whole line."""
    return row % LINE != 0 and row >= _LEAST_LINES * LINE


def clear_volume(shape: tuple[int, int, int], channels: int) -> NDArray[np.float32]:
    """Zeros ``(channel, z, y, x)`` in the order of the columns, so that `columns_from_volume` need not copy them."""
    nz, ny, nx = shape
    return np.zeros((ny, nx, nz, channels), np.float32).transpose(3, 2, 0, 1)


def columns_from_volume(volume: Floats) -> Floats:
    """``(channel, z, y, x)`` to a contiguous ``(y * x, z * channel)``, the same memory where it is in that order."""
    channels, nz, ny, nx = volume.shape
    return np.ascontiguousarray(volume.transpose(2, 3, 1, 0).reshape(ny * nx, nz * channels))


def volume_from_columns(columns: Floats, shape: tuple[int, int, int], channels: int) -> Floats:
    """Back from ``(y * x, z * channel)`` to a contiguous ``(channel, z, y, x)`` of grid shape ``(nz, ny, nx)``."""
    nz, ny, nx = shape
    return np.ascontiguousarray(columns.reshape(ny, nx, nz, channels).transpose(3, 2, 0, 1))


def columns_from_pictures(pictures: Floats) -> Floats:
    """``(view, row, column, channel)`` to a contiguous ``(view * column, row * channel)``, rows bottom-up."""
    views, rows, columns, channels = pictures.shape
    return np.ascontiguousarray(pictures[:, ::-1].transpose(0, 2, 1, 3).reshape(views * columns, rows * channels))


def pictures_from_columns(columns: Floats, picture_shape: tuple[int, int], channels: int) -> Floats:
    """Back from ``(view * column, row * channel)`` to a contiguous ``(view, row, column, channel)``, top row first."""
    rows, width = picture_shape
    stacked = columns.reshape(-1, width, rows, channels)
    return np.ascontiguousarray(stacked.transpose(0, 2, 1, 3)[:, ::-1])
