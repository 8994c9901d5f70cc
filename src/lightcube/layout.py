"""The order of numbers in memory: pictures and volumes as the columns of one matrix equation.

The unknowns are a block of ``(ny * nx)`` rows and ``(nz * channels)`` columns, the pictures a block of
``(views * picture columns)`` rows and ``(picture rows * channels)`` columns whose picture rows run bottom-up
like z. The innermost axis is the colour channel in both, so a block of columns is contiguous.
"""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating]


def columns_from_volume(volume: Floats) -> Floats:
    """``(channel, z, y, x)`` to a contiguous ``(y * x, z * channel)``."""
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
