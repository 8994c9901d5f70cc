"""How well a cube will show its pictures, told before it is solved: by a rehearsal on a small cube.

What a cube can hold hardly depends on its number of voxels, as long as everything else keeps its proportions. So the
pictures and the cube are made small together, the small cube is solved, which takes about half a second, and what its
pictures reach tells what those of the large one will. The rehearsal knows all that counts by itself: the pictures,
their order and weights, mats, the lamp and its bounds, the elevation and the shapes.

The small pictures are area averages in linear light, whose values are then replaced, rank by rank, by those of the
large picture: averaging takes contrast away, and what is left would be too easy. Their finest detail is as strong as
what a large picture has at that size, so the rehearsal is too hard, the more so the smaller it is. With ``r`` the
large cube's width over the small one's, and ``q`` dB in the rehearsal, the prediction is the law

    ``q + (1 − 1/r) · (bias + growth · (q − 30) + level)``

where `level` is 0 under raised lamps. Where a solver stops because its pictures are good enough, all are lowered by
what they would be better than that together. A picture held over ±h degrees is held over ±h · r^HOLD in the small cube,
at most half the way to the next stop: over ±h it would be too easy, since fewer angles do for fewer voxels, and over
±h · r, which takes as many, too hard.

The constants are fitted by benchmarks/prediction.py on solved problems of 32 to 96 voxels, three quarters of them below
40 dB: 4 to 64 pictures, level and raised lamps of every kind and bound, photographs, grey and saturated ones, traced
scenes, masks, mats, holds. Fitted on even ones, the means of 37 odd ones, with photographs of other originals, were
told within 3 dB in 81 % (median error 1.3, 90 % below 4.0, largest 6.0), their worst pictures in 73 %; of all 75, means
in 88 %, worst pictures in 81 %. 50 stands for all that is above. Above 96 voxels it is extrapolated. By thin beams the
law is an earlier one, of 118 problems, told within 3 dB in 95 %.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from lightcube.backward import solving
from lightcube.backward.mat import widened
from lightcube.backward.pieces import Watching
from lightcube.backward.recipe import Recipe, recipe_of
from lightcube.backward.wishes import held
from lightcube.errors import InputError
from lightcube.forward.casting import cast
from lightcube.optics.arrays import Images, Reals, keep, locked
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid, nearest, raster_shape
from lightcube.optics.light import Beams, Light, finer, is_in_slices
from lightcube.optics.rig import Rig
from lightcube.optics.transfer import encode
from lightcube.pictures.resampling import shares
from lightcube.pictures.targets import Targets
from lightcube.planning.measured import raised
from lightcube.scoring.metrics import BEST_DB, psnr
from lightcube.wording import counted

#: Points of a pixel in a rehearsal.
POINTS = Light()
#: A small cube is at least so wide, in voxels.
_LEAST = 20
#: How small a hold shrinks with the cube.
HOLD = 0.7


class Rehearsal(NamedTuple):
    """Passes of a rehearsal, its work (beams times the cube's width, in voxels), and the fitted law, see above."""

    passes: int
    work: int
    bias: float
    growth: float
    level: float = 0.0


#: By thin beams, and where light is averaged over pixels.
THIN, AREA = Rehearsal(150, 150_000, 3.6, 0.12), Rehearsal(100, 2_900_000, 8.6, 0.255, -3.95)
#: Solvers that stop because pictures are good enough look rarely: they are so much better than asked for, dB.
_SPARE_DB = 1.0
#: Means and minima above this, dB, are told as this.
MOST_DB = 50.0


@dataclass(frozen=True, eq=False)
class Prediction:
    """What PSNR to expect of each picture, dB.

    Parameters
    ----------
    psnr
        ``(pictures,)``, in the order of the targets, 0 to 100; NaN where nobody knows.
    rehearsed
        Width in voxels of the small cube; 0 where there was none.
    """

    psnr: Reals
    rehearsed: int

    def __post_init__(self) -> None:
        check_fields(self)
        keep(self, psnr=np.float64)
        if self.psnr.ndim != 1 or not self.psnr.size:
            raise InputError(f"a prediction is of one PSNR for each picture, not of shape {self.psnr.shape}")

    @classmethod
    def unknown(cls, views: int) -> Prediction:
        """What is told of a room in which nothing was measured."""
        return cls(np.full(views, np.nan), 0)

    @property
    def is_known(self) -> bool:
        """Whether anything is told."""
        return self.rehearsed > 0

    def __repr__(self) -> str:
        if not self.is_known:
            return f"<who knows what is to be expected of {counted(len(self.psnr), 'picture')}>"
        pictures = counted(len(self.psnr), "picture")
        return f"<{self.psnr_mean:.1f} dB expected, {self.psnr_min:.1f} dB of the worst of {pictures}>"

    @property
    def psnr_mean(self) -> float:
        """Mean over the pictures, dB, at most 50; NaN where it is not known."""
        return min(float(np.mean(self.psnr)), MOST_DB) if self.is_known else math.nan

    @property
    def psnr_min(self) -> float:
        """The worst picture's, dB, at most 50; NaN where it is not known."""
        return min(float(np.min(self.psnr)), MOST_DB) if self.is_known else math.nan


@checked
def predict(targets: Targets, grid: Grid, recipe: Recipe | None = None) -> Prediction:
    """Predict the PSNR of each picture that `lightcube.solve` reaches by quality ``normal`` of method ``display``.

    Parameters
    ----------
    targets, grid, recipe
        As `lightcube.solve` takes them.

    Raises
    ------
    InputError
        Where `solve` would refuse them.
    """
    targets = replace(targets, rig=targets.rig.as_one_colour())
    raised(targets.rig, grid)
    asked = recipe or Recipe()
    small, width = rehearse(targets, grid, asked)
    level = targets.rig.elevation_deg == 0
    told = law(small, max(grid.shape[1:]) / width, rehearsal_of(asked), level=level, enough_db=asked.enough_db)
    return Prediction(told, width)


def rehearsal_of(recipe: Recipe) -> Rehearsal:
    """How a recipe is rehearsed."""
    return THIN if recipe.beams.is_thin else AREA


def law(small: Reals, ratio: float, by: Rehearsal, *, level: bool = False, enough_db: float = math.inf) -> Reals:
    """PSNR to expect, dB, of pictures that reached so much in a `small` cube, narrower by `ratio`; see the module."""
    more = by.bias + by.growth * (small - 30) + (by.level if level else 0.0)
    told = small + (1 - 1 / ratio) * more
    together = -10 * math.log10(float(np.mean(10 ** (-told / 10))))
    return np.clip(told - max(together - enough_db - _SPARE_DB, 0.0), 0.0, BEST_DB)


def rehearse(targets: Targets, grid: Grid, recipe: Recipe) -> tuple[Reals, int]:
    """PSNR of each picture in a small cube, dB, and the width of that in voxels; takes what `predict` does."""
    small, cube = rehearsed(targets, grid, recipe)
    return reached(small, cube), max(cube.grid.shape[1:])


def rehearsed(
    targets: Targets,
    grid: Grid,
    recipe: Recipe,
    *,
    width: int | None = None,
    passes: int | None = None,
    points: Light | None = None,
    start: Cube | None = None,
    callback: Watching | None = None,
) -> tuple[Targets, Cube]:
    """The small pictures of a rehearsal and the cube that is solved for them.

    Parameters
    ----------
    targets, grid, recipe
        As `predict` takes them.
    width, passes, points
        Voxels across, passes, and points of a pixel; None = what predictions are fitted to.
    start
        A small cube of before; one of another shape is not used.
    callback
        As `lightcube.solve` takes it.
    """
    solving.check_targets(targets, grid)
    held(targets.rig, recipe, grid)
    small, small_grid = reduced(targets, grid, width or _width(targets, grid, recipe))
    across = max(small_grid.shape[1:])
    bound = recipe.bounded_by.of_any_size(grid)
    light = recipe.beams if recipe.beams.is_thin else replace(points or POINTS, grain=recipe.beams.grain)
    asked = replace(recipe.by_display(passes or rehearsal_of(recipe).passes), material=bound, light=light)
    asked = replace(asked, hold_deg=_small_hold(targets, grid, recipe.hold_deg, across))
    begun = start if start is not None and start.grid.shape == small_grid.shape else None
    return small, solving.solve(small, small_grid, asked, start=begun, callback=callback).cube


def reached(small: Targets, cube: Cube) -> Reals:
    """PSNR of each picture of a rehearsal, dB."""
    light: Beams = "thin" if recipe_of(cube).beams.is_thin else "area"
    shown = encode(np.stack(list(cast(cube, light=light))), small.transfer)
    wanted = encode(small.pictures, small.transfer)
    return np.array([psnr(*each) for each in zip(shown, wanted, small.weight, strict=True)])


def reduced(targets: Targets, grid: Grid, width: int) -> tuple[Targets, Grid]:
    """Make a problem small: the cube about `width` voxels wide (at most), everything in nearly the same proportions.

    The cube keeps its size in mm, and the pictures their distribution of values in each colour. A pixel of which
    less than half has weight has none. What is small enough comes back as it is.
    """
    if max(grid.shape[1:]) <= width:
        return targets, grid
    elevation_deg = float(np.max(np.abs(targets.rig.views.elevations_deg)))
    shape, picture_shape = _proportioned(grid, targets.rig, elevation_deg, width)
    ratio = max(grid.shape[1:]) / max(shape[1:])
    pairs = [_shrunk(*each, picture_shape) for each in zip(targets.pictures, targets.weight, strict=True)]
    pictures, weights = (np.stack(arrays).astype(np.float32) for arrays in zip(*pairs, strict=True))
    small = Targets(
        locked(pictures),
        targets.rig.with_pixels(ratio, picture_shape),
        locked(weights),
        targets.names,
        targets.transfer,
    )
    return small, grid.coarser(shape, ratio)


def _width(targets: Targets, grid: Grid, recipe: Recipe) -> int:
    """Width of the small cube: what takes the work of a rehearsal, at two angles where pictures are held."""
    across = max(grid.shape[1:])
    pixels = math.prod(widened(targets.rig, grid, recipe.mat).picture_shape)
    fine = finer(recipe.beams if recipe.beams.is_thin else POINTS, targets.rig, grid)
    points = fine.row_points if is_in_slices(targets.rig, grid) else fine.points
    work = len(targets) * points * (2 if recipe.hold_deg else 1) * pixels * across
    return min(across, max(_LEAST, round(across * (rehearsal_of(recipe).work / work) ** (1 / 3))))


def _small_hold(targets: Targets, grid: Grid, hold_deg: float, width: int) -> float:
    """Degrees over which a cube of that `width` must hold its pictures to find it as hard as the large one."""
    return min(hold_deg * (max(grid.shape[1:]) / width) ** HOLD, targets.rig.widest_hold_deg)


def _proportioned(
    grid: Grid, rig: Rig, elevation_deg: float, width: int
) -> tuple[tuple[int, int, int], tuple[int, int]]:
    """Shapes of a cube not wider than `width` and of its pictures, all with parities as `raster_shape` has them.

    Of all widths down to four fifths of it, the one that keeps the proportions best: above all that of the pictures'
    area to the cube's, or of their widths where light is level.
    """
    nz, ny, nx = grid.shape
    (rows, columns), pixel, level = rig.picture_shape, rig.views.pixel_in(grid), elevation_deg == 0
    best = (math.inf, grid.shape, rig.picture_shape)
    for across in range(math.ceil(0.8 * width), width + 1):
        scale = across / max(nx, ny)
        small_y, small_x = nearest(ny * scale, across), nearest(nx * scale, across + nx - ny)
        for small_z in range(max(1, round(nz * scale) - 1), round(nz * scale) + 2):
            shape = (small_z, small_y, small_x)
            most_rows, most_columns = raster_shape(grid.coarser(shape, 1), elevation_deg, pixel)
            small_rows = min(nearest(rows * scale, most_rows), most_rows)
            small_columns = min(nearest(columns * scale, most_columns), most_columns)
            high, tall = math.log(small_rows / rows / scale), math.log(small_z / nz / scale)
            wide = math.log(small_columns / columns / scale) - math.log(small_y * small_x / (ny * nx) / scale**2) / 2
            high -= tall
            cost = wide**2 + 0.02 * high**2 if level else (wide + high) ** 2 + 0.3 * (wide**2 + high**2)
            cost += 0.1 * tall**2 + 0.01 * (1 - across / width) ** 2
            best = min(best, (cost, shape, (small_rows, small_columns)))
    return best[1], best[2]


def _shrunk(picture: Images, weight: Images, shape: tuple[int, int]) -> tuple[Reals, Reals]:
    """Picture ``(row, column, channel)`` and its weights ``(row, column)``, at fewer pixels."""
    down, across = shares(weight.shape[0], shape[0]), shares(weight.shape[1], shape[1]).T
    cover = down @ (weight > 0) @ across
    total = down @ weight.astype(np.float64) @ across
    kept = (cover >= min(0.5, float(cover.max())) - 1e-9) & (total > 0)
    light = np.ones((*shape, picture.shape[-1]))
    seen = picture[weight > 0][:: max(1, int(np.sum(weight > 0)) // 4096)]
    for channel in range(picture.shape[-1]):
        mean = (down @ (picture[..., channel] * weight.astype(np.float64)) @ across)[kept] / total[kept]
        light[kept, channel] = _ranked(mean, np.sort(seen[:, channel]))
    return light, np.where(kept, total / np.where(kept, cover, 1), 0)


def _ranked(values: Reals, ascending: Images) -> Reals:
    """`values`, each replaced by the mean of its share of the `ascending` ones."""
    sums = np.concatenate([[0.0], np.cumsum(ascending, dtype=np.float64)])
    ends = np.interp(np.linspace(0, len(ascending), len(values) + 1), np.arange(len(sums)), sums)
    result = np.empty_like(values)
    result[np.argsort(values, kind="stable")] = np.diff(ends) * len(values) / len(ascending)
    return result


def as_json(prediction: Prediction) -> dict[str, Any] | None:
    """A prediction for JSON, None where nothing is known."""
    if not prediction.is_known:
        return None
    each = [round(float(value), 2) for value in prediction.psnr]
    return {"psnr_mean": prediction.psnr_mean, "psnr_min": prediction.psnr_min, "pictures": each}
