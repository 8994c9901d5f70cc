"""Units of work: the parts of a cube that are independent of each other, and the smaller cubes that it starts from."""

from dataclasses import dataclass
from itertools import pairwise

from lightcube.optics.grid import Grid
from lightcube.pictures.resampling import halved
from lightcube.pictures.targets import Targets

#: Cubes longer than this start from the solution at half the size.
COARSEST = 48
#: Slabs are whole multiples of so many slices where there are enough of them: the kernels' vectors are full then.
_SLICES = 16


@dataclass(frozen=True)
class Part:
    """Colours and slices of a cube that are solved together; all of either are ``slice(0, count)``."""

    colours: slice
    slices: slice

    @property
    def columns(self) -> int:
        """How many pairs of a colour and a slice."""
        return (self.colours.stop - self.colours.start) * (self.slices.stop - self.slices.start)


def most_units(shape: tuple[int, int, int], channels: int, *, level: bool) -> int:
    """Into how many units a cube of ``(nz, ny, nx)`` voxels can be split: slices under a level lamp, else colours."""
    return shape[0] if level else channels


def split(shape: tuple[int, int, int], channels: int, count: int, *, level: bool) -> list[Part]:
    """Split a cube into so many units: slabs of slices under a level lamp, else groups of colours."""
    if not level:
        return [Part(some, slice(0, shape[0])) for some in _even(channels, count, 1)]
    grain = _SLICES if shape[0] >= _SLICES * count else 1
    return [Part(slice(0, channels), some) for some in _even(shape[0], count, grain)]


def _even(total: int, count: int, grain: int) -> list[slice]:
    """``0 .. total`` in `count` runs as even as can be, cut at multiples of `grain` only."""
    grains = -(-total // grain)
    cuts = [min(total, grain * (number * grains // count)) for number in range(count + 1)]
    return [slice(start, stop) for start, stop in pairwise(cuts)]


def halvings(grid: Grid) -> int:
    """How often a cube is halved until it is no longer than `COARSEST`."""
    length, times = max(grid.shape), 0
    while length > COARSEST:
        length, times = (length + 1) // 2, times + 1
    return times


def coarser(targets: Targets, grid: Grid, times: int) -> tuple[Targets, Grid]:
    """Return the same pictures and cube, halved so many times."""
    for _ in range(times):
        targets, grid = halved(targets, grid)
    return targets, grid


def coarse_shape(shape: tuple[int, int, int], times: int) -> tuple[int, int, int]:
    """``(nz, ny, nx)`` after so many halvings."""
    for _ in range(times):
        shape = ((shape[0] + 1) // 2, (shape[1] + 1) // 2, (shape[2] + 1) // 2)
    return shape
