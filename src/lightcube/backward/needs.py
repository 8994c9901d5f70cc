"""What a job needs: memory, units that fit into it, and time."""

import math
import time
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from lightcube.backward.job import Job, shares
from lightcube.backward.problem import Problem, pose
from lightcube.backward.units import coarse_shape, coarser, split
from lightcube.backward.wishes import asked
from lightcube.kernels.layout import is_worth_lines
from lightcube.optics.grid import Grid
from lightcube.optics.light import judged
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.pictures.targets import Targets
from lightcube.projection.limits import PIECE, ROOM
from lightcube.projection.projector import Projector
from lightcube.projection.shadows import FEW_PIXELS
from lightcube.solvers.method import Method

#: Bytes that a job may need unless it is said: a fixed number, so that cubes do not depend on machines.
MEMORY = 6_000_000_000
#: Bytes of the program itself, with numpy, numba and what they compile (measured).
PROGRAM = 260_000_000
#: Bytes for each equation of a column, or each pixel of sums: which lamp it belongs to, and the like (measured).
_EQUATION = 36
#: Bytes for each voxel that a beam runs through, where the method holds the matrix (measured).
_ENTRY = 40
#: Degrees of elevation that stand for beams that are not level in other ways.
_ANY = 35.0
#: Bytes for each pixel of a view where light or shadows fade: what falls on it, and its shadow's strength (measured).
_MIXED = 16
#: Bytes for each beam that glass bends: where it enters and leaves, twice, what falls on it, and the like (measured).
_BENT = 130
#: Where beams add up: more arrays as large as the unknowns, and all as large as the beams and as the sums (measured).
_OF_SUMS = (1.2, 3.5, 6.0)
#: The time of a pass is measured where it has about so many multiply-adds, over so many passes.
_REHEARSED, _TIMED = 1e9, 12


def memory_needed(
    method: Method,
    grid: Grid,
    picture_shape: tuple[int, int],
    views: int,
    elevation_deg: float = 0.0,
    *,
    per_stop: int = 1,
    sums: int | None = None,
    levels: int = 0,
    apart: int = 1,
    units: int = 1,
    channels: int = 3,
    dtype: str = "float32",
) -> int:
    """Bytes that the program needs at its peak, from measured counts of arrays; finished units lie on disk.

    Parameters
    ----------
    method, grid, units
        As in `lightcube.backward.job.Job`.
    picture_shape, views, channels
        ``(rows, columns)`` of the pictures, how many they are, and their colours.
    elevation_deg
        Of the lamp, degrees.
    per_stop
        How many beams each of their pixels has: angles of a hold, times points of a pixel.
    sums
        To how many sums these add up; None = each beam is for itself.
    levels
        How often the cube is halved for its start.
    apart
        How many slices the rows of pictures are apart; products take a copy of the unknowns where it is more than one.
    """
    rows, columns = picture_shape
    size = np.dtype(dtype).itemsize
    raised = elevation_deg if elevation_deg != 0 or rows != grid.shape[0] else None
    pictures = 4 * views * rows * columns * (channels + 1)
    cube = 4 * channels * math.prod(grid.shape)
    parts = split(grid.shape, channels, units, level=raised is None)
    share = max(part.columns for part in parts) / sum(part.columns for part in parts)
    beams = (views * per_stop, None if sums is None else views * sums)
    needed = _solver(method, grid.shape, picture_shape, beams, channels * size * share, raised, apart)
    if levels:
        half, small = coarse_shape(grid.shape, 1), (-(-rows // 2), -(-columns // 2))
        level = pictures / 4 + _solver(method, half, small, beams, channels * size, raised, apart)
        needed = max(needed + size * channels * (math.prod(half) + math.prod(grid.shape) * share), level)
    merging = cube * (1 + max(0.25, size / 2 * share)) + pictures / 4
    return int(PROGRAM + pictures + max(needed, merging))


def _solver(
    method: Method,
    shape: tuple[int, int, int],
    picture_shape: tuple[int, int],
    views: tuple[int, int | None],
    depth: float,
    elevation_deg: float | None,
    apart: int,
) -> float:
    """Bytes that a solver holds, `depth` of them for each voxel and each pixel; elevation None = slice by slice.

    `views` are how many there are, and how many sums.
    """
    unknowns, beams = method.arrays
    count, sums = views
    per_picture = 0.0
    if sums is not None:
        unknowns, beams, per_picture = unknowns + _OF_SUMS[0], _OF_SUMS[1], _OF_SUMS[2] * sums
    rows, columns = picture_shape
    nz, ny, nx = shape
    equations = (count if sums is None else sums) * columns * (1 if elevation_deg is None else rows)
    if elevation_deg is None and not method.holds_matrix and is_worth_lines(nz * depth):
        beams += 1  # a product's copy with whole lines
    unknowns += apart > 1 and not method.holds_matrix
    pixels = (beams * count + per_picture) * rows * columns
    arrays = depth * (unknowns * nz * ny * nx + pixels) + _EQUATION * equations
    if not method.holds_matrix:
        return arrays
    pieces = 1.3 * max(ny, nx)
    if elevation_deg is not None:
        pieces += min(nz, pieces * math.tan(math.radians(abs(elevation_deg))))
    return arrays + _ENTRY * pieces * equations


def job_memory(job: Job) -> int:
    """`memory_needed` of a job, with the pieces of rays that it has room for."""
    every = asked(job.targets.rig, job.grid, job.recipe).rig
    return _memory_in(job.units, job, every) + _kept(job, every)


def with_room(job: Job, memory: int) -> Job:
    """A job that keeps what pieces of rays there is room for in so many bytes, beside all that it needs anyway."""
    return replace(job, room=min(ROOM, max(0, memory - job_memory(replace(job, room=0)))))


def _memory_in(units: int, job: Job, every: Rig) -> int:
    """`memory_needed` of a job in so many units, of whose pictures all that is asked stands on a rig."""
    rig, views = job.targets.rig, job.targets.rig.views
    steepest = float(np.max(np.abs(views.elevations_deg)))
    parts = _parts(job.grid, every)
    per_stop, beams = -(-len(every.views) // len(views)) * parts, len(every.views) * math.prod(every.picture_shape)
    mixed = 0 if rig.fading.is_none and rig.glass is None and parts == 1 else _MIXED * beams * parts
    kept = 0 if job.start is None else job.start.nbytes
    return (
        mixed
        + kept
        + _dyes_memory(units, job, beams * parts)
        + _bent_memory(job, beams)
        + memory_needed(
            job.recipe.solver,
            job.grid,
            every.picture_shape,
            len(views),
            0.0 if job.level else steepest or _ANY,
            per_stop=per_stop,
            sums=None if len(every) == len(every.views) and parts == 1 else -(-len(every) // len(rig)),
            levels=job.levels,
            apart=views.slices_a_row(job.grid),
            units=units,
            channels=job.channels,
            dtype=job.recipe.dtype,
        )
    )


def _bent_memory(job: Job, beams: int) -> int:
    """Bytes for where glass bends so many beams, and those that the cube is judged by, which are kept where few."""
    rig = job.targets.rig
    if rig.glass is None:
        return 0
    judge = len(judged(rig, job.grid).views) * math.prod(rig.picture_shape)
    return _BENT * (beams + (judge if judge <= FEW_PIXELS else 0))


def _kept(job: Job, every: Rig) -> int:
    """Bytes of the pieces of rays that a job keeps: all, or none where it has no room for them."""
    rig = job.targets.rig
    if job.room == 0 or job.recipe.solver.holds_matrix or job.recipe.dtype != "float32":
        return 0
    beams = len(every.views) * math.prod(every.picture_shape) // (len(rig.views) * math.prod(rig.picture_shape))
    pieces = PIECE * beams * _thin_pieces(job.grid, rig)
    return pieces if pieces <= job.room else 0


@lru_cache(maxsize=8)
def _thin_pieces(grid: Grid, rig: Rig) -> int:
    """Pieces of the rays through the middles of pixels, where these go one by one."""
    return Projector(grid, rig).pieces


def _parts(grid: Grid, rig: Rig) -> int:
    """How many beams a pixel of a view has: the rectangles of films, or 1."""
    return Projector(grid, rig).parts if isinstance(grid, Stack) else 1


def _dyes_memory(units: int, job: Job, beams: int) -> int:
    """More bytes of a job in so many units whose voxels are mixed of dyes, for so many beams.

    What is mixed, and what is cast before and after colours are set apart; unknowns of more dyes than colours; what
    reaches each pixel, and its shadow's strength, through a clear material that is not quite clear.
    """
    if job.dyes is None:
        return 0
    parts = split(job.grid.shape, job.channels, units, level=job.level)
    share = max(part.columns for part in parts) / sum(part.columns for part in parts)
    size, more = np.dtype(job.recipe.dtype).itemsize, job.kinds - job.channels
    unknowns = (more * job.recipe.solver.arrays[0] + job.kinds + job.channels) * size
    pixels = job.channels * (size + (_MIXED if np.any(job.dyes.base) else 0))
    return int(share * (unknowns * math.prod(job.grid.shape) + pixels * beams))


def fewest_units(job: Job, memory: int) -> int:
    """Into how many units to split a job: as few as fit into so many bytes; where none fits, as few as need least."""
    every = asked(job.targets.rig, job.grid, job.recipe).rig
    needed = [_memory_in(units, job, every) for units in range(1, job.most_units + 1)]
    fitting = [units for units, each in enumerate(needed, 1) if each <= memory]
    return fitting[0] if fitting else needed.index(min(needed)) + 1


def expected_passes(job: Job) -> float | None:
    """The work of at most all passes, in passes of the whole cube at all points; None for a direct method."""
    method = job.recipe.solver
    if method.passes is None:
        return None
    recipe = replace(job.recipe, passes=job.recipe.passes or method.passes)
    return sum(shares(replace(job, recipe=recipe)).values())


class Speed(NamedTuple):
    """Seconds of a pass for each multiply-add, but for a factor, and beside these for each number at hand."""

    products: float
    rest: float


def seconds_a_pass(job: Job, speed: Speed | None = None) -> float:
    """Seconds that a pass of the whole cube is expected to take, at a speed that was measured; None = now."""
    multiplied, numbers = _work(job, job.targets, job.grid)
    products, rest = speed or measured_speed(job)
    return products * multiplied + rest * numbers


def measured_speed(job: Job) -> Speed:
    """How fast a job's method is here and now, by a smaller cube: products in both directions, and all else.

    It takes a second or two, besides what numba compiles.
    """
    targets, grid = job.targets, job.grid
    while _work(job, targets, grid)[0] > _REHEARSED:
        targets, grid = coarser(targets, grid, 1)
    room = _kept(job, asked(job.targets.rig, job.grid, job.recipe).rig)  # as the job itself: nothing, or all pieces
    problem = pose(targets, grid, job.recipe, room=room)
    low, high = job.lamp_bounds
    marks: list[float] = []
    problem.solve(
        job.recipe.solver,
        (high, high) if job.frozen else (low, high),
        job.bounds(problem.part, problem.light.shape[1]),
        iterations=_TIMED,
        callback=lambda progress: marks.append(time.perf_counter()),
    )
    if len(marks) < 2:
        return Speed(0.0, 0.0)
    products = _seconds_of_products(problem)
    rest = max(0.0, float(np.median(np.diff(marks))) - products)
    multiplied, numbers = _work(job, targets, grid)
    return Speed(products / multiplied, rest / numbers)


def _seconds_of_products(problem: Problem) -> float:
    """The least that one product in either direction has taken."""
    times = []
    beams = np.ones((problem.matrix.shape[0], problem.light.shape[1]), problem.light.dtype)
    for _ in range(3):
        began = time.perf_counter()
        problem.matrix.forward(problem.matrix.adjoint(beams))
        times.append(time.perf_counter() - began)
    return min(times)


def _work(job: Job, targets: Targets, grid: Grid) -> tuple[float, float]:
    """Of a pass, multiply-adds but for a factor (beams times the voxels that one runs through), and numbers at hand."""
    every = asked(targets.rig, grid, job.recipe).rig
    pixels = len(every.views) * math.prod(every.picture_shape) * _parts(grid, every) * job.channels
    met = grid.shape[0] if isinstance(grid, Stack) else max(grid.shape[1:])
    return pixels * met, pixels + job.channels * math.prod(grid.shape)
