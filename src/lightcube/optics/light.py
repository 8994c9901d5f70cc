"""Light on areas: a pixel shows the mean of the light over its square, and over its lamp's disc where that has a size.

One beam through a pixel's middle is the paper's model, *thin*; a wall, a camera and an eye see means. Means are taken
over points, each of which is a view of its own: the same room with the pixels moved by a fraction of their size.

Points are a lattice of rank 1, ``((i + 1/2) / N, ((g i + s) mod N + 1/2) / N)`` for i = 0 ... N - 1, with the whole
numbers g and s of least centred discrepancy: the error of a mean is bounded by that times how much the light varies
(F. J. Hickernell, A generalized discrepancy and quadrature error bound, Math. Comp. 67 (1998) 299-322). How near cubes
come to their pictures follows it closely (docs/light.md). Where the lamp is level and a pixel is exactly one slice
high, light does not change from the bottom of a pixel to its top, and points lie side by side instead.

What is cast is judged at other points than any that a cube is solved for: a cube does best where it is looked at.

Nearer, a pixel is shown in parts, each the mean over its own area, and what stands around a picture is shown at fewer
points: `in_parts`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals, locked
from lightcube.optics.checks import check_fields
from lightcube.optics.grid import PARALLEL, Grid
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack

#: Means over areas, or the one beam through each pixel's middle.
Beams = Literal["area", "thin"]
#: Points of a pixel that what is cast is judged at: a Fibonacci lattice; side by side; and of a lamp's disc.
JUDGE, JUDGE_ROW, JUDGE_DISC = 55, 16, 16
JUDGE_STEP = 34
#: Points of a pixel around a picture, and side by side: as many as cubes are solved for. Display values of 64-cubes are
#: off by 0.007 and 0.004 (root of the mean square; `benchmarks/light.py play`), pictures at the judge's by 0.002.
AROUND, AROUND_ROW = 13, 7
#: A pixel is shown in so many parts a side at most; each has so many points at least, in a row too. With no fewer
#: points a pixel in all than the judge has, parts are off by 0.003 at most.
MOST_ZOOM, _PART = 16, 4
#: So many times as many points are taken of a pixel under a lamp with a disc. With no more than without one, cubes that
#: knew of a disc of half a degree were up to 5 dB worse under it than those that did not; so they are better.
DISC_TIMES = 3
#: Pixels of several voxels have as many times as many points, up to so many, and so many in a row. Pixels of 2 x 2 came
#: out 4 to 7 dB better for it (docs/light.md); of pixels of one voxel more bring nothing.
ENOUGH_POINTS, ENOUGH_ROW = 34, 15
#: No more points are taken of a pixel, and they weigh no more together beside its mean.
MOST_POINTS, MOST_GRAIN = 1024, 2.0
#: Distances between two points that are looked at where a lattice is chosen; of many points fewer lattices are tried.
_LOOKED_AT = 50_000_000
#: Of so many orders the one is taken in which a disc's seeds go with a pixel's points.
_ORDERS = 128
#: The part of a golden turn: what the seeds of a sunflower lie apart.
_GOLDEN = math.pi * (3 - math.sqrt(5))


@dataclass(frozen=True)
class Light:
    """How finely light is averaged over pixels, and over lamps that have a size, where a cube is solved.

    Parameters
    ----------
    points
        Of each pixel that is a voxel wide, 1 to 1024; 1 = the beam through its middle. Three times as many where its
        lamp has a disc; of a pixel of several voxels as many times as many, up to 34.
    row_points
        Where the lamp is level and a pixel is exactly one slice high: so many along its row; where that is several
        voxels wide as many times as many, up to 15. An odd multiple of 16 would have the points that all is judged
        by, and is one more.
    grain
        How much it counts, 0 to 2, that a pixel shows its value at its points too and not only on average: the more,
        the smoother it is from near by, and the less exact from afar.

    Examples
    --------
    >>> import lightcube as lc
    >>> lc.Light(), lc.Light.thin().is_thin
    (Light(points=13, row_points=7, grain=0.0), True)
    """

    points: int = 13
    row_points: int = 7
    grain: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        for count in (self.points, self.row_points):
            if not 1 <= count <= MOST_POINTS:
                raise InputError(f"a pixel is averaged over 1 to {MOST_POINTS} points, not {count}")
        if not 0 <= self.grain <= MOST_GRAIN:
            raise InputError(f"points of a pixel weigh 0 to {MOST_GRAIN:g} beside its mean, not {self.grain:g}")
        object.__setattr__(self, "grain", float(self.grain))

    @classmethod
    def thin(cls) -> Light:
        """One beam through the middle of each pixel, from the middle of each lamp: the paper's model."""
        return cls(1, 1)

    @property
    def is_thin(self) -> bool:
        """Whether there is one beam a pixel."""
        return self.points == self.row_points == 1 and not self.grain


def finer(light: Light, rig: Rig, grid: Grid) -> Light:
    """A light with the points that pixels of a rig have, which are more where pixels are several voxels large."""
    high, wide = _voxels_in(rig, grid)
    if light.is_thin or high * wide == 1:
        return light
    points = max(light.points, min(light.points * high * wide, ENOUGH_POINTS))
    return replace(light, points=points, row_points=max(light.row_points, min(light.row_points * wide, ENOUGH_ROW)))


def _voxels_in(rig: Rig, grid: Grid) -> tuple[int, int]:
    """How many slices a pixel is high and how many voxels wide, at least, where its light passes the cube's middle."""
    views = rig.views
    lamps, near = views.lamps[:, :3], views.lamps[:, 3] != 0
    far_mm = np.where(near, np.linalg.norm(lamps - views.origins_mm, axis=1), 1.0)
    narrower = np.where(near, np.linalg.norm(lamps, axis=1), 1.0) / far_mm
    sides = (views.row_steps_mm, grid.slice_mm), (views.column_steps_mm, grid.voxel_mm)
    high, wide = (max(1, int(np.min(np.linalg.norm(step, axis=1) * narrower) / mm + 1e-6)) for step, mm in sides)
    return high, wide


def bundle(light: Light, *, in_slices: bool) -> tuple[Reals, Reals]:
    """Points of a pixel as `Rig.split` takes them, under a lamp without a disc and under one with a disc."""
    if in_slices:
        points = _bare(_unlike_the_judge(light.row_points))
        return points, points
    return _bare(lattice(light.points)), soft_lattice(min(DISC_TIMES * light.points, MOST_POINTS))


def judged(rig: Rig, grid: Grid) -> Rig:
    """Each view as those that what is cast is judged by: 55 points a pixel, 16 in a row, times 16 of a lamp's disc.

    Or exact means, where they can be had, times as many of a disc.
    """
    return discs_sampled(rig).squared(1.0) if is_exact(rig, grid) else _judged(rig, judge_points(rig, grid))


def judged_one_by_one(rig: Rig, grid: Grid) -> list[Rig]:
    """The rig at each of the points of a pixel that it is judged by: the mean of their pictures is `judged`'s."""
    return [_judged(rig, point[None]) for point in judge_points(rig, grid)]


def check_zoom(zoom: int) -> int:
    """Return parts of a pixel a side, or raise `InputError` where there cannot be so many."""
    if not 1 <= zoom <= MOST_ZOOM:
        raise InputError(f"a zoom is a whole number from 1 to {MOST_ZOOM}, of parts a side of each pixel, not {zoom}")
    return zoom


def in_parts(rig: Rig, grid: Grid, beams: Beams, zoom: int, *, around: bool = False) -> list[list[Rig]]:
    """Rigs ``[row][column]`` of the parts that each pixel is shown in, `zoom` a side, each the mean over its own area.

    Where light is the same from a pixel's bottom to its top there is one row of them, which stands for all.

    Parameters
    ----------
    beams
        Of thin beams each part has the one through its middle.
    around
        Whether it is what stands around pictures, which takes fewer points.
    """
    row, exact = is_in_slices(rig, grid), beams != "thin" and is_exact(rig, grid)
    middles = (np.arange(zoom) + 0.5) / zoom - 0.5
    points = np.zeros((1, 2)) if beams == "thin" or exact else _part_points(zoom, row=row, around=around)
    cut = _split if beams == "thin" else _judged
    rigs = [[cut(rig, points / zoom + (across, down)) for across in middles] for down in ([0.0] if row else middles)]
    return [[part.squared(1 / zoom) for part in line] for line in rigs] if exact else rigs


def _part_points(zoom: int, *, row: bool, around: bool) -> Reals:
    """``(count, 2)``: right and down from a part's middle, in sides of the part."""
    if zoom == 1 and not around:
        return _judge(row)
    if row:
        return side_by_side(max(_PART, math.ceil((AROUND_ROW if around else JUDGE_ROW) / zoom)))
    return lattice(max(_PART, math.ceil((AROUND if around else JUDGE) / zoom**2)))


def discs_sampled(rig: Rig) -> Rig:
    """Each view under a lamp with a size as those of the judge's points of its disc, through the middles of pixels."""
    return _judged(rig, np.zeros((1, 2)))


def _split(rig: Rig, points: Reals) -> Rig:
    """Each view as those through some points of its pixels, from the middle of its lamp."""
    return rig.split([_bare(points)] * len(rig.views))


def _judged(rig: Rig, points: Reals) -> Rig:
    """Each view as those through some points of its pixels, from 16 of its lamp's disc where it has one."""
    soft = np.hstack([np.repeat(points, JUDGE_DISC, axis=0), np.tile(seeds(JUDGE_DISC), (len(points), 1))])
    return rig.split([soft if disc_deg else _bare(points) for disc_deg in rig.sums.disc_deg])


def judge_points(rig: Rig, grid: Grid) -> Reals:
    """``(55, 2)`` or, in a row, ``(16, 2)``: right and down from a pixel's middle, in pixels."""
    return _judge(is_in_slices(rig, grid))


def _judge(row: bool) -> Reals:
    """The judge's points: in a row, or of a square."""
    return side_by_side(JUDGE_ROW) if row else _rank_1(JUDGE, JUDGE_STEP, 0)


def is_exact(rig: Rig, grid: Grid) -> bool:
    """Whether means over pixels are taken exactly: those of films whose cells lie along the pixels."""
    if not isinstance(grid, Stack):
        return False
    from lightcube.optics.films import are_exact  # here: the compiler comes with it

    return are_exact(grid, rig)


def is_in_slices(rig: Rig, grid: Grid) -> bool:
    """Whether all light is parallel, level, without a disc, and each pixel as high as the slice that it is before.

    And stays in it: a sphere bends what is above and below its middle.
    """
    if rig.glass is not None and rig.glass.form == "sphere":
        return False
    views, side = rig.views, grid.slice_mm
    rows, _ = views.picture_shape
    level = np.abs(views.lamps[:, 2]) < PARALLEL * np.linalg.norm(views.lamps[:, :3], axis=1)
    upright = np.all(np.abs(views.row_steps_mm - np.array([0.0, 0.0, -side])) < 1e-9 * side, axis=1)
    upright &= np.abs(views.column_steps_mm[:, 2]) < 1e-9 * side
    lowest = views.origins_mm[:, 2] / side - (rows - 1) / 2 + grid.shape[0] / 2
    between = np.abs(np.remainder(lowest, 1) - 0.5) < 1e-9
    return bool(np.all((views.lamps[:, 3] == 0) & level & upright & between & (rig.sums.disc_deg == 0)))


def side_by_side(count: int) -> Reals:
    """``(count, 2)``: midpoints along a pixel's row."""
    return np.stack([(np.arange(count) + 0.5) / count - 0.5, np.zeros(count)], axis=1)


@lru_cache(maxsize=64)
def lattice(count: int) -> Reals:
    """``(count, 2)``: points of a pixel, right and down from its middle, of least discrepancy; none of the judge's."""
    if count == 1:
        return locked(np.zeros((1, 2)))
    steps = [step for step in range(1, count) if math.gcd(step, count) == 1] or [1]
    pairs = [(step, start) for step in steps for start in range(count)]
    pairs = pairs[:: -(-len(pairs) * count**2 // _LOOKED_AT)]
    judge = {tuple(point) for point in np.round(_rank_1(JUDGE, JUDGE_STEP, 0), 9)}
    best = math.inf, np.zeros((count, 2))
    for step, start in pairs:
        points = _rank_1(count, step, start)
        discrepancy = _centred_discrepancy(points)
        if discrepancy < best[0] - 1e-12 and not judge.intersection(map(tuple, np.round(points, 9))):
            best = discrepancy, points
    return locked(best[1])


def seeds(count: int) -> Reals:
    """``(count, 2)``: points spread evenly over a disc of radius 1, like a sunflower's seeds; their mean is its middle.

    H. Vogel, A better way to construct the sunflower head, Math. Biosciences 44 (1979) 179-189.
    """
    number = np.arange(count) + 0.5
    radius, turn = np.sqrt(number / count), number * _GOLDEN
    disc = radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return np.asarray(disc - np.mean(disc, axis=0))


@lru_cache(maxsize=64)
def soft_lattice(count: int) -> Reals:
    """``(count, 4)``: the `lattice`'s points, each with a seed of a disc; seeds in the order of least discrepancy.

    In many another order the places of points and seeds go together, and more of them bring nothing.
    """
    points, number = lattice(count), np.arange(count)
    turns = np.stack([(number + 0.5) / count, number * _GOLDEN / math.tau % 1], axis=1) - 0.5  # seeds, on a square
    steps = [step for step in range(1, count) if math.gcd(step, count) == 1] or [1]
    tried = min(_ORDERS, _LOOKED_AT // count**2)
    orders = [step * number % count for step in steps[:: -(-len(steps) // tried)]]
    best = min(orders, key=lambda order: _centred_discrepancy(np.hstack([points, turns[order]])))
    return locked(np.hstack([points, seeds(count)[best]]))


def _rank_1(count: int, step: int, start: int) -> Reals:
    """Points of a lattice of rank 1 about 0, ``(count, 2)``."""
    number = np.arange(count)
    return np.stack([number + 0.5, (step * number + start) % count + 0.5], axis=1) / count - 0.5


def _centred_discrepancy(points: Reals) -> float:
    """The square of the centred discrepancy of points in ``[-1/2, 1/2]^d`` (Hickernell's equation 5.1c)."""
    away, count = np.abs(points), len(points)
    apart = np.abs(points[:, None] - points)
    one = np.prod(1 + (away - away**2) / 2, axis=1).sum()
    two = np.prod(1 + (away[:, None] + away - apart) / 2, axis=2).sum()
    return float((13 / 12) ** points.shape[1] - 2 / count * one + two / count**2)


def _unlike_the_judge(count: int) -> Reals:
    """Midpoints along a row; one more of them where the judge's would be among them."""
    return side_by_side(count + 1 if count % (2 * JUDGE_ROW) == JUDGE_ROW else count)


def _bare(points: Reals) -> Reals:
    """Points of pixels under the middle of a lamp."""
    return np.hstack([points, np.zeros_like(points)])
