"""What the report and `info` say of glass is what the rig has."""

from typing import Any

import numpy as np
import pytest

from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid
from lightcube.optics.refraction import bent
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.report import bending

GRID = Grid((6, 8, 8), 2.5)


def in_glass(glass: Glass | None, **more: Any) -> Rig:
    return turntable(GRID, [20.0, 130.0, 250.0], elevation_deg=20, picture_shape=(6, 12), glass=glass, **more)


def test_facts_are_those_of_the_rig() -> None:
    rig = in_glass(Glass(1.5, "cylinder"))
    known = bending.facts(rig)
    assert (known["glass"], known["ior"]) == ("cylinder", [1.5])
    sine = np.sin(np.radians(20)) / 1.5
    np.testing.assert_allclose(known["elevation_inside_deg"], 2 * [np.degrees(np.arcsin(sine))])
    np.testing.assert_allclose(known["screen_behind_mm"], 2 * [30.0])  # three radii
    index = np.sqrt(1.5**2 - np.sin(np.radians(20)) ** 2) / np.cos(np.radians(20))
    assert known["focus_mm"] == pytest.approx(10 * index / (2 * (index - 1)))
    assert known["lit_part"] == np.mean(bent(rig).through > 0) < 1
    assert "bottom" not in known


@pytest.mark.parametrize(
    ("glass", "said"),
    [
        (Glass(1.5, bottom="blocked"), ("the block itself", "goes on at 13.18°", "No light comes out", "60 mm behind")),
        (Glass((1.4, 1.5, 1.6), "cylinder"), ("1.4, 1.5, 1.6", "a lens", "12.34 to 14.14°", "no voxel reaches")),
        (Glass(1.5, "sphere"), ("a sphere of glass", "a lens")),
        (Glass(1.33, "bath"), ("a bath whose flat sides", "Every pixel of")),
        (Glass(1.5, "round-bath"), ("a round bath", "a lens")),
    ],
)
def test_each_fact_has_a_sentence(glass: Glass, said: tuple[str, ...]) -> None:
    told = " ".join(bending.sentences(in_glass(glass)))
    assert all(part in told for part in said), told


def test_nothing_is_said_without_glass() -> None:
    assert bending.facts(in_glass(None)) == {}
    assert bending.sentences(in_glass(None)) == []
