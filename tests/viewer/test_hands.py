"""The page in the hand: what dragging, keys, fingers, the slider and playing do."""

from typing import Any

import numpy as np
import pytest

from tests.helpers.visiting import (
    CUBE,
    PHONE,
    STOPS,
    Open,
    angle_deg,
    drag,
    marked,
    middle,
    pages,
    rested,
    stands,
    unsnapped,
    until,
    visit,
    without_hint,
)

__all__ = ["pages", "visit"]


def test_a_drag_turns_the_cube_and_ends_the_hint(visit: Open) -> None:
    tab = visit()
    unsnapped(tab)
    drag(tab, 120)
    assert angle_deg(tab) == pytest.approx(STOPS[0] + 0.35 * 120)
    drag(tab, -200)
    assert angle_deg(tab) == pytest.approx(360 + STOPS[0] - 0.35 * 80)
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
    assert angle_deg(tab) == 0
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
    found = evaluate(("parts/gestures.js",), THROWN, [["pointerdown", 500, 100], *moves, *last])
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
    on_stop, free = evaluate(("model/turning.js",), RELEASED, 300)
    assert free[-1] == pytest.approx(94, abs=1e-6)
    assert on_stop[-1] == 60
    assert 0.8 * 300 < (free[1] - free[0]) / 0.01 <= 300.1
    assert np.all(np.diff(free) > 0)
    assert np.all(np.diff(on_stop) > 0)


def test_without_motion_a_throw_stands_at_once(visit: Open) -> None:
    tab = visit(reduced_motion="reduce")
    unsnapped(tab)
    drag(tab, 120, hold_deg=False)
    assert angle_deg(tab) == pytest.approx(STOPS[0] + 42)
    tab.locator(".thumbnail").nth(3).click()
    assert angle_deg(tab) == STOPS[3]


def test_the_eye_moves_and_comes_back(visit: Open) -> None:
    """And the cube does not turn."""
    tab = visit(reduced_motion="reduce")
    x, y = middle(tab, "canvas.room")
    tab.mouse.click(x, y)
    tab.keyboard.press("n")  # who uses keys sees what has the focus
    tab.mouse.move(x, 2)
    without_hint(tab)
    room = tab.locator("canvas.room")
    before = room.screenshot()
    for how in ("right", "shift", "wheel", "keys"):
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
        assert room.screenshot() != before, how
        tab.mouse.dblclick(x, y)
        tab.mouse.move(x, 2)
        rested(tab)
        assert room.screenshot() == before, how
        assert angle_deg(tab) == STOPS[0], how


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
    rested(tab)
    assert tab.locator("#lightcube").get_attribute("data-theme") == before
    assert angle_deg(tab) == STOPS[0]


def test_space_plays_and_pauses(visit: Open) -> None:
    tab = visit()
    tab.get_by_label("Speed of playing").select_option("4")
    tab.locator("canvas.room").focus()
    tab.keyboard.press("Space")
    until(tab, f"{CUBE}.angle > 61")
    tab.get_by_role("button", name="Pause").wait_for()
    tab.keyboard.press("Space")
    until(tab, f"{STOPS}.includes({CUBE}.angle)")
    tab.get_by_role("button", name="Play").wait_for()


def test_after_a_click_the_keys_are_the_cubes(visit: Open) -> None:
    tab = visit()
    tab.get_by_role("button", name="Snap").click()
    tab.keyboard.press("Space")
    until(tab, f"{CUBE}.angle > {STOPS[0] + 3}")
    assert tab.get_by_role("button", name="Snap").get_attribute("aria-pressed") == "false"
    tab.get_by_role("button", name="Snap").focus()
    tab.keyboard.press("Space")
    until(tab, "document.activeElement.getAttribute('aria-pressed') === 'true'")


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
    resting, even = (np.array(each) for each in evaluate(("model/turning.js",), text, STOPS))
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


TICKS = """argument.map((count) => {
  const stops = Array.from({ length: count }, (_, i) => (i * 360) / count);
  const { element } = createControls(stops, { play() {}, speed() {} }, "Angle", []);
  return element.querySelector(".slider path").getAttribute("d").match(/[0-9.]+ /g).map(Number);
})"""


def test_stops_have_ticks_that_stand_apart(evaluate: Open) -> None:
    few, many = evaluate(("parts/controls.js",), TICKS, [16, 300])
    assert few == pytest.approx(np.arange(16) * 22.5)
    assert len(many) <= 60
    assert np.ptp(np.diff(many)) < 1e-9
    assert 360 - many[-1] <= many[1] + 1e-9


def test_the_film_strip_turns_to_its_pictures(visit: Open) -> None:
    tab = visit(details=True)
    tab.locator(".thumbnail").nth(3).click()
    stands(tab, 200.0)
    assert marked(tab) == ["rocket"]
    assert tab.locator(".compare h2").inner_text() == "rocket"
    tab.keyboard.press("ArrowRight")
    stands(tab, 290.0)
    tab.keyboard.press("ArrowRight")
    stands(tab, 10.0)
    assert tab.locator(".thumbnail[tabindex='0']").count() == 1


def touch(session: Any, kind: str, *points: tuple[float, float]) -> None:
    spots = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]
    session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": spots})


@pytest.mark.parametrize("selector", [".choose", ".slice"])
def test_what_a_finger_pointed_at_stays(visit: Open, selector: str) -> None:
    tab = visit(**PHONE, details=True)
    tab.locator(selector).scroll_into_view_if_needed()
    fingers = tab.context.new_cdp_session(tab)
    box = tab.locator(selector).bounding_box()
    touch(fingers, "touchStart", (box["x"] + 0.52 * box["width"], box["y"] + 0.3 * box["height"]))
    tab.wait_for_timeout(20)
    touch(fingers, "touchEnd")
    until(tab, "document.querySelector('.scanline > .facts').textContent.includes('passes')")
    rested(tab)
    assert "passes" in tab.locator(".scanline > .facts").inner_text()
    if selector == ".choose":
        assert "row 3 of 8" in tab.locator(".scanline header").inner_text()


def test_the_film_strip_keeps_the_row(visit: Open) -> None:
    tab = visit(details=True)
    chooser = tab.get_by_role("slider", name="Row of the shown picture")
    chooser.focus()
    tab.keyboard.press("ArrowDown")
    tab.locator(".thumbnail").nth(3).click()
    stands(tab, 200.0)
    assert chooser.get_attribute("aria-valuetext") == "row 6 of 8"


def test_fingers_turn_and_pinch(visit: Open) -> None:
    tab = visit(**PHONE, reduced_motion="reduce")
    unsnapped(tab)
    fingers = tab.context.new_cdp_session(tab)
    x, y = middle(tab, "canvas.room")
    touch(fingers, "touchStart", (x - 40, y))
    for step in range(-40, 41, 10):
        touch(fingers, "touchMove", (x + step, y))
    touch(fingers, "touchEnd")
    assert angle_deg(tab) == pytest.approx(STOPS[0] + 0.35 * 80)
    without_hint(tab)
    before, where = tab.locator("canvas.room").screenshot(), angle_deg(tab)
    touch(fingers, "touchStart", (x - 30, y), (x + 30, y))
    for step in range(30, 81, 10):
        touch(fingers, "touchMove", (x - step, y), (x + step, y))
    touch(fingers, "touchEnd")
    rested(tab)
    assert angle_deg(tab) == where
    assert tab.locator("canvas.room").screenshot() != before
