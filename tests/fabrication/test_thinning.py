"""Cubes as films: each absorbs what its part of the cube did, and those that are solved anew cast better pictures."""

import math
from dataclasses import replace

import numpy as np
import pytest

from lightcube.backward.recipe import Recipe
from lightcube.backward.solving import solve
from lightcube.errors import InputError
from lightcube.fabrication.thinning import as_films, sliced, stack_of
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.stack import Stack
from lightcube.pictures.fitting import fit
from lightcube.pictures.samples import photographs


@pytest.fixture(scope="module")
def cube() -> Cube:
    """A cube of 12 slices for three photographs under a raised lamp."""
    grid = Grid((12, 10, 10), 2.0)
    rig = turntable(grid, [20, 140, 260], elevation_deg=35, picture_shape=(6, 6), power_max=16.0)
    return solve(fit(photographs(3, 1.0), rig), grid, Recipe(passes=30)).cube


@pytest.mark.parametrize("films", [2, 5, 12, 30])
def test_films_absorb_what_their_parts_of_a_cube_do(cube: Cube, films: int) -> None:
    weak = replace(cube, extinction=cube.extinction / np.float32(50))
    stack = stack_of(weak, films)
    absorbed = sliced(weak, stack).sum(axis=1, dtype=np.float64) * stack.voxel_mm
    assert np.allclose(absorbed, weak.extinction.sum(axis=1, dtype=np.float64) * 2, rtol=1e-5, atol=1e-7)
    assert stack.heights_mm[-1] - stack.heights_mm[0] == pytest.approx(24 * (1 - 1 / films))
    assert sum(stack.heights_mm) == pytest.approx(0, abs=1e-9)


def test_films_lie_where_their_slices_do(cube: Cube) -> None:
    one = np.zeros_like(cube.extinction)
    one[:, 7, 3, 4] = 0.01
    found = sliced(replace(cube, extinction=one), stack_of(cube, 6))
    assert np.argwhere(found[0]).tolist() == [[3, 3, 4]]  # the eighth of twelve slices lies on the fourth of six films


def test_films_that_are_solved_for_themselves_are_better(cube: Cube) -> None:
    told: list[object] = []
    made = as_films(cube, 6, tell=told.append)
    assert isinstance(made.grid, Stack)
    assert made.grid.shape == (6, 10, 10)
    assert made.scores["psnr_mean"] > made.provenance["psnr_of_slices"] + 3
    assert made.extinction.max() * made.grid.voxel_mm <= 1.5 * math.log(10) + 1e-4
    assert np.array_equal(made.targets, cube.targets)  # type: ignore[arg-type]
    assert told


def test_light_that_runs_along_films_is_told_how_to_be(cube: Cube) -> None:
    level = turntable(cube.grid, [20, 140, 260], picture_shape=(6, 6))
    with pytest.raises(InputError, match=r"only 0 degrees steep.*--elevation-deg 35"):
        as_films(Cube(cube.extinction, cube.grid, level, targets=cube.targets), 4)


@pytest.mark.parametrize(("films", "told"), [(1, "2 to 256 films"), (10**6, "2 to 256 films")])
def test_too_few_and_too_many_films_are_refused(cube: Cube, films: int, told: str) -> None:
    with pytest.raises(InputError, match=told):
        as_films(cube, films)


def test_a_stack_is_no_cube(cube: Cube) -> None:
    stack = stack_of(cube, 3)
    with pytest.raises(InputError, match="a stack of 3 films already"):
        as_films(Cube(sliced(cube, stack), stack, cube.rig), 4)
    with pytest.raises(InputError, match="no targets"):
        as_films(replace(cube, targets=None), 4)
