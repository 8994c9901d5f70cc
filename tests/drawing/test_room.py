"""Laws of the room's picture: what is seen where, and what the cube's glass does to it."""

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lightcube.drawing import tones
from lightcube.drawing.camera import FINE, Camera, Canvas, fitting
from lightcube.drawing.eyes import camera_for
from lightcube.drawing.orbit import lamps_orbit
from lightcube.drawing.room import Room, room_picture
from lightcube.drawing.standing import extent, standing
from lightcube.errors import InputError
from lightcube.forward import casting
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from tests.helpers.wall import play

Array = NDArray[np.floating[Any]]
GRID = Grid((3, 5, 4), 4.0)
UP = (0.0, 0.0, 1.0)
STAGES: tuple[dict[str, Any], ...] = ({"cube_turns": True}, {"cube_turns": False})


def cube_on(stage: Stage, extinction: Array | None = None) -> Cube:
    rig = stage.rig()
    given = np.random.default_rng(5).uniform(0, 0.08, (3, *stage.grid.shape)) if extinction is None else extinction
    return Cube(given.astype(np.float32), stage.grid, rig)


def one(screen: Screen, lamp: Lamp, **table: Any) -> Stage:
    return Stage(GRID, (lamp,), (screen,), (Shot("a", screen.name, (lamp.name,)),), **table)


def homogeneous(*extinction: float) -> Array:
    return np.ones((3, *GRID.shape)) * np.array(extinction)[:, None, None, None]


def met(camera: Camera, turn: Array) -> tuple[Array, Array, Array]:
    """Of each pixel's ray its length within the cube, the sine at which it meets that, and whether from above or below.

    ``(row, column)`` each, from the definition; the length is 0 where it misses.
    """
    rows, columns = camera.size
    right, up, ahead = camera.axes
    half = np.array(GRID.size_mm[::-1]) / 2
    across, above = camera.spread
    found = np.zeros((3, *camera.size))
    for row, column in np.ndindex(rows, columns):
        way = ahead + (2 * (column + 0.5) / columns - 1) * across * right + (1 - 2 * (row + 0.5) / rows) * above * up
        way = way @ turn / np.linalg.norm(way)
        ends = (np.array([-half, half]) - np.array(camera.eye) @ turn) / way
        first = ends.min(axis=0)
        face = int(np.argmax(first))
        stretch = ends.max(axis=0).min() - max(first[face], 0)
        found[:, row, column] = max(stretch, 0), abs(way[face]), face == 2
    return found[0], found[1], found[2]


def mirrored(light: Array, slant: Array, level: Array) -> Array:
    """What an eye sees of light that comes through a face which mirrors a little of the room."""
    part = (0.03 + 0.5 * (1 - slant) ** 4)[..., None]
    return light + part * (1.6 * np.array(tones.FAR) + 0.06 * level[..., None] - light)


@pytest.mark.parametrize(("rear", "eye", "angle_deg"), [(False, 40.0, 0.0), (False, 40.0, 35.0), (True, 170.0, 35.0)])
@pytest.mark.parametrize("table", STAGES)
def test_a_screen_seen_head_on_shows_its_picture(
    rear: bool, eye: float, angle_deg: float, table: dict[str, Any]
) -> None:
    size, pitch = 5, 2.0
    cube = cube_on(
        one(Screen("wall", (100, 3, 2), (28, 20), pitch, (-1, 0, 0), rear=rear), Lamp("sun", (1, 0.1, 0.05)), **table)
    )
    wanted = play(cube, [angle_deg])[0]
    rows, columns = wanted.shape[:2]
    field = np.degrees(2 * np.arctan(columns * pitch / 2 / abs(100 - eye)))
    camera = Camera((eye, 3, 2), (100, 3, 2), UP, field, (rows * size, columns * size))
    seen = room_picture(cube, angle_deg, camera)[size // 2 :: size, size // 2 :: size]
    assert np.ptp(wanted) > 0.3
    np.testing.assert_allclose(seen[1:-1, 1:-1], wanted[1:-1, 1:-1], atol=0.025)


@pytest.mark.parametrize("angle_deg", [0.0, 25.0])
def test_glass_is_clearer_than_it_is_and_shines_along_each_chord(angle_deg: float) -> None:
    """Before a white screen: (1 + grey / 0.8)^-0.8, colours likewise by 1.1, and embers by the length of the way."""
    grid = Grid((12, 20, 16), GRID.voxel_mm / 4)
    stage = replace(one(Screen("wall", (60, 0, 0), (90, 80), 10.0, (-1, 0, 0)), Lamp("sun", (0.1, 1, 0))), grid=grid)
    camera, dense = Camera((-50, 9, 14), (0, 0, 0), UP, 30.0, (60, 72)), np.array((0.02, 0.1, 0.05))
    clear, dim = (
        room_picture(cube_on(stage, np.ones((3, *grid.shape)) * each[:, None, None, None]), angle_deg, camera)
        for each in (0 * dense, dense)
    )
    length, slant, level = met(camera, standing(cube_on(stage), angle_deg).turn)
    white = np.ones((*length.shape, 3))
    glass = (length > 5) & (np.abs(clear - mirrored(white, slant, level)).max(axis=2) < 1e-5)
    assert np.sum(glass) > 700  # elsewhere are edges, the table, the lamp and its beam
    absorbed = length[..., None] * dense
    grey = absorbed.min(axis=2, keepdims=True)
    through = (1 + grey / 0.8) ** -0.8 * (1 + (absorbed - grey) / 1.1) ** -1.1
    voxels = length[..., None] / grid.voxel_mm
    pure = (dense.max() - dense.min()) * grid.voxel_mm
    embers = (1 - np.exp(-0.1 * voxels * np.log(1 + 6 * pure))) * (dense.max() - dense) / (dense.max() - dense.min())
    expected = mirrored(through + 0.5 * embers, slant, level)
    np.testing.assert_allclose(dim[glass], expected[glass], atol=2e-4)


def test_what_shines_behind_is_veiled_by_what_shines_before() -> None:
    """Half the block is red and half green: from either side the near half is the brighter one."""
    stage = one(Screen("wall", (0, 200, 0), (9, 9), 1.0, (0, -1, 0)), Lamp("sun", (0, 1, 0)))
    extinction = np.zeros((3, *GRID.shape))
    extinction[0, ..., 2:], extinction[1:, ..., :2] = 40, 40
    for eye, near in ((-90.0, 0), (90.0, 1)):
        seen = room_picture(cube_on(stage, extinction), 0.0, Camera((eye, 0, 1), (0, 0, 1), UP, 3.0, (9, 9)))[4, 4]
        assert seen[near] > 1.2 * seen[1 - near]


@pytest.mark.parametrize("near", [False, True])
def test_the_lamps_eye_sees_what_the_wall_shows(near: bool) -> None:
    """Through bare glass as its light goes, and without the glass the very picture; all else is dark."""
    lamp = Lamp("bulb", position_mm=(-60, 5, 25)) if near else Lamp("sun", (1, 0.2, -0.3))
    stage = one(Screen("wall", (40, 1, -12), (6, 4), 1.0, (-1, 0, 0)), lamp)
    cube = replace(cube_on(stage, homogeneous(0.02, 0.05, 0.1)), lamp_powers=np.array([[0.9, 0.8, 0.7]]))
    room, size = Room(cube), (90, 160)
    wanted, thin = (casting.play(cube, [20.0], picture_only=True, light=light)[0] for light in ("area", "thin"))
    camera = lamps_orbit(*room.eyes_lamp(20.0), size).camera(size)
    through, shown = room.seen(camera, 20.0, bare=1.0), room.from_lamp(camera, 20.0)
    canvas, screen = Canvas(camera), standing(cube, 20.0).screens[0]
    assert np.ptp(wanted[..., 2]) > 0.01
    for row, column in np.ndindex(screen.pixels):
        x, y, _ = canvas.seen(screen.corner + (column + 0.5) * screen.right + (row + 0.5) * screen.down)[0] / FINE
        np.testing.assert_allclose(through[int(y), int(x)], thin[row, column], rtol=0.08)  # the sun is near
        np.testing.assert_allclose(shown[int(y), int(x)], wanted[row, column], rtol=0.02)
    assert np.abs(shown[:5]).max() == np.abs(through[:4, :4]).max() == 0
    edges = [canvas.seen(corner)[0, :2] / FINE for corner in screen.corners]
    high, wide = np.ptp([edge[1] for edge in edges]), np.ptp([edge[0] for edge in edges])
    assert 0.6 < max(high / size[0], wide / size[1]) < 0.85


def test_what_stands_before_the_cube_is_not_dimmed() -> None:
    stage = one(Screen("card", (-20, 2, 1), (6, 6), 1.0, (-1, 0, 0)), Lamp("sun", (0, 1, 0)))
    camera = Camera((-60, 0, 0), (0, 0, 0), UP, 22.0, (48, 64))
    seen = room_picture(cube_on(stage, homogeneous(9, 9, 9)), 0.0, camera)
    centre = camera.size[1] / 2 / camera.spread[0] / 40  # pixels per mm, where the card stands
    rows, columns = (
        (np.arange(size) + 0.5 - size / 2) / centre - off for size, off in zip(camera.size, (-1, -2), strict=True)
    )
    card = (np.abs(rows)[:, None] < 2.4) & (np.abs(columns) < 2.4)
    assert np.sum(card) > 60
    np.testing.assert_allclose(seen[card], 1, rtol=1e-6)
    beside = met(camera, np.eye(3))[0] > 5
    assert np.median(seen[beside & ~((np.abs(rows)[:, None] < 4) & (np.abs(columns) < 4))]) < 0.2


def test_beams_are_seen_between_lamp_cube_and_wall_and_cover_no_picture() -> None:
    """Of a dark room with its lamps on; what changes away from the picture and the cube is the beam."""
    rig = turntable(GRID, [20.0, 100.0], elevation_deg=20.0, picture_shape=(3, 5))
    cube = Cube(homogeneous(0.05, 0.05, 0.05), GRID, rig, lamp_powers=np.tile((0.9, 0.2, 0.1), (2, 1)))
    camera = camera_for(cube, (90, 160))
    drawn, room = Room(cube), standing(cube, 20.0)
    lit, unlit = drawn.seen(camera, 20.0), drawn.seen(camera, 20.0, lit=False)
    np.testing.assert_allclose(unlit, drawn.seen(camera, 20.0, lit=False), atol=0)  # also where it is kept
    canvas = Canvas(camera)
    middle = room.screens[0].corners.mean(axis=0)
    for part in (0.25, 0.4, 0.85):
        place = middle + part * (room.lamps[0].place - middle) + 0.7 * room.screens[0].right  # beside the thin line
        column, row, _ = canvas.seen(place)[0] / FINE
        more = (lit - unlit)[int(row), int(column)]
        assert more[0] > 0.01
        assert more[0] > 1.5 * more[2]
    column, row, _ = canvas.seen(middle)[0] / FINE
    cast = play(cube, [20.0])[0]
    share = (lit - unlit)[int(row), int(column)] / (cast[1, 2] - tones.WALL)  # the table's glass lies before it
    assert np.ptp(share) < 0.01
    assert 0.7 < share[0] < 1.01


def test_a_third_of_a_picture_is_seen_from_behind() -> None:
    stage = one(Screen("wall", (40, 0, 0), (30, 30), 3.0, (-1, 0, 0)), Lamp("sun", (1, 0, 0)))
    seen = room_picture(cube_on(stage), 0.0, Camera((90, 0, 0), (40, 0, 0), UP, 25.0, (12, 14)))
    shown = play(cube_on(stage), [0.0])[0]
    np.testing.assert_allclose(seen.min(), 0.35 * shown.min() + 0.65 * min(tones.BACK), atol=0.02)
    np.testing.assert_allclose(seen[0, 0], 0.35 + 0.65 * np.array(tones.BACK), atol=0.012)  # past the cube


@pytest.mark.parametrize("channels", [1, 3])
def test_a_whole_turn_changes_nothing(channels: int) -> None:
    rig = turntable(GRID, [20.0, 100.0], elevation_deg=20.0, picture_shape=(3, 5))
    extinction = np.random.default_rng(1).uniform(0, 0.1, (channels, *GRID.shape)).astype(np.float32)
    cube = Cube(extinction, GRID, rig)
    room, camera = Room(cube), camera_for(cube, (27, 40))
    first, after, other = (room.seen(camera, angle_deg) for angle_deg in (33.0, 393.0, 70.0))
    np.testing.assert_allclose(first, after, atol=1e-3)
    assert np.abs(first - other).max() > 0.1
    assert first.shape == (27, 40, 3)
    assert first.dtype == np.float32


@pytest.mark.parametrize("table", STAGES)
@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0)])
def test_the_table_carries_what_turns_and_nothing_else(table: dict[str, Any], axis: tuple[float, float, float]) -> None:
    lamps = Lamp("fixed", position_mm=(-50, 10, 5)), Lamp("carried", position_mm=(-40, 20, 9), turns=True)
    screens = Screen("fixed", (60, 0, 9), (20, 16), 4.0), Screen("carried", (0, 55, 0), (12, 20), 4.0, turns=True)
    shots = tuple(Shot(screen.name, screen.name, ("fixed", "carried")) for screen in screens)
    cube = cube_on(Stage(GRID, lamps, screens, shots, axis=axis, **table))
    start, later = standing(cube, 0.0), standing(cube, 90.0)
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]) if axis[2] else np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    np.testing.assert_allclose(later.turn, quarter if table["cube_turns"] else np.eye(3), atol=1e-12)
    for place, moved in (
        *((start.screens[i].corners, later.screens[i].corners) for i in (0, 1)),
        *((start.lamps[i].place, later.lamps[i].place) for i in (0, 1)),
    ):
        carried = np.allclose(moved, place @ quarter.T)
        assert carried != np.allclose(moved, place)
    assert np.allclose(later.screens[0].corners, start.screens[0].corners)
    assert np.allclose(later.lamps[0].place, (-50, 10, 5))
    assert np.allclose(start.screens[0].corners.mean(axis=0), (60, 0, 9))


def test_a_turntable_s_screen_stands_still_where_the_beam_through_the_cube_s_middle_lands() -> None:
    cube = Cube(
        homogeneous(0.1, 0.1, 0.1), GRID, turntable(GRID, [20.0, 100.0], elevation_deg=30.0, picture_shape=(3, 5))
    )
    for angle_deg in (0.0, 20.0, 77.0):
        room = standing(cube, angle_deg)
        wide = GRID.size_mm[1]
        middle = room.screens[0].corners.mean(axis=0)
        np.testing.assert_allclose(middle, (1.5 * wide, 0, -1.5 * wide / np.sqrt(3)), atol=1e-9)
        np.testing.assert_allclose(room.screens[0].facing, (-1, 0, 0), atol=1e-12)
        np.testing.assert_allclose(np.cross(room.lamps[0].place, middle), 0, atol=1e-9)
        assert room.lamps[0].place[2] > 0


@pytest.mark.parametrize("table", STAGES)
@pytest.mark.parametrize("size", [(30, 50), (50, 30)])
def test_the_camera_sees_everything_at_every_angle(table: dict[str, Any], size: tuple[int, int]) -> None:
    screens = Screen("wall", (60, 0, 9), (20, 16), 4.0), Screen("floor", (9, 60, -30), (30, 20), 4.0, turns=True)
    shots = tuple(Shot(screen.name, screen.name, ("sun",)) for screen in screens)
    cube = cube_on(Stage(GRID, (Lamp("sun", (1, 0, -1)),), screens, shots, stops_deg=(0.0,), **table))
    camera = camera_for(cube, size)
    assert camera.eye[2] > 0
    for angle_deg in (0.0, 30.0, 180.0, 270.0):
        right, up, ahead = camera.axes @ (extent(GRID, standing(cube, angle_deg)) - camera.eye).T
        assert np.all(ahead > 0)
        assert np.all(np.abs(right / ahead) < camera.spread[0])
        assert np.all(np.abs(up / ahead) < camera.spread[1])


def test_the_camera_prefers_the_lit_side_past_the_cube() -> None:
    cube = cube_on(one(Screen("wall", (25, 0, -4), (16, 8), 4.0, (-1, 0, 0)), Lamp("sun", (1, 0, 0))))
    camera = camera_for(cube)
    eye, room = np.array(camera.eye), standing(cube, 0.0)
    assert eye[0] < 0
    half = np.array(GRID.size_mm[::-1]) / 2
    middle = room.screens[0].corners.mean(axis=0)
    line = middle + np.linspace(0, 1, 400)[:, None] * (eye - middle)
    assert not np.any(np.all(np.abs(line) < half, axis=1))


@pytest.mark.parametrize("first", [0.0, 70.0, 190.0])
def test_the_camera_faces_the_first_screen_of_a_lamp_that_circles(first: float) -> None:
    lamp, wall = (
        Lamp("sun", (1, 0, -0.2), turns=True),
        Screen("wall", (25, 0, -4), (16, 8), 4.0, (-1, 0, 0), turns=True),
    )
    stops = tuple(np.arange(first, first + 360, 60))
    shots = tuple(Shot(f"{stop}", "wall", ("sun",), i) for i, stop in enumerate(stops))
    cube = cube_on(Stage(GRID, (lamp,), (wall,), shots, stops, cube_turns=False))
    screen = standing(cube, float(np.unique(cube.angles_deg)[0])).screens[0]
    assert screen.facing @ (np.array(camera_for(cube).eye) - screen.corners.mean(axis=0)) > 0


def test_a_screen_that_reaches_behind_the_eye_is_seen_as_far_as_it_lies_ahead() -> None:
    stage = one(Screen("floor", (0, 0, -30), (400, 300), 10.0, (0, 0, 1)), Lamp("sun", (1, 0, 0)))
    seen = room_picture(
        cube_on(stage, homogeneous(0, 0, 0)), 0.0, Camera((-100, 0, 0), (0, 0, -20), UP, 50.0, (18, 24))
    )
    np.testing.assert_allclose(seen[-3:], 1, rtol=1e-6)


def test_fitting_leaves_the_margin_free_and_no_more() -> None:
    points = np.array(list(product((-3, 5), (-2, 9), (0, 4))), float)
    axes = Camera((9, 7, 5), (0, 0, 0), UP, 50.0, (30, 40)).axes
    eye = fitting(points, axes, (0.4, 0.3), 0.1)
    right, up, ahead = axes @ (points - eye).T
    ends = np.array([(right / ahead).min(), (right / ahead).max(), (up / ahead).min(), (up / ahead).max()])
    ends /= 0.8 * np.array([0.4, 0.4, 0.3, 0.3])
    assert np.all(np.abs(ends) < 1 + 1e-9)
    assert np.allclose(ends[:2], (-1, 1)) or np.allclose(ends[2:], (-1, 1))


def test_a_lamp_that_is_off_and_one_behind_the_eye_do_no_harm() -> None:
    lamps = Lamp("near", position_mm=(-30, 0, 0)), Lamp("later", position_mm=(0, -30, 0))
    screen = Screen("wall", (40, 0, 0), (30, 30), 5.0)
    stage = Stage(
        GRID, lamps, (screen,), (Shot("a", "wall", ("near",)), Shot("b", "wall", ("later",), 1)), stops_deg=(0.0, 90.0)
    )
    cube = cube_on(stage)
    assert [float(lamp.light.max()) > 0 for lamp in standing(cube, 10.0).lamps] == [True, False]
    assert [float(lamp.light.max()) > 0 for lamp in standing(cube, 80.0).lamps] == [False, True]
    for eye in ((-20.0, 1.0, 2.0), (-90.0, -70.0, 30.0), (0.0, 0.0, 1.0)):
        assert np.all(np.isfinite(room_picture(cube, 10.0, Camera(eye, (40, 0, 0), UP, 60.0, (9, 13)))))


def test_cameras_that_see_nothing_are_refused() -> None:
    for eye, up, field, size in (
        ((0, 0, 0), UP, 40.0, (9, 9)),
        ((0, 0, 5), UP, 40.0, (9, 9)),
        ((5, 0, 0), UP, 180.0, (9, 9)),
        ((5, 0, 0), UP, 40.0, (0, 9)),
    ):
        with pytest.raises(InputError, match="camera"):
            Camera(eye, (0, 0, 0), up, field, size)


def test_a_beam_leads_from_a_lamp_to_the_screens_that_it_lights() -> None:
    walls = (
        Screen("ahead", (60, 0, 0), (4, 4), 4.0, (-1, 0, 0)),
        Screen("aside", (0, 60, 0), (4, 4), 4.0, (0, -1, 0)),
    )
    lamps = Lamp("first", (1, 0, 0)), Lamp("second", (0, 1, 0))
    shots = Shot("a", "ahead", ("first",)), Shot("b", "aside", ("second",))
    cube = cube_on(Stage(GRID, lamps, walls, shots, cube_turns=False), homogeneous(0.02, 0.02, 0.02))
    camera = Camera((-1, -2, 300), (0, 0, 0), (0, 1, 0), 40.0, (90, 90))
    drawn, room = Room(cube), standing(cube, 0.0)
    more, canvas = drawn.seen(camera, 0.0) - drawn.seen(camera, 0.0, lit=False), Canvas(camera)
    found = np.zeros((2, 2))
    for i, j in product(range(2), repeat=2):
        middle = 0.7 * room.lamps[i].place + 0.3 * room.screens[j].corners.mean(axis=0)
        column, row, _ = canvas.seen(middle)[0] / FINE
        found[i, j] = more[int(row), int(column)].max()
    assert found.diagonal().min() > 1.4 * max(found[0, 1], found[1, 0])  # what pictures throw on the floor
