"""Solving stacks of films: at random from a seed, for exact means, for films that lie off, no darker than ink."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import lightcube as lc
from lightcube.backward.job import Job
from lightcube.backward.needs import job_memory
from lightcube.backward.store import MemoryStore
from lightcube.errors import InputError
from lightcube.optics.attenuator import Films, attenuator
from lightcube.optics.material import Material
from lightcube.optics.moves import Move, misplaced
from lightcube.optics.stack import Stack
from lightcube.pictures.fitting import targets_of
from lightcube.scoring.metrics import score, score_pictures

NAMES = ["one", "two"]
#: Three films before two pictures of 4 x 6 pixels.
FILMS = Films(3, 8.0, size_mm=30.0, pixels=6)


def wanted(films: Films = FILMS, count: int = 2, **more: Any) -> tuple[lc.Targets, Stack]:
    """Random pictures of a stack."""
    names = [f"p{number}" for number in range(count)]
    stage = attenuator(names, films, 1.5, **more)
    rig = stage.rig()
    random = np.random.default_rng(3)
    shape = (count, *rig.picture_shape, 3)
    assert isinstance(stage.grid, Stack)
    return lc.Targets(random.uniform(0.05, 0.9, shape).astype(np.float32), rig, names=tuple(names)), stage.grid


def psnr(cube: lc.Cube) -> float:
    return float(score(cube)["psnr_mean"])


@pytest.fixture(scope="module")
def solved() -> lc.Cube:
    return lc.solve(*wanted(), lc.Recipe(passes=60)).cube


def test_films_show_unrelated_pictures_as_a_wall_shows_them(solved: lc.Cube) -> None:
    assert psnr(solved) > 45
    assert score(solved)["thin_psnr_mean"] < 25  # their beams one by one are another matter


def test_what_is_told_is_the_exact_mean(solved: lc.Cube) -> None:
    exact = score_pictures(lc.cast(solved), targets_of(solved))
    assert psnr(solved) == pytest.approx(exact["psnr_mean"], abs=1e-3)


def test_the_same_seed_gives_the_same_bits_and_another_one_other_films(solved: lc.Cube) -> None:
    again, other = (lc.solve(*wanted(), lc.Recipe(passes=60, seed=seed)).cube for seed in (0, 1))
    np.testing.assert_array_equal(again.extinction, solved.extinction)
    assert np.abs(other.extinction - solved.extinction).max() > 0.01
    assert psnr(other) > 40


def test_a_solver_that_was_stopped_goes_on_to_the_same_bits(solved: lc.Cube) -> None:
    store, targets_grid = MemoryStore(), wanted()
    stopped = lc.solve(*targets_grid, lc.Recipe(passes=60), store=store, callback=lambda step: step.iteration >= 7)
    assert stopped.cube.status == "interrupted"
    whole = lc.solve(*targets_grid, lc.Recipe(passes=60), store=store)
    np.testing.assert_array_equal(whole.cube.extinction, solved.extinction)


def test_clear_films_cannot_be_told_apart_and_stay_poor() -> None:
    """Why films start at random: cells of a pixel that begin alike end alike."""
    targets, stack = wanted(count=4)
    clear = lc.Cube(np.zeros((3, *stack.shape), np.float32), stack, targets.rig)
    from_clear, at_random = (
        psnr(lc.solve(targets, stack, lc.Recipe(passes=60), start=start).cube) for start in (clear, None)
    )
    assert from_clear < at_random - 5


@pytest.mark.parametrize("density", [0.3, 1.0])
def test_films_are_no_darker_than_ink_can_be(density: float) -> None:
    most = density * np.log(10)
    cube = lc.solve(*wanted(), lc.Recipe(passes=25, material=Material(most, "voxel"))).cube
    darkest = float(cube.extinction.max()) * cube.grid.voxel_mm
    assert darkest <= most * (1 + 1e-6)
    assert darkest > 0.9 * most


def test_pictures_stand_films_that_lie_off_where_that_was_asked_for(solved: lc.Cube) -> None:
    """At places that were not asked for; what it costs is the pictures as designed."""
    held = lc.solve(*wanted(), lc.Recipe(passes=25, assembly_mm=0.5)).cube
    off = np.zeros((6, 3, 3))
    off[..., :2] = 0.5 * np.random.default_rng(77).standard_normal((6, 3, 2))

    def seen(cube: lc.Cube) -> float:
        rigs = (misplaced(cube.rig, cube.grid, each) for each in off)  # type: ignore[arg-type]
        return float(np.mean([score_pictures(lc.cast(cube, rig), targets_of(cube))["psnr_mean"] for rig in rigs]))

    assert seen(held) > seen(solved) + 1
    assert psnr(held) < psnr(solved)


def test_films_that_are_moved_show_pictures_under_one_lamp() -> None:
    moves = [None, Move("slid", shift_mm=((0, 0), (5, 0), (0, 5)))]
    targets, stack = wanted(replace(FILMS, gap_mm=0.0), moves=moves)
    assert len(targets.rig.lamps.names) == 1
    assert psnr(lc.solve(targets, stack, lc.Recipe(passes=60)).cube) > 35


def test_stacks_are_solved_at_their_own_size_at_once() -> None:
    """Smaller films would be other films: they have no coarser levels, nor passes with few points."""
    targets, stack = wanted(replace(FILMS, pixels=60, size_mm=300.0))
    job = Job(targets, stack, lc.Recipe(passes=10))
    assert max(stack.shape) > 100
    assert job.pieces == ["unit-0"]
    assert len(job.phases("unit-0")) == 1


def test_cubes_have_no_films_that_lie_off() -> None:
    grid = lc.Grid((3, 5, 5))
    rig = lc.turntable(grid, [10, 50], elevation_deg=30, picture_shape=(3, 3))
    targets = lc.Targets(np.full((2, 3, 3, 3), 0.5, np.float32), rig, names=("a", "b"))
    with pytest.raises(InputError, match="a cube has none"):
        lc.solve(targets, grid, lc.Recipe(passes=2, assembly_mm=0.1))


@pytest.mark.parametrize("wrong", [{"seed": -1}, {"assembly_mm": -0.1}, {"assembly_mm": 1e308}])
def test_recipes_of_films_are_bounded(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        lc.Recipe(**wrong)


def test_films_are_clear_where_no_light_goes_through(solved: lc.Cube) -> None:
    """A printer need not print them, and what is random there would be ink for nothing."""
    matrix = lc.Projector(solved.grid, solved.rig.squared(1.0))
    met = matrix.adjoint(np.ones((matrix.shape[0], 1))).reshape(*solved.grid.shape[1:], -1).transpose(2, 0, 1) > 0
    assert 0.05 < np.mean(~met) < 0.8
    assert np.all(solved.extinction[:, ~met] == 0)
    assert np.mean(solved.extinction[:, met] > 0) > 0.5


def test_memory_counts_all_rectangles_of_a_pixel() -> None:
    """Lamps anywhere cut pixels into many; on a lattice they are as many as cells."""
    aslant = tuple(lc.Lamp(f"p{k}", direction=(0.31 - 0.5 * k, 0.17 + 0.1 * k, -1.0)) for k in range(2))
    films = replace(FILMS, pixels=48, size_mm=240.0)
    few, many = (Job(*wanted(films, lamps=lamps), lc.Recipe(passes=5)) for lamps in ((), aslant))
    parts = [lc.Projector(job.grid, job.targets.rig.squared(1.0)).parts for job in (few, many)]
    assert parts[1] > 5 * parts[0]
    more = job_memory(many) - job_memory(few)
    beams = 2 * 48 * 32 * (parts[1] - parts[0])
    assert 12 * beams < more < 100 * beams
