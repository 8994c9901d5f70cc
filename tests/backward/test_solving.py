"""Program 2: every method of the table through the same tests, and the orchestration around them."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from lightcube.backward.pieces import Step
from lightcube.backward.recipe import Recipe
from lightcube.backward.solving import make_job, solve, solve_job
from lightcube.errors import InputError
from lightcube.forward import casting
from lightcube.forward.turning import moment
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.light import Light
from lightcube.optics.material import Material
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import BLACK, decode
from lightcube.optics.views import spread_angles
from lightcube.pictures.targets import Targets
from lightcube.scoring.metrics import score
from lightcube.solvers import METHODS
from tests.helpers.recipes import asked, lit
from tests.helpers.thin import play, thin_recipe

SHAPE = (3, 4, 5)
PASSES: Mapping[str, dict[str, Any]] = {
    "display": {"passes": 300},
    "gauss-seidel": {"passes": 300},
    "row-reduction": {},
    "sirt": {"passes": 1500},
    "cgls": {"passes": 300},
}


def known_cube(rig: int, elevation_deg: float, power: float) -> Cube:
    grid = Grid(SHAPE, 0.5)
    extinction = np.random.default_rng(0).uniform(0, 0.4, (3, *SHAPE)).astype(np.float32)
    turned = turntable(grid, spread_angles(rig, elevation_deg=elevation_deg), elevation_deg=elevation_deg)
    return Cube(extinction, grid, turned, lamp_powers=np.full((rig, 3), power))


def powers_at(cube: Cube, angles_deg: Any) -> np.ndarray:
    """Of the one lamp at any angles."""
    return moment(cube, angles_deg)[1]


def test_every_method_is_tested_here() -> None:
    assert set(PASSES) == set(METHODS)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize("method", METHODS)
def test_a_cubes_own_shadows_come_back(method: str, elevation_deg: float) -> None:
    cube = known_cube(6, elevation_deg, power=1.0)
    targets = Targets(play(cube), cube.rig)
    solution = solve(
        lit(targets, lamp_power=1.0), cube.grid, thin_recipe(method=method, dtype="float64", **PASSES[method])
    )
    assert solution.cube.status == "complete"
    assert solution.cube.provenance["method"] == method
    assert score(solution.cube, targets)["thin_psnr_min"] >= 60
    assert solution.cube.extinction.min() >= 0


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_shadows_in_pixels_of_many_voxels_come_back(elevation_deg: float) -> None:
    """By thin beams, exactly; there are fewer pixels than voxels, so nothing is in the way of pictures."""
    grid = Grid((6, 7, 8), 0.5)
    extinction = np.random.default_rng(0).uniform(0, 0.4, (3, *grid.shape)).astype(np.float32)
    rig = turntable(grid, [10.0, 80.0, 200.0, 301.0], elevation_deg=elevation_deg, pixel=2, power=1.0)
    targets = Targets(np.stack(list(casting.cast(Cube(extinction, grid, rig), light="thin"))), rig)
    solution = solve(targets, grid, Recipe(passes=150, light=Light.thin()))
    assert solution.cube.rig.picture_shape == raster_shape(grid, elevation_deg, 2)
    assert score(solution.cube, targets)["thin_psnr_min"] >= 60


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_shadows_of_tall_slices_come_back(elevation_deg: float) -> None:
    """Level light solves them slice by slice, where each has a row of pixels of its own."""
    grid = Grid((3, 7, 8), 0.5, 2.0)
    extinction = np.random.default_rng(0).uniform(0, 0.4, (3, *grid.shape)).astype(np.float32)
    rig = turntable(grid, [10.0, 80.0, 200.0, 301.0], elevation_deg=elevation_deg, pixel=2, power=1.0)
    targets = Targets(np.stack(list(casting.cast(Cube(extinction, grid, rig), light="thin"))), rig)
    job = make_job(targets, grid, Recipe(passes=150, light=Light.thin()), units=3)
    assert job.level is (elevation_deg == 0)
    solution = solve_job(job)
    assert solution.cube.grid == grid
    assert score(solution.cube, targets)["thin_psnr_min"] >= 60


def test_pictures_of_large_pixels_that_are_wider_than_the_screen_are_refused() -> None:
    grid = Grid((6, 7, 8), 0.5)
    rig = turntable(grid, [10.0, 80.0], pixel=2)
    rig = rig.with_pixels(1.0, (rig.picture_shape[0], rig.picture_shape[1] + 2))
    targets = Targets(np.full((2, *rig.picture_shape, 3), 0.5, np.float32), rig)
    with pytest.raises(InputError, match="larger than"):
        solve(targets, grid, Recipe())


@pytest.mark.parametrize("method", METHODS)
def test_a_stronger_lamp_is_accounted_for(method: str) -> None:
    cube = known_cube(4, 0.0, power=2.5)
    targets = Targets(play(cube), cube.rig)
    solution = solve(
        lit(targets, lamp_power=2.5), cube.grid, thin_recipe(method=method, dtype="float64", **PASSES[method])
    )
    assert np.all(solution.cube.powers == 2.5)
    assert score(solution.cube, targets)["thin_psnr_min"] >= 60


@pytest.mark.parametrize("method", METHODS)
def test_pixels_of_no_weight_do_not_matter(method: str) -> None:
    cube = known_cube(12, 0.0, power=1.0)
    shown = play(cube)
    weights = np.random.default_rng(1).integers(0, 2, shown.shape[:3]).astype(np.float32)
    spoiled = np.where(weights[..., None] > 0, shown, np.float32(0.123))
    one, other = (
        solve(
            lit(Targets(pictures, cube.rig, weights), lamp_power=1.0),
            cube.grid,
            thin_recipe(method=method, dtype="float64", **PASSES[method]),
        )
        for pictures in (shown, spoiled)
    )
    assert np.allclose(one.cube.extinction, other.cube.extinction, atol=1e-6)
    assert score(other.cube, Targets(shown, cube.rig, weights))["thin_psnr_min"] >= 60


# a direct one knows no bound
@pytest.mark.parametrize("method", [name for name in METHODS if METHODS[name].passes is not None])
def test_the_largest_extinction_is_kept(method: str) -> None:
    cube = known_cube(4, 0.0, power=1.0)
    dark = Targets(play(cube) * np.float32(0.01), cube.rig)
    solution = solve(
        lit(dark, lamp_power=1.0), cube.grid, thin_recipe(method=method, material=Material(0.3), passes=20)
    )
    assert solution.cube.extinction.max() <= 0.3 * (1 + 1e-6)
    if method != "gauss-seidel":  # which throws out equations that ask for more
        assert solution.cube.extinction.max() == pytest.approx(0.3)


def test_black_pictures_are_raised_to_the_screens_black() -> None:
    grid = Grid(SHAPE)
    rig = turntable(grid, [20.0, 100.0], picture_shape=(3, 2))
    solution = solve(Targets(np.zeros((2, 3, 2, 3), np.float32), rig), grid, thin_recipe(passes=200))
    darkest = float(decode(np.array([BLACK]))[0])
    assert np.all(play(solution.cube) < 2 * darkest)


def test_the_callback_is_shown_the_screen_and_can_stop() -> None:
    cube = known_cube(4, 35.0, power=2.0)
    targets = Targets(play(cube), cube.rig)
    seen: list[np.ndarray] = []

    def callback(step: Step) -> bool:
        assert step.shown is not None
        seen.append(step.shown())
        return step.iteration == 3

    solution = solve(lit(targets, lamp_power=2.0), cube.grid, callback=callback)  # by area: it is shown as it is judged
    assert len(seen) == 3
    assert solution.cube.status == "interrupted"
    assert solution.stop_reason == "callback"
    assert np.allclose(seen[-1], casting.play(solution.cube, picture_only=True), rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_rejected_pixels_are_named_by_view_row_column_and_channel(elevation_deg: float) -> None:
    """One pixel of a redundant set is made wrong; Gauss-Seidel must name it."""
    cube = known_cube(12, elevation_deg, power=1.0)
    shown = play(cube).astype(np.float64)
    # a pixel whose beam crosses the middle of the cube
    _, rows, columns, _ = shown.shape
    wrong = (5, rows // 2, columns // 2, 1)
    shown[wrong] *= 0.5
    targets = Targets(shown.astype(np.float32), cube.rig)
    solution = solve(
        lit(targets, lamp_power=1.0), cube.grid, thin_recipe(method="gauss-seidel", dtype="float64", passes=3000)
    )
    assert solution.rejected.tolist() == [list(wrong)]
    assert solution.cube.provenance["rejected"] == 1


@pytest.mark.parametrize(
    "options",
    [
        {"method": "magic"},
        {"lamp_power": 0.0},
        {"lamp_power": float("nan")},
        {"lamp_power": 1e300},
        {"lamp_max": 0.5},
        {"lamp_max": float("inf")},
        {"powers": "strobe"},
        {"powers": "shared", "method": "sirt"},
        {"lamp_max": 4.0, "method": "sirt"},
        {"hold_deg": -1.0},
        {"enough_db": float("nan")},
        {"dtype": "int8"},
        {"max_extinction": -1.0},
        {"passes": 0},
    ],
)
def test_nonsense_is_refused(options: dict[str, Any]) -> None:
    cube = known_cube(2, 0.0, power=1.0)
    with pytest.raises(InputError):
        solve(**asked(Targets(play(cube), cube.rig), cube.grid, **options))


def test_targets_of_another_grid_are_refused() -> None:
    cube = known_cube(2, 0.0, power=1.0)
    with pytest.raises(InputError, match="larger than"):
        solve(Targets(play(cube), cube.rig), Grid((2, 2, 2), 0.5))


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_lamp_powers_are_found_per_view_or_for_all_views(elevation_deg: float) -> None:
    """Pictures cast with lamps of several powers: per picture finds them, shared finds one between, fixed stays."""
    cube = known_cube(5, elevation_deg, power=1.0)
    powers = np.random.default_rng(6).uniform(0.5, 3.0, (5, 3))
    targets = Targets(play(Cube(cube.extinction, cube.grid, cube.rig, lamp_powers=powers)), cube.rig)
    free = solve(targets, cube.grid, thin_recipe(passes=600, dtype="float64")).cube
    assert free.provenance["powers"] == "per-picture"
    assert np.allclose(free.powers, powers, rtol=0.05)
    assert score(free, targets)["thin_psnr_min"] > 50
    shared = solve(lit(targets, lamp_max=4.0), cube.grid, thin_recipe(powers="shared", passes=100)).cube
    assert np.all(shared.powers == shared.powers[0])
    assert np.all((shared.powers >= powers.min(axis=0) * 0.9) & (shared.powers <= 4.0))
    fixed = solve(lit(targets, lamp_power=2.0), cube.grid, thin_recipe(passes=100)).cube
    assert np.all(fixed.powers == 2.0)
    free_db, shared_db, fixed_db = (score(each, targets)["thin_psnr_mean"] for each in (free, shared, fixed))
    assert free_db > shared_db > fixed_db


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_a_held_picture_stands_around_its_stop(elevation_deg: float) -> None:
    """With hold the picture is asked for, and cast, over the whole range; without it falls apart there."""
    grid = Grid((6, 8, 8))
    rig = turntable(
        grid, spread_angles(3, elevation_deg=elevation_deg), elevation_deg=elevation_deg, picture_shape=(4, 2)
    )
    pictures = np.random.default_rng(8).uniform(0.2, 1, (3, 4, 2, 3)).astype(np.float32)
    targets = Targets(pictures, rig)
    around = np.concatenate([rig.stops.angle_deg + offset for offset in (-8, -5, -2, 2, 5, 8)])
    wanted = np.tile(pictures, (6, 1, 1, 1))
    errors = {}
    for hold_deg in (0.0, 8.0):
        seen: list[np.ndarray] = []

        def look(step: Step, seen: list[np.ndarray] = seen) -> None:
            assert step.shown is not None
            seen.append(step.shown())

        cube = solve(targets, grid, thin_recipe(hold_deg=hold_deg, passes=200), callback=look).cube
        assert cube.hold_deg == hold_deg
        assert cube.powers.shape == (3, 3)
        assert np.allclose(seen[-1], play(cube), rtol=1e-3, atol=1e-4)
        errors[hold_deg] = np.sqrt(np.mean((play(cube, around) - wanted) ** 2))
    assert errors[8.0] < 0.5 * errors[0.0]


def test_the_lamp_does_not_change_while_a_picture_is_held() -> None:
    cube = known_cube(3, 35.0, power=1.0)
    powers = np.array([[1.0] * 3, [4.0] * 3, [2.0] * 3])
    held_cube = Cube(cube.extinction, cube.grid, cube.rig, lamp_powers=powers, hold_deg=10.0)
    stop = cube.angles_deg[1]
    assert powers_at(held_cube, [stop - 10, stop - 3, stop, stop + 10])[:, 0] == pytest.approx([4] * 4)
    halfway = (cube.angles_deg[0] + stop) / 2
    assert powers_at(held_cube, [halfway])[0, 0] == pytest.approx(2)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize("count", [2, 3, 5, 16])
def test_a_hold_of_half_the_spacing_changes_lamps_halfway(count: int, elevation_deg: float) -> None:
    cube = known_cube(count, elevation_deg, power=1.0)
    powers = np.repeat(2.0 ** (np.arange(count) % 4)[:, None], 3, axis=1)
    half = (360 if elevation_deg else 180) / count / 2
    for hold_deg in (half, 180.0):  # a file may say anything
        held_cube = Cube(cube.extinction, cube.grid, cube.rig, lamp_powers=powers, hold_deg=hold_deg)
        for offset in (-0.9 * half, 0.0, 0.9 * half):
            assert np.allclose(powers_at(held_cube, cube.angles_deg + offset), powers)


@pytest.mark.parametrize("hold_deg", [-1.0, 31.0, float("nan"), float("inf")])
def test_a_hold_wider_than_half_the_spacing_is_refused(hold_deg: float) -> None:
    cube = known_cube(3, 0.0, power=1.0)
    with pytest.raises(InputError, match="hold"):
        solve(Targets(play(cube), cube.rig), cube.grid, thin_recipe(hold_deg=hold_deg))
