"""What tells the pictures of films apart, in words."""

import numpy as np
import pytest

import lightcube as lc
from lightcube.optics.moves import places_of
from lightcube.optics.naming import clock, lamps_of, moves_of, off_upright_deg, shifts_of, told_apart
from tests.helpers.films import stack_of

FILMS = lc.Films(count=3, gap_mm=12, pixels=8)


def test_pictures_are_told_by_their_lamps() -> None:
    stage = lc.attenuator(["a", "b"], FILMS)
    assert told_apart(stage.rig()) == ["under lamp 1", "under lamp 2"]


def test_pictures_are_told_by_how_films_lie() -> None:
    moves = [
        None,
        lc.Move("order", order=(2, 1, 3)),
        lc.Move("slid", shift_mm=((0, 0), (5, -2.5), (0, 0)), turn_deg=(0, 0, 90)),
        lc.Move("all", shift_mm=((1, 0), (2, 0), (-1, 0))),
    ]
    stage = lc.attenuator(["a", "b", "c", "d"], FILMS, moves=moves)
    assert told_apart(stage.rig()) == [
        "films as they are",
        "films 2, 1, 3 from below",
        "film 2 slid 5 mm right and 2.5 mm down, film 3 turned 90°",
        "films slid",
    ]
    assert moves_of(stage.rig())[0] == ""
    assert set(lamps_of(stage.rig())) == {"lamp"}


def test_shifts_and_turns_come_back_as_they_were_given() -> None:
    random = np.random.default_rng(3)
    shifts, turns = random.normal(size=(3, 2)), random.uniform(-170, 170, 3)
    move = lc.Move("m", shift_mm=tuple((float(x), float(y)) for x, y in shifts), turn_deg=tuple(map(float, turns)))
    stage = lc.attenuator(["a", "b"], FILMS, moves=[None, move])
    found = shifts_of(places_of(stack_of(stage), stage.rig())[1])
    np.testing.assert_allclose(found[0], shifts, atol=1e-9)
    np.testing.assert_allclose(found[1], turns, atol=1e-9)


@pytest.mark.parametrize(
    ("x", "y", "said"),
    [
        *((0, 1, "12:00"), (1, 1, "1:30"), (2, 0, "3:00"), (0, -1, "6:00"), (-1, 1, "10:30"), (-0.001, 1, "12:00")),
        (0, 0, ""),
    ],
)
def test_places_are_told_by_the_hand_of_a_clock(x: float, y: float, said: str) -> None:
    assert clock(x, y) == said


def test_upright_is_no_degrees_and_level_is_ninety() -> None:
    ways = np.array([(0, 0, -2.0), (1, 0, -1), (0, -1, 1), (3, 0, 0)])
    np.testing.assert_allclose(off_upright_deg(ways), [0, 45, 45, 90])
