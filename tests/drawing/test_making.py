"""The movie of how a cube is made: what looks on changes nothing, and shows it from clear to finished."""

from typing import Any

import numpy as np
import pytest

import lightcube as lc
from lightcube.backward.pieces import Step
from lightcube.drawing.making import MakingOf
from lightcube.drawing.tableau import Tableau
from lightcube.optics.transfer import to_uint8

#: Long enough to be solved at half the size first.
GRID, SIZE = lc.Grid((3, 6, 50), 2.0), (54, 96)


def targets() -> lc.Targets:
    rig = lc.turntable(GRID, [20.0, 100.0], elevation_deg=20.0, picture_shape=(4, 8))
    light = np.random.default_rng(2).uniform(0.05, 0.6, (2, 4, 8, 3)).astype(np.float32)
    return lc.fit(lc.Pictures(tuple(light), ("one", "other")), rig)


@pytest.mark.parametrize("powers", ["per-picture", "shared"])
def test_a_step_has_the_cube_as_it_is(powers: Any) -> None:
    asked, seen = targets(), list[tuple[lc.Cube, Step]]()
    solution = lc.solve(asked, GRID, lc.Recipe(passes=4, powers=powers), callback=lambda step: seen.append(made(step)))
    shapes = [cube.grid.shape for cube, _ in seen]
    assert {shapes[0], shapes[-1]} == {(2, 3, 25), GRID.shape}
    assert sorted(shapes) == shapes
    last, step = seen[-1]
    np.testing.assert_array_equal(last.extinction, solution.cube.extinction)
    np.testing.assert_array_equal(last.powers, solution.cube.powers)
    assert last.status == "interrupted"
    assert step.iteration == 4


def made(step: Step) -> tuple[lc.Cube, Step]:
    assert step.cube is not None
    return step.cube(), step


def test_in_several_units_no_step_has_the_whole_cube() -> None:
    steps: list[Step] = []
    lc.solve(targets(), GRID, lc.Recipe(passes=2), units=3, callback=steps.append)
    assert steps
    assert all(step.cube is None for step in steps)


def test_it_goes_from_clear_to_finished_rests_and_changes_no_bit() -> None:
    asked, recipe = targets(), lc.Recipe(passes=6)
    making = MakingOf(asked, GRID, SIZE, fps=10)
    cube = lc.solve(asked, GRID, recipe, callback=making).cube
    alone = lc.solve(asked, GRID, recipe).cube
    np.testing.assert_array_equal(cube.extinction, alone.extinction)
    np.testing.assert_array_equal(cube.powers, alone.powers)
    film = making.film(cube)
    frames = np.stack(list(film))
    assert (len(frames), frames.shape[1:]) == (len(film), (*SIZE, 3))
    assert 27 < len(frames) <= 80  # at most eight seconds
    clear = lc.Cube(np.zeros_like(cube.extinction), GRID, cube.rig)
    first = Tableau(clear, SIZE)
    for shown, tableau in ((frames[:7], first), (frames[-20:], Tableau(cube, SIZE, first))):
        wanted = to_uint8(tableau.seen(20.0))
        assert all(np.array_equal(frame, wanted) for frame in shown)
    assert len(np.unique(frames.reshape(len(frames), -1), axis=0)) > 10
    assert not film.flicker.is_much
