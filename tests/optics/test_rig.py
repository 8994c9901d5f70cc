"""How shadows make a picture: light, fading, samples of discs and pixels, sums, and what is between the stops."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lightcube.backward.problem import held_views, pose
from lightcube.backward.units import split
from lightcube.errors import InputError
from lightcube.forward.casting import cast, play, player
from lightcube.forward.turning import exposures_at
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.law import fading, falling_light
from lightcube.optics.rig import Lighting, held_lighting, sampled
from lightcube.optics.stage import Lamp, Screen, Shot, Stage, exposures
from lightcube.optics.views import Views
from lightcube.pictures.frames import Frames
from lightcube.pictures.resampling import halved
from tests.helpers import plain

GRID = Grid((4, 5, 6), 0.7)
#: Parallel and from a point; coloured; fading slowly, at once, and never; on a wall and a floor of other sizes.
ROOM = Stage(
    GRID,
    (
        Lamp("sun", direction=(2.0, 0.3, -1.2), colour=(1.0, 0.5, 0.0), reach_mm=6.0, falloff_mm=8.0),
        Lamp("bulb", position=(-9.0, 2.0, 7.0), full_at_mm=12.0, falloff_mm=math.inf, reach_mm=3.0),
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


def powers_of(lighting: Lighting) -> np.ndarray:
    return np.random.default_rng(5).uniform(0.5, 3.0, (len(lighting.pairs), 3))


def made(stage: Stage, **more: Any) -> Cube:
    """A random cube on a stage, under random powers."""
    views, lighting = exposures(stage)
    return Cube(extinction(stage.grid.shape), stage.grid, views, powers_of(lighting), lighting=lighting, **more)


def pictures(cube: Cube, views: Views, lighting: Lighting, powers: np.ndarray | None = None) -> np.ndarray:
    return np.stack(list(cast(cube, views, cube.powers if powers is None else powers, lighting)))


def light_by_hand(views: Views, lighting: Lighting, view: int, row: int, column: int) -> tuple[float, float]:
    """Light g and strength a of one pixel, from the words of `falling_light` and of `Lighting`."""
    pixel, way, first, _ = plain.beam_of_pixel(views, view, row, column)
    light, shadow = 1.0, 1.0
    if lighting.cosine[view]:
        normal = np.cross(views.column_steps[view], views.row_steps[view])
        light *= abs(float(way @ normal)) / math.sqrt(float(normal @ normal))
    if views.lamps[view, 3] == 1 and lighting.full_at_mm[view] < math.inf:
        light *= lighting.full_at_mm[view] ** 2 / first**2
    behind = float(way @ pixel)
    for reach, falloff in zip(lighting.reach_mm[view], lighting.falloff_mm[view], strict=True):
        if behind > reach:
            shadow *= math.exp(-(behind - reach) / falloff) if falloff > 0 else 0.0
    return light, shadow


def by_hand(cube: Cube, views: Views, lighting: Lighting, powers: np.ndarray) -> np.ndarray:
    """The sum over views of P share g (1 - a (1 - T)), pixel by pixel; black beside the screen."""
    through = np.exp(-plain.absorbance_pictures(cube.grid, views, cube.extinction))
    shown = np.zeros((lighting.pictures, *views.picture_shape, 3))
    pairs = [tuple(pair) for pair in lighting.pairs]
    for view, row, column in np.ndindex(through.shape[:3]):
        picture = lighting.picture[view]
        if row < lighting.window[picture, 0] and column < lighting.window[picture, 1]:
            g, a = light_by_hand(views, lighting, view, row, column)
            power = powers[pairs.index((picture, lighting.lamp[view]))] * lighting.share[view]
            shown[picture, row, column] += power * g * (1 - a * (1 - through[view, row, column]))
    return shown


def test_the_light_of_every_pixel_is_what_the_words_say() -> None:
    views, lighting = exposures(ROOM)
    light, shadow = falling_light(views, lighting)
    assert len(np.unique(np.round(light, 5))) > 30
    assert np.any(shadow == 0)
    assert np.any((shadow > 0.05) & (shadow < 0.95))
    assert np.any(shadow == 1)
    for pixel in np.ndindex(light.shape):
        assert (light[pixel], shadow[pixel]) == pytest.approx(light_by_hand(views, lighting, *pixel), rel=1e-6)


def test_a_lamp_that_stands_on_a_pixel_shines_on_it() -> None:
    lamp = Lamp("lamp", position=(9.0, 0.0, -5.4), full_at_mm=10.0, reach_mm=1.0)
    views, lighting = exposures(replace(ROOM, lamps=(lamp,), shots=(Shot("1", "floor", ("lamp",)),)))
    on_it = replace(views, origins=views.lamps[:, :3])
    for numbers in (*falling_light(on_it, lighting), *falling_light(views, lighting)):
        assert np.all(np.isfinite(numbers))


@pytest.mark.parametrize("samples", [{}, {"lamp_samples": 2, "pixel_samples": 2}])
def test_what_is_cast_is_the_plain_sum(samples: dict[str, Any]) -> None:
    lamps = tuple(replace(lamp, size_deg=4.0) for lamp in ROOM.lamps)
    views, lighting = sampled(*exposures(replace(ROOM, lamps=lamps)), **samples)
    cube = Cube(extinction(), GRID, views, powers_of(lighting), lighting=lighting)
    expected = by_hand(cube, views, lighting, cube.powers)
    np.testing.assert_allclose(pictures(cube, views, lighting), expected, rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(play(cube), expected, rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("lamp", ["per-view", "global"])
@pytest.mark.parametrize("hold", [0.0, 3.0])
def test_solvers_see_the_plain_sum(lamp: Any, hold: float) -> None:
    """And so does whoever asks a problem for what is shown; at the stops themselves where pictures are held."""
    cube = made(ROOM)
    assert cube.lighting is not None
    wanted = np.full((4, 5, 5, 3), 0.5, np.float32)
    problem = pose(Frames(wanted, cube.views, lighting=cube.lighting), GRID, hold, lamp, dtype=np.float64)
    assert problem.sums.mixture is not None
    powers = cube.powers if lamp == "per-view" else powers_of(cube.lighting)[:3]
    each = powers if lamp == "per-view" else powers[cube.lighting.pairs[:, 1]]
    absorbed = problem.matrix.forward(problem.unknowns(cube.extinction.astype(np.float64)))
    inside = cube.lighting.inside((5, 5))[..., None]
    shown = problem.shown(absorbed, powers) * inside
    np.testing.assert_allclose(shown, pictures(cube, cube.views, cube.lighting, each), rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("level", [True, False])
def test_the_parts_of_a_problem_are_the_problem(level: bool, count: int) -> None:
    """Colours, or slices where two level lamps shine on a wall whose rows are the cube's."""
    lamps = tuple(Lamp(name, (2.0, y, 0.0 if level else -1.2), reach_mm=8.0) for name, y in (("a", 0.3), ("b", -0.4)))
    wall = Screen("wall", (9.0, 0.0, 0.0), (3.5, 2.8), 0.7, normal=(-1.0, 0.0, 0.0), falloff_mm=3.0, reach_mm=7.0)
    shots = (Shot("1", "wall", ("a", "b")), Shot("2", "wall", ("b",), 1))
    cube = made(Stage(GRID, lamps, (wall,), shots, (10.0, 50.0)))
    wanted = np.random.default_rng(3).random((2, 4, 5, 3)).astype(np.float32)
    frames = Frames(wanted, cube.views, lighting=cube.lighting)
    whole = pose(frames, GRID, 0.0, "per-view")
    assert whole.matrix.level == level
    shown = whole.shown(whole.matrix.forward(whole.unknowns(cube.extinction)), cube.powers)
    for part in split(GRID.shape, 3, count, level=level):
        own = pose(frames, GRID, 0.0, "per-view", part=part)
        absorbed = own.matrix.forward(own.unknowns(cube.extinction[part.colours, part.slices]))
        mine = own.shown(absorbed, cube.powers[:, part.colours])
        np.testing.assert_allclose(mine, shown[:, own.rows, :, part.colours], rtol=1e-6)


@given(st.floats(-50, 200), st.floats(0, 100), st.floats(0.01, 50), st.floats(0.1, 3))
def test_a_shadow_is_whole_up_to_its_reach_and_then_fades(
    distance: float, reach: float, falloff: float, lengths: float
) -> None:
    whole, faded, near = fading(
        np.array([min(distance, reach), reach + lengths * falloff, reach + 1e-9]), reach, falloff
    )
    assert whole == 1
    assert faded == pytest.approx(math.exp(-lengths))
    assert near == pytest.approx(1, abs=1e-6)
    assert fading(np.array([reach, reach + lengths]), reach, 0.0).tolist() == [1, 0]
    assert fading(np.array([reach + lengths]), reach, math.inf) == 1
    assert fading(np.array([distance]), math.inf, falloff) == 1


def lit_by(size_deg: float, distance: float, *, point: bool = False) -> Stage:
    """A lamp level with a flat cube, and a wall of very fine pixels so far behind the cube's middle."""
    lamp = Lamp("lamp", None if point else (1.0, 0.0, 0.0), (-40.0, 0.0, 0.0) if point else None, size_deg=size_deg)
    wall = Screen("wall", (distance, 0.0, 0.0), (2.0, 0.1), 0.05)
    return Stage(Grid((2, 6, 1), 1.0), (lamp,), (wall,), (Shot("1", "wall", ("lamp",)),))


def edge(stage: Stage, samples: int) -> np.ndarray:
    """Light along the wall behind a cube whose one half is opaque."""
    half = np.zeros((3, 2, 6, 1), np.float32)
    half[:, :, :3] = 50.0
    views, lighting = sampled(*exposures(stage), lamp_samples=samples)
    return pictures(Cube(half, stage.grid, views, lighting=lighting), views, lighting)[0, 0, :, 0]


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


@pytest.mark.parametrize("place", [{"direction": (1.0, -2.0, -0.5)}, {"position": (3.0, 1.0, 40.0)}])
@pytest.mark.parametrize("samples", [2, 3, 5, 16])
def test_samples_of_a_disc_lie_in_it_and_their_mean_is_the_lamp(place: Any, samples: int) -> None:
    lamp = Lamp("lamp", colour=(1.0, 0.5, 0.1), size_deg=8.0, **place)
    screen = Screen("wall", (5.0, -10.0, -9.0), (2.0, 2.0), 1.0)
    shots = (Shot("1", "wall", ("lamp", "sun")), Shot("2", "wall", ("lamp",), 1))
    views, lighting = exposures(Stage(GRID, (lamp, ROOM.lamps[0]), (screen,), shots, (0.0, 50.0)))
    several, mixed = sampled(views, lighting, lamp_samples=samples)
    assert mixed.lamp.tolist() == [0] * samples + [1] + [0] * samples
    assert mixed.picture.tolist() == [0] * (samples + 1) + [1] * samples
    assert np.all(mixed.disc_deg == 0)
    for view, first in ((0, 0), (2, samples + 1)):
        points, middle = several.lamps[first : first + samples], views.lamps[view]
        np.testing.assert_allclose(points.mean(axis=0), middle, atol=1e-9)
        aside = (points - middle)[:, :3]
        radius = math.tan(math.radians(4.0)) * np.linalg.norm(middle[:3])
        assert np.all(np.linalg.norm(aside, axis=1) <= radius)
        assert len(np.unique(np.round(aside, 6), axis=0)) == samples
        np.testing.assert_allclose(aside @ middle[:3], 0, atol=1e-9)  # it faces the cube's middle
        np.testing.assert_allclose(mixed.share[first : first + samples].sum(axis=0), lighting.share[view])


def test_many_samples_fill_the_disc_evenly() -> None:
    """As many in the inner disc of half the area as outside it, and in each half."""
    views, lighting = exposures(lit_by(10.0, 5.0))
    points = sampled(views, lighting, lamp_samples=400)[0].lamps[:, 1:3]
    radius = math.tan(math.radians(5.0))
    assert np.mean(np.hypot(*points.T) < radius / math.sqrt(2)) == pytest.approx(0.5, abs=0.02)
    for axis in (0, 1):
        assert np.mean(points[:, axis] > 0) == pytest.approx(0.5, abs=0.02)


def test_samples_of_a_pixel_tend_to_its_mean_and_change_no_sum() -> None:
    cube = made(replace(ROOM, shots=ROOM.shots[:1]))
    assert cube.lighting is not None
    assert cube.lighting.window.tolist() == [[4, 5]]
    fine = replace(ROOM, shots=ROOM.shots[:1], screens=(replace(ROOM.screens[0], pitch_mm=0.7 / 8),))
    fine_views, fine_lighting = exposures(fine)
    rows, columns = cube.views.picture_shape
    area = pictures(cube, fine_views, fine_lighting).reshape(rows, 8, columns, 8, 3).mean(axis=(1, 3))
    off = []
    for samples in (1, 2, 4):
        views, lighting = sampled(cube.views, cube.lighting, pixel_samples=samples)
        assert len(views) == 2 * samples**2
        np.testing.assert_allclose(np.add.reduceat(lighting.share, [0, samples**2]), cube.lighting.share, rtol=1e-12)
        off.append(float(np.sqrt(np.mean((pictures(cube, views, lighting)[0] - area) ** 2))))
    assert off[0] > 1.5 * off[1] > 3 * off[2]
    assert off[2] < 0.02


@pytest.mark.parametrize("samples", [{"lamp_samples": 0}, {"lamp_samples": 1025}, {"pixel_samples": 0}])
def test_samples_that_cannot_be_are_refused(samples: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="1 to 1024 samples"):
        sampled(*exposures(ROOM), **samples)


def test_some_pictures_of_many_keep_their_views() -> None:
    cube = made(ROOM)
    lighting = cube.lighting
    assert lighting is not None
    frames = Frames(np.random.default_rng(2).random((4, 5, 5, 3), np.float32), cube.views, lighting=lighting)
    some = frames.take([2, 0, 2])
    assert some.lighting is not None
    assert some.lighting.picture.tolist() == [0, 0, 0, 1, 1, 2, 2, 2]
    assert some.lighting.starts.tolist() == [0, 3, 5, 8]
    assert some.angles.tolist() == [130, 10, 130]
    np.testing.assert_array_equal(some.pictures, frames.pictures[[2, 0, 2]])
    np.testing.assert_array_equal(some.views.lamps, cube.views.lamps[[3, 4, 5, 0, 1, 3, 4, 5]])
    everything = pictures(cube, cube.views, lighting)
    for picture, (row, pair) in enumerate(zip((2, 0, 2), (3, 0, 3), strict=True)):
        own = some.take([picture])
        assert own.lighting is not None
        count = len(own.lighting.pairs)
        one = pictures(cube, own.views, own.lighting, cube.powers[pair : pair + count])
        np.testing.assert_array_equal(one[0], everything[row])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"share": np.ones(8)}, "share of a lighting has shape"),
        ({"lamp": np.zeros(7)}, "lamp of a lighting has shape"),
        ({"reach_mm": np.ones(8)}, "reach_mm of a lighting has shape"),
        ({"window": np.ones((4, 3))}, "window of a lighting has shape"),
        ({"axis": np.ones(2)}, "axis of a lighting has shape"),
        ({"least": np.ones(2)}, "least of a lighting has shape"),
        ({"picture": [0, 0, 1, 1, 2, 3, 3, 2]}, "in the order of their pictures"),
        ({"picture": [0, 0, 1, 1, 1, 3, 3, 3]}, "none of which is left out"),
        ({"picture": [0, 0, 1, 1, 1, 2, 2, 2]}, "none of which is left out"),
        ({"picture": [1, 1, 1, 1, 1, 2, 2, 3]}, "none of which is left out"),
        ({"share": -np.ones((8, 3))}, "shares must be at least 0"),
        ({"least": np.zeros(3)}, "powers above 0"),
        ({"most": np.full(3, 1e-9)}, "least before most"),
        ({"lamp": np.full(8, 3)}, "numbers of the names"),
        ({"screen": np.full(4, -1)}, "numbers of the names"),
    ],
)
def test_a_lighting_that_does_not_fit_itself_is_refused(changes: dict[str, Any], message: str) -> None:
    lighting = exposures(ROOM)[1]
    with pytest.raises(InputError, match=message):
        replace(lighting, **changes)


def test_a_lighting_that_does_not_fit_its_pictures_is_refused() -> None:
    views, lighting = exposures(ROOM)
    with pytest.raises(InputError, match="a lighting of 8 views does not fit 7"):
        Frames(np.ones((4, 5, 5, 3), np.float32), views.take(slice(7)), lighting=lighting)
    with pytest.raises(InputError, match="pictures of shape"):
        Frames(np.ones((8, 5, 5, 3), np.float32), views, lighting=lighting)
    with pytest.raises(InputError, match="a lighting of 3 colours does not fit 1"):
        Frames(np.ones((4, 5, 5, 1), np.float32), views, lighting=lighting)
    with pytest.raises(InputError, match="does not fit"):
        Cube(extinction()[:1], GRID, views, lighting=lighting)
    with pytest.raises(InputError, match="lamp powers must be"):
        Cube(extinction(), GRID, views, np.ones((4, 3)), lighting=lighting)


TURNED = replace(
    ROOM,
    shots=tuple(
        Shot(f"{name}{stop}", name, lamps, stop)
        for stop in (0, 1, 2)
        for name, lamps in (("floor", ("moon",)), ("wall", ("sun", "bulb") if stop != 1 else ("sun",)))
    ),
    stops=(20.0, 100.0, 250.0),
)


def test_at_the_stops_a_stage_shows_the_pictures_of_the_cube() -> None:
    """One for each screen, in the order of the screens; and player and play show the same."""
    cube = made(TURNED)
    own, order = play(cube), [1, 0, 3, 2, 5, 4]
    np.testing.assert_allclose(play(cube, TURNED.stops), own[order], rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(player(cube)([20.0 + 360, 100.0 - 720]), own[order[:4]], rtol=1e-4, atol=1e-6)
    np.testing.assert_array_equal(player(cube)(None), own)


def test_between_two_stops_each_lamp_goes_by_equal_factors() -> None:
    cube = made(TURNED)
    views, lighting, powers = exposures_at(cube, [60.0, 40.0, 315.0])
    assert lighting.screen.tolist() == [0, 1, 0, 1, 0, 1]
    assert lighting.angle.tolist() == [60, 60, 40, 40, 315, 315]
    # pairs of the cube by stop: floor with moon, wall with sun and bulb (with sun alone at the second)
    moon, sun, bulb = cube.powers[[0, 3, 5]], cube.powers[[1, 4, 6]], cube.powers[[2, 7]]
    found = {(int(picture), int(lamp)): power for (picture, lamp), power in zip(lighting.pairs, powers, strict=True)}
    np.testing.assert_allclose(found[1, 2], np.sqrt(moon[0] * moon[1]))
    np.testing.assert_allclose(found[3, 2], moon[0] ** 0.75 * moon[1] ** 0.25)
    np.testing.assert_allclose(found[5, 2], np.sqrt(moon[2] * moon[0]))
    np.testing.assert_allclose(found[2, 0], sun[0] ** 0.75 * sun[1] ** 0.25)
    np.testing.assert_allclose(found[4, 1], np.sqrt(bulb[0] * bulb[1]))
    np.testing.assert_allclose(found[2, 1], bulb[0] ** (210 / 230) * bulb[1] ** (20 / 230))  # it is out at 100
    assert len(views) == len(lighting.picture)


def test_a_screen_without_a_picture_at_the_nearest_stop_is_dark() -> None:
    lighting = made(TURNED).lighting
    assert lighting is not None
    kept, views = lighting.take([1, 2])  # the wall at 20 degrees, the floor at 100
    whole = made(TURNED)
    powers = whole.powers[np.isin(lighting.pairs[:, 0], [1, 2])]
    cube = replace(whole, views=whole.views.take(views), lighting=kept, lamp_powers=powers, names=())
    own = play(cube)
    for angle, lit in ((20.0, own[0]), (100.0, own[1])):
        shown = play(cube, [angle])
        dark = [not np.any(picture) for picture in shown]
        assert sorted(dark) == [False, True]
        np.testing.assert_allclose(shown[dark.index(False)], lit, rtol=1e-4, atol=1e-6)


def test_over_a_hold_the_lamps_stay_as_they_are() -> None:
    cube = made(TURNED, hold_deg=8.0)
    for stop, at in ((20.0, 0), (100.0, 3), (250.0, 5)):
        for off in (-8.0, -3.0, 0.0, 8.0):
            _, lighting, powers = exposures_at(cube, [stop + off])
            pair = lighting.pairs.tolist().index([1, 2])
            np.testing.assert_allclose(powers[pair], cube.powers[at])
    _, lighting, powers = exposures_at(cube, [60.0])
    np.testing.assert_allclose(powers[lighting.pairs.tolist().index([1, 2])], np.sqrt(cube.powers[0] * cube.powers[3]))


def test_held_pictures_are_asked_for_on_either_side_under_the_same_lamps() -> None:
    """The views at stop and hold are those of the same stage at stops that far aside."""
    cube = made(TURNED)
    lighting = cube.lighting
    assert lighting is not None
    held, several, kept = held_views(Frames(play(cube), cube.views, lighting=lighting), 4.0, GRID)
    assert several is not None
    angles = several.pictures // lighting.pictures
    assert angles == 3
    for index, off in enumerate((-4.0, 0.0, 4.0)):
        aside, _ = exposures(replace(TURNED, stops=tuple(stop + off for stop in TURNED.stops)))
        mine = np.isin(several.picture, np.arange(index, several.pictures, angles))
        np.testing.assert_allclose(held.take(np.flatnonzero(mine)).lamps, aside.lamps, atol=1e-12)
        np.testing.assert_allclose(held.take(np.flatnonzero(mine)).origins, aside.origins, atol=1e-12)
        np.testing.assert_array_equal(kept[mine], np.arange(len(cube.views)))
        np.testing.assert_allclose(several.angle[index::angles], lighting.angle + off)


def test_a_hold_that_reaches_the_next_stop_is_refused() -> None:
    """The nearest stop at which the same screen shows a picture counts: here 80 degrees on."""
    views, lighting = exposures(TURNED)
    held_lighting(views, lighting, 40.0, 5.0)
    with pytest.raises(InputError, match=r"a hold of 41 degrees is wider .* at most 40"):
        held_lighting(views, lighting, 41.0, 5.0)
    with pytest.raises(InputError, match="at least 0"):
        held_lighting(views, lighting, -1.0, 5.0)


def test_halved_pictures_keep_their_lighting() -> None:
    """The same room with pixels twice as large: lamps, middles of pictures, and light that falls on them."""
    wall, shots = replace(ROOM.screens[0], size_mm=(4.2, 2.8)), ROOM.shots[:1]
    cube = made(replace(ROOM, screens=(wall,), shots=shots))
    frames, grid = halved(Frames(play(cube), cube.views, lighting=cube.lighting), GRID)
    views, same = exposures(replace(ROOM, grid=grid, screens=(replace(wall, pitch_mm=1.4),), shots=shots))
    assert frames.lighting is not None
    for one, other in zip(falling_light(frames.views, frames.lighting), falling_light(views, same), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-6)
