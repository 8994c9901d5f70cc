"""The stages of examples/stages: each brings back the shadows of a known cube, and can be solved as it is."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lightcube.backward.solving import solve
from lightcube.io import read_stage, read_stage_targets
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.stage import Stage
from lightcube.pictures.targets import Targets
from lightcube.planning.feasibility import doubtful, impossible
from lightcube.scoring.metrics import score
from tests.conftest import INTERPRETED
from tests.helpers.areas import divided
from tests.helpers.thin import cast, play, thin_recipe

STAGES = sorted((Path(__file__).parents[2] / "examples" / "stages").glob("*.toml"))
#: Voxels along the cube's longest side here: fewer where nothing is compiled.
SIDE = 5 if INTERPRETED else 12


def smaller(stage: Stage, side: int) -> Stage:
    """The same room with larger voxels and pixels, and as many stops as fill such a cube as the example's fill it."""
    coarser = max(stage.grid.shape) / side
    nz, ny, nx = (max(1, round(count / coarser)) for count in stage.grid.shape)
    grid = Grid((nz, ny, nx), stage.grid.voxel_mm * coarser)
    screens = tuple(replace(screen, pitch_mm=screen.pitch_mm * coarser) for screen in stage.screens)
    few = stage.shots[:: max(1, len(stage.shots) // 8)]
    return replace(stage, grid=grid, screens=screens, shots=few)


def known(stage: Stage, lamp_samples: int = 1) -> tuple[Cube, Targets]:
    """A random cube on a stage, under lamps of random powers, and its shadows."""
    random = np.random.default_rng(0)
    rig = divided(stage.rig(), lamp=lamp_samples)
    extinction = random.gamma(0.3, 4.0 / (0.3 * stage.grid.size_mm[0]), (3, *stage.grid.shape)).astype(np.float32)
    powers = random.uniform(0.8, 2.0, (len(rig.pairs), 3))
    cube = Cube(extinction, stage.grid, rig, powers)
    shadows = np.stack(list(cast(cube, rig, powers)))
    inside = rig.inside.astype(np.float32)
    return cube, Targets(shadows, rig, inside)


def test_there_is_a_stage_for_each_way_to_light_a_cube() -> None:
    assert {path.stem for path in STAGES} == {
        *("two-screens", "three-screens", "circling-lamp", "point-lamp", "hemisphere", "coloured-lamps"),
        *("soft-lamp", "fading"),
        *(f"glass-{form}" for form in ("block", "cylinder", "sphere", "bath", "round-bath")),
    }


@pytest.mark.parametrize("path", STAGES, ids=lambda path: path.stem)
def test_the_shadows_of_a_known_cube_come_back(path: Path) -> None:
    stage = smaller(read_stage(path)[0], SIDE)
    cube, targets = known(stage, 3 if path.stem == "soft-lamp" else 1)
    assert np.mean(targets.pictures < 0.5) > 0.1  # there are shadows
    solved = solve(targets, stage.grid, thin_recipe(passes=100 if INTERPRETED else 400))
    scores = score(solved.cube, targets)
    assert scores["thin_psnr_min"] >= 50
    assert not np.allclose(solved.cube.extinction, cube.extinction, atol=1e-3)  # other cubes have the same shadows


@pytest.mark.parametrize("path", STAGES, ids=lambda path: path.stem)
def test_nothing_is_wrong_with_it(path: Path) -> None:
    stage, targets = read_stage_targets(path)
    assert impossible(stage) == doubtful(stage) == []
    assert len(targets) == len(stage.shots) == len(set(targets.names))


def test_a_stage_is_played_at_any_angle() -> None:
    stage = smaller(read_stage(next(path for path in STAGES if path.stem == "two-screens"))[0], SIDE)
    cube, targets = known(stage)
    angles_deg = np.unique(targets.angles_deg)
    assert len(play(cube, angles_deg)) == 2 * len(angles_deg)
    for picture, angle_deg in enumerate(targets.angles_deg):
        shown = play(cube, [angle_deg])
        assert any(np.allclose(each, targets.pictures[picture], atol=1e-6) for each in shown)
