"""A stack of printed films: a second kind of block, whose slices are thin sheets with room between them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals
from lightcube.optics.grid import Grid

#: A stack has no more films: beyond some eight, light that is reflected between loose ones drowns the pictures.
MOST_FILMS = 256
#: Indices of refraction of what may be between films.
_LEAST_INDEX, _MOST_INDEX = 1.0, 3.0


@dataclass(frozen=True, repr=False)
class Stack(Grid):
    """Films of square cells at heights of their own, centred at the origin, square to the z axis.

    A film is a slice of a `Grid` that is thin and lies by itself: where a beam meets it, it meets one cell. Its
    extinction (1/mm) is counted along a cell's width, as a voxel's is along its side: ``extinction * voxel_mm`` is the
    absorbance of a film that light meets upright, and under the angle t ``1 / cos t`` times that.

    Parameters
    ----------
    shape
        Number of films, and of the rows and columns of cells of each, ``(films, ny, nx)``.
    voxel_mm
        Width of a cell in mm.
    heights_mm
        Where the films lie, ascending, mm along z; none given = a cell's width apart, about the origin.
    index
        Index of refraction of what is between them, 1 to 3: 1 = air, 1.49 = acrylic.

    Raises
    ------
    InputError
        As `Grid`; and where films are not as many as their heights, or these do not ascend.

    Examples
    --------
    >>> import lightcube as lc
    >>> lc.Stack((5, 64, 64), voxel_mm=2.5, heights_mm=[-24, -12, 0, 12, 24])
    <stack of 5 films of 64 x 64 cells of 2.5 mm>
    """

    tall: float = field(default=1.0, init=False)
    heights_mm: tuple[float, ...] = ()
    index: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        count = self.shape[0]
        if count > MOST_FILMS:
            raise InputError(f"a stack has at most {MOST_FILMS} films, not {count}")
        heights = tuple(float(each) for each in self.heights_mm or _evenly(count, self.voxel_mm))
        if len(heights) != count or not all(np.isfinite(heights)) or np.any(np.diff(heights) < 0):
            raise InputError(
                f"a stack of {count} films has as many heights in mm that ascend, not {len(heights)}: {heights}"
            )
        if max(map(abs, heights)) > 1e6:
            raise InputError(f"films lie at most 1e6 mm from the middle of their stack, not {max(map(abs, heights)):g}")
        if not _LEAST_INDEX <= self.index <= _MOST_INDEX:
            raise InputError(f"an index of refraction between films lies between 1 and 3, not {self.index:g}")
        object.__setattr__(self, "heights_mm", heights)
        object.__setattr__(self, "index", float(self.index))
        apart = (heights[-1] - heights[0]) / max(count - 1, 1) or self.voxel_mm
        object.__setattr__(self, "tall", float(np.clip(apart / self.voxel_mm, 1e-3, 1e3)))

    def __repr__(self) -> str:
        films, ny, nx = self.shape
        return f"<stack of {films} films of {ny} x {nx} cells of {self.voxel_mm:.6g} mm>"

    @property
    def size_mm(self) -> tuple[float, float, float]:
        """Lengths of the stack along (z, y, x) in mm, films and what is between them."""
        _, ny, nx = self.shape
        return (self.heights_mm[-1] - self.heights_mm[0], ny * self.voxel_mm, nx * self.voxel_mm)

    @property
    def sides_in_words(self) -> str:
        """A cell's width in mm."""
        return f"{self.voxel_mm:.6g} mm"

    @property
    def steepest_deg(self) -> float:
        """Degrees from upright beyond which no light comes inside what is between the films: 90 in air."""
        return math.degrees(math.asin(1 / self.index))

    def coarser(self, shape: tuple[int, int, int], ratio: float) -> Stack:
        """As many films where they are, of so many cells (the last two numbers of `shape`), `ratio` times as large."""
        return Stack((self.shape[0], *shape[1:]), ratio * self.voxel_mm, heights_mm=self.heights_mm, index=self.index)

    def at(self, heights_mm: Reals) -> Stack:
        """The same films at other heights."""
        return replace(self, heights_mm=tuple(float(each) for each in heights_mm))


def _evenly(count: int, apart_mm: float) -> tuple[float, ...]:
    """Heights of so many films, so far apart, about the middle."""
    return tuple(((np.arange(count) - (count - 1) / 2) * apart_mm).tolist())
