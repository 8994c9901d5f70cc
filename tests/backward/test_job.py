"""A job: its units and pieces, what it is known by, where it goes on, and what it needs."""

import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lightcube.backward import needs
from lightcube.backward.job import Job, differences, fingerprint, shares
from lightcube.backward.mat import Mat
from lightcube.backward.pieces import Step, solve_piece
from lightcube.backward.problem import is_level, pose
from lightcube.backward.solution import Solution, merged
from lightcube.backward.solving import make_job, solve, solve_job
from lightcube.backward.store import Arrays, MemoryStore
from lightcube.backward.units import coarser, split
from lightcube.errors import InputError
from lightcube.io import read_dyes
from lightcube.jobs.partial import open_partial
from lightcube.kernels.layout import columns_from_volume
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.light import Light
from lightcube.optics.material import Material
from lightcube.optics.setups import turntable
from lightcube.optics.views import spread_angles
from lightcube.pictures.targets import Targets
from lightcube.solvers import METHODS
from tests.conftest import INTERPRETED
from tests.helpers.recipes import asked, lit
from tests.helpers.thin import thin_recipe

SHAPE = (4, 7, 6)


def some_targets(
    shape: tuple[int, int, int] = SHAPE, size: tuple[int, int] = (3, 5), elevation_deg: float = 35.0, count: int = 3
) -> Targets:
    angles_deg = spread_angles(count, elevation_deg=elevation_deg)
    rig = turntable(Grid(shape, 0.7), angles_deg, elevation_deg=elevation_deg, picture_shape=size)
    random = np.random.default_rng(2)
    weight = random.choice([0.5, 1.0], (count, *size))
    return Targets(random.uniform(0.1, 1, (count, *size, 3)).astype(np.float32), rig, weight.astype(np.float32))


def other_cube() -> Cube:
    """To start from."""
    extinction = np.random.default_rng(4).uniform(0, 0.4, (3, *SHAPE)).astype(np.float32)
    return Cube(extinction, Grid(SHAPE, 0.7), some_targets().rig)


def job(elevation_deg: float = 35.0, size: tuple[int, int] = (3, 5), **options: Any) -> Job:
    return make_job(
        **asked(some_targets(size=size, elevation_deg=elevation_deg), Grid(SHAPE, 0.7), **{"passes": 12, **options})
    )


DYED = Material(dyes=read_dyes("polyjet"))
CLEAR = Material(dyes=read_dyes("pla"))  # in a material that absorbs nothing itself
LEVEL: dict[str, Any] = {"elevation_deg": 0.0, "size": (4, 5), "units": 3}
RAISED: dict[str, Any] = {"units": 2}
KINDS: list[dict[str, Any]] = [
    {},
    RAISED,
    LEVEL,
    {**RAISED, "powers": "shared", "hold_deg": 2.0},
    {"powers": "coarse"},
    {"start": other_cube()},
    {**LEVEL, "method": "sirt"},
    {**RAISED, "method": "cgls"},
    {"material": DYED},
    {**LEVEL, "material": DYED, "light": Light(3, 3)},
    {"material": DYED, "method": "sirt"},
]


def same(one: Solution, other: Solution) -> bool:
    """Bit for bit."""
    pairs: list[tuple[Any, Any]] = [(one.cube.extinction, other.cube.extinction), (one.cube.powers, other.cube.powers)]
    pairs += [(one.residuals, other.residuals), (one.rejected, other.rejected)]
    rest = [(each.stop_reason, each.undetermined, each.lower_bound, each.cube.provenance) for each in (one, other)]
    return rest[0] == rest[1] and all(a.tobytes() == b.tobytes() for a, b in pairs)


@given(st.integers(1, 300), st.integers(1, 3), st.integers(1, 300), st.booleans())
def test_units_are_all_of_the_cube_once(slices: int, colours: int, count: int, level: bool) -> None:
    count = min(count, slices if level else colours)
    seen = np.zeros((colours, slices), int)
    parts = split((slices, 2, 3), colours, count, level=level)
    for part in parts:
        seen[part.colours, part.slices] += 1
    assert len(parts) == count
    assert np.all(seen == 1)
    columns = [part.columns for part in parts]
    assert sum(columns) == seen.size
    if level and slices >= 16 * count:
        assert all(part.slices.start % 16 == 0 for part in parts)
        assert max(columns) - min(columns) <= 2 * 16 * colours
    elif level:
        assert max(columns) - min(columns) <= colours


@pytest.mark.parametrize(("elevation_deg", "size"), [(0.0, (4, 5)), (35.0, (3, 5)), (0.0, (2, 5))])
def test_the_parts_of_a_problem_are_the_problem(elevation_deg: float, size: tuple[int, int]) -> None:
    """Columns of light and weights, and what is made of unknowns and beams, part by part and all at once."""
    targets, grid = some_targets(size=size, elevation_deg=elevation_deg), Grid(SHAPE, 0.7)
    whole = pose(targets, grid, thin_recipe(hold_deg=2.0))
    random = np.random.default_rng(1)
    volume = random.random((3, *SHAPE)).astype(np.float32)
    seen, powers = whole.matrix.forward(whole.unknowns(volume)), random.random((3, 3))
    everything = whole.shown(whole.unknowns(volume), powers)
    columns = np.arange(whole.light.shape[1]).reshape(-1, 3)
    rejected = np.argwhere(random.random(whole.light.shape) < 0.2)
    pixels: list[list[int]] = []
    level = is_level(grid, targets.rig.views)
    assert level == (size[0] == 4)
    for part in split(SHAPE, 3, 2, level=level):
        own = pose(targets, grid, thin_recipe(hold_deg=2.0), part)
        chosen = columns[part.slices if level else slice(None), part.colours].ravel()
        assert np.array_equal(own.light, whole.light[:, chosen])
        assert np.array_equal(own.weights, whole.weights[:, chosen])
        some = volume[part.colours, part.slices]
        assert np.array_equal(own.extinction(own.unknowns(some)), some)
        assert np.array_equal(own.matrix.forward(own.unknowns(some)), seen[:, chosen])
        shown = everything[:, own.rows, :, part.colours]
        np.testing.assert_allclose(own.shown(own.unknowns(some), powers[:, part.colours]), shown, rtol=1e-6)
        mine = [(row, chosen.tolist().index(column)) for row, column in rejected if column in chosen]
        pixels += own.pixels(np.array(mine, np.int64).reshape(-1, 2)).tolist()
    assert sorted(pixels) == whole.pixels(rejected).tolist()


def test_pieces_come_in_order_and_share_the_work(monkeypatch: pytest.MonkeyPatch) -> None:
    assert job().pieces == ["unit-0"]
    assert job(**RAISED).pieces == ["level-1", "unit-0", "unit-1"]
    assert job(**RAISED, lamp_power=1.0).pieces == ["unit-0", "unit-1"]
    assert job(powers="coarse").pieces == ["level-1", "unit-0"]
    assert job(**LEVEL).pieces_of(1) == ["level-1", "unit-1"]
    monkeypatch.setattr("lightcube.backward.units.COARSEST", 3)
    assert job(**LEVEL).pieces == ["level-2", "level-1", "unit-0", "unit-1", "unit-2"]
    work = shares(job(**LEVEL))
    assert list(work) == job(**LEVEL).pieces
    assert sum(work[f"unit-{unit}"] for unit in range(3)) == pytest.approx(12)


@pytest.mark.parametrize("units", [0, -1, 4])
def test_units_that_cannot_be_are_refused(units: int) -> None:
    with pytest.raises(InputError, match="1 to 3 units"):
        job(units=units)


def test_fingerprints_name_what_changed() -> None:
    one = job()
    targets = one.targets
    darker = replace(targets, pictures=targets.pictures * np.float32(0.5))
    lighter = replace(targets, weights=targets.weight * np.float32(0.5))
    turned = replace(targets, rig=turntable(one.grid, [1.0, 2.0, 4.0], elevation_deg=35, picture_shape=(3, 5)))
    changes: list[tuple[Job, str]] = [
        (replace(one, targets=darker), "the pictures differ"),
        (replace(one, targets=lighter), "the weights differ"),
        (replace(one, targets=turned), "the lamps and screens differ"),
        (replace(one, grid=Grid((4, 7, 7), 0.7)), "voxels was 4 x 7 x 6 and is 4 x 7 x 7"),
        (job(hold_deg=1.5), "hold was 0 and is 1.5"),
        (replace(one, units=3), "units was 1 and is 3"),
        (job(max_extinction=2.0), "largest extinction was none and is 2"),
        (job(material=Material(clear=0.25)), "least extinction was 0 and is 0.25"),
    ]
    assert differences(fingerprint(one), fingerprint(job())) == []
    for other, sentence in changes:
        assert differences(fingerprint(one), fingerprint(other)) == [sentence]


class Forgetful(MemoryStore):
    """Tells of every checkpoint, and keeps only those that it is asked to."""

    def __init__(self, keeps: Callable[[str, int], bool]) -> None:
        super().__init__()
        self.kept: list[tuple[str, int]] = []
        self._keeps = keeps

    def keep(self, name: str, arrays: Arrays) -> None:
        iteration = len(arrays["history"])
        if self._keeps(name, iteration):
            self.kept.append((name, iteration))
            super().keep(name, arrays)


class Killed(BaseException):
    pass


@pytest.mark.parametrize("options", KINDS, ids=str)
def test_what_was_killed_goes_on_to_the_same_bits(options: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """A checkpoint after each iteration; a kill after every fourth one; as often as it takes."""
    monkeypatch.setattr("lightcube.backward.pieces.FIRST_CHECKPOINT_S", 0.0)
    monkeypatch.setattr("lightcube.backward.pieces.CHECKPOINT_S", 0.0)
    monkeypatch.setattr("lightcube.backward.pieces._PATIENCE", 0.0)
    monkeypatch.setattr("lightcube.backward.job.COARSE_PASSES", 9)
    made = job(**options)
    straight = solve_job(made)
    store, kills = Forgetful(lambda name, iteration: iteration % 3 != 1), 0
    for _ in range(100):
        calls = 0

        def killed(step: Step) -> None:
            nonlocal calls
            calls += 1
            if calls == 4:
                raise Killed

        try:
            finished = solve_job(made, store, killed)
            break
        except Killed:
            kills += 1
    assert kills > 2
    assert store.kept
    assert same(finished, straight)


@pytest.mark.parametrize("options", [{}, RAISED, LEVEL], ids=str)
def test_what_was_stopped_goes_on_to_the_same_bits(options: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lightcube.backward.job.COARSE_PASSES", 9)
    made, store = job(**options), MemoryStore()
    straight = solve_job(made)
    for _ in range(40):
        calls = 0

        def third(step: Step) -> bool:
            nonlocal calls
            calls += 1
            return calls == 3

        stopped = solve_job(made, store, third)
        if stopped.cube.status == "complete":
            break
        assert stopped.stop_reason == "callback"
        assert stopped.lower_bound is None
    assert same(stopped, straight)


def test_enough_is_enough_though_it_is_stopped_there() -> None:
    """Stopped at the very pass that was enough: the unit is finished, and the next one is not begun."""
    made = job(**RAISED, enough_db=20.0, lamp_power=1.0)
    straight = solve_job(made)
    assert straight.stop_reason == "enough"
    alone = MemoryStore()
    assert solve_piece(made, "unit-0", alone)
    found = alone.finished("unit-0")
    assert found is not None
    store = MemoryStore()
    stopped = solve_job(made, store, lambda step: step.iteration == len(found["history"]))
    assert stopped.cube.status == "interrupted"
    assert store.names() == {"unit-0"}
    assert same(solve_job(made, store), straight)


def test_units_in_any_order_are_the_run_in_one_go() -> None:
    made = job(**LEVEL)
    store = MemoryStore()
    for name in ("level-1", "unit-2", "unit-0"):
        assert solve_piece(made, name, store)
    missing = merged(made, store)
    assert missing.cube.status == "interrupted"
    assert np.any(missing.cube.extinction > 0, axis=(0, 2, 3)).all()  # the rest is the coarse start
    assert solve_piece(made, "unit-1", store)
    assert same(merged(made, store), solve_job(made))


def test_a_finished_piece_is_not_solved_again() -> None:
    made, store = job(**RAISED), MemoryStore()
    calls: list[Step] = []
    solve_job(made, store)
    solve_job(made, store, calls.append)
    assert calls == []


def test_progress_runs_over_all_units_and_shows_each_ones_own() -> None:
    made = job(**LEVEL, lamp_power=1.0)
    done: list[float] = []
    windows: list[tuple[slice, slice]] = []

    def look(step: Step) -> None:
        done.append(step.done)
        assert step.shown is not None
        assert step.shown().shape == made.targets.pictures[:, step.window[0], :, step.window[1]].shape
        windows.append(step.window)

    solve_job(made, callback=look)
    assert done == sorted(done)
    assert done[-1] == pytest.approx(1)
    rows = np.zeros(4, int)
    for first, last in {(window[0].start, window[0].stop) for window in windows}:
        rows[first:last] += 1
    assert np.all(rows == 1)


def test_few_units_where_memory_is_ample_and_more_where_it_is_not() -> None:
    targets, grid = some_targets((64, 64, 64), (64, 4), elevation_deg=0.0), Grid((64, 64, 64), 0.7)
    one = make_job(lit(targets, lamp_power=1.0), grid, units=1)
    assert make_job(lit(targets, lamp_power=1.0), grid).units == 1
    all_at_once = needs.job_memory(one)
    halved = make_job(lit(targets, lamp_power=1.0), grid, memory=all_at_once - 1)
    assert halved.units > 1
    assert needs.job_memory(halved) < all_at_once
    least = make_job(lit(targets, lamp_power=1.0), grid, memory=1)
    assert needs.job_memory(least) == min(needs.job_memory(replace(one, units=units)) for units in range(1, 65))


def test_memory_grows_with_the_cube_the_pictures_and_the_matrix() -> None:
    def needed(*arguments: Any) -> int:
        return needs.memory_needed(*arguments) - needs.PROGRAM

    small = needed(METHODS["display"], Grid((8, 8, 8)), (8, 8), 4)
    assert needed(METHODS["display"], Grid((16, 16, 16)), (8, 8), 4) > 4 * small
    assert needed(METHODS["display"], Grid((8, 8, 8)), (16, 16), 64) > 4 * small
    assert needed(METHODS["gauss-seidel"], Grid((8, 8, 8)), (8, 8), 4) > small
    assert needed(METHODS["gauss-seidel"], Grid((8, 8, 8)), (8, 8), 4, 35.0) > 2 * small


@pytest.mark.parametrize("kind", [LEVEL, RAISED], ids=["level", "raised"])
def test_a_cube_is_cast_from_where_it_lies(kind: dict[str, Any]) -> None:
    """Scoring a large cube must not take the memory of a second one."""
    extinction = solve_job(job(**kind)).cube.extinction
    assert np.shares_memory(columns_from_volume(extinction), extinction)


@pytest.mark.skipif(INTERPRETED, reason="interpreted kernels hold arrays of their own, and take their time")
@pytest.mark.parametrize(
    ("shape", "size", "elevation_deg", "count", "options"),
    [
        ((80, 80, 80), (80, 60), 0.0, 40, {}),
        ((80, 80, 80), (80, 60), 0.0, 40, {"units": 4}),
        ((90, 70, 50), (40, 30), 35.0, 20, {}),
        ((90, 70, 50), (40, 30), 35.0, 20, {"units": 3}),
        ((2, 90, 90), (2, 90), 0.0, 900, {"lamp_power": 1.0}),
        ((60, 60, 60), (50, 40), 0.0, 30, {"method": "sirt"}),
        ((60, 60, 60), (60, 40), 0.0, 30, {"method": "cgls", "units": 2}),
        ((30, 60, 60), (30, 60), 0.0, 60, {"method": "gauss-seidel"}),
        ((60, 60, 60), (30, 30), 35.0, 12, {"light": Light(13, 7, 0.01), "mat": Mat(), "hold_deg": 0.3}),
        ((60, 60, 60), (30, 30), 35.0, 12, {"light": Light(34)}),
        ((60, 60, 60), (60, 40), 0.0, 20, {"light": Light(8, 5), "units": 3}),
        ((60, 60, 60), (30, 30), 35.0, 12, {"light": Light(13), "material": DYED}),
        ((60, 60, 60), (30, 30), 35.0, 12, {"light": Light(13), "material": CLEAR}),
        ((60, 60, 60), (60, 40), 0.0, 20, {"light": Light(8, 5), "units": 3, "material": DYED}),
        ((80, 80, 80), (40, 30), 35.0, 6, {"material": CLEAR}),
    ],
    ids=str,
)
def test_memory_is_as_much_as_is_said(
    tmp_path: Path,
    shape: tuple[int, int, int],
    size: tuple[int, int],
    elevation_deg: float,
    count: int,
    options: dict[str, Any],
) -> None:
    made = make_job(**asked(some_targets(shape, size, elevation_deg, count), Grid(shape, 0.7), **options, passes=2))
    rows = SHAPE[0] if size[0] == shape[0] and not elevation_deg else 2
    grid = Grid(SHAPE, 0.7)
    small = replace(
        made, targets=asked(some_targets(SHAPE, (rows, 2), elevation_deg), grid, **options)["targets"], grid=grid
    )
    solve_job(small, open_partial(tmp_path / "small.zarr", small))  # numba compiles
    store = open_partial(tmp_path / "a.zarr", made)
    tracemalloc.start()
    try:
        solve_job(made, store)
        peak = tracemalloc.get_traced_memory()[1] + made.targets.pictures.nbytes + made.targets.weight.nbytes
    finally:
        tracemalloc.stop()
    # kernels have a few MB of their own
    assert needs.job_memory(made) - needs.PROGRAM == pytest.approx(peak, rel=0.25, abs=5e6)


@pytest.mark.parametrize("method", ["display", "cgls"])
def test_time_is_measured_on_a_smaller_cube(method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a pass of one second, a quarter grows with the multiply-adds and the rest with the numbers at hand."""
    made = job(method=method)
    clock = iter(np.arange(1000.0))
    monkeypatch.setattr("lightcube.backward.needs.time.perf_counter", lambda: next(clock))
    monkeypatch.setattr("lightcube.backward.needs._seconds_of_products", lambda problem: 0.25)
    assert needs.seconds_a_pass(made) == pytest.approx(1)
    products, numbers = needs._work(made, made.targets, made.grid)
    monkeypatch.setattr("lightcube.backward.needs._REHEARSED", products / 2)
    fewer = needs._work(made, *coarser(made.targets, made.grid, 1))
    assert needs.seconds_a_pass(made) == pytest.approx(0.25 * products / fewer[0] + 0.75 * numbers / fewer[1])


def test_a_look_takes_no_more_passes_at_smaller_sizes() -> None:
    assert job(passes=30).coarse_passes == 30
    assert job(passes=1000).coarse_passes == 100
    assert job(method="sirt", lamp_power=1.0, passes=None).coarse_passes == 100


def test_passes_count_the_coarse_ones_by_their_work() -> None:
    assert needs.expected_passes(job(passes=7)) == 7
    assert needs.expected_passes(job(**RAISED, passes=7)) == pytest.approx(7 + 7 / 8)
    assert needs.expected_passes(job(method="sirt", passes=None)) == 100
    assert needs.expected_passes(job(method="row-reduction", passes=None)) is None


@pytest.mark.parametrize("method", [method for method in METHODS if method != "display"])
def test_units_of_every_method_with_a_fixed_lamp(method: str) -> None:
    """Slabs are solved by themselves and together: with the same pictures they come to nearly the same."""
    targets, grid = some_targets(size=(4, 5), elevation_deg=0.0), Grid(SHAPE, 0.7)
    passes: dict[str, Any] = {} if method == "row-reduction" else {"passes": 400}
    one, two = (
        solve(lit(targets, lamp_power=1.0), grid, thin_recipe(method=method, dtype="float64", **passes), units=units)
        for units in (1, 2)
    )
    assert np.allclose(one.cube.extinction, two.cube.extinction, atol=2e-3)
    assert two.residuals[-1] == pytest.approx(one.residuals[-1], rel=1e-2)
    assert one.undetermined == two.undetermined


@pytest.mark.parametrize("method", METHODS)
def test_what_there_is_of_a_stopped_job_is_a_cube(method: str) -> None:
    """Also where a checkpoint has arrays that are called as the figures of a finished piece are."""
    targets, grid = some_targets(size=(4, 5), elevation_deg=0.0), Grid(SHAPE, 0.7)
    made = make_job(**asked(targets, grid, method=method, lamp_power=1.0, units=2, passes=3))
    store = MemoryStore()
    stopped = solve_job(made, store, lambda step: True)
    assert stopped.cube.status == "interrupted"
    assert stopped.rejected.shape == (0, 4)
    assert same(solve_job(made, store), solve_job(made))


def test_a_finished_piece_is_a_volume() -> None:
    """Of a slab of the cube, and of all of it at half the size."""
    made, store = job(**LEVEL), MemoryStore()
    cube = solve_job(made, store).cube
    half, slab = (store.finished(name) for name in ("level-1", "unit-1"))
    assert half is not None
    assert half["extinction"].shape == (3, 2, 4, 3)
    assert slab is not None
    assert np.array_equal(slab["extinction"], cube.extinction[:, made.parts[1].slices])


def test_progress_of_what_is_never_enough_runs_to_its_end() -> None:
    """Few points first, then all: what is done is told in order and to the end, however far off enough is."""
    made = job(light=Light(5, 4), passes=30, enough_db=3000.0)
    assert [phase.passes for phase in made.phases("unit-0")] == [10, 20]
    done: list[float] = []
    solution = solve_job(made, callback=lambda step: done.append(step.done))
    assert done == sorted(done)
    assert done[-1] == pytest.approx(1)
    assert len(solution.residuals) == 30
