"""The laws of a prediction: what is reduced keeps what counts, and more load is never told to be easier."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lightcube.backward.recipe import Recipe
from lightcube.backward.solving import solve
from lightcube.errors import InputError
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.light import Light
from lightcube.optics.setups import turntable
from lightcube.optics.views import spread_angles
from lightcube.pictures.targets import Targets
from lightcube.planning import prediction
from lightcube.planning.prediction import Prediction, law, predict, reduced
from lightcube.scoring.metrics import score
from tests.conftest import INTERPRETED
from tests.helpers.recipes import lit


def problem(
    shape: tuple[int, int, int] = (10, 12, 12),
    rig: int = 4,
    picture: tuple[int, int] = (6, 4),
    elevation_deg: float = 35.0,
    seed: int = 0,
    pixel: int = 1,
) -> tuple[Targets, Grid]:
    """Random pictures."""
    grid = Grid(shape, 2.5)
    angles_deg = spread_angles(rig, elevation_deg=elevation_deg)
    stops = turntable(grid, angles_deg, elevation_deg=elevation_deg, picture_shape=picture, pixel=pixel)
    pictures = np.random.default_rng(seed).uniform(0.05, 1, (rig, *picture, 3)).astype(np.float32)
    return Targets(pictures, stops), grid


def doubled(targets: Targets, grid: Grid) -> tuple[Targets, Grid]:
    """The same problem with voxels and pixels of half the size."""
    nz, ny, nx = grid.shape
    rows, columns = targets.rig.picture_shape
    fine = targets.rig.with_pixels(0.5, (2 * rows, 2 * columns))
    pictures, weights = (array.repeat(2, axis=1).repeat(2, axis=2) for array in (targets.pictures, targets.weight))
    return Targets(pictures, fine, weights), Grid((2 * nz, 2 * ny, 2 * nx), grid.voxel_mm / 2)


@pytest.fixture(autouse=True)
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rehearsals of a few passes, on cubes of a few voxels."""
    monkeypatch.setattr(prediction, "AREA", prediction.AREA._replace(passes=4 if INTERPRETED else 12, work=7800))
    monkeypatch.setattr(prediction, "_LEAST", 6)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_what_was_doubled_is_reduced_to_what_it_was(elevation_deg: float) -> None:
    targets, grid = problem(elevation_deg=elevation_deg)
    targets = replace(targets, weights=np.random.default_rng(1).integers(0, 3, targets.weight.shape).astype(np.float32))
    small, small_grid = reduced(*doubled(targets, grid), 12)
    assert small_grid == grid
    # Where nothing has weight there is nothing to keep.
    seen = targets.weight > 0
    np.testing.assert_allclose(small.pictures[seen], targets.pictures[seen], rtol=1e-6)
    np.testing.assert_allclose(small.weight, targets.weight, rtol=1e-6)
    for part in ("lamps", "origins_mm", "column_steps_mm", "row_steps_mm"):
        np.testing.assert_allclose(
            getattr(small.rig.views, part), getattr(targets.rig.views, part), rtol=1e-12, atol=1e-12
        )


@pytest.mark.parametrize(
    ("shape", "picture", "elevation_deg", "pixel"),
    [
        ((30, 50, 70), (18, 26), 30.0, 1),
        ((75, 48, 51), (75, 22), 0.0, 1),
        ((20, 64, 64), (10, 80), 20.0, 1),
        ((64, 64, 64), (96, 32), 45.0, 1),
        ((60, 80, 90), (24, 30), 35.0, 2),
    ],
)
def test_reduced_problems_keep_their_proportions(
    shape: tuple[int, int, int], picture: tuple[int, int], elevation_deg: float, pixel: int
) -> None:
    targets, grid = problem(shape, 2, picture, elevation_deg, pixel=pixel)
    for width in range(20, 28):
        _check_proportions(targets, grid, *reduced(targets, grid, width), width)


def _check_proportions(targets: Targets, grid: Grid, small: Targets, small_grid: Grid, width: int) -> None:
    shape, picture, elevation_deg = grid.shape, targets.rig.picture_shape, float(targets.rig.views.elevations_deg[0])
    (nz, ny, nx), (rows, columns) = small_grid.shape, small.rig.picture_shape
    assert 0.8 * width - 1 <= max(ny, nx) <= width + 1
    pixel = round(targets.rig.views.pixel_in(grid)[0])
    raster = raster_shape(small_grid, elevation_deg, pixel)
    assert (rows - raster[0]) % 2 == (columns - raster[1]) % 2 == 0
    assert max(small_grid.size_mm[1:]) == pytest.approx(max(grid.size_mm[1:]))
    scale = max(ny, nx) / max(shape[1:])
    load = picture[1] / np.sqrt(shape[1] * shape[2]), columns / np.sqrt(ny * nx)
    assert load[1] / load[0] == pytest.approx(1, abs=0.12 * pixel)
    assert np.array([nz, rows, columns]) == pytest.approx(scale * np.array([shape[0], *picture]), abs=2.1)
    lengths = np.linalg.norm(small.rig.views.column_steps_mm, axis=1)
    assert lengths == pytest.approx(pixel * small_grid.voxel_mm)


@pytest.mark.parametrize("elevation_deg", [0.0, 10.0])
def test_the_largest_pictures_stay_on_the_screen_and_level_ones_as_high_as_the_cube(elevation_deg: float) -> None:
    for n in range(23, 60):
        grid = Grid((20, n, n - 4))
        rows, columns = raster_shape(grid, elevation_deg)
        small, small_grid = reduced(*problem(grid.shape, 1, (rows, columns), elevation_deg), 20)
        most = raster_shape(small_grid, elevation_deg)
        assert np.all(np.array(small.rig.picture_shape) <= most)
        assert elevation_deg != 0 or small.rig.picture_shape[0] == most[0] == small_grid.shape[0]


def test_a_small_problem_stays_as_it_is() -> None:
    targets, grid = problem()
    assert reduced(targets, grid, 12) == (targets, grid)


def test_reduced_pictures_have_the_values_of_the_large_ones_in_the_order_of_their_means() -> None:
    targets, grid = problem((36, 36, 36), 2, (18, 12))
    small, _ = reduced(targets, grid, 12)
    assert small.rig.picture_shape == (6, 4)
    for before, after in zip(targets.pictures, small.pictures, strict=True):
        # plain: means of 3 x 3 pixels, and of nine values at a time from the darkest on
        means = before.reshape(6, 3, 4, 3, 3).mean(axis=(1, 3)).reshape(24, 3)
        wanted = np.sort(before.reshape(216, 3), axis=0).reshape(24, 9, 3).mean(axis=1)
        found = after.reshape(24, 3)
        for channel in range(3):
            np.testing.assert_allclose(found[np.argsort(means[:, channel]), channel], wanted[:, channel], rtol=1e-5)


def test_pixels_of_no_weight_have_no_say() -> None:
    targets, grid = problem((20, 24, 22), 3, (12, 8))
    weights = np.ones_like(targets.weight)
    weights[:, :, 5:] = 0
    weights[1, :5] = 0
    other = np.where(weights[..., None] > 0, targets.pictures, 0.7).astype(np.float32)
    one, two = (predict(replace(targets, pictures=p, weights=weights), grid) for p in (targets.pictures, other))
    np.testing.assert_array_equal(one.psnr, two.psnr)
    assert one.rehearsed < 22


def test_a_picture_with_a_single_pixel_of_weight_is_not_lost() -> None:
    targets, grid = problem((20, 24, 22), 3, (12, 8))
    weights = np.ones_like(targets.weight)
    weights[2] = 0
    weights[2, 7, 3] = 1
    small, _ = reduced(replace(targets, weights=weights), grid, 8)
    assert np.sum(small.weight[2] > 0) >= 1


def test_what_is_small_enough_is_solved_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    targets, grid = problem()
    monkeypatch.setattr(prediction, "AREA", prediction.AREA._replace(work=10**9))
    told = predict(targets, grid)
    assert told.rehearsed == 12
    scored = solve(targets, grid, Recipe(passes=prediction.AREA.passes))
    reached = [view["psnr"] for view in score(scored.cube, targets)["pictures"]]
    np.testing.assert_allclose(told.psnr, reached, rtol=1e-4)


def test_a_prediction_is_the_same_every_time() -> None:
    targets, grid = problem((20, 24, 22), 3, (12, 8))
    np.testing.assert_array_equal(predict(targets, grid).psnr, predict(targets, grid).psnr)


def _fewer(targets: Targets, _: Grid) -> tuple[Targets, dict[str, Any]]:
    return targets.take([0, 2]), {}


def _grey(targets: Targets, _: Grid) -> tuple[Targets, dict[str, Any]]:
    return replace(targets, pictures=0.5 + 0.1 * (targets.pictures - 0.5)), {}


def _strong(targets: Targets, _: Grid) -> tuple[Targets, dict[str, Any]]:
    return targets, {"lamp_max": 64.0}


@pytest.mark.parametrize("easier", [_fewer, _grey, _strong])
def test_what_is_easier_is_not_told_to_be_worse(
    easier: Callable[[Targets, Grid], tuple[Targets, dict[str, Any]]],
) -> None:
    targets, grid = problem((16, 20, 18), 5, (8, 12))
    other, options = easier(targets, grid)
    hard, easy = (
        predict(lit(targets, lamp_max=2.0), grid),
        predict(lit(other, **{"lamp_max": 2.0, **options}), grid),
    )
    assert hard.psnr_mean < 50
    assert np.mean(easy.psnr) >= np.mean(hard.psnr) - 0.5
    assert np.min(easy.psnr) >= np.min(hard.psnr) - 0.5


def test_a_hold_costs_something() -> None:
    targets, grid = problem((16, 20, 18), 4, (8, 8))
    assert np.mean(predict(targets, grid, Recipe(hold_deg=8)).psnr) < np.mean(predict(targets, grid).psnr) - 0.5


def test_wider_pictures_are_told_to_be_worse() -> None:
    told = [
        np.mean(predict(lit(targets, lamp_max=2), grid).psnr)
        for targets, grid in (problem((16, 20, 18), 5, (8, columns)) for columns in (4, 10, 20))
    ]
    assert told[0] > told[1] > told[2]


def test_the_law_leaves_alone_what_was_not_reduced_and_keeps_order() -> None:
    reached = np.linspace(5, 90, 50)
    for by in (prediction.AREA, prediction.THIN):
        for level in (False, True):
            np.testing.assert_array_equal(law(reached, 1.0, by, level=level), reached)
        for ratio in (1.5, 4.0, 12.0):
            for level in (False, True):
                told = law(reached, ratio, by, level=level)
                assert np.all(np.diff(told) >= 0)
                assert np.all((told >= 0) & (told <= 100))


def test_pictures_that_would_be_better_than_enough_are_lowered_together() -> None:
    """Until all their pixels are a decibel better than what is enough; others stay."""
    reached = np.array([41.0, 50.0, 47.0])
    told = law(reached, 1.0, prediction.AREA, enough_db=42.0)
    np.testing.assert_allclose(np.diff(told), np.diff(reached))
    assert -10 * np.log10(np.mean(10 ** (-told / 10))) == pytest.approx(43.0)
    np.testing.assert_array_equal(law(reached - 9, 1.0, prediction.AREA, enough_db=42.0), reached - 9)


def test_means_and_worst_are_told_up_to_fifty() -> None:
    told = Prediction(np.array([20.0, 95.0, 41.0]), 24)
    assert (told.psnr_mean, told.psnr_min) == (50.0, 20.0)
    assert Prediction(np.array([20.0, 30.0, 40.0]), 24).psnr_mean == pytest.approx(30.0)


def test_tall_slices_stay_as_tall_in_a_rehearsal() -> None:
    targets, grid = problem((15, 60, 60), 2, (20, 20), 35.0)
    small, small_grid = reduced(targets, replace(grid, tall=2.0), 24)
    assert small_grid.tall == 2
    assert small_grid.size_mm == pytest.approx(replace(grid, tall=2.0).size_mm, rel=0.1)
    assert small.rig.picture_shape[0] == pytest.approx(20 * 24 / 60, abs=2)


def test_pixels_of_many_voxels_are_rehearsed_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    """So many as voxels are too many for the cube; pixels that are no whole voxels were not measured."""
    monkeypatch.setattr(prediction, "AREA", prediction.AREA._replace(passes=12))
    monkeypatch.setattr(prediction, "POINTS", Light(13, 7))  # larger pixels want more than a few
    few = predict(*problem((12, 12, 12), picture=(4, 4), pixel=2), Recipe())
    many = predict(*problem((12, 12, 12), picture=(8, 8)), Recipe())
    assert few.psnr_mean > many.psnr_mean
    targets, grid = problem()
    with pytest.raises(InputError, match="whole voxels"):
        predict(replace(targets, rig=targets.rig.with_pixels(1.5, targets.rig.picture_shape)), grid)


def test_what_solve_refuses_is_refused() -> None:
    targets, grid = problem((20, 24, 22), 4, (12, 8))
    with pytest.raises(InputError) as told:
        predict(targets, grid, Recipe(hold_deg=46.0))
    with pytest.raises(InputError) as solved:
        solve(targets, grid, Recipe(passes=1, hold_deg=46.0))
    assert str(told.value) == str(solved.value)


def test_pictures_larger_than_the_screen_are_refused() -> None:
    targets, _ = problem((20, 24, 22), 4, (40, 8))
    with pytest.raises(InputError, match="larger than"):
        predict(targets, Grid((12, 24, 22), 2.5))
