"""What is asked of pictures: their means at all points, their mats at few, smoothness at single ones."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lightcube.backward import wishes
from lightcube.backward.mat import Mat, framed, inner, judged_beyond, widened
from lightcube.backward.problem import pose
from lightcube.backward.recipe import Recipe
from lightcube.backward.solving import solve
from lightcube.backward.wishes import asked
from lightcube.errors import InputError
from lightcube.optics.light import Light, bundle
from lightcube.optics.rig import Rig
from lightcube.optics.setups import soft
from lightcube.scoring.metrics import score
from tests.backward.test_mat import GRID, PASSES, some_targets

SMOOTH = len(bundle(wishes.SMOOTH, in_slices=False)[0])
COARSE = len(bundle(wishes.MAT, in_slices=False)[0])


def moved(rig: Rig, other: Rig) -> Any:
    """How far each view's pixels are from those of a rig of as many views, in pixels, right and down."""
    away, steps = rig.views.origins_mm - other.views.origins_mm, (rig.views.column_steps_mm, rig.views.row_steps_mm)
    return np.stack([np.sum(away * step, axis=1) / np.sum(step**2, axis=1) for step in steps], axis=1)


def test_each_wish_has_its_own_points_for_all_pictures_and_angles() -> None:
    recipe = Recipe(light=Light(5, 3, 0.1), mat=Mat(width=0.5, beyond=0), hold_deg=1.0)
    rig = some_targets(35.0).rig
    all_that = asked(rig, GRID, recipe)
    assert len(all_that.wishes) == 2 + SMOOTH
    assert all_that.wish.tolist() == np.repeat(np.arange(2 + SMOOTH), 6).tolist()
    assert all_that.angle.tolist() == [0, 1] * 3 * (2 + SMOOTH)
    assert all_that.stop.tolist() == [0, 0, 1, 1, 2, 2] * (2 + SMOOTH)
    counts = np.diff(np.append(all_that.rig.starts, len(all_that.rig.views)))[: len(all_that.rig)]
    assert counts.tolist() == [5] * 6 + [COARSE] * 6 + [1] * 6 * SMOOTH
    turned = wishes.held(rig, recipe, GRID)
    single = moved(all_that.rig.take(np.arange(12, 18)), turned)
    where = np.broadcast_to(bundle(wishes.SMOOTH, in_slices=False)[0][0, :2], single.shape)
    np.testing.assert_allclose(single, where, atol=1e-9)
    np.testing.assert_allclose(np.bincount(all_that.rig.sums.picture, all_that.rig.sums.share[:, 0]), 1)


def test_thin_beams_have_one_wish_and_no_more_beams() -> None:
    rig = some_targets(35.0).rig
    all_that = asked(rig, GRID, Recipe(light=Light.thin(), mat=Mat(), hold_deg=1.0))
    assert len(all_that.wishes) == 1
    assert len(all_that.rig.views) == len(all_that.rig) == len(all_that.stop) == 3 * (1 + all_that.angle.max())


def test_few_points_are_for_pictures_and_mats_alike() -> None:
    """A mat at more points than the picture would cost more than it."""
    assert len(asked(some_targets(35.0).rig, GRID, Recipe(light=Light(COARSE), mat=Mat(beyond=0))).wishes) == 1


def test_every_pixel_counts_in_one_wish_but_for_smoothness() -> None:
    targets, mat = some_targets(35.0), Mat(width=0.5, beyond=0)
    recipe = Recipe(light=Light(5, 3, 0.1), mat=mat)
    heavy = pose(targets, GRID, recipe).weights
    wide = framed(targets, GRID, mat)
    rows, columns = wide.rig.picture_shape
    by_wish = heavy.reshape(2 + SMOOTH, 3, columns, rows, 3)[..., ::-1, 0].transpose(0, 1, 3, 2)
    np.testing.assert_allclose(by_wish[0] + by_wish[1], wide.weight)
    inside = np.zeros((rows, columns), bool)
    inside[inner(targets.rig, GRID, mat)] = True
    assert not np.any(by_wish[0, :, ~inside])
    assert not np.any(by_wish[1, :, inside])
    for each in by_wish[2:]:
        np.testing.assert_allclose(each, by_wish[0] * np.float32(0.1 / SMOOTH))


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize("shift", [(0, 0), (2, 1)])
def test_every_pixel_of_the_shadow_beyond_the_mat_is_asked_for_once_at_one_point(
    elevation_deg: float, shift: tuple[int, int]
) -> None:
    targets, mat = some_targets(elevation_deg), Mat(width=0.2, beyond=0.01)
    if elevation_deg:
        targets = replace(targets, rig=targets.rig.shifted(np.tile(shift, (3, 1))))
    recipe = Recipe(light=Light(5, 4), mat=mat, hold_deg=1.0)
    all_that, problem = asked(targets.rig, GRID, recipe), pose(targets, GRID, recipe)
    whole, wide = targets.rig.whole(GRID), widened(targets.rig, GRID, mat)
    rows, columns = wide.picture_shape
    heavy = problem.weights.reshape(-1, columns, rows, 3)[:, :, ::-1, 0].transpose(0, 2, 1)
    beyond = [index for index, wish in enumerate(all_that.wish) if all_that.wishes[wish].is_beyond]
    assert set(all_that.angle[beyond]) == {1}  # of two
    counted = np.zeros((3, *np.add(whole.picture_shape, (4 * rows, 4 * columns))))
    middle = wide.places_in(whole) + np.array([2 * rows, 2 * columns])
    for index in beyond:
        right, down = all_that.wishes[all_that.wish[index]].place
        stop = all_that.stop[index]
        top, left = middle[stop] + (down, right)
        counted[stop, top : top + rows, left : left + columns] += heavy[index]
    expected = np.pad(0.01 * judged_beyond(targets.rig, GRID, mat), ((0, 0), (2 * rows,) * 2, (2 * columns,) * 2))
    assert np.count_nonzero(expected) > 100
    np.testing.assert_allclose(counted, expected, rtol=1e-6)
    counts = np.diff(np.append(all_that.rig.starts, len(all_that.rig.views)))
    assert set(counts[beyond]) == {1}
    turned = wishes.held(wide, recipe, GRID).take(2 * all_that.stop[beyond] + 1)
    placed = [all_that.wishes[wish].place for wish in all_that.wish[beyond]]
    np.testing.assert_allclose(moved(all_that.rig.take(beyond), turned), placed, atol=1e-9)


def test_all_wishes_of_a_picture_are_under_its_lamp() -> None:
    problem = pose(some_targets(35.0), GRID, Recipe(light=Light(5, 3, 0.1), mat=Mat(width=0.5), hold_deg=1.0))
    picture = problem.matrix.views
    lamps = problem.lighting.lamp
    assert len(lamps) == len(picture)
    mixture = problem.lighting.mixture
    assert mixture is not None
    of_pictures = lamps[mixture.starts[:-1]]
    assert of_pictures.tolist() == problem.stop.tolist()


def test_lamps_with_discs_are_asked_for_at_their_discs_too() -> None:
    rig = soft(some_targets(35.0).rig, GRID, 2.0)
    views = asked(rig, GRID, Recipe(light=Light(5, 3, 0.1))).rig.views
    assert len(views) == 3 * (3 * 5 + SMOOTH)
    assert len(np.unique(np.round(views.lamps[:, :3], 9), axis=0)) > 3 * 10


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_asked_for_smoothness_the_grain_is_less(elevation_deg: float) -> None:
    targets = some_targets(elevation_deg, (4, 6) if elevation_deg else (10, 6))
    cubes = [solve(targets, GRID, Recipe(passes=PASSES, light=Light(5, 3, grain))).cube for grain in (0.0, 0.3)]
    without, smooth = (score(cube, targets) for cube in cubes)
    assert smooth["grain_rms"] < 0.9 * without["grain_rms"]
    assert smooth["psnr_mean"] > 25


@pytest.mark.parametrize("grain", [-0.1, 2.1, float("inf")])
def test_grain_that_cannot_be_is_refused(grain: float) -> None:
    with pytest.raises(InputError, match="points of a pixel weigh 0 to 2 beside its mean, not"):
        Light(grain=grain)
