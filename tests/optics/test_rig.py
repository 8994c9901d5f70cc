"""How shadows make a picture: light, fading, samples of discs and pixels, sums, and what is between the stops."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lightcube.backward.problem import pose
from lightcube.backward.units import split
from lightcube.backward.wishes import held
from lightcube.errors import InputError
from lightcube.forward.turning import moment
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.law import fade, falling_light
from lightcube.optics.light import Light
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.optics.tables import Lamps, Screens
from lightcube.optics.views import spread_angles
from lightcube.pictures.resampling import halved
from lightcube.pictures.targets import Targets
from tests.helpers import plain
from tests.helpers.areas import divided
from tests.helpers.thin import cast, play, player, thin_recipe

GRID = Grid((4, 5, 6), 0.7)
#: Parallel and from a point; coloured; fading slowly, at once, and never; on a wall and a floor of other sizes.
ROOM = Stage(
    GRID,
    (
        Lamp("sun", direction=(2.0, 0.3, -1.2), colour=(1.0, 0.5, 0.0), reach_mm=6.0, falloff_mm=8.0),
        Lamp("bulb", position_mm=(-9.0, 2.0, 7.0), full_at_mm=12.0, falloff_mm=math.inf, reach_mm=3.0),
        Lamp("moon", direction=(1.0, -0.4, -1.1), reach_mm=10.0, falloff_mm=0.0),
    ),
    (
        Screen("wall", (9.0, 0.0, -5.4), (3.5, 2.8), 0.7, reach_mm=9.0, falloff_mm=5.0),
        Screen("floor", (7.0, 1.0, -9.0), (2.1, 3.5), 0.7, normal=(0.0, 0.0, 1.0), cosine=True, rear=True),
    ),
    (
        Shot("a", "wall", ("sun", "bulb")),
        Shot("b", "floor", ("bulb",)),
        Shot("c", "wall", ("moon", "bulb", "sun"), 1),
        Shot("d", "floor", ("sun", "moon"), 1),
    ),
    (10.0, 130.0),
    (0.1, -0.2, 1.0),
)


def extinction(shape: tuple[int, int, int] = GRID.shape, seed: int = 4) -> np.ndarray:
    return np.random.default_rng(seed).gamma(0.5, 0.4, (3, *shape)).astype(np.float32)


def powers_of(rig: Rig) -> np.ndarray:
    return np.random.default_rng(5).uniform(0.5, 3.0, (len(rig.pairs), 3))


def made(stage: Stage, **more: Any) -> Cube:
    """A random cube on a stage, under random powers."""
    rig = stage.rig()
    return Cube(extinction(stage.grid.shape), stage.grid, rig, powers_of(rig), **more)


def pictures(cube: Cube, rig: Rig, powers: np.ndarray | None = None) -> np.ndarray:
    return np.stack(list(cast(cube, rig, cube.powers if powers is None else powers)))


def light_by_hand(rig: Rig, view: int, row: int, column: int) -> tuple[float, float]:
    """Light g and strength a of one pixel, from the words of `falling_light` and of `Rig`."""
    views = rig.views
    pixel, way, first, _ = plain.beam_of_pixel(views, view, row, column)
    light, shadow = 1.0, 1.0
    if rig.fading.cosine[view]:
        normal = np.cross(views.column_steps_mm[view], views.row_steps_mm[view])
        light *= abs(float(way @ normal)) / math.sqrt(float(normal @ normal))
    if views.lamps[view, 3] == 1 and rig.fading.full_at_mm[view] < math.inf:
        light *= rig.fading.full_at_mm[view] ** 2 / first**2
    behind = float(way @ pixel)
    for reach, falloff in zip(rig.fading.reach_mm[view], rig.fading.falloff_mm[view], strict=True):
        if behind > reach:
            shadow *= math.exp(-(behind - reach) / falloff) if falloff > 0 else 0.0
    return light, shadow


def by_hand(cube: Cube, rig: Rig, powers: np.ndarray) -> np.ndarray:
    """The sum over views of P share g (1 - a (1 - T)), pixel by pixel; black beside the screen."""
    through = np.exp(-plain.absorbance_pictures(cube.grid, rig.views, cube.extinction))
    shown = np.zeros((len(rig), *rig.picture_shape, 3))
    pairs = [tuple(pair) for pair in rig.pairs]
    for view, row, column in np.ndindex(through.shape[:3]):
        picture = rig.sums.picture[view]
        if row < rig.stops.window[picture, 0] and column < rig.stops.window[picture, 1]:
            g, a = light_by_hand(rig, view, row, column)
            power = powers[pairs.index((picture, rig.sums.lamp[view]))] * rig.sums.share[view]
            shown[picture, row, column] += power * g * (1 - a * (1 - through[view, row, column]))
    return shown


def test_the_light_of_every_pixel_is_what_the_words_say() -> None:
    rig = ROOM.rig()
    light, shadow = falling_light(rig)
    assert len(np.unique(np.round(light, 5))) > 30
    assert np.any(shadow == 0)
    assert np.any((shadow > 0.05) & (shadow < 0.95))
    assert np.any(shadow == 1)
    for pixel in np.ndindex(light.shape):
        assert (light[pixel], shadow[pixel]) == pytest.approx(light_by_hand(rig, *pixel), rel=1e-6)


def test_a_lamp_that_stands_on_a_pixel_shines_on_it() -> None:
    lamp = Lamp("lamp", position_mm=(9.0, 0.0, -5.4), full_at_mm=10.0, reach_mm=1.0)
    rig = replace(ROOM, lamps=(lamp,), shots=(Shot("1", "floor", ("lamp",)),)).rig()
    on_it = replace(rig, views=replace(rig.views, origins_mm=rig.views.lamps[:, :3]))
    for numbers in (*falling_light(on_it), *falling_light(rig)):
        assert np.all(np.isfinite(numbers))


@pytest.mark.parametrize("samples", [{}, {"lamp": 2, "pixel": 2}])
def test_what_is_cast_is_the_plain_sum(samples: dict[str, Any]) -> None:
    lamps = tuple(replace(lamp, size_deg=4.0) for lamp in ROOM.lamps)
    rig = divided(replace(ROOM, lamps=lamps).rig(), **samples)
    cube = Cube(extinction(), GRID, rig, powers_of(rig))
    expected = by_hand(cube, rig, cube.powers)
    np.testing.assert_allclose(pictures(cube, rig), expected, rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(play(cube), expected, rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("powers_of_lamps", ["per-picture", "shared"])
@pytest.mark.parametrize("hold_deg", [0.0, 3.0])
def test_solvers_see_the_plain_sum(powers_of_lamps: Any, hold_deg: float) -> None:
    """And so does whoever asks a problem for what is shown; at the stops themselves where pictures are held."""
    cube = made(ROOM)
    wanted = np.full((4, 5, 5, 3), 0.5, np.float32)
    recipe = thin_recipe(powers=powers_of_lamps, hold_deg=hold_deg, dtype="float64", light=Light.thin())
    problem = pose(Targets(wanted, cube.rig), GRID, recipe)
    assert problem.lighting.mixture is not None
    powers = cube.powers if powers_of_lamps == "per-picture" else powers_of(cube.rig)[:3]
    each = powers if powers_of_lamps == "per-picture" else powers[cube.rig.pairs[:, 1]]
    shown = problem.shown(problem.unknowns(cube.extinction.astype(np.float64)), powers)
    np.testing.assert_allclose(shown, pictures(cube, cube.rig, each), rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("level", [True, False])
def test_the_parts_of_a_problem_are_the_problem(level: bool, count: int) -> None:
    """Colours, or slices where two level lamps shine on a wall whose rows are the cube's."""
    lamps = tuple(Lamp(name, (2.0, y, 0.0 if level else -1.2), reach_mm=8.0) for name, y in (("a", 0.3), ("b", -0.4)))
    wall = Screen("wall", (9.0, 0.0, 0.0), (3.5, 2.8), 0.7, normal=(-1.0, 0.0, 0.0), falloff_mm=3.0, reach_mm=7.0)
    shots = (Shot("1", "wall", ("a", "b")), Shot("2", "wall", ("b",), 1))
    cube = made(Stage(GRID, lamps, (wall,), shots, (10.0, 50.0)))
    wanted = np.random.default_rng(3).random((2, 4, 5, 3)).astype(np.float32)
    targets = Targets(wanted, cube.rig)
    whole = pose(targets, GRID, thin_recipe())
    assert whole.matrix.level == level
    shown = whole.shown(whole.unknowns(cube.extinction), cube.powers)
    for part in split(GRID.shape, 3, count, level=level):
        own = pose(targets, GRID, thin_recipe(), part)
        mine = own.shown(own.unknowns(cube.extinction[part.colours, part.slices]), cube.powers[:, part.colours])
        np.testing.assert_allclose(mine, shown[:, own.rows, :, part.colours], rtol=1e-6)


@given(st.floats(-50, 200), st.floats(0, 100), st.floats(0.01, 50), st.floats(0.1, 3))
def test_a_shadow_is_whole_up_to_its_reach_and_then_fades(
    distance: float, reach: float, falloff: float, lengths: float
) -> None:
    whole, faded, near = fade(np.array([min(distance, reach), reach + lengths * falloff, reach + 1e-9]), reach, falloff)
    assert whole == 1
    assert faded == pytest.approx(math.exp(-lengths))
    assert near == pytest.approx(1, abs=1e-6)
    assert fade(np.array([reach, reach + lengths]), reach, 0.0).tolist() == [1, 0]
    assert fade(np.array([reach + lengths]), reach, math.inf) == 1
    assert fade(np.array([distance]), math.inf, falloff) == 1


def lit_by(size_deg: float, distance: float, *, point: bool = False) -> Stage:
    """A lamp level with a flat cube, and a wall of very fine pixels so far behind the cube's middle."""
    lamp = Lamp("lamp", None if point else (1.0, 0.0, 0.0), (-40.0, 0.0, 0.0) if point else None, size_deg=size_deg)
    wall = Screen("wall", (distance, 0.0, 0.0), (2.0, 0.1), 0.05)
    return Stage(Grid((2, 6, 1), 1.0), (lamp,), (wall,), (Shot("1", "wall", ("lamp",)),))


def edge(stage: Stage, samples: int) -> np.ndarray:
    """Light along the wall behind a cube whose one half is opaque."""
    half = np.zeros((3, 2, 6, 1), np.float32)
    half[:, :, :3] = 50.0
    rig = divided(stage.rig(), lamp=samples)
    return pictures(Cube(half, stage.grid, rig), rig)[0, 0, :, 0]


@pytest.mark.parametrize("point", [False, True])
def test_a_disc_blurs_an_edge_by_its_angle_times_the_distance(point: bool) -> None:
    """Of a line of light across the disc, the shadow of an edge is as wide as the disc is seen from the edge."""
    size, distance = 5.0, 8.0
    width = 2 * math.tan(math.radians(size / 2)) * distance
    stage = lit_by(size, distance, point=point)
    profile = edge(stage, 200)
    partly = np.sum((profile > 1e-3) & (profile < 1 - 1e-3)) * 0.05
    assert partly == pytest.approx(width, abs=0.15)
    assert np.all(np.diff(profile) <= 1e-6)  # y rises to the left
    assert abs(profile[len(profile) // 2] - 0.5) < 0.06
    for sharp in (edge(lit_by(0.0, distance, point=point), 200), edge(stage, 1)):
        assert np.sum((sharp > 1e-3) & (sharp < 1 - 1e-3)) <= 1


@pytest.mark.parametrize("place", [{"direction": (1.0, -2.0, -0.5)}, {"position_mm": (3.0, 1.0, 40.0)}])
@pytest.mark.parametrize("samples", [2, 3, 5, 16])
def test_samples_of_a_disc_lie_in_it_and_their_mean_is_the_lamp(place: Any, samples: int) -> None:
    lamp = Lamp("lamp", colour=(1.0, 0.5, 0.1), size_deg=8.0, **place)
    screen = Screen("wall", (5.0, -10.0, -9.0), (2.0, 2.0), 1.0)
    shots = (Shot("1", "wall", ("lamp", "sun")), Shot("2", "wall", ("lamp",), 1))
    rig = Stage(GRID, (lamp, ROOM.lamps[0]), (screen,), shots, (0.0, 50.0)).rig()
    several = divided(rig, lamp=samples)
    assert several.sums.lamp.tolist() == [0] * samples + [1] + [0] * samples
    assert several.sums.picture.tolist() == [0] * (samples + 1) + [1] * samples
    assert np.all(several.sums.disc_deg == 0)
    for view, first in ((0, 0), (2, samples + 1)):
        points, middle = several.views.lamps[first : first + samples], rig.views.lamps[view]
        np.testing.assert_allclose(points.mean(axis=0), middle, atol=1e-9)
        aside = (points - middle)[:, :3]
        radius = math.tan(math.radians(4.0)) * np.linalg.norm(middle[:3])
        assert np.all(np.linalg.norm(aside, axis=1) <= radius)
        assert len(np.unique(np.round(aside, 6), axis=0)) == samples
        np.testing.assert_allclose(aside @ middle[:3], 0, atol=1e-9)  # it faces the cube's middle
        np.testing.assert_allclose(several.sums.share[first : first + samples].sum(axis=0), rig.sums.share[view])


def test_many_samples_fill_the_disc_evenly() -> None:
    """As many in the inner disc of half the area as outside it, and in each half."""
    rig = lit_by(10.0, 5.0).rig()
    points = divided(rig, lamp=400).views.lamps[:, 1:3]
    radius = math.tan(math.radians(5.0))
    assert np.mean(np.hypot(*points.T) < radius / math.sqrt(2)) == pytest.approx(0.5, abs=0.02)
    for axis in (0, 1):
        assert np.mean(points[:, axis] > 0) == pytest.approx(0.5, abs=0.02)


def test_samples_of_a_pixel_tend_to_its_mean_and_change_no_sum() -> None:
    cube = made(replace(ROOM, shots=ROOM.shots[:1]))
    assert cube.rig.stops.window.tolist() == [[4, 5]]
    fine = replace(ROOM, shots=ROOM.shots[:1], screens=(replace(ROOM.screens[0], pitch_mm=0.7 / 8),))
    rows, columns = cube.rig.picture_shape
    area = pictures(cube, fine.rig()).reshape(rows, 8, columns, 8, 3).mean(axis=(1, 3))
    off = []
    for samples in (1, 2, 4):
        rig = divided(cube.rig, pixel=samples)
        assert len(rig.views) == 2 * samples**2
        np.testing.assert_allclose(np.add.reduceat(rig.sums.share, [0, samples**2]), cube.rig.sums.share, rtol=1e-12)
        off.append(float(np.sqrt(np.mean((pictures(cube, rig)[0] - area) ** 2))))
    assert off[0] > 1.5 * off[1] > 3 * off[2]
    assert off[2] < 0.02


def test_some_pictures_of_many_keep_their_views() -> None:
    cube = made(ROOM)
    targets = Targets(np.random.default_rng(2).random((4, 5, 5, 3), np.float32), cube.rig)
    some = targets.take([2, 0, 2])
    assert some.rig.sums.picture.tolist() == [0, 0, 0, 1, 1, 2, 2, 2]
    assert some.rig.starts.tolist() == [0, 3, 5, 8]
    assert some.angles_deg.tolist() == [130, 10, 130]
    np.testing.assert_array_equal(some.pictures, targets.pictures[[2, 0, 2]])
    np.testing.assert_array_equal(some.rig.views.lamps, cube.rig.views.lamps[[3, 4, 5, 0, 1, 3, 4, 5]])
    everything = pictures(cube, cube.rig)
    for picture, (row, pair) in enumerate(zip((2, 0, 2), (3, 0, 3), strict=True)):
        own = some.take([picture]).rig
        one = pictures(cube, own, cube.powers[pair : pair + len(own.pairs)])
        np.testing.assert_array_equal(one[0], everything[row])


@pytest.mark.parametrize(
    ("part", "changes", "message"),
    [
        ("sums", {"share": np.ones(8)}, "share of a rig has shape"),
        ("sums", {"lamp": np.zeros(7, int)}, "lamp of a rig has shape"),
        ("fading", {"reach_mm": np.ones(8)}, "reach_mm of a rig has shape"),
        ("stops", {"window": np.ones((4, 3), int)}, "window of a rig has shape"),
        ("turning", {"axis": np.ones(2)}, "axis of a rig has shape"),
        ("lamps", {"least": np.ones(2)}, "least of a rig has shape"),
        ("sums", {"picture": [0, 0, 1, 1, 2, 3, 3, 2]}, "in the order of their pictures"),
        ("sums", {"picture": [0, 0, 1, 1, 1, 3, 3, 3]}, "none of which is left out"),
        ("sums", {"picture": [0, 0, 1, 1, 1, 2, 2, 2]}, "4 stops for 3 pictures: give one each"),
        ("sums", {"picture": [1, 1, 1, 1, 1, 2, 2, 3]}, "none of which is left out"),
        ("sums", {"share": -np.ones((8, 3))}, "shares must be at least 0"),
        ("lamps", {"least": np.zeros(3)}, "above 0"),
        ("lamps", {"most": np.full(3, 1e-9)}, "least before the largest"),
        ("screens", {"black": np.ones(2)}, "black must be a display value"),
        ("sums", {"lamp": np.full(8, 3)}, "numbers of the names"),
        ("stops", {"screen": np.full(4, -1)}, "numbers of the names"),
    ],
)
def test_a_rig_that_does_not_fit_itself_is_refused(part: str, changes: dict[str, Any], message: str) -> None:
    rig = ROOM.rig()
    with pytest.raises(InputError, match=message):
        replace(rig, **{part: replace(getattr(rig, part), **changes)})


def test_what_does_not_fit_a_rig_is_refused() -> None:
    rig = ROOM.rig()
    with pytest.raises(InputError, match="not all of 7 views"):
        replace(rig, views=rig.views.take(slice(7)))
    with pytest.raises(InputError, match="pictures of shape"):
        Targets(np.ones((8, 5, 5, 3), np.float32), rig)
    with pytest.raises(InputError, match="a rig of 3 colours does not fit 1"):
        Targets(np.ones((4, 5, 5, 1), np.float32), rig)
    with pytest.raises(InputError, match="does not fit"):
        Cube(extinction()[:1], GRID, rig)
    with pytest.raises(InputError, match="lamp powers must be"):
        Cube(extinction(), GRID, rig, np.ones((4, 3)))


@pytest.mark.parametrize("elevation_deg", [0.0, 30.0])
@pytest.mark.parametrize("angles_deg", [[20.0, 75.0, 130.0], [10.0, 190.0, 250.0]])
def test_a_turntable_is_a_stage_with_one_lamp_and_a_screen_behind(
    elevation_deg: float, angles_deg: list[float]
) -> None:
    """The same room said in two ways casts the same at its stops and between, half a turn on, and off."""
    tilt = math.radians(elevation_deg)
    light = math.cos(tilt), 0.0, -math.sin(tilt)
    high, wide = GRID.shape[0] * 0.7, 5 * 0.7
    wall = Screen("screen", (9 * light[0], 0.0, 9 * light[2]), (wide, high), 0.7, normal=(-1.0, 0.0, 0.0))
    shots = tuple(Shot(str(stop + 1), "screen", ("lamp",), stop) for stop in range(len(angles_deg)))
    stage = Stage(GRID, (Lamp("lamp", light),), (wall,), shots, tuple(angles_deg))
    one = turntable(GRID, angles_deg, elevation_deg=elevation_deg, picture_shape=(4, 5))
    powers = powers_of(one)
    turned, staged = (Cube(extinction(), GRID, rig, powers, hold_deg=2.0) for rig in (one, stage.rig()))
    period = 180 if elevation_deg == 0 and angles_deg[1] != 190 else 360
    assert turned.rig.period_deg == staged.rig.period_deg == period
    assert turned.rig.widest_hold_deg == pytest.approx(staged.rig.widest_hold_deg)
    np.testing.assert_allclose(play(turned), play(staged), rtol=1e-4, atol=1e-6)
    between = [angle_deg + off for angle_deg in angles_deg for off in (0.0, 1.0, 7.5, 180.0, 200.0, -90.0)]
    np.testing.assert_allclose(play(turned, between), play(staged, between), rtol=1e-4, atol=1e-6)
    targets = [Targets(play(turned), rig, transfer="linear") for rig in (one, stage.rig())]
    problems = [pose(each, GRID, thin_recipe(hold_deg=2.0)) for each in targets]
    for name in ("light", "weights"):
        np.testing.assert_allclose(getattr(problems[0], name), getattr(problems[1], name), rtol=1e-6)
    np.testing.assert_array_equal(problems[0].lighting.lamp, problems[1].lighting.lamp)
    x = problems[0].unknowns(extinction())
    across = [each.matrix.forward(each.unknowns(extinction())) for each in problems]
    assert x.shape == problems[1].unknowns(extinction()).shape
    np.testing.assert_allclose(across[0], across[1], rtol=1e-4, atol=1e-6)


def test_half_a_turn_mirrors_where_light_is_level_and_screens_go_along() -> None:
    rig = turntable(GRID, [20.0, 75.0], picture_shape=(4, 5)).shifted(np.array([[1, 0], [-1, 0]]))
    assert rig.mirrors
    assert not turntable(GRID, [20.0, 75.0], elevation_deg=10.0).mirrors
    assert not ROOM.rig().mirrors
    cube = Cube(extinction(), GRID, rig, powers_of(rig))
    np.testing.assert_allclose(play(cube, [200.0, 255.0])[:, :, ::-1], play(cube), rtol=1e-4, atol=1e-6)
    both = rig.both_sides
    assert both.stops.angle_deg.tolist() == [20, 75, 200, 255]
    assert both.both_sides is both


def test_the_whole_shadow_is_shown_where_the_screen_has_no_edges() -> None:
    rig = turntable(GRID, [20.0, 75.0], elevation_deg=30.0, picture_shape=(4, 5)).shifted(np.array([[1, 2], [-1, 0]]))
    whole = rig.whole(GRID)
    np.testing.assert_allclose(whole.views.origins_mm, 0, atol=1e-12)
    assert whole.picture_shape == turntable(GRID, [0.0], elevation_deg=30.0).picture_shape
    assert ROOM.rig().whole(GRID).picture_shape == ROOM.rig().picture_shape


def test_lamps_and_screens_say_their_bounds() -> None:
    rig = turntable(GRID, [0.0], power=2.0, black=0.1)
    assert rig.lamps.are_fixed
    assert (rig.lamps.most[0], rig.screens.black[0]) == (2, 0.1)
    assert not Lamps(("a", "b"), np.array([1.0, 1e-4]), np.array([1.0, 16.0])).are_fixed
    cannot_be: list[dict[str, Any]] = [
        {"power": 0.0},
        {"power": math.nan},
        {"power": 1e9},
        {"power_max": 0.5},
        {"black": 1.0},
    ]
    for wrong in cannot_be:
        with pytest.raises(InputError):
            turntable(GRID, [0.0], **wrong)
    with pytest.raises(InputError, match="black"):
        Screens(("wall",), np.array([0.0]), np.array([False]))


TURNED = replace(
    ROOM,
    shots=tuple(
        Shot(f"{name}{stop}", name, lamps, stop)
        for stop in (0, 1, 2)
        for name, lamps in (("floor", ("moon",)), ("wall", ("sun", "bulb") if stop != 1 else ("sun",)))
    ),
    stops_deg=(20.0, 100.0, 250.0),
)


def test_at_the_stops_a_stage_shows_the_pictures_of_the_cube() -> None:
    """One for each screen, in the order of the screens; and player and play show the same."""
    cube = made(TURNED)
    own, order = play(cube), [1, 0, 3, 2, 5, 4]
    np.testing.assert_allclose(play(cube, TURNED.stops_deg), own[order], rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(player(cube)([20.0 + 360, 100.0 - 720]), own[order[:4]], rtol=1e-4, atol=1e-6)
    np.testing.assert_array_equal(player(cube)(None), own)


def test_between_two_stops_each_lamp_goes_by_equal_factors() -> None:
    cube = made(TURNED)
    rig, powers = moment(cube, [60.0, 40.0, 315.0])
    assert rig.stops.screen.tolist() == [0, 1, 0, 1, 0, 1]
    assert rig.stops.angle_deg.tolist() == [60, 60, 40, 40, 315, 315]
    # pairs of the cube by stop: floor with moon, wall with sun and bulb (with sun alone at the second)
    moon, sun, bulb = cube.powers[[0, 3, 5]], cube.powers[[1, 4, 6]], cube.powers[[2, 7]]
    found = {(int(picture), int(lamp)): power for (picture, lamp), power in zip(rig.pairs, powers, strict=True)}
    np.testing.assert_allclose(found[1, 2], np.sqrt(moon[0] * moon[1]))
    np.testing.assert_allclose(found[3, 2], moon[0] ** 0.75 * moon[1] ** 0.25)
    np.testing.assert_allclose(found[5, 2], np.sqrt(moon[2] * moon[0]))
    np.testing.assert_allclose(found[2, 0], sun[0] ** 0.75 * sun[1] ** 0.25)
    np.testing.assert_allclose(found[4, 1], np.sqrt(bulb[0] * bulb[1]))
    np.testing.assert_allclose(found[2, 1], bulb[0] ** (210 / 230) * bulb[1] ** (20 / 230))  # it is out at 100


def test_a_screen_without_a_picture_at_the_nearest_stop_is_dark() -> None:
    whole = made(TURNED)
    kept = whole.rig.take([1, 2])  # the wall at 20 degrees, the floor at 100
    powers = whole.powers[np.isin(whole.rig.pairs[:, 0], [1, 2])]
    cube = replace(whole, rig=kept, lamp_powers=powers, names=())
    own = play(cube)
    for angle_deg, lit in ((20.0, own[0]), (100.0, own[1])):
        shown = play(cube, [angle_deg])
        dark = [not np.any(picture) for picture in shown]
        assert sorted(dark) == [False, True]
        np.testing.assert_allclose(shown[dark.index(False)], lit, rtol=1e-4, atol=1e-6)


def test_over_a_hold_the_lamps_stay_as_they_are() -> None:
    cube = made(TURNED, hold_deg=8.0)
    for stop, at in ((20.0, 0), (100.0, 3), (250.0, 5)):
        for off in (-8.0, -3.0, 0.0, 8.0):
            rig, powers = moment(cube, [stop + off])
            pair = rig.pairs.tolist().index([1, 2])
            np.testing.assert_allclose(powers[pair], cube.powers[at])
    rig, powers = moment(cube, [60.0])
    np.testing.assert_allclose(powers[rig.pairs.tolist().index([1, 2])], np.sqrt(cube.powers[0] * cube.powers[3]))


def test_held_pictures_are_asked_for_on_either_side_under_the_same_lamps() -> None:
    """The views at stop and hold are those of the same stage at stops that far aside."""
    cube = made(TURNED)
    several = held(cube.rig, thin_recipe(hold_deg=4.0), GRID)
    angles_deg = len(several) // len(cube.rig)
    assert angles_deg == 3
    problem = pose(Targets(play(cube), cube.rig), GRID, thin_recipe(hold_deg=4.0))
    for index, off in enumerate((-4.0, 0.0, 4.0)):
        aside = replace(TURNED, stops_deg=tuple(stop + off for stop in TURNED.stops_deg)).rig().views
        mine = np.flatnonzero(np.isin(several.sums.picture, np.arange(index, len(several), angles_deg)))
        np.testing.assert_allclose(several.views.take(mine).lamps, aside.lamps, atol=1e-12)
        np.testing.assert_allclose(several.views.take(mine).origins_mm, aside.origins_mm, atol=1e-12)
        np.testing.assert_array_equal(problem.lighting.lamp[mine], cube.rig.pair)
        np.testing.assert_allclose(several.stops.angle_deg[index::angles_deg], cube.rig.stops.angle_deg + off)


def test_a_hold_that_reaches_the_next_stop_is_refused() -> None:
    """The nearest stop at which the same screen shows a picture counts: here 80 degrees on."""
    rig = TURNED.rig()
    rig.held(40.0, 5.0)
    with pytest.raises(InputError, match=r"a hold of 41 degrees is wider .* at most 40"):
        rig.held(41.0, 5.0)
    with pytest.raises(InputError, match="at least 0"):
        rig.held(-1.0, 5.0)


def test_halved_pictures_keep_their_rig() -> None:
    """The same room with pixels twice as large: lamps, middles of pictures, and light that falls on them."""
    wall, shots = replace(ROOM.screens[0], size_mm=(4.2, 2.8)), ROOM.shots[:1]
    cube = made(replace(ROOM, screens=(wall,), shots=shots))
    targets, grid = halved(Targets(play(cube), cube.rig), GRID)
    same = replace(ROOM, grid=grid, screens=(replace(wall, pitch_mm=1.4),), shots=shots).rig()
    for one, other in zip(falling_light(targets.rig), falling_light(same), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-6)


@given(st.floats(0.01, 20), st.integers(4, 200), st.sampled_from([0.0, 35.0]))
def test_held_pictures_are_dense_enough_and_keep_the_stop_in_the_middle(
    hold_deg: float, n: int, elevation_deg: float
) -> None:
    grid = Grid((4, n, 4))
    rig = turntable(grid, [20.0, 70.0, 150.0], elevation_deg=elevation_deg, picture_shape=(2, 2))
    angles_deg = held(rig, thin_recipe(hold_deg=hold_deg), grid).stops.angle_deg.reshape(3, -1)
    assert np.allclose(angles_deg[:, angles_deg.shape[1] // 2], rig.stops.angle_deg)
    assert np.allclose(angles_deg[:, -1] - angles_deg[:, 0], 2 * hold_deg)
    assert np.max(np.diff(angles_deg, axis=1)) <= 0.5 * 64 / n + 1e-6
    assert angles_deg.shape[1] == 1 + 2 * np.ceil(hold_deg / (0.5 * 64 / n) - 1e-9)


def test_a_turntable_that_has_turned_on_is_one_at_other_angles() -> None:
    rig = turntable(GRID, [10.0, 80.0], elevation_deg=20.0).turned([20.0, -10.0])
    expected = turntable(GRID, [30.0, 70.0], elevation_deg=20.0)
    np.testing.assert_allclose(rig.stops.angle_deg, expected.stops.angle_deg)
    for name in ("lamps", "origins_mm", "column_steps_mm", "row_steps_mm"):
        np.testing.assert_allclose(getattr(rig.views, name), getattr(expected.views, name), atol=1e-12)


@pytest.mark.parametrize("count", [3, 7, 11])
def test_the_widest_hold_that_is_named_is_taken(count: int) -> None:
    rig = turntable(GRID, spread_angles(count))
    with pytest.raises(InputError, match="use at most") as refused:
        rig.held(89.0, 1.0)
    most = float(str(refused.value).rsplit(" ", 1)[1])
    assert len(rig.held(most, 1.0)) > count


def test_a_hold_that_meets_another_stops_mirror_image_is_refused() -> None:
    with pytest.raises(InputError, match=r"use at most 0\.5"):
        turntable(GRID, [0.0, 90.0, 180.0, 271.0]).held(40.0, 1.0)
