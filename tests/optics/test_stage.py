"""Stages: where lamps and screens stand, in what the cube sees of them and in the pictures that are cast."""

import math
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from tests.helpers import plain
from tests.helpers.thin import cast, play

GRID = Grid((4, 5, 6), 0.7)
SUN = Lamp("sun", direction=(2.0, 0.0, -1.2))
WALL = Screen("wall", centre_mm=(9.0, 0.0, -5.4), size_mm=(4.9, 2.8), pitch_mm=0.7, normal=(-1.0, 0.0, 0.0))
BULB = Lamp("bulb", position_mm=(-9.0, 2.0, 7.0))
STOPS = (0.0, 25.0, 90.0, 211.0)


def on_stage(*stops: float, lamp: Lamp = SUN, screen: Screen = WALL, grid: Grid = GRID, **more: Any) -> Stage:
    """One lamp, one screen, a picture at every stop."""
    shots = tuple(Shot(str(stop), screen.name, (lamp.name,), stop) for stop in range(len(stops)))
    return Stage(grid, (lamp,), (screen,), shots, stops, **more)


def extinction(shape: tuple[int, int, int] = GRID.shape) -> np.ndarray:
    return np.random.default_rng(4).gamma(0.5, 0.4, (3, *shape)).astype(np.float32)


def shown(stage: Stage, volume: np.ndarray | None = None) -> np.ndarray:
    """What a cube casts on the stage, every lamp at power 1."""
    rig = stage.rig()
    cube = Cube(extinction(stage.grid.shape) if volume is None else volume, stage.grid, rig)
    return np.stack(list(cast(cube, rig, cube.powers)))


def assert_close(one: np.ndarray, other: np.ndarray) -> None:
    assert one.shape == other.shape
    assert one.std() > 0.05
    np.testing.assert_allclose(one, other, atol=2e-5)


def turntable_pictures(angles_deg: tuple[float, ...]) -> np.ndarray:
    """What a turntable shows of the same cube, lamp and window."""
    elevation_deg = math.degrees(math.atan2(1.2, 2.0))
    rig = turntable(GRID, angles_deg, elevation_deg=elevation_deg, picture_shape=(4, 7))
    return play(Cube(extinction(), GRID, rig))


def test_a_raised_lamp_and_a_vertical_wall_are_a_turntable() -> None:
    rig = on_stage(*STOPS).rig()
    table = turntable(GRID, STOPS, elevation_deg=math.degrees(math.atan2(1.2, 2.0)), picture_shape=(4, 7))
    np.testing.assert_allclose(rig.views.lamps / np.hypot(2.0, 1.2), table.views.lamps, atol=1e-12)
    np.testing.assert_allclose(rig.views.column_steps_mm, table.views.column_steps_mm, atol=1e-12)
    np.testing.assert_allclose(rig.views.row_steps_mm, table.views.row_steps_mm, atol=1e-12)
    np.testing.assert_allclose(rig.stops.angle_deg, STOPS)
    assert rig.is_thin
    assert_close(shown(on_stage(*STOPS)), turntable_pictures(STOPS))


def test_a_fixed_cube_that_lamp_and_screen_go_round_is_a_turntable() -> None:
    carried: dict[str, Any] = {"lamp": replace(SUN, turns=True), "screen": replace(WALL, turns=True)}
    back = on_stage(*(-stop for stop in STOPS), cube_turns=False, **carried)
    assert_close(shown(back), turntable_pictures(STOPS))


@pytest.mark.parametrize("lamp", [SUN, BULB])
def test_what_turns_with_the_cube_shows_the_same_at_every_stop(lamp: Lamp) -> None:
    for turns in (True, False):
        with_it = replace(lamp, turns=turns), replace(WALL, turns=turns)
        pictures = shown(on_stage(*STOPS, lamp=with_it[0], screen=with_it[1], cube_turns=turns, axis=(1, 2, -0.5)))
        for picture in pictures[1:]:
            assert_close(pictures[0], picture)


def quarter_turned(volume: np.ndarray) -> np.ndarray:
    """The cube after a quarter turn counter-clockwise: what was at ``(y, -x)`` is at ``(x, y)``."""
    return volume.transpose(0, 1, 3, 2)[..., ::-1]


def third_turned(volume: np.ndarray) -> np.ndarray:
    """The cube after a third of a turn about ``(1, 1, 1)``: what was at ``(y, z, x)`` is at ``(x, y, z)``."""
    return volume.transpose(0, 2, 3, 1)


@pytest.mark.parametrize("lamp", [SUN, BULB])
@pytest.mark.parametrize(
    ("turned", "angle_deg", "axis"),
    [(quarter_turned, 90.0, (0.0, 0.0, 1.0)), (third_turned, 120.0, (2.0, 2.0, 2.0))],
)
def test_turning_the_table_is_turning_the_voxels(lamp: Lamp, turned: Any, angle_deg: float, axis: Any) -> None:
    """The cube is turned by hand, voxel by voxel, in a room that stands still."""
    still = turned(extinction())
    grid = Grid(still.shape[1:], GRID.voxel_mm)
    screen = replace(WALL, size_mm=(7.7, 5.6))
    by_hand = shown(on_stage(0.0, lamp=lamp, screen=screen, grid=grid), still)
    assert_close(shown(on_stage(angle_deg, lamp=lamp, screen=screen, axis=axis)), by_hand)


@pytest.mark.parametrize("lamp", [SUN, BULB])
def test_a_lamp_that_the_table_carries_goes_round_a_cube_that_it_does_not(lamp: Lamp) -> None:
    """And the screen, which it does not carry, stays: the same as a lamp that was put elsewhere by hand."""
    there: dict[str, Any] = {
        "direction": (0.0, 2.0, -1.2) if lamp.direction else None,
        "position_mm": (-2.0, -9.0, 7.0) if lamp.position_mm else None,
    }
    screen = Screen("wall", (0.8, 7.6, -5.2), (5.6, 4.2), 0.7)
    carried = on_stage(90.0, lamp=replace(lamp, turns=True), screen=screen, cube_turns=False)
    assert_close(shown(carried), shown(on_stage(0.0, lamp=replace(lamp, **there), screen=screen)))


def test_a_second_screen_at_a_right_angle_sees_a_quarter_turn_on_what_the_first_saw() -> None:
    lamps = (SUN, Lamp("moon", direction=(0.0, 2.0, -1.2)))
    screens = (WALL, replace(WALL, name="door", centre_mm=(0.0, 9.0, -5.4), normal=(0.0, -1.0, 0.0)))
    shots = [Shot(f"{name}{stop}", name, (lamp,), stop) for stop in (0, 1) for name, lamp in PAIRS]
    wall, door, wall_on, door_on = shown(Stage(GRID, lamps, screens, tuple(shots), (20.0, 110.0)))
    assert_close(door_on, wall)
    for other in (door, wall_on):
        assert np.max(np.abs(other - wall)) > 0.1


PAIRS = (("wall", "sun"), ("door", "moon"))


def test_rear_projection_mirrors_the_columns() -> None:
    front, rear = (shown(on_stage(*STOPS, lamp=BULB, screen=replace(WALL, rear=rear))) for rear in (False, True))
    assert_close(rear, front[:, :, ::-1])


def test_up_rotates_the_picture() -> None:
    """The normal is -x: for who looks along x with z up, y points to the left."""
    wide, high = WALL.size_mm
    upright = shown(on_stage(*STOPS, lamp=BULB))
    turned = {
        1: replace(WALL, up=(0.3, -1.0, 0.0), size_mm=(high, wide)),
        2: replace(WALL, up=(0.0, 0.0, -2.0)),
        3: replace(WALL, up=(0.0, 1.0, 0.0), size_mm=(high, wide)),
    }
    for quarters, screen in turned.items():
        assert_close(shown(on_stage(*STOPS, lamp=BULB, screen=screen)), np.rot90(upright, quarters, (1, 2)))


@pytest.mark.parametrize("lamp", [SUN, BULB])
@pytest.mark.parametrize(
    ("centre_mm", "normal", "up", "right"),
    [
        ((9.0, 0.0, -5.0), None, (0.0, 0.0, 1.0), (0.0, -1.0, 0.0)),
        ((8.0, 1.0, -9.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0)),  # a floor
        ((8.0, 1.0, -6.0), (-3.0, 0.0, 4.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0)),
        ((7.0, -3.0, -6.0), (-1.0, 1.0, 0.0), (0.0, 0.0, 1.0), (-1.0, -1.0, 0.0)),
    ],
)
def test_pixels_lie_where_the_screen_does(lamp: Lamp, centre_mm: Any, normal: Any, up: Any, right: Any) -> None:
    """Pixel by pixel in plain Python; `right` is that of somebody who looks at the lit side."""
    screen = Screen("wall", centre_mm, (3.5, 2.8), 0.7, normal=normal)
    out = np.array(normal or [-each for each in centre_mm])
    above = np.array(up) - (np.array(up) @ out) / (out @ out) * out
    volume, expected = extinction(), np.zeros((4, 5, 3))
    for row, column in np.ndindex(4, 5):
        along, across = 0.7 * (1.5 - row), 0.7 * (column - 2)
        aside = np.array(right) if normal else np.cross(above, out)
        pixel = np.array(centre_mm) + along * above / np.linalg.norm(above) + across * aside / np.linalg.norm(aside)
        way = np.array(lamp.direction) if lamp.direction else pixel - np.array(lamp.position_mm)
        length = float(np.linalg.norm(way))
        ends = (-math.inf, math.inf) if lamp.direction else (-length, 0.0)
        lengths = plain.lengths_of_beam(GRID, pixel, way / length, *ends)
        expected[row, column] = np.exp(-np.einsum("zyx,czyx->c", lengths, volume))
    np.testing.assert_allclose(shown(on_stage(0.0, lamp=lamp, screen=screen))[0], expected, atol=2e-5)


def test_smaller_screens_keep_the_upper_left_of_their_pictures() -> None:
    small = Screen("small", (8.0, 2.0, -6.0), (2.1, 3.5), 0.7, up=(0.0, 0.4, 1.0))
    alone = shown(on_stage(30.0, lamp=BULB, screen=small))[0]
    shots = (Shot("1", "wall", ("bulb",)), Shot("2", "small", ("bulb",)))
    stage = Stage(GRID, (BULB,), (WALL, small), shots, (30.0,))
    rig = stage.rig()
    assert rig.picture_shape == (5, 7)
    assert rig.stops.window.tolist() == [[4, 7], [5, 3]]
    assert rig.inside.sum(axis=(1, 2)).tolist() == [28, 15]
    both = shown(stage)
    assert_close(both[1, :5, :3], alone)
    assert_close(both[0, :4], shown(on_stage(30.0, lamp=BULB))[0])
    assert np.all(both[0, 4:] == 0)
    assert np.all(both[1, :, 3:] == 0)


MIXED = replace(
    on_stage(0.0, 40.0, axis=(0.2, -0.3, 1.0)),
    lamps=(SUN, replace(BULB, turns=True)),
    screens=(WALL, replace(WALL, name="door", turns=True)),
    shots=(Shot("a", "wall", ("sun", "bulb")), Shot("b", "door", ("bulb",), 1), Shot("c", "door", ("sun",))),
)


@pytest.mark.parametrize("cube_turns", [True, False])
def test_turning_on_by_two_angles_is_turning_on_by_their_sum(cube_turns: bool) -> None:
    rig = replace(MIXED, cube_turns=cube_turns).rig()
    every_other = np.array([10.0, 200.0, 77.0])
    for parts, whole in (((0.0, 360.0, -720.0), True), ((33.0, -47.0), False), ((every_other, 5.5), False)):
        each = rig
        for part in parts:
            each = each.turned(part)
        at_once = rig.turned(np.sum(np.broadcast_arrays(*parts), axis=0))
        np.testing.assert_allclose(each.stops.angle_deg, at_once.stops.angle_deg)
        for name in ("lamps", "origins_mm", "column_steps_mm", "row_steps_mm"):
            np.testing.assert_allclose(getattr(each.views, name), getattr(at_once.views, name), atol=1e-12)
            if whole:
                np.testing.assert_allclose(getattr(each.views, name), getattr(rig.views, name), atol=1e-12)


def test_turning_on_from_a_stop_is_standing_at_another() -> None:
    """What moves keeps its distance from the axis and from the cube, also about a slanted one."""
    first, second = (replace(MIXED, stops_deg=(start, 40.0 + start)).rig() for start in (0.0, 71.0))
    moved, axis = first.turned(71.0), first.turning.axis
    for name in ("lamps", "origins_mm", "column_steps_mm", "row_steps_mm"):
        np.testing.assert_allclose(getattr(moved.views, name), getattr(second.views, name), atol=1e-12)
        before, after = getattr(first.views, name)[:, :3], getattr(moved.views, name)[:, :3]
        np.testing.assert_allclose(np.linalg.norm(after, axis=1), np.linalg.norm(before, axis=1))
        np.testing.assert_allclose(after @ axis, before @ axis, atol=1e-12)


def test_what_is_said_of_lamps_and_screens_is_said_of_every_view() -> None:
    lamps = (
        Lamp("sun", (1, 0, 0), colour=(1, 0.5, 0), power=3.0, reach_mm=4, falloff_mm=5, size_deg=0.5),
        Lamp("bulb", None, (-9, 0, 0), power_max=7.0, full_at_mm=80, turns=True),
    )
    screens = (replace(WALL, reach_mm=6, falloff_mm=7), replace(WALL, name="door", cosine=True, turns=True))
    shots = (Shot("a", "door", ("bulb", "sun"), 1), Shot("b", "wall", ("bulb",)), Shot("c", "wall", ("sun",), 1))
    rig = Stage(GRID, lamps, screens, shots, (10.0, 50.0)).rig()
    assert rig.sums.picture.tolist() == [0, 0, 1, 2]
    assert rig.sums.lamp.tolist() == [1, 0, 1, 0]
    assert rig.sums.share.tolist() == [[1, 1, 1], [1, 0.5, 0], [1, 1, 1], [1, 0.5, 0]]
    inf = math.inf
    assert rig.fading.reach_mm.tolist() == [[inf, inf], [4, inf], [inf, 6], [4, 6]]
    assert rig.fading.falloff_mm.tolist() == [[0, 0], [5, 0], [0, 7], [5, 7]]
    assert rig.fading.full_at_mm.tolist() == [80, inf, 80, inf]
    assert rig.sums.disc_deg.tolist() == [0, 0.5, 0, 0.5]
    assert rig.fading.cosine.tolist() == [True, True, False, False]
    assert rig.turning.turns.tolist() == [[False, False], [True, False], [False, True], [True, True]]
    assert rig.stops.angle_deg.tolist() == [50, 10, 50]
    assert rig.stops.screen.tolist() == [1, 0, 0]
    assert rig.lamps.least.tolist() == [3, 1e-4]
    assert rig.lamps.most.tolist() == [3, 7]
    assert (rig.lamps.names, rig.screens.names) == (("sun", "bulb"), ("wall", "door"))
    assert not rig.is_thin
    assert rig.pairs.tolist() == [[0, 0], [0, 1], [1, 1], [2, 0]]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"lamps": ()}, "no lamp on this stage"),
        ({"screens": ()}, "no screen on this stage"),
        ({"shots": ()}, "no picture is wanted"),
        ({"lamps": (SUN, SUN)}, "two lamps called 'sun'"),
        ({"screens": (WALL, WALL)}, "two screens called 'wall'"),
        ({"lamps": tuple(replace(SUN, name=str(i)) for i in range(257))}, "at most 256 lamps.*'256'"),
        ({"screens": tuple(replace(WALL, name=str(i)) for i in range(33))}, "at most 32 screens"),
        ({"shots": (Shot("a", "floor", ("sun",)),)}, "'a': there is no screen 'floor': use one of wall"),
        ({"shots": (Shot("a", "wall", ("moon",)),)}, "'a': there is no lamp 'moon': use one of sun"),
        ({"shots": (Shot("a", "wall", ()),)}, "'a': no lamp is lit"),
        ({"shots": (Shot("a", "wall", ("sun", "sun")),)}, "'a' names a lamp twice"),
        ({"shots": (Shot("a", "wall", ("sun",), 2),)}, "'a': there is no stop 3: the turntable has 2"),
        ({"shots": (Shot("a", "wall", ("sun",), -1),)}, "'a': there is no stop 0"),
        ({"stops_deg": ()}, "the turntable has 0"),
        ({"stops_deg": (0.0, math.inf)}, "stops must be finite"),
        ({"stops_deg": (0.0, 1e308)}, "stops must be finite"),
        ({"axis": (0.0, 0.0, 0.0)}, "turntable: axis"),
    ],
)
def test_what_cannot_be_a_stage_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as refused:
        replace(on_stage(0.0, 90.0), **changes)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("lamp", "message"),
    [
        ({"position_mm": (1, 2, 3)}, "give either a direction .* or a position_mm"),
        ({"direction": None}, "give either a direction .* or a position_mm"),
        ({"direction": (0, 0, 0)}, "direction must be three finite numbers"),
        ({"direction": (0, 1)}, "takes 3 numbers as direction"),
        ({"direction": None, "position_mm": (0, math.inf, 0)}, "position_mm must be three finite"),
        ({"colour": (0, 0, 0)}, "colour must be"),
        ({"colour": (1, -1, 0)}, "colour must be"),
        ({"power": 0.0}, "power must lie between"),
        ({"power": -1.0}, "power must lie between"),
        ({"power_max": 1e7}, "power_max must lie"),
        ({"size_deg": 90.0}, "size_deg"),
        ({"full_at_mm": 5.0}, "full_at_mm is for point lamps"),
        ({"direction": None, "position_mm": (1, 2, 3), "full_at_mm": 0.0}, "full_at_mm must be above 0"),
        ({"reach_mm": -1.0}, "reach_mm must be at least 0"),
        ({"falloff_mm": math.nan}, "takes a number as falloff_mm, not nan"),
    ],
)
def test_what_cannot_be_a_lamp_is_refused(lamp: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=f"lamp 'sun':? {message}"):
        on_stage(0.0, lamp=replace(SUN, **lamp))


@pytest.mark.parametrize(
    ("screen", "message"),
    [
        ({"centre_mm": (0, 0, 0), "normal": None}, "centre_mm must be three finite numbers that are not all 0"),
        ({"centre_mm": (0, math.inf, 0)}, "centre_mm must be three finite numbers"),
        ({"normal": (0, 0, 0)}, "normal must be"),
        ({"up": (-2, 0, 0)}, "up must not point straight out"),
        ({"up": (0, 0, 0)}, "up must be three"),
        ({"size_mm": (0, 1)}, "size_mm must be above 0"),
        ({"pitch_mm": -0.7}, "pitch_mm must lie between"),
        ({"pitch_mm": 1e-3}, "more than 2048 pixels"),
        ({"reach_mm": -1.0}, "reach_mm"),
        ({"falloff_mm": -1.0}, "falloff_mm"),
    ],
)
def test_what_cannot_be_a_screen_is_refused(screen: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=f"screen 'wall': {message}"):
        on_stage(0.0, screen=replace(WALL, **screen))


any_float = st.floats() | st.sampled_from([0.0, 1.0, -1.0, 1e-9, 1e300, -1e300, 1e-300, 5e-324, math.inf, math.nan])
vector = st.tuples(any_float, any_float, any_float)


@settings(max_examples=200)
@given(st.data())
def test_any_numbers_make_a_stage_or_one_sentence(data: st.DataObject) -> None:
    """A few numbers of a good stage become any: what is left is finite, and lamps and screens have a direction."""
    numbers: dict[str, Any] = {"stop": 0.0, "axis": (0.0, 0.0, 1.0)}
    things: list[Any] = [data.draw(st.sampled_from([SUN, BULB])), WALL]
    changes: list[dict[str, Any]] = []
    for thing in things:
        names = [
            each.name
            for each in fields(thing)
            if each.name not in ("position_mm", "centre_mm") and each.name.endswith(("mm", "deg", "power", "max"))
        ]
        vectors = [
            name for name in ("direction", "position_mm", "colour", "centre_mm", "normal", "up") if hasattr(thing, name)
        ]
        chosen = data.draw(st.sets(st.sampled_from(names + vectors), max_size=2))
        values: dict[str, Any] = {name: any_float if name in names else vector for name in chosen}
        values |= {"size_mm": st.tuples(any_float, any_float)} if "size_mm" in chosen else {}
        changes.append({name: data.draw(value) for name, value in values.items()})
    for name, value in (("stop", any_float), ("axis", vector)):
        if data.draw(st.booleans()):
            numbers[name] = data.draw(value)
    try:
        lamp, screen = (replace(thing, **changed) for thing, changed in zip(things, changes, strict=True))
        stage = on_stage(numbers["stop"], lamp=lamp, screen=screen, axis=numbers["axis"])
        rig = stage.rig()
        rig.turned(33.0)
    except InputError as error:
        assert "\n" not in str(error)  # noqa: PT017 - any other exception fails the test
    else:
        assert np.all(np.any(np.cross(rig.views.column_steps_mm, rig.views.row_steps_mm) != 0, axis=1))
        assert np.all(np.any(rig.views.lamps[:, :3] != 0, axis=1))
