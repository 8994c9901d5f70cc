"""The studio in a real browser: from an empty page to a cube, by hand and by keys, for everybody and on a phone."""

import importlib.util
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import skimage.data
from PIL import Image

pytest.importorskip("fastapi", reason="the studio's extra is not installed")
pytest.importorskip("uvicorn", reason="the studio's extra is not installed")
pytest.importorskip("httpx2", reason="httpx2 is not installed")

from lightcube import io
from lightcube.studio.project import MAKINGS, Settings
from tests.helpers.studios import entered, is_bad, started

#: Bytes of the page before pictures, all that it is made of.
HEAVIEST = 250_000
#: Others may use the machine too.
PATIENCE_MS = 60_000


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a studio that runs as people start it, for all who make nothing in it."""
    with started(tmp_path_factory.mktemp("shared") / "project") as (_, address):
        yield address


@pytest.fixture
def studio(running: str) -> str:
    """The same, as it is when it is new."""
    with entered(running) as client:
        client.put("/api/pictures", json={"keys": []})
        settings = Settings().model_dump(mode="json")
        client.patch("/api/settings", json={name: settings[name] for name in ("kind", "title", *MAKINGS)})
    return running


@pytest.fixture
def enter(browser: Any, studio: str) -> Iterator[Callable[..., Any]]:
    """A function that opens the studio in a tab; whatever a tab complains of fails the test."""
    yield from tabs(browser, studio)


@pytest.fixture
def enter_alone(browser: Any, tmp_path: Path) -> Iterator[Callable[..., Any]]:
    """The same of a studio of one's own, in which something can be made."""
    with started(tmp_path / "project") as (_, address):
        yield from tabs(browser, address)


def tabs(browser: Any, studio: str) -> Iterator[Callable[..., Any]]:
    """A function that opens a studio in a tab, and what it complained of in the end."""
    heard: list[str] = []
    contexts: list[Any] = []

    def open_tab(**context: Any) -> Any:
        contexts.append(browser.new_context(**context))
        tab = contexts[-1].new_page()
        tab.on("console", lambda said: heard.append(said.text) if is_bad(said) else None)
        tab.on("pageerror", lambda error: heard.append(str(error)))
        tab.on("request", lambda asked: heard.append(asked.url) if "//127.0.0.1:" not in asked.url[:30] else None)
        tab.goto(studio)
        tab.wait_for_selector("[data-ready]")
        return tab

    yield open_tab
    for context in contexts:
        context.close()
    assert [each for each in heard if not each.startswith(("data:", "blob:"))] == []


#: Asks to change a setting, whose answer takes a while, then to do something, and how all stands; tells what happened.
_ASKED_AT_ONCE = """async () => {
  const { askOf } = await import("/web/tools/asking.js");
  const told = [], own = window.fetch, slow = { PATCH: 50 };
  window.fetch = async (path, given) => {
    told.push(`asked ${path}`);
    await new Promise((done) => setTimeout(done, slow[given.method] ?? 0));
    told.push(`answered ${path}`);
    return new Response("{}");
  };
  try {
    const ask = askOf({ say() {} });
    await Promise.all([ask("title", { method: "PATCH" }), ask("start", { method: "POST" }), ask("state")]);
  } finally {
    window.fetch = own;
  }
  return told;
}"""


def test_what_is_done_waits_for_what_was_changed_before_it(enter: Callable[..., Any]) -> None:
    """Who gives a title and presses a button at once gets a thing of that title."""
    told = enter().evaluate(_ASKED_AT_ONCE)
    assert told.index("answered title") < told.index("asked start")
    assert told.index("answered state") < told.index("answered title"), "who only looks need not wait"


def until(tab: Any, expression: str) -> None:
    """Wait for something that the page's own policy would not let it be asked by itself."""
    began = time.monotonic()
    while not tab.evaluate(expression):
        assert time.monotonic() - began < PATIENCE_MS / 1000, expression
        tab.wait_for_timeout(50)


def drop(tab: Any, files: list[Path]) -> None:
    tab.set_input_files("input[type=file]", [str(file) for file in files])


@pytest.fixture
def photos(tmp_path: Path) -> list[Path]:
    found = [skimage.data.coffee(), skimage.data.astronaut(), skimage.data.chelsea()]
    for number, levels in enumerate(found):
        Image.fromarray(levels).save(tmp_path / f"photo {number + 1}.jpg")
    return [tmp_path / f"photo {number + 1}.jpg" for number in range(len(found))]


def test_the_whole_story_in_two_tabs(enter_alone: Callable[..., Any], photos: list[Path], tmp_path: Path) -> None:
    tab, other = enter_alone(), enter_alone()
    assert tab.get_by_text("Drop pictures here").is_visible()
    drop(tab, photos[:2])
    tab.wait_for_selector(".forecast .walls li:nth-child(2)", timeout=PATIENCE_MS)
    other.wait_for_selector(".strip li:nth-child(2)")
    assert tab.locator(".forecast .verdict").inner_text()
    tab.get_by_role("textbox", name="Title").fill("Two of them")
    tab.get_by_role("slider", name="How fine").fill("32")
    tab.get_by_label("Care").select_option("draft")
    until(other, "document.querySelector('select[name=quality]').value === 'draft'")
    assert "--n 32 --quality draft" in other.locator(".command code").inner_text()
    tab.get_by_role("button", name="Make the cube").click()
    other.wait_for_selector(".walls.live li", timeout=PATIENCE_MS)
    tab.wait_for_selector(".solving[data-status=done]", timeout=PATIENCE_MS)
    assert "The cube is finished" in tab.locator(".solving .state").inner_text()
    turned = tab.wait_for_selector(".turned .lightcube", timeout=PATIENCE_MS)
    before = turned.evaluate("(root) => root.lightcube.angle")
    tab.locator(".turned .thumbnail:not([aria-current])").first.click()
    until(tab, f"document.querySelector('.turned .lightcube').lightcube.angle !== {before}")
    assert "Two of them" in save(tab, "A page", tmp_path).read_text()
    assert {each.shape for each in io.read_pictures(save(tab, "A square movie", tmp_path), to_s=0.1).images} == {
        (1080, 1080, 3)
    }
    if importlib.util.find_spec("reportlab"):
        assert save(tab, "Films", tmp_path).read_bytes().startswith(b"%PDF-")
    other.reload()
    other.wait_for_selector(".walls.live li")
    assert "The cube is finished" in other.locator(".solving .state").inner_text()
    assert other.get_by_role("link", name="Save a square movie").is_visible()


def save(tab: Any, thing: str, folder: Path) -> Path:
    """Make a thing, and save it as the browser does."""
    tab.get_by_role("button", name=f"Make: {thing}", exact=True).click()
    link = tab.get_by_role("link", name=f"Save {thing.lower()}")
    link.wait_for(timeout=PATIENCE_MS)
    with tab.expect_download() as awaited:
        link.click()
    path = folder / awaited.value.suggested_filename
    awaited.value.save_as(path)
    return path


def test_the_whole_story_by_keys_alone(enter_alone: Callable[..., Any]) -> None:
    tab = enter_alone(reduced_motion="reduce")
    to(tab, "Title of this project")
    tab.keyboard.type("By keys")
    to(tab, "Five letters")
    tab.keyboard.press("Enter")
    tab.wait_for_selector(".forecast .walls li:nth-child(5)", timeout=PATIENCE_MS)
    to(tab, "How fine")
    for _ in range(2):
        tab.keyboard.press("ArrowLeft")
    to(tab, "Care")
    tab.keyboard.type("qu")
    until(tab, "document.querySelector('.command code').textContent.includes('--n 32 --quality draft')")
    to(tab, "Make the cube")
    tab.keyboard.press("Enter")
    tab.wait_for_selector(".solving[data-status=done]", timeout=PATIENCE_MS)
    tab.wait_for_selector(".turned .thumbnail[aria-current]", timeout=PATIENCE_MS)
    before = tab.locator(".turned .thumbnail[aria-current]").get_attribute("aria-label")
    to(tab, before)
    tab.keyboard.press("ArrowRight")
    until(tab, f"document.activeElement.ariaLabel !== {before!r} && document.activeElement.ariaCurrent === 'true'")
    to(tab, "Make: A page")
    tab.keyboard.press("Enter")
    tab.get_by_role("link", name="Save a page").wait_for(timeout=PATIENCE_MS)
    to(tab, "Save a page")
    with tab.expect_download() as awaited:
        tab.keyboard.press("Enter")
    assert awaited.value.suggested_filename == "By-keys-page.html"


def to(tab: Any, name: str) -> None:
    """Go on by Tab until something of a name has the focus; once round at most."""
    named = """() => {
        const at = document.activeElement;
        const label = at.ariaLabel ?? at.labels?.[0]?.textContent ?? at.textContent ?? "";
        return label.trim();
    }"""
    for _ in range(150):
        tab.keyboard.press("Tab")
        if tab.evaluate(named).startswith(name):
            return
    raise AssertionError(f"no Tab leads to {name}")


def test_what_is_pasted_and_telephones_own_kind_of_photographs_are_taken(enter: Callable[..., Any]) -> None:
    tab = enter(permissions=["clipboard-read", "clipboard-write"])
    tab.evaluate(
        """async () => {
            const canvas = Object.assign(document.createElement("canvas"), { width: 30, height: 20 });
            canvas.getContext("2d").fillRect(0, 0, 9, 9);
            const blob = await new Promise((resolve) => canvas.toBlob(resolve));
            await navigator.clipboard.write([new ClipboardItem({ "image/png": blob })]);
        }"""
    )
    tab.locator("body").press("Control+v")
    tab.wait_for_selector(".strip li:nth-child(1)")
    pytest.importorskip("pi_heif", reason="pi-heif is not installed")
    drop(tab, [Path(__file__).parents[1] / "io" / "files" / "four-colours.heic"])
    until(tab, "document.querySelector('.strip li:nth-child(2) input')?.value === 'four-colours'")


def test_of_a_video_a_part_is_taken(enter: Callable[..., Any], tmp_path: Path) -> None:
    frames = np.linspace(0, 1, 20)[:, None, None, None] * np.ones((1, 16, 24, 3))
    io.save(frames.astype(np.float32), tmp_path / "walk.mp4", fps=10)
    tab = enter()
    drop(tab, [tmp_path / "walk.mp4"])
    tab.get_by_label("From, in seconds").fill("0.5")
    tab.get_by_label("To, in seconds").fill("1.5")
    tab.get_by_label("One of so many pictures").fill("3")
    tab.get_by_role("button", name="Take these").click()
    tab.wait_for_selector(".strip li")
    assert tab.locator(".strip li input").evaluate_all("(all) => all.map((each) => each.value)") == [
        f"walk {number}" for number in range(1, 5)
    ]


def test_a_webcam_takes_a_picture(launch: Callable[..., Any], studio: str) -> None:
    with launch("--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream") as started_anew:
        tab = started_anew.new_page()
        tab.goto(studio)
        tab.get_by_role("button", name="Webcam").click()
        until(tab, "document.querySelector('dialog video')?.videoWidth > 0")
        tab.get_by_role("button", name="Take it").click()
        tab.wait_for_selector(".strip li")
        assert tab.locator(".strip li input").input_value() == "webcam"
        assert tab.locator("dialog").count() == 0


def test_pictures_by_keys_alone(enter: Callable[..., Any], photos: list[Path]) -> None:
    tab = enter()
    drop(tab, photos[:2])
    tab.wait_for_selector(".strip li:nth-child(2)")
    tab.locator(".strip li").first.focus()
    tab.keyboard.press("Alt+ArrowRight")
    until(tab, "document.querySelector('.strip li input').value === 'photo 2'")
    crop = tab.get_by_role("button", name="Crop photo 2")
    crop.focus()
    tab.keyboard.press("Enter")
    tab.get_by_role("button", name="Corner lower right").focus()
    for _ in range(5):
        tab.keyboard.press("ArrowLeft")
    tab.get_by_role("button", name="Take this").press("Enter")
    until(tab, "document.querySelector('.strip li img').style.clipPath !== ''")
    tab.get_by_role("button", name="Remove photo 1").press("Enter")
    until(tab, "document.querySelectorAll('.strip li').length === 1")
    tab.locator("body").press("Control+z")
    until(tab, "document.querySelectorAll('.strip li').length === 2")


def test_pictures_are_put_in_order_by_hand(enter: Callable[..., Any], photos: list[Path]) -> None:
    tab = enter()
    drop(tab, photos)
    tab.wait_for_selector(".strip li:nth-child(3)")
    boxes = [tab.locator(".strip li").nth(number).bounding_box() for number in (0, 2)]
    tab.mouse.move(boxes[0]["x"] + 60, boxes[0]["y"] + 60)
    tab.mouse.down()
    tab.mouse.move(boxes[1]["x"] + 80, boxes[1]["y"] + 60, steps=8)
    tab.mouse.up()
    until(tab, "document.querySelector('.strip li:nth-child(3) input').value === 'photo 1'")


def test_what_is_no_picture_is_said_in_the_page(enter: Callable[..., Any], tmp_path: Path) -> None:
    wrong = tmp_path / "letter.png"
    wrong.write_text("dear reader")
    tab = enter()
    drop(tab, [wrong] * 65)
    tab.wait_for_selector(".said .bad")
    assert "there is room for 64" in tab.locator(".said").inner_text()


def drop_by_hand(tab: Any, paths: list[Path]) -> None:
    """Drop files and folders onto the page, as from a desktop."""
    hand = tab.context.new_cdp_session(tab)
    held = {"items": [], "files": [str(path) for path in paths], "dragOperationsMask": 1}
    for kind in ("dragEnter", "dragOver", "drop"):
        hand.send("Input.dispatchDragEvent", {"type": kind, "x": 300, "y": 300, "data": held})


def test_files_and_folders_are_dropped_and_each_that_is_no_picture_is_named(
    enter: Callable[..., Any], photos: list[Path], tmp_path: Path
) -> None:
    folder = tmp_path / "holidays"
    folder.mkdir()
    for number in (10, 9):
        photos[number - 9].rename(folder / f"day {number}.jpg")
    (folder / ".hidden.jpg").write_text("no picture")
    (folder / "a.txt").write_text("no picture")
    (folder / "b.png").write_text("no picture")
    tab = enter()
    drop_by_hand(tab, [photos[2], folder])
    tab.wait_for_selector(".said .bad")
    said = tab.locator(".said").inner_text()
    assert "a.txt is no picture" in said
    assert "b.png" in said
    names = "(all) => all.map((each) => each.value)"
    assert tab.locator(".strip li input").evaluate_all(names) == ["photo 3", "day 9", "day 10"]


def test_what_is_refused_goes_back(enter: Callable[..., Any], photos: list[Path]) -> None:
    tab = enter()
    drop(tab, photos[:1])
    tab.wait_for_selector(".strip li")
    refuse = {"status": 400, "json": {"sentence": "no space is left on the disk"}}
    for path in ("**/api/settings", "**/api/pictures/*"):
        tab.route(path, lambda route: route.fulfill(**refuse) if route.request.method == "PATCH" else route.continue_())
    for box, before in (("Title of this project", ""), ("Name of picture 1", "photo 1")):
        tab.get_by_role("textbox", name=box).fill("Another")
        tab.keyboard.press("Tab")
        tab.get_by_text("No space is left on the disk.").wait_for()
        until(tab, f"document.querySelector('[aria-label=\"{box}\"]').value === '{before}'")
    tab.get_by_label("Care").select_option("draft")
    until(tab, "document.querySelector('select[name=quality]').value === 'normal'")


def test_a_studio_that_is_gone_is_told_of_and_a_door_begins_at_its_top(browser: Any, tmp_path: Path) -> None:
    with started(tmp_path / "project") as (process, address):
        context = browser.new_context(viewport={"width": 390, "height": 500})
        tab = context.new_page()
        tab.goto(address)
        tab.wait_for_selector("[data-ready]")
        tab.get_by_role("button", name="Room").click()
        tab.wait_for_selector(".troubles li")
        tab.evaluate("scrollTo(0, 400)")
        tab.get_by_role("button", name="Lessons").click()
        until(tab, "scrollY === 0")
        process.kill()
        tab.get_by_text("The studio does not answer").wait_for(timeout=PATIENCE_MS)
    port = int(address.rpartition(":")[2].partition("/")[0])
    with started(tmp_path / "project", "--port", str(port)) as (_, other):
        tab.get_by_text("The studio was started again, and has another key now").wait_for(timeout=PATIENCE_MS)
        context.new_page().goto(other)
        tab.get_by_text("The studio is back").wait_for(timeout=PATIENCE_MS)
        context.close()


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_everybody_can_use_it(theme: str, enter: Callable[..., Any]) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not installed")
    tab = enter(color_scheme=theme, viewport={"width": 390, "height": 800}, bypass_csp=True)
    tab.get_by_role("button", name="Five letters").click()
    tab.wait_for_selector(".forecast .walls li", timeout=30_000)
    found = axe.Axe().run(tab)
    assert found.violations_count == 0, found.generate_report()
    assert tab.evaluate("document.documentElement.scrollWidth") == 390


def test_the_page_is_light_and_soon_there(enter: Callable[..., Any]) -> None:
    tab = enter()
    sizes = tab.evaluate("performance.getEntriesByType('resource').map((each) => each.encodedBodySize)")
    assert len(sizes) > 8
    assert 10_000 < sum(sizes) < HEAVIEST
