"""Program 2, the backward computation: from pictures to the cube that casts them."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from lightcube.coarse import enlarged
from lightcube.cube import Cube, Status
from lightcube.errors import InputError
from lightcube.fitting import targets
from lightcube.frames import Frames
from lightcube.geometry import Grid, raster_shape
from lightcube.problem import BLACK, Lamp, pose
from lightcube.solvers import METHODS
from lightcube.solvers.contract import Solver
from lightcube.units import COARSE_PASSES, Step, Store, Watch, coarser, solve_levels, solve_units

#: Bounds of the power of a lamp that is not fixed, unless the upper one is given.
LAMP_MIN, LAMP_MAX = 1e-4, 16.0
#: No lamp may be stronger.
LAMP_MOST = 1e6
#: At most so many passes of method display, and the PSNR of all pixels, dB, that is enough: for a look, for use, and
#: for the last tenth of a dB.
Quality = Literal["draft", "normal", "best"]
QUALITIES: Mapping[Quality, tuple[int, float]] = {"draft": (30, 36.0), "normal": (200, 42.0), "best": (1000, np.inf)}


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
        One of ``"converged"``, ``"enough"``, ``"iterations"``, ``"callback"``.
    lower_bound
        What no cube and no lamps (with lamp ``"coarse"``: these lamps) can bring the last residual below, or None
        where the method does not tell.
    """

    cube: Cube
    residuals: NDArray[np.float64]
    rejected: NDArray[np.int64]
    undetermined: int
    stop_reason: str
    lower_bound: float | None = None

    @property
    def optimality(self) -> dict[str, float] | None:
        """The objective, what it cannot be below, and how many dB at most are left to gain on average, if known."""
        if self.lower_bound is None:
            return None
        reached = float(self.residuals[-1])
        most = 10 * math.log10(reached / self.lower_bound) if 0 < self.lower_bound < reached else None
        return {"objective": reached, "lower_bound": self.lower_bound} | ({} if most is None else {"left_db": most})


def solve(
    frames: Frames,
    grid: Grid,
    *,
    method: str = "display",
    lamp: Lamp | None = None,
    lamp_power: float | None = None,
    lamp_max: float | None = None,
    hold: float = 0.0,
    black: float = BLACK,
    max_extinction: float = np.inf,
    iterations: int | None = None,
    enough_db: float = np.inf,
    dtype: type[np.floating[Any]] = np.float32,
    callback: Callable[[Step], bool | None] | None = None,
    store: Store | None = None,
    provenance: Mapping[str, Any] | None = None,
) -> Solution:
    """Find the cube whose shadows are the frames.

    Method ``display`` solves a cube more than 48 voxels long at half the size first (and that one at a quarter, and
    so on) and starts from there: the lamps and the coarse structure come at an eighth of the price.

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
        for all views; ``"coarse"``: as per-view, but found at half the size and then kept, so that colours (slabs of
        slices where the lamp is level) are solved one after the other in a part of the memory; ``"fixed"``: all have
        `lamp_power`. Default per-view, but fixed where `lamp_power` is given or the method cannot choose.
    lamp_power
        Power of a fixed lamp, linear light; 1 (the default) shows white where a beam meets nothing.
    lamp_max
        Largest power of a lamp that is not fixed, linear light, at least 1; default 16.
    hold
        Degrees on either side of its stop over which each picture shall stand, at most half the way to the next one:
        it is asked for at several angles (`lightcube.geometry.held`), under one lamp power.
    black
        Display value, in [0, 1), that the screen cannot be darker than; pixels darker than it are wanted at it.
    max_extinction
        Upper bound of the extinction, 1/mm.
    iterations
        At most so many at full size; None = the method's own number.
    enough_db
        Method display stops as soon as the mean squared difference of all weighted pixels (the too dark ones
        linearised) is as small as at this PSNR, dB.
    dtype
        Of the computation: float32 or float64.
    callback
        Called after each iteration; True stops the solver, and the cube's status becomes ``"interrupted"``.
    store
        Keeps an unfinished cube after 2 s at full size, ever more seldom up to every 30 s, and when stopped.
    provenance
        What else the cube shall remember of how it was made.

    Raises
    ------
    InputError
        For an unknown method, numbers out of range, or frames that do not belong to the grid.
    """
    kind = check_options(method, lamp, lamp_power, lamp_max, max_extinction, iterations, black)
    check_frames(frames, grid)
    problem = pose(frames, grid, hold, kind, black, dtype)
    power = float(lamp_power or lamp_max or (1.0 if kind == "fixed" else LAMP_MAX))
    made = {
        "lightcube": version("lightcube"),
        "method": method,
        "lamp": kind,
        "lamp_power" if kind == "fixed" else "lamp_max": power,
        "max_extinction": None if np.isinf(max_extinction) else float(max_extinction),
        "black": float(black),
        "angles_per_view": problem.angles,
        **(provenance or {}),
    }
    draft = Cube(
        extinction=np.zeros((problem.channels, *grid.shape), np.float32),
        grid=grid,
        views=frames.views,
        targets=targets(frames),
        names=frames.names,
        transfer=frames.transfer,
        status="interrupted",
        hold_deg=float(hold),
        provenance=made,
    )
    powers = np.full((1 if kind == "global" else len(frames), problem.channels), power)
    lamp_bounds = (powers if kind == "fixed" else np.full_like(powers, LAMP_MIN), powers)
    smaller = coarser(frames, grid, at_least=int(kind == "coarse")) if method == "display" else []
    levels = [pose(*each, hold, kind, black, dtype) for each in smaller]
    options: dict[str, Any] = {"bounds": (0.0, max_extinction), "transfer": frames.transfer}
    passes = iterations or (QUALITIES["normal"][0] if method == "display" else None)
    ahead = sum(COARSE_PASSES / 8**k for k in range(1, len(levels) + 1))
    enough = 10 ** (-enough_db / 10) if method == "display" else 0.0
    watch = Watch(draft, callback, store, ahead, passes, enough)
    start, found, going = solve_levels(levels, lamp_bounds, watch, **options)
    if kind == "coarse":
        lamp_bounds = (found, found)
    if passes is not None:
        options["iterations"] = passes if going else 1
    x = None if start is None else problem.unknowns(enlarged(start, grid.shape))
    parts = problem.units() if kind == "coarse" else [slice(None)]
    result = solve_units(find_method(method), problem, lamp_bounds, x, parts, watch, **options)
    rejected = problem.pixels(result.rejected)
    made |= {"iterations": len(result.residuals), "stop_reason": result.stop_reason, "rejected": len(rejected)}
    status: Status = "interrupted" if result.stop_reason == "callback" else "complete"
    cube = replace(watch.cube(problem, result.x, result.lamp_powers), provenance=made, status=status)
    if store is not None and status == "interrupted":
        store.keep(cube)
    undetermined = 0 if result.undetermined is None else int(np.sum(result.undetermined))
    return Solution(cube, result.residuals, rejected, undetermined, result.stop_reason, result.lower_bound)


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
    if lamp_power is not None and not LAMP_MIN <= lamp_power <= LAMP_MOST:
        raise InputError(f"a lamp power must lie between {LAMP_MIN:g} and 1e6, not {lamp_power:g}")
    if lamp_max is not None and not 1 <= lamp_max <= LAMP_MOST:
        raise InputError(f"the largest lamp power must lie between 1 and 1e6, not {lamp_max:g}")
    return lamp


def check_options(
    method: str,
    lamp: Lamp | None = None,
    lamp_power: float | None = None,
    lamp_max: float | None = None,
    max_extinction: float = np.inf,
    iterations: int | None = None,
    black: float = BLACK,
) -> Lamp:
    """Return the kind of lamp that is meant, or raise `InputError` where `solve` would refuse its options."""
    find_method(method)
    if not max_extinction > 0:
        raise InputError(f"the largest extinction must be a positive number (1/mm), not {max_extinction}")
    if not BLACK <= black < 1:
        raise InputError(f"black must be a display value from {BLACK:.4f}, half a level, to below 1, not {black:g}")
    if iterations is not None and iterations < 1:
        raise InputError(f"a solver needs at least 1 iteration, not {iterations}")
    return _check_lamp(method, lamp, lamp_power, lamp_max)
