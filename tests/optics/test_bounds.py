"""Finite is not sane: what stands too far away, shines nowhere or has no size is refused at every door."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import lightcube as lc
from lightcube.errors import InputError
from lightcube.optics.tables import Fading, Stops, Sums, Turning
from lightcube.optics.views import Views

GRID = lc.Grid((3, 5, 7), 0.5)
RIG = lc.turntable(GRID, [10, 100])
NAMES = ("lamps", "origins_mm", "column_steps_mm", "row_steps_mm")


def changed(name: str, row: list[float], **others: Any) -> Views:
    """The views of a turntable, the second one changed."""
    arrays = {each: np.array(getattr(RIG.views, each)) for each in NAMES}
    arrays[name][1] = row
    return Views(**arrays, picture_shape=others.get("picture_shape", RIG.picture_shape))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("huge", [1e308, -1e308, 1e200, 1e19])
def test_no_length_is_huge(name: str, huge: float) -> None:
    row = [huge, 1.0, 1.0, 0.0] if name == "lamps" else [huge, 1.0, 1.0]
    with pytest.raises(InputError, match=f"^{name} of view 2 is 1e"):
        changed(name, row)


@pytest.mark.parametrize("name", ["lamps", "column_steps_mm", "row_steps_mm"])
@pytest.mark.parametrize("tiny", [0.0, 1e-300, 5e-324, 1e-19])
def test_what_points_somewhere_has_a_length(name: str, tiny: float) -> None:
    row = [tiny, 0.0, 0.0, 0.0] if name == "lamps" else [tiny, 0.0, 0.0]
    with pytest.raises(InputError, match=f"^{name} of view 2 is "):
        replace(RIG, views=changed(name, row))


def test_screens_have_a_size_and_lamps_a_kind() -> None:
    with pytest.raises(InputError, match="run along one line"):
        replace(RIG, views=changed("row_steps_mm", [-3.0 * each for each in RIG.views.column_steps_mm[1]]))
    small = replace(RIG, views=changed("row_steps_mm", [0.0, 0.0, 1e-6]))
    with pytest.raises(InputError, match="a pixel is 2e-06 voxels large"):
        lc.Cube(np.zeros((3, *GRID.shape), np.float32), GRID, small)
    for fourth in (0.5, -1.0, 1e300):
        with pytest.raises(InputError, match="the fourth number of a lamp"):
            changed("lamps", [1.0, 0.0, 0.0, fourth])
    with pytest.raises(InputError, match="from 1 to a million"):
        changed("origins_mm", [0.0, 0.0, 0.0], picture_shape=(10**9, 1))


@pytest.mark.parametrize(
    ("name", "row", "said"),
    [
        ("lamps", [1e17, 0.0, 0.0, 1.0], r"the lamp of view 2 reaches 1e\+17 mm .* 3\.5e\+15 mm is the most"),
        ("origins_mm", [0.0, 1e17, 0.0], "the picture of view 2 reaches"),
        ("row_steps_mm", [0.0, 0.0, 1e17], "the picture of view 2 reaches"),
    ],
)
def test_what_stands_around_a_cube_is_within_its_reach(name: str, row: list[float], said: str) -> None:
    views = changed(name, row)
    with pytest.raises(InputError, match=said):
        lc.Projector(GRID, views)
    with pytest.raises(InputError, match=said):
        lc.Cube(np.zeros((3, *GRID.shape), np.float32), GRID, replace(RIG, views=views))


@pytest.mark.parametrize("far", [1e6, 1e9])
def test_within_its_bounds_a_far_lamp_is_parallel_light(far: float) -> None:
    volume = np.random.default_rng(0).uniform(0, 1, GRID.shape)
    along = RIG.views.lamps[:, :3]
    behind = replace(RIG.views, origins_mm=10 * along)
    lamps = replace(behind, lamps=np.column_stack([-far * along, np.ones(2)]))
    parallel = lc.Projector(GRID, behind)(volume)
    np.testing.assert_allclose(lc.Projector(GRID, lamps)(volume), parallel, atol=1e3 / far)
    loud = replace(behind, lamps=far * behind.lamps)
    np.testing.assert_allclose(lc.Projector(GRID, loud)(volume), parallel, atol=1e-9)


@pytest.mark.parametrize("angle", [1e10, -1e308, math.inf, math.nan])
def test_angles_are_those_of_a_table(angle: float) -> None:
    with pytest.raises(InputError, match="angle number 2 is not a finite number of degrees"):
        lc.turntable(GRID, [0, angle])


@pytest.mark.parametrize("wrong", [math.nan, 1e308, -1e308])
def test_tables_of_a_rig_hold_sane_numbers(wrong: float) -> None:
    zero, one = np.zeros(1), np.ones((1, 1))
    first = np.zeros(1, np.intp)
    for make in (
        lambda: Sums(first, first, wrong * one, zero),
        lambda: Sums(first, first, one, wrong + zero),
        lambda: Fading(np.full((1, 2), wrong), np.zeros((1, 2)), np.full(1, np.inf), np.zeros(1, np.bool_)),
        lambda: Turning(np.ones((1, 2), np.bool_), np.full((1, 2), wrong), np.array([0.0, 0.0, 1.0])),
        lambda: Turning(np.ones((1, 2), np.bool_), np.ones((1, 2)), np.array([0.0, wrong, 1.0])),
        lambda: Stops(wrong + zero, first, np.ones((1, 2), np.intp)),
    ):
        with pytest.raises(InputError, match=r"of a rig holds NaN or numbers beyond 1e\+12"):
            make()
