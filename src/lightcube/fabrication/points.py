"""Points for a laser that marks glass inside: the brightness of a cube's voxels as blue noise.

A point scatters light, of all colours, and absorbs none: what comes out is an ornament that looks like the cube, and
casts none of its pictures.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.fabrication.boxes import edges, means
from lightcube.fabrication.noise import SIDE, blue_order
from lightcube.fabrication.planned import AXES, Advance, File, Planned, named
from lightcube.io._files import Replaceable
from lightcube.io._places import Place
from lightcube.optics.arrays import Reals, Volume
from lightcube.optics.checks import check_fields
from lightcube.optics.cube import Cube

#: Sites are so many spacings apart, and points stand up to half the rest off them: no two are nearer than a spacing.
_APART = 1.25
#: The part of all voxels with matter that are as dense as can be.
_FULL = 0.02
#: A job of more points takes hours: one a millisecond is usual.
MOST = 20_000_000
#: What such a thing is.
_NOTE = "decorative: points in glass scatter light and absorb none, so they cast none of the cube's pictures"
#: How a PLY file of coloured places in mm begins.
PLY_HEAD = """ply
format binary_little_endian 1.0
comment lightcube; lengths are millimetres, z is up
comment {comment}
element vertex {count}
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
"""
#: Light that the eye takes for brightness.
_EYE = np.array([0.2126, 0.7152, 0.0722])


def luminance(cube: Cube) -> Volume:
    """How much of the brightness a voxel takes, ``(z, y, x)``, 1/mm."""
    eye = _EYE if len(cube.extinction) == 3 else np.full(len(cube.extinction), 1 / len(cube.extinction))
    return np.einsum("c,czyx->zyx", eye.astype(np.float32), cube.extinction)


def check_seed(seed: int) -> None:
    """Raise `InputError` unless a seed is one."""
    if not 0 <= seed < 2**32:
        raise InputError(f"a seed is a whole number from 0 to {2**32 - 1}, not {seed}")


def check_matter(cube: Cube) -> None:
    """Raise `InputError` where a cube is clear all over."""
    if not np.any(cube.extinction > 0):
        raise InputError("the cube is clear all over, so nothing of it can be made: solve one first")


@dataclass(frozen=True)
class PointCloud:
    """How points are written.

    Parameters
    ----------
    spacing_um
        Micrometres that two points are apart at least, 20 to 2000: nearer ones crack the glass, 80 to 120 are usual.
    seed
        Of their places, from 0 on.
    """

    spacing_um: float = 100.0
    seed: int = 1

    called: ClassVar[str] = "points"
    suffixes: ClassVar[tuple[str, ...]] = (".ply",)
    replaceable: ClassVar[Replaceable] = None

    def __post_init__(self) -> None:
        check_fields(self)
        if not 20 <= self.spacing_um <= 2000:
            raise InputError(f"points are from 20 to 2000 micrometres apart, not {self.spacing_um:g}")
        check_seed(self.seed)

    def plan(self, cube: Cube, at: Place) -> Planned:
        """What would be written."""
        points = Points(cube, self.spacing_um / 1000, self.seed)
        if points.expected > MOST:
            most = self.spacing_um * (points.expected / MOST) ** (1 / 3)
            raise InputError(
                f"about {points.expected:.3g} points are more than the {MOST:g} that a job takes: let them be at least "
                f"{math.ceil(most)} micrometres apart (--spacing-um {math.ceil(most)})"
            )

        def write(path: Path, advance: Advance) -> None:
            _write(path, points, advance)

        facts = {
            "size_mm": named(cube.grid.size_mm[::-1]),
            "axes": AXES,
            "spacing_mm": self.spacing_um / 1000,
            "about": round(points.expected),
            "seed": self.seed,
        }
        return Planned((File(at, write),), facts, (_NOTE,))


def _write(path: Path, points: Points, advance: Advance) -> None:
    """Write points as binary PLY, white; how many there are stands in its head when all are known."""
    corner = np.dtype([("place", "<f4", 3), ("colour", "u1", 3)])
    head = (PLY_HEAD + "end_header\n").format
    count, layers = 0, points.sites[0]
    with path.open("w+b") as file:
        file.write(head(comment=_NOTE, count=f"{0:012d}").encode())
        for number, places in enumerate(points.layers(), 1):
            made = np.empty(len(places), corner)
            made["place"], made["colour"] = places, 255
            file.write(made.tobytes())
            count += len(places)
            advance(number, layers)
        if not count:
            raise InputError("the block is too small or too clear for a point: let points be nearer (--spacing-um)")
        file.seek(0)
        file.write(head(comment=_NOTE, count=f"{count:012d}").encode())


class Points:
    """Points of a cube, layer by layer.

    Parameters
    ----------
    spacing_mm
        No two are nearer to each other.
    seed
        Of their places.
    """

    def __init__(self, cube: Cube, spacing_mm: float, seed: int) -> None:
        check_matter(cube)
        dark = luminance(cube)
        full = float(np.quantile(dark[dark > 0], 1 - _FULL))
        self._chance = np.minimum(dark / full, 1)
        self._grid, self._seed, self._side = cube.grid, seed, _APART * spacing_mm
        self._off = (_APART - 1) / 2 * spacing_mm

    @property
    def sites(self) -> tuple[int, int, int]:
        """How many sites there are along z, y and x, each of which may be a point."""
        nz, ny, nx = (max(1, int((mm - 2 * self._off) / self._side)) for mm in self._grid.size_mm)
        return nz, ny, nx

    @property
    def expected(self) -> float:
        """About how many points there will be."""
        return float(self._chance.mean(dtype=np.float64)) * float(np.prod([float(each) for each in self.sites]))

    def layers(self) -> Iterator[Reals]:
        """Yield the points of each layer of sites, ``(points, 3)``: x, y and z in mm around the block's middle."""
        order = blue_order((1.0, 1.0, 1.0))
        cuts = [
            edges(count, self._side, voxels, mm)
            for count, voxels, mm in zip(self.sites, self._grid.shape, self._grid.sides_mm[::-1], strict=True)
        ]
        for number, (low, high) in enumerate(zip(cuts[0][:-1], cuts[0][1:], strict=True)):
            first, last = max(0, int(np.floor(low))), min(self._grid.shape[0], int(np.ceil(high)))
            plane = means(self._chance[first:last], 0, np.array([low, high]) - first)[0]
            chance = means(means(plane, 0, cuts[1]), 1, cuts[2])
            random = np.random.default_rng([self._seed, number])
            yield self._points(number, chance, order[number % SIDE], random)

    def _points(self, number: int, chance: Reals, ranks: NDArray[np.uint16], random: np.random.Generator) -> Reals:
        """The points of a layer."""
        _, rows, columns = self.sites
        tiled = ranks[np.ix_(np.arange(rows) % SIDE, np.arange(columns) % SIDE)]
        y, x = np.nonzero((tiled + random.random()) / SIDE**3 < chance)
        places = np.stack([x, y, np.full(len(x), number)], axis=1).astype(np.float64)
        middle = (np.array(self.sites[::-1]) - 1) / 2
        return (places - middle) * self._side + random.uniform(-self._off, self._off, places.shape)
