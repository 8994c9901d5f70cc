"""What the page's graphics cast is a plain average of what `cast` does, to half a display level; the room shows it."""

import base64
import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.optics.transfer import Transfer, decode, encode
from lightcube.viewer import packing
from lightcube.viewer.description import describe
from lightcube.viewer.packing import pack
from tests.helpers.areas import JUDGED, THIN, Points, averaged, divided, judged, over_square

Run = Callable[..., Any]
#: Levels of 255 that a shadow may be off: half of one by rounding, and what single precision costs.
OFF = 0.5 + 0.05

Z = np.array([0.0, 0.0, 1.0])
MODULES = (
    *("model/data.js", "model/stage.js", "model/area.js", "model/cast.js"),
    *("room/camera.js", "room/furniture.js", "room/gpu.js", "room/flat.js"),
)
START = """(async () => {
  const { scene, voxels, angles_deg, whole, kind, parts } = argument;
  const beams = { THIN, QUICK, JUDGED }[argument.beams];
  const cube = await readVoxels(fromBase64(voxels), scene);
  const renderer = (kind === "flat" ? createFlat : createRenderer)(document.createElement("canvas"), scene, cube);
"""
SHADOWS = f"""{START}
  const shown = angles_deg.map((angle) => {{
    const all = exposures(scene, angle, whole);
    renderer.cast(all, beams, parts);
    return all.map((_, i) => renderer.shadow(i)).map((each) => ({{ ...each, pixels: [...each.pixels] }}));
  }});
  renderer.dispose();
  return shown;
}})()"""


USUAL = {"whole": False, "beams": "JUDGED", "parts": 1}


def given(cube: Cube) -> dict[str, Any]:
    """A packed cube as the page has it."""
    packed = pack(cube)
    scene = json.loads(json.dumps(describe(cube, packed, "test"), allow_nan=False))
    return {"scene": scene, "voxels": base64.b64encode(packed.data()).decode()}


def shadows(evaluate: Run, cube: Cube, angles_deg: list[float], **more: Any) -> list[list[NDArray[np.uint8]]]:
    """Levels of red, green and blue, for each angle and screen."""
    found = evaluate(MODULES, SHADOWS, {**given(cube), "angles_deg": angles_deg, **USUAL, **more})
    return [
        [np.array(each["pixels"], np.uint8).reshape(each["rows"], each["columns"], 4)[..., :3] for each in at_angle]
        for at_angle in found
    ]


def worst(
    shown: list[list[NDArray[np.uint8]]],
    cube: Cube,
    angles_deg: list[float],
    *,
    points: Points | None = None,
    whole: bool = False,
) -> float:
    """The largest difference from the packed cube's light, averaged over points or as it is judged, levels of 255."""
    packed = pack(cube).cube
    right = (
        judged(packed, angles_deg, whole=whole) if points is None else averaged(packed, angles_deg, points, whole=whole)
    )
    pictures = [picture for at_angle in shown for picture in at_angle]
    assert len(pictures) == len(right)
    levels = 255 * encode(np.clip(right, 0, 1).astype(np.float64), cube.transfer)
    off = [
        np.abs(picture - wanted[: picture.shape[0], : picture.shape[1]])
        for picture, wanted in zip(pictures, levels, strict=True)
    ]
    return max(float(each.max()) for each in off)


def glass(shape: tuple[int, int, int], channels: int = 3, seed: int = 0) -> NDArray[np.float32]:
    """A few dark voxels among many clear ones."""
    random = np.random.default_rng(seed)
    return random.gamma(0.3, 5 / (0.3 * max(shape)), (channels, *shape)).astype(np.float32)


TURNTABLES: dict[str, tuple[tuple[int, int, int], float, tuple[int, int], int, Transfer, int]] = {
    "level": ((3, 5, 7), 0.0, (3, 5), 3, "srgb", 1),
    "raised": ((12, 12, 12), 35.0, (10, 12), 3, "srgb", 1),
    "one colour, linear": ((5, 4, 6), 12.0, (5, 4), 1, "linear", 1),
    "pixels of 2 voxels": ((8, 7, 9), 35.0, (4, 3), 3, "srgb", 2),
    "level pixels of 2": ((6, 7, 5), 0.0, (3, 3), 3, "srgb", 2),
}
ANGLES = [0.0, 20.0, 33.3, 45.0, 89.9999, 90.0, 90.00001, 123.456, 180.0, 270.0, 359.99, 1e-4]


def on_turntable(name: str, **more: Any) -> Cube:
    """A random cube with three stops and powers of their own."""
    shape, elevation_deg, window, channels, transfer, pixel = TURNTABLES[name]
    grid = Grid(shape, 0.8)
    rig = turntable(grid, [20.0, 90.0, 130.0], elevation_deg=elevation_deg, picture_shape=window, pixel=pixel)
    powers = np.random.default_rng(1).uniform(0.5, 3, (3, channels))
    return Cube(glass(shape, channels), grid, rig, powers, transfer=transfer, hold_deg=1.0, **more)


@pytest.mark.parametrize("whole", [False, True])
@pytest.mark.parametrize("name", TURNTABLES)
def test_turntables(evaluate: Run, name: str, whole: bool) -> None:
    """Where beams run almost along faces, by thin ones; and by whole pixels."""
    cube = on_turntable(name)
    thin = shadows(evaluate, cube, ANGLES, whole=whole, beams="THIN")
    assert worst(thin, cube, ANGLES, points=THIN, whole=whole) <= OFF
    assert worst(shadows(evaluate, cube, ANGLES[:6], whole=whole), cube, ANGLES[:6], whole=whole) <= OFF


@pytest.mark.parametrize("kind", ["webgl", "flat"])
@pytest.mark.parametrize("bits", packing.BITS[1:])
@pytest.mark.parametrize("name", TURNTABLES)
def test_codes_of_more_bits(evaluate: Run, name: str, bits: int, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packing, "BITS", (bits,))
    cube = on_turntable(name)
    cube = replace(cube, extinction=cube.extinction * np.float32(5), lamp_powers=cube.powers * 3)
    thin = shadows(evaluate, cube, ANGLES, kind=kind, beams="THIN")
    assert worst(thin, cube, ANGLES, points=THIN) <= OFF


@pytest.mark.parametrize("shape", [(4, 4, 4), (3, 5, 5), (4, 5, 6)])
@pytest.mark.parametrize("shift", [0.0, 0.5])
def test_beams_along_faces(evaluate: Run, shape: tuple[int, int, int], shift: float) -> None:
    """Whole voxels from the middle, or half a voxel beside: in one of them the beams of 0° and 90° run along faces."""
    grid = Grid(shape)
    rig = turntable(grid, [0.0, 90.0, 200.0], picture_shape=(shape[0] - 2, shape[1] - 2))
    beside = shift * (rig.views.column_steps_mm + rig.views.row_steps_mm)
    cube = Cube(glass(shape), grid, replace(rig, views=replace(rig.views, origins_mm=rig.views.origins_mm + beside)))
    angles_deg = [0.0, 90.0, 180.0, 270.0, 1e-3, 90 - 1e-4, 180 + 1e-5]
    thin = shadows(evaluate, cube, angles_deg, beams="THIN")
    assert worst(thin, cube, angles_deg, points=THIN) <= OFF


GRID = Grid((7, 6, 8), 0.7)
WALL = Screen("wall", (5.0, 0.0, -2.5), (4.9, 4.2), 0.7)
RED, BLUE = (
    Lamp(name, (1.0, y, z), colour=colour)
    for name, y, z, colour in (("red", 0.3, -0.6, (1.0, 0.1, 0.0)), ("blue", -0.3, -0.4, (0.1, 0.3, 1.0)))
)
BULB = Lamp("bulb", position_mm=(-12.0, 0.0, 6.0))
FLOOR = Screen("floor", (0.0, 0.0, -6.0), (3.5, 5.6), 0.7)
SUN = Lamp("sun", (0.0, 0.0, -1.0))
ROOMS: dict[str, tuple[tuple[Lamp, ...], tuple[Screen, ...], int]] = {
    "two coloured lamps": ((RED, BLUE), (WALL,), 1),
    "a shadow that fades, of a point": ((BULB,), (replace(WALL, reach_mm=5.4, falloff_mm=4.0),), 1),
    "a shadow that ends": ((replace(RED, reach_mm=5.4, falloff_mm=0.0),), (WALL,), 1),
    "penumbra": ((replace(RED, colour=(1, 1, 1), size_deg=5.0),), (WALL,), 7),
    "aslant and by the inverse square": ((replace(BULB, full_at_mm=18.0),), (replace(WALL, cosine=True),), 1),
    "a bulb far away": ((replace(BULB, position_mm=(-4000.0, 0.0, 0.0)),), (WALL,), 1),
    "a bulb level with a face": ((replace(BULB, position_mm=(-9.0, 0.7, 0.7)),), (WALL,), 1),
    "two screens of different sizes": ((RED, SUN, BULB), (WALL, FLOOR), 1),
    "a veil": ((RED, replace(BULB, reach_mm=5.4, falloff_mm=4.0)), (replace(WALL, cosine=True),), 1),
}


def on_stage(name: str) -> Cube:
    """A random cube; the red and the blue lamp and the bulb shine on the wall, the sun on the floor."""
    lamps, screens, samples = ROOMS[name]
    shots = []
    for screen in screens:
        its = tuple(lamp.name for lamp in lamps if (lamp.name == "sun") == (screen.name == "floor"))
        shots += [Shot(f"{screen.name} {stop}", screen.name, its, stop) for stop in range(3)]
    stage = Stage(GRID, lamps, screens, tuple(shots), (0.0, 110.0, 230.0), veil=0.2 if name == "a veil" else 0.0)
    rig = divided(stage.rig(), lamp=samples)
    powers = np.random.default_rng(2).uniform(0.4, 1.5, (len(rig.pairs), 3))
    return Cube(glass(GRID.shape), GRID, rig, powers)


@pytest.mark.parametrize("name", ROOMS)
def test_stages(evaluate: Run, name: str) -> None:
    cube, angles_deg = on_stage(name), [0.0, 51.0, 90.0, 110.0, 230.0, 359.0]
    thin = shadows(evaluate, cube, angles_deg, beams="THIN")
    assert worst(thin, cube, angles_deg, points=THIN) <= OFF
    assert worst(shadows(evaluate, cube, angles_deg[:2]), cube, angles_deg[:2]) <= OFF


@pytest.mark.parametrize("name", ["a shadow that fades, of a point", "two screens of different sizes"])
def test_flat_casts_the_same_on_stages(evaluate: Run, name: str) -> None:
    cube, angles_deg = on_stage(name), [0.0, 51.0, 230.0]
    assert worst(shadows(evaluate, cube, angles_deg, kind="flat"), cube, angles_deg) <= 0.5 + 1e-3


@pytest.mark.parametrize("name", TURNTABLES)
def test_flat_casts_the_same_on_turntables(evaluate: Run, name: str) -> None:
    cube, angles_deg = on_turntable(name), [0.0, 51.0, 230.0]
    assert worst(shadows(evaluate, cube, angles_deg, kind="flat"), cube, angles_deg) <= 0.5 + 1e-3


@pytest.mark.parametrize("kind", ["webgl", "flat"])
def test_whole_pixels_are_the_same_beside_parts(evaluate: Run, kind: str) -> None:
    """What is read back are pixels, however finely the room's wall shows them."""
    cube, angles_deg = on_stage("two screens of different sizes"), [0.0, 51.0]
    assert worst(shadows(evaluate, cube, angles_deg, kind=kind, parts=3), cube, angles_deg) <= OFF


@pytest.mark.parametrize("kind", ["webgl", "flat"])
@pytest.mark.parametrize("beams", ["THIN", "QUICK", "JUDGED"])
def test_a_clear_cube_shows_its_lamps(evaluate: Run, kind: str, beams: str) -> None:
    """Every pixel is as bright as they are together, whichever beams make it."""
    for cube in (on_turntable("level"), on_turntable("raised"), on_stage("two coloured lamps")):
        powers = np.full(cube.powers.shape, (0.3, 0.2, 0.1))
        clear = replace(cube, extinction=0 * cube.extinction, lamp_powers=powers)
        per_picture = len(cube.rig.pairs) // len(cube.rig)
        colours = cube.rig.sums.of_colours(3)[:per_picture]  # of the first picture's views
        lamp = 255 * encode(np.sum(colours * powers[0], axis=0))
        for (picture,) in shadows(evaluate, clear, [20.0, 90.0], kind=kind, beams=beams):
            assert np.abs(picture - lamp).max() <= OFF


def test_lost_contexts_come_back(evaluate: Run) -> None:
    """The same shadow as before, cast without being asked."""
    lose = """(async () => {
      const { scene, voxels } = argument;
      const canvas = document.createElement("canvas");
      const renderer = createRenderer(canvas, scene, await readVoxels(fromBase64(voxels), scene));
      renderer.cast(exposures(scene, 33), JUDGED, 1);
      const before = [...renderer.shadow(0).pixels];
      const handle = canvas.getContext("webgl2").getExtension("WEBGL_lose_context");
      const lost = new Promise((done) => canvas.addEventListener("webglcontextlost", () => setTimeout(done, 50)));
      handle.loseContext();
      await lost;
      const restored = new Promise((done) => (renderer.onRestored = done));
      handle.restoreContext();
      await restored;
      return [before, [...renderer.shadow(0).pixels]];
    })()"""
    before, after = evaluate(MODULES, lose, given(on_turntable("raised")))
    assert before == after
    assert len(set(before)) > 20


SEEN = f"""{START}
  const canvas = document.createElement("canvas");
  Object.assign(canvas, {{ width: 300, height: 200 }});
  const room = standing(scene, angles_deg[0]);
  const camera = cameraOf(fitted(orbitFrom(scene.camera), scene, [room], 1.5), 1.5);
  const painter = (kind === "flat" ? createFlat : createRenderer)(canvas, scene, cube);
  painter.cast(exposures(scene, angles_deg[0]), beams, parts);
  painter.draw(room, camera, {{ dark: argument.dark, mark: argument.mark ?? null, scale: argument.scale ?? 1,
    bare: argument.bare ?? 0 }});
  const copy = Object.assign(document.createElement("canvas"), {{ width: 300, height: 200 }}).getContext("2d");
  copy.drawImage(canvas, 0, 0);
  const pixels = copy.getImageData(0, 0, 300, 200).data;
  const corners = [0, 1].map((y) => [0, 1].map((x) => rayAt(camera, x, y).way));
  renderer.dispose();
  painter.dispose();
  return {{ pixels: [...pixels], eye: camera.eye, corners, screen: room.screens[0], table: tableOf(scene, room) }};
}})()"""


def seen(evaluate: Run, cube: Cube, **more: Any) -> dict[str, Any]:
    """What the room shows, `levels` (200, 300, 3), and the `ways` of its pixels' rays, in the room."""
    found = evaluate(MODULES, SEEN, {**given(cube), "angles_deg": [0.0], "dark": False, **USUAL, **more})
    found["levels"] = np.array(found["pixels"], np.float64).reshape(200, 300, 4)[..., :3]
    corners = np.array(found["corners"])
    corners /= (corners @ corners.sum(axis=(0, 1)))[..., None]  # all as far ahead
    x, y = (np.arange(300) + 0.5)[:, None] / 300, (np.arange(200) + 0.5)[:, None, None] / 200
    above, below = ((1 - x) * left + x * right for left, right in corners)
    ways = (1 - y) * above + y * below
    found["ways"] = ways / np.linalg.norm(ways, axis=-1, keepdims=True)
    return dict(found)


def chords(found: dict[str, Any], grid: Grid) -> NDArray[np.float64]:
    """Lengths of the rays within the cube at angle 0, mm; negative where they miss it."""
    half = 0.5 * np.array(grid.size_mm[::-1])
    ends = np.stack([(side * half - np.array(found["eye"])) / found["ways"] for side in (-1, 1)])
    return np.asarray(ends.max(axis=0).min(axis=-1) - ends.min(axis=0).max(axis=-1))


def test_glass_is_seen_by_the_eye(evaluate: Run) -> None:
    """For the lamp's eye light is dimmed by the law of Beer and Lambert over each ray's chord."""
    shape, extinction = (6, 8, 10), np.array([0.02, 0.06, 0.15])
    grid = Grid(shape, 1.3)
    rig = turntable(grid, [0.0, 70.0], elevation_deg=20.0, picture_shape=(6, 8))
    cube, clear = (
        Cube(np.broadcast_to(each[:, None, None, None], (3, *shape)).astype(np.float32), grid, rig)
        for each in (extinction, 0 * extinction)
    )
    through, past = seen(evaluate, cube, bare=1), seen(evaluate, clear, bare=1)
    chord = chords(through, grid)
    inside = (chord > 0.5) & (np.abs(through["levels"] - past["levels"]).max(axis=-1) > 0)
    kept = np.exp(-np.maximum(chord, 0)[..., None] * extinction)
    off = np.abs(through["levels"] - 255 * encode(kept * decode(past["levels"] / 255)))[inside].max(axis=-1)
    assert np.count_nonzero(inside) > 10000
    assert np.mean(off <= 2.1) > 0.9  # both pictures are rounded; what is left is under the cube's edges
    assert np.median(off) < 0.8


@pytest.mark.parametrize(
    ("parts", "kind", "dark"), [(1, "webgl", False), (1, "webgl", True), (3, "webgl", False), (3, "flat", False)]
)
def test_the_picture_in_the_room_is_the_shadow(evaluate: Run, parts: int, kind: str, dark: bool) -> None:
    """Where a ray meets the screen past the cube, the room shows the light there, with smooth steps between parts."""
    cube = on_turntable("raised")
    found = seen(evaluate, cube, dark=dark, parts=parts, kind=kind)
    screen, eye = found["screen"], np.array(found["eye"])
    rows, columns = screen["pixels"]
    corner, facing, right, down = (np.array(screen[name]) for name in ("corner", "facing", "right", "down"))
    away = ((corner - eye) @ facing) / (found["ways"] @ facing)
    places = eye + away[..., None] * found["ways"] - corner
    across, below = (parts * places @ step / (step @ step) - 0.5 for step in (right, down))
    rows, columns = parts * rows, parts * columns
    inside = (across > 0) & (across < columns - 1) & (below > 0) & (below < rows - 1) & (chords(found, cube.grid) < -1)
    table = {name: np.array(each) for name, each in found["table"].items()}
    before = ((table["middle"] - eye) @ Z) / (found["ways"] @ Z)
    spot = eye + before[..., None] * found["ways"] - table["middle"]
    on_table = (before > 0) & (before < away) & (np.linalg.norm(spot, axis=-1) < 1.02 * np.linalg.norm(table["right"]))
    inside &= ~on_table  # its glass lies before the screen
    assert np.count_nonzero(inside) > 300
    points = over_square(8, 5) if parts == 3 else JUDGED
    light = averaged(pack(cube).cube, [0.0], points, parts=parts)[0]
    shadow = 255 * encode(np.clip(light, 0, 1))
    wanted = np.stack(
        [map_coordinates(shadow[..., i], [below[inside], across[inside]], order=1) for i in range(3)], axis=-1
    )
    off = np.abs(found["levels"][inside] - wanted).max(axis=-1)
    assert np.mean(off <= (2 if kind == "webgl" else 12)) > 0.95  # thin lines pass before it; plain patches are aslant


def test_small_pictures_are_enlarged(evaluate: Run) -> None:
    cube = on_turntable("raised")
    off = np.abs(seen(evaluate, cube)["levels"] - seen(evaluate, cube, scale=0.5)["levels"])
    assert 0.01 < np.mean(off) < 6


def test_marks_are_seen(evaluate: Run) -> None:
    """A bright row on the screen, and its beams."""
    cube = on_turntable("raised")
    plain, marked = (seen(evaluate, cube, mark=mark)["levels"] for mark in (None, {"screen": 0, "row": 4, "column": 5}))
    assert np.count_nonzero(np.abs(plain - marked).max(axis=-1) > 4) > 100
