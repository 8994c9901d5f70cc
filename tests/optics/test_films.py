"""What a stack of films is, where its lamps and films stand, the sun, and light that is reflected twice."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lightcube as lc
from lightcube.errors import InputError
from lightcube.optics.attenuator import Films, attenuator, inside, lattice, outside, snapped
from lightcube.optics.films import paths
from lightcube.optics.ghosts import ghosts
from lightcube.optics.moves import Move, misplaced, moved, places_of
from lightcube.optics.stack import Stack
from lightcube.optics.sun import sunlight
from lightcube.projection.projector import Projector
from tests.helpers import films as plain

NAMES = ["spring", "summer", "autumn", "winter"]
#: Lamps that stand anywhere.
ANY = tuple(lc.Lamp(name, direction=(0.17 * k - 0.2, 0.09 * k * k - 0.3, -1.0)) for k, name in enumerate(NAMES))


def test_a_stack_is_a_block_of_films_at_heights() -> None:
    stack = Stack((3, 4, 6), 2.0, heights_mm=(-5, 0, 7))
    assert stack.size_mm == (12.0, 8.0, 12.0)
    assert stack == replace(stack)
    assert stack != replace(stack, index=1.5)
    assert stack.coarser((9, 2, 3), 2.0) == Stack((3, 2, 3), 4.0, heights_mm=(-5, 0, 7))
    assert Stack((2, 3, 3)).heights_mm == (-0.5, 0.5)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"heights_mm": (0, 1)}, "3 films has as many heights"),
        ({"heights_mm": (0, 2, 1)}, "ascend"),
        ({"heights_mm": (0, 1, np.inf)}, "heights"),
        ({"heights_mm": (0, 1, 1e308)}, "1e6 mm"),
        ({"index": 0.9}, "between 1 and 3"),
    ],
)
def test_stacks_that_cannot_be_are_refused(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        Stack((3, 4, 6), **wrong)


def test_a_stack_has_only_so_many_films() -> None:
    with pytest.raises(InputError, match="at most 256 films, not 257"):
        Stack((257, 1, 1))


@given(count=st.integers(1, 16), gap_mm=st.floats(3, 40), cells=st.integers(1, 4), films=st.integers(2, 8))
def test_usual_lamps_are_unlike_and_move_by_whole_cells_from_film_to_film(
    count: int, gap_mm: float, cells: int, films: int
) -> None:
    asked = Films(films, gap_mm, cells_a_pixel=cells)
    slopes = lattice(asked, count)
    assert len(np.unique(slopes, axis=0)) == count
    assert np.max(np.abs(slopes)) <= np.tan(np.radians(40)) + 1e-9
    steps = slopes * gap_mm / asked.cell_mm
    whole = np.all(np.abs(steps - np.round(steps)) < 1e-9)
    few = 2 * np.tan(np.radians(40)) * gap_mm / asked.cell_mm < 2 * np.ceil(np.sqrt(count))
    assert whole or few


def test_usual_lamps_make_pixels_of_whole_cells() -> None:
    """So means are exact with as few rectangles as a pixel has cells."""
    stage = attenuator(NAMES, Films(5, 12.0))
    assert Projector(stage.grid, stage.rig().squared(1.0)).parts == 4
    anywhere = attenuator(NAMES, Films(5, 12.0), lamps=ANY)
    assert Projector(anywhere.grid, anywhere.rig().squared(1.0)).parts > 50
    again = attenuator(NAMES, Films(5, 12.0), lamps=snapped(ANY, Films(5, 12.0)))
    assert Projector(again.grid, again.rig().squared(1.0)).parts == 4


@pytest.mark.parametrize(("near", "index"), [(False, 1.0), (False, 1.49), (True, 1.0)])
def test_films_are_as_large_as_all_light_needs_and_no_larger(near: bool, index: float) -> None:
    lamps = tuple(lc.Lamp(each.name, position_mm=tuple(-400 * np.array(each.direction))) for each in ANY)
    stage = attenuator(NAMES, Films(3, 9.0, pixels=8, index=index), 1.5, lamps=lamps if near else ANY)
    rig = stage.rig()
    assert rig.picture_shape == (5, 8)
    met = Projector(stage.grid, rig.squared(1.0)).to_sparse()
    assert np.all(np.diff(met.indptr)[np.diff(met.indptr) > 0] == 3)  # no beam misses a film
    films, (_, ny, nx) = np.zeros(met.shape[1]), stage.grid.shape
    films[met.indices] = 1
    volume = films.reshape(ny, nx, -1)
    rows, columns = np.flatnonzero(volume.any(axis=(1, 2))), np.flatnonzero(volume.any(axis=(0, 2)))
    assert min(rows[0], ny - 1 - rows[-1]) == 0
    assert min(columns[0], nx - 1 - columns[-1]) == 0


def test_light_in_acrylic_is_less_aslant() -> None:
    slopes = np.array([[0.4, 0.3], [0.0, 0.0], [-1.0, 2.0]])
    there = inside(slopes, 1.49)
    np.testing.assert_allclose(outside(there, 1.49), slopes, atol=1e-12)
    sines = [np.sin(np.arctan(np.linalg.norm(each, axis=1))) for each in (slopes, there)]
    np.testing.assert_allclose(sines[0], 1.49 * sines[1])
    with pytest.raises(InputError, match=r"42\.2 degrees aslant"):
        outside(np.array([[1.0, 0.0]]), 1.49)


def test_pictures_that_would_be_the_same_are_refused() -> None:
    same = "are cast by the same light"
    upright = (lc.Lamp("up", direction=(0, 0, -1)),)
    with pytest.raises(InputError, match=f"'spring' and 'summer' {same}"):
        attenuator(NAMES, Films(1))
    with pytest.raises(InputError, match=same):
        attenuator(NAMES, Films(3, 0.0))
    orders = [Move("a"), Move("b", order=(2, 1, 3))]
    with pytest.raises(InputError, match=same):
        attenuator(NAMES[:2], Films(3), lamps=upright, moves=orders)
    attenuator(NAMES[:2], Films(3), moves=orders)
    attenuator(NAMES[:2], Films(2, 0.0), moves=[None, Move("b", shift_mm=((0, 0), (5, 0)))])
    with pytest.raises(InputError, match=same):
        attenuator(NAMES[:2], Films(3), lamps=(ANY[0], replace(ANY[0], name="twin")))


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"lamps": ANY[:3]}, "3 lamps for 4 pictures"),
        ({"moves": [None]}, "1 move for 4 pictures"),
        ({"lit": [["lamp 1"]]}, "lamps of 1 picture for 4"),
        ({"aspect": np.inf}, "0.001 to 1000 times as wide"),
        ({"moves": [Move("m", order=(1, 2))] * 4}, "order is of 2 films, and the stack has 5"),
        ({"moves": [Move("m", order=(1, 2, 3, 4, 4))] * 4}, "each film from 1 to 5 once"),
        ({"lamps": (lc.Lamp("steep", direction=(600, 0, -1)), *ANY[1:])}, "cells wide, and 4096"),
        ({"lamps": (lc.Lamp("level", direction=(1, 0, 0)), *ANY[1:])}, "runs along the films"),
    ],
)
def test_rooms_of_films_that_cannot_be_are_refused(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        attenuator(NAMES, **wrong)


@pytest.mark.parametrize("name", ["count", "gap_mm", "size_mm", "pixels", "cells_a_pixel", "screen_mm"])
def test_numbers_of_films_are_bounded(name: str) -> None:
    few: dict[str, Any] = {name: -1}
    many: dict[str, Any] = {name: 10**9 if name in ("count", "pixels", "cells_a_pixel") else 1e308}
    with pytest.raises(InputError):
        replace(Films(), **few)
    with pytest.raises(InputError):
        replace(Films(), **many)


def test_the_screen_stands_where_it_can_where_that_matters() -> None:
    """Through the middle of the stack no wall can stand; parallel light of one lamp alone does not care."""
    films = Films(3, 9.0)
    near = tuple(lc.Lamp(each.name, position_mm=tuple(-400 * np.array(each.direction))) for each in ANY)
    wide = tuple(replace(lamp, size_deg=1.0) for lamp in ANY)
    both = [("spring", "summer"), ("summer",), ("autumn",), ("winter",)]
    for lamps, lit, low_mm in ((ANY, [], 0), (near, [], -9), (wide, [], -9), (ANY, both, -9)):
        stage = attenuator(NAMES, films, lamps=lamps, lit=lit)
        assert stage.screen("wall").centre_mm[2] == low_mm
    assert attenuator(NAMES, replace(films, screen_mm=20.0)).screen("wall").centre_mm[2] == -29


def test_cubes_have_no_films_to_move() -> None:
    stage = attenuator(NAMES, moves=[Move(name, shift_mm=((k, 0),) + ((0, 0),) * 4) for k, name in enumerate(NAMES)])
    with pytest.raises(InputError, match="only the films of a stack are moved"):
        replace(stage, grid=lc.Grid((5, 9, 9)))


@given(
    turn=st.floats(-400, 400),
    right=st.floats(-9, 9),
    up=st.floats(-9, 9),
    at=st.tuples(st.floats(-9, 9), st.floats(-9, 9)),
)
def test_a_moved_film_is_where_it_was_put(turn: float, right: float, up: float, at: tuple[float, float]) -> None:
    """A point of the film, turned and then shifted, is found again at its own place."""
    stack = Stack((1, 2, 2))
    a, b, c, d, x, y, z = Move("m", turn_deg=(turn,), shift_mm=((right, up),)).places(stack)[0]
    angle = np.radians(turn)
    there = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ at + (right, up)
    np.testing.assert_allclose((a * there[0] + b * there[1] + x, c * there[0] + d * there[1] + y), at, atol=1e-9)
    assert z == 0


def test_films_lie_in_the_order_that_is_said() -> None:
    places = Move("m", order=(3, 1, 2)).places(Stack((3, 2, 2), heights_mm=(-4, 0, 9)))
    np.testing.assert_array_equal(places[:, 6], (0, 9, -4))


def test_misplaced_films_are_off_by_so_much_in_the_room() -> None:
    stage = attenuator(NAMES[:2], Films(2), moves=[None, Move("m", turn_deg=(0, 90), shift_mm=((3, 1), (0, 0)))])
    stack, rig, off = plain.stack_of(stage), stage.rig(), np.array([[0.5, -0.25, 0.0], [1.0, 2.0, 3.0]])
    before, after = (paths(stack, each).lines for each in (rig, misplaced(rig, stack, off)))
    for picture, (first, second) in enumerate(zip(before, after, strict=True)):
        turn = places_of(stack, rig)[picture, :, :4].reshape(2, 2, 2)
        slope = np.array([-lamp for lamp in rig.views.lamps[picture, :2]]) / rig.views.lamps[picture, 2] * -1
        seen = -(turn @ off[:, :2, None])[..., 0] + (turn @ slope) * off[:, 2:]
        np.testing.assert_allclose(second[..., 2] - first[..., 2], seen, atol=1e-12)


def test_places_are_of_as_many_films_as_the_stack_has() -> None:
    stage = attenuator(NAMES)
    rig = moved(stage.rig(), plain.stack_of(stage), [Move("m"), None, None, None])
    with pytest.raises(InputError, match="places of 5 films do not fit a stack of 3"):
        places_of(Stack((3, 2, 2)), rig)


@pytest.mark.parametrize(
    ("latitude", "day", "height"),
    [(0.0, "03-21", 90.0), (52.0, "06-21", 61.4), (52.0, "12-21", 14.6), (-35.0, "12-21", 78.4)],
)
def test_the_sun_stands_at_noon_as_high_as_almanacs_say(latitude: float, day: str, height: float) -> None:
    """90 degrees less the latitude's distance from the declination, which is 23.4 at the solstices."""
    way = sunlight(latitude, day, 12.0)
    assert np.degrees(np.arcsin(-way[2])) == pytest.approx(height, abs=0.6)
    assert np.linalg.norm(way) == pytest.approx(1)
    if height < 89:
        assert np.sign(way[1]) == np.sign(latitude)  # away from the sun: up in the picture, which is north


def test_the_sun_rises_in_the_east_and_windows_face_where_they_are_said_to() -> None:
    morning, evening = sunlight(50.0, "06-21", 8.0), sunlight(50.0, "06-21", 16.0)
    np.testing.assert_allclose(morning * (-1, 1, 1), evening, atol=1e-12)
    assert morning[0] < 0  # from the east, the right of films whose lower edge is south
    window = sunlight(50.0, "12-21", 12.0, faces_deg=180, tilt_deg=90)
    height = np.arcsin(-sunlight(50.0, "12-21", 12.0)[2])
    np.testing.assert_allclose(window, (0, -np.sin(height), -np.cos(height)), atol=1e-9)


@pytest.mark.parametrize(
    ("given_", "said"),
    [
        ((91.0, "06-21", 12.0), "latitude_deg"),
        ((50.0, "6/21", 12.0), "a day is a month and a day"),
        ((50.0, "02-30", 12.0), "a day is a month and a day"),
        ((50.0, "06-21", 25.0), "hour lies between 0 and 24"),
        ((50.0, "06-21", 0.0), "below the horizon"),
        ((50.0, "06-21", 12.0, 0.0, 90.0), "on the back"),
        ((50.0, "06-21", 12.0, 180.0, 91.0), "tilt_deg"),
    ],
)
def test_suns_that_do_not_shine_are_refused(given_: tuple[Any, ...], said: str) -> None:
    with pytest.raises(InputError, match=said):
        sunlight(*given_)


def test_ghosts_are_those_of_light_that_is_followed_from_face_to_face() -> None:
    """Two loose films: four faces of 5.3 %, of whose pairs those across the gap and over it are displaced."""
    mirror = (0.6 / 2.6) ** 2
    found = ghosts(2)
    assert found.through == pytest.approx((1 - mirror) ** 4)
    crossing = 1 + 2 * (1 - mirror) ** 2 + (1 - mirror) ** 4
    assert found.displaced == pytest.approx(mirror**2 * crossing)
    assert found.within == pytest.approx(2 * mirror**2)
    assert ghosts(5).displaced == pytest.approx(0.083, abs=0.002)
    assert ghosts(5, 0.3).displaced < ghosts(5).displaced / 3
    assert ghosts(5, plates=True).displaced == pytest.approx(0.206, abs=0.01)
    assert ghosts(5, loose=False).displaced == pytest.approx(mirror**2)


def test_ghosts_are_of_films() -> None:
    with pytest.raises(InputError, match="1 film or more"):
        ghosts(0)
    with pytest.raises(InputError, match="at least 0"):
        ghosts(3, float("nan"))
