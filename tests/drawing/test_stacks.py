"""Laws of the room of films: light goes where it goes, films are seen where they lie, in the colours that they have."""

from dataclasses import replace

import numpy as np
import pytest

import lightcube as lc
from lightcube.drawing.camera import FINE, Camera, Canvas
from lightcube.drawing.eyes import camera_for
from lightcube.drawing.film_glass import FilmGlass
from lightcube.drawing.room import Room
from lightcube.drawing.stacks import films_at, followed, is_anywhere, lowered, sheets
from lightcube.drawing.standing import standing
from lightcube.errors import InputError
from lightcube.forward.casting import cast
from lightcube.forward.turning import turn
from lightcube.optics.cube import Cube
from lightcube.optics.moves import places_of
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.optics.stage import Stage
from tests.helpers.films import room, stack_of

STACK = Stack((3, 12, 14), 2.0, heights_mm=(-9.0, 1.0, 8.0))


def stack_cube(rig: Rig, stack: Stack = STACK) -> Cube:
    extinction = np.random.default_rng(4).uniform(0, 0.4, (3, *stack.shape)).astype(np.float32)
    return Cube(extinction, stack, rig)


def slid() -> tuple[Stage, Cube]:
    moves = [None, lc.Move("a", shift_mm=((0, 0), (6, -3))), lc.Move("b", order=(2, 1), turn_deg=(0, 90))]
    stage = lc.attenuator(["x", "y", "z"], lc.Films(count=2, gap_mm=10, pixels=4, size_mm=40), moves=moves)
    return stage, stack_cube(stage.rig(), stack_of(stage))


@pytest.mark.parametrize(("near", "index"), [(False, 1.0), (True, 1.0), (False, 1.49)])
def test_a_lowered_sheet_shows_the_same_pictures(near: bool, index: float) -> None:
    stack = replace(STACK, index=index)
    rig = room(stack, near=near, low_mm=-9.0 if near else 0.0)
    lower = lowered(stack, rig)
    assert np.all(lower.views.origins_mm[:, 2] < stack.heights_mm[0] - 5)
    cube = stack_cube(rig, stack)
    for shown, kept in zip(cast(cube, lower), cast(cube, rig), strict=True):
        np.testing.assert_allclose(shown, kept, atol=2e-6)


def test_a_sheet_whose_place_is_said_stays_there() -> None:
    rig = room(STACK, low_mm=-40.0)
    assert is_anywhere(STACK, rig) == [False, False]
    np.testing.assert_array_equal(lowered(STACK, rig).views.origins_mm, rig.views.origins_mm)


@pytest.mark.parametrize("index", [1.0, 1.49])
def test_light_is_followed_by_snells_law(index: float) -> None:
    stack = replace(STACK, index=index)
    rig = room(stack)
    heights = np.array([-30.0, -9.0, 8.0, 20.0])
    at = followed(stack, rig, 0, np.array([[1.0, 2.0, -30.0]]), heights)[0]
    np.testing.assert_allclose(at[0], (1, 2, -30))
    steps = np.diff(at, axis=0)
    sines = np.linalg.norm(steps[:, :2], axis=1) / np.linalg.norm(steps, axis=1)
    np.testing.assert_allclose(sines[[0, 2]], sines[1] * index)


def test_films_are_at_their_places_and_on_their_way_between() -> None:
    stage, cube = slid()
    stack, angles = stack_of(stage), stage.stops_deg
    for angle_deg, places in zip(angles, places_of(stack, cube.rig), strict=True):
        np.testing.assert_allclose(films_at(stack, cube.rig, angle_deg), places, atol=1e-9)
        corners = sheets(stack, films_at(stack, cube.rig, angle_deg))
        own = np.einsum("fij,fcj->fci", places[:, :4].reshape(-1, 2, 2), corners[..., :2]) + places[:, None, 4:6]
        np.testing.assert_allclose(np.abs(own).max(axis=(0, 1)), np.array(stack.size_mm[:0:-1]) / 2)
    between = sheets(stack, films_at(stack, cube.rig, (angles[0] + angles[1]) / 2))
    np.testing.assert_allclose(between[1].mean(axis=0), (3, -1.5, 5))


@pytest.mark.parametrize("picture", [0, 1, 2])
def test_a_bare_eye_sees_each_film_where_it_lies(picture: int) -> None:
    stage, cube = slid()
    stack, angle_deg = stack_of(stage), stage.stops_deg[picture]
    camera = Camera((20.0, -50.0, 70.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 50.0, (13, 17))
    canvas = Canvas(camera)
    seen = FilmGlass(cube).seen(canvas, standing(cube, angle_deg), np.zeros(3), 1.0)
    assert seen is not None
    places, cell = places_of(stack, cube.rig)[picture], stack.voxel_mm
    expected = np.zeros((*camera.size, 3))
    for row, column in np.ndindex(camera.size):
        way = canvas.ways(canvas.whole)[row, column]
        for film, (a, b, c, d, x, y, z) in enumerate(places):
            met = canvas.eye + (z - canvas.eye[2]) / way[2] * way
            u, v = a * met[0] + b * met[1] + x, c * met[0] + d * met[1] + y
            i, j = int(np.floor(v / cell + stack.shape[1] / 2)), int(np.floor(u / cell + stack.shape[2] / 2))
            if 0 <= i < stack.shape[1] and 0 <= j < stack.shape[2]:
                expected[row, column] += cube.extinction[:, film, i, j] * cell * np.linalg.norm(way) / abs(way[2])
    assert np.count_nonzero(expected.sum(axis=-1)) > 50
    region = tuple(slice(part.start // FINE, part.stop // FINE) for part in seen.pixels)
    np.testing.assert_allclose(seen.through, np.exp(-expected[region]), rtol=1e-3, atol=1e-5)


def test_the_room_of_films_has_paper_for_all_pictures_and_no_table() -> None:
    stage = lc.attenuator(["a", "b", "c", "d"], lc.Films(count=3, gap_mm=12, pixels=4))
    cube = stack_cube(stage.rig(), stack_of(stage))
    camera = camera_for(cube, (54, 96))
    frames = [Room(cube).seen(camera, angle_deg, lit=False) for angle_deg in stage.stops_deg[:2]]
    np.testing.assert_allclose(frames[0], frames[1], rtol=0, atol=5e-3)  # in the dark nothing tells pictures apart
    lit = [Room(cube).seen(camera, angle_deg) for angle_deg in stage.stops_deg[:2]]
    assert np.abs(lit[0] - lit[1]).max() > 0.1
    assert np.argmax(np.abs(np.subtract(camera.target, camera.eye))[:2]) == 1  # as one who reads the pictures
    assert camera.eye[1] < 0


def test_a_cube_has_no_films() -> None:
    grid = lc.Grid((2, 3, 4))
    with pytest.raises(InputError, match="only a stack has films"):
        FilmGlass(Cube(np.zeros((3, 2, 3, 4), np.float32), grid, lc.turntable(grid, [0])))


def test_a_film_of_films_shows_each_picture_and_never_turns() -> None:
    stage = lc.attenuator(["a", "b", "c"], lc.Films(count=2, gap_mm=12, pixels=4))
    cube = replace(stack_cube(stage.rig(), stack_of(stage)), extinction=np.zeros((3, *stage.grid.shape), np.float32))
    np.testing.assert_array_equal(turn(cube), stage.stops_deg)
    said = lc.film(cube).said  # pictures that are all alike flow into each other, but there is no turn
    assert "at each of 3 pictures the lamp fades in" in said
    assert "turn" not in said
