"""Targets and a grid as a solver sees them."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.backward.dyed import solve_amounts
from lightcube.backward.mat import framed, inner, weights_beyond
from lightcube.backward.recipe import Powers, Recipe
from lightcube.backward.units import Part
from lightcube.backward.wishes import Asked, asked
from lightcube.kernels.layout import (
    columns_from_pictures,
    columns_from_volume,
    volume_from_columns,
)
from lightcube.optics.arrays import Counts, Flags, Images, Reals
from lightcube.optics.dyes import Dyes
from lightcube.optics.grid import Grid
from lightcube.optics.law import Mixture
from lightcube.optics.light import judged
from lightcube.optics.refraction import bent
from lightcube.optics.rig import Rig
from lightcube.optics.transfer import decode, encode
from lightcube.optics.views import Views
from lightcube.pictures.targets import Targets
from lightcube.projection.limits import ROOM
from lightcube.projection.projector import Projector
from lightcube.projection.shadows import Shadows
from lightcube.solvers.contract import Bounds, Lighting, Result, Wanted
from lightcube.solvers.method import Method

Floats = NDArray[np.floating[Any]]


@dataclass(frozen=True, eq=False)
class Problem:
    """The matrix, the wanted light of every beam, and which lamp it is of, for a part of the cube.

    Columns are independent of each other.

    Parameters
    ----------
    matrix
        Of all views, those of a stop one after the other.
    light, weights
        Linear light above 0, and at least 0: of every beam, ``(matrix.shape[0], columns)``, or where beams add up, of
        every pixel.
    lighting
        The lamp power that each view of the matrix has, and how views add up to pictures.
    part
        Colours and slices of the cube; their columns are all that is here.
    rows
        Rows of the pictures that the part is seen in.
    targets
        What is wanted at the stops themselves.
    stop
        ``(pictures of the matrix,)``: which of the targets each is for.
    judge
        The rig of the targets by the beams that what is cast is judged by, and which power each of its views has.
    dyes
        What voxels are mixed of, 1/mm: then unknowns are parts of their limits. None = unknowns are extinction.
    """

    matrix: Projector
    light: Floats
    weights: Floats
    lighting: Lighting
    part: Part
    rows: slice
    targets: Targets
    stop: Counts
    judge: tuple[Rig, NDArray[np.intp]]
    dyes: Dyes | None = None

    @property
    def channels(self) -> int:
        """Colours of the part: column ``j`` is of the colour ``j % channels`` of these."""
        return self.part.colours.stop - self.part.colours.start

    @property
    def slices(self) -> int:
        """Slices of the part."""
        return self.part.slices.stop - self.part.slices.start

    @property
    def _voxels(self) -> int:
        return self.matrix.grid.shape[1] * self.matrix.grid.shape[2]

    def voxels(self, x: Floats) -> Floats:
        """``(channel, z, y, x)`` extinction of the unknowns `x`, or ``(dye, z, y, x)`` amounts: those of the part."""
        return voxels_from_unknowns(x, (self.slices, *self.matrix.grid.shape[1:]), self.channels, self.dyes)

    def unknowns(self, voxels: Floats) -> Floats:
        """Inverse of `voxels`."""
        if self.dyes is None:
            return columns_from_volume(voxels).reshape(self.matrix.shape[1], -1)
        parts = voxels / self.dyes.limit.astype(voxels.dtype)[:, None, None, None]
        return np.ascontiguousarray(parts.transpose(0, 2, 3, 1)).reshape(len(parts) * self.matrix.shape[1], -1)

    def extinction(self, x: Floats) -> Floats:
        """``(channel, z, y, x)`` of the unknowns `x`: that of the part."""
        return self.voxels(x) if self.dyes is None else self.dyes.mixed(self.voxels(x))

    def solve(self, method: Method, lamp_bounds: tuple[Floats, Floats], bounds: Bounds, **options: Any) -> Result:
        """Solve by a method: without dyes extinction within bounds, and what else a solver takes."""
        wanted = self.wanted(lamp_bounds)
        if self.dyes is not None:
            return solve_amounts(method, self.matrix, wanted, self.dyes, **options)
        return method.solve(self.matrix, wanted, bounds=bounds, **options)

    @property
    def is_lit(self) -> Flags:
        """``(z, y, x)``: voxels that some beam goes through."""
        beams = np.ones((self.matrix.shape[0], 1), self.light.dtype)
        return np.asarray(voxels_from_unknowns(self.matrix.adjoint(beams), self.matrix.grid.shape, 1)[0] > 0)

    def wanted(self, lamp_bounds: tuple[Floats, Floats]) -> Wanted:
        """What a solver is to reach with lamps whose powers are within these bounds, each ``(lamps, channels)``."""
        return Wanted(self.light, self.weights, self.lighting, lamp_bounds, self.targets.transfer)

    def shown(self, x: Floats, powers: Floats) -> Images:
        """What unknowns `x` and lamps of powers ``(lamps, channels)`` show at the stops, as it is judged, linear light.

        ``(stop, row, column, channel)`` of the part: `rows` and colours only.
        """
        columns = x.reshape(self._voxels, -1) if self.dyes is None else columns_from_volume(self.extinction(x))
        shown = self._judge(columns, np.asarray(powers[self.judge[1]], np.float64))
        return np.stack(list(shown)).astype(np.float32, copy=False)

    @cached_property
    def _judge(self) -> Shadows:
        return Shadows(self.matrix.grid, self.judge[0], self.rows, self.part.colours)

    def error(self, x: Floats, powers: Floats) -> float:
        """The mean squared difference, in display values, of what is `shown` from what is wanted."""
        targets, weight = self.targets, self.targets.weight[:, self.rows]
        wanted = encode(targets.pictures[:, self.rows, :, self.part.colours], targets.transfer)
        off = np.mean((encode(self.shown(x, powers), targets.transfer) - wanted) ** 2, axis=-1, dtype=np.float64)
        total = float(np.sum(weight, dtype=np.float64))
        return float(np.sum(weight * off)) / total if total else 0.0

    def pixels(self, rejected: NDArray[np.int64]) -> NDArray[np.int64]:
        """(stop, row, column, channel) of rejected (equation, column) pairs, each once."""
        flat = rejected[:, 0] * self.light.shape[1] + rejected[:, 1]
        rows, colours = self.rows, self.part.colours
        shape = (
            len(self.stop),
            self.matrix.views.picture_shape[1],
            rows.stop - rows.start,
            self.channels,
        )
        view, column, lifted, channel = np.unravel_index(flat, shape)
        pixels = [self.stop[view], rows.stop - 1 - lifted, column, colours.start + channel]
        return np.unique(np.stack(pixels, axis=1).astype(np.int64), axis=0)


def powers_of_pictures(targets: Targets, powers: Floats, recipe: Recipe) -> Reals:
    """The powers of each picture's lamps, as a cube keeps them, from those that are solved for."""
    own = powers[targets.rig.pairs[:, 1]] if recipe.powers == "shared" else powers
    return np.array(own, np.float64)


def voxels_from_unknowns(x: Floats, shape: tuple[int, int, int], channels: int, dyes: Dyes | None = None) -> Floats:
    """``(channel, z, y, x)`` of a grid of `shape` ``(nz, ny, nx)`` from the unknowns that a solver finds.

    Of dyes ``(dye, z, y, x)``: amounts of these.
    """
    if dyes is None:
        return volume_from_columns(x.reshape(shape[1] * shape[2], -1), shape, channels)
    nz, ny, nx = shape
    amounts = x.reshape(-1, ny, nx, nz) * dyes.limit.astype(x.dtype)[:, None, None, None]
    return amounts.transpose(0, 3, 1, 2)


def is_level(grid: Grid, views: Views) -> bool:
    """Tell whether each slice of the cube casts one row of the pictures, by itself."""
    from lightcube.projection.stacked import StackedBeams, is_stacked  # here: the compiler comes with them

    return is_stacked(grid, views) and StackedBeams(grid, views).level


def pose(targets: Targets, grid: Grid, recipe: Recipe, part: Part | None = None, *, room: int = ROOM) -> Problem:
    """Pose the problem of the cube `grid` whose shadows are `targets`, by a recipe.

    Only the columns of `part` are made: None = all colours and slices; some slices only where `is_level`. `room` is the
    matrix's.

    Pixels darker than the screen's black are wanted at it. The ends of a hold by thin beams, with nothing to hold on to
    beyond, count twice: else they are what falls apart first (measured).
    """
    all_that = asked(targets.rig, grid, recipe)
    rig, views = all_that.rig, all_that.rig.views
    wanted, heavy = _wanted(targets, grid, recipe, all_that)
    matrix = Projector(grid, rig, (heavy > 0)[rig.sums.picture], room=room)
    darkest = decode(targets.rig.screens.black[targets.rig.stops.screen].astype(np.float32), targets.transfer)
    high, channels = views.picture_shape[0], targets.pictures.shape[-1]
    part = part or Part(slice(0, channels), slice(0, grid.shape[0]))
    rows = slice(0, high)  # of the pictures, which have no mat above and below where a part has some slices only
    if part.slices != slice(0, grid.shape[0]):
        rows = slice(high - part.slices.stop, high - part.slices.start)

    def block(pictures: Floats) -> Floats:
        columns = columns_from_pictures(pictures.astype(recipe.dtype))
        return columns.reshape(columns.shape[0] * (1 if matrix.level else high), -1)

    light = np.maximum(wanted[:, rows, :, part.colours], darkest[all_that.stop, None, None, None])
    own = np.repeat(heavy[:, rows, :, None], part.colours.stop - part.colours.start, axis=-1)
    loss, seen = _loss(rig, own[..., 0])
    mixture = None if rig.is_thin or loss is not None else Mixture.of(rig, channels, part.colours, rows)
    if mixture is not None:
        mixture = mixture.in_parts(matrix.parts, matrix.areas)
    lamp = lamp_numbers(targets.rig, rig, all_that.stop, recipe.powers).repeat(matrix.parts)
    return Problem(
        matrix=matrix,
        light=block(light),
        weights=block(own * seen[..., None]),
        lighting=Lighting(lamp, mixture, loss),
        part=part,
        rows=rows,
        targets=targets,
        stop=all_that.stop,
        judge=_judging(targets.rig, recipe, grid),
        dyes=None if recipe.dyes is None else recipe.dyes.in_block(grid),
    )


def _loss(rig: Rig, weights: Images) -> tuple[Floats | None, Flags]:
    """What glass takes of the light of single beams, as absorbance ``(equations, 1)``, and which pixels have a beam.

    None where pictures are sums, or light passes the glass where it counts: then it is no plain factor.
    """
    all_of_them = np.ones(weights.shape, np.bool_)
    if rig.glass is None or not replace(rig, glass=None).is_thin:
        return None, all_of_them
    found = bent(rig)
    if np.any(found.beside[weights > 0]):
        return None, all_of_them
    lit = found.through > 0
    taken = -np.log(np.where(lit, found.through, 1.0))
    return np.ascontiguousarray(taken[:, ::-1].swapaxes(1, 2)).reshape(-1, 1), lit


def _wanted(targets: Targets, grid: Grid, recipe: Recipe, all_that: Asked) -> tuple[Images, Images]:
    """Linear light of the matrix's pictures, ``(picture, row, column, channel)``, and how much each pixel counts."""
    mat, own = recipe.mat, targets.rig
    frames = framed(targets, grid, mat)
    inside = np.zeros(frames.weight.shape[1:], np.float32)
    inside[inner(own, grid, mat)] = 1
    light, heavy = frames.pictures[all_that.stop], frames.weight[all_that.stop]
    for number, wish in enumerate(all_that.wishes):
        here = all_that.wish == number
        if mat is not None and wish.is_beyond:
            light[here] = decode(np.array(mat.tone, np.float32), targets.transfer)
            heavy[here] = weights_beyond(own, grid, mat, wish.place)[all_that.stop[here]]
        else:
            heavy[here] *= wish.picture * inside + wish.mat * (1 - inside)
    last = all_that.angle.max()
    if last and recipe.beams.is_thin:
        heavy[(all_that.angle == 0) | (all_that.angle == last)] *= 2
    return light, heavy


def _judging(rig: Rig, recipe: Recipe, grid: Grid) -> tuple[Rig, NDArray[np.intp]]:
    """The beams that what is cast is judged by, the thin ones where it is solved for them, and the power of each."""
    judge = rig if recipe.beams.is_thin else judged(rig, grid)
    return judge, lamp_numbers(rig, judge, np.arange(len(rig)), recipe.powers)


def lamp_numbers(rig: Rig, asked_rig: Rig, stop: Counts, powers: Powers) -> NDArray[np.intp]:
    """``(views,)``: which power each view has of a rig whose pictures are for those of the stops `stop`.

    Every lamp has one for each picture, or one (``"shared"``).
    """
    if powers == "shared":
        return asked_rig.sums.lamp
    lamps = len(rig.lamps.names)
    keys = rig.pairs[:, 0] * lamps + rig.pairs[:, 1]
    return np.searchsorted(keys, stop[asked_rig.sums.picture] * lamps + asked_rig.sums.lamp)
