"""Program 2, the backward computation: from pictures to the cube that casts them."""

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import Any, Literal, Protocol, get_args

import numpy as np
from numpy.typing import NDArray

from lightcube.cube import Cube, Status
from lightcube.errors import InputError
from lightcube.fitting import targets
from lightcube.frames import Frames
from lightcube.geometry import Grid, Views, held, raster_shape
from lightcube.layout import columns_from_pictures, pictures_from_columns, volume_from_columns
from lightcube.projector import Projector
from lightcube.solvers import METHODS
from lightcube.solvers.contract import Progress, Solver
from lightcube.transfer import decode

#: The darkest that a screen can show: half a display level.
BLACK = 0.5 / 255
Lamp = Literal["per-view", "global", "fixed"]
#: Bounds of the power of a lamp that is not fixed, unless the upper one is given.
LAMP_MIN, LAMP_MAX = 1e-4, 16.0
#: Seconds from the start to the first checkpoint, and between checkpoints later on; the gaps double in between.
FIRST_CHECKPOINT_S, CHECKPOINT_S = 2.0, 30.0


class Store(Protocol):
    """Where unfinished work is kept."""

    def keep(self, cube: Cube) -> None:
        """Keep `cube`, which is unfinished, in place of what was kept before."""


@dataclass(frozen=True)
class Step:
    """Where a running solve stands."""

    iteration: int
    iterations: int
    #: What the method minimises, or the norm it reports.
    residual: float
    #: What the screen shows now: a function that returns ``(view, row, column, channel)``, linear light.
    shown: Callable[[], NDArray[np.float32]]


@dataclass(frozen=True)
class Solution:
    """A cube and how the solver arrived at it.

    Parameters
    ----------
    cube
        What was solved for.
    residuals
        One figure per iteration, in the norm of the method.
    rejected
        ``(count, 4)`` whole numbers: (view, row, column, channel) of pixels thrown out as inconsistent.
    undetermined
        How many voxel colours no remaining equation determines; they are transparent.
    stop_reason
        One of ``"converged"``, ``"iterations"``, ``"callback"``.
    """

    cube: Cube
    residuals: NDArray[np.float64]
    rejected: NDArray[np.int64]
    undetermined: int
    stop_reason: str


def solve(
    frames: Frames,
    grid: Grid,
    *,
    method: str = "display",
    lamp: Lamp | None = None,
    lamp_power: float | None = None,
    lamp_max: float | None = None,
    hold: float = 0.0,
    max_extinction: float = np.inf,
    iterations: int | None = None,
    dtype: type[np.floating[Any]] = np.float32,
    callback: Callable[[Step], bool | None] | None = None,
    store: Store | None = None,
    provenance: Mapping[str, Any] | None = None,
) -> Solution:
    """Find the cube whose shadows are the frames.

    Parameters
    ----------
    frames
        The wanted pictures, their views and weights.
    grid
        The block of voxels.
    method
        A name in `lightcube.solvers.METHODS`.
    lamp
        ``"per-view"``: each view and colour has the lamp power that suits it best; ``"global"``: each colour has one
        for all views; ``"fixed"``: all have `lamp_power`. Default per-view, but fixed where `lamp_power` is given or
        the method cannot choose.
    lamp_power
        Power of a fixed lamp, linear light; 1 (the default) shows white where a beam meets nothing.
    lamp_max
        Largest power of a lamp that is not fixed, linear light, at least 1; default 16.
    hold
        Degrees on either side of its stop over which each picture shall stand, at most half the way to the next one:
        it is asked for at several angles (`lightcube.geometry.held`), under one lamp power.
    max_extinction
        Upper bound of the extinction, 1/mm.
    iterations
        At most so many; None = the method's own number.
    dtype
        Of the computation: float32 or float64.
    callback
        Called after each iteration; True stops the solver, and the cube's status becomes ``"interrupted"``.
    store
        Keeps an unfinished cube after 2 s, ever more seldom up to every 30 s, and when the solver was stopped.
    provenance
        What else the cube shall remember of how it was made.

    Raises
    ------
    InputError
        For an unknown method, numbers out of range, or frames that do not belong to the grid.
    """
    solver = find_method(method)
    kind = check_options(method, lamp, lamp_power, lamp_max, max_extinction, iterations)
    check_frames(frames, grid)
    views = held(frames.views, hold, grid)
    angles = len(views) // len(frames)
    matrix = Projector(grid, views)
    wanted = np.maximum(frames.pictures, decode(np.array([BLACK], np.float32), frames.transfer)).astype(dtype)
    channels = wanted.shape[-1]
    weights = np.repeat(frames.weight[..., None], channels, axis=-1).astype(dtype)
    stop_of_row = matrix.view_of_row // angles
    power = lamp_power or lamp_max or (1.0 if kind == "fixed" else LAMP_MAX)
    strongest = np.full((1 if kind == "global" else len(frames), channels), float(power))
    weakest = strongest if kind == "fixed" else np.full_like(strongest, LAMP_MIN)
    made = {
        "lightcube": version("lightcube"),
        "method": method,
        "lamp": kind,
        "lamp_power" if kind == "fixed" else "lamp_max": float(strongest[0, 0]),
        "max_extinction": None if np.isinf(max_extinction) else float(max_extinction),
        "angles_per_view": angles,
        **(provenance or {}),
    }
    draft = _draft(frames, grid, channels, hold, made)

    def cube_of(x: NDArray[Any], powers: NDArray[Any]) -> Cube:
        columns = x.reshape(grid.shape[1] * grid.shape[2], -1)
        extinction = volume_from_columns(columns, grid.shape, channels)
        return replace(draft, extinction=extinction, lamp_powers=_per_view(powers, len(frames)))

    watch = _watch(cube_of, frames.views, angles, callback, store)
    options: dict[str, Any] = {} if iterations is None else {"iterations": iterations}
    result = solver(
        matrix,
        columns_from_pictures(np.repeat(wanted, angles, axis=0)).reshape(matrix.shape[0], -1),
        weights=columns_from_pictures(np.repeat(weights, angles, axis=0)).reshape(matrix.shape[0], -1),
        view_of_row=stop_of_row if kind != "global" else np.zeros_like(stop_of_row),
        lamp_bounds=(weakest, strongest),
        bounds=(0.0, max_extinction),
        callback=watch,
        transfer=frames.transfer,
        **options,
    )
    rejected = _pixels(result.rejected, result.x.shape[1], frames, angles)
    made |= {"iterations": len(result.residuals), "stop_reason": result.stop_reason, "rejected": len(rejected)}
    status: Status = "interrupted" if result.stop_reason == "callback" else "complete"
    cube = replace(cube_of(result.x, result.lamp_powers), provenance=made, status=status)
    if store is not None and status == "interrupted":
        store.keep(cube)
    undetermined = 0 if result.undetermined is None else int(np.sum(result.undetermined))
    return Solution(cube, result.residuals, rejected, undetermined, result.stop_reason)


def _draft(frames: Frames, grid: Grid, channels: int, hold: float, made: Mapping[str, Any]) -> Cube:
    """The cube for these frames before anything is computed: transparent, and marked as unfinished."""
    return Cube(
        extinction=np.zeros((channels, *grid.shape), np.float32),
        grid=grid,
        views=frames.views,
        targets=targets(frames),
        names=frames.names,
        transfer=frames.transfer,
        status="interrupted",
        hold_deg=float(hold),
        provenance=made,
    )


def find_method(name: str) -> Solver:
    """Return the solver called `name`, or raise `InputError` naming those there are."""
    if name not in METHODS:
        raise InputError(f"unknown method {name!r}: use one of {', '.join(METHODS)}")
    return METHODS[name]


def check_frames(frames: Frames, grid: Grid) -> None:
    """Raise `InputError` where a picture is larger than the grid's screen."""
    rows, columns = frames.views.picture_shape
    most = [raster_shape(grid, elevation) for elevation in set(frames.views.elevations.tolist())]
    most_rows, most_columns = min(most)
    if rows > most_rows or columns > most_columns:
        raise InputError(
            f"pictures of {rows} x {columns} pixels (rows x columns) are larger than "
            f"the cube's screen of {most_rows} x {most_columns}: fit them to this grid first"
        )


def memory_needed(method: str, grid: Grid, picture_shape: tuple[int, int], views: int, elevation: float = 0.0) -> int:
    """Bytes that `solve` needs at its peak, in float32 with three channels, from measured counts of arrays.

    Methods that need single rows also hold the sparse matrix: about 1.3 voxels per beam and voxel of the cube's width.
    """
    rows, columns = picture_shape
    nz, ny, nx = grid.shape
    arrays = 4 * 3 * ((18 if method == "cgls" else 12) * nz * ny * nx + 10 * rows * columns * views)
    if method not in ("gauss-seidel", "row-reduction"):
        return arrays
    level = elevation == 0 and rows == nz
    pieces = 1.3 * max(ny, nx) + (0 if level else min(nz, 1.3 * max(ny, nx) * math.tan(math.radians(abs(elevation)))))
    return arrays + int(60 * pieces * columns * views * (1 if level else rows))


def _check_lamp(method: str, lamp: Lamp | None, lamp_power: float | None, lamp_max: float | None) -> Lamp:
    """Return the kind of lamp that is meant, or raise `InputError` where its options contradict each other."""
    if lamp is None:
        lamp = "per-view" if method == "display" and lamp_power is None else "fixed"
    if lamp not in get_args(Lamp):
        raise InputError(f"unknown lamp {lamp!r}: use one of {', '.join(get_args(Lamp))}")
    if method != "display" and (lamp != "fixed" or lamp_max is not None):
        raise InputError(f"method {method} cannot choose lamp powers: give one lamp power, or use method display")
    if lamp == "fixed" and lamp_max is not None:
        raise InputError("a fixed lamp has no largest power: leave that out, or use a lamp per-view or global")
    if lamp != "fixed" and lamp_power is not None:
        raise InputError(f"a lamp that is {lamp} has no given power: leave that out, or use a fixed lamp")
    if lamp_power is not None and not LAMP_MIN <= lamp_power <= 1e6:
        raise InputError(f"a lamp power must lie between {LAMP_MIN:g} and 1e6, not {lamp_power:g}")
    if lamp_max is not None and not 1 <= lamp_max <= 1e6:
        raise InputError(f"the largest lamp power must lie between 1 and 1e6, not {lamp_max:g}")
    return lamp


def _per_view(powers: NDArray[Any], views: int) -> NDArray[np.float64]:
    """Lamp powers ``(views, channels)`` from those, or from one lamp for all views."""
    return np.array(np.broadcast_to(powers, (views, powers.shape[1])), dtype=np.float64)


def check_options(
    method: str,
    lamp: Lamp | None = None,
    lamp_power: float | None = None,
    lamp_max: float | None = None,
    max_extinction: float = np.inf,
    iterations: int | None = None,
) -> Lamp:
    """Return the kind of lamp that is meant, or raise `InputError` where `solve` would refuse its options."""
    find_method(method)
    if not max_extinction > 0:
        raise InputError(f"the largest extinction must be a positive number (1/mm), not {max_extinction}")
    if iterations is not None and iterations < 1:
        raise InputError(f"a solver needs at least 1 iteration, not {iterations}")
    return _check_lamp(method, lamp, lamp_power, lamp_max)


def _watch(
    cube_of: Callable[[NDArray[Any], NDArray[Any]], Cube],
    views: Views,
    angles: int,
    callback: Callable[[Step], bool | None] | None,
    store: Store | None,
) -> Callable[[Progress], bool | None]:
    """What the solver calls after each iteration: checkpoints, and the caller's callback."""
    last, gap = time.monotonic(), FIRST_CHECKPOINT_S

    def watch(progress: Progress) -> bool | None:
        nonlocal last, gap
        if store is not None and time.monotonic() - last > gap:
            store.keep(cube_of(progress.x, progress.lamp_powers))
            last, gap = time.monotonic(), min(2 * gap, CHECKPOINT_S)
        if callback is None:
            return None

        def shown() -> NDArray[np.float32]:
            powers = _per_view(progress.lamp_powers, len(views))
            columns = views.picture_shape[1]
            at_stops = progress.absorbance.reshape(len(views), angles, columns, -1)[:, angles // 2]
            light = np.exp(-at_stops).reshape(len(views) * columns, -1)
            pictures = pictures_from_columns(light, views.picture_shape, powers.shape[1])
            return (pictures * powers[:, None, None, :]).astype(np.float32)

        return callback(Step(progress.iteration, progress.iterations, progress.residual, shown))

    return watch


def _pixels(rejected: NDArray[np.int64], block_columns: int, frames: Frames, angles: int) -> NDArray[np.int64]:
    """(view, row, column, channel) of rejected (equation, column) pairs of a block with so many columns, each once."""
    rows, columns = frames.views.picture_shape
    flat = rejected[:, 0] * block_columns + rejected[:, 1]
    shape = (len(frames) * angles, columns, rows, frames.pictures.shape[-1])
    view, column, lifted, channel = np.unravel_index(flat, shape)
    pixels = np.stack([view // angles, rows - 1 - lifted, column, channel], axis=1).astype(np.int64)
    return np.unique(pixels, axis=0)
