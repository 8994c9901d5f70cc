"""Pages in a browser for tests: fixtures that open them, and hands that do what people do there."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.optics.transfer import encode
from lightcube.viewer.packing import pack
from lightcube.viewer.page import page
from tests.helpers.areas import THIN, averaged, judged
from tests.helpers.browser import opened
from tests.viewer.test_shadows import glass, on_stage

Open = Callable[..., Any]
STOPS = [10.0, 60.0, 130.0, 200.0, 290.0]
NAMES = ("astronaut", "coffee", "cat", "rocket", "moon")
GRID = Grid((12, 14, 16), 2.0)
ROWS, COLUMNS = 8, 10
CUBE = "document.getElementById('lightcube').lightcube"
PHONE = {"width": 390, "height": 844, "has_touch": True, "is_mobile": True}


def turning() -> Cube:
    """A random cube on a turntable with a raised lamp, and random pictures wanted of it."""
    random = np.random.default_rng(3)
    rig = turntable(GRID, STOPS, elevation_deg=35.0, picture_shape=(ROWS, COLUMNS))
    targets = random.integers(0, 65536, (len(STOPS), ROWS, COLUMNS, 4), dtype=np.uint16)
    powers = random.uniform(0.5, 2.0, (len(STOPS), 3))
    return Cube(glass(GRID.shape), GRID, rig, powers, targets=targets, names=NAMES)


def standing_still() -> Cube:
    """One picture, on a stage where nothing turns."""
    room = Grid((3, 5, 7), 1.4)
    screen, lamp = Screen("wall", (9.0, 0.0, -2.0), (5.6, 8.4), 1.4), Lamp("red", (1.0, 0.0, -0.3))
    rig = Stage(room, (lamp,), (screen,), (Shot("one", "wall", ("red",)),), cube_turns=False).rig()
    return Cube(glass(room.shape), room, rig)


CUBES: dict[str, Callable[[], Cube]] = {
    "turntable": turning,
    "stage": lambda: on_stage("two screens of different sizes"),
    "still": standing_still,
}


@pytest.fixture(scope="session")
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

    def go(
        name: str = "turntable",
        *,
        width: int = 920,
        height: int = 440,
        details: bool = False,
        untouched: bool = False,
        **context: Any,
    ) -> Any:
        tab, heard = opened(browser, pages[name], width=width, height=height, **context)
        tabs.append((tab, heard))
        until(tab, CUBE)
        rested(tab)
        if not untouched:  # else it turns by itself after a while
            tab.evaluate("document.getElementById('lightcube').dispatchEvent(new PointerEvent('pointerdown'))")
        if details:
            tab.keyboard.press("d")
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


def angle_deg(tab: Any) -> float:
    return tab.evaluate(f"{CUBE}.angle")


def stands(tab: Any, where: float) -> None:
    """Wait until the cube stands at an angle."""
    until(tab, f"Math.abs({CUBE}.angle - {where}) < 1e-6")
    rested(tab)
    assert angle_deg(tab) == pytest.approx(where)


def turned_to(tab: Any, where: float) -> None:
    tab.evaluate(f"{CUBE}.turnTo({where})")
    rested(tab)


def middle(tab: Any, selector: str) -> tuple[float, float]:
    box = tab.locator(selector).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(tab: Any, across: float, down: float = 0, *, button: str = "left", hold_deg: bool = True) -> None:
    """Drag over the room, still before letting go unless it is thrown."""
    x, y = middle(tab, "canvas.room")
    tab.mouse.move(x - across / 2, y)
    tab.mouse.down(button=button)
    tab.mouse.move(x + across / 2, y + down, steps=8)
    if hold_deg:
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


def right(cube: Cube, where: float, *, whole: bool = False, thin: bool = False) -> np.ndarray:
    """Levels of the whole pixels, or of the thin beams through their middles, for each screen."""
    packed = pack(cube).cube
    light = averaged(packed, [where], THIN, whole=whole) if thin else judged(packed, [where], whole=whole)
    return 255 * encode(np.clip(light, 0, 1), cube.transfer)
