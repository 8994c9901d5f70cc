"""Light on areas: points that spread evenly, that no judge shares, whose mean is what a wall shows."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.stats import qmc

from lightcube.backward.recipe import Recipe
from lightcube.backward.wishes import asked
from lightcube.errors import InputError
from lightcube.forward import casting
from lightcube.optics.cube import Cube
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid
from lightcube.optics.light import (
    JUDGE,
    JUDGE_DISC,
    JUDGE_ROW,
    Light,
    finer,
    is_in_slices,
    judge_points,
    judged,
    judged_one_by_one,
    lattice,
    seeds,
    soft_lattice,
)
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from tests.helpers.areas import divided
from tests.helpers.thin import cast, play

GRID = Grid((3, 5, 7), 0.7)


def rig_of(elevation_deg: float, rows: int = 3, **more: Any) -> Rig:
    return turntable(GRID, [17.0, 131.0], elevation_deg=elevation_deg, picture_shape=(rows, 5), **more)


def some_cube(rig: Rig) -> Cube:
    random = np.random.default_rng(5)
    powers = random.uniform(0.5, 2, (len(rig.pairs), 3))
    return Cube(random.gamma(0.4, 1.0, (3, *GRID.shape)).astype(np.float32), GRID, rig, powers)


@pytest.mark.parametrize("count", [*range(1, 30), 34, 45, 54])
def test_points_of_a_lattice_are_even_and_none_is_the_judges(count: int) -> None:
    """Each of the N columns and rows of a pixel has one; their discrepancy is scipy's, and below a square grid's."""
    points = lattice(count)
    for axis in (0, 1):
        np.testing.assert_allclose(np.sort(points[:, axis]), (np.arange(count) + 0.5) / count - 0.5, atol=1e-12)
    apart = np.linalg.norm(points[:, None] - judge_points(rig_of(35.0), GRID), axis=-1)
    assert np.min(apart) > 1e-4 or count == 1
    side = math.isqrt(count)
    if count >= 9:
        fine = (np.arange(side) + 0.5) / side
        square = np.stack([each.ravel() for each in np.meshgrid(fine, fine)], axis=1)
        assert qmc.discrepancy(points + 0.5, method="CD") < qmc.discrepancy(square, method="CD")


@pytest.mark.parametrize("count", [55, 110, 275, 1024])
def test_many_points_are_found_in_a_moment_and_all_different(count: int) -> None:
    for points in (lattice(count), soft_lattice(count)):
        assert len(np.unique(points[:, 0])) == len(np.unique(points[:, 1])) == count


def test_the_judges_points_are_a_fibonacci_lattice() -> None:
    points = judge_points(rig_of(35.0), GRID)
    expected = [((i + 0.5) / 55 - 0.5, (34 * i % 55 + 0.5) / 55 - 0.5) for i in range(55)]
    np.testing.assert_allclose(points, expected, atol=1e-12)


@pytest.mark.parametrize("count", [*range(1, 40), 48])
def test_points_in_a_row_are_none_of_the_judges(count: int) -> None:
    rig = rig_of(0.0)
    moved = asked(rig, GRID, Recipe(light=Light(3, count))).rig.views.origins_mm[: max(count, 1)]
    judge = judged(rig, GRID).views.origins_mm[:JUDGE_ROW]
    assert np.min(np.linalg.norm(moved[:, None] - judge, axis=-1)) > 1e-6
    np.testing.assert_allclose(moved[:, 2], rig.views.origins_mm[0, 2])  # none higher or lower


@pytest.mark.parametrize(
    ("rig", "in_slices"),
    [
        (rig_of(0.0), True),
        (rig_of(0.0, rows=1), True),
        (rig_of(0.01), False),
        (rig_of(0.0).shifted(np.array([[1, 0], [0, 1]])), True),
        (replace(rig_of(0.0), views=rig_of(0.0).views.with_pixels(2.0, (3, 5))), False),
        (rig_of(0.0, glass=Glass(1.5, "cylinder")), True),
        (rig_of(0.0, glass=Glass(1.5, "sphere")), False),
    ],
)
def test_points_lie_in_a_row_exactly_where_a_pixel_is_one_slice_high(rig: Rig, in_slices: bool) -> None:
    assert is_in_slices(rig, GRID) is in_slices
    half_up = replace(rig, views=replace(rig.views, origins_mm=rig.views.origins_mm + np.array([0.0, 0.0, 0.35])))
    assert not is_in_slices(half_up, GRID)
    soft = replace(rig, sums=replace(rig.sums, disc_deg=np.array([0.0, 1.0])))
    assert not is_in_slices(soft, GRID)


@pytest.mark.parametrize(
    ("pixel", "elevation_deg", "tall", "points", "row"),
    [
        (1, 35.0, 1, 5, 4),
        (2, 35.0, 1, 20, 8),
        (2, 35.0, 2, 10, 8),
        (2, 0.0, 1, 20, 8),
        (3, 35.0, 1, 34, 12),
        (4, 0.0, 4, 20, 15),
    ],
)
def test_pixels_of_several_voxels_have_as_many_times_as_many_points(
    pixel: int, elevation_deg: float, tall: int, points: int, row: int
) -> None:
    grid = Grid((12, 16, 20), 0.7, tall=tall)
    rig = turntable(grid, [17.0], elevation_deg=elevation_deg, picture_shape=(2, 3), pixel=pixel)
    assert finer(Light(5, 4, 0.1), rig, grid) == Light(points, row, 0.1)
    assert finer(Light(100, 50), rig, grid) == Light(100, 50)
    assert finer(Light.thin(), rig, grid).is_thin
    counted = len(asked(rig, grid, Recipe(light=Light(5, 4))).rig.views)
    assert counted == (row if is_in_slices(rig, grid) else points)


def test_a_pixel_is_as_large_as_its_light_is_in_the_cubes_middle() -> None:
    """A screen of pixels thrice as wide as voxels, as far behind the cube as the lamp is before it."""
    rig = turntable(GRID, [30.0], picture_shape=(1, 2), pixel=3)
    along = rig.views.lamps[:, :3]
    for distance_mm, sides in ((20.0, 1), (40.0, 2), (1e9, 3)):
        lamps = np.append(-distance_mm * along, [[1.0]], axis=1)
        near = replace(rig, views=replace(rig.views, lamps=lamps, origins_mm=20 * along))
        assert finer(Light(2, 2), near, GRID) == Light(2 * sides**2, 2 * sides)


def test_where_points_lie_in_a_row_more_along_z_change_nothing_and_elsewhere_they_do() -> None:
    for elevation_deg, alike in ((0.0, True), (3.0, False)):
        rig = rig_of(elevation_deg)
        cube = some_cube(rig)
        row = [np.column_stack([x, 0 * x, 0 * x, 0 * x]) for x in (np.linspace(-0.4, 0.4, 9),) * 2]
        square = [np.concatenate([each + np.array([0, y, 0, 0]) for y in (-0.4, 0.1, 0.45)]) for each in row]
        one, other = (np.stack(list(cast(cube, rig.split(points)))) for points in (row, square))
        assert np.allclose(one, other, rtol=1e-5) is alike


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize("disc_deg", [0.0, 3.0])
def test_light_on_areas_is_the_mean_of_thin_beams(elevation_deg: float, disc_deg: float) -> None:
    """Of those at the judge's points, one by one or together, and nearly that of very many."""
    rig = rig_of(elevation_deg)
    rig = replace(rig, sums=replace(rig.sums, disc_deg=np.full(2, disc_deg)))
    cube = some_cube(rig)
    shown = casting.play(cube, picture_only=True)
    each = [np.stack(list(cast(cube, one))) for one in judged_one_by_one(rig, GRID)]
    assert len(each) == (JUDGE if elevation_deg or disc_deg else JUDGE_ROW)
    np.testing.assert_allclose(np.mean(each, axis=0), shown, rtol=2e-5)
    np.testing.assert_allclose(np.stack(list(cast(cube, judged(rig, GRID)))), shown, rtol=1e-6)
    many = np.stack(list(cast(cube, divided(rig, pixel=16, lamp=5 if disc_deg else 1))))
    assert np.sqrt(np.mean((shown - many) ** 2)) < 0.01
    assert np.sqrt(np.mean((play(cube) - many) ** 2)) > 0.02


def test_a_clear_cube_shows_the_lamp() -> None:
    rig = rig_of(35.0)
    clear = replace(some_cube(rig), extinction=np.zeros((3, *GRID.shape), np.float32))
    np.testing.assert_allclose(
        casting.play(clear, picture_only=True), np.broadcast_to(clear.powers[:, None, None], (2, 3, 5, 3)), rtol=1e-6
    )


def test_a_box_darkens_a_pixel_by_the_part_that_it_covers() -> None:
    """One opaque voxel before a level lamp at 0 degrees: a pixel that it covers in part shows what passes beside it."""
    grid = Grid((3, 5, 5), 1.0)
    rig = turntable(grid, [0.0], picture_shape=(3, 5))
    dark = np.zeros((1, *grid.shape), np.float32)
    dark[:, 1, 2, 2] = 100.0
    for aside in (0.0, 0.25, 0.5, 0.75):
        moved = replace(rig, views=replace(rig.views, origins_mm=rig.views.origins_mm + np.array([0.0, aside, 0.0])))
        shown = next(casting.cast(Cube(dark, grid, moved)))[1, :, 0]
        np.testing.assert_allclose(sorted(shown)[:2], sorted([aside, 1 - aside]), atol=0.5 / JUDGE_ROW + 1e-6)


def test_a_slab_of_glass_whose_thickness_falls_along_a_pixel_has_its_analytic_mean() -> None:
    """Turned by 45 degrees the beams through a voxel's corner are as long as they are far from it: a mean of e^-2x."""
    grid = Grid((1, 1, 1), 1.0)
    rig = turntable(grid, [45.0], picture_shape=(1, 1))
    cube = Cube(np.ones((1, 1, 1, 1), np.float32), grid, rig)
    # over the pixel's width the chord is 2 (1/sqrt 2 - |t|) for t from -1/2 to 1/2
    most = 2 / math.sqrt(2)
    expected = (math.exp(1 - most) - math.exp(-most)) * 1.0
    assert next(casting.cast(cube))[0, 0, 0] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("count", [13, 21, 34, 89])
def test_points_of_a_pixel_and_of_a_disc_do_not_go_together(count: int) -> None:
    """No place in a pixel says where in the disc its light is from: else more points would bring nothing."""
    points = soft_lattice(count)
    np.testing.assert_array_equal(points[:, :2], lattice(count))
    radius = np.sum(points[:, 2:] ** 2, axis=1)
    places = np.column_stack([points[:, :2], np.abs(points[:, :2])])
    off = [abs(np.corrcoef(place, other)[0, 1]) for place in places.T for other in (radius, *points[:, 2:].T)]
    assert max(off) < 2.2 / math.sqrt(count)


def test_the_more_points_the_nearer_to_the_mean_of_a_disc() -> None:
    rig = rig_of(35.0)
    rig = replace(rig, sums=replace(rig.sums, disc_deg=np.full(2, 20.0)))
    cube = some_cube(rig)
    many = np.stack(list(cast(cube, divided(rig, pixel=12, lamp=40))))
    rigs = (asked(rig, GRID, Recipe(light=Light(count))).rig for count in (5, 13, 34, 89))
    off = [float(np.sqrt(np.mean((np.stack(list(cast(cube, each))) - many) ** 2))) for each in rigs]
    assert np.all(np.diff(off) < 0)
    assert off[3] < off[0] / 4


@pytest.mark.parametrize("count", [1, 2, 5, JUDGE_DISC])
def test_seeds_lie_in_a_disc_about_its_middle(count: int) -> None:
    found = seeds(count)
    assert np.all(np.linalg.norm(found, axis=1) <= 1)
    np.testing.assert_allclose(found.mean(axis=0), 0, atol=1e-12)


@pytest.mark.parametrize("counts", [(0, 1), (1, 0), (-3, 4), (1025, 1)])
def test_points_that_cannot_be_are_refused(counts: tuple[int, int]) -> None:
    with pytest.raises(InputError, match="1 to 1024 points"):
        Light(*counts)


def test_thin_light_leaves_the_rig_as_it_is() -> None:
    rig = rig_of(35.0)
    assert asked(rig, GRID, Recipe(light=Light.thin())).rig is rig
    assert len(asked(rig, GRID, Recipe(light=Light(13))).rig.views) == 26
