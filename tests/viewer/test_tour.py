"""The tour: each step shows what its words say, its figures are true, and the arrow keys lead through it."""

import json
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lightcube.forward.turning import powers_of
from lightcube.optics.cube import Cube
from lightcube.optics.transfer import encode
from lightcube.viewer.packing import pack
from tests.helpers.areas import JUDGED, judged
from tests.helpers.paging import CUBES, Evaluate
from tests.helpers.plain import beam_of_pixel, lengths_of_beam
from tests.helpers.visiting import PHONE, STOPS, Open, angle_deg, pages, rested, right, stands, turning, until, visit
from tests.viewer.test_first import on_the_wall
from tests.viewer.test_shadows import given

__all__ = ["pages", "visit"]

MODULES = ("model/data.js", "model/lesson.js")
LESSON = """(async () => {
  const cube = await readVoxels(fromBase64(argument.voxels), argument.scene);
  return lessonOf(argument.scene, cube);
})()"""
Box = list[list[int]]


def filled(cube: Cube, box: Box) -> Cube:
    """Clear outside of a box, first voxels (x, y, z) and the ones after the last."""
    kept = np.zeros_like(cube.extinction)
    inside = (slice(None), *(slice(low, high) for low, high in reversed(list(zip(*box, strict=True)))))
    kept[inside] = cube.extinction[inside]
    return replace(cube, extinction=kept)


def level(light: NDArray[Any]) -> NDArray[Any]:
    return 255 * encode(np.clip(light, 0, 1), "srgb")


def walk(tab: Any, *keys: str) -> str:
    """Press keys and wait; returns the title of the step that is shown."""
    for key in keys:
        tab.keyboard.press(key)
    rested(tab)
    return tab.locator(".tour h2").inner_text()


def test_the_arrows_lead_from_the_dark_to_the_whole(visit: Open, evaluate: Evaluate) -> None:
    tab, cube = visit(width=1280, height=800, reduced_motion="reduce"), turning()
    steps = evaluate(MODULES, LESSON, given(cube))
    assert not tab.locator(".tour").is_visible()
    assert walk(tab, "g") == "The lamp is off"
    assert not tab.locator(".controls").is_visible()
    assert on_the_wall(tab).max() == 0
    titles = ["The lamp is off"]
    while len(titles) < len(steps):
        titles.append(walk(tab, ("ArrowRight", "PageDown", "Space")[len(titles) % 3]))
        step = steps[len(titles) - 1]
        assert step["text"] == tab.locator(".tour p").inner_text()
        assert tab.locator(".place").inner_text() == f"{len(titles)} of {len(steps)}"
        assert angle_deg(tab) == pytest.approx(step["angle"])
        if titles[-1] == "A few voxels":
            white = replace(filled(pack(cube).cube, step["box"]), lamp_powers=np.ones_like(cube.lamp_powers))
            wanted = level(judged(white, [step["angle"]])[0])
            assert wanted.min() < 250
        else:
            wanted = right(cube, step["angle"])[0]
        assert np.abs(on_the_wall(tab) - wanted).max() <= 0.55
    assert titles == [step["title"] for step in steps]
    assert "One picture wants it clear" in titles
    assert walk(tab, "ArrowRight") == titles[-1]
    assert walk(tab, "ArrowLeft", "PageUp") == titles[-3]


def test_escape_gives_the_keys_back_to_the_cube(visit: Open) -> None:
    tab = visit(width=1280, height=800, reduced_motion="reduce")
    before = on_the_wall(tab)
    walk(tab, "g", "ArrowRight", "ArrowRight")
    assert np.abs(on_the_wall(tab) - before).max() > 50
    assert tab.locator(".wall .name").inner_text() == ""
    tab.keyboard.press("Escape")
    rested(tab)
    assert not tab.locator(".tour").is_visible()
    assert tab.locator(".controls").is_visible()
    assert np.array_equal(on_the_wall(tab), before)
    assert tab.locator(".wall .name").inner_text() == "astronaut"
    tab.keyboard.press("ArrowRight")
    stands(tab, STOPS[0] + 1)


def test_its_buttons_do_the_same(visit: Open) -> None:
    tab = visit(width=1280, height=800, reduced_motion="reduce")
    button = tab.get_by_role("button", name="Tour", exact=True)
    button.click()
    rested(tab)
    assert button.get_attribute("aria-pressed") == "true"
    assert tab.get_by_role("button", name="Previous step").is_disabled()
    tab.get_by_role("button", name="Next step").click()
    assert walk(tab) == "The lamp is on"
    tab.get_by_role("button", name="End of the tour").click()
    rested(tab)
    assert button.get_attribute("aria-pressed") == "false"


def test_who_starts_it_at_once_is_not_turned_away(visit: Open) -> None:
    """By the key, with the focus anywhere: the page no longer turns by itself."""
    tab = visit(width=640, height=400, untouched=True)
    tab.evaluate("document.activeElement.blur()")
    assert walk(tab, "g", "ArrowRight") == "The lamp is on"
    tab.wait_for_timeout(5000)
    assert angle_deg(tab) == STOPS[0]


def test_at_the_end_the_table_turns(visit: Open) -> None:
    tab = visit(width=640, height=400)
    tab.keyboard.press("g")
    for _ in range(8):
        tab.keyboard.press("ArrowRight")
    until(tab, "document.querySelector('.tour h2').textContent === 'All together'")
    where = angle_deg(tab)
    until(tab, f"Math.abs(document.getElementById('lightcube').lightcube.angle - {where}) > 3")
    tab.keyboard.press("Escape")
    rested(tab)


def test_its_figures_are_those_of_the_light(evaluate: Evaluate) -> None:
    cube = replace(turning(), extinction=0.2 * turning().extinction)
    packed = pack(cube).cube
    steps = {step["title"]: step for step in evaluate(MODULES, LESSON, given(cube))}
    light = {stop: judged(packed, [stop])[0] for stop in STOPS}
    for title, way in (("One picture wants it clear", 1), ("Another wants it dark", -1)):
        step, mark = steps[title], steps[title]["mark"]
        (percent,) = re.findall(r"(\d+) %", step["text"])
        shown = light[step["angle"]][mark["row"], mark["column"]].mean()
        assert float(percent) == pytest.approx(100 * shown, abs=0.51)
        assert way * (shown - np.median(list(light.values()))) > 0
        views, (low, high) = cube.rig.views.take([STOPS.index(step["angle"])]), mark["frame"]
        lengths = [
            lengths_of_beam(cube.grid, *beam_of_pixel(views, 0, mark["row"] + down, mark["column"] + across))
            for across, down in JUDGED
        ]
        assert max(each[low[2] : high[2], low[1] : high[1], low[0] : high[0]].sum() for each in lengths) > 0
    step, mark = steps["One beam"], steps["One beam"]["mark"]
    views = cube.rig.views.take([STOPS.index(step["angle"])])
    through = [
        lengths_of_beam(cube.grid, *beam_of_pixel(views, 0, mark["row"] + down, mark["column"] + across))
        for across, down in JUDGED
    ]
    met = np.mean([np.count_nonzero(each > 1e-9) for each in through])
    left = np.mean([np.exp(-np.einsum("zyx,czyx->c", each, packed.extinction)) for each in through], axis=0)
    numbers = [float(each) for each in re.findall(r"\d+", step["text"])]
    assert numbers == pytest.approx([met, *(100 * left)], abs=0.51)


def test_a_row_of_level_light_is_one_layer_of_glass(evaluate: Evaluate) -> None:
    """That layer alone casts the row as the whole block does, and nothing on the others."""
    cube = CUBES["level"]
    (row,) = [step for step in evaluate(MODULES, LESSON, given(cube)) if step["title"] == "One row"]
    whole, layer = (judged(each, [row["angle"]])[0] for each in (cube, filled(cube, row["box"])))
    number = row["mark"]["row"]
    np.testing.assert_allclose(layer[number], whole[number], rtol=1e-5)
    power = powers_of(cube, cube.rig.at([row["angle"]])[0])[0]
    others = np.delete(layer, number, axis=0)
    np.testing.assert_allclose(others, np.broadcast_to(power, others.shape), rtol=1e-5)


@pytest.mark.parametrize("name", sorted(CUBES))
def test_every_cube_has_its_tour(evaluate: Evaluate, name: str) -> None:
    cube, data = CUBES[name], given(CUBES[name])
    steps = evaluate(MODULES, LESSON, data)
    titles = [step["title"] for step in steps]
    assert titles[:2] == ["The lamp is off", "The lamp is on"]
    assert titles[-1] == "All together"
    assert len(titles) == (9 if len(data["scene"]["pictures"]) > 1 else 7)
    assert "NaN" not in json.dumps(steps)
    for step in steps:
        mark = step["mark"]
        if mark and mark["row"] is not None:
            rows, columns = cube.rig.views.picture_shape
            assert 0 <= mark["row"] < rows
            assert mark["column"] is None or 0 <= mark["column"] < columns


def test_what_is_filled_is_a_box(evaluate: Evaluate) -> None:
    box = [[1, 2, 0], [5, 4, 2]]
    both = LESSON.replace(
        "lessonOf(argument.scene, cube)", "[cube, partOf(cube, argument.box)].map(({ codes }) => [...codes])"
    )
    codes = evaluate(MODULES, both, {**given(CUBES["raised"]), "box": box})
    whole, part = (np.array(each).reshape(3, 5, 7, 3) for each in codes)
    wanted = np.zeros_like(whole)
    wanted[0:2, 2:4, 1:5] = whole[0:2, 2:4, 1:5]
    assert np.array_equal(part, wanted)


def test_larger_type_for_a_projector(visit: Open) -> None:
    tab = visit(width=1280, height=800, reduced_motion="reduce")
    walk(tab, "g")
    box = [tab.locator(each).bounding_box()["height"] for each in (".tour h2", "header .tools")]
    assert box[0] > 30
    walk(tab, "a")
    larger = [tab.locator(each).bounding_box()["height"] for each in (".tour h2", "header .tools")]
    assert np.divide(larger, box) == pytest.approx(1.4, abs=0.05)
    assert tab.evaluate("document.documentElement.scrollWidth") <= 1280


@pytest.mark.parametrize("size", [PHONE, {**PHONE, "width": 844, "height": 390}])
def test_on_a_phone_icons_have_words(visit: Open, size: dict[str, Any]) -> None:
    tab = visit(**size)
    for button in tab.locator(".tools button, .choices button:visible").all():
        words, box = button.locator("span").bounding_box(), button.bounding_box()
        assert words["width"] > 10
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= size["width"]
        assert box["x"] - 1 <= words["x"]
        assert words["x"] + words["width"] <= box["x"] + box["width"] + 1
    tab.keyboard.press("g")
    rested(tab)
    for part in (".tour", ".wall canvas"):
        box = tab.locator(part).bounding_box()
        assert box["y"] + box["height"] <= size["height"] + 1
        assert box["height"] > 40
