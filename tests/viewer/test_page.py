"""The page as a whole: how it opens, looks and helps, for everybody, without WebGL2, as a widget, and damaged."""

import base64
import itertools
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube.viewer.description import zipped
from lightcube.viewer.modules import source
from lightcube.viewer.page import page
from tests.helpers.browser import opened
from tests.helpers.visiting import (
    CUBE,
    CUBES,
    NAMES,
    PHONE,
    STOPS,
    Open,
    angle_deg,
    drag,
    marked,
    pages,
    rested,
    right,
    shown,
    stands,
    turned_to,
    turning,
    unsnapped,
    until,
    visit,
)
from tests.viewer.test_shadows import given

__all__ = ["pages", "visit"]


def test_it_opens_at_the_first_picture(visit: Open) -> None:
    tab = visit()
    assert angle_deg(tab) == STOPS[0]
    assert marked(tab) == ["astronaut"]
    assert tab.title() == tab.locator("h1").inner_text() == "a turntable & <more>"
    assert tab.locator(".hint").is_visible()
    assert "16 × 14 × 12 voxels" in tab.locator(".quiet").inner_text()


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
        assert angle_deg(tab) == pytest.approx(STOPS[0])
        tab.keyboard.press(end)
        assert not tab.get_by_role("dialog").is_visible()


def test_on_a_phone_nothing_is_too_small_or_too_wide(visit: Open) -> None:
    tab = visit(**PHONE)
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
    for control in tab.locator("button:visible, select:visible, .slider input").all():
        box = control.bounding_box()
        assert min(box["width"], box["height"]) >= 40, control.get_attribute("aria-label")


def test_on_a_phone_nothing_moves_while_it_turns(visit: Open) -> None:
    tab = visit(**PHONE)
    heights = []
    for where in (8.0, 98.0, 358.8):
        turned_to(tab, where)
        heights.append(tab.locator(".controls").bounding_box()["height"])
    assert len(set(heights)) == 1


@pytest.mark.parametrize("size", [(1280, 720), (390, 844)])
def test_a_long_name_pushes_nothing_aside(browser: Any, tmp_path: Path, size: tuple[int, int]) -> None:
    names = tuple(f"Screenshot 2026-01-01 at 12.34.56 ({name} {name} {name})" for name in NAMES)
    (tmp_path / "long.html").write_text(page(replace(turning(), names=names), "long"), encoding="utf-8")
    tab, heard = opened(browser, tmp_path / "long.html", width=size[0], height=size[1])
    until(tab, CUBE)
    tab.keyboard.press("d")
    rested(tab)
    for selector in (".side", "html"):
        assert tab.evaluate(f"(e => e.scrollWidth <= e.clientWidth)(document.querySelector('{selector}'))")
    for part in (".choose", ".lamps"):
        box, card = tab.locator(part).bounding_box(), tab.locator(".card.compare").bounding_box()
        assert box["x"] + box["width"] <= card["x"] + card["width"]
    assert heard == []
    tab.context.close()


@pytest.mark.parametrize("name", CUBES)
def test_nobody_is_shut_out(visit: Open, name: str) -> None:
    """As it opens, with details, with help; wide and narrow, light and dark."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe-playwright-python is not installed")
    tab = visit(name)
    for key in ("", "d", "?"):
        if key:
            tab.keyboard.press(key)
        for (width, height), theme in itertools.product([(1440, 900), (390, 844)], ["light", "dark"]):
            tab.set_viewport_size({"width": width, "height": height})
            tab.emulate_media(color_scheme=theme)
            until(tab, f"document.getElementById('lightcube').dataset.theme === '{theme}'")
            rested(tab)
            found = axe.Axe().run(tab, options={"resultTypes": ["violations"]})
            assert found.violations_count == 0, found.generate_report()


#: Of all that can be pressed: what is read out, and what is seen.
CALLED = """Array.from(document.querySelectorAll("button, [role=button]"))
  .filter((each) => each.checkVisibility() && each.textContent.trim() && each.hasAttribute("aria-label"))
  .map((each) => [each.getAttribute("aria-label"), each.innerText.split(/\\s+/).filter(Boolean).join(" ")])"""
#: Notes every canvas that comes into a page without a name.
NAMELESS = """window.nameless = [];
new MutationObserver(() => {
  const found = document.querySelectorAll("canvas[role=img]:not([aria-label])");
  for (const each of found) window.nameless.push(each.className);
}).observe(document, { childList: true, subtree: true });"""


def test_what_is_read_out_begins_with_what_is_seen(visit: Open) -> None:
    """Else who speaks to a browser says what it does not know."""
    for name in CUBES:
        called = visit(name).evaluate(CALLED)
        assert called
        for label, seen in called:
            assert label.startswith(seen), (label, seen)


def test_the_room_has_a_name_from_the_start(browser: Any, pages: dict[str, Path]) -> None:
    for path in pages.values():
        tab = browser.new_context(device_scale_factor=0.25).new_page()
        tab.add_init_script(NAMELESS)
        tab.goto(path.as_uri())
        until(tab, CUBE)
        assert "room" not in tab.evaluate("window.nameless")
        tab.context.close()


#: Words of the code, and what a flipped bit makes of them: one is met when data is read, one as the cards are drawn.
GARBLED = {"return scene;": "return scEne;", "powers = lampPowers(": "powers = lampPowdrs("}


def damaged(kind: str, text: str) -> str:
    """The page with its scene, its voxels or a word of its code garbled, or cut off somewhere."""
    if kind in GARBLED:
        return text.replace(kind, GARBLED[kind], 1)
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


@pytest.mark.parametrize(
    "kind", ["scene", "voxels", *GARBLED, "cut style", "cut code", "cut in scene", "cut in voxels"]
)
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
    assert angle_deg(tab) == pytest.approx(165.0)
    tab.keyboard.press("w")
    tab.keyboard.press("t")
    rested(tab)
    assert heard == []
    tab.context.close()


MODEL = """(async () => {
  const values = { angle_deg: argument.angle_deg };
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
  model.set("angle_deg", 222.5);
  await still();
  told.push(shown.angle, saved);
  shown.turnTo(33);
  await still();
  told.push(values.angle_deg, saved);
  const parts = el.querySelectorAll(".slider, .filmstrip, canvas.room, .side").length;
  const outside = [...document.querySelectorAll("body, body > div")].every((each) => each.className === "");
  end();
  return { told, parts, outside, left: el.childElementCount + heard.length };
})()"""


def test_a_widget_follows_its_model_and_leads_it(evaluate: Open) -> None:
    """Each is told once of what the other did, and not of what it did itself."""
    parts = given(turning())
    scene = base64.b64encode(zipped(parts["scene"])).decode()
    found = evaluate(
        ("model/data.js", "widget.js"), MODEL, {"angle_deg": 60.0, "scene": scene, "voxels": parts["voxels"]}
    )
    assert found == {"told": [60.0, 0, 222.5, 0, 33, 1], "parts": 3, "outside": True, "left": 0}


GROUNDS = """(async () => {
  const parts = Object.fromEntries(["scene", "voxels"].map((part) => [part, fromBase64(argument[part])]));
  const model = { get: (name) => parts[name] ?? 60, on() {}, off() {} };
  const around = document.createElement("div");
  const inside = around.attachShadow({ mode: "open" }).appendChild(document.createElement("div"));
  const still = () => new Promise((done) => setTimeout(done, 100));
  const theme = () => inside.firstChild.dataset.theme;
  const end = await render({ model, el: inside });
  const themes = [theme()];
  around.style.background = "oklch(0.2 0.05 250)";
  document.body.append(around);
  await still();
  themes.push(theme());
  for (const [transparent, body] of [[true, "#1e1e1e"], [true, "#fff"], [false, "#ffe"]]) {
    around.style.background = transparent ? "#fff2" : "black";
    document.body.style.background = body;
    await still();
    themes.push(theme());
  }
  end();
  return themes;
})()"""


QUIET = """(async () => {
  const parts = Object.fromEntries(["scene", "voxels"].map((part) => [part, fromBase64(argument[part])]));
  const el = document.body.appendChild(document.createElement("div"));
  const end = await render({ model: { get: (name) => parts[name] ?? 60, on() {}, off() {} }, el });
  const said = el.querySelector(".quiet")?.textContent ?? null;
  end();
  return said;
})()"""


def test_a_widget_says_where_it_holds_a_smaller_cube(evaluate: Open) -> None:
    parts = given(turning())
    for full, said in (
        (parts["scene"]["kept"]["full"], ""),
        ((200, 200, 200), "solved for the pictures of one of 200³"),
    ):
        parts["scene"]["kept"]["full"] = full
        scene = base64.b64encode(zipped(parts["scene"])).decode()
        found = evaluate(("model/data.js", "widget.js"), QUIET, {"scene": scene, "voxels": parts["voxels"]})
        assert said in found if said else found is None


def test_a_widget_is_as_dark_as_its_notebook(evaluate: Open) -> None:
    parts = given(turning())
    scene = base64.b64encode(zipped(parts["scene"])).decode()
    found = evaluate(("model/data.js", "widget.js"), GROUNDS, {"scene": scene, "voxels": parts["voxels"]})
    assert found == ["light", "dark", "dark", "light", "dark"]


def test_the_style_stays_inside() -> None:
    """Every rule is below .lightcube: a notebook around it looks as before."""
    text = re.sub(
        r"/\*.*?\*/|@media[^{]*\{|@keyframes \S+ \{[^}]*\}[^}]*\}[^}]*\}", "", source("style.css"), flags=re.DOTALL
    )
    selectors = [each.strip() for group in re.findall(r"([^{};]+)\{", text) for each in group.split(",")]
    assert selectors
    assert [each for each in selectors if not each.startswith(".lightcube")] == []
