"""The page's mathematics, module by module in a browser, against the Python that it repeats."""

import base64
import gzip
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lightcube.cube import Cube
from lightcube.forward import exposures_at, play, views_at
from lightcube.geometry import Grid, Views, rotations, turntable
from lightcube.lighting import sampled
from lightcube.stage import Lamp, Screen, Shot, Stage
from lightcube.stage import exposures as exposures_of
from lightcube.standing import as_stage, standing
from lightcube.transfer import decode, encode
from lightcube.viewer import packing
from lightcube.viewer.described import describe, zipped
from lightcube.viewer.packing import Packed, pack
from tests import plain
from tests.test_rays import lamps_for, lit, screens_for

Evaluate = Callable[..., Any]
Array = NDArray[Any]

GRID = Grid((3, 5, 7), 1.3)
RANDOM = np.random.default_rng(7)
ALL = ("data.js", "stage.js", "cast.js", "sheet.js")
#: The scene and the voxels of an argument, for an expression to go on with.
GIVEN = """(async () => {
  const scene = await readScene(fromBase64(argument.scene));
  const cube = await readVoxels(fromBase64(argument.voxels), scene);
  return %s;
})()"""
#: Makes typed arrays and what is nested in others plain.
PLAIN = "JSON.parse(JSON.stringify(%s, (_, v) => ArrayBuffer.isView(v) ? [...v] : v === Infinity ? 'Infinity' : v))"


def on_table(views: Views, channels: int = 3, **more: Any) -> Cube:
    """A random cube for views of a turntable, under random powers."""
    extinction = np.random.default_rng(3).gamma(0.5, 0.2, (channels, *GRID.shape))
    powers = np.random.default_rng(4).uniform(0.5, 3, (len(views), channels))
    return Cube(extinction.astype(np.float32), GRID, views, powers, **more)


def on_stage(stage: Stage, *, lamp_samples: int = 1, pixel_samples: int = 1, **more: Any) -> Cube:
    """A random cube on a stage, under random powers."""
    views, lighting = sampled(*exposures_of(stage), lamp_samples=lamp_samples, pixel_samples=pixel_samples)
    extinction = np.random.default_rng(3).gamma(0.5, 0.2, (3, *GRID.shape))
    powers = np.random.default_rng(4).uniform(0.5, 3, (len(lighting.pairs), 3))
    return Cube(extinction.astype(np.float32), GRID, views, powers, lighting=lighting, **more)


def table(*angles: float, elevation: float = 0.0) -> Views:
    return turntable(GRID, angles, elevation=elevation, picture_shape=(3, 5))


def shifted(views: Views) -> Views:
    """Each picture standing somewhere else on its screen."""
    right, down = np.random.default_rng(5).integers(-2, 3, (2, len(views), 1))
    return replace(views, origins=views.origins + right * views.column_steps + down * views.row_steps)


LAMPS = (
    Lamp("sun", direction=(2.0, 0.3, -1.2), colour=(1.0, 0.5, 0.0), reach_mm=6.0, falloff_mm=8.0, size_deg=5.0),
    Lamp("bulb", position=(-9.0, 2.0, 7.0), full_at_mm=12.0, falloff_mm=np.inf, reach_mm=3.0, size_deg=9.0),
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
FAR = Stage(GRID, LAMPS[:1], (replace(SCREENS[0], centre=(60.0, 8.0, -35.0)),), (Shot("a", "wall", ("sun",)),))
CUBES = {
    "level": on_table(table(10, 75, 140)),
    "level, one stop": on_table(table(30)),
    "level, stops half a turn apart": on_table(table(20, 110, 200, 290), hold_deg=4.0),
    "raised": on_table(table(0, 77, 181, 300, elevation=35)),
    "from below, held": on_table(table(0, 10, 77, 300, elevation=-20), hold_deg=8.0),
    "level, moved, held": on_table(shifted(table(5, 95, 170)), hold_deg=3.0, transfer="linear"),
    "raised, moved": on_table(shifted(table(5, 95, 270, elevation=30))),
    "one colour": on_table(table(10, 75, 140, elevation=10), channels=1),
    "stage": on_stage(TURNING, hold_deg=5.0),
    "soft lamps": on_stage(TURNING, lamp_samples=3, pixel_samples=2),
    "far wall": on_stage(FAR),
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


# data.js


@pytest.mark.parametrize("native", [True, False])
@pytest.mark.parametrize("bits", packing.BITS)
@pytest.mark.parametrize("name", ["raised", "one colour"])
def test_voxels_come_through(
    evaluate: Evaluate, name: str, bits: int, native: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(packing, "BITS", (bits,))
    _, packed, data = paged(CUBES[name])
    without = "" if native else "delete Uint8Array.fromBase64, "
    found = asked(evaluate, data, f"{without}cube")
    codes = np.array(found["codes"]).reshape(*GRID.shape, 3)
    for channel in range(3):
        own = channel % len(packed.codes)
        np.testing.assert_array_equal(codes[..., channel], packed.codes[own])
        table = np.array(found["tables"][channel])
        assert len(table) == 2**bits
        np.testing.assert_allclose(table[packed.codes[own]], packed.cube.extinction[own], rtol=1e-6)
    assert (tuple(found["shape"]), found["mm"]) == (GRID.shape, GRID.voxel_mm)


@pytest.mark.parametrize("native", [True, False])
def test_base64_is_read_with_and_without_help(evaluate: Evaluate, native: bool) -> None:
    without = "" if native else "delete Uint8Array.fromBase64, "
    sent = RANDOM.integers(0, 256, 1000).astype(np.uint8).tobytes()
    found = evaluate(("data.js",), f"({without}[...fromBase64(argument)])", base64.b64encode(sent).decode())
    assert bytes(found) == sent
    broken = failure(evaluate, f"({without}fromBase64(argument))", "AAAA*AAA")
    assert broken == "the page's data is not base64, some of its letters are damaged: write or send the page again"


@pytest.mark.parametrize("damage", ["flipped", "cut", "longer"])
@pytest.mark.parametrize("part", ["scene", "voxels"])
def test_damaged_gzip_is_told(evaluate: Evaluate, part: str, damage: str) -> None:
    data = held_in_a_page("raised")[2]
    sent = bytearray(base64.b64decode(data[part]))
    if damage == "flipped":
        sent[-5] ^= 8  # in the checksum: all else is as it was
    sent = {"flipped": sent, "cut": sent[:-9], "longer": sent + b"more"}[damage]
    said = failure(evaluate, GIVEN % "cube", data | {part: base64.b64encode(sent).decode()})
    assert said == f"the page's {part} came damaged or cut off (its gzip does not unpack): write or send the page again"


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        (b'{"format": 1', "the page's scene is not readable JSON: write or send the page again"),
        (b'{"format": "\xff"}', "the page's scene is not readable JSON: write or send the page again"),
        (b'{"format": 2}', "the page's data has format 2, newer than 1: update the viewer that opens it"),
        (b'{"format": 0}', "the page's data has format 0, not 1: write the page again with this version"),
        (b'{"title": "x"}', "the page's data has format undefined, not 1: write the page again with this version"),
        (b"null", "the page's data has format undefined, not 1: write the page again with this version"),
    ],
)
def test_a_scene_that_cannot_be_read_is_told(evaluate: Evaluate, scene: bytes, said: str) -> None:
    sent = base64.b64encode(gzip.compress(scene)).decode()
    assert failure(evaluate, "await readScene(fromBase64(argument))", sent) == said


@pytest.mark.parametrize("off", [-1, 1])
def test_a_wrong_number_of_bytes_is_told(evaluate: Evaluate, off: int) -> None:
    _, packed, data = held_in_a_page("raised")
    voxels = gzip.decompress(packed.data())
    sent = base64.b64encode(gzip.compress(voxels[:off] if off < 0 else voxels + b"x")).decode()
    size = 3 * 105 + 79
    said = f"the page's voxels have {size + off} bytes, not the {size} of 3 x 5 x 7 voxels in 3 channels: "
    assert failure(evaluate, GIVEN % "cube", data | {"voxels": sent}) == said + "write or send the page again"


def test_a_browser_without_unpacking_is_told(evaluate: Evaluate) -> None:
    said = failure(evaluate, "{ delete globalThis.DecompressionStream; await gunzip(new Uint8Array(9)); }", None)
    assert said == "this browser cannot unpack gzip: open the page in a newer one"


# vectors.js and light.js


def test_rotations_are_those_of_python(evaluate: Evaluate) -> None:
    axes = RANDOM.normal(size=(4, 3)).tolist() + np.eye(3).tolist()
    angles = [*RANDOM.uniform(-800, 800, 5), *range(-450, 451, 90), 45.0, -1e-20]
    expression = "argument.axes.map((axis) => argument.angles.map((angle) => rotation(axis, angle)))"
    found = evaluate(("vectors.js",), expression, {"axes": axes, "angles": angles})
    wanted = np.stack([rotations(axis, np.array(angles)) for axis in axes])
    nearly(np.reshape(found, wanted.shape), wanted, 1e-14)
    right = np.array(found[-1]).reshape(-1, 3, 3)[5:16]
    np.testing.assert_array_equal(right, np.rint(right))


def test_vectors_are_those_of_numpy(evaluate: Evaluate) -> None:
    a, b = RANDOM.normal(size=(2, 3))
    m = RANDOM.normal(size=(3, 3))
    expression = """(({ a, b, m }) => [[dot(a, b), norm(a), modulo(-7.5, 2)], cross(a, b), add(a, b), sub(a, b),
        scaled(a, 3), unit(b), apply(m, a), applyInverse(m, a)])(argument)"""
    found = evaluate(("vectors.js",), expression, {"a": a.tolist(), "b": b.tolist(), "m": m.ravel().tolist()})
    length = np.linalg.norm
    wanted = [[a @ b, length(a), 0.5], np.cross(a, b), a + b, a - b, 3 * a, b / length(b), m @ a, m.T @ a]
    nearly(found, wanted, 1e-14)


@pytest.mark.parametrize("transfer", ["srgb", "linear"])
def test_display_values_are_those_of_python(evaluate: Evaluate, transfer: Any) -> None:
    values = np.concatenate([np.linspace(0, 0.05, 60), np.linspace(0.05, 3, 60), [0.04045, 0.0031308]])
    expression = f"argument.map((x) => [encode(x, '{transfer}'), decode(x, '{transfer}')])"
    found = np.array(evaluate(("light.js",), expression, values.tolist()))
    nearly(found[:, 0], encode(values, transfer), 1e-14)
    nearly(found[:, 1], decode(values, transfer), 1e-14)


# stage.js


@pytest.mark.parametrize("name", CUBES)
def test_exposures_are_those_of_python(evaluate: Evaluate, name: str) -> None:
    cube, _, data = held_in_a_page(name)
    staged = as_stage(cube)
    found = asked(evaluate, data, "argument.angles.map((angle) => exposures(scene, angle))", angles=ANGLES)
    views, lighting, powers = exposures_at(staged, ANGLES)
    shown = [exposure for at_angle in found for exposure in at_angle]
    assert [exposure["screen"] for exposure in shown] == lighting.screen.tolist()
    assert [exposure["angle"] for exposure in shown] == lighting.angle.tolist()
    nearly([exposure["window"] for exposure in shown], lighting.window, 0)
    assert all(tuple(exposure["raster"]) == views.picture_shape for exposure in shown)
    each = [view for exposure in shown for view in exposure["views"]]
    for field, wanted in (
        ("light", views.lamps),
        ("origin", views.origins),
        ("right", views.column_steps),
        ("down", views.row_steps),
        ("power", np.broadcast_to(powers[lighting.pair] * lighting.share, (len(views), 3))),
        ("reach", lighting.reach_mm),
        ("falloff", lighting.falloff_mm),
        ("full_at", lighting.full_at_mm),
        ("cosine", lighting.cosine),
        ("lamp", lighting.lamp),
    ):
        nearly([view[field] for view in each], wanted, 1e-9)
    dark = [not exposure["lit"] for exposure in shown for _ in exposure["views"]]
    np.testing.assert_array_equal(dark, np.all(powers[lighting.pair] * lighting.share == 0, axis=1))


@pytest.mark.parametrize("name", ["raised", "level, moved, held"])
def test_a_whole_shadow_has_its_middle_in_the_middle(evaluate: Evaluate, name: str) -> None:
    """And shows what Python does, on the screen's plane."""
    cube, packed, data = held_in_a_page(name)
    expression = """argument.angles.map((angle) => {
      const [exposure] = exposures(scene, angle, true);
      return { exposure, room: standing(scene, angle, true), picture: castPicture(cube, exposure) };
    })"""
    found = asked(evaluate, data, expression, angles=ANGLES)
    views = views_at(cube, ANGLES, whole_screen=True)
    wanted = play(packed.cube, ANGLES, whole_screen=True)
    for i, each in enumerate(found):
        exposure, room = each["exposure"], each["room"]
        assert tuple(exposure["raster"]) == tuple(exposure["window"]) == views.picture_shape
        origin = np.array(exposure["views"][0]["origin"])
        nearly(np.cross(origin, views.lamps[i, :3]), np.zeros(3), 1e-9)
        screen = standing(cube, ANGLES[i]).screens[0]
        assert abs(np.reshape(room["turn"], (3, 3)) @ origin @ screen.facing - screen.corner @ screen.facing) < 1e-9
        across = 0.5 * (views.picture_shape[1] * screen.right + views.picture_shape[0] * screen.down)
        nearly(np.reshape(room["turn"], (3, 3)) @ origin - across, room["screens"][0]["corner"], 1e-9)
        nearly(np.reshape(each["picture"], wanted[i].shape), wanted[i], 2e-6)


@pytest.mark.parametrize("name", CUBES)
def test_stops_are_each_named_once_and_shown_at_their_angle(evaluate: Evaluate, name: str) -> None:
    cube, _, data = held_in_a_page(name)
    angles = as_stage(cube).angles
    expression = """[stops(scene), stops(scene).map((angle) => exposures(scene, angle).filter((e) => e.lit)
      .map((e) => scene.pictures[e.picture].angle)), nearestPicture(scene, 7, 0)]"""
    found, own, none = asked(evaluate, data, expression)
    nearly(found, np.unique(angles % 360), 1e-9)
    for angle, shown in zip(found, own, strict=True):
        nearly(np.array(shown) % 360, np.full(len(shown), angle), 1e-9)
    assert sum(map(len, own)) == len(angles)
    assert none == -1


@pytest.mark.parametrize("name", CUBES)
def test_all_stand_where_python_puts_them(evaluate: Evaluate, name: str) -> None:
    cube, _, data = held_in_a_page(name)
    found = asked(evaluate, data, "argument.angles.map((angle) => standing(scene, angle))", angles=ANGLES)
    for angle, room in zip(ANGLES, found, strict=True):
        wanted = standing(cube, angle)
        nearly(np.reshape(room["turn"], (3, 3)), wanted.turn, 1e-12)
        nearly(room["axis"], wanted.axis, 1e-12)
        assert len(room["screens"]) == len(wanted.screens)
        for screen, placed in zip(room["screens"], wanted.screens, strict=True):
            for field in ("corner", "right", "down", "pixels", "facing"):
                nearly(screen[field], getattr(placed, field), 1e-9)
        assert len(room["lamps"]) == len(wanted.lamps)
        for lamp, stood in zip(room["lamps"], wanted.lamps, strict=True):
            nearly(lamp["place"], stood.place, 1e-6)
            nearly(lamp["light"], np.broadcast_to(stood.light, 3), 1e-9)
            assert lamp["parallel"] == stood.parallel


# beam.js


def plain_views(views: Views) -> list[dict[str, Any]]:
    """Views as far as a beam needs them."""
    fields = {"light": views.lamps, "origin": views.origins, "right": views.column_steps, "down": views.row_steps}
    return [{name: array[view].tolist() for name, array in fields.items()} for view in range(len(views))]


BEAMS = """argument.views.map((view) => argument.pixels.map(([row, column]) => {
  const beam = beamOf(view, row, column, argument.raster);
  const { start, way, first, last } = beam;
  return { ...beam, ...walk(argument.shape, argument.mm, start, way, first, last),
    inside: stretchInside(argument.shape, argument.mm, beam) };
}))"""


def walked(evaluate: Evaluate, grid: Grid, views: Views) -> list[Any]:
    pixels = list(np.ndindex(*views.picture_shape))
    argument = {"views": plain_views(views), "pixels": pixels, "raster": views.picture_shape}
    argument |= {"shape": grid.shape, "mm": grid.voxel_mm}
    found = evaluate(("beam.js",), PLAIN % BEAMS, argument)
    return [(view, *pixel, found[view][i]) for view in range(len(views)) for i, pixel in enumerate(pixels)]


@pytest.mark.parametrize("lamp", lamps_for((1, 1, 1)))
@pytest.mark.parametrize("shape", [(3, 5, 7), (4, 6, 5)])
def test_walks_meet_what_plain_boxes_do(evaluate: Evaluate, shape: tuple[int, int, int], lamp: str) -> None:
    """Ties included, and beams end at their lamp and their pixel."""
    grid = Grid(shape, 1.3)
    views = lit(grid, [lamps_for(shape)[lamp]], list(screens_for(shape).values()), (2, 3))
    met = 0
    for view, row, column, beam in walked(evaluate, grid, views):
        point, way, first, last = plain.beam_of_pixel(views, view, row, column)
        wanted = plain.lengths_of_beam(grid, point, way, first, last)
        found = np.zeros(grid.shape)
        np.add.at(found.reshape(-1), np.array(beam["voxels"], int), beam["lengths"])
        nearly(found, wanted, 1e-9)
        nearly(beam["pixel"], point, 1e-12)
        nearly(beam["way"], way, 1e-12)
        assert (beam["inside"] is None) == (len(beam["voxels"]) == 0)
        met += len(beam["voxels"])
        if beam["inside"]:
            start, end = np.array(beam["inside"]["start"]), np.array(beam["inside"]["end"])
            long = np.linalg.norm(end - start)
            nearly(end - start, long * way, 1e-9)
            nearly(np.cross(start - point, way), np.zeros(3), 1e-9)
            assert min(abs(long * part - wanted.sum()) for part in (1, 0.5, 0.25)) < 1e-9  # parts outside vanish
    assert met > 0


def test_a_beam_to_the_lamp_itself_meets_nothing(evaluate: Evaluate) -> None:
    views = Views(np.array([[1.0, 2, 0.5, 1]]), np.array([[1.0, 2, 0.5]]), -np.eye(3)[1:2], -np.eye(3)[2:], (1, 1))
    ((*_, beam),) = walked(evaluate, GRID, views)
    assert beam["voxels"] == []
    assert beam["inside"] is None
    assert np.linalg.norm(beam["way"]) == 1


# cast.js


@pytest.mark.parametrize("name", CUBES)
def test_pictures_are_those_of_play(evaluate: Evaluate, name: str) -> None:
    _, packed, data = held_in_a_page(name)
    expression = """argument.angles.flatMap((angle) => exposures(scene, angle)).map((exposure) => {
      return { light: castPicture(cube, exposure), row: castRow(cube, exposure, 1) };
    })"""
    found = asked(evaluate, data, expression, angles=ANGLES)
    wanted = np.broadcast_to(play(packed.cube, ANGLES), (*play(packed.cube, ANGLES).shape[:3], 3))
    assert len(found) == len(wanted)
    assert np.ptp(wanted) > 0.5
    for each, picture in zip(found, wanted, strict=True):
        nearly(np.reshape(each["light"], picture.shape), picture, 3e-6)
        nearly(np.reshape(each["row"], picture[1].shape), picture[1], 3e-6)


# sheet.js


SHEETS = """argument.angles.flatMap((angle) => exposures(scene, angle)).flatMap((exposure) =>
  exposure.views.flatMap((view, number) => [0, 1, 2].map((row) => ({
    row, number, exposure, sheet: sheetOf(cube, exposure, number, row),
    facts: Array.from({ length: exposure.window[1] }, (_, c) => beamFacts(cube, exposure, number, row, c)),
  }))))"""


def sheets(evaluate: Evaluate, name: str, angles: tuple[float, ...]) -> tuple[Cube, list[Any], list[Views]]:
    """The packed cube, its sheets, and for each of them its view by itself."""
    return sheets_of(evaluate, *held_in_a_page(name)[1:], angles)


def sheets_of(
    evaluate: Evaluate, packed: Packed, data: dict[str, str], angles: tuple[float, ...]
) -> tuple[Cube, list[Any], list[Views]]:
    found = asked(evaluate, data, SHEETS, angles=angles)
    views, _, _ = exposures_at(as_stage(packed.cube), angles)
    return packed.cube, found, [views.take([i // 3]) for i in range(len(found))]


@pytest.mark.parametrize("name", ["level", "raised, moved", "stage"])
def test_what_a_beam_meets_is_a_row_of_the_matrix(evaluate: Evaluate, name: str) -> None:
    cube, found, alone = sheets(evaluate, name, (10.0, 102.5))
    for each, view in zip(found, alone, strict=True):
        for column, facts in enumerate(each["facts"]):
            lengths = plain.lengths_of_beam(GRID, *plain.beam_of_pixel(view, 0, each["row"], column))
            met = np.zeros(GRID.shape)
            np.add.at(met.reshape(-1), np.array(facts["voxels"], int), facts["lengths"])
            nearly(met, lengths, 1e-9)
            assert facts["left"] == [1, 1, 1] or facts["voxels"]
            nearly(facts["left"], np.exp(-np.einsum("zyx,czyx->c", lengths, cube.extinction)), 1e-6)


@pytest.mark.parametrize("name", ["level, moved, held", "raised", "one colour", "stage", "lamps go round"])
def test_a_sheet_shows_its_row_of_the_screen(evaluate: Evaluate, name: str) -> None:
    cube, found, _ = sheets(evaluate, name, (43.7, 130.0))
    wanted = np.clip(encode(play(cube, (43.7, 130.0)), cube.transfer), 0, 1)
    picture = -1
    for each in found:
        picture += (each["number"], each["row"]) == (0, 0)
        beams = each["sheet"]["beams"]
        assert [beam["column"] for beam in beams] == list(range(each["exposure"]["window"][1]))
        own = wanted[picture, each["row"], : len(beams)]
        nearly([beam["shown"] for beam in beams], np.broadcast_to(own, (len(beams), 3)), 1e-5)
        for beam, facts in zip(beams, each["facts"], strict=True):
            assert (beam["start"] is None) == (beam["end"] is None) == (facts["voxels"] == [])


@pytest.mark.parametrize("name", ["level", "level, moved, held"])
def test_level_light_runs_in_one_slice(evaluate: Evaluate, name: str) -> None:
    _, found, alone = sheets(evaluate, name, ANGLES)
    for each, view in zip(found, alone, strict=True):
        sheet = each["sheet"]
        height = (view.origins[0] + (each["row"] - 1) * view.row_steps[0])[2] / GRID.voxel_mm + 1.5
        assert (sheet["axis"], sheet["shape"]) == (2, [5, 7])
        inside = 0 < height < 3
        wanted = int(height) * 35 + np.arange(35) if inside else np.full(35, -1)
        np.testing.assert_array_equal(sheet["cells"], wanted)
        assert {voxel for facts in each["facts"] for voxel in facts["voxels"]} <= set(sheet["cells"])


@pytest.mark.parametrize("name", ["raised", "stage", "lamps go round"])
def test_cells_are_the_voxels_at_the_height_of_the_plane(evaluate: Evaluate, name: str) -> None:
    """And every voxel that a beam of the row meets is one of them, or the next above or below."""
    _, found, alone = sheets(evaluate, name, ANGLES[:6])
    axes = set()
    for each, view in zip(found, alone, strict=True):
        axis, cells = each["sheet"]["axis"], np.array(each["sheet"]["cells"]).reshape(each["sheet"]["shape"])
        pixels = [plain.beam_of_pixel(view, 0, each["row"], column)[:2] for column in (0, view.picture_shape[1] - 1)]
        normal = np.cross(pixels[0][1], pixels[1][0] - pixels[0][0])
        axes.add(axis)
        assert abs(normal[axis]) == pytest.approx(np.abs(normal).max())
        others = [other for other in (2, 1, 0) if other != axis]
        counts = GRID.shape[::-1]
        assert cells.shape == tuple(counts[other] for other in others)
        heights = np.empty(cells.shape)
        for cell in np.ndindex(cells.shape):
            middle = np.zeros(3)
            middle[others] = [(cell[i] + 0.5 - counts[other] / 2) * GRID.voxel_mm for i, other in enumerate(others)]
            away = normal @ (pixels[0][0] - middle) / normal[axis] / GRID.voxel_mm
            heights[cell] = height = away + counts[axis] / 2
            place = np.zeros(3, int)
            place[others], place[axis] = cell, int(np.floor(height))
            wanted = np.ravel_multi_index(place[::-1], GRID.shape) if 0 <= height < counts[axis] else -1
            assert cells[cell] == wanted or abs(height - round(height)) < 1e-6
        for facts in each["facts"]:
            for voxel in facts["voxels"]:
                at = np.unravel_index(voxel, GRID.shape)[::-1]
                assert -1 - 1e-9 <= heights[tuple(at[other] for other in others)] - at[axis] <= 2 + 1e-9
    assert len(axes) > (name != "raised")


@pytest.mark.parametrize("off", [0.5, -0.5])
def test_a_plane_along_faces_shows_a_slice_beside_it(evaluate: Evaluate, off: float) -> None:
    """Level beams half a voxel down, or up: the lowest, or highest, run on the outside of the cube."""
    views = table(0, 70)
    cube = on_table(replace(views, origins=views.origins + off * views.row_steps))
    _, found, _ = sheets_of(evaluate, *paged(cube)[1:], (0.0, 30.0))
    assert len(found) == 6
    for each in found:
        height = round(2.5 - off - each["row"])
        assert set(np.array(each["sheet"]["cells"]) // 35) == {min(height, 2)}
        slices = {voxel // 35 for facts in each["facts"] for voxel in facts["voxels"]}
        assert slices == {height, height - 1} & {0, 1, 2}
        for beam, facts in zip(each["sheet"]["beams"], each["facts"], strict=True):
            assert (beam["start"] is None) == (facts["voxels"] == [])
