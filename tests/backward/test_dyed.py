"""Solving for amounts of dyes: by any method, under any lamps, and what is in the clear material beside them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lightcube.backward.dyed import _apart, _behind, _clear
from lightcube.backward.job import differences, fingerprint
from lightcube.backward.problem import pose
from lightcube.backward.recipe import Recipe, from_plain, recipe_of
from lightcube.backward.solving import make_job, solve
from lightcube.errors import InputError
from lightcube.forward.casting import cast
from lightcube.io import read_dyes
from lightcube.optics.arrays import Volume
from lightcube.optics.cube import Cube
from lightcube.optics.dyes import Dyes
from lightcube.optics.gamut import nearest
from lightcube.optics.grid import Grid
from lightcube.optics.law import shown_light
from lightcube.optics.light import Light
from lightcube.optics.material import Material
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.pictures.targets import Targets
from lightcube.projection.inked import Inked
from lightcube.scoring.metrics import score
from lightcube.solvers import METHODS, find_method
from lightcube.solvers.contract import Lighting, Wanted
from tests.backward.test_job import LEVEL, SHAPE, job, some_targets
from tests.backward.test_stages import known, stage
from tests.helpers.recipes import asked

GRID = Grid(SHAPE, 0.7)
DYES = Dyes(
    ("cyan", "magenta", "yellow", "black"),
    np.array([[0.9, 0.1, 0.03], [0.1, 0.6, 0.3], [0.02, 0.1, 0.8], [0.9, 0.9, 0.9]]),
    limit=np.array([1, 0.7, 1, 0.4]),
    base=np.array([0.01, 0.02, 0.03]),
)


def amounts_of(grid: Grid, seed: int) -> Volume:
    """Any within the limits."""
    shares = np.random.default_rng(seed).random((4, *grid.shape), np.float32)
    return shares * DYES.limit.astype(np.float32)[:, None, None, None]


AREA: dict[str, Any] = {"light": Light(3, 3)}


@pytest.mark.parametrize(
    "options",
    [{}, AREA, {**LEVEL, **AREA}, {**AREA, "hold_deg": 2.0, "powers": "shared"}, {**LEVEL, "powers": "coarse"}],
    ids=str,
)
@pytest.mark.parametrize("dyes", [DYES, replace(DYES, kind="ink"), replace(DYES, base=np.zeros(3))])
def test_what_is_solved_lies_within_the_limits_and_is_what_it_is_mixed_of(dyes: Dyes, options: dict[str, Any]) -> None:
    made = job(**options, material=Material(dyes=dyes))
    cube = solve(made.targets, made.grid, made.recipe, units=made.units).cube
    assert cube.amounts is not None
    assert cube.dyes == dyes
    assert np.all(cube.amounts >= 0)
    assert np.all(cube.amounts <= dyes.limit[:, None, None, None].astype(np.float32))
    assert np.any(cube.amounts > 0.05)
    np.testing.assert_array_equal(dyes.in_block(GRID).mixed(cube.amounts), cube.extinction)


@pytest.mark.parametrize("method", METHODS)
def test_any_method_solves_for_amounts(method: str) -> None:
    """Nearer to pictures of a cube of dyes than a clear block; pixels and powers are told as of colours."""
    grid = Grid((3, 3, 4), 0.7)
    rig = turntable(grid, [15.0, 75.0, 130.0], elevation_deg=0.0, picture_shape=(3, 3))
    planted = Cube(DYES.mixed(amounts_of(grid, 0) / 2), grid, rig)
    targets = Targets(np.stack(list(cast(planted, light="thin"))), rig)
    said = asked(targets, grid, method=method, passes=40, lamp_power=1.0, material=Material(dyes=DYES))
    solution = solve(**said)
    clear = replace(planted, extinction=0 * planted.extinction)
    reached, before = (score(each, targets)["thin_psnr_mean"] for each in (solution.cube, clear))
    assert reached > before + (0 if method == "row-reduction" else 10)  # which keeps no limits while it solves
    assert solution.cube.powers.shape == (3, 3)
    assert np.all((solution.rejected >= 0) & (solution.rejected < (3, 3, 3, 3)))


def test_amounts_that_were_planted_are_seen_again_as_well_as_colours_are() -> None:
    """On the pictures' own views; what is inside is not determined, nor is it by colours."""
    grid = Grid((6, 8, 7), 0.7)
    rig = turntable(grid, [20.0, 80.0, 140.0, 200.0], elevation_deg=35.0, picture_shape=(4, 5))
    planted = Cube(DYES.mixed(amounts_of(grid, 0) ** 4), grid, rig)
    targets = Targets(np.stack(list(cast(planted, light="area"))), rig)
    reached = []
    for material in (None, Material(dyes=DYES)):
        cube = solve(targets, grid, Recipe(material=material, light=Light(5, 5), passes=150)).cube
        reached.append(score(cube, targets)["psnr_mean"])
    assert min(reached) > 40
    assert reached[1] > reached[0] - 3


def rooms() -> list[tuple[Grid, Rig]]:
    made = stage("a shadow that fades, of a point")
    level = turntable(GRID, [20.0, 70.0], picture_shape=(4, 5))
    raised = turntable(GRID, [20.0], elevation_deg=35, picture_shape=(3, 5))
    return [(made.grid, made.rig()), (GRID, level), (GRID, raised)]


@pytest.mark.parametrize("room", range(3))
def test_a_method_is_asked_for_what_a_cube_in_its_clear_material_casts(room: int) -> None:
    """Amounts through the matrix of dyes, under the light that a method is told of, show what the cube casts."""
    grid, rig = rooms()[room]
    amounts = amounts_of(grid, 3)
    powers = np.random.default_rng(4).uniform(0.5, 2, (len(rig.pairs), 3))
    cube = Cube(DYES.mixed(amounts), grid, rig, powers, amounts=amounts, dyes=DYES)
    wanted = np.stack(list(cast(cube, light="thin")))
    targets = Targets(np.full_like(wanted, 0.5), rig, rig.inside.astype(np.float32))
    problem = pose(targets, grid, Recipe(light=Light.thin(), material=Material(dyes=DYES)))
    apart = _apart(problem.wanted((powers, powers)))
    told = _behind(_clear(problem.matrix, apart, DYES.base), apart, find_method("display"))
    inked = Inked(problem.matrix, DYES.extinction * DYES.limit[:, None])
    absorbance = inked.forward(problem.unknowns(amounts))
    assert told.lighting.mixture is not None
    of_views = told.lamp_bounds[0][told.lighting.lamp]
    shown = shown_light(told.lighting.mixture, of_views, absorbance, rig.picture_shape)
    of_colours = shown.reshape(3, *wanted.shape[:3]).transpose(1, 2, 3, 0) * rig.inside[..., None]
    np.testing.assert_allclose(of_colours, wanted, rtol=2e-4)


def test_rounding_makes_no_shadow_stronger_than_whole() -> None:
    clear = np.random.default_rng(0).random((300, 40), np.float32)
    wanted = Wanted(np.ones((300 * 40, 1), np.float32), lighting=Lighting(np.zeros(300, int)))
    behind = _behind(clear, wanted, find_method("display")).lighting.mixture
    assert behind is not None
    np.testing.assert_allclose(behind.light * behind.shadow, clear, rtol=1e-5)


def test_a_stage_is_solved_in_amounts() -> None:
    cube, targets = known(stage("two coloured lamps"))
    solved = solve(**asked(targets, cube.grid, passes=60, material=Material(dyes=DYES))).cube
    clear = replace(solved, extinction=0 * solved.extinction, amounts=None, dyes=None)
    assert score(solved, targets)["psnr_mean"] > score(clear, targets)["psnr_mean"] + 3


def test_smaller_cubes_are_of_the_same_dyes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Films are as far apart in a coarse cube as in the cube itself: its voxels are no darker."""
    monkeypatch.setattr("lightcube.backward.units.COARSEST", 3)
    inks = replace(DYES, kind="ink")
    seen: list[Cube] = []
    made = make_job(**asked(some_targets(), GRID, passes=4, material=Material(dyes=inks)))
    solve(made.targets, GRID, made.recipe, callback=lambda step: seen.append(step.cube()) if step.cube else None)
    most = Material(dyes=inks).most(GRID)
    assert {each.grid.shape for each in seen} == {(1, 2, 2), (2, 4, 3), SHAPE}
    assert all(each.extinction.min() >= inks.base.min() / 0.7 * 0.999 for each in seen)
    assert all(each.extinction.max() <= most * 1.001 for each in seen)


def test_it_starts_from_the_amounts_of_a_cube_or_those_nearest_to_it() -> None:
    first = solve(**asked(some_targets(), GRID, passes=20, material=Material(dyes=DYES))).cube
    for start in (first, replace(first, amounts=None, dyes=None)):
        made = make_job(**asked(some_targets(), GRID, passes=2, material=Material(dyes=DYES), start=start))
        assert made.start is not None
        np.testing.assert_allclose(DYES.mixed(made.start), first.extinction, atol=2e-3)
    assert solve(**asked(some_targets(), GRID, passes=2, start=first)).cube.dyes is None


def test_a_recipe_of_dyes_comes_back_and_is_another_job() -> None:
    recipe = Recipe(material=Material(dyes=DYES))
    assert from_plain(recipe.plain()).material == recipe.material
    assert from_plain(recipe.plain()).plain() == recipe.plain()
    made, other = (job(material=Material(dyes=dyes)) for dyes in (DYES, replace(DYES, limit=np.ones(4))))
    assert differences(fingerprint(made), fingerprint(other)) == ["the dyes differ"]
    assert recipe_of(solve(made.targets, made.grid, made.recipe).cube).dyes == DYES


def test_colours_of_the_same_dyes_are_one_unit() -> None:
    with pytest.raises(InputError, match="in 1 to 1 units, not in 2"):
        job(units=2, material=Material(dyes=DYES))


def test_dyes_of_other_colours_are_refused() -> None:
    two = Dyes(("a", "b"), DYES.extinction[:2, :2])
    with pytest.raises(InputError, match="dyes that absorb 2 colours make no pictures of 3"):
        job(material=Material(dyes=two))


def test_dyes_that_ship_make_better_pictures_solved_for_than_converted() -> None:
    dyes, grid = read_dyes("polyjet"), Grid((8, 8, 8), 2.0)
    rig = turntable(grid, [20.0, 100.0, 190.0, 290.0], elevation_deg=35.0, picture_shape=(4, 4))
    targets = Targets(np.random.default_rng(1).uniform(0.2, 1, (4, 4, 4, 3)).astype(np.float32), rig)
    free = solve(targets, grid, Recipe(passes=60, light=Light(5, 5))).cube
    converted = replace(free, extinction=dyes.mixed(nearest(free.extinction, dyes)))
    dyed = solve(targets, grid, Recipe(passes=60, light=Light(5, 5), material=Material(dyes=dyes))).cube
    assert score(dyed, targets)["psnr_mean"] > score(converted, targets)["psnr_mean"] + 4
