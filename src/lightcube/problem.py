"""Frames and a grid as a solver sees them."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from lightcube.frames import Frames
from lightcube.geometry import Grid, held
from lightcube.layout import columns_from_pictures, columns_from_volume, pictures_from_columns, volume_from_columns
from lightcube.projector import Projector
from lightcube.transfer import Transfer, decode

Floats = NDArray[np.floating[Any]]
Lamp = Literal["per-view", "global", "coarse", "fixed"]
#: The darkest that a screen can show, in display values: half a display level.
BLACK = 0.5 / 255


@dataclass(frozen=True, eq=False)
class Problem:
    """The matrix, the wanted light of every beam, and which lamp it belongs to; columns are independent of each other.

    Parameters
    ----------
    matrix
        Of all views, those of a stop one after the other.
    light, weights
        ``(matrix.shape[0], columns)``, linear light above 0, and at least 0.
    lamp_of_row
        ``(matrix.shape[0],)``: the lamp that each equation belongs to.
    channels
        Colours of the pictures: column ``j`` is of colour ``j % channels``.
    stops, angles
        Pictures, and at how many angles each of them is asked for.
    transfer
        How display values follow from light.
    """

    matrix: Projector
    light: Floats
    weights: Floats
    lamp_of_row: NDArray[np.intp]
    channels: int
    stops: int
    angles: int
    transfer: Transfer

    def units(self) -> list[slice]:
        """Blocks of columns that may be solved one after the other: colours, or slabs of slices with level lamps."""
        columns = self.light.shape[1]
        width = 1 if columns == self.channels else self.channels * -(-columns // (4 * self.channels))
        return [slice(start, min(start + width, columns)) for start in range(0, columns, width)]

    def extinction(self, x: Floats) -> Floats:
        """``(channel, z, y, x)`` of the unknowns `x`."""
        _, ny, nx = self.matrix.grid.shape
        return volume_from_columns(x.reshape(ny * nx, -1), self.matrix.grid.shape, self.channels)

    def unknowns(self, extinction: Floats) -> Floats:
        """Inverse of `extinction`."""
        return columns_from_volume(extinction).reshape(self.matrix.shape[1], -1)

    def shown(self, absorbance: Floats, powers: NDArray[np.float64]) -> NDArray[np.float32]:
        """``(stop, row, column, channel)``, linear light at the stops themselves, of ``A x`` and the lamps' powers."""
        shape = self.matrix.views.picture_shape
        at_stops = absorbance.reshape(self.stops, self.angles, shape[1], -1)[:, self.angles // 2]
        light = pictures_from_columns(np.exp(-at_stops).reshape(self.stops * shape[1], -1), shape, self.channels)
        return (light * powers[:, None, None, :]).astype(np.float32)

    def pixels(self, rejected: NDArray[np.int64]) -> NDArray[np.int64]:
        """(stop, row, column, channel) of rejected (equation, column) pairs, each once."""
        rows, columns = self.matrix.views.picture_shape
        flat = rejected[:, 0] * self.light.shape[1] + rejected[:, 1]
        shape = (self.stops * self.angles, columns, rows, self.channels)
        view, column, lifted, channel = np.unravel_index(flat, shape)
        pixels = np.stack([view // self.angles, rows - 1 - lifted, column, channel], axis=1).astype(np.int64)
        return np.unique(pixels, axis=0)


def pose(
    frames: Frames,
    grid: Grid,
    hold: float,
    lamp: Lamp,
    black: float = BLACK,
    dtype: type[np.floating[Any]] = np.float32,
) -> Problem:
    """Pose the problem of the cube `grid` whose shadows are `frames`, held for so many degrees on either side.

    Pixels darker than `black`, a display value, are wanted at it. The ends of a hold, with nothing to hold on to
    beyond, count twice: else they are what falls apart first (measured).
    """
    views = held(frames.views, hold, grid)
    angles = len(views) // len(frames)
    matrix = Projector(grid, views)
    darkest = decode(np.array([black], np.float32), frames.transfer)
    channels = frames.pictures.shape[-1]

    def block(pictures: Floats) -> Floats:
        return columns_from_pictures(np.repeat(pictures.astype(dtype), angles, axis=0)).reshape(matrix.shape[0], -1)

    importance = np.ones(angles, dtype)
    if angles > 1:
        importance[[0, -1]] = 2
    of_row = np.tile(importance, len(frames))[matrix.view_of_row]
    stop_of_row = matrix.view_of_row // angles
    return Problem(
        matrix=matrix,
        light=block(np.maximum(frames.pictures, darkest)),
        weights=of_row[:, None] * block(np.repeat(frames.weight[..., None], channels, axis=-1)),
        lamp_of_row=np.zeros_like(stop_of_row) if lamp == "global" else stop_of_row,
        channels=channels,
        stops=len(frames),
        angles=angles,
        transfer=frames.transfer,
    )
