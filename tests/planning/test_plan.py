"""How large the pictures are made, the cube's proportions, and hold: laws, with a prediction that is a formula."""

from dataclasses import replace

import numpy as np
import pytest

from lightcube.backward.recipe import Recipe
from lightcube.errors import InputError
from lightcube.optics.grid import Grid
from lightcube.optics.light import Light
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.targets import Targets
from lightcube.pictures.turntable import Turntable
from lightcube.planning import rehearsals
from lightcube.planning.plan import PLANNED_DB, WIDTHS, narrower, plan, plan_stage, proportions
from lightcube.planning.prediction import Prediction


def pictures(count: int = 4, rows: int = 24, columns: int = 36) -> Pictures:
    random = np.random.default_rng(3)
    images = tuple(random.uniform(0.1, 1, (rows, columns, 3)).astype(np.float32) for _ in range(count))
    return Pictures(images, tuple(f"p{i}" for i in range(count)))


@pytest.fixture
def formula(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Predict 60 dB less 100 times the part of the cube's area, and 0.8 dB for each degree of hold; count the calls."""
    calls: list[float] = []

    def predict(targets: Targets, grid: Grid, recipe: Recipe) -> Prediction:
        hold_deg = recipe.hold_deg
        rows, columns = targets.rig.picture_shape
        calls.append(hold_deg)
        part = rows * columns / (grid.shape[0] * grid.shape[1])
        return Prediction(np.full(len(targets), 60 - 100 * part - 0.8 * hold_deg), 20)

    monkeypatch.setattr(rehearsals, "predict", predict)
    return calls


def test_pictures_are_as_wide_as_good_ones_can_be(formula: list[float]) -> None:
    planned = plan(pictures(), 64)
    assert planned.prediction.psnr_mean >= PLANNED_DB
    width = planned.targets.rig.picture_shape[1] / 64
    wider = plan(pictures(), 64, picture_width=WIDTHS[WIDTHS.index(min(WIDTHS, key=lambda w: abs(w - width))) + 1])
    assert wider.prediction.psnr_mean < PLANNED_DB
    assert len(formula) <= 6


def test_half_as_wide_as_the_cube_they_may_be_a_little_worse(monkeypatch: pytest.MonkeyPatch) -> None:
    for half_db, columns in ((36.5, 32), (35.5, 24)):

        def told(targets: Targets, _grid: Grid, _recipe: Recipe, half_db: float = half_db) -> Prediction:
            wide = targets.rig.picture_shape[1]
            return Prediction(np.full(len(targets), 40.0 if wide < 26 else half_db if wide <= 32 else 20.0), 20)

        monkeypatch.setattr(rehearsals, "predict", told)
        assert plan(pictures(), 64).targets.rig.picture_shape[1] == columns


def test_where_none_is_good_they_are_as_narrow_as_they_get(monkeypatch: pytest.MonkeyPatch) -> None:
    def bad(targets: Targets, _grid: Grid, _recipe: Recipe) -> Prediction:
        return Prediction(np.full(len(targets), 10.0), 20)

    monkeypatch.setattr(rehearsals, "predict", bad)
    assert plan(pictures(), 64).targets.rig.picture_shape[1] == 16


def test_where_all_are_good_they_fill_the_cube(monkeypatch: pytest.MonkeyPatch) -> None:
    def good(targets: Targets, _grid: Grid, _recipe: Recipe) -> Prediction:
        return Prediction(np.full(len(targets), 70.0), 20)

    monkeypatch.setattr(rehearsals, "predict", good)
    assert plan(pictures(), 64).targets.rig.picture_shape[1] == 64


def test_hold_grows_while_it_costs_less_than_a_decibel(formula: list[float]) -> None:
    """At 0.8 dB a degree a hold of 1 degree is the longest of those tried by thin beams; areas have the least."""
    thin = Recipe(light=Light.thin())
    planned = plan(pictures(), 64, thin, longest_hold=True, picture_width=0.4)
    without = plan(pictures(), 64, thin, picture_width=0.4)
    assert planned.recipe.hold_deg == 1.0
    assert planned.prediction.psnr_mean == pytest.approx(without.prediction.psnr_mean - 0.8)
    assert 40 < without.prediction.psnr_mean < 45
    perfect = plan(pictures(), 64, thin, longest_hold=True, picture_width=0.25)
    assert 1 < perfect.recipe.hold_deg <= perfect.targets.rig.widest_hold_deg
    assert perfect.prediction.psnr_mean >= 44
    for width in (0.25, 0.6):  # where light is averaged, longer ones cost more
        assert plan(pictures(), 64, longest_hold=True, picture_width=width).recipe.hold_deg == 0.25
    assert plan(pictures(), 64, thin, longest_hold=True, picture_width=0.6).recipe.hold_deg == 0


def test_a_hold_that_is_asked_for_is_part_of_the_prediction(formula: list[float]) -> None:
    planned = plan(pictures(), 64, Recipe(hold_deg=2.5))
    assert planned.recipe.hold_deg == 2.5
    assert set(formula) == {2.5}


@pytest.mark.parametrize(
    ("aspect", "width", "level", "shape"),
    [
        (1.0, 0.5, False, (60, 60, 60)),
        (1.5, 0.5, False, (40, 60, 60)),
        (0.5, 0.3, False, (60, 30, 30)),
        (1.0, 0.5, True, (30, 60, 60)),
        (0.25, 0.5, True, (60, 30, 30)),
        (30.0, 0.25, True, (1, 60, 60)),
    ],
)
def test_the_cube_follows_the_pictures(aspect: float, width: float, level: bool, shape: tuple[int, ...]) -> None:
    assert proportions(60, aspect, width, level=level) == shape


def test_a_level_cube_is_as_high_as_its_pictures(formula: list[float]) -> None:
    planned = plan(pictures(4, 30, 20), 32, turntable=Turntable(elevation_deg=0.0), picture_width=0.5)
    assert planned.targets.rig.picture_shape[0] == planned.grid.shape[0]
    assert max(planned.grid.shape) == 32
    assert max(planned.grid.size_mm) == pytest.approx(100)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize("pixel", [2, 3])
def test_pictures_of_larger_pixels_are_as_wide_of_fewer(formula: list[float], pixel: int, elevation_deg: float) -> None:
    said = Turntable(elevation_deg=elevation_deg, pixel=pixel)
    planned = plan(pictures(4, 30, 20), 36, turntable=said, picture_width=0.5)
    rig, grid = planned.targets.rig, planned.grid
    assert rig.views.pixel_in(grid) == pytest.approx((pixel, pixel))
    assert max(grid.shape) == 36
    usual = plan(pictures(4, 30, 20), 36, turntable=replace(said, pixel=1), picture_width=0.5)
    assert pixel * rig.picture_shape[1] == pytest.approx(usual.targets.rig.picture_shape[1], abs=pixel)
    if elevation_deg == 0:
        assert pixel * rig.picture_shape[0] == grid.shape[0]
    less = narrower(planned, 0.25).rig
    assert less.views.pixel_in(grid) == pytest.approx((pixel, pixel))
    assert less.picture_shape[1] == pytest.approx(0.25 * grid.shape[1] / pixel, abs=1)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_a_cube_of_tall_slices_is_as_large_of_fewer(formula: list[float], elevation_deg: float) -> None:
    said = Turntable(elevation_deg=elevation_deg, pixel=2)
    planned = plan(pictures(4, 30, 20), 36, tall=2.0, turntable=said, picture_width=0.5)
    usual = plan(pictures(4, 30, 20), 36, turntable=said, picture_width=0.5)
    assert planned.grid.tall == 2
    assert 2 * planned.grid.shape[0] == pytest.approx(usual.grid.shape[0], abs=2)
    assert planned.grid.shape[1:] == usual.grid.shape[1:]
    assert planned.targets.rig.picture_shape == usual.targets.rig.picture_shape
    assert max(planned.grid.size_mm) == pytest.approx(100)
    assert elevation_deg != 0 or planned.targets.rig.picture_shape[0] == planned.grid.shape[0]


def test_a_given_shape_stays(formula: list[float]) -> None:
    planned = plan(pictures(), 64, shape=(20, 30, 31), size_mm=62.0)
    assert planned.grid == Grid((20, 30, 31), 2.0)


def test_the_real_prediction_and_no_pictures() -> None:
    planned = plan(pictures(3, 8, 8), 8, picture_width=0.5)
    assert 0 <= planned.prediction.psnr_min <= planned.prediction.psnr_mean <= 50
    assert planned.targets.rig.views.elevations_deg[0] == 35
    with pytest.raises(InputError, match="at least two"):
        plan(Pictures((), ()), 8)


def test_a_stage_is_told_what_the_same_turntable_is() -> None:
    """The room of a plan written as a stage, pixel by pixel: the same prediction, hold and all."""
    planned = plan(pictures(), 24, Recipe(hold_deg=1.0), turntable=Turntable(elevation_deg=20.0), picture_width=0.5)
    rig, grid = planned.targets.rig, planned.grid
    side = grid.voxel_mm
    far = grid.size_mm[0] + grid.size_mm[2]
    light = np.cos(np.radians(20.0)), 0.0, -np.sin(np.radians(20.0))
    wall = Screen(
        "wall",
        centre_mm=(far * light[0], 0.0, far * light[2]),
        size_mm=(rig.picture_shape[1] * side, rig.picture_shape[0] * side),
        pitch_mm=side,
        normal=(-1.0, 0.0, 0.0),
    )
    shots = tuple(Shot(name, "wall", ("lamp",), stop) for stop, name in enumerate(planned.targets.names))
    stage = Stage(grid, (Lamp("lamp", light),), (wall,), shots, tuple(rig.stops.angle_deg.tolist()))
    staged = plan_stage(stage, planned.pictures, "crop", planned.recipe)
    assert staged.prediction.is_known
    np.testing.assert_allclose(staged.prediction.psnr, planned.prediction.psnr, atol=1e-3)
    np.testing.assert_array_equal(staged.targets.pictures, planned.targets.pictures)
    assert staged.impossible == staged.doubtful == []

    bulb = replace(stage, lamps=(Lamp("lamp", position_mm=(-far, 0.0, 0.0)),))
    unknown = plan_stage(bulb, planned.pictures).prediction
    assert not unknown.is_known
    assert np.isnan([unknown.psnr_mean, unknown.psnr_min]).all()

    coarse = replace(stage, screens=(replace(wall, pitch_mm=1.5 * side),))
    assert not plan_stage(coarse, planned.pictures).prediction.is_known

    inside = replace(stage, screens=(replace(wall, centre_mm=(0.0, 0.0, 0.0)),))
    wrong = plan_stage(inside, planned.pictures)
    assert wrong.impossible
    assert not wrong.prediction.is_known
