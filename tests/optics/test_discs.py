"""A turntable whose lamp has a disc: as the same room on a stage, blurred by the disc's angle times the distance."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lightcube.backward.problem import pose
from lightcube.backward.recipe import Recipe
from lightcube.backward.solving import solve
from lightcube.backward.wishes import asked
from lightcube.errors import InputError
from lightcube.forward import casting
from lightcube.optics import light
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.light import Light
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.optics.views import swept_mm
from lightcube.pictures.targets import Targets
from lightcube.pictures.turntable import Turntable
from lightcube.planning.measured import is_measured, unmeasured
from lightcube.projection.stacked import StackedBeams, is_stacked
from lightcube.scoring.metrics import score
from tests.conftest import INTERPRETED, forget_points
from tests.helpers import wall
from tests.helpers.areas import divided
from tests.helpers.thin import cast

GRID = Grid((4, 5, 6), 0.7)
STOPS = (20.0, 75.0, 250.0)


@pytest.fixture
def few_points(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """For what is true of any: interpreted kernels look at few points of a pixel."""
    if INTERPRETED:
        for name, count in (("JUDGE", 5), ("JUDGE_ROW", 3), ("JUDGE_DISC", 2)):
            monkeypatch.setattr(light, name, count)
    forget_points()
    yield
    forget_points()


def some_cube(rig: Rig, grid: Grid = GRID) -> Cube:
    random = np.random.default_rng(5)
    powers = random.uniform(0.5, 2, (len(rig.pairs), 3))
    return Cube(random.gamma(0.4, 1.0, (3, *grid.shape)).astype(np.float32), grid, rig, powers)


def disc_of(lamp_deg: float, screen_mm: float | None = None, elevation_deg: float = 30.0, **more: Any) -> Rig:
    said: dict[str, Any] = {"picture_shape": (4, 5), **more}
    return turntable(GRID, STOPS, elevation_deg=elevation_deg, lamp_deg=lamp_deg, screen_mm=screen_mm, **said)


@pytest.mark.usefixtures("few_points")
@pytest.mark.parametrize("elevation_deg", [0.0, 30.0, -50.0])
def test_it_is_the_same_room_written_as_a_stage(elevation_deg: float) -> None:
    rig, tilt = disc_of(7.0, 2.5, elevation_deg), math.radians(elevation_deg)
    behind = math.hypot(5, 6) / 2 * 0.7 + 2.5
    stage = Stage(
        GRID,
        (Lamp("lamp", direction=(math.cos(tilt), 0.0, -math.sin(tilt)), size_deg=7.0),),
        (Screen("wall", (behind, 0.0, -behind * math.tan(tilt)), (3.5, 2.8), 0.7, normal=(-1.0, 0.0, 0.0)),),
        tuple(Shot(str(stop), "wall", ("lamp",), number) for number, stop in enumerate(STOPS)),
        STOPS,
    )
    table, room = some_cube(rig), some_cube(stage.rig())
    np.testing.assert_allclose(wall.play(table), wall.play(room), rtol=1e-5)
    np.testing.assert_allclose(wall.play(table, [33.0]), wall.play(room, [33.0]), rtol=1e-5)
    assert not np.allclose(wall.play(table), wall.play(some_cube(disc_of(7.0, 4.0, elevation_deg))), rtol=1e-2)


def test_the_screen_stands_one_width_behind_where_nothing_is_said() -> None:
    usual, said = disc_of(2.0), disc_of(2.0, 5 * 0.7)
    np.testing.assert_array_equal(usual.views.origins_mm, said.views.origins_mm)
    np.testing.assert_allclose(usual.behind_mm, swept_mm(GRID) + 3.5)
    assert usual.elevation_deg == 30.0
    np.testing.assert_allclose(disc_of(2.0, 0.0).behind_mm, math.hypot(5, 6) / 2 * 0.7)


def test_without_a_size_all_is_as_it_was() -> None:
    rig = disc_of(0.0)
    assert not np.any(rig.views.origins_mm)
    assert not np.any(rig.sums.disc_deg)


def edge(distance_mm: float, disc_deg: float) -> float:
    """Root mean square width of the shadow of a thin wall's edge, mm, `distance_mm` behind it."""
    grid, fine = Grid((3, 9, 1), 1.0), 0.05
    screen_mm = distance_mm - swept_mm(grid)
    rig = turntable(grid, [0.0], picture_shape=(3, 9), lamp_deg=disc_deg, screen_mm=screen_mm)
    rig = divided(rig.with_pixels(fine, (1, round(5 / fine) + 1)), lamp=200)
    wall = np.zeros((1, *grid.shape), np.float32)
    wall[:, :, :5] = 1000.0  # its edge at y = 0.5
    profile = next(iter(cast(Cube(wall, grid, rig), rig)))[0, :, 0]
    change = np.abs(np.diff(profile))
    place = fine * np.arange(len(change))
    middle = np.sum(change * place) / np.sum(change)
    return float(np.sqrt(np.sum(change * (place - middle) ** 2) / np.sum(change)))


@pytest.mark.parametrize(("distance_mm", "disc_deg"), [(6.0, 4.0), (12.0, 4.0), (12.0, 8.0), (20.0, 2.0)])
def test_an_edge_blurs_by_the_discs_angle_times_the_distance(distance_mm: float, disc_deg: float) -> None:
    """Seen from the side a disc of diameter w is sqrt(1 - t^2) bright at t: a root mean square of w / 4."""
    width = 2 * distance_mm * math.tan(math.radians(disc_deg / 2))
    assert edge(distance_mm, disc_deg) == pytest.approx(width / 4, rel=0.12)


@pytest.mark.parametrize("elevation_deg", [0.0, 30.0, -50.0])
def test_the_whole_shadow_has_its_blur(elevation_deg: float) -> None:
    """Around the beam through the cube's middle; beyond is the lamp's light alone, and beyond the sharp one shadow."""
    rig = disc_of(12.0, 6.0, elevation_deg).shifted(np.array([[1, 2], [0, -1], [0, 0]]))
    whole = rig.whole(GRID)
    np.testing.assert_allclose(np.cross(whole.views.origins_mm, whole.views.lamps[:, :3]), 0, atol=1e-9)
    np.testing.assert_allclose(whole.behind_mm, rig.behind_mm)
    sharp, (rows, columns) = raster_shape(GRID, elevation_deg), whole.picture_shape
    around = whole.with_pixels(1.0, (rows + 4, columns + 4))
    around = replace(around, stops=replace(around.stops, window=np.tile((rows + 4, columns + 4), (len(rig), 1))))
    cube = replace(some_cube(rig), lamp_powers=None)
    shown = np.stack(list(casting.cast(cube, around)))
    inside = np.zeros(shown.shape[1:3], bool)
    inside[2:-2, 2:-2] = True
    np.testing.assert_allclose(shown[:, ~inside], 1, rtol=1e-5)
    high, wide = ((all_of - own) // 2 for all_of, own in zip(shown.shape[1:3], sharp, strict=True))
    inside[high:-high, wide:-wide] = False
    assert np.min(shown[:, inside]) < 0.999
    np.testing.assert_allclose(casting.play(cube), shown[:, 2:-2, 2:-2], atol=0.02)  # fewer points around the pictures


@pytest.mark.usefixtures("few_points")
def test_half_a_turn_mirrors_nothing() -> None:
    rig = disc_of(12.0, 6.0, 0.0)
    assert not rig.mirrors
    assert rig.period_deg == 360
    ahead, back = (casting.play(some_cube(rig), [angle])[0] for angle in (20.0, 200.0))
    assert not np.allclose(ahead / ahead.max(), back[:, ::-1] / back.max(), atol=0.01)


def test_turned_and_held_it_stands_where_another_turntable_does() -> None:
    rig, offsets = disc_of(3.0), [-1.0, 0.0, 1.0]
    held = rig.held(1.0, 1.0)
    angles_deg = np.add.outer(STOPS, offsets).ravel()
    other = turntable(GRID, angles_deg, elevation_deg=30.0, picture_shape=(4, 5), lamp_deg=3.0)
    for name in ("lamps", "origins_mm", "column_steps_mm", "row_steps_mm"):
        np.testing.assert_allclose(getattr(held.views, name), getattr(other.views, name), atol=1e-12)
    assert held.sums.disc_deg.tolist() == 9 * [3.0]


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_solving_takes_the_fast_engine(elevation_deg: float) -> None:
    rig = disc_of(3.0, None, elevation_deg)
    views = asked(rig, GRID, Recipe(light=Light(13))).rig.views
    assert len(views) == 3 * 3 * 13
    assert is_stacked(GRID, views)
    problem = pose(Targets(np.full((3, 4, 5, 3), 0.5, np.float32), rig), GRID, Recipe())
    assert isinstance(problem.matrix._engine, StackedBeams)


def test_planning_says_what_it_does_not_know() -> None:
    assert is_measured(disc_of(3.0), GRID)
    assert unmeasured(disc_of(0.0)) == []
    (said,) = unmeasured(disc_of(3.0))
    assert "was not measured" in said


@pytest.mark.skipif(INTERPRETED, reason="interpreted solves of discs take minutes")
def test_a_cube_that_knows_of_its_lamp_is_better_under_it() -> None:
    grid = Grid((9, 12, 11), 1.0)
    random = np.random.default_rng(2)
    smooth = np.kron(random.uniform(0.1, 0.9, (4, 3, 2, 3)), np.ones((1, 2, 3, 1)))[:, :5].astype(np.float32)
    said: dict[str, Any] = {"elevation_deg": 35.0, "picture_shape": (5, 6)}
    rig = turntable(grid, [10.0, 100.0, 190.0, 280.0], lamp_deg=3.0, **said)
    sharp = turntable(grid, [10.0, 100.0, 190.0, 280.0], **said)
    found = []
    for solved_for in (rig, sharp):
        cube = solve(Targets(smooth, solved_for), grid, Recipe(passes=60)).cube
        found.append(score(replace(cube, rig=rig, targets=None), Targets(smooth, rig))["psnr_mean"])
    assert found[0] > found[1] + 3


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"lamp_deg": -0.5}, "from 0 to below 90 degrees, not -0.5"),
        ({"lamp_deg": 90.0}, "from 0 to below 90 degrees, not 90"),
        ({"lamp_deg": math.nan}, "takes a number as lamp_deg, not nan"),
        ({"lamp_deg": 1.0, "screen_mm": -1.0}, "a screen -1 mm behind the turning cube would stand inside it"),
        ({"lamp_deg": 1.0, "screen_mm": math.inf}, "a screen inf mm"),
        ({"screen_mm": 5.0}, "changes nothing unless the lamp has a size"),
    ],
)
def test_what_cannot_be_is_a_sentence(said: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Turntable(**said)
    with pytest.raises(InputError, match=message):
        turntable(GRID, [0.0], **said)


def test_a_disc_does_not_shine_from_behind_the_screen() -> None:
    turntable(GRID, [0.0], elevation_deg=80.0, lamp_deg=19.0)
    with pytest.raises(InputError, match="shines from behind the screen"):
        turntable(GRID, [0.0], elevation_deg=-80.0, lamp_deg=20.0)
