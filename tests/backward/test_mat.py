"""A mat is wanted around the pictures, where the cube can make it, and the pictures are what they were."""

from dataclasses import replace

import numpy as np
import pytest

from lightcube.backward.mat import Mat, framed, judged_pixels, margin, widened
from lightcube.backward.problem import pose
from lightcube.backward.recipe import Recipe
from lightcube.backward.solving import make_job, solve, solve_job
from lightcube.errors import InputError
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.light import Light
from lightcube.optics.setups import turntable
from lightcube.pictures.targets import Targets
from lightcube.projection.projector import Projector
from lightcube.scoring.metrics import score
from tests.conftest import INTERPRETED

GRID = Grid((10, 12, 14), 0.7)
PASSES = 20 if INTERPRETED else 60


def some_targets(elevation_deg: float, shape: tuple[int, int] = (4, 6)) -> Targets:
    rig = turntable(GRID, [10.0, 80.0, 200.0], elevation_deg=elevation_deg, picture_shape=shape)
    pictures = np.random.default_rng(2).uniform(0.1, 0.9, (3, *shape, 3)).astype(np.float32)
    return Targets(pictures, rig)


def test_pictures_stay_where_they_are_and_what_they_are() -> None:
    targets = some_targets(35.0)
    wide = framed(targets, GRID, Mat(tone=0.25, width=0.5))
    rows, columns = margin(targets.rig, GRID, Mat(width=0.5))
    assert (rows, columns) == (3, 3)
    inner = slice(rows, -rows), slice(columns, -columns)
    np.testing.assert_array_equal(wide.pictures[:, *inner], targets.pictures)
    np.testing.assert_array_equal(wide.weight[:, *inner], targets.weight)
    np.testing.assert_array_equal(wide.rig.views.origins_mm, targets.rig.views.origins_mm)
    assert np.all(wide.rig.inside)
    around = np.ones(wide.weight.shape, bool)
    around[:, *inner] = False
    assert set(np.unique(wide.weight[around])) <= {np.float32(0), np.float32(0.05)}
    assert np.mean(wide.weight[around] > 0) > 0.5
    np.testing.assert_allclose(wide.pictures[around], 0.0509, atol=1e-3)  # display 0.25 in linear light


def test_no_mat_is_wanted_where_no_glass_is() -> None:
    targets = some_targets(35.0)
    wide = framed(targets, GRID, Mat(width=9.0))
    assert wide.rig.picture_shape == raster_shape(GRID, 35.0)
    through = Projector(GRID, wide.rig)(np.ones(GRID.shape))
    inside = np.ones(wide.weight.shape, bool)
    inside[:, margin(targets.rig, GRID, Mat(width=9.0))[0] : -1, :] = False
    assert np.all(through[(wide.weight > 0)] > 0)
    assert np.all(wide.weight[through == 0] == 0)


@pytest.mark.parametrize("pixel", [2, 3])
def test_a_mat_of_larger_pixels_ends_with_the_shadow_too(pixel: int) -> None:
    grid = Grid((10, 12, 14), 0.7)
    raster = raster_shape(grid, 35.0, pixel)
    rows, columns = (4 - count % 2 for count in raster)
    rig = turntable(grid, [10.0, 80.0, 200.0], elevation_deg=35.0, picture_shape=(rows, columns), pixel=pixel)
    assert margin(rig, grid, Mat(width=0.25)) == (1, 1)
    assert widened(rig, grid, Mat(width=9.0)).picture_shape == raster
    assert rig.whole(grid).picture_shape == raster


def test_level_light_has_no_mat_above_pictures_as_high_as_the_cube() -> None:
    targets = some_targets(0.0, (10, 6))
    assert margin(targets.rig, GRID, Mat())[0] == 0
    assert pose(targets, GRID, Recipe(mat=Mat())).matrix.level


def test_screens_with_edges_have_no_mat() -> None:
    targets = some_targets(35.0)
    edges = replace(targets.rig, screens=replace(targets.rig.screens, endless=np.array([False])))
    assert widened(edges, GRID, Mat()) is edges
    assert framed(replace(targets, rig=edges), GRID, Mat()).pictures is targets.pictures
    assert "mat_rms" not in score(solve(replace(targets, rig=edges), GRID, Recipe(mat=Mat(), passes=2)).cube)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_asked_for_a_calm_shadow_beyond_the_mat_it_becomes_calmer(elevation_deg: float) -> None:
    targets = some_targets(elevation_deg, (4, 4))
    mats = Mat(width=0.25, beyond=0), Mat(width=0.25, beyond=0.1)
    chaos, calm = (score(solve(targets, GRID, Recipe(mat=mat, passes=PASSES, light=Light(5, 3))).cube) for mat in mats)
    assert calm["beyond_rms"] < 0.5 * chaos["beyond_rms"]
    assert calm["psnr_mean"] > 20


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_asked_for_a_mat_becomes_calmer_and_the_pictures_hardly_worse(elevation_deg: float) -> None:
    targets = some_targets(elevation_deg, (4, 6))
    recipes = [Recipe(mat=mat, passes=PASSES, light=Light(5, 3)) for mat in (None, Mat(weight=0.3))]
    cubes = [solve(targets, GRID, recipe).cube for recipe in recipes]
    scores = [score(cube, targets) for cube in cubes]
    assert "mat_rms" not in scores[0]
    chaos = replace(cubes[0], provenance=cubes[1].provenance)  # judged as if it had been asked for a mat
    assert scores[1]["mat_rms"] < 0.5 * score(chaos, targets)["mat_rms"]
    assert scores[1]["psnr_mean"] > 25


def test_a_mat_is_judged_beside_the_picture_but_for_a_seam() -> None:
    targets = some_targets(35.0)
    mat = Mat(width=0.5)
    chosen = judged_pixels(targets.rig, GRID, mat)
    rows, columns = margin(targets.rig, GRID, mat)
    assert not np.any(chosen[:, rows - 1 : rows + 5, columns - 1 : columns + 7])
    assert np.any(chosen[:, : rows - 1])


@pytest.mark.parametrize(
    "said", [{"tone": -0.1}, {"tone": 1.1}, {"weight": 0.0}, {"weight": 2.0}, {"width": 0.0}, {"beyond": -1}]
)
def test_a_mat_that_cannot_be_is_refused(said: dict[str, float]) -> None:
    with pytest.raises(InputError, match="a mat has a tone from 0 to 1"):
        Mat(**said)


def test_methods_that_know_no_lamps_frame_nothing() -> None:
    with pytest.raises(InputError, match="frames no pictures"):
        Recipe("sirt", mat=Mat())
    with pytest.raises(InputError, match="adds up over a pixel"):
        Recipe("sirt", light=Light(3))
    assert Recipe("sirt").beams.is_thin


def test_units_of_a_level_cube_are_slabs_only_where_its_pictures_are_as_high() -> None:
    """Lower ones with mats are seen in all slices too, but judged in their own rows."""
    for shape, level in (((10, 6), True), ((4, 6), False)):
        targets = some_targets(0.0, shape)
        job = make_job(targets, GRID, Recipe(mat=Mat(width=3.0), passes=2, light=Light(3, 2)), units=2)
        assert job.level is level
        assert solve_job(job).cube.status == "complete"
