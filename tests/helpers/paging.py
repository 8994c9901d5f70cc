"""Cubes of every kind as pages hold them, and a page's modules asked about them, for tests."""

import base64
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.viewer.description import describe, zipped
from lightcube.viewer.packing import Packed, pack
from tests.helpers.areas import divided

Evaluate = Callable[..., Any]
Array = NDArray[Any]

GRID = Grid((3, 5, 7), 1.3)
RANDOM = np.random.default_rng(7)
ALL = (
    "model/data.js",
    "model/stage.js",
    "model/area.js",
    "model/cast.js",
    "model/sheet.js",
    "model/glass.js",
    "model/beam.js",
    "room/clearbody.js",
)
#: The scene and the voxels of an argument, for an expression to go on with.
GIVEN = """(async () => {
  const scene = await readScene(fromBase64(argument.scene));
  const cube = await readVoxels(fromBase64(argument.voxels), scene);
  return %s;
})()"""
#: Makes typed arrays and what is nested in others plain.
PLAIN = "JSON.parse(JSON.stringify(%s, (_, v) => ArrayBuffer.isView(v) ? [...v] : v === Infinity ? 'Infinity' : v))"


def on_table(rig: Rig, channels: int = 3, **more: Any) -> Cube:
    """A random cube for views of a turntable, under random powers."""
    extinction = np.random.default_rng(3).gamma(0.5, 0.2, (channels, *GRID.shape))
    powers = np.random.default_rng(4).uniform(0.5, 3, (len(rig), channels))
    return Cube(extinction.astype(np.float32), GRID, rig, powers, **more)


def on_stage(stage: Stage, *, lamp_samples: int = 1, **more: Any) -> Cube:
    """A random cube on a stage, under random powers."""
    rig = divided(stage.rig(), lamp=lamp_samples)
    extinction = np.random.default_rng(3).gamma(0.5, 0.2, (3, *GRID.shape))
    powers = np.random.default_rng(4).uniform(0.5, 3, (len(rig.pairs), 3))
    return Cube(extinction.astype(np.float32), GRID, rig, powers, **more)


def table(*angles_deg: float, elevation_deg: float = 0.0) -> Rig:
    return turntable(GRID, angles_deg, elevation_deg=elevation_deg, picture_shape=(3, 5))


def shifted(rig: Rig) -> Rig:
    """Each picture standing somewhere else on its screen."""
    return rig.shifted(np.random.default_rng(5).integers(-2, 3, (2, len(rig))).T)


LAMPS = (
    Lamp("sun", direction=(2.0, 0.3, -1.2), colour=(1.0, 0.5, 0.0), reach_mm=6.0, falloff_mm=8.0, size_deg=5.0),
    Lamp("bulb", position_mm=(-9.0, 2.0, 7.0), full_at_mm=12.0, falloff_mm=np.inf, reach_mm=3.0, size_deg=9.0),
    Lamp("moon", direction=(1.0, -0.4, -1.1), reach_mm=10.0, falloff_mm=0.0, turns=True),
)
SCREENS = (
    Screen("wall", (9.0, 0.0, -5.4), (6.5, 5.2), 1.3, reach_mm=9.0, falloff_mm=5.0),
    Screen("floor", (7.0, 1.0, -9.0), (3.9, 6.5), 1.3, normal=(0.0, 0.0, 1.0), cosine=True, rear=True, turns=True),
)
SHOTS = (
    Shot("a", "wall", ("sun", "bulb")),
    Shot("b", "floor", ("bulb",)),
    Shot("c", "wall", ("moon", "bulb", "sun"), 1),
    Shot("d", "floor", ("sun", "moon"), 1),
    Shot("e", "wall", ("bulb",), 2),
)
STOPS = (-10.0, 130.0, 200.0)
TURNING = Stage(GRID, LAMPS, SCREENS, SHOTS, STOPS, (0.1, -0.2, 1.0))
FAR = Stage(GRID, LAMPS[:1], (replace(SCREENS[0], centre_mm=(60.0, 8.0, -35.0)),), (Shot("a", "wall", ("sun",)),))
CUBES = {
    "level": on_table(table(10, 75, 140)),
    "level, one stop": on_table(table(30)),
    "level, stops half a turn apart": on_table(table(20, 110, 200, 290), hold_deg=4.0),
    "raised": on_table(table(0, 77, 181, 300, elevation_deg=35)),
    "from below, held": on_table(table(0, 10, 77, 300, elevation_deg=-20), hold_deg=8.0),
    "level, moved, held": on_table(shifted(table(5, 95, 170)), hold_deg=3.0, transfer="linear"),
    "raised, moved": on_table(shifted(table(5, 95, 270, elevation_deg=30))),
    "one colour": on_table(table(10, 75, 140, elevation_deg=10), channels=1),
    "stage": on_stage(TURNING, hold_deg=5.0),
    "soft lamps": on_stage(TURNING, lamp_samples=3),
    "far wall under a veil": on_stage(replace(FAR, veil=0.2)),
    "lamps go round": on_stage(replace(TURNING, cube_turns=False, axis=(0.3, 1.0, -0.2))),
}
ANGLES = (0.0, 10.0, 43.7, 102.5, 130.0, 174.9, 200.0, -10.0, 271.25, 355.5)


def paged(cube: Cube) -> tuple[Cube, Packed, dict[str, str]]:
    """A cube with what a page holds of it, and the page's data as arguments."""
    packed = pack(cube)
    texts = {"scene": zipped(describe(cube, packed, "a cube")), "voxels": packed.data()}
    return cube, packed, {key: base64.b64encode(text).decode() for key, text in texts.items()}


@cache
def held_in_a_page(name: str) -> tuple[Cube, Packed, dict[str, str]]:
    """The same of one of the cubes."""
    return paged(CUBES[name])


def asked(evaluate: Evaluate, data: dict[str, str], expression: str, **argument: Any) -> Any:
    """Value of an expression over a page's `scene` and `cube`, and numbers handed to it."""
    return evaluate(ALL, GIVEN % (PLAIN % f"({expression})"), data | argument)


def nearly(found: Any, wanted: Any, bound: float) -> None:
    found, wanted = np.asarray(found, float), np.asarray(wanted, float)
    assert found.shape == wanted.shape
    np.testing.assert_allclose(found, wanted, atol=bound, rtol=bound)


def failure(evaluate: Evaluate, expression: str, argument: Any) -> str:
    """The sentence that an expression fails with."""
    return str(evaluate(ALL, f"(async () => {expression})().then(() => 'none', (e) => e.message)", argument))
