"""A cube made of films: solved anew for thin sheets, since a cube's slices on films are another block than the cube."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from lightcube.backward.pieces import Watching
from lightcube.backward.recipe import recipe_of
from lightcube.backward.solving import solve
from lightcube.errors import InputError
from lightcube.events import Tell, counting
from lightcube.optics.arrays import Volume, locked
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.light import Light
from lightcube.optics.material import Material
from lightcube.optics.stack import MOST_FILMS, Stack
from lightcube.pictures.fitting import targets_of
from lightcube.scoring.metrics import score

#: Printers reach this density in each colour; how often a stack is solved that starts from a cube, and over how many
#: points of a pixel: thin sheets vary more inside pixels than voxels do (benchmarks/thinning.py).
_DENSITY, _PASSES, _POINTS = 1.5, 60, 50
#: Light that is less aslant to the films than this, degrees, runs along them; and what cubes are usually lit at.
_FLAT_DEG, _USUAL_DEG = 10.0, 35


@checked
def as_films(cube: Cube, films: int, *, tell: Tell | None = None) -> Cube:
    """Solve a cube anew as a stack of films that lie flat: `export` makes pages of it.

    A slice of a cube that is printed on a film casts something else than the slice did, since its light went through
    slabs that were as thick as the room between films. So films are solved for the cube's pictures, from its slices on.

    Parameters
    ----------
    films
        How many, evenly apart where the cube is.
    tell
        Is told of every pass.

    Returns
    -------
    The stack, whose ``provenance["psnr_of_slices"]`` is what slices as they are would have cast, mean PSNR in dB.

    Raises
    ------
    InputError
        Where the cube is a stack already, has no pictures, or its light runs along the films.

    Examples
    --------
    >>> import lightcube as lc
    >>> grid = lc.Grid((4, 8, 8))
    >>> rig = lc.turntable(grid, [20, 80], elevation_deg=35, picture_shape=(4, 4))
    >>> targets = lc.Targets(np.full((2, 4, 4, 3), 0.5, np.float32), rig, np.ones((2, 4, 4), np.float32))
    >>> lc.as_films(lc.solve(targets, grid, lc.Recipe(passes=2)).cube, 2).grid
    <stack of 2 films of 8 x 8 cells of 1 mm>
    """
    stack, targets = stack_of(cube, films), targets_of(cube)
    slices = sliced(cube, stack)
    start = replace(cube, grid=stack, extinction=slices, amounts=None, dyes=None, scores={}, provenance={})
    before = score(start, targets)["psnr_mean"]
    material = Material(_DENSITY * math.log(10), "voxel")
    recipe = replace(recipe_of(cube).by_display(_PASSES), material=material, light=Light(_POINTS))
    look = None if tell is None else _looking(tell)
    made = solve(targets, stack, recipe, start=start, callback=look, provenance={"psnr_of_slices": before}).cube
    return replace(made, scores=score(made, targets))


def _looking(tell: Tell) -> Watching:
    """What counts passes while films are solved."""
    advance, done = counting(tell), itertools.count(1)

    def look(*_: object) -> bool:
        advance(min(next(done), _PASSES), _PASSES)
        return False

    return look


def stack_of(cube: Cube, films: int) -> Stack:
    """So many films in the middles of as many equal parts of a cube; `InputError` where they are none for it."""
    grid = cube.grid
    if isinstance(grid, Stack):
        raise InputError(f"this is a stack of {grid.shape[0]} films already: leave --films out")
    if not 2 <= films <= MOST_FILMS:
        raise InputError(f"a cube is made of 2 to {MOST_FILMS} films, not of {films}: mend --films")
    ways = cube.rig.views.origins_mm - cube.rig.views.lamps[:, :3]
    ways = np.where(cube.rig.views.lamps[:, 3:] == 1, ways, cube.rig.views.lamps[:, :3])
    steep = np.degrees(np.arcsin(np.abs(ways[:, 2]) / np.linalg.norm(ways, axis=1)))
    if steep.min() < _FLAT_DEG:
        raise InputError(
            f"the light of this cube is only {steep.min():.3g} degrees steep and runs along films that lie flat: solve "
            f"it with a raised lamp (solve --elevation-deg {_USUAL_DEG})"
        )
    apart = grid.size_mm[0] / films
    heights = (np.arange(films) - (films - 1) / 2) * apart
    return Stack((films, *grid.shape[1:]), grid.voxel_mm, heights_mm=tuple(heights.tolist()))


def sliced(cube: Cube, stack: Stack) -> Volume:
    """The extinction of films, each of which absorbs what its part of a cube does, as dark as films can be."""
    nz = cube.grid.shape[0]
    below = np.zeros((len(cube.extinction), nz + 1, *cube.grid.shape[1:]))
    np.cumsum(cube.extinction * cube.grid.slice_mm, axis=1, dtype=np.float64, out=below[:, 1:])
    edges = np.linspace(0, nz, stack.shape[0] + 1)
    whole = np.minimum(edges.astype(np.int64), nz - 1)
    part = (edges - whole)[:, None, None]
    at = below[:, whole] + part * (below[:, whole + 1] - below[:, whole])
    absorbance = np.minimum(np.diff(at, axis=1), _DENSITY * math.log(10))
    return locked((absorbance / stack.voxel_mm).astype(np.float32))
