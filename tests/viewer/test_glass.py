"""The page bends light as `cast` does: its model to single precision, its graphics to half a display level."""

from typing import Any

import numpy as np
import pytest

from lightcube.optics.cube import Cube
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid
from lightcube.optics.refraction import bent
from lightcube.optics.setups import turntable
from tests.helpers.areas import THIN, averaged
from tests.helpers.paging import Evaluate, asked, nearly, paged
from tests.viewer.test_shadows import OFF, Run, shadows, worst

#: Unequal sides, and angles that no seam of a block's faces, nor its own symmetry, meets.
GRID = Grid((7, 6, 8), 1.3)
STOPS, ANGLES = [12.0, 100.0, 241.0], [12.0, 57.3, 203.7]
BODIES: dict[str, tuple[Glass, float]] = {
    "block": (Glass(1.5), 33.0),
    "level block": (Glass(1.6), 0.0),
    "blocked": (Glass(1.5, bottom="blocked"), 52.0),
    "bath": (Glass(1.4, "bath"), 40.0),
    "cylinder": (Glass(1.5, "cylinder"), 20.0),
    "weak cylinder": (Glass(1.3, "cylinder"), 0.0),
    "round bath": (Glass(1.5, "round-bath", bath_mm=15.1), -25.0),
    "sphere": (Glass(1.5, "sphere"), 20.0),
    "level sphere": (Glass(1.5, "sphere"), 0.0),
    "weak sphere": (Glass(1.33, "sphere"), 31.0),
    "three indices": (Glass((1.45, 1.5, 1.6), "cylinder"), 20.0),
    "three of a block": (Glass((1.45, 1.5, 1.6)), 33.0),
}


def in_glass(name: str, **more: Any) -> Cube:
    """A random cube behind which pictures stand that are wider than what is lit."""
    glass, elevation_deg = BODIES[name]
    screen_mm = 40.0 if glass.iors[0] < 1.4 else None
    rig = turntable(
        GRID, STOPS, elevation_deg=elevation_deg, picture_shape=(7, 10), glass=glass, screen_mm=screen_mm, **more
    )
    random = np.random.default_rng(5)
    extinction = random.gamma(0.4, 0.15, (3, *GRID.shape)).astype(np.float32)
    return Cube(extinction, GRID, rig, random.uniform(0.5, 1.2, (len(rig.pairs), 3)))


@pytest.mark.parametrize("name", BODIES)
def test_beams_are_those_of_python(evaluate: Evaluate, name: str) -> None:
    """Where they enter and leave, and their light beside the glass and through it."""
    cube = in_glass(name)
    _, _, data = paged(cube)
    expression = """argument.angles_deg.flatMap((angle) => exposures(scene, angle)).flatMap(({ views, raster }) =>
      views.map((view) => Array.from({ length: raster[0] * raster[1] }, (_, i) =>
        bentBeam(view, beamOf(view, Math.floor(i / raster[1]), i % raster[1], raster).pixel))))"""
    found = asked(evaluate, data, expression, angles_deg=ANGLES)
    rig, _ = cube.rig.at(ANGLES)
    wanted = bent(rig)
    beams = [beam for view in found for beam in view]
    nearly([beam["beside"] for beam in beams], wanted.beside.ravel(), 1e-9)
    nearly([beam["through"] for beam in beams], wanted.through.ravel(), 1e-9)
    lit = wanted.through.ravel() > 0
    assert np.mean(lit) > 0.1
    for field, places in (("enters", wanted.enters_mm), ("leaves", wanted.leaves_mm)):
        nearly(np.array([beam[field] for beam in beams])[lit], places.reshape(-1, 3)[lit], 1e-9)


@pytest.mark.parametrize("whole", [False, True])
@pytest.mark.parametrize("name", BODIES)
def test_the_model_casts_what_python_does(evaluate: Evaluate, name: str, whole: bool) -> None:
    cube = in_glass(name)
    _, packed, data = paged(cube)
    expression = """argument.angles_deg.flatMap((angle) => exposures(scene, angle, argument.whole))
      .map((exposure) => castPicture(cube, exposure, [[0, 0]]))"""
    found = asked(evaluate, data, expression, angles_deg=ANGLES, whole=whole)
    for each, picture in zip(found, averaged(packed.cube, ANGLES, THIN, whole=whole), strict=True):
        nearly(np.reshape(each, picture.shape), picture, 4e-6)
        assert np.ptp(picture) > 0.2


@pytest.mark.parametrize("name", BODIES)
def test_the_wall_shows_what_python_casts(evaluate: Run, name: str) -> None:
    cube = in_glass(name)
    thin = shadows(evaluate, cube, ANGLES, beams="THIN")
    assert worst(thin, cube, ANGLES, points=THIN) <= OFF
    assert worst(shadows(evaluate, cube, ANGLES[:1]), cube, ANGLES[:1]) <= OFF


def test_only_a_bottom_that_lets_no_light_out_is_barred(evaluate: Evaluate) -> None:
    """The block's own edges are drawn anyway."""
    edges = {}
    for name in ("block", "blocked"):
        _, _, data = paged(in_glass(name))
        edges[name] = asked(evaluate, data, "bodyEdges(scene, exposures(scene, 0)[0])")
    assert edges["block"] == []
    bars = np.array(edges["blocked"])
    half = np.array(in_glass("blocked").grid.size_mm)[::-1] / 2
    assert len(bars) > 3
    np.testing.assert_allclose(bars[..., 2], -half[2])
    assert np.all(np.abs(bars[..., :2]) <= half[:2] + 1e-9)
    np.testing.assert_allclose(np.ptp(bars[..., 1], axis=1), 2 * half[1])
