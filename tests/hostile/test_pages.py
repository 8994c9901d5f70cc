"""Names that are code: in no browser do they run or become a part of a page, whatever page it is."""

import re
from collections.abc import Iterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import lightcube as lc
from lightcube.cli import main
from lightcube.drawing.stage import drawing
from lightcube.errors import shown
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from tests.conftest import INTERPRETED
from tests.helpers.browser import opened
from tests.helpers.marionette import firefox
from tests.helpers.visiting import GRID, turning, until
from tests.viewer.test_notebook import hosted
from tests.viewer.test_shadows import glass

pytestmark = pytest.mark.skipif(INTERPRETED, reason="a page is the same whether kernels are compiled or not")

HARM = "document.documentElement.dataset.harmed=1"
EVIL = (
    f"<script>{HARM}</script>",
    f"</script></style></title><script>{HARM}</script>",
    f'"><img src=x onerror="{HARM}">',
    f"' onmouseover='{HARM}' autofocus onfocus='{HARM}' x='",
    f"--><svg onload={HARM}><!--",
    f"]]></text><script>{HARM}</script>",
    f"{{{{code}}}} ${{{HARM}}} javascript:{HARM}",
    '<meta http-equiv="refresh" content="0;url=https://example.org"><base href="https://example.org/">',
    '<form action="https://example.org"><button>press</button></form><iframe src="https://example.org"></iframe>',
)
#: Of a document: how often it has which element, its policy apart, and whether anything ran.
COUNT = """(() => {
  const found = {};
  for (const each of document.querySelectorAll("*")) found[each.localName] = (found[each.localName] || 0) + 1;
  return { found, harmed: Object.keys(document.documentElement.dataset).includes("harmed") };
})()"""
#: Whether a page shows its cube; a report does so at once.
READY = "document.querySelector('main:not(#lightcube), #lightcube[data-drawn], svg:root')"
ROOMS = ("turntable", "stage")
PAGES = (*((room, kind) for room in ROOMS for kind in ("view", "report")), ("stage", "draw"))
#: Beside code: what ends a line, turns letters round, has no width, is no letter of XML or no letter at all.
ODD = ("\x1b[31m", "\u202etxt.", "a\tb\r\nc", "\u2066\u200f\u200b", "\0\x08\ufffe", "\ud800", "&amp;&#0;<![CDATA[")


def stage(texts: tuple[str, ...]) -> Stage:
    """A room in which everything has such a name."""
    first, second, third, wall, end, *names = (f"{text}{at}" for at, text in enumerate((texts * 7)[:7]))
    lamps = tuple(Lamp(name, (1.0, 0.1 * at, -0.3)) for at, name in enumerate((first, second, third)))
    screens = (Screen(wall, (9.0, 0.0, -2.0), (5.6, 8.4), 1.4), Screen(end, (9.0, 9.0, -2.0), (5.6, 8.4), 1.4))
    shots = tuple(Shot(name, screens[at].name, (lamps[at].name,)) for at, name in enumerate(names))
    return Stage(GRID, lamps, screens, shots, cube_turns=False)


def cube(room: str, texts: tuple[str, ...]) -> lc.Cube:
    """A cube whose every text is one of these."""

    def say(number: int) -> str:
        return texts[number % len(texts)]

    said = {say(number): say(number + 1) for number in range(len(texts))}
    provenance: dict[str, Any] = {"lightcube": say(2), "method": "display", "pictures": say(4), "order": say(5), **said}
    if room == "turntable":
        made = turning()
        names = tuple(map(say, range(len(made.rig))))
    else:
        rig = stage(texts).rig()
        targets = np.full((len(rig), *rig.picture_shape, 4), 60000, np.uint16)
        made = lc.Cube(glass(GRID.shape), GRID, rig, targets=targets)
        names = (say(6), say(7))
    return replace(made, names=names, provenance=provenance)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Pages of all kinds with evil texts, and the same ones with harmless texts."""
    folder = tmp_path_factory.mktemp("pages")
    kinds = {"evil": EVIL, "harmless": tuple(re.sub(r"[^a-z]", "x", text) for text in EVIL)}
    for kind, texts in kinds.items():
        for room in ROOMS:
            lc.save(cube(room, texts), folder / f"{room}.npz", overwrite=True)
            for verb in ("view", "report"):
                arguments = [verb, str(folder / f"{room}.npz"), "-o", str(folder / f"{room}-{verb}-{kind}.html")]
                assert main.run(arguments) == 0
        lc.save(drawing(stage(texts)), folder / f"stage-draw-{kind}.svg")
    return folder


def page_of(written: Path, room: str, kind: str, which: str) -> Path:
    return written / f"{room}-{kind}-{which}{'.svg' if kind == 'draw' else '.html'}"


@pytest.fixture(scope="module")
def second(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    with firefox(tmp_path_factory.mktemp("firefox")) as found:
        yield found


@pytest.mark.parametrize(("room", "kind"), PAGES)
def test_in_chromium_names_stay_names(browser: Any, written: Path, room: str, kind: str) -> None:
    found = {}
    for which in ("evil", "harmless"):
        tab, heard = opened(browser, page_of(written, room, kind, which))
        until(tab, READY)
        found[which] = tab.evaluate(COUNT)
        assert [each for each in heard if not each.startswith("file:")] == []
        tab.context.close()
    assert found["evil"] == found["harmless"]
    assert not found["evil"]["harmed"]


@pytest.mark.parametrize(("room", "kind"), PAGES)
def test_in_firefox_names_stay_names(second: Any, written: Path, room: str, kind: str) -> None:
    found = {}
    for which in ("evil", "harmless"):
        second.open(page_of(written, room, kind, which))
        second.until(READY)
        found[which] = second.evaluate(COUNT)
    assert found["evil"] == found["harmless"]
    assert not found["evil"]["harmed"]


@pytest.mark.parametrize("text", [*EVIL, *ODD], ids=ascii)
def test_a_drawing_is_xml_that_says_its_names(text: str) -> None:
    """Whatever they are: what is no letter of XML, or none that people see, is written as Python writes it."""
    drawn = drawing(stage((text,))).encode()
    names = {each.text for each in ElementTree.fromstring(drawn).iter() if each.text}  # noqa: S314 - our own drawing
    assert shown(f"{text}0") in names
    assert not [letter for name in names for letter in name if not letter.isprintable() and letter != "\n"]


@pytest.mark.skipif(not find_spec("anywidget"), reason="widgets need the extra notebook")
def test_in_a_notebook_names_stay_names(browser: Any) -> None:
    found = []
    for texts in (EVIL, tuple(re.sub(r"[^a-z]", "x", text) for text in EVIL)):
        tab = browser.new_page(device_scale_factor=0.25)
        hosted(tab, cube("turntable", texts))
        found.append(tab.evaluate(COUNT))
        tab.close()
    assert found[0] == found[1]
    assert not found[0]["harmed"]


@pytest.mark.parametrize("kind", ["view", "report"])
def test_no_script_runs_but_the_pages_own(browser: Any, written: Path, tmp_path: Path, kind: str) -> None:
    """Even if a text became a part of the page."""
    text = (written / f"turntable-{kind}-harmless.html").read_text(encoding="utf-8")
    (tmp_path / "page.html").write_text(text.replace("</main>", f"{EVIL[0]}{EVIL[2]}</main>"), encoding="utf-8")
    tab, _ = opened(browser, tmp_path / "page.html")
    tab.wait_for_timeout(500)
    assert not tab.evaluate(COUNT)["harmed"]
    tab.context.close()
