"""Lessons and the room in a real browser: by hand and by keys, for all who read screens, at phone width too."""

import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("fastapi", reason="the studio's extra is not installed")
pytest.importorskip("uvicorn", reason="the studio's extra is not installed")
pytest.importorskip("httpx2", reason="httpx2 is not installed")
import uvicorn

from lightcube.studio.app import make_app
from lightcube.studio.kinds import KINDS
from lightcube.studio.project import Project
from tests.helpers.studios import is_bad


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    app = make_app(Project(Path(tmp_path_factory.mktemp("doors"))), "key")
    app.state.desk.starting.clear()  # nothing is forecast behind these doors
    server = uvicorn.Server(uvicorn.Config(app, host="127.0.0.1", port=0, log_level="error"))
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    port = server.servers[0].sockets[0].getsockname()[1]
    yield f"http://127.0.0.1:{port}/?token=key"
    app.state.desk.hub.close()
    server.should_exit = True
    thread.join(10)


@pytest.fixture
def tab(browser: Any, address: str) -> Iterator[Any]:
    context = browser.new_context(viewport={"width": 1280, "height": 900}, reduced_motion="reduce")
    opened, heard = context.new_page(), []
    opened.set_default_timeout(60_000)
    opened.on("console", lambda said: heard.append(said.text) if is_bad(said) else None)
    opened.on("pageerror", lambda error: heard.append(str(error)))
    opened.goto(address)
    opened.wait_for_selector("[data-ready]")
    yield opened
    context.close()
    assert not heard


def seen_by_axe(tab: Any, part: str) -> list[str]:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not installed").Axe()
    found = axe.run(tab, context=f"#part-{part}", options={"resultTypes": ["violations"]})
    return [f"{each['id']}: {each['nodes'][0]['html']}" for each in found.response["violations"]]


def test_a_lesson_is_walked_by_the_arrow_keys(tab: Any) -> None:
    tab.set_viewport_size({"width": 640, "height": 480})  # the solid is drawn by the processor here
    tab.click("nav >> text=Lessons")
    tab.wait_for_selector(".solid canvas.room")
    for title in ("A second one", "The hull of all three", "Where they contradict each other"):
        tab.keyboard.press("ArrowRight")
        tab.wait_for_selector(f".words h3:has-text('{title}')")
    tab.wait_for_selector(".found:has-text('No object casts')")
    tab.focus("canvas.box >> nth=1")
    tab.keyboard.press("ArrowLeft")  # moves in the box, not to another step
    assert tab.inner_text(".words h3") == "Where they contradict each other"
    tab.click("text=Empty boxes")
    tab.wait_for_selector(".found[data-bad]:has-text('The front is empty: draw something in its box.')")
    for box in range(3):
        tab.focus(f"canvas.box >> nth={box}")
        tab.keyboard.press(" ")
    tab.wait_for_selector(".found:has-text('One object casts all of this')")
    assert seen_by_axe(tab, "lessons") == []


def test_a_pen_draws_a_line_and_the_same_pen_clears(tab: Any) -> None:
    tab.click("nav >> text=Lessons")
    tab.click("text=Empty boxes")
    at = tab.locator("canvas.box").first.bounding_box()
    filled = (
        "[...document.querySelector('canvas.box').getContext('2d').getImageData(0, 0, 240, 240).data]"
        ".filter((each, i) => i % 4 === 3 && each === 255).length"
    )
    empty = tab.evaluate(filled)
    for _ in range(2):
        tab.mouse.move(at["x"] + 20, at["y"] + 20)
        tab.mouse.down()
        tab.mouse.move(at["x"] + 200, at["y"] + 150)
        tab.mouse.up()
        drawn = tab.evaluate(filled)
        assert (drawn > 3000 + empty) if _ == 0 else (drawn == empty)


def test_the_small_cube_is_found_by_three_pictures(tab: Any) -> None:
    tab.click("nav >> text=Lessons")
    tab.click("text=A cube of 27 voxels")
    tab.wait_for_selector(".slice-plan")
    tab.keyboard.press("ArrowRight")
    tab.click("[aria-label='Top slice, pixel 2']")
    tab.wait_for_selector(".equation:has-text('1.02 g + 1.02 h + 1.02 i')")
    for right in ("no voxel is", "3 of nine voxels are", "all nine voxels are"):
        tab.keyboard.press("ArrowRight")
        tab.wait_for_selector(f".found:has-text('{right} found')")
    assert seen_by_axe(tab, "lessons") == []


def test_a_wall_out_of_the_light_is_red_and_comes_back(tab: Any) -> None:
    tab.click("nav >> text=Room")
    tab.wait_for_selector(".troubles .well")
    wall = tab.locator(".plans svg").first.locator("[data-name='side wall'] .screen").bounding_box()
    middle = wall["x"] + wall["width"] / 2, wall["y"] + wall["height"] / 2
    tab.mouse.move(*middle)
    tab.mouse.down()
    tab.mouse.move(middle[0] + 160, middle[1] + 30, steps=4)
    tab.mouse.up()
    tab.wait_for_selector(".troubles .bad:has-text('miss screen \\'side wall\\'')")
    assert tab.locator(".plan-of .handle.bad").count() == 4  # the lamp and the wall, in both plans
    assert tab.is_disabled("text=Make a cube for this room")
    assert seen_by_axe(tab, "rooms") == []
    tab.click("text=Into the shadow")
    tab.wait_for_selector(".troubles .well")
    tab.focus("[data-name='back wall']")
    for _ in range(30):
        tab.keyboard.press("ArrowUp")
    tab.wait_for_selector(".troubles .bad:has-text('back wall')")
    assert tab.evaluate("document.activeElement.dataset.name") == "back wall"


@pytest.mark.parametrize("door", ["Lessons", "Room"])
def test_a_telephone_shows_it_all(tab: Any, door: str) -> None:
    tab.set_viewport_size({"width": 360, "height": 740})
    tab.click(f"nav >> text={door}")
    tab.wait_for_selector("canvas.room, .troubles li")
    assert tab.evaluate("document.documentElement.scrollWidth") <= 360


STATE = "fetch('/api/state').then((answer) => answer.json())"


def heard_of(tab: Any, field: str, before: dict[str, Any]) -> set[str]:
    """Which settings are others than they were."""
    now = tab.evaluate(STATE)["settings"][field]
    return {each for each in now if now[each] != before[field][each]}


#: Chooses the last of some options, as a person does.
CHOOSE_LAST = "(each) => { each.selectedIndex = each.length - 1; each.dispatchEvent(new Event('change')); }"


def wait_until_heard(tab: Any, field: str, before: dict[str, Any], names: set[str]) -> None:
    began = time.monotonic()
    while not heard_of(tab, field, before) >= names:
        assert time.monotonic() - began < 20, names - heard_of(tab, field, before)
        tab.wait_for_timeout(50)


def test_all_that_can_be_said_of_each_kind_is_heard(tab: Any) -> None:
    """Each slider and choice moves the setting of its name, of the kind that is chosen, and the command with it."""
    tab.get_by_role("button", name="Five letters").click()
    tab.wait_for_selector(".strip li:nth-child(5)")
    for name, kind in KINDS.items():
        if name == "room":
            continue
        tab.get_by_role("radio", name=kind.title).click()
        tab.wait_for_selector(f".kind[aria-checked=true]:has-text('{kind.title}')")
        tab.wait_for_selector(f".command code:has-text('lightcube {kind.verb} ')")
        before = tab.evaluate(STATE)["settings"]
        controls = tab.locator(".sliders input:visible, .choices-of-making select:visible")
        names = set(controls.evaluate_all("(all) => all.map((each) => each.name)"))
        for each in names:
            control = tab.locator(f".forecast [name={each}]")
            if control.evaluate("(each) => each.tagName") == "INPUT":
                control.press("Home")
            else:
                control.evaluate(
                    "(each) => { each.selectedIndex = each.length - 1; each.dispatchEvent(new Event('change')); }"
                )
        wait_until_heard(tab, kind.settings, before, names)
        after = tab.evaluate(STATE)["settings"]
        assert heard_of(tab, kind.settings, before) == names
        assert {each for each in after if after[each] != before[each]} == {kind.settings}
        assert tab.locator(".said .bad").count() == 0, tab.locator(".said").inner_text()
    assert seen_by_axe(tab, "choosing") == []
    assert seen_by_axe(tab, "forecast") == []
    tab.get_by_role("radio", name="A light cube").press("ArrowLeft")
    assert tab.evaluate("document.activeElement.textContent").startswith("A cube in your room")


def test_a_room_becomes_a_cube_in_the_studio(tab: Any) -> None:
    tab.click("nav >> text=Room")
    tab.click("text=Wall and floor")
    tab.wait_for_selector(".troubles .well")
    tab.click("text=Make a cube for this room")
    tab.wait_for_selector(".kind[aria-checked=true]:has-text('A cube in your room')")
    tab.wait_for_selector(".command code:has-text('room.toml')")
    assert tab.is_visible("#part-forecast")
