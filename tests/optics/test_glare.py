"""Ghosts of a block of glass, against a plain twin that follows every beam."""

from dataclasses import replace

import numpy as np
import pytest

import lightcube as lc
from lightcube.optics.glare import ghosts, off_normals
from lightcube.optics.glass import Glass
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.views import Views
from tests.helpers import plain_glass as plain

GRID = lc.Grid((8, 5, 7), 2.0, tall=0.5)


@pytest.mark.parametrize(("angle_deg", "elevation_deg"), [(15.0, 0.0), (33.0, 20.0), (80.0, 35.0)])
def test_where_beams_land_that_are_thrown_back_ghosts_are_told(angle_deg: float, elevation_deg: float) -> None:
    """And they are at least as bright as such a beam; straight on, where no such beam lands, some places have none."""
    rig = turntable(GRID, [angle_deg], elevation_deg=elevation_deg, glass=Glass(1.5))
    assert rig.glass is not None
    assert rig.glass.size_mm is not None
    views, body = rig.views, plain.Block(rig.glass.size_mm)
    light, normal = views.lamps[0, :3], np.cross(views.column_steps_mm[0], views.row_steps_mm[0])
    random, places, bright = np.random.default_rng(1), [], []
    for start in random.uniform(-0.5, 0.5, (400, 3)) * rig.glass.size_mm:
        beam = plain.traced(body, start, light, 1.5)
        if beam is None or beam.is_direct or (beam.outgoing @ normal) / (light @ normal) < 0.05:
            continue
        places.append(beam.lands(views.origins_mm[0], normal))
        bright.append(plain.irradiance(body, start, light, 1.5, views.origins_mm[0], normal))
    assert len(places) > 20
    each = views.take(np.zeros(len(places), int))
    one = Views(each.lamps, np.array(places), each.column_steps_mm, each.row_steps_mm, (1, 1))
    pixels = replace(Rig.of(one, np.zeros(len(places))), glass=rig.glass)
    told = ghosts(pixels)[:, 0, 0]
    assert np.all(told > np.array(bright) * (1 - 1e-6))
    assert np.mean(told < np.array(bright) * (1 + 1e-6)) > 0.5, "most places have one ghost"
    assert np.mean(ghosts(rig) == 0) > 0.1


def test_stops_off_the_normals_before_a_far_screen_have_no_ghosts_in_the_middle() -> None:
    grid = lc.Grid((20, 20, 20), 2.0)
    room = turntable(
        grid, [4.0, 15.0, 45.0, 75.0], elevation_deg=0.0, picture_shape=(12, 12), glass=Glass(1.5), screen_mm=91.0
    )
    share = np.mean(ghosts(room) > 0.01, axis=(1, 2))
    assert share[0] > 0.01
    assert not np.any(share[1:])
    near = turntable(grid, [15.0], elevation_deg=0.0, picture_shape=(12, 12), glass=Glass(1.5), screen_mm=0.0)
    assert np.mean(ghosts(near) > 0.01) > 0.05


def test_what_is_round_or_a_bath_has_none() -> None:
    for form in ("cylinder", "sphere", "bath", "round-bath"):
        assert not np.any(ghosts(turntable(GRID, [33.0], elevation_deg=20, glass=Glass(1.5, form))))


def off(angles_deg: np.ndarray) -> float:
    """How far the nearest is from a multiple of 90 degrees."""
    return float(np.min(np.abs(np.remainder(angles_deg + 45.0, 90.0) - 45.0)))


@pytest.mark.parametrize("count", range(1, 40))
def test_stops_are_turned_together_as_far_from_the_normals_as_can_be(count: int) -> None:
    """As a search over all turns finds, and no further than they must."""
    even = lc.spread_angles(count, 360.0)
    for angles_deg in (even, np.random.default_rng(count).uniform(0, 360, count)):
        turned = off_normals(angles_deg, Glass(1.5))
        turns = turned - angles_deg
        np.testing.assert_allclose(turns, turns[0], atol=1e-9)
        some = np.arange(-45.0, 45.0, 0.05)
        reached = np.array([off(angles_deg + turn) for turn in some])
        assert off(turned) >= reached.max() - 1e-9
        assert abs(turns[0]) <= np.min(np.abs(some[reached > off(turned) - 0.05])) + 0.1
    if off(even) == 45.0 / (count / np.gcd(count, 4)):
        np.testing.assert_array_equal(off_normals(even, Glass(1.5)), even)
    for glass in (None, Glass(1.0), Glass(1.5, "cylinder")):
        assert off_normals(even, glass) is even
