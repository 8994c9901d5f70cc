"""The studio in a real browser: from an empty page to a cube, by hand and by keys, for everybody and on a phone."""

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import skimage.data
from PIL import Image

pytest.importorskip("fastapi", reason="the studio's extra is not installed")
pytest.importorskip("uvicorn", reason="the studio's extra is not installed")

#: Bytes of the page before pictures, all that it is made of.
HEAVIEST = 400_000


@pytest.fixture
def studio(tmp_path: Path) -> Iterator[str]:
    """The address of a studio that runs as people start it."""
    command = [sys.executable, "-m", "lightcube", "studio", str(tmp_path / "project"), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout is not None
        yield process.stdout.readline().strip()
        process.terminate()


@pytest.fixture
def enter(browser: Any, studio: str) -> Iterator[Callable[..., Any]]:
    """A function that opens the studio in a tab; whatever a tab complains of fails the test."""
    heard: list[str] = []
    contexts: list[Any] = []

    def open_tab(**context: Any) -> Any:
        contexts.append(browser.new_context(**context))
        tab = contexts[-1].new_page()
        tab.on("console", lambda said: heard.append(said.text) if said.type == "error" else None)
        tab.on("pageerror", lambda error: heard.append(str(error)))
        tab.on("request", lambda asked: heard.append(asked.url) if "//127.0.0.1:" not in asked.url[:30] else None)
        tab.goto(studio)
        tab.wait_for_selector("[data-ready]")
        return tab

    yield open_tab
    for context in contexts:
        context.close()
    assert [each for each in heard if not each.startswith(("data:", "blob:"))] == []


def until(tab: Any, expression: str) -> None:
    """Wait for something that the page's own policy would not let it be asked by itself."""
    began = time.monotonic()
    while not tab.evaluate(expression):
        assert time.monotonic() - began < 30, expression
        tab.wait_for_timeout(50)


def drop(tab: Any, files: list[Path]) -> None:
    tab.set_input_files("input[type=file]", [str(file) for file in files])


@pytest.fixture
def photos(tmp_path: Path) -> list[Path]:
    found = [skimage.data.coffee(), skimage.data.astronaut(), skimage.data.chelsea()]
    for number, levels in enumerate(found):
        Image.fromarray(levels).save(tmp_path / f"photo {number + 1}.jpg")
    return [tmp_path / f"photo {number + 1}.jpg" for number in range(len(found))]


def test_the_whole_story_in_two_tabs(enter: Callable[..., Any], photos: list[Path]) -> None:
    tab, other = enter(), enter()
    assert tab.get_by_text("Drop pictures here").is_visible()
    drop(tab, photos)
    tab.wait_for_selector(".walls li", timeout=30_000)
    other.wait_for_selector(".strip li:nth-child(3)")
    assert tab.locator(".forecast .walls li").count() == 3
    assert tab.locator(".forecast .verdict").inner_text()
    tab.get_by_role("slider", name="How fine").fill("32")
    tab.get_by_label("Care").select_option("draft")
    until(other, "document.querySelector('select[name=quality]').value === 'draft'")
    assert "--n 32 --quality draft" in other.locator(".command code").inner_text()
    tab.get_by_role("button", name="Make the cube").click()
    other.wait_for_selector(".walls.live li", timeout=30_000)
    tab.wait_for_selector(".solving[data-status=done]", timeout=30_000)
    assert "The cube is finished" in tab.locator(".solving .state").inner_text()
    tab.reload()
    tab.wait_for_selector(".walls.live li")
    assert "The cube is finished" in tab.locator(".solving .state").inner_text()


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
