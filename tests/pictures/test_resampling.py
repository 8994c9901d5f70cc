"""Half the size and back, and solving from coarse to fine and unit after unit."""

import numpy as np
import pytest

from lightcube.backward.pieces import Step
from lightcube.backward.problem import pose
from lightcube.backward.solving import solve
from lightcube.backward.units import coarser, halvings
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.views import spread_angles
from lightcube.pictures.resampling import enlarged, halved
from lightcube.pictures.targets import Targets
from lightcube.projection.projector import Projector
from lightcube.solvers import METHODS
from tests.helpers.recipes import lit
from tests.helpers.thin import play, thin_recipe


def some_targets(shape: tuple[int, int, int], size: tuple[int, int], elevation_deg: float, count: int = 3) -> Targets:
    rig = turntable(
        Grid(shape, 0.7),
        spread_angles(count, elevation_deg=elevation_deg),
        elevation_deg=elevation_deg,
        picture_shape=size,
    )
    random = np.random.default_rng(4)
    weight = random.choice([0.0, 0.5, 1.0], (count, *size))
    weight[:, 0, 0] = 1
    return Targets(random.uniform(0.1, 1, (count, *size, 3)).astype(np.float32), rig, weight.astype(np.float32))


@pytest.mark.parametrize("size", [(3, 7), (4, 6), (3, 6), (4, 7)])
def test_halving_keeps_weighted_light_and_the_middle(size: tuple[int, int]) -> None:
    targets = some_targets((3, 7, 5), size, 35.0)
    small, grid = halved(targets, Grid((3, 7, 5), 0.7))
    assert grid == Grid((2, 4, 3), 1.4)
    assert small.rig.picture_shape == ((size[0] + 1) // 2, (size[1] + 1) // 2)
    assert np.allclose(small.rig.views.angles_deg, targets.rig.views.angles_deg)

    def total(each: Targets) -> np.ndarray:
        pixel = np.linalg.norm(each.rig.views.row_steps_mm[0]) * np.linalg.norm(each.rig.views.column_steps_mm[0])
        return np.asarray(np.sum(each.pictures * each.weight[..., None], axis=(1, 2)) * pixel)

    assert np.allclose(total(small), total(targets), rtol=1e-5)
    turned = Targets(targets.pictures[:, ::-1, ::-1], targets.rig, targets.weight[:, ::-1, ::-1])
    assert np.allclose(halved(turned, Grid((3, 7, 5), 0.7))[0].pictures, small.pictures[:, ::-1, ::-1], atol=1e-6)


def test_enlarging_keeps_what_is_linear_and_the_middle() -> None:
    """A ramp in mm stays the same ramp between the middles of the outermost coarse voxels."""
    coarse, fine = (3, 4, 5), (6, 7, 9)
    ramps = [0.3, -0.2, 0.5]

    def ramp(shape: tuple[int, int, int], side: float) -> np.ndarray:
        axes = [(np.arange(n) - (n - 1) / 2) * side * r for n, r in zip(shape, ramps, strict=True)]
        return 2 + axes[0][:, None, None] + axes[1][:, None] + axes[2]

    made = enlarged(ramp(coarse, 2.0)[None], fine)[0]
    inside = (slice(1, -1),) * 3
    assert made.shape == fine
    assert np.allclose(made[inside], ramp(fine, 1.0)[inside])


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_a_smooth_cube_casts_nearly_the_same_at_half_the_size(elevation_deg: float) -> None:
    shape, grid = (6, 12, 10), Grid((6, 12, 10))
    z, y, x = np.meshgrid(*(np.linspace(-1, 1, n) for n in shape), indexing="ij")
    volume = np.exp(-2 * (x**2 + (y - 0.2) ** 2 + z**2))[None] * np.ones((3, 1, 1, 1))
    rig = turntable(grid, [20.0, 75.0], elevation_deg=elevation_deg, picture_shape=(6, 4))
    targets = Targets(np.ones((2, 6, 4, 3), np.float32), rig)
    small, small_grid = halved(targets, grid)
    half = volume.reshape(3, 3, 2, 6, 2, 5, 2).mean((2, 4, 6))
    totals = []
    for problem, extinction in (
        (pose(targets, grid, thin_recipe()), volume),
        (pose(small, small_grid, thin_recipe()), half),
    ):
        pixels = problem.matrix.shape[0] * problem.light.shape[1]
        totals.append(float(np.sum(problem.matrix.forward(problem.unknowns(extinction)))) / pixels)
    assert totals[1] == pytest.approx(totals[0], rel=0.06)


def test_coarser_sizes_run_down_to_the_coarsest() -> None:
    grid = Grid((50, 130, 100))
    rig = turntable(grid, [20.0, 75.0], elevation_deg=35.0, picture_shape=(10, 8))
    targets = Targets(np.ones((2, 10, 8, 3), np.float32), rig)
    assert [halvings(Grid(shape)) for shape in ((48, 1, 1), (2, 49, 3), (50, 130, 100))] == [0, 1, 2]
    assert [coarser(targets, grid, times)[1].shape for times in (2, 1)] == [(13, 33, 25), (25, 65, 50)]


def test_the_unknowns_are_the_extinction() -> None:
    targets = some_targets((3, 7, 5), (3, 3), 0.0)
    problem = pose(targets, Grid((3, 7, 5), 0.7), thin_recipe())
    volume = np.random.default_rng(0).random((3, 3, 7, 5)).astype(np.float32)
    assert np.array_equal(problem.extinction(problem.unknowns(volume)), volume)


@pytest.mark.parametrize(("elevation_deg", "size"), [(0.0, (6, 3)), (35.0, (4, 5))])
def test_units_are_independent_once_the_lamp_is_known(elevation_deg: float, size: tuple[int, int]) -> None:
    """Colours, or slabs of slices, solved one by one give what they give together."""
    grid = Grid((6, 7, 5), 0.7)
    targets = some_targets((6, 7, 5), size, elevation_deg)
    apart = solve(lit(targets, lamp_max=4), grid, thin_recipe(passes=400), units=2)
    problem = pose(targets, grid, thin_recipe(powers="coarse"))
    powers = apart.cube.powers
    assert np.max(powers) <= 4 * (1 + 1e-6)
    together = METHODS["display"].solve(problem.matrix, problem.wanted((powers, powers)), iterations=400)
    assert apart.residuals[-1] == pytest.approx(together.residuals[-1], rel=0.05, abs=1e-4)
    assert apart.lower_bound is not None
    assert apart.lower_bound <= apart.residuals[-1] * (1 + 1e-5)


def test_the_start_at_half_the_size_saves_passes(monkeypatch: pytest.MonkeyPatch) -> None:
    grid = Grid((8, 12, 12))
    rig = turntable(grid, spread_angles(4, elevation_deg=35), elevation_deg=35, picture_shape=(6, 6))
    rows, columns = np.mgrid[:6, :6] / 6
    pictures = np.stack([np.stack([0.2 + 0.7 * rows, 0.9 - 0.6 * columns, 0.5 + 0.3 * rows * columns], -1)] * 4)
    targets = Targets(pictures.astype(np.float32), rig)
    cold = solve(targets, grid, thin_recipe(passes=5))
    monkeypatch.setattr("lightcube.backward.units.COARSEST", 8)
    warm = solve(targets, grid, thin_recipe(passes=5))
    assert warm.residuals[0] < 0.5 * cold.residuals[0]
    assert warm.residuals[-1] < cold.residuals[-1]


def test_stopped_at_a_coarse_size_it_stays_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lightcube.backward.units.COARSEST", 4)
    grid = Grid((6, 8, 8), 0.7)
    targets = some_targets((6, 8, 8), (4, 4), 35.0)
    steps: list[Step] = []

    def callback(step: Step) -> bool:
        steps.append(step)
        return len(steps) == 3

    solution = solve(targets, grid, callback=callback)
    assert len(steps) == 3
    assert [step.shown is None for step in steps] == [True] * 3
    assert [step.iteration for step in steps] == [0] * 3
    assert solution.cube.status == "interrupted"
    assert np.all(np.isfinite(play(solution.cube)))


@pytest.mark.parametrize("powers", ["per-picture", "coarse"])
def test_the_work_done_grows_to_all_of_it(monkeypatch: pytest.MonkeyPatch, powers: str) -> None:
    monkeypatch.setattr("lightcube.backward.units.COARSEST", 6)
    grid = Grid((6, 8, 8), 0.7)
    targets = some_targets((6, 8, 8), (4, 4), 35.0)
    done: list[float] = []
    solve(targets, grid, thin_recipe(powers=powers, passes=7), callback=lambda step: done.append(step.done))
    assert done == sorted(done)
    assert done[-1] == pytest.approx(1)
    assert 0 < done[0] < 0.1


def test_halves_are_problems_of_their_own() -> None:
    """A coarse pixel stands for the same beams: with all weights, the same column heights of the screen."""
    targets = some_targets((5, 7, 6), (5, 7), 0.0)
    small, grid = halved(targets, Grid((5, 7, 6), 0.7))
    matrix = Projector(grid, small.rig.views)
    assert matrix.shape == (3 * 4, 4 * 3)


@pytest.mark.parametrize(("powers", "enough_db"), [("per-picture", 30.0), ("coarse", 18.0)])
def test_enough_is_enough(powers: str, enough_db: float) -> None:
    grid = Grid((6, 8, 8), 0.7)
    targets = some_targets((6, 8, 8), (4, 4), 35.0, count=2)
    most = solve(targets, grid, thin_recipe(powers=powers, passes=150))
    enough = solve(targets, grid, thin_recipe(powers=powers, passes=150, enough_db=enough_db))
    assert most.stop_reason != "enough"
    assert enough.stop_reason == "enough"
    assert enough.cube.status == "complete"
    assert enough.residuals[-1] <= 0.5 * 10 ** (-enough_db / 10) * float(np.sum(targets.weight)) * 3 * 1.01
    assert len(enough.residuals) <= len(most.residuals)


def test_stopped_at_the_coarsest_of_several_sizes_the_cube_is_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    """What was reached is enlarged through all sizes: it fills the cube, and does not stand small in its middle."""
    monkeypatch.setattr("lightcube.backward.units.COARSEST", 4)
    grid = Grid((8, 16, 16))
    rig = turntable(grid, spread_angles(3, elevation_deg=35), elevation_deg=35, picture_shape=(8, 16))
    targets = Targets(np.full((3, 8, 16, 3), 0.3, np.float32), rig)
    calls: list[Step] = []

    def callback(step: Step) -> bool:
        calls.append(step)
        return len(calls) == 60

    cube = solve(lit(targets, lamp_power=1.0), grid, callback=callback).cube
    middle, outside = cube.extinction[:, 2:6, 6:10, 6:10].mean(), cube.extinction[:, 2:6, 1:3, 6:10].mean()
    assert cube.status == "interrupted"
    assert outside > 0.2 * middle


def test_slabs_of_one_colour_are_no_colours() -> None:
    rig = turntable(Grid((4, 6, 6)), [20.0, 80.0, 140.0], picture_shape=(4, 4))
    targets = Targets(np.random.default_rng(0).uniform(0.2, 1, (3, 4, 4, 1)).astype(np.float32), rig)
    assert solve(targets, Grid((4, 6, 6)), thin_recipe(powers="coarse", passes=5)).cube.powers.shape == (3, 1)
