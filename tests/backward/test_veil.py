"""Light that lies evenly over the wall whatever the cube: the law, what a solve that knows of it makes of it, files."""

from dataclasses import replace

import numpy as np
import pytest

import lightcube as lc
from lightcube.backward.solving import solve
from lightcube.errors import InputError
from lightcube.io._rig import RigJson, rig_to_json
from lightcube.optics.glass import Glass
from lightcube.optics.law import falling_light
from lightcube.optics.light import Light
from lightcube.optics.tables import Fading
from lightcube.planning.measured import is_measured, unmeasured
from lightcube.solvers import METHODS
from tests.conftest import INTERPRETED
from tests.helpers.recipes import asked
from tests.helpers.thin import cast
from tests.helpers.wall import play
from tests.optics.test_rig import ROOM

GRID = lc.Grid((3, 5, 7), 0.7)
ANGLES = [20.0, 80.0, 130.0]


def veiled(rig: lc.Rig, veil: float) -> lc.Rig:
    return replace(rig, fading=replace(rig.fading, veil=np.full(len(rig.views), veil)))


def cubes() -> dict[str, lc.Cube]:
    """On a turntable, in glass, under lamps of several kinds whose shadows fade, and under a lamp with a disc."""
    rigs = {
        "turntable": lc.turntable(GRID, ANGLES, elevation_deg=35),
        "glass": lc.turntable(GRID, ANGLES, elevation_deg=20, glass=Glass(1.5, "cylinder")),
        "disc": lc.turntable(GRID, ANGLES, elevation_deg=10, lamp_deg=2.0),
    }
    grids = dict.fromkeys(rigs, GRID) | {"room": ROOM.grid}
    rigs |= {"room": ROOM.rig()}
    random = np.random.default_rng(4)
    return {
        name: lc.Cube(
            random.gamma(0.5, 0.5, (3, *grids[name].shape)).astype(np.float32),
            grids[name],
            rig,
            random.uniform(0.5, 3, (len(rig.pairs), 3)),
        )
        for name, rig in rigs.items()
    }


@pytest.mark.parametrize("name", ["turntable", "glass", "disc", "room"])
def test_it_is_a_part_of_each_lamps_light_beside_all_that_is_there(name: str) -> None:
    """Wherever a beam goes, and where none comes: power times share times veil, of all its lamps."""
    cube = cubes()[name]
    before, rig = cube.rig, veiled(cube.rig, 0.3)
    added = np.zeros((len(before), 3))
    np.add.at(added, before.sums.picture, 0.3 * cube.powers[before.pair] * before.sums.of_colours(3))
    each = zip(cast(cube, before, cube.powers), cast(cube, rig, cube.powers), added, strict=True)
    for picture, (shown, over, more) in enumerate(each):
        rows, columns = before.stops.window[picture]
        np.testing.assert_allclose(over[:rows, :columns], (shown + more)[:rows, :columns], rtol=2e-5, atol=2e-6)


def test_light_and_shadow_are_the_laws_with_it() -> None:
    rig = ROOM.rig()
    (light, shadow), (more, less) = falling_light(rig), falling_light(veiled(rig, 0.3))
    np.testing.assert_allclose(more, light + 0.3, rtol=1e-6)
    np.testing.assert_allclose(more * less, light * shadow, rtol=1e-5, atol=1e-7)
    some = falling_light(veiled(rig, 0.3), [4, 1])
    np.testing.assert_array_equal(some[1], less[[4, 1]])


@pytest.mark.parametrize("method", METHODS)
def test_none_is_as_ever_bit_for_bit(method: str) -> None:
    targets = some_targets(0.0)
    same = lc.Targets(targets.pictures, veiled(targets.rig, 0.0))
    assert same.rig.is_thin
    one, other = (solve(**asked(each, GRID, method=method, passes=4)).cube for each in (targets, same))
    np.testing.assert_array_equal(one.extinction, other.extinction)


def some_targets(veil: float, least: float = 0.2) -> lc.Targets:
    rig = lc.turntable(GRID, ANGLES, elevation_deg=35, picture_shape=(4, 5), veil=veil)
    return lc.Targets(np.random.default_rng(3).uniform(least, 0.9, (3, 4, 5, 3)).astype(np.float32), rig)


@pytest.mark.skipif(INTERPRETED, reason="interpreted, light has few points")
@pytest.mark.parametrize("thin", [True, False])
@pytest.mark.parametrize("units", [1, 3])
def test_who_knows_of_it_comes_nearer(units: int, *, thin: bool) -> None:
    """Than a cube that was solved without, under the veil; and what the solver saw is what is cast."""
    beams = {"light": Light.thin() if thin else Light(5, 5)}
    targets = some_targets(0.1)
    known = solve(**asked(targets, GRID, passes=40, units=units, **beams)).cube
    unaware = solve(**asked(some_targets(0.0), GRID, passes=40, **beams)).cube

    def off(cube: lc.Cube) -> float:
        seen = play(replace(cube, rig=targets.rig), light="thin" if thin else "area")
        return float(np.sqrt(np.mean((seen - targets.pictures) ** 2)))

    assert off(known) < 0.5 * off(unaware)
    assert known.rig.fading.veil.tolist() == [0.1, 0.1, 0.1]


def test_it_comes_back_from_files_and_is_not_written_where_there_is_none() -> None:
    rig = lc.turntable(GRID, ANGLES, veil=0.1 + 0.2)
    again = RigJson.model_validate(rig_to_json(rig)).rig()
    np.testing.assert_array_equal(again.fading.veil, rig.fading.veil)
    assert "veil" not in rig_to_json(lc.turntable(GRID, ANGLES))["fading"]


def test_it_goes_with_what_is_taken_and_turned() -> None:
    rig = lc.turntable(GRID, ANGLES, elevation_deg=35)
    rig = replace(rig, fading=replace(rig.fading, veil=np.array([0.1, 0.2, 0.3])))
    assert rig.take([2, 0]).fading.veil.tolist() == [0.3, 0.1]
    assert rig.at([131.0])[0].fading.veil.tolist() == [0.3]
    assert rig.by_colour(2).fading.veil.tolist() == [0.1, 0.1, 0.2, 0.2, 0.3, 0.3]


def test_it_is_rehearsed_as_any_other_light() -> None:
    """Without a doubt, and with pictures that are worse."""
    rigs = [lc.turntable(GRID, ANGLES, elevation_deg=35, picture_shape=(3, 3), veil=veil) for veil in (0.0, 0.2)]
    assert all(is_measured(rig, GRID) for rig in rigs)
    assert unmeasured(rigs[1]) == []
    wanted = np.random.default_rng(1).uniform(0.05, 0.9, (3, 3, 3, 3)).astype(np.float32)
    clear, under = (lc.predict(lc.Targets(wanted, rig), GRID).psnr_mean for rig in rigs)
    assert INTERPRETED or under < clear - 3


@pytest.mark.parametrize("veil", [-0.1, 1.0, 3.0])
def test_what_is_no_part_of_the_light_is_refused(veil: float) -> None:
    match = f"a veil is a part of the lamp's light, from 0 to below 1, not {veil:g}"
    with pytest.raises(InputError, match=match):
        lc.Turntable(veil=veil)
    with pytest.raises(InputError, match=match):
        lc.turntable(GRID, ANGLES, veil=veil)
    with pytest.raises(InputError, match=match):
        replace(ROOM, veil=veil)
    with pytest.raises(InputError, match="has shape"):
        replace(Fading.none(3), veil=np.zeros(2))
