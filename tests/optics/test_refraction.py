"""Beams in glass, against a plain twin that follows each from the lamp on."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import lightcube as lc
from lightcube.errors import InputError
from lightcube.forward.casting import cast
from lightcube.optics.cube import Cube
from lightcube.optics.glass import Form, Glass
from lightcube.optics.law import falling_light
from lightcube.optics.refraction import bent
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.views import Views
from lightcube.planning.feasibility import impossible
from tests.helpers import plain_glass as plain

Reals = NDArray[np.float64]

#: Voxels (z, y, x) of a block of 14 x 10 x 8 mm, and what a cylinder or sphere is cut of.
GRID, EVEN = lc.Grid((8, 5, 7), 2.0, tall=0.5), lc.Grid((6, 7, 7), 2.0)
BEAMS = 60
FORMS: list[tuple[Form, float]] = [
    ("block", 1.5),
    ("block", 1.9),
    ("cylinder", 1.5),
    ("cylinder", 1.33),
    ("sphere", 1.5),
    ("sphere", 1.3),
    ("bath", 1.5),
    ("bath", 1.1),
    ("round-bath", 1.5),
]


def grid_of(form: Form) -> lc.Grid:
    return EVEN if form in ("cylinder", "sphere") else GRID


def body_of(glass: Glass) -> plain.Body:
    assert glass.size_mm is not None
    x, y, z = glass.size_mm
    if glass.form == "sphere":
        return plain.Sphere(x / 2)
    if glass.form in ("cylinder", "round-bath"):
        return plain.Cylinder(x / 2, z)
    return plain.Block((x, y, z) if glass.form == "block" else (x, 10 * x, 100 * x))


def landed(rig: Rig, form: Form, glass: Glass, seed: int) -> tuple[list[plain.Traced], Rig, list[float]]:
    """Beams that come straight through, a rig with a pixel where each lands, and how bright it is there.

    Of a bath the light's own axes are taken: its faces are square to it.
    """
    random, light = np.random.default_rng(seed), rig.views.lamps[0, :3]
    views, body = rig.views, body_of(glass)
    turn = np.eye(3)
    if form == "bath":
        ahead = np.array([light[0], light[1], 0]) / np.hypot(light[0], light[1])
        turn = np.stack([ahead, [-ahead[1], ahead[0], 0], [0, 0, 1]])
    normal = np.cross(views.column_steps_mm[0], views.row_steps_mm[0])
    kept: list[plain.Traced] = []
    places: list[Reals] = []
    bright: list[float] = []
    while len(kept) < BEAMS:
        start = random.uniform(-1, 1, 3) * 0.5 * np.array([glass.radius_mm * 2, glass.radius_mm * 2, 8.0])
        beam = plain.traced(body, turn @ start, turn @ light, glass.iors[0])
        if beam is None or not beam.is_direct or not np.all(np.isfinite(beam.outgoing)):
            continue
        upright = [abs(abs(point[2]) - (glass.size_mm or (0, 0, 0))[2] / 2) > 1e-6 for point in beam.points]
        ahead_out = min((turn.T @ beam.outgoing)[:2] @ light[:2], turn.T @ beam.outgoing @ light - 0.2)
        if (form in ("cylinder", "round-bath") and not all(upright)) or ahead_out < 0.05:
            continue
        kept.append(beam)
        places.append(turn.T @ beam.lands(turn @ views.origins_mm[0], turn @ normal))
        bright.append(
            plain.irradiance(body, turn @ start, turn @ light, glass.iors[0], turn @ views.origins_mm[0], turn @ normal)
        )
    each = views.take(np.zeros(BEAMS, int))
    one = Views(each.lamps, np.array(places), each.column_steps_mm, each.row_steps_mm, (1, 1))
    for beam in kept:
        beam.points[:] = [turn.T @ point for point in beam.points]
    return kept, replace(Rig.of(one, np.zeros(BEAMS)), glass=glass), bright


@pytest.mark.parametrize("elevation_deg", [0, 20, 35, 61, -35])
@pytest.mark.parametrize(("form", "ior"), FORMS)
def test_beams_are_the_plain_twins(form: Form, ior: float, elevation_deg: float) -> None:
    """Where each enters and leaves, and how bright it is where it lands: Snell's and Fresnel's laws, one by one."""
    grid = grid_of(form)
    rig = turntable(grid, [33.0], elevation_deg=elevation_deg, glass=Glass(ior, form), screen_mm=60.0)
    assert rig.glass is not None
    beams, pixels, bright = landed(rig, form, rig.glass, seed=4)
    got = bent(pixels)
    scale = max(rig.glass.radius_mm, 1.0)
    np.testing.assert_allclose(got.enters_mm[:, 0, 0], [beam.entry for beam in beams], atol=1e-9 * scale)
    np.testing.assert_allclose(got.leaves_mm[:, 0, 0], [beam.exit for beam in beams], atol=1e-9 * scale)
    np.testing.assert_allclose(got.through[:, 0, 0], bright, rtol=3e-5)


def small_cube(glass: Glass, elevation_deg: float = 25.0, **asked: object) -> Cube:
    """A cube of unequal sides at three stops, its pictures as wide as it."""
    rig = turntable(GRID, [12.0, 100.0, 241.0], elevation_deg=elevation_deg, picture_shape=(6, 7), glass=glass)
    extinction = np.random.default_rng(3).uniform(0, 0.2, (3, *GRID.shape)).astype(np.float32)
    return Cube(extinction, GRID, rig)


@pytest.mark.parametrize("form", ["block", "cylinder", "sphere", "bath", "round-bath"])
def test_what_is_cast_is_the_sum_along_the_plain_twins_way(form: Form) -> None:
    """Absorbance in the voxels, from face to face, times the light that comes there."""
    glass = Glass(1.5, form)
    grid = grid_of(form)
    rig = turntable(grid, [33.0], elevation_deg=20, glass=glass)
    assert rig.glass is not None
    beams, pixels, _ = landed(rig, form, rig.glass, seed=2)
    extinction = np.random.default_rng(3).uniform(0, 0.2, (2, *grid.shape)).astype(np.float32)
    shown = np.stack(list(cast(Cube(extinction, grid, pixels), light="thin")))[:, 0, 0]
    x_mm, y_mm, z_mm = (float(side) for side in grid.sides_mm)
    absorbed = [[plain.absorbance(beam.points, each, (x_mm, y_mm, z_mm)) for each in extinction] for beam in beams]
    got = bent(pixels)
    wanted = got.beside[:, 0] + got.through[:, 0] * np.exp(-np.array(absorbed))
    np.testing.assert_allclose(shown, wanted, rtol=2e-5)


def test_an_index_of_one_changes_no_bit() -> None:
    straight = turntable(GRID, [12.0, 100.0], elevation_deg=25)
    for form in ("block", "cylinder", "sphere"):
        same = turntable(GRID, [12.0, 100.0], elevation_deg=25, glass=Glass(1.0, form))
        assert same.glass is None
        np.testing.assert_array_equal(same.views.origins_mm, straight.views.origins_mm)


@pytest.mark.parametrize("angle_deg", [0.0, 20.0, 90.0])
def test_a_square_bath_is_straight_light_at_the_elevation_inside(angle_deg: float) -> None:
    """59.4 degrees outside are 35 inside glass of 1.5; all the bath does is to let 83 % of the light through."""
    glass = Glass(1.5, "bath")
    assert glass.inside_deg(59.35) == pytest.approx(35, abs=0.01)
    outside_deg = np.degrees(np.arcsin(1.5 * np.sin(np.radians(35.0))))
    extinction = np.random.default_rng(3).uniform(0, 0.2, (3, *GRID.shape)).astype(np.float32)
    shape = (9, 7)
    wet = turntable(GRID, [angle_deg], elevation_deg=outside_deg, picture_shape=shape, glass=glass)
    dry = turntable(GRID, [angle_deg], elevation_deg=35.0, picture_shape=shape)
    ((light, _), shown, straight) = (
        falling_light(wet),
        next(cast(Cube(extinction, GRID, wet))),
        next(cast(Cube(extinction, GRID, dry))),
    )
    np.testing.assert_allclose(shown, light[0][..., None] * straight, rtol=1e-6)
    assert np.ptp(light) < 1e-6
    assert 0.8 < light[0, 0, 0] < 0.9


@pytest.mark.parametrize("form", ["block", "cylinder", "round-bath", "bath"])
def test_glass_turns_with_the_table(form: Form) -> None:
    """Stops at other angles are what the rig shows when it is turned there; whole turns change nothing."""
    glass = Glass(1.5, form)
    rig = turntable(GRID, [12.0, 100.0], elevation_deg=25, picture_shape=(6, 5), glass=glass)
    there = turntable(GRID, [42.0, 130.0], elevation_deg=25, picture_shape=(6, 5), glass=glass)
    for one, two in ((bent(rig.turned(30.0)), bent(there)), (bent(rig.turned(360.0)), bent(rig))):
        np.testing.assert_allclose(one.enters_mm, two.enters_mm, atol=1e-9)
        np.testing.assert_allclose(one.through, two.through, atol=1e-12)


def test_each_colour_has_its_own_index() -> None:
    """Three indices are three cubes of one colour each, in glass of one index."""
    iors = (1.45, 1.5, 1.6)
    cube = small_cube(Glass(iors))
    shown = np.stack(list(cast(cube)))
    for colour, ior in enumerate(iors):
        alone = small_cube(Glass(ior))
        np.testing.assert_allclose(shown[..., colour], np.stack(list(cast(alone)))[..., colour], rtol=1e-6)


def test_a_window_and_its_whole_shadow_agree() -> None:
    for form in ("block", "cylinder", "sphere", "round-bath"):
        cube = small_cube(Glass(1.5, form))
        window = lc.play(cube, picture_only=True)
        whole = lc.play(cube)
        places = cube.rig.places_in(cube.rig.whole(GRID))
        for picture, (top, left) in enumerate(places):
            np.testing.assert_array_equal(whole[picture, top : top + 6, left : left + 7], window[picture])


def test_nothing_comes_through_a_bottom_that_is_blocked() -> None:
    open_, blocked = (small_cube(Glass(1.5, bottom=bottom), 50.0).rig for bottom in ("open", "blocked"))
    one, two = bent(open_), bent(blocked)
    lost = (one.through > 0) & (two.through == 0)
    assert 0.05 < lost.mean() < 0.95
    np.testing.assert_allclose(one.leaves_mm[lost][:, 2], -GRID.size_mm[0] / 2)
    np.testing.assert_array_equal(one.through[~lost], two.through[~lost])


@pytest.mark.parametrize(
    ("said", "sentence"),
    [
        ({"ior": 0.9}, "between 1 and 4"),
        ({"ior": 5.0}, "between 1 and 4"),
        ({"ior": 1.2}, "below 1.4143"),
        ({"ior": (1.5, 1.6)}, "one index of refraction, or three"),
        ({"ior": (1.3, 1.4, 1.5), "form": "bath"}, "one index"),
        ({"ior": 1.5, "form": "sphere", "bottom": "blocked"}, "not of a sphere"),
        ({"ior": 1.5, "bath_mm": 100.0}, "bath_mm is the width of a bath"),
        ({"ior": 1.5, "form": "bath", "bath_mm": 1e308}, "bath_mm is the width of a bath"),
    ],
)
def test_glass_that_cannot_be_is_refused(said: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        Glass(**said)  # type: ignore[arg-type]


def test_rooms_that_cannot_be_are_refused() -> None:
    with pytest.raises(InputError, match="too narrow"):
        turntable(GRID, [10.0], glass=Glass(1.5, "bath", bath_mm=10.0))
    with pytest.raises(InputError, match="within the focus of the cylinder"):
        turntable(GRID, [10.0], glass=Glass(1.2, "cylinder"), screen_mm=0.0)
    near = np.array([[-300.0, 0, 0, 1.0]])
    views = Views(near, np.array([[90.0, 0, 0]]), np.array([[0, -1.0, 0]]), np.array([[0, 0, -1.0]]), (4, 4))
    with pytest.raises(InputError, match="parallel light only"):
        replace(Rig.of(views, np.zeros(1)), glass=Glass(1.5).around(GRID))


def test_colours_that_were_parted_come_together_again() -> None:
    """Of pictures under several coloured lamps too; in a room nothing is impossible because colours part."""
    lamps = tuple(lc.Lamp(name, direction=(1, y, -0.4), colour=(1.0, 0.5, 0.2)) for name, y in (("a", 0.0), ("b", 0.3)))
    screen = lc.Screen("wall", (90.0, 0.0, -30.0), (10.0, 8.0), 2.0, normal=(-1, 0, 0))
    shots = tuple(lc.Shot(f"{stop}", "wall", ("a", "b") if stop else ("a",), stop) for stop in range(2))
    room = lc.Stage(GRID, lamps, (screen,), shots, (10.0, 100.0), glass=Glass((1.4, 1.5, 1.6), "round-bath"))
    one = replace(room, glass=Glass(1.5, "round-bath")).rig()
    parted, again = room.rig(), room.rig().as_one_colour()
    assert len(parted.views) == 9
    np.testing.assert_allclose(again.sums.share, one.sums.share)
    np.testing.assert_array_equal(again.sums.picture, one.sums.picture)
    np.testing.assert_array_equal(again.views.lamps, one.views.lamps)
    assert again.glass is not None
    assert again.glass.iors == pytest.approx((1.5,))
    assert impossible(room) == impossible(replace(room, glass=None))
