"""Program 2, the backward computation: from pictures to the cube that casts them."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from lightcube.cube import Cube, Status
from lightcube.errors import InputError
from lightcube.fitting import targets
from lightcube.frames import Frames
from lightcube.geometry import Grid, raster_shape
from lightcube.layout import columns_from_pictures, pictures_from_columns, volume_from_columns
from lightcube.projector import Projector
from lightcube.solvers import METHODS
from lightcube.solvers.contract import Progress, Solver
from lightcube.transfer import decode

#: The darkest that a screen can show: half a display level.
BLACK = 0.5 / 255
#: Seconds between checkpoints.
CHECKPOINT_S = 30.0


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
    lamp_power: float = 1.0,
    max_extinction: float = np.inf,
    iterations: int | None = None,
    dtype: type[np.floating[Any]] = np.float32,
    callback: Callable[[Step], bool | None] | None = None,
    store: Store | None = None,
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
    lamp_power
        Power of the lamp in every view and colour, linear light; 1 shows white where a beam meets nothing.
    max_extinction
        Upper bound of the extinction, 1/mm.
    iterations
        At most so many; None = the method's own number.
    dtype
        Of the computation: float32 or float64.
    callback
        Called after each iteration; True stops the solver, and the cube's status becomes ``"interrupted"``.
    store
        Keeps an unfinished cube every 30 s and when the solver was stopped.

    Raises
    ------
    InputError
        For an unknown method, numbers out of range, or frames that do not belong to the grid.
    """
    solver = find_method(method)
    _check_numbers(lamp_power, max_extinction, iterations)
    check_frames(frames, grid)
    matrix = Projector(grid, frames.views)
    wanted = np.maximum(frames.pictures, decode(np.array([BLACK], np.float32), frames.transfer)).astype(dtype)
    channels = wanted.shape[-1]
    weights = np.repeat(frames.weight[..., None], channels, axis=-1).astype(dtype)
    powers = np.full((len(frames), channels), float(lamp_power))
    draft = Cube(
        extinction=np.zeros((channels, *grid.shape), np.float32),
        grid=grid,
        views=frames.views,
        lamp_powers=powers,
        targets=targets(frames),
        names=frames.names,
        transfer=frames.transfer,
        status="interrupted",
    )

    def cube_of(x: NDArray[Any]) -> Cube:
        columns = x.reshape(grid.shape[1] * grid.shape[2], -1)
        return replace(draft, extinction=volume_from_columns(columns, grid.shape, channels))

    watch = _watch(cube_of, powers, frames.views.picture_shape, callback, store)
    options: dict[str, Any] = {} if iterations is None else {"iterations": iterations}
    result = solver(
        matrix,
        columns_from_pictures(wanted).reshape(matrix.shape[0], -1),
        weights=columns_from_pictures(weights).reshape(matrix.shape[0], -1),
        view_of_row=matrix.view_of_row,
        lamp_bounds=(powers, powers),
        bounds=(0.0, max_extinction),
        callback=watch,
        **options,
    )
    provenance = {
        "lightcube": version("lightcube"),
        "method": method,
        "lamp_power": float(lamp_power),
        "max_extinction": None if np.isinf(max_extinction) else float(max_extinction),
        "iterations": len(result.residuals),
        "stop_reason": result.stop_reason,
        "rejected": len(result.rejected),
    }
    status: Status = "interrupted" if result.stop_reason == "callback" else "complete"
    cube = replace(cube_of(result.x), provenance=provenance, status=status)
    if store is not None and status == "interrupted":
        store.keep(cube)
    undetermined = 0 if result.undetermined is None else int(np.sum(result.undetermined))
    return Solution(
        cube, result.residuals, _pixels(result.rejected, result.x.shape[1], frames), undetermined, result.stop_reason
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


def memory_needed(grid: Grid, picture_shape: tuple[int, int], views: int, channels: int = 3, itemsize: int = 4) -> int:
    """Bytes that `solve` needs at its peak with method display (measured: 9 volumes and 10 sets of pictures)."""
    volume = channels * grid.shape[0] * grid.shape[1] * grid.shape[2]
    pictures = channels * picture_shape[0] * picture_shape[1] * views
    return itemsize * (9 * volume + 10 * pictures)


def _check_numbers(lamp_power: float, max_extinction: float, iterations: int | None) -> None:
    if not (np.isfinite(lamp_power) and lamp_power > 0):
        raise InputError(f"a lamp power must be a positive number, not {lamp_power}")
    if not max_extinction > 0:
        raise InputError(f"the largest extinction must be a positive number (1/mm), not {max_extinction}")
    if iterations is not None and iterations < 1:
        raise InputError(f"a solver needs at least 1 iteration, not {iterations}")


def _watch(
    cube_of: Callable[[NDArray[Any]], Cube],
    powers: NDArray[np.float64],
    picture_shape: tuple[int, int],
    callback: Callable[[Step], bool | None] | None,
    store: Store | None,
) -> Callable[[Progress], bool | None]:
    """What the solver calls after each iteration: checkpoints, and the caller's callback."""
    last = time.monotonic()

    def watch(progress: Progress) -> bool | None:
        nonlocal last
        if store is not None and time.monotonic() - last > CHECKPOINT_S:
            store.keep(cube_of(progress.x))
            last = time.monotonic()
        if callback is None:
            return None

        def shown() -> NDArray[np.float32]:
            light = np.exp(-progress.absorbance).reshape(len(powers) * picture_shape[1], -1)
            pictures = pictures_from_columns(light, picture_shape, powers.shape[1])
            return (pictures * powers[:, None, None, :]).astype(np.float32)

        return callback(Step(progress.iteration, progress.iterations, progress.residual, shown))

    return watch


def _pixels(rejected: NDArray[np.int64], block_columns: int, frames: Frames) -> NDArray[np.int64]:
    """(view, row, column, channel) of rejected (equation, column) pairs of a block with so many columns."""
    rows, columns = frames.views.picture_shape
    flat = rejected[:, 0] * block_columns + rejected[:, 1]
    view, column, lifted, channel = np.unravel_index(flat, (len(frames), columns, rows, frames.pictures.shape[-1]))
    return np.stack([view, rows - 1 - lifted, column, channel], axis=1).astype(np.int64)
