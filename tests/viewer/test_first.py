"""The page's first seconds: what stands large, what is said, what moves by itself, and what the lamp sees."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from lightcube import io
from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.viewer.description import describe
from lightcube.viewer.label import Label
from lightcube.viewer.packing import pack
from lightcube.viewer.page import page
from tests.cli.test_cli import run
from tests.helpers.browser import opened
from tests.helpers.visiting import (
    CUBE,
    PHONE,
    STOPS,
    Open,
    angle_deg,
    pages,
    rested,
    right,
    stands,
    turned_to,
    turning,
    until,
    visit,
)
from tests.viewer.test_shadows import given

__all__ = ["pages", "run", "visit"]

WALL = """(() => {
  const wall = document.querySelector(".wall canvas");
  const copy = document.createElement("canvas");
  Object.assign(copy, { width: wall.width, height: wall.height });
  copy.getContext("2d").drawImage(wall, 0, 0);
  const { data } = copy.getContext("2d").getImageData(0, 0, wall.width, wall.height);
  return [wall.height, wall.width, [...data]];
})()"""
SEES = """(async () => {
  const { angle, scene } = argument;
  const cube = await readVoxels(fromBase64(argument.voxels), scene);
  const canvas = Object.assign(document.createElement("canvas"), { width: 480, height: 320 });
  const [room, shown] = [standing(scene, angle), exposures(scene, angle)];
  const camera = cameraOf(lampsOrbit(scene, shown, room), 1.5);
  const painter = createRenderer(canvas, scene, cube);
  painter.cast(shown, THIN, 1);
  painter.draw(room, camera, { dark: true, mark: null, scale: 1, bare: 1 });
  const copy = Object.assign(document.createElement("canvas"), { width: 480, height: 320 }).getContext("2d");
  copy.drawImage(canvas, 0, 0);
  const [rows, columns] = room.screens[0].pixels;
  const found = [];
  for (let row = 0; row < rows; row++) for (let column = 0; column < columns; column++) {
    const { x, y } = seenAt(camera, middleOfPixel(room, { screen: 0, row, column }));
    found.push([...copy.getImageData(Math.floor(480 * x), Math.floor(320 * y), 1, 1).data].slice(0, 3));
  }
  painter.dispose();
  return { found, rows, columns };
})()"""
MODULES = (
    "model/area.js",
    "model/data.js",
    "model/stage.js",
    "room/camera.js",
    "room/furniture.js",
    "room/gpu.js",
)


def on_the_wall(tab: Any) -> Any:
    rows, columns, levels = tab.evaluate(WALL)
    return np.array(levels, float).reshape(rows, columns, 4)[..., :3]


@pytest.mark.parametrize("where", [STOPS[0], 95.0])
def test_the_wall_shows_the_light_large(visit: Open, where: float) -> None:
    tab = visit(width=1280, height=800, reduced_motion="reduce")
    tab.evaluate(f"{CUBE}.turnTo({where})")
    rested(tab)
    assert np.abs(on_the_wall(tab) - right(turning(), where)[0]).max() <= 0.55
    assert tab.locator(".wall canvas").bounding_box()["width"] > 1280 / 4
    said = tab.locator(".wall .name").inner_text()
    assert said == ("astronaut" if where == STOPS[0] else "between two pictures")


def test_on_a_phone_the_picture_can_be_seen_at_once(visit: Open) -> None:
    tab = visit(**PHONE)
    box = tab.locator(".wall canvas").bounding_box()
    assert box["y"] > 0
    assert box["y"] + box["height"] < 844
    assert min(box["width"], box["height"]) > 180
    for each in (".controls", ".filmstrip"):
        below = tab.locator(each).bounding_box()
        assert below["y"] + below["height"] <= 844 + 1


def test_on_its_side_a_phone_shows_both(visit: Open) -> None:
    tab = visit(width=844, height=390, has_touch=True, is_mobile=True)
    for each in ("canvas.room", ".wall canvas", ".controls"):
        box = tab.locator(each).bounding_box()
        assert box["y"] + box["height"] <= 390 + 1
        assert box["height"] > (200 if each != ".controls" else 30)


def test_a_sentence_says_what_this_is(visit: Open) -> None:
    assert "at each stop its shadow is another picture" in visit().locator(".what").inner_text()
    still = visit("still").locator(".what").inner_text()
    assert still == "Light falls through a block of coloured glass; its shadows are pictures."


def test_numbers_wait_behind_details(visit: Open) -> None:
    tab = visit(width=1280, height=900)
    seen = "document.getElementById('lightcube').innerText"
    assert "dB" not in tab.evaluate(seen)
    assert tab.locator(".thumbnail .mark").count() == len(STOPS)
    assert not tab.locator(".scanline").is_visible()
    button = tab.get_by_role("button", name="Details")
    button.click()
    rested(tab)
    assert button.get_attribute("aria-pressed") == "true"
    assert "dB" in tab.evaluate(seen)
    assert tab.locator(".scanline").is_visible()
    tab.keyboard.press("d")
    assert "dB" not in tab.evaluate(seen)


def test_the_row_is_marked_where_one_points_only(visit: Open) -> None:
    tab = visit(width=1280, height=900, details=True)
    line = "getComputedStyle(document.querySelector('.choose .line')).visibility"
    assert tab.evaluate(line) == "hidden"
    tab.locator(".choose").hover()
    assert tab.evaluate(line) == "visible"


def test_untouched_it_turns_once_to_the_next_stop_and_touched_or_calm_it_stays(visit: Open) -> None:
    others = [visit(), visit(untouched=True, reduced_motion="reduce")]
    tab = visit(untouched=True)
    stands(tab, STOPS[1])
    tab.wait_for_timeout(4500)
    assert angle_deg(tab) == STOPS[1]
    assert [angle_deg(each) for each in others] == [STOPS[0]] * 2


def test_where_its_address_says_so_it_plays(visit: Open) -> None:
    tab = visit(untouched=True)
    tab.evaluate("location.hash = '#play'")
    for where in STOPS[1:3]:
        until(tab, f"Math.abs({CUBE}.angle - {where}) < 1e-6")
    turned_to(tab, STOPS[0])


def test_threads_lead_from_the_wall_to_its_picture(visit: Open) -> None:
    tab = visit(width=1280, height=800, reduced_motion="reduce")
    ends = tab.evaluate("""(() => {
      const line = document.querySelector(".threads path").getAttribute("d");
      return line.match(/M[^M]*/g).map((each) => each.slice(1).split("L").map((end) => end.split(",").map(Number)));
    })()""")
    box = tab.locator(".wall canvas").bounding_box()
    rows, columns = on_the_wall(tab).shape[:2]
    high = min(box["height"], box["width"] * rows / columns)
    for (start, end), row in zip(ends, (0, 1), strict=True):
        assert end[0] == pytest.approx(box["x"] + (box["width"] - high * columns / rows) / 2, abs=1)
        assert end[1] == pytest.approx(box["y"] + (box["height"] - high) / 2 + row * high, abs=1)
        assert start[0] < end[0]


def test_the_wall_stands_wide_and_faces_the_eye(evaluate: Open) -> None:
    rig = turntable(Grid((16, 16, 16), 2.0), [20.0, 80.0, 200.0], elevation_deg=35.0, picture_shape=(8, 8))
    cube = Cube(np.full((3, 16, 16, 16), 0.02, np.float32), Grid((16, 16, 16), 2.0), rig)
    found = evaluate(
        ("model/stage.js", "room/camera.js", "room/furniture.js"),
        """(() => {
          const { scene } = argument;
          const [room, wide] = [standing(scene, 20), roomsAround(scene)];
          const orbit = fitted(orbitFrom(scene.camera), scene, wide, 1.4);
          const camera = cameraOf(orbit, 1.4);
          const screen = room.screens[0];
          const [across, below] = [screen.right, screen.down].map((step) => Math.hypot(...step));
          const more = wallWidth(scene, screen) / across;
          const at = (column, row) => seenAt(camera, screen.corner.map((c, i) =>
            c + column * screen.right[i] + row * screen.down[i]));
          const [left, right] = [at(-more, 4), at(screen.pixels[1] + more, 4)];
          const middle = at(4, 4);
          const way = screen.corner.map((c, i) => c - camera.eye[i]);
          const facing = -way.reduce((sum, w, i) => sum + w * screen.facing[i], 0) / Math.hypot(...way);
          return { wide: Math.abs(right.x - left.x), facing, x: middle.x, y: middle.y };
        })()""",
        {"scene": json.loads(json.dumps(describe(cube, pack(cube), "a wall")))},
    )
    assert found["wide"] > 1 / 3
    assert found["facing"] > 0.7
    assert found["x"] > 0.5  # one reads on from the lamp, through the glass, to the picture


def test_the_lamps_eye_sees_the_picture(evaluate: Open) -> None:
    """Through the glass along the lamp's light each pixel has the colour that its thin beam brings to the wall."""
    level = turntable(Grid((6, 8, 10), 1.3), [0.0, 70.0], picture_shape=(6, 8))
    glass = np.random.default_rng(5).uniform(0, 0.1, (3, 6, 8, 10)).astype(np.float32)
    for cube, where in ((turning(), STOPS[0]), (turning(), 95.0), (Cube(glass, Grid((6, 8, 10), 1.3), level), 70.0)):
        seen = evaluate(MODULES, SEES, {**given(cube), "angle": where})
        found = np.array(seen["found"], float).reshape(seen["rows"], seen["columns"], 3)
        off = np.abs(found - right(cube, where, thin=True)[0])
        assert np.median(off) < 3
        assert np.mean(off < 16) > 0.9


def test_the_lamps_eye_has_the_light_of_its_lamp_on_its_wall(evaluate: Open) -> None:
    """A lamp that lights two walls, each with a power of its own, beside a weaker one that lights the first too."""
    room = Grid((3, 5, 7), 1.4)
    walls = Screen("near", (9, 0, -2), (5.6, 8.4), 1.4), Screen("far", (14, 0, -3.4), (5.6, 8.4), 1.4)
    lamps = Lamp("sun", (1, 0, -0.3)), Lamp("moon", (1, 0.2, -0.3))
    shots = Shot("one", "near", ("sun", "moon")), Shot("two", "far", ("sun",))
    rig = Stage(room, lamps, walls, shots, cube_turns=False).rig()
    given_powers = {(0, 0): 0.6, (0, 1): 0.2, (1, 0): 0.3}
    powers = np.array([given_powers[int(picture), int(lamp)] for picture, lamp in rig.pairs])
    cube = Cube(np.zeros((3, 3, 5, 7), np.float32), room, rig, np.repeat(powers[:, None], 3, axis=1))
    found = evaluate(
        ("model/stage.js", "room/furniture.js"),
        "lampOfEye(argument.scene, exposures(argument.scene, 0), standing(argument.scene, 0)).light",
        given(cube),
    )
    assert found == pytest.approx([0.6, 0.6, 0.6])


def test_the_lamps_eye_is_a_key_and_a_way_back(visit: Open) -> None:
    tab = visit(width=900, height=600, reduced_motion="reduce")
    button, room = tab.get_by_role("button", name="Lamp's eye"), tab.locator("canvas.room")
    tab.evaluate("document.querySelector('.hint').remove()")
    before = room.screenshot()
    tab.keyboard.press("l")
    rested(tab)
    assert button.get_attribute("aria-pressed") == "true"
    assert room.screenshot() != before
    button.click()
    rested(tab)
    tab.mouse.move(0, 0)
    rested(tab)
    assert button.get_attribute("aria-pressed") == "false"
    assert room.screenshot() == before


def test_a_label_says_whose_it_is(browser: Any, tmp_path: Path) -> None:
    label = Label("<b>Glas</b> & Licht", by="Ada", note='for "Bob"', picture="a b.png")
    (tmp_path / "x.html").write_text(page(turning(), label), encoding="utf-8")
    tab, heard = opened(browser, tmp_path / "x.html")
    until(tab, CUBE)
    assert tab.title() == tab.locator("h1").inner_text() == label.title
    assert tab.locator(".by").inner_text() == 'by Ada · for "Bob"'
    metas = "[...document.querySelectorAll('meta[property]')].map((m) => [m.getAttribute('property'), m.content])"
    told = dict(tab.evaluate(metas))
    assert told["og:title"] == label.title
    assert told["og:image"] == "a b.png"
    assert told["og:description"].endswith("its shadows are pictures: astronaut, coffee, cat, rocket, moon.")
    assert heard == []
    tab.context.close()


@pytest.mark.parametrize("part", ["title", "by", "note", "picture"])
def test_labels_have_room_for_so_much(part: str) -> None:
    with pytest.raises(InputError, match=f"a page's {part} has at most"):
        Label(**{"title": "x", part: 10_000 * "x"})


def test_view_takes_a_label_and_writes_a_preview(run: Any, tmp_path: Path) -> None:
    io.save(turning(), tmp_path / "c.zarr")
    title = "كأس \u202e<i>"
    done = run("view", tmp_path / "c.zarr", "-o", tmp_path / "c.html", "--title", title, "--by", "Ada", "--preview")
    assert done.code == 0
    text = (tmp_path / "c.html").read_text(encoding="utf-8")
    assert 'property="og:image" content="c.png"' in text
    assert "&lt;i&gt;</title>" in text
    with Image.open(tmp_path / "c.png") as picture:
        assert picture.size == (1200, 630)
    again = run("view", tmp_path / "c.zarr", "-o", tmp_path / "d.html", "--title", "x" * 10_000)
    assert again.code == 2
    assert "a page's title has at most 200 letters" in again.err
    assert not (tmp_path / "d.html").exists()
