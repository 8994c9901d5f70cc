"""The block of voxels, and the raster of a screen that holds its shadow."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals
from lightcube.optics.checks import check_fields, checked

#: A direction component smaller than this counts as zero (the tie rule of docs/conventions.md).
PARALLEL = 1e-12


@dataclass(frozen=True)
class Grid:
    """A block of voxels, centred at the origin; z is the turntable's axis and z = 0 the bottom slice.

    Parameters
    ----------
    shape
        Number of voxels ``(nz, ny, nx)``, each at least 1.
    voxel_mm
        Width of a voxel along y and x in mm.
    tall
        Height of a voxel, that of a slice, in its widths, 1e-3 to 1e3: 1 = voxels are cubes.

    Raises
    ------
    InputError
        Where a number of voxels is not whole or below 1, a side lies outside 1e-6 to 1e6 mm, or a height outside its
        range.

    Examples
    --------
    >>> import lightcube as lc
    >>> grid = lc.Grid((3, 5, 7), voxel_mm=0.5)
    >>> grid.size_mm
    (1.5, 2.5, 3.5)
    >>> lc.Grid((3, 5, 7), voxel_mm=0.5, tall=2).size_mm
    (3.0, 2.5, 3.5)
    """

    shape: tuple[int, int, int]
    voxel_mm: float = 1.0
    tall: float = 1.0

    def __post_init__(self) -> None:
        check_fields(self)
        if min(self.shape) < 1:
            raise InputError(f"a grid's shape is three whole numbers of at least 1 (nz, ny, nx), not {self.shape}")
        if not 1e-6 <= self.voxel_mm <= 1e6:
            raise InputError(f"a voxel's side must lie between 1e-6 and 1e6 millimetres, not {self.voxel_mm:g}")
        check_tall(self.tall)
        object.__setattr__(self, "shape", tuple(int(n) for n in self.shape))
        object.__setattr__(self, "voxel_mm", float(self.voxel_mm))
        object.__setattr__(self, "tall", float(self.tall))

    def __repr__(self) -> str:
        tall = "" if self.tall == 1 else f", tall={self.tall!r}"
        return f"Grid(shape={self.shape!r}, voxel_mm={self.voxel_mm!r}{tall})"

    @property
    def slice_mm(self) -> float:
        """Height of a slice in mm."""
        return self.tall * self.voxel_mm

    @property
    def sides_mm(self) -> Reals:
        """Sides of a voxel along (x, y, z) in mm."""
        return np.array([self.voxel_mm, self.voxel_mm, self.slice_mm])

    @property
    def size_mm(self) -> tuple[float, float, float]:
        """Lengths of the block along (z, y, x) in mm."""
        nz, ny, nx = self.shape
        return (nz * self.slice_mm, ny * self.voxel_mm, nx * self.voxel_mm)

    @property
    def longest(self) -> float:
        """Longest side of the block in voxels' widths."""
        nz, ny, nx = self.shape
        return max(self.tall * nz, ny, nx)

    @property
    def largest_pixel(self) -> int:
        """How many voxels wide a pixel may be that is no larger than the block, at least 1."""
        nz, ny, nx = self.shape
        return max(1, math.floor(min(self.tall * nz, ny, nx)))

    @property
    def sides_in_words(self) -> str:
        """A voxel's width in mm, or where it is no cube, its three sides."""
        if self.tall == 1:
            return f"{self.voxel_mm:.6g} mm"
        return f"{self.voxel_mm:.6g} x {self.voxel_mm:.6g} x {self.slice_mm:.6g} mm"

    def coarser(self, shape: tuple[int, int, int], ratio: float) -> Grid:
        """So many voxels, `ratio` times as large."""
        return Grid(shape, ratio * self.voxel_mm, self.tall)


def _round_up(value: float, parity: int) -> int:
    """Smallest whole number of at least `value` that is even or odd like `parity` (to 1e-9)."""
    whole = _pixels(value)
    return whole + (whole - parity) % 2


def raster_shape(grid: Grid, elevation_deg: float = 0.0, pixel: float | tuple[float, float] = 1) -> tuple[int, int]:
    """``(rows, columns)`` of the pixels of a screen that holds the cube's whole shadow at every turntable angle.

    A pixel is `pixel` voxels wide and high, or so high and so wide. ``columns * pixel`` is at least ``hypot(nx, ny)``,
    ``rows * pixel`` at least ``tall * nz + hypot(nx, ny) * |tan(elevation)|``; both counts are the smallest such ones
    that are even or odd like those of the pixels that ``ny`` and ``tall * nz`` voxels' widths take. Of pixels as large
    as voxels no beam of 0 degrees then runs along voxel faces.
    """
    _, ny, nx = grid.shape
    nz = grid.tall * grid.shape[0]
    high, wide = pixel if isinstance(pixel, tuple) else (pixel, pixel)
    diagonal = math.hypot(nx, ny)
    height = nz + diagonal * abs(math.tan(math.radians(check_elevation(elevation_deg))))
    return _round_up(height / high, _pixels(nz / high)), _round_up(diagonal / wide, _pixels(ny / wide))


def _pixels(value: float) -> int:
    """Smallest whole number of at least `value` (to 1e-9)."""
    return math.ceil(value - 1e-9)


@checked
def picture_shape(
    grid: Grid, picture_width: float, aspect: float, elevation_deg: float = 0.0, pixel: int = 1
) -> tuple[int, int]:
    """``(rows, columns)`` of pictures on the screen raster.

    Parameters
    ----------
    picture_width
        Width of the picture as a fraction of the cube's width ``ny``.
    aspect
        Width of the picture divided by its height.
    elevation_deg
        Of the lamp, in degrees.
    pixel
        Width and height of a pixel in voxels, whole, from 1 to the cube's shortest side.

    Returns
    -------
    The nearest sizes with the raster's parities. A picture too high for the raster is made as high as the
    raster (at elevation 0: as the cube) and keeps its width.

    Raises
    ------
    InputError
        Where the picture would be wider than the cube's screen, a pixel larger than the cube, or a size not positive.
    """
    if not (math.isfinite(picture_width) and picture_width > 0):
        raise InputError(f"a picture width must be a positive fraction of the cube's width, not {picture_width}")
    if not (math.isfinite(aspect) and aspect > 0):
        raise InputError(f"an aspect (width / height) must be a positive number, not {aspect}")
    most_rows, most_columns = raster_shape(grid, elevation_deg, check_pixel(pixel, grid))
    across = grid.shape[1] / pixel
    columns = nearest(min(picture_width * across, most_columns + 2), most_columns)
    if columns > most_columns:
        raise InputError(
            f"a picture width of {picture_width:g} of the cube's is wider than its screen of {most_columns} pixels: "
            f"use at most {most_columns / across:.3f}"
        )
    rows = min(nearest(min(columns / aspect, most_rows + 2), most_rows), most_rows)
    return rows, columns


def nearest(value: float, parity: int) -> int:
    """Positive whole number nearest to `value` that is even or odd like `parity`."""
    odd = parity % 2
    return max(2 * round((value - odd) / 2) + odd, 2 - odd)


def check_tall(tall: float) -> None:
    """Raise `InputError` unless slices can be so tall in the width of their voxels."""
    if not 1e-3 <= tall <= 1e3:
        raise InputError(f"a slice is from 0.001 to 1000 times as tall as its voxels are wide, not {tall:g}")


def check_elevation(elevation_deg: float) -> float:
    """Return `elevation_deg` (degrees), or raise `InputError` unless it lies strictly between -90 and 90."""
    if not (math.isfinite(elevation_deg) and abs(elevation_deg) < 89.999):
        raise InputError(f"an elevation must lie between -90 and 90 degrees, both excluded, not {elevation_deg:g}")
    return float(elevation_deg)


def check_pixel(pixel: int, grid: Grid) -> int:
    """Return how many voxels a pixel is wide, or raise `InputError` unless it is 1 to the cube's shortest side."""
    if not 1 <= pixel <= grid.largest_pixel:
        raise InputError(
            f"a pixel is a whole number of voxels wide, from 1 to the {grid.largest_pixel} of the cube's shortest "
            f"side, not {pixel}"
        )
    return pixel


def dense_step_deg(grid: Grid) -> float:
    """Degrees between two angles for a picture to stand in between: 0.5 for 64 voxels across, as 1/n (measured)."""
    return 0.5 * 64 / max(grid.shape[1:])
