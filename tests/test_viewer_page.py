"""The page in a browser: what hands, keys and fingers do, what is said of a beam, and what a broken file says."""

import base64
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube.cube import Cube
from lightcube.forward import play
from lightcube.geometry import Grid, turntable
from lightcube.stage import Lamp, Screen, Shot, Stage, exposures
from lightcube.transfer import encode
from lightcube.viewer.described import zipped
from lightcube.viewer.modules import source
from lightcube.viewer.packing import pack
from lightcube.viewer.page import page
from tests.browser import opened
from tests.plain import beam_of_pixel, lengths_of_beam
from tests.test_viewer_shadows import given, glass, on_stage

Open = Callable[..., Any]
STOPS = [10.0, 60.0, 130.0, 200.0, 290.0]
NAMES = ("astronaut", "coffee", "cat", "rocket", "moon")
GRID = Grid((12, 14, 16), 2.0)
ROWS, COLUMNS = 8, 10
CUBE = "document.getElementById('lightcube').lightcube"


def turning() -> Cube:
    """A random cube on a turntable with a raised lamp, and random pictures wanted of it."""
    random = np.random.default_rng(3)
    views = turntable(GRID, STOPS, elevation=35.0, picture_shape=(ROWS, COLUMNS))
    targets = random.integers(0, 256, (len(STOPS), ROWS, COLUMNS, 4), dtype=np.uint8)
    powers = random.uniform(0.5, 2.0, (len(STOPS), 3))
    return Cube(glass(GRID.shape), GRID, views, powers, targets=targets, names=NAMES)


def standing_still() -> Cube:
    """One picture, on a stage where nothing turns."""
    room = Grid((3, 5, 7), 1.4)
    screen, lamp = Screen("wall", (9.0, 0.0, -2.0), (5.6, 8.4), 1.4), Lamp("red", (1.0, 0.0, -0.3))
    views, lighting = exposures(Stage(room, (lamp,), (screen,), (Shot("one", "wall", ("red",)),), cube_turns=False))
    return Cube(glass(room.shape), room, views, lighting=lighting)


CUBES: dict[str, Callable[[], Cube]] = {
    "turntable": turning,
    "stage": lambda: on_stage("two screens of different sizes"),
    "still": standing_still,
}


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A page of each cube."""
    folder = tmp_path_factory.mktemp("pages")
    for name, cube in CUBES.items():
        (folder / f"{name}.html").write_text(page(cube(), f"a {name} & <more>"), encoding="utf-8")
    return {name: folder / f"{name}.html" for name in CUBES}


@pytest.fixture
def visit(browser: Any, pages: dict[str, Path]) -> Iterator[Open]:
    """A function that opens a page and waits until it shows its cube; what it complained of fails the test."""
    tabs = []

    def go(name: str = "turntable", *, width: int = 920, height: int = 440, **context: Any) -> Any:
        context.setdefault("device_scale_factor", 0.25)  # fewer pixels: the room may be drawn in software
        tab, heard = opened(browser, pages[name], width=width, height=height, **context)
        tabs.append((tab, heard))
        until(tab, CUBE)
        rested(tab)
        return tab

    yield go
    for tab, heard in tabs:
        assert heard == []
        tab.context.close()


def until(tab: Any, expression: str) -> None:
    """Wait until an expression is true; the page forbids what Playwright waits with."""
    for _ in range(300):
        if tab.evaluate(f"Boolean({expression})"):
            return
        tab.wait_for_timeout(50)
    raise AssertionError(f"never: {expression}")


def rested(tab: Any) -> None:
    """Wait until nothing moves and all is drawn."""
    until(tab, f"{CUBE}.resting")


def angle(tab: Any) -> float:
    return tab.evaluate(f"{CUBE}.angle")


def stands(tab: Any, where: float) -> None:
    """Wait until the cube stands at an angle."""
    until(tab, f"Math.abs({CUBE}.angle - {where}) < 1e-6")
    rested(tab)
    assert angle(tab) == pytest.approx(where)


def turned_to(tab: Any, where: float) -> None:
    tab.evaluate(f"{CUBE}.turnTo({where})")
    rested(tab)


def middle(tab: Any, selector: str) -> tuple[float, float]:
    box = tab.locator(selector).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(tab: Any, across: float, down: float = 0, *, button: str = "left", hold: bool = True) -> None:
    """Drag over the room, still before letting go unless it is thrown."""
    x, y = middle(tab, "canvas.room")
    tab.mouse.move(x - across / 2, y)
    tab.mouse.down(button=button)
    tab.mouse.move(x + across / 2, y + down, steps=8)
    if hold:
        tab.wait_for_timeout(150)
    tab.mouse.up(button=button)


def unsnapped(tab: Any) -> None:
    tab.get_by_role("button", name="Snap").click()
    tab.locator("canvas.room").focus()


def without_hint(tab: Any) -> None:
    """Wait until it has faded."""
    until(tab, "getComputedStyle(document.querySelector('.hint')).visibility === 'hidden'")
    rested(tab)


def marked(tab: Any) -> list[str]:
    return tab.locator(".thumbnail[aria-current] .name").all_inner_texts()


def test_it_opens_at_the_first_picture(visit: Open) -> None:
    tab = visit()
    assert angle(tab) == STOPS[0]
    assert marked(tab) == ["astronaut"]
    assert tab.title() == tab.locator("h1").inner_text() == "a turntable & <more>"
    assert tab.locator(".hint").is_visible()
    assert "16 × 14 × 12 voxels" in tab.locator(".quiet").inner_text()


def test_a_drag_turns_the_cube_and_ends_the_hint(visit: Open) -> None:
    tab = visit()
    unsnapped(tab)
    drag(tab, 120)
    assert angle(tab) == pytest.approx(STOPS[0] + 0.35 * 120)
    drag(tab, -200)
    assert angle(tab) == pytest.approx(360 + STOPS[0] - 0.35 * 80)
    without_hint(tab)


def test_where_nothing_turns_a_drag_moves_the_eye(visit: Open) -> None:
    tab = visit("still")
    assert tab.locator(".controls").count() == 0
    assert "look around" in tab.locator(".hint").inner_text()
    room = tab.locator("canvas.room")
    drag(tab, 4)
    before = room.screenshot()
    drag(tab, 90, 30)
    for key in ("ArrowRight", " ", "PageDown", "n"):
        tab.keyboard.press(key)
    rested(tab)
    assert angle(tab) == 0
    tab.keyboard.press("?")
    assert "turn" not in " ".join(tab.get_by_role("dialog").locator("dl").all_inner_texts())
    tab.keyboard.press("Escape")
    assert room.screenshot() != before


def test_a_drag_settles_on_the_nearest_stop(visit: Open) -> None:
    tab = visit()
    drag(tab, 120)  # by 42°, to 52°
    stands(tab, 60.0)
    assert marked(tab) == ["coffee"]


THROWN = """(() => {
  const area = document.createElement("div");
  document.body.append(area);
  area.setPointerCapture = () => {};
  const found = [];
  const does = new Proxy({}, { get: (_, name) => (...given) => found.push([name, ...given]) });
  listenToGestures(area, does, false);
  for (const [kind, time, clientX] of argument) {
    const event = new PointerEvent(kind, { pointerId: 1, pointerType: "mouse", button: 0, clientX, clientY: 5 });
    Object.defineProperty(event, "timeStamp", { value: time });
    area.dispatchEvent(event);
  }
  return found.filter(([name]) => name === "release");
})()"""


@pytest.mark.parametrize(("wait", "speed"), [(10, 1000.0), (200, 0.0)])
def test_a_throw_is_as_fast_as_its_last_moments(evaluate: Open, wait: int, speed: float) -> None:
    """In pixels a second; who waits before letting go has not thrown."""
    moves: list[list[Any]] = [["pointermove", 500 + 16 * step, 100 + 16 * step] for step in range(1, 20)]
    last = [["pointerup", moves[-1][1] + wait, moves[-1][2] + (wait if speed else 0)]]
    found = evaluate(("gestures.js",), THROWN, [["pointerdown", 500, 100], *moves, *last])
    assert found == [["release", pytest.approx(speed)]]


RELEASED = """[true, false].map((snap) => {
  const turning = new Turning([10, 60, 130, 200, 290], false);
  turning.snap = snap;
  turning.release(argument);
  const angles = [turning.angle];
  while (turning.moving && angles.length < 1000) {
    turning.step(0.01);
    angles.push(turning.angle);
  }
  return angles;
})"""


def test_what_is_let_go_runs_out_where_it_would_or_on_a_stop(evaluate: Open) -> None:
    """300° a second is 84° in all: to 94°, and with snapping to 60° or 130°, no faster than thrown."""
    on_stop, free = evaluate(("turning.js",), RELEASED, 300)
    assert free[-1] == pytest.approx(94, abs=1e-6)
    assert on_stop[-1] == 60
    assert 0.8 * 300 < (free[1] - free[0]) / 0.01 <= 300.1
    assert np.all(np.diff(free) > 0)
    assert np.all(np.diff(on_stop) > 0)


def test_without_motion_a_throw_stands_at_once(visit: Open) -> None:
    tab = visit(reduced_motion="reduce")
    unsnapped(tab)
    drag(tab, 120, hold=False)
    assert angle(tab) == pytest.approx(STOPS[0] + 42)
    tab.locator(".thumbnail").nth(3).click()
    assert angle(tab) == STOPS[3]


@pytest.mark.parametrize("how", ["right", "shift", "wheel", "keys"])
def test_the_eye_moves_and_comes_back(visit: Open, how: str) -> None:
    """And the cube does not turn."""
    tab = visit(reduced_motion="reduce")
    x, y = middle(tab, "canvas.room")
    tab.mouse.click(x, y)
    tab.keyboard.press("n")  # who uses keys sees what has the focus
    tab.mouse.move(x, 2)
    without_hint(tab)
    room = tab.locator("canvas.room")
    before = room.screenshot()
    if how == "right":
        drag(tab, 90, 30, button="right")
    elif how == "shift":
        tab.keyboard.down("Shift")
        drag(tab, 90, 30)
        tab.keyboard.up("Shift")
    elif how == "wheel":
        tab.mouse.wheel(0, 300)
    else:
        tab.keyboard.press("+")
    tab.mouse.move(x, 2)
    rested(tab)
    assert room.screenshot() != before
    tab.mouse.dblclick(x, y)
    tab.mouse.move(x, 2)
    rested(tab)
    assert room.screenshot() == before
    assert angle(tab) == STOPS[0]


def test_keys_turn(visit: Open) -> None:
    tab = visit()
    for key, where in [
        ("ArrowRight", 11.0),
        ("ArrowRight", 12.0),
        ("Shift+ArrowLeft", 11.9),
        ("PageDown", 60.0),
        (".", 130.0),
        ("PageUp", 60.0),
        (",", 10.0),
        (",", 290.0),
        ("Home", 10.0),
        ("ArrowLeft", 9.0),
        ("n", 10.0),
    ]:
        tab.keyboard.press(key)
        stands(tab, where)


def test_keys_leave_alone_what_is_typed_in(visit: Open) -> None:
    tab = visit()
    tab.get_by_label("Speed of playing").focus()
    before = tab.locator("#lightcube").get_attribute("data-theme")
    for key in ("t", "Home", "ArrowRight"):
        tab.keyboard.press(key)
    assert tab.locator("#lightcube").get_attribute("data-theme") == before
    assert angle(tab) == STOPS[0]


def test_space_plays_and_pauses(visit: Open) -> None:
    tab = visit()
    tab.get_by_label("Speed of playing").select_option("4")
    tab.locator("canvas.room").focus()
    tab.keyboard.press("Space")
    until(tab, f"{CUBE}.angle > 61")
    assert tab.get_by_role("button", name="Pause").is_visible()
    tab.keyboard.press("Space")
    until(tab, f"{STOPS}.includes({CUBE}.angle)")
    assert tab.get_by_role("button", name="Play").is_visible()


def test_playing_rests_on_every_stop_and_keeps_its_speed(evaluate: Open) -> None:
    """A whole turn at 24° a second takes 15 s, half of them on stops; without snapping, none."""
    text = """[true, false].map((snap) => {
      const turning = new Turning(argument, false);
      turning.snap = snap;
      turning.play();
      const angles = [];
      for (let step = 0; step < 1500; step++) {
        turning.step(0.01);
        angles.push(turning.angle);
      }
      return angles;
    })"""
    resting, even = (np.array(each) for each in evaluate(("turning.js",), text, STOPS))
    on_stop = np.isclose(resting[:, None], STOPS).any(axis=1)
    assert np.mean(on_stop) == pytest.approx(0.5, abs=0.02)
    assert all(np.isclose(resting, stop).any() for stop in STOPS)
    assert resting[-1] == pytest.approx(STOPS[0], abs=0.1)
    assert even == pytest.approx((STOPS[0] + 0.24 * np.arange(1, 1501)) % 360, abs=1e-6)


def test_the_slider_is_a_real_one(visit: Open) -> None:
    tab = visit()
    slider = tab.get_by_label("Angle of the turntable")
    unsnapped(tab)
    slider.fill("60.8")
    stands(tab, 60.8)
    assert slider.get_attribute("aria-valuetext") == "60.8°, 0.8° from 'coffee'"
    assert tab.locator(".readout").inner_text() == "60.8°"
    tab.get_by_role("button", name="Snap").click()
    stands(tab, 60.0)
    assert slider.get_attribute("aria-valuetext") == "60.0°, at 'coffee'"
    slider.fill("190")
    stands(tab, 200.0)


def test_the_film_strip_turns_to_its_pictures(visit: Open) -> None:
    tab = visit()
    tab.locator(".thumbnail").nth(3).click()
    stands(tab, 200.0)
    assert marked(tab) == ["rocket"]
    assert tab.locator(".compare h2").inner_text() == "rocket"
    tab.keyboard.press("ArrowRight")
    stands(tab, 290.0)
    tab.keyboard.press("ArrowRight")
    stands(tab, 10.0)
    assert tab.locator(".thumbnail[tabindex='0']").count() == 1


def test_the_theme_follows_the_system_and_the_key(visit: Open) -> None:
    for system, other in (("dark", "light"), ("light", "dark")):
        tab = visit(color_scheme=system)
        root = tab.locator("#lightcube")
        assert root.get_attribute("data-theme") == system
        for each in (other, system):
            tab.emulate_media(color_scheme=each)
            until(tab, f"document.getElementById('lightcube').dataset.theme === '{each}'")
        rested(tab)
        before = tab.locator("canvas.room").screenshot()
        tab.keyboard.press("t")
        rested(tab)
        assert root.get_attribute("data-theme") == other
        assert tab.locator("canvas.room").screenshot() != before
        for each in (other, system):
            tab.emulate_media(color_scheme=each)
            tab.wait_for_timeout(100)
        assert root.get_attribute("data-theme") == other


def test_help_opens_and_closes(visit: Open) -> None:
    tab = visit()
    for end in ("Escape", "?"):
        tab.keyboard.press("?")
        assert tab.get_by_role("dialog").is_visible()
        tab.keyboard.press("ArrowRight")  # what is behind it does not hear
        assert angle(tab) == pytest.approx(STOPS[0])
        tab.keyboard.press(end)
        assert not tab.get_by_role("dialog").is_visible()


def shown(tab: Any) -> np.ndarray:
    """The shown picture, levels of red, green and blue."""
    rested(tab)
    text = """() => {
      const { width, height } = document.querySelector(".choose canvas");
      const copy = Object.assign(document.createElement("canvas"), { width, height });
      copy.getContext("2d").drawImage(document.querySelector(".choose canvas"), 0, 0);
      return [height, width, [...copy.getContext("2d").getImageData(0, 0, width, height).data]];
    }"""
    rows, columns, levels = tab.evaluate(text)
    return np.array(levels).reshape(rows, columns, 4)[..., :3]


def right(cube: Cube, where: float, *, whole: bool = False) -> np.ndarray:
    return 255 * encode(np.clip(play(pack(cube).cube, [where], whole_screen=whole), 0, 1).astype(float), cube.transfer)


def test_the_shown_picture_is_what_play_casts(visit: Open) -> None:
    tab, cube = visit(), turning()
    for where in (10.0, 17.3, 130.0, 245.0):
        turned_to(tab, where)
        assert np.abs(shown(tab) - right(cube, where)[0]).max() <= 0.55
    tab.keyboard.press("w")
    assert np.abs(shown(tab) - right(cube, where, whole=True)[0]).max() <= 0.55
    tab.keyboard.press("w")
    assert np.abs(shown(tab) - right(cube, where)[0]).max() <= 0.55


def test_a_stage_has_a_tab_for_every_screen(visit: Open) -> None:
    tab, cube = visit("stage"), CUBES["stage"]()
    assert tab.locator(".tabs button").all_inner_texts() == ["wall", "floor"]
    assert marked(tab) == ["1"]
    assert not tab.get_by_role("button", name="Whole shadow").is_visible()
    pictures = right(cube, 0.0)
    for number, name in enumerate(("wall", "floor")):
        tab.get_by_role("button", name=name, exact=True).click()
        found = shown(tab)
        rows, columns = found.shape[:2]
        assert np.abs(found - pictures[number, :rows, :columns]).max() <= 0.55
        assert marked(tab) == [("1", "4")[number]]
    assert tab.locator(".lamps th").all_inner_texts() == ["sun"]


def test_the_film_strip_finds_a_picture_on_its_screen(visit: Open) -> None:
    tab, cube = visit("stage"), CUBES["stage"]()
    for number in (4, 1, 3):  # wall and floor at each of three stops
        tab.get_by_role("button", name=re.compile(f"^{number + 1}, ")).click()
        stands(tab, float(cube.angles[number]))
        assert marked(tab) == [str(number + 1)]
        assert cube.lighting is not None
        screen = int(cube.lighting.screen[number])
        assert tab.locator(".tabs [aria-pressed=true]").inner_text() == ("wall", "floor")[screen]
        rows, columns = shown(tab).shape[:2]
        pictures = right(cube, float(cube.angles[number]))
        assert np.abs(shown(tab) - pictures[screen, :rows, :columns]).max() <= 0.55


def test_the_whole_shadow_has_a_frame_where_the_picture_is(visit: Open) -> None:
    tab, cube = visit(), turning()
    tab.keyboard.press("w")
    whole = shown(tab)
    box, frame = (tab.locator(each).bounding_box() for each in (".choose canvas", ".choose .frame"))
    scale = box["width"] / whole.shape[1]
    top, left = round((frame["y"] - box["y"]) / scale), round((frame["x"] - box["x"]) / scale)
    framed = whole[top : top + ROWS, left : left + COLUMNS]
    assert np.abs(framed - right(cube, STOPS[0])[0]).max() <= 0.55


@pytest.mark.parametrize("where", STOPS[:2])
def test_a_beam_says_what_it_passes(visit: Open, where: float) -> None:
    tab, cube = visit(width=1440, height=900), turning()
    turned_to(tab, where)
    views = cube.views.take([STOPS.index(where)])
    box = tab.locator(".choose canvas").bounding_box()
    for row, column in [(0, 0), (5, 2), (7, 9)]:
        tab.mouse.move(
            box["x"] + (column + 0.5) / COLUMNS * box["width"], box["y"] + (row + 0.5) / ROWS * box["height"]
        )
        rested(tab)
        lengths = lengths_of_beam(GRID, *beam_of_pixel(views, 0, row, column))
        left = np.exp(-np.einsum("zyx,czyx->c", lengths, pack(cube).cube.extinction))
        said = tab.locator(".scanline > .facts").inner_text()
        numbers = [float(each) for each in re.findall(r"[\d.]+(?=[ ;])", said)]
        assert numbers[:2] == [column + 1, np.count_nonzero(lengths > 1e-9)]
        assert numbers[2:] == pytest.approx(100 * left, abs=0.51)
        assert tab.locator(".scanline header .facts").inner_text() == f"row {row + 1} of {ROWS}"


def test_the_keys_choose_a_row(visit: Open) -> None:
    tab = visit()
    chooser = tab.get_by_role("slider", name="Row of the shown picture")
    chooser.focus()
    for key, said in [("ArrowDown", "row 6 of 8"), ("ArrowUp", "row 5 of 8"), ("ArrowRight", "row 5 of 8, column 7")]:
        tab.keyboard.press(key)
        rested(tab)
        assert chooser.get_attribute("aria-valuetext") == said
    assert angle(tab) == STOPS[0]
    assert "Pixel 7 passes" in tab.locator(".scanline > .facts").inner_text()


def test_pointing_at_the_slice_chooses_a_beam(visit: Open) -> None:
    """From above the light goes to the right and the picture's left is up."""
    tab = visit()
    box = tab.locator("canvas.slice").bounding_box()
    said = []
    for part in (0.45, 0.55):
        tab.mouse.move(box["x"] + box["width"] / 2, box["y"] + part * box["height"])
        rested(tab)
        said.append(int(re.findall(r"Pixel (\d+)", tab.locator(".scanline > .facts").inner_text())[0]))
    assert said[0] <= COLUMNS / 2 < said[1]


def touch(session: Any, kind: str, *points: tuple[float, float]) -> None:
    spots = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]
    session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": spots})


PHONE = {"width": 390, "height": 844, "has_touch": True, "is_mobile": True}


def test_fingers_turn_and_pinch(visit: Open) -> None:
    tab = visit(**PHONE, reduced_motion="reduce")
    unsnapped(tab)
    fingers = tab.context.new_cdp_session(tab)
    x, y = middle(tab, "canvas.room")
    touch(fingers, "touchStart", (x - 40, y))
    for step in range(-40, 41, 10):
        touch(fingers, "touchMove", (x + step, y))
    touch(fingers, "touchEnd")
    assert angle(tab) == pytest.approx(STOPS[0] + 0.35 * 80)
    without_hint(tab)
    before, where = tab.locator("canvas.room").screenshot(), angle(tab)
    touch(fingers, "touchStart", (x - 30, y), (x + 30, y))
    for step in range(30, 81, 10):
        touch(fingers, "touchMove", (x - step, y), (x + step, y))
    touch(fingers, "touchEnd")
    rested(tab)
    assert angle(tab) == where
    assert tab.locator("canvas.room").screenshot() != before


def test_on_a_phone_nothing_is_too_small_or_too_wide(visit: Open) -> None:
    tab = visit(**PHONE)
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
    for control in tab.locator("button:visible, select:visible, .slider input").all():
        box = control.bounding_box()
        assert min(box["width"], box["height"]) >= 40, control.get_attribute("aria-label")


@pytest.mark.parametrize("size", [(1440, 900), (390, 844)])
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_nobody_is_shut_out(visit: Open, theme: str, size: tuple[int, int]) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe-playwright-python is not installed")
    for name in CUBES:
        tab = visit(name, width=size[0], height=size[1], color_scheme=theme)
        for open_help in (False, True):
            if open_help:
                tab.keyboard.press("?")
            found = axe.Axe().run(tab)
            assert found.violations_count == 0, found.generate_report()


def damaged(kind: str, text: str) -> str:
    """The page with its scene or voxels garbled, or cut off somewhere."""
    if kind in ("scene", "voxels"):
        start = text.index(f'id="{kind}">') + len(f'id="{kind}">') + 200
        return text[:start] + "AAAA" + text[start + 4 :]
    marks = {
        "style": ".lightcube {",
        "code": "function openPage",
        "in scene": 'id="scene">',
        "in voxels": 'id="voxels">',
    }
    return text[: text.index(marks[kind.removeprefix("cut ")]) + 30]


@pytest.mark.parametrize("kind", ["scene", "voxels", "cut style", "cut code", "cut in scene", "cut in voxels"])
def test_a_damaged_page_says_so(browser: Any, pages: dict[str, Path], tmp_path: Path, kind: str) -> None:
    (tmp_path / "damaged.html").write_text(
        damaged(kind, pages["turntable"].read_text(encoding="utf-8")), encoding="utf-8"
    )
    tab, _ = opened(browser, tmp_path / "damaged.html")
    said = tab.get_by_role("alert").inner_text()
    assert re.search(r"damaged|incomplete|cut", said), said
    assert re.search(r"[Ss]ave|[Ww]rite|[Oo]pen", said), said
    assert len(said) < 250
    tab.context.close()


def test_without_webgl_the_same_can_be_done(bare_browser: Any, pages: dict[str, Path]) -> None:
    tab, heard = opened(bare_browser, pages["turntable"])
    until(tab, CUBE)
    assert "WebGL" in tab.locator(".quiet").inner_text()
    tab.locator(".thumbnail").nth(2).click()
    stands(tab, 130.0)
    assert np.abs(shown(tab) - right(turning(), 130.0)[0]).max() <= 0.55
    unsnapped(tab)
    drag(tab, 100)
    assert angle(tab) == pytest.approx(165.0)
    tab.keyboard.press("w")
    tab.keyboard.press("t")
    rested(tab)
    assert heard == []
    tab.context.close()


MODEL = """(async () => {
  const values = { angle: argument.angle };
  for (const part of ["scene", "voxels"]) values[part] = new DataView(fromBase64(argument[part]).buffer);
  const heard = [];
  let saved = 0;
  const model = {
    get: (name) => values[name],
    set(name, value) {
      values[name] = value;
      heard.filter(([event]) => event === `change:${name}`).forEach(([, does]) => does());
    },
    save_changes: () => saved++,
    on: (event, does) => heard.push([event, does]),
    off: (event, does) => heard.splice(heard.findIndex((each) => each[1] === does), 1),
  };
  const el = document.createElement("div");
  document.body.append(el);
  const still = () => new Promise((done) => setTimeout(done, 300));
  const end = await render({ model, el });
  const shown = el.firstChild.lightcube;
  await still();
  const told = [shown.angle, saved];
  model.set("angle", 222.5);
  await still();
  told.push(shown.angle, saved);
  shown.turnTo(33);
  await still();
  told.push(values.angle, saved);
  const parts = el.querySelectorAll(".slider, .filmstrip, canvas.room, .side").length;
  const outside = [...document.querySelectorAll("body, body > div")].every((each) => each.className === "");
  end();
  return { told, parts, outside, left: el.childElementCount + heard.length };
})()"""


def test_a_widget_follows_its_model_and_leads_it(evaluate: Open) -> None:
    """Each is told once of what the other did, and not of what it did itself."""
    parts = given(turning())
    scene = base64.b64encode(zipped(parts["scene"])).decode()
    found = evaluate(("widget.js",), MODEL, {"angle": 60.0, "scene": scene, "voxels": parts["voxels"]})
    assert found == {"told": [60.0, 0, 222.5, 0, 33, 1], "parts": 3, "outside": True, "left": 0}


def test_the_style_stays_inside() -> None:
    """Every rule is below .lightcube: a notebook around it looks as before."""
    text = re.sub(
        r"/\*.*?\*/|@media[^{]*\{|@keyframes \S+ \{[^}]*\}[^}]*\}[^}]*\}", "", source("style.css"), flags=re.DOTALL
    )
    selectors = [each.strip() for group in re.findall(r"([^{};]+)\{", text) for each in group.split(",")]
    assert selectors
    assert [each for each in selectors if not each.startswith(".lightcube")] == []
