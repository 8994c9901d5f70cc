"""What a fading shadow cannot show: no cube casts anything darker, and nothing brighter is called out of reach."""

from dataclasses import replace

import numpy as np
import pytest

from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.pictures.targets import Targets
from lightcube.planning.reachable import least_light, out_of_reach, sentences, too_bright
from tests.helpers.thin import cast


def faded(lamps: int = 1, falloff_mm: float = 60.0) -> tuple[Stage, Targets]:
    """A stage with fading shadows and random shadows of a random cube on it."""
    grid = Grid((3, 5, 7), 2.0)
    lit = tuple(Lamp(str(i), position_mm=(-60.0, 9.0 * i, 5.0), colour=(1, 0.5, 0.25 * i)) for i in range(lamps))
    wall = Screen("wall", (40, 0, 0), (16, 12), 2.0, reach_mm=20, falloff_mm=falloff_mm, cosine=True)
    names = tuple(lamp.name for lamp in lit)
    stage = Stage(grid, lit, (wall,), tuple(Shot(str(i), "wall", names, i) for i in range(2)), stops_deg=(10.0, 130.0))
    rig = stage.rig()
    random = np.random.default_rng(lamps)
    cube = Cube(
        random.gamma(0.5, 0.3, (3, *grid.shape)).astype(np.float32),
        grid,
        rig,
        random.uniform(0.5, 3, (len(rig.pairs), 3)),
    )
    return stage, Targets(np.stack(list(cast(cube, rig, cube.powers))), rig)


@pytest.mark.parametrize("lamps", [1, 2])
def test_what_a_cube_casts_is_within_reach(lamps: int) -> None:
    _, targets = faded(lamps)
    assert np.all(targets.pictures >= least_light(targets) * (1 - 1e-5))
    assert np.all(out_of_reach(targets) == 0)
    assert sentences(targets) == []


def test_an_opaque_cube_shows_the_least_light() -> None:
    """Under one lamp the bound is met: a black cube beside which a pixel is as bright as the lamp."""
    stage, targets = faded()
    rig = targets.rig
    black = Cube(np.full((3, *stage.grid.shape), 1e3, np.float32), stage.grid, rig)
    shown = np.stack(list(cast(black, rig, black.powers)))
    least = least_light(replace(targets, pictures=shown))
    behind = (shown[0, ..., 0] < 0.5) & (shown[0, ..., 0].max() > 0.9)
    assert np.any(behind)
    assert np.allclose(shown[0, ..., 0][behind], least[0, ..., 0][behind], rtol=1e-3)


def test_black_beside_white_is_out_of_reach() -> None:
    _, targets = faded()
    wanted = np.ones_like(targets.pictures)
    wanted[0, 2:4, 3:5] = 0.001
    parts = out_of_reach(replace(targets, pictures=wanted))
    assert parts[0] == pytest.approx(4 * 2 / (6 * 8 * 3), abs=1e-6)  # the lamp has no blue
    assert parts[1] == 0
    assert any("picture '1' is darker" in said for said in sentences(replace(targets, pictures=wanted)))


def test_a_veil_has_no_shadow() -> None:
    """Behind the darkest cube it is left, and under the brightest pixel it lies too."""
    grid = Grid((3, 5, 7), 2.0)
    rig = turntable(grid, [10.0, 130.0], picture_shape=(3, 5), veil=0.25)
    wanted = np.full((2, 3, 5, 3), 0.5, np.float32)
    wanted[1, :, 2] = 0.09  # a lamp that makes 0.5 leaves 0.25 / 1.25 of it
    targets = Targets(wanted, rig)
    np.testing.assert_allclose(least_light(targets), 0.1, rtol=1e-6)
    np.testing.assert_allclose(out_of_reach(targets), [0, 1 / 5])
    assert sentences(targets)[0].startswith("20% of picture '2' is darker than the veil over it allows")


def test_without_fading_everything_is_within_reach() -> None:
    _, targets = faded(falloff_mm=np.inf)
    wanted = np.zeros_like(targets.pictures)
    wanted[..., 1] = 1
    assert np.all(out_of_reach(replace(targets, pictures=wanted)) == 0)


def test_brighter_than_all_lamps_is_out_of_reach() -> None:
    """The bound is what the lamps show at their largest power where no cube stands."""
    stage, targets = faded(2)
    rig = targets.rig
    clear = Cube(
        np.zeros((3, *stage.grid.shape), np.float32),
        stage.grid,
        rig,
        np.repeat(rig.lamps.most[rig.pairs[:, 1], None], 3, axis=1),
    )
    most = np.stack(list(cast(clear, rig, clear.powers)))
    assert np.all(too_bright(replace(targets, pictures=most)) == 0)
    brighter = most * np.where(np.arange(6) < 2, 1.05, 0.95)[:, None, None].astype(np.float32)
    assert np.allclose(too_bright(replace(targets, pictures=brighter)), 2 / 6)
    assert "is brighter than" in sentences(replace(targets, pictures=brighter))[0]
