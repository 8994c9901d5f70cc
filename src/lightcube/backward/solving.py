"""Program 2, the backward computation: from pictures to the cube that casts them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, cast

import numpy as np

from lightcube.backward.job import Job
from lightcube.backward.needs import MEMORY, fewest_units, with_room
from lightcube.backward.pieces import Watching, solve_pieces
from lightcube.backward.recipe import Recipe
from lightcube.backward.solution import Solution, merged
from lightcube.backward.store import MemoryStore, Store
from lightcube.errors import InputError
from lightcube.optics.arrays import Images, locked
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.gamut import nearest
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.rig import Rig
from lightcube.pictures.targets import Targets


@checked
def solve(
    targets: Targets,
    grid: Grid,
    recipe: Recipe | None = None,
    *,
    units: int | None = None,
    memory: int | None = None,
    callback: Watching | None = None,
    store: Store | None = None,
    start: Cube | None = None,
    provenance: Mapping[str, Any] | None = None,
) -> Solution:
    """Find the cube whose shadows are the pictures.

    Method ``display``, and others unless they say that it does not help them, solve a cube more than 48 voxels long at
    half the size first (and that one at a quarter, and so on) and start from there: the lamps and the coarse structure
    come at an eighth of the price.

    Parameters
    ----------
    targets
        The wanted pictures, their views and weights.
    grid
        The block of voxels.
    recipe
        How it is solved; None = ``Recipe()``.
    units
        In so many parts the cube is solved, one after the other and each in its part of the memory: colours, or slabs
        of slices where the lamp is level. With more than one the powers of lamps that are not fixed are found at half
        the size and then kept. Default as few as fit `memory`, or as many as can be where none fits.
    memory
        Bytes; default 6e9. What callback, store and the finished units themselves take comes on top.
    callback
        Called after each iteration; True stops the solver, and the cube's status becomes ``"interrupted"``.
    store
        Keeps the pieces that are finished, and the state of the running one after 2 s, ever more seldom up to every
        30 s, and when stopped; what is in it already is not computed again, and a solver that was stopped goes on
        from its state: the cube is the same, bit for bit, as that of a run without a stop. It must have been used
        for this very job only (`lightcube.jobs.partial.DiskStore` sees to that).
    start
        A cube of as many voxels to start from, instead of a smaller one of these pictures: solved before one of them
        was changed, in another order, or of another material. What is darker than `recipe` allows becomes as dark as
        that; in voxels of another size absorbance is kept.
    provenance
        What else the cube shall remember of how it was made.

    Raises
    ------
    InputError
        For targets that do not belong to the grid, a recipe that cannot be followed there, or a start of another shape.

    Examples
    --------
    >>> import numpy as np, lightcube as lc
    >>> grid = lc.Grid((6, 8, 8))
    >>> rig = lc.turntable(grid, [45, 225], elevation_deg=35, picture_shape=(4, 4))
    >>> wanted = np.random.default_rng(1).uniform(0.1, 1, (2, 4, 4, 3)).astype(np.float32)
    >>> solution = lc.solve(lc.Targets(wanted, rig), grid, lc.Recipe(passes=100))
    >>> solution.cube
    <light cube of 6 x 8 x 8 voxels for 2 pictures, complete>
    >>> lc.score(solution.cube)["psnr_mean"] > 30
    True
    """
    made = make_job(targets, grid, recipe, units=units, memory=memory, start=start, provenance=provenance)
    return solve_job(made, store, callback)


def solve_job(job: Job, store: Store | None = None, callback: Watching | None = None) -> Solution:
    """Solve what is not finished of a job, and put the cube together; `store` and `callback` as `solve` takes them."""
    shelf = MemoryStore() if store is None else store
    solve_pieces(job, job.pieces, shelf, callback, checkpoints=store is not None)
    return merged(job, shelf)


def make_job(
    targets: Targets,
    grid: Grid,
    recipe: Recipe | None = None,
    *,
    units: int | None = None,
    memory: int | None = None,
    start: Cube | None = None,
    provenance: Mapping[str, Any] | None = None,
) -> Job:
    """Check what `solve` is asked for, and leave nothing open; parameters and errors as there."""
    recipe = recipe or Recipe()
    check_targets(targets, grid)
    _check_method(recipe, targets.rig)
    _check_dyes(recipe, targets)
    recipe.bounded_by.least(grid, targets.pictures.shape[-1])
    recipe = recipe.with_passes
    voxels = None if start is None else _as_start(start, grid, targets, recipe)
    job = Job(targets, grid, recipe, start=voxels, provenance=dict(provenance or {}))
    most = job.most_units
    if units is not None and not 1 <= units <= most:
        raise InputError(f"this cube can be solved in 1 to {most} units, not in {units}: ask for a number between")
    most_bytes = memory or MEMORY
    return with_room(replace(job, units=units or fewest_units(job, most_bytes)), most_bytes)


def _as_start(cube: Cube, grid: Grid, targets: Targets, recipe: Recipe) -> Images:
    """Extinction of a cube to start from, of as much absorbance a voxel; `InputError` where it is of another shape.

    Of dyes the amounts that it holds, or those nearest to it.
    """
    wanted = (targets.pictures.shape[-1], *grid.shape)
    if cube.extinction.shape != wanted:
        have, want = (" x ".join(map(str, shape[1:])) for shape in (cube.extinction.shape, wanted))
        colours = f" and {wanted[0]} colours" * (cube.extinction.shape[0] != wanted[0])
        raise InputError(
            f"a cube of {have} voxels (z, y, x) is no start for one of {want}{colours}: give one of the same shape"
        )
    if recipe.dyes is not None and recipe.dyes == cube.dyes:
        return cast(Images, cube.amounts)
    extinction = cube.extinction * np.float32(cube.grid.voxel_mm / grid.voxel_mm)
    return locked(extinction if recipe.dyes is None else nearest(extinction, recipe.dyes.in_block(grid)))


def _check_method(recipe: Recipe, rig: Rig) -> None:
    """Raise `InputError` where a recipe's method cannot do what a rig asks for."""
    method = recipe.solver
    if not method.chooses_lamps and not rig.lamps.are_fixed:
        free = rig.lamps.names[int(np.argmax(rig.lamps.least < rig.lamps.most))]
        raise InputError(
            f"method {method.name} cannot choose the power of lamp {free!r}: give it one, or use method display"
        )
    if not method.takes_sums and not rig.is_thin:
        raise InputError(f"method {method.name} cannot do with light that adds up: use method display")


def _check_dyes(recipe: Recipe, targets: Targets) -> None:
    """Raise `InputError` where dyes are of other colours than the pictures."""
    dyes, colours = recipe.dyes, targets.pictures.shape[-1]
    if dyes is not None and dyes.channels != colours:
        raise InputError(f"dyes that absorb {dyes.channels} colours make no pictures of {colours}: give as many")


def check_targets(targets: Targets, grid: Grid) -> None:
    """Raise `InputError` where a picture is larger than the grid's screen; other screens are as large as they are."""
    from lightcube.projection.stacked import is_stacked  # here: the compiler comes with it

    rig = targets.rig
    if rig.glass is not None or not np.all(rig.screens.endless) or not is_stacked(grid, rig.views):
        return
    rows, columns = rig.picture_shape
    pixel, elevations_deg = rig.views.pixel_in(grid), set(rig.views.elevations_deg.tolist())
    most = [raster_shape(grid, elevation_deg, pixel) for elevation_deg in elevations_deg]
    most_rows, most_columns = min(most)
    if rows > most_rows or columns > most_columns:
        raise InputError(
            f"pictures of {rows} x {columns} pixels (rows x columns) are larger than "
            f"the cube's screen of {most_rows} x {most_columns}: fit them to this grid first"
        )
