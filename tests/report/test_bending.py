"""What the report and `info` say of glass is what the rig has, and its command makes that rig again, bit for bit."""

from typing import Any

import numpy as np

from lightcube.optics.cube import Cube
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid
from lightcube.optics.refraction import bent
from lightcube.optics.rig import turntable
from lightcube.report import bending

GRID = Grid((6, 8, 8), 2.5)


def in_glass(glass: Glass, **more: Any) -> Cube:
    rig = turntable(GRID, [20.0, 130.0, 250.0], elevation_deg=20, picture_shape=(6, 10), glass=glass, **more)
    return Cube(np.zeros((3, *GRID.shape), np.float32), GRID, rig)


def test_facts_are_those_of_the_rig() -> None:
    rig = in_glass(Glass(1.5, "cylinder")).rig
    known = bending.facts(rig)
    assert known["glass"], known["ior"] == ("cylinder", [1.5])
    sine = np.sin(np.radians(20)) / 1.5
    np.testing.assert_allclose(known["elevation_inside_deg"], 2 * [np.degrees(np.arcsin(sine))])
    np.testing.assert_allclose(known["screen_behind_mm"], 2 * [30.0])  # three radii
    np.testing.assert_allclose(known["focus_mm"], 13.36, rtol=0.05)
    assert known["lit_part"] == np.mean(bent(rig).through > 0)
    assert "bottom" not in known
