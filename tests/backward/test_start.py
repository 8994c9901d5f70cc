"""What a cube is solved from: another cube of as many voxels instead of a smaller one."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lightcube.backward.job import differences, fingerprint
from lightcube.backward.solution import merged
from lightcube.backward.solving import make_job, solve
from lightcube.backward.store import MemoryStore
from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.pictures.targets import Targets
from lightcube.scoring.metrics import mean_psnr
from tests.backward.test_job import LEVEL, RAISED, SHAPE, some_targets
from tests.helpers.recipes import asked
from tests.helpers.thin import play

GRID = Grid(SHAPE, 0.7)


def some_cube(grid: Grid = GRID, most: float = 0.4) -> Cube:
    targets = some_targets(grid.shape)
    extinction = np.random.default_rng(3).uniform(0, most, (3, *grid.shape)).astype(np.float32)
    return Cube(extinction, grid, targets.rig)


def test_one_picture_changed_is_solved_sooner_from_the_cube_before() -> None:
    """After as few passes it is nearer to the new pictures than what begins clear."""
    known = some_cube()
    targets = Targets(play(known), known.rig)
    pictures = targets.pictures.copy()
    pictures[1] *= np.float32(0.95)
    changed = replace(targets, pictures=pictures)
    recipe = asked(changed, GRID, passes=3)["recipe"]
    cubes = [solve(changed, GRID, recipe, start=start).cube for start in (None, known)]
    clear, before = (mean_psnr(play(cube), changed) for cube in cubes)
    assert before > clear + 3


@pytest.mark.parametrize("options", [{}, RAISED, LEVEL], ids=str)
def test_it_is_where_each_unit_starts(options: dict[str, Any]) -> None:
    """Before any unit is begun the cube is the one that was given; coarse cubes are for powers alone."""
    given = dict(options)
    size, elevation_deg = given.pop("size", (3, 5)), given.pop("elevation_deg", 35.0)
    start = some_cube()
    targets = some_targets(size=size, elevation_deg=elevation_deg)
    job = make_job(**asked(targets, GRID, passes=3, start=start, **given))
    assert [name for name in job.pieces if name.startswith("level")] == (["level-1"] if options else [])
    assert np.array_equal(merged(job, MemoryStore()).cube.extinction, start.extinction)


def test_no_smaller_cube_is_solved_for_a_start_that_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lightcube.backward.units.COARSEST", 3)
    targets = some_targets()
    assert make_job(**asked(targets, GRID)).levels == 2
    assert make_job(**asked(targets, GRID, start=some_cube())).levels == 0


def test_a_start_keeps_its_absorbance_and_the_bound() -> None:
    """In voxels twice as large extinction halves; what is darker than the material can be becomes as dark as that."""
    start = some_cube(Grid(SHAPE, 0.35))
    job = make_job(**asked(some_targets(), GRID, start=start, max_extinction=0.1))
    wanted = np.minimum(start.extinction / 2, 0.1)
    np.testing.assert_allclose(merged(job, MemoryStore()).cube.extinction, wanted, rtol=1e-6)


def test_a_start_is_part_of_what_a_job_is_known_by() -> None:
    with_it = make_job(**asked(some_targets(), GRID, start=some_cube()))
    for other in (None, some_cube(most=0.2)):
        found = differences(fingerprint(with_it), fingerprint(make_job(**asked(some_targets(), GRID, start=other))))
        assert found == ["the voxels to start from differ"]


@pytest.mark.parametrize("shape", [(4, 6, 7), (5, 7, 6)])
def test_a_start_of_another_shape_is_refused(shape: tuple[int, int, int]) -> None:
    sides = " x ".join(map(str, shape))
    with pytest.raises(InputError, match=rf"a cube of {sides} voxels \(z, y, x\) is no start for one of 4 x 7 x 6:"):
        make_job(**asked(some_targets(), GRID, start=some_cube(Grid(shape))))


def test_a_start_of_other_colours_is_refused() -> None:
    start = some_cube()
    grey = Cube(np.ascontiguousarray(start.extinction[:1]), GRID, start.rig)
    with pytest.raises(InputError, match="and 3 colours: give"):
        make_job(**asked(some_targets(), GRID, start=grey))
