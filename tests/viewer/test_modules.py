"""The page's modules: their rooms, how they are joined, and their mathematics against the Python that it repeats."""

import re
import zipfile
from dataclasses import replace
from graphlib import TopologicalSorter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hatchling.builders.wheel import WheelBuilder

import lightcube
from lightcube.drawing.standing import drawn, standing
from lightcube.forward.turning import moment, powers_of
from lightcube.optics.light import JUDGE_DISC, discs_sampled
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import decode, encode
from lightcube.optics.views import rotations
from lightcube.viewer import modules
from lightcube.viewer.description import describe
from tests.helpers.areas import THIN, averaged, judged
from tests.helpers.paging import (
    ANGLES,
    CUBES,
    GIVEN,
    GRID,
    PLAIN,
    RANDOM,
    Evaluate,
    asked,
    held_in_a_page,
    nearly,
    on_table,
    paged,
)
from tests.helpers.thin import cast

WEB = Path(lightcube.__file__).parent / "viewer" / "web"
MODULES = sorted(file.relative_to(WEB).as_posix() for file in WEB.rglob("*.js"))
#: The rooms, and from which ones each may import; those at the door stand in none.
ROOMS = {
    "tools": {"tools"},
    "model": {"tools", "model"},
    "room": {"tools", "model", "room"},
    "parts": {"tools", "model", "parts"},
    "": {"tools", "model", "room", "parts", ""},
}
DOORS = ("page.js", "widget.js")


def room(path: str) -> str:
    """The folder that a module stands in."""
    return path.rpartition("/")[0]


def text_of(path: str) -> str:
    """A module without its comments."""
    return re.sub(r"/\*.*?\*/|(?<![:\"'`])//[^\n]*", "", modules.source(path), flags=re.DOTALL)


# rooms


@pytest.mark.parametrize("path", MODULES)
def test_imports_run_downhill(path: str) -> None:
    assert {room(needed) for needed in modules.imports(path)} <= ROOMS[room(path)]


def test_nothing_imports_what_stands_at_the_door() -> None:
    """But the page and the widget, which open the app."""
    found = {(path, needed) for path in MODULES for needed in modules.imports(path) if room(needed) == ""}
    assert found == {*((door, "app.js") for door in DOORS), ("page.js", "plate.js"), ("page.js", "films.js")}


def test_imports_form_no_circle() -> None:
    TopologicalSorter({path: modules.imports(path) for path in MODULES}).prepare()


@pytest.mark.parametrize("path", MODULES)
def test_what_is_imported_is_exported_and_used(path: str) -> None:
    text = text_of(path)
    for names, place in re.findall(r'^import \{([^}]*)\} from "([^"]*)";$', text, re.MULTILINE):
        needed = (WEB / path).parent.joinpath(place).resolve().relative_to(WEB.resolve()).as_posix()
        for name in re.findall(r"\w+", names):
            assert name in modules.exports(needed), f"{needed} does not export {name}"
            assert len(re.findall(rf"\b{name}\b", text)) > 1, f"{path} does not use {name}"


def test_what_is_exported_is_taken() -> None:
    """By another module, by the studio's page, or by the tests."""
    tests = "".join(file.read_text() for file in Path(__file__).parents[1].rglob("*.py"))
    studio = "".join(file.read_text() for file in Path(lightcube.__file__).with_name("studio").rglob("*.js"))
    for path in MODULES:
        others = "".join(text_of(other) for other in MODULES if path in modules.imports(other))
        for name in modules.exports(path):
            assert any(re.search(rf"\b{name}\b", taken) for taken in (others, studio, tests)), f"{path}: {name}"


@pytest.mark.parametrize("path", MODULES)
def test_a_module_says_first_what_it_is(path: str) -> None:
    first, second, *_ = modules.source(path).splitlines()
    assert re.fullmatch(r"// [A-Z].*\.", first)
    assert second == ""


MODEL = [path for path in MODULES if room(path) == "model"]


@pytest.mark.parametrize("path", [*MODEL, "tools/vectors.js"])
def test_the_model_has_no_document(path: str) -> None:
    assert {room(needed) for needed in modules.imports(path)} <= {"model", "tools"}
    assert "tools/elements.js" not in modules.imports(path)
    assert not re.search(
        r"\bdocument\b|(?<![.\w])window[.[]|\bHTML\w+|\bSVG\w+|\bmatchMedia\b|\bgetContext\b", text_of(path)
    )


#: Runs a text apart from the page, where there is no document, and hands back what it answers.
APART = """new Promise((done, failed) => {
  const worker = new Worker(URL.createObjectURL(new Blob([argument.text])));
  worker.onmessage = ({ data }) => done(data);
  worker.onerror = (event) => failed(new Error(event.message));
  worker.postMessage(argument);
})"""
TOLD = """{
  at: momentOf(scene, new Turning(stops(scene), true), exposures(scene, 10), { place: 0, row: 1, column: null }),
  pictures: exposures(scene, 10).map((exposure) => castPicture(cube, exposure, [[0, 0]])),
  sheet: sheetOf(cube, exposures(scene, 10)[0], 0, 1, [[0, 0]]),
  room: standing(scene, 10),
  page: typeof document + typeof window,
}"""


def test_the_model_runs_without_a_page(evaluate: Evaluate) -> None:
    data = held_in_a_page("stage")[2]
    answer = f"onmessage = ({{ data: argument }}) => {GIVEN % (PLAIN % f'({TOLD})')}.then(postMessage, postMessage);"
    apart = evaluate((), APART, data | {"text": f"{modules.joined(*MODEL)}\n{answer}"})
    assert apart.pop("page") == "undefinedundefined"
    inside = evaluate(tuple(MODEL), GIVEN % (PLAIN % f"({TOLD})"), data)
    assert inside.pop("page") == "objectobject"
    assert apart == inside


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


def test_names_that_are_not_exported_stay_in_their_module(evaluate: Evaluate, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modules, "source", TWINS.__getitem__)
    both, *unseen = evaluate(("other.js",), "[new Other().both, typeof one, typeof size, typeof SIZE]")
    assert both == [1, 2]
    assert unseen == ["undefined"] * 3


def test_each_is_joined_once_and_after_what_it_imports() -> None:
    found = re.findall(r"^const \$(\w+) = \(\(\) => \{$", modules.joined(*DOORS), re.MULTILINE)
    names = {path: path.removesuffix(".js").replace("/", "_") for path in MODULES}
    assert sorted(found) == sorted(names.values())
    for path in MODULES:
        assert all(found.index(names[needed]) < found.index(names[path]) for needed in modules.imports(path))


def test_joined_text_imports_and_exports_nothing() -> None:
    assert not re.search(r"^\s*(import|export)\b", modules.joined(*MODULES), re.MULTILINE)


def test_each_works_as_a_module_of_its_own(browser: Any) -> None:
    """Unjoined, and exports what it does where it is joined."""
    tab = browser.new_page()

    def send(route: Any) -> None:
        name = route.request.url.removeprefix("http://lightcube.test/")
        if name == "":
            route.fulfill(body='<main id="lightcube"></main>', content_type="text/html")
        else:
            route.fulfill(body=modules.source(name), content_type="text/javascript")

    tab.route("**/*", send)
    tab.goto("http://lightcube.test/")
    for path in MODULES:
        assert sorted(modules.exports(path)) == tab.evaluate(f"import('/{path}').then(Object.keys)"), path
    tab.close()


def test_a_wheel_holds_all_of_the_page(tmp_path: Path) -> None:
    root = Path(__file__).parents[2]
    wheel = zipfile.ZipFile(next(WheelBuilder(str(root)).build(directory=str(tmp_path), versions=["standard"])))
    for file in filter(Path.is_file, WEB.rglob("*")):
        path = file.relative_to(WEB).as_posix()
        assert wheel.read(f"lightcube/viewer/web/{path}") == file.read_bytes()
        assert modules.source(path) == file.read_text(encoding="utf-8")


# tools/vectors.js and model/light.js


def test_rotations_are_those_of_python(evaluate: Evaluate) -> None:
    axes = RANDOM.normal(size=(4, 3)).tolist() + np.eye(3).tolist()
    angles_deg = [*RANDOM.uniform(-800, 800, 5), *range(-450, 451, 90), 45.0, -1e-20]
    expression = "argument.axes.map((axis) => argument.angles_deg.map((angle) => rotation(axis, angle)))"
    found = evaluate(("tools/vectors.js",), expression, {"axes": axes, "angles_deg": angles_deg})
    wanted = np.stack([rotations(axis, np.array(angles_deg)) for axis in axes])
    nearly(np.reshape(found, wanted.shape), wanted, 1e-14)
    right = np.array(found[-1]).reshape(-1, 3, 3)[5:16]
    np.testing.assert_array_equal(right, np.rint(right))


def test_vectors_are_those_of_numpy(evaluate: Evaluate) -> None:
    a, b = RANDOM.normal(size=(2, 3))
    m = RANDOM.normal(size=(3, 3))
    expression = """(({ a, b, m }) => [[dot(a, b), norm(a), modulo(-7.5, 2)], cross(a, b), add(a, b), sub(a, b),
        scaled(a, 3), unit(b), apply(m, a), applyInverse(m, a)])(argument)"""
    found = evaluate(("tools/vectors.js",), expression, {"a": a.tolist(), "b": b.tolist(), "m": m.ravel().tolist()})
    length = np.linalg.norm
    wanted = [[a @ b, length(a), 0.5], np.cross(a, b), a + b, a - b, 3 * a, b / length(b), m @ a, m.T @ a]
    nearly(found, wanted, 1e-14)


@pytest.mark.parametrize("transfer", ["srgb", "linear"])
def test_display_values_are_those_of_python(evaluate: Evaluate, transfer: Any) -> None:
    values = np.concatenate([np.linspace(0, 0.05, 60), np.linspace(0.05, 3, 60), [0.04045, 0.0031308]])
    expression = f"argument.map((x) => [encode(x, '{transfer}'), decode(x, '{transfer}')])"
    found = np.array(evaluate(("model/light.js",), expression, values.tolist()))
    nearly(found[:, 0], encode(values, transfer), 1e-14)
    nearly(found[:, 1], decode(values, transfer), 1e-14)


# model/stage.js


@pytest.mark.parametrize("name", CUBES)
def test_exposures_are_those_of_python(evaluate: Evaluate, name: str) -> None:
    cube, _, data = held_in_a_page(name)
    staged = drawn(cube)
    found = asked(evaluate, data, "argument.angles_deg.map((angle) => exposures(scene, angle))", angles_deg=ANGLES)
    rig, powers = moment(staged, ANGLES)
    shown = [exposure for at_angle in found for exposure in at_angle]
    assert [exposure["screen"] for exposure in shown] == rig.stops.screen.tolist()
    assert [exposure["angle"] for exposure in shown] == rig.stops.angle_deg.tolist()
    nearly([exposure["window"] for exposure in shown], rig.stops.window, 0)
    assert all(tuple(exposure["raster"]) == rig.picture_shape for exposure in shown)
    each = [view for exposure in shown for view in exposure["views"]]
    for field, wanted in (
        ("light", rig.views.lamps),
        ("origin", rig.views.origins_mm),
        ("right", rig.views.column_steps_mm),
        ("down", rig.views.row_steps_mm),
        ("power", np.broadcast_to(powers[rig.pair] * rig.sums.share, (len(rig.views), 3))),
        ("reach_mm", rig.fading.reach_mm),
        ("falloff_mm", rig.fading.falloff_mm),
        ("full_at_mm", rig.fading.full_at_mm),
        ("cosine", rig.fading.cosine),
        ("veil", rig.fading.veil),
        ("lamp", rig.sums.lamp),
    ):
        nearly([view[field] for view in each], wanted, 1e-9)
    dark = [not exposure["lit"] for exposure in shown for _ in exposure["views"]]
    np.testing.assert_array_equal(dark, np.all(powers[rig.pair] * rig.sums.share == 0, axis=1))


def test_a_lamp_with_a_size_is_as_many_views_as_all_is_judged_by() -> None:
    """A page averages over pixels itself."""
    cube = CUBES["raised"]
    soft = replace(cube, rig=replace(cube.rig, sums=replace(cube.rig.sums, disc_deg=cube.rig.sums.disc_deg + 2)))
    plain, several = (describe(each, paged(each)[1], "")["views"] for each in (cube, soft))
    assert len(several) == JUDGE_DISC * len(plain)
    for k, view in enumerate(plain):
        own = several[k * JUDGE_DISC : (k + 1) * JUDGE_DISC]
        assert {each["picture"] for each in own} == {view["picture"]}
        nearly(np.mean([each["light"] for each in own], axis=0), view["light"], 1e-9)
        nearly(np.sum([each["share"] for each in own], axis=0), view["share"], 1e-9)


@pytest.mark.parametrize("name", ["raised", "level, moved, held"])
def test_a_whole_shadow_has_its_middle_in_the_middle(evaluate: Evaluate, name: str) -> None:
    """And shows what Python does, on the screen's plane."""
    cube, packed, data = held_in_a_page(name)
    expression = """argument.angles_deg.map((angle) => {
      const [exposure] = exposures(scene, angle, true);
      return { exposure, room: standing(scene, angle, true), picture: castPicture(cube, exposure, [[0, 0]]) };
    })"""
    found = asked(evaluate, data, expression, angles_deg=ANGLES)
    rig, _ = cube.rig.whole(cube.grid).at(ANGLES)
    wanted = averaged(packed.cube, ANGLES, THIN, whole=True)
    for i, each in enumerate(found):
        exposure, room = each["exposure"], each["room"]
        assert tuple(exposure["raster"]) == tuple(exposure["window"]) == rig.picture_shape
        origin = np.array(exposure["views"][0]["origin"])
        nearly(np.cross(origin, rig.views.lamps[i, :3]), np.zeros(3), 1e-9)
        screen = standing(cube, ANGLES[i]).screens[0]
        assert abs(np.reshape(room["turn"], (3, 3)) @ origin @ screen.facing - screen.corner @ screen.facing) < 1e-9
        across = 0.5 * (rig.picture_shape[1] * screen.right + rig.picture_shape[0] * screen.down)
        nearly(np.reshape(room["turn"], (3, 3)) @ origin - across, room["screens"][0]["corner"], 1e-9)
        nearly(np.reshape(each["picture"], wanted[i].shape), wanted[i], 2e-6)


def test_a_lamp_with_a_size_blurs_the_whole_shadow_on_its_own_screen(evaluate: Evaluate) -> None:
    rig = turntable(GRID, [5, 95], elevation_deg=30, picture_shape=(3, 5), lamp_deg=9.0, screen_mm=6.0)
    cube = on_table(rig.shifted(np.array([[1, -1], [0, 2]])))
    np.testing.assert_array_equal(drawn(cube).rig.views.origins_mm, cube.rig.views.origins_mm)
    _, packed, data = paged(cube)
    expression = """argument.angles_deg.map((angle) =>
      castPicture(cube, exposures(scene, angle, true)[0], [[0, 0]]))"""
    found = asked(evaluate, data, expression, angles_deg=ANGLES)
    now, _ = packed.cube.rig.whole(packed.cube.grid).at(ANGLES)
    powers = powers_of(packed.cube, now)
    for each, picture in zip(found, cast(packed.cube, discs_sampled(now), powers), strict=True):
        nearly(np.reshape(each, picture.shape), picture, 2e-6)


@pytest.mark.parametrize("name", CUBES)
def test_stops_are_each_named_once_and_shown_at_their_angle(evaluate: Evaluate, name: str) -> None:
    cube, _, data = held_in_a_page(name)
    angles_deg = drawn(cube).angles_deg
    expression = """[stops(scene), stops(scene).map((angle) => exposures(scene, angle).filter((e) => e.lit)
      .map((e) => scene.pictures[e.picture].angle_deg)), nearestPicture(scene, 7, 0)]"""
    found, own, none = asked(evaluate, data, expression)
    nearly(found, np.unique(angles_deg % 360), 1e-9)
    for angle_deg, shown in zip(found, own, strict=True):
        nearly(np.array(shown) % 360, np.full(len(shown), angle_deg), 1e-9)
    assert sum(map(len, own)) == len(angles_deg)
    assert none == -1


@pytest.mark.parametrize("name", CUBES)
def test_all_stand_where_python_puts_them(evaluate: Evaluate, name: str) -> None:
    cube, _, data = held_in_a_page(name)
    found = asked(evaluate, data, "argument.angles_deg.map((angle) => standing(scene, angle))", angles_deg=ANGLES)
    for angle_deg, room in zip(ANGLES, found, strict=True):
        wanted = standing(cube, angle_deg)
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


# model/cast.js


@pytest.mark.parametrize("beams", ["THIN", "JUDGED"])
@pytest.mark.parametrize("name", CUBES)
def test_pictures_are_plain_averages(evaluate: Evaluate, name: str, beams: str) -> None:
    _, packed, data = held_in_a_page(name)
    expression = f"""argument.angles_deg.flatMap((angle) => exposures(scene, angle)).map((exposure) => {{
      const points = pointsOf(cube, exposure, {beams});
      return {{ light: castPicture(cube, exposure, points), row: castRow(cube, exposure, 1, points) }};
    }})"""
    found = asked(evaluate, data, expression, angles_deg=ANGLES)
    light = averaged(packed.cube, ANGLES, THIN) if beams == "THIN" else judged(packed.cube, ANGLES)
    wanted = np.broadcast_to(light, (*light.shape[:3], 3))
    assert len(found) == len(wanted)
    assert np.ptp(wanted) > 0.5
    for each, picture in zip(found, wanted, strict=True):
        nearly(np.reshape(each["light"], picture.shape), picture, 3e-6)
        nearly(np.reshape(each["row"], picture[1].shape), picture[1], 3e-6)
