"""A cube made of films: solved anew for thin sheets, since a cube's slices on films are another block than the cube."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from lightcube.backward.recipe import recipe_of
from lightcube.backward.solving import solve
from lightcube.errors import InputError
from lightcube.events import Tell, counting
from lightcube.optics.arrays import Volume, locked
from lightcube.optics.cube import Cube
from lightcube.optics.material import Material
from lightcube.optics.stack import MOST_FILMS, Stack
from lightcube.pictures.fitting import targets_of
from lightcube.scoring.metrics import score

#: Printers reach this density in each colour; and how often a stack is solved that starts from a cube.
_DENSITY, _PASSES = 1.5, 60
#: Light that is less aslant to the films than this, degrees, runs along them; and what cubes are usually lit at.
_FLAT_DEG, _USUAL_DEG = 10.0, 35


@dataclass(frozen=True, eq=False)
class Restacked:
    """A cube as films.

    Parameters
    ----------
    cube
        The stack.
    psnr_slices
        Mean PSNR, dB, of the cube's slices on as many films as they are, and under the cube's lamps.
    """

    cube: Cube
    psnr_slices: float


def restacked(cube: Cube, films: int, tell: Tell | None = None) -> Restacked:
    """Solve so many films, evenly apart where the cube is, for the pictures that the cube was made for.

    Raises
    ------
    InputError
        Where the cube is a stack already, has no pictures, or its light runs along the films.
    """
    stack = stack_of(cube, films)
    targets = targets_of(cube)
    start = replace(
        cube,
        grid=stack,
        extinction=sliced(cube, stack),
        amounts=None,
        dyes=None,
        targets=None,
        scores={},
        provenance={},
    )
    recipe = replace(recipe_of(cube), material=Material(_DENSITY * math.log(10), "voxel"), passes=_PASSES, light=None)
    advance = None if tell is None else counting(tell)
    done = 0

    def look(*_: object) -> bool:
        nonlocal done
        done += 1
        if advance is not None:
            advance(min(done, _PASSES), _PASSES)
        return False

    slices = score(start, targets)["psnr_mean"]
    solution = solve(targets, stack, recipe, start=start, callback=look)
    made = solution.cube
    return Restacked(replace(made, scores=score(made, targets)), slices)


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
