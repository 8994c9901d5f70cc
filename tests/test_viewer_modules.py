"""The page's mathematics, module by module in a browser, against the Python that it repeats."""

from typing import Any

import numpy as np
import pytest

from lightcube.forward import exposures_at, play, views_at
from lightcube.geometry import rotations
from lightcube.standing import as_stage, standing
from lightcube.transfer import decode, encode
from lightcube.viewer import modules
from tests.paging import ANGLES, CUBES, RANDOM, Evaluate, asked, held_in_a_page, nearly

# joined

TWINS = {
    "one.js": """const SIZE = 1;

export function one() {
  return size();
}

function size() {
  return SIZE;
}
""",
    "other.js": """import { one } from "./one.js";

const SIZE = 2;

export class Other {
  both = [one(), size()];
}

function size() {
  return SIZE;
}
""",
}


def test_names_that_are_not_exported_are_a_module_s_own(evaluate: Evaluate, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modules, "source", TWINS.__getitem__)
    assert evaluate(("other.js",), "[new Other().both, typeof one, typeof size, typeof SIZE]") == [
        [1, 2],
        *["undefined"] * 3,
    ]


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
