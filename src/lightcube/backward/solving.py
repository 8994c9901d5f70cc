"""Program 2, the backward computation: from pictures to the cube that casts them."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import DTypeLike

from lightcube.backward.job import Job
from lightcube.backward.needs import MEMORY, fewest_units
from lightcube.backward.pieces import Watching, solve_pieces
from lightcube.backward.recipe import LAMP_MAX, QUALITIES, Powers, check_options
from lightcube.backward.solution import Solution, merged
from lightcube.backward.store import MemoryStore, Store
from lightcube.backward.units import most_units
from lightcube.errors import InputError
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.rig import Lighting
from lightcube.optics.transfer import BLACK
from lightcube.pictures.frames import Frames
from lightcube.projection.stacked import is_stacked
from lightcube.solvers import find_method
from lightcube.solvers.contract import Solver
from lightcube.solvers.method import Method


def solve(
    frames: Frames,
    grid: Grid,
    *,
    method: str | Solver | Method = "display",
    lamp: Powers | None = None,
    lamp_power: float | None = None,
    lamp_max: float | None = None,
    hold: float = 0.0,
    black: float = BLACK,
    max_extinction: float = np.inf,
    iterations: int | None = None,
    enough_db: float = np.inf,
    dtype: DTypeLike = np.float32,
    units: int | None = None,
    memory: int | None = None,
    callback: Watching | None = None,
    store: Store | None = None,
    provenance: Mapping[str, Any] | None = None,
) -> Solution:
    """Find the cube whose shadows are the frames.

    Method ``display``, and others unless they say that it does not help them, solve a cube more than 48 voxels long at
    half the size first (and that one at a quarter, and so on) and start from there: the lamps and the coarse structure
    come at an eighth of the price.

    Parameters
    ----------
    frames
        The wanted pictures, their views and weights.
    grid
        The block of voxels.
    method
        A name in `lightcube.METHODS`, or a function (docs/your-own-method.md); as `lightcube.solvers.find_method`
        takes it.
    lamp
        ``"per-view"``: each view and colour has the lamp power that suits it best; ``"global"``: each colour has one
        for all views; ``"coarse"``: as per-view, but found at half the size and then kept; ``"fixed"``: all have
        `lamp_power`. Default per-view, but fixed where `lamp_power` is given or the method cannot choose.
    lamp_power
        Power of a fixed lamp, linear light; 1 (the default) shows white where a beam meets nothing.
    lamp_max
        Largest power of a lamp that is not fixed, linear light, at least 1; default 16.
    hold
        Degrees on either side of its stop over which each picture shall stand, at most half the way to the next one:
        it is asked for at several angles (`lightcube.optics.views.held`), under one lamp power.
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
    units
        In so many parts the cube is solved, one after the other and each in its part of the memory: colours, or slabs
        of slices where the lamp is level. With more than one the powers of lamps that are not fixed are found at half
        the size and then kept. Default as few as fit `memory`, or as many as can be where none fits.
    memory
        Bytes; default 4e9. What callback, store and the finished units themselves take comes on top.
    callback
        Called after each iteration; True stops the solver, and the cube's status becomes ``"interrupted"``.
    store
        Keeps the pieces that are finished, and the state of the running one after 2 s, ever more seldom up to every
        30 s, and when stopped; what is in it already is not computed again, and a solver that was stopped goes on
        from its state: the cube is the same, bit for bit, as that of a run without a stop. It must have been used
        for this very job only (`lightcube.io.DiskStore` sees to that).
    provenance
        What else the cube shall remember of how it was made.

    Raises
    ------
    InputError
        For an unknown method, numbers out of range, or frames that do not belong to the grid.
    """
    job = make_job(
        frames,
        grid,
        method=method,
        lamp=lamp,
        lamp_power=lamp_power,
        lamp_max=lamp_max,
        hold=hold,
        black=black,
        max_extinction=max_extinction,
        iterations=iterations,
        enough_db=enough_db,
        dtype=dtype,
        units=units,
        memory=memory,
        provenance=provenance,
    )
    return run(job, store, callback)


def run(job: Job, store: Store | None = None, callback: Watching | None = None) -> Solution:
    """Solve what is not finished of a job, and put the cube together; `store` and `callback` as `solve` takes them."""
    shelf = MemoryStore() if store is None else store
    solve_pieces(job, job.pieces, shelf, callback, checkpoints=store is not None)
    return merged(job, shelf)


def make_job(
    frames: Frames,
    grid: Grid,
    *,
    method: str | Solver | Method = "display",
    lamp: Powers | None = None,
    lamp_power: float | None = None,
    lamp_max: float | None = None,
    hold: float = 0.0,
    black: float = BLACK,
    max_extinction: float = np.inf,
    iterations: int | None = None,
    enough_db: float = np.inf,
    dtype: DTypeLike = np.float32,
    units: int | None = None,
    memory: int | None = None,
    provenance: Mapping[str, Any] | None = None,
) -> Job:
    """Check what `solve` is asked for, and leave nothing open; parameters and errors as there."""
    method = find_method(method)
    kind = check_options(method, lamp, lamp_power, lamp_max, max_extinction, iterations, black)
    check_frames(frames, grid)
    if frames.lighting is not None:
        if lamp == "fixed" or lamp_power is not None or lamp_max is not None:
            raise InputError("the powers of a stage's lamps are said on the stage: leave out those given beside it")
        _check_method_on_stage(method, frames.lighting)
    job = Job(
        frames=frames,
        grid=grid,
        method=method,
        lamp=kind,
        lamp_power=float(lamp_power or lamp_max or (1.0 if kind == "fixed" else LAMP_MAX)),
        hold=float(hold),
        black=float(black),
        max_extinction=float(max_extinction),
        iterations=iterations or (QUALITIES["normal"][0] if method.residual == "display" else None),
        enough_db=float(enough_db),
        dtype=np.dtype(dtype).name,
        provenance=dict(provenance or {}),
    )
    most = most_units(grid.shape, job.channels, level=job.level)
    if units is not None and not 1 <= units <= most:
        raise InputError(f"this cube can be solved in 1 to {most} units, not in {units}: ask for a number between")
    return replace(job, units=fewest_units(job, memory or MEMORY) if units is None else units)


def _check_method_on_stage(method: Method, lighting: Lighting) -> None:
    """Raise `InputError` where a method cannot do what a stage asks for."""
    free = lighting.lamp_names[int(np.argmax(lighting.least < lighting.most))]
    if not method.chooses_lamps and np.any(lighting.least < lighting.most):
        raise InputError(
            f"method {method.name} cannot choose the power of lamp {free!r}: give it one, or use method display"
        )
    if not method.takes_sums and not lighting.is_plain:
        raise InputError(f"method {method.name} cannot do with light that adds up: use method display")


def check_frames(frames: Frames, grid: Grid) -> None:
    """Raise `InputError` where a picture is larger than the grid's screen; other screens are as large as they are."""
    if frames.lighting is not None or not is_stacked(grid, frames.views):
        return
    rows, columns = frames.views.picture_shape
    most = [raster_shape(grid, elevation) for elevation in set(frames.views.elevations.tolist())]
    most_rows, most_columns = min(most)
    if rows > most_rows or columns > most_columns:
        raise InputError(
            f"pictures of {rows} x {columns} pixels (rows x columns) are larger than "
            f"the cube's screen of {most_rows} x {most_columns}: fit them to this grid first"
        )
