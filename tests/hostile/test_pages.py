"""Names that are code: in no browser do they run or become a part of a page, whatever page it is."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lightcube as lc
from lightcube.cli import main
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from tests.conftest import INTERPRETED
from tests.helpers.browser import opened
from tests.helpers.marionette import firefox
from tests.helpers.visiting import GRID, turning, until
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
READY = "document.querySelector('main:not(#lightcube), #lightcube[data-drawn]')"
ROOMS = ("turntable", "stage")
PAGES = tuple((room, kind) for room in ROOMS for kind in ("view", "report"))


def cube(room: str, texts: Sequence[str]) -> lc.Cube:
    """A cube whose every text is one of these."""

    def say(number: int) -> str:
        return texts[number % len(texts)]

    said = {say(number): say(number + 1) for number in range(len(texts))}
    provenance: dict[str, Any] = {"lightcube": say(2), "method": "display", "pictures": say(4), "order": say(5), **said}
    if room == "turntable":
        made = turning()
        names = tuple(map(say, range(len(made.rig))))
    else:
        lamps = tuple(Lamp(say(number), (1.0, 0.1 * number, -0.3)) for number in range(3))
        screens = (Screen(say(4), (9.0, 0.0, -2.0), (5.6, 8.4), 1.4), Screen(say(5), (9.0, 9.0, -2.0), (5.6, 8.4), 1.4))
        shots = tuple(Shot(say(6 + number), screens[number].name, (lamps[number].name,)) for number in range(2))
        rig = Stage(GRID, lamps, screens, shots, cube_turns=False).rig()
        targets = np.full((len(rig), *rig.picture_shape, 4), 60000, np.uint16)
        made = lc.Cube(glass(GRID.shape), GRID, rig, targets=targets)
        names = (say(6), say(7))
    return replace(made, names=names, provenance=provenance)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Pages of all kinds with evil texts, and the same ones with harmless texts."""
    folder = tmp_path_factory.mktemp("pages")
    kinds = {"evil": EVIL, "harmless": tuple(f"name {number}" for number in range(len(EVIL)))}
    for kind, texts in kinds.items():
        for room in ROOMS:
            lc.save(cube(room, texts), folder / f"{room}.npz", overwrite=True)
            for verb in ("view", "report"):
                arguments = [verb, str(folder / f"{room}.npz"), "-o", str(folder / f"{room}-{verb}-{kind}.html")]
                assert main.run(arguments) == 0
    return folder


@pytest.fixture(scope="module")
def second(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    with firefox(tmp_path_factory.mktemp("firefox")) as found:
        yield found


@pytest.mark.parametrize(("room", "kind"), PAGES)
def test_in_chromium_names_stay_names(browser: Any, written: Path, room: str, kind: str) -> None:
    found = {}
    for which in ("evil", "harmless"):
        tab, heard = opened(browser, written / f"{room}-{kind}-{which}.html")
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
        second.open(written / f"{room}-{kind}-{which}.html")
        second.until(READY)
        found[which] = second.evaluate(COUNT)
    assert found["evil"] == found["harmless"]
    assert not found["evil"]["harmed"]


@pytest.mark.parametrize("kind", ["view", "report"])
def test_no_script_runs_but_the_pages_own(browser: Any, written: Path, tmp_path: Path, kind: str) -> None:
    """Even if a text became a part of the page."""
    text = (written / f"turntable-{kind}-harmless.html").read_text(encoding="utf-8")
    (tmp_path / "page.html").write_text(text.replace("</main>", f"{EVIL[0]}{EVIL[2]}</main>"), encoding="utf-8")
    tab, _ = opened(browser, tmp_path / "page.html")
    tab.wait_for_timeout(500)
    assert not tab.evaluate(COUNT)["harmed"]
    tab.context.close()
