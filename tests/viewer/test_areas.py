"""Light falls on areas: which beams make a pixel, how finely one sees it, and how one comes near."""

import json
from typing import Any

import numpy as np
import pytest

from tests.helpers.areas import JUDGED, JUDGED_LEVEL, THIN, Points, along_row, averaged, over_square
from tests.helpers.paging import ANGLES, GIVEN, Evaluate, asked, held_in_a_page, nearly
from tests.helpers.visiting import STOPS, Open, pages, rested, right, shown, turning, visit
from tests.viewer.test_shadows import given, on_stage, on_turntable

__all__ = ["pages", "visit"]

# which beams make a pixel


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("level", [THIN, along_row(3), JUDGED_LEVEL]),
        ("level, moved, held", [THIN, along_row(3), JUDGED_LEVEL]),
        *((name, [THIN, over_square(3, 2), JUDGED]) for name in ("raised", "one colour", "stage", "lamps go round")),
    ],
)
def test_beams_are_those_of_the_judge(evaluate: Evaluate, name: str, wanted: list[Points]) -> None:
    """Fewer in motion, and one as in the paper; along the row where light is level and rows are slices."""
    expression = "[THIN, QUICK, JUDGED].map((beams) => pointsOf(cube, exposures(scene, 43.7)[0], beams))"
    found = asked(evaluate, held_in_a_page(name)[2], expression)
    for points, right_ones in zip(found, wanted, strict=True):
        nearly(points, right_ones, 1e-15)


CHANGED = """[
  (view) => view,
  ({ origin, down }) => ({ origin: add(origin, scaled(down, 0.5)) }),
  ({ down }) => ({ down: scaled(down, 1.5) }),
  ({ down }) => ({ down: add(down, [0.1, 0, 0]) }),
  ({ light }) => ({ light: [...light.slice(0, 3), 1] }),
].map((change) => {
  const exposure = exposures(scene, 43.7)[0];
  const views = exposure.views.map((view) => ({ ...view, ...change(view) }));
  return pointsOf(cube, { ...exposure, views }, JUDGED).length;
})"""


def test_beams_spread_over_pixels_that_are_no_slices(evaluate: Evaluate) -> None:
    """Rows half a slice lower, or taller, or of a screen that leans, or lit by a point lamp."""
    modules = ("tools/vectors.js", "model/data.js", "model/stage.js", "model/area.js")
    assert evaluate(modules, GIVEN % CHANGED, held_in_a_page("level")[2]) == [16, 55, 55, 55, 55]


@pytest.mark.parametrize(
    ("parts", "finely", "in_rows"),
    [
        (2, over_square(21, 13), along_row(8)),
        (3, over_square(8, 5), along_row(6)),
        (4, over_square(5, 3), along_row(4)),
        (5, over_square(3, 2), along_row(4)),
    ],
)
@pytest.mark.parametrize("name", ["level", "raised, moved", "stage"])
def test_parts_of_pixels_are_plain_averages(
    evaluate: Evaluate, name: str, parts: int, finely: Points, in_rows: Points
) -> None:
    """Of no fewer than three beams each, and together of at least as many as a whole pixel."""
    _, packed, data = held_in_a_page(name)
    angles_deg = ANGLES[2:4]
    expression = """argument.angles_deg.flatMap((angle) => exposures(scene, angle)).map((exposure) =>
      castPicture(cube, exposure, pointsOf(cube, exposure, JUDGED, argument.parts), argument.parts))"""
    found = asked(evaluate, data, expression, angles_deg=angles_deg, parts=parts)
    wanted = averaged(packed.cube, angles_deg, in_rows if name == "level" else finely, parts=parts)
    assert len(found) == len(wanted)
    for each, picture in zip(found, wanted, strict=True):
        nearly(np.reshape(each, picture.shape), picture, 3e-6)


# how finely one sees it


ROOM = """(async () => {
  const { scene, voxels } = argument;
  const view = new RoomView(scene, await readVoxels(fromBase64(voxels), scene));
  const asked = [];
  const { cast } = view.renderer;
  view.renderer.cast = (exposures, beams, parts) => {
    asked.push([{ 1: "thin", 3: "quick", 55: "judged" }[beams.square], parts]);
    cast(exposures, beams, parts);
  };
  const look = { whole: false, thin: false };
  view.aim(0, look, false);
  const whole = { screen: 0, row: 3, column: 4 };
  const seen = () => (({ x, y }) => [x, y])(seenAt(view.camera(), middleOfPixel(view.room, whole)));
  const far = () => { const { eye } = view.camera(); return norm(sub(eye, middleOfPixel(view.room, whole))); };
  const found = %s;
  view.dispose();
  return found;
})()"""


def ask(evaluate: Evaluate, expression: str, cube: Any = None) -> Any:
    """Value of an expression over a `view` of a room, what its renderer was `asked` for, and the pixel `whole`."""
    modules = ("tools/vectors.js", "model/data.js", "room/camera.js", "room/roomview.js")
    return evaluate(modules, ROOM % expression, given(on_turntable("raised") if cube is None else cube))


def test_it_is_cast_finely_when_still_and_near(evaluate: Evaluate) -> None:
    """And not again while the eye moves; thin beams are one in each pixel, from wherever one looks."""
    steps = """[
      () => view.aim(0, look, true),
      () => view.aim(0, look, true),
      () => { view.zoom(4, whole); view.aim(0, look, false); },
      () => view.aim(0, look, true),
      () => view.aim(5, look, false),
      () => view.aim(5, { ...look, thin: true }, false),
      () => view.aim(5, { ...look, thin: true }, true),
      () => view.aim(5, look, false),
      () => { view.comeBack(); view.aim(5, look, true); },
    ].map((step) => { asked.length = 0; step(); return [...asked]; })"""
    assert ask(evaluate, steps) == [
        [["judged", 1]], [], [], [["judged", 4]], [["quick", 4]], [["thin", 1]], [], [["quick", 4]], [["judged", 1]],
    ]  # fmt: skip


# how one comes near


def test_coming_near_leads_to_the_pixel(evaluate: Evaluate) -> None:
    """It stays where it is seen, so many times as near, and on the way back too; farther, one looks at the middle."""
    steps = [(1.5, True), (2, True), (1.2, True), (1 / 1.2, False), (0.5, False), (1 / 1.5, False)]
    told = ask(
        evaluate,
        f"""{json.dumps(steps)}.map(([factor, to]) => {{
          view.zoom(factor, to ? whole : null);
          return [seen(), far()];
        }}).concat([[seen(), far()], (view.zoom(100, whole), [seen(), far()])])""",
    )
    places, away = (np.array([each[i] for each in told]) for i in (0, 1))
    nearly(places, np.broadcast_to(places[0], places.shape), 1e-9)
    nearly(away, away[-2] / np.array([1.5, 3, 3.6, 3, 1.5, 1, 1, 5]), 1e-9)
    expression = "[0.5, 1.9, 1 / 1.9, 2].map((factor) => { view.zoom(factor, whole); return view.orbit(); })"
    farther = ask(evaluate, expression)
    base = farther[-1]["target"]
    assert all(orbit["target"] == pytest.approx(base, abs=1e-9) for orbit in farther)


def test_with_no_pixel_one_comes_near_to_the_middle(evaluate: Evaluate) -> None:
    before, after = ask(evaluate, "[view.orbit(), (view.zoom(2, null), view.orbit())]", on_stage("penumbra"))
    assert after == before | {"distance": before["distance"] / 2}


#: A place where a mouse points at a pixel of a screen; nothing is drawn while it is looked for.
PLACE = """(() => {
  const canvas = document.querySelector("canvas.room");
  const { x, y, width, height } = canvas.getBoundingClientRect();
  for (let down = 0.4; down < 0.9; down += 0.02) {
    for (let across = 0.5; across < 0.95; across += 0.02) {
      const [clientX, clientY] = [x + across * width, y + down * height];
      canvas.dispatchEvent(new PointerEvent("pointermove", { pointerType: "mouse", clientX, clientY }));
      if (canvas.classList.contains("pointing")) return [clientX, clientY];
    }
  }
})()"""


@pytest.mark.parametrize("how", ["wheel", "keys"])
def test_the_pixel_that_is_pointed_at_stays_under_the_pointer(visit: Open, how: str) -> None:
    tab = visit(width=1280, height=800, details=True, reduced_motion="reduce")
    row_said = tab.locator(".scanline header .facts")
    place = tab.evaluate(PLACE)
    tab.mouse.move(*place)
    assert tab.locator("canvas.room.pointing").count() == 1
    rested(tab)
    before = row_said.inner_text(), tab.locator(".scanline > .facts").inner_text()
    for _ in range(6):
        if how == "wheel":
            tab.mouse.wheel(0, -200)
        else:
            tab.keyboard.press("+")
    rested(tab)
    tab.mouse.move(place[0] + 1, place[1])
    rested(tab)
    assert (row_said.inner_text(), tab.locator(".scanline > .facts").inner_text()) == before
    assert np.abs(shown(tab) - right(turning(), STOPS[0])[0]).max() <= 0.55  # whole pixels, though nearer
