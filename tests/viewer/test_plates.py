"""Reliefs on the page: the same light as the package's, and the lamp in one's hands."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lightcube as lc
from lightcube.drawing.relief_sheet import as_seen, relief_preview
from lightcube.optics.transfer import to_uint8
from lightcube.solids.relief import Relief, ReliefRecipe
from lightcube.solids.relief_light import relief_shadow, shown
from lightcube.viewer.page import page
from lightcube.viewer.plate import describe_relief, heights_data
from tests.helpers.browser import opened
from tests.helpers.paging import Evaluate
from tests.helpers.visiting import CUBE, angle_deg, drag, marked, rested, stands, turned_to, until

LAW = ("model/relief.js",)
NAMES = ("IMG_2023_ash", "IMG_2023_birch", "IMG_2023_cedar")


def plate(*, cell: int = 1, is_colour: bool = False) -> Relief:
    """A rough plate of no use, higher than wide, with three pictures of noise."""
    random = np.random.default_rng(5)
    heights = random.uniform(0, 6, (13 * cell, 11 * cell + (cell > 1)))
    wanted = random.uniform(0.2, 1, (3, 13, 11))
    recipe = ReliefRecipe(black=0.5, elevation_deg=40.0, frame_mm=3.0, bounce=0.15)
    names = ("sky red", "sky green", "sky blue") if is_colour else NAMES
    return Relief(heights, wanted, recipe, names, is_colour, cell=cell)


def asked(evaluate: Evaluate, relief: Relief, expression: str, **argument: Any) -> np.ndarray:
    """The value of an expression over a page's scene and heights."""
    given = {"scene": describe_relief(relief, "a plate"), "heights": relief.heights_px.ravel().tolist(), **argument}
    text = f"((scene, heights) => [...{expression}])(argument.scene, Float64Array.from(argument.heights))"
    return np.array(evaluate(LAW, text, given))


@pytest.mark.parametrize("cell", [1, 3])
@pytest.mark.parametrize(("azimuth", "elevation"), [(0, 40), (90, 37), (180, 43), (270, 40), (33.3, 40), (287.2, 55.5)])
def test_the_page_casts_the_same_light(evaluate: Evaluate, cell: int, azimuth: float, elevation: float) -> None:
    relief = plate(cell=cell)
    text = "pixelsLit(scene, columnsLit(scene, heights, argument.azimuth, argument.elevation))"
    light = asked(evaluate, relief, text, azimuth=azimuth, elevation=elevation)
    np.testing.assert_allclose(light, relief_shadow(relief, azimuth, elevation).ravel(), rtol=0, atol=1e-12)
    assert 0.1 < light.mean() < 0.9


@pytest.mark.parametrize("cell", [1, 3])
def test_the_page_sees_the_same_pictures(evaluate: Evaluate, cell: int) -> None:
    relief = plate(cell=cell)
    wanted = to_uint8(as_seen(relief, shown(relief)))
    for number, azimuth in enumerate(relief.azimuths_deg):
        light = "pixelsLit(scene, columnsLit(scene, heights, argument.azimuth, scene.elevation_deg))"
        text = f"levelsOf([blurred(scene, {light}, scene.blurs.near)])"
        levels = asked(evaluate, relief, text, azimuth=azimuth).reshape(13, 11, 4)
        assert np.all(levels[..., 3] == 255)
        assert np.abs(levels[..., :3] - wanted[number].astype(float)).max() <= 1  # rounding
        assert np.ptp(levels[..., 0]) > 10


def test_coloured_lamps_go_round_together(evaluate: Evaluate) -> None:
    relief = plate(is_colour=True)
    text = """lampsOf(scene, 30).flatMap(({ azimuth, colour }) => [azimuth, ...colour])"""
    assert asked(evaluate, relief, text).reshape(3, 4).tolist() == [[30, 1, 0, 0], [210, 0, 1, 0], [120, 0, 0, 1]]
    assert [each["name"] for each in describe_relief(relief, "a")["pictures"]] == ["sky"]


def test_heights_that_are_cut_off_are_refused(evaluate: Evaluate) -> None:
    relief = plate()
    text = """(() => { try { heightsOf(new Uint8Array(8), argument); } catch (error) { return error.message; } })()"""
    said = evaluate(LAW, text, describe_relief(relief, "a"))
    assert "8 bytes, not those of 11 x 13 columns" in said
    assert len(heights_data(relief)) > 1000


@pytest.fixture(scope="module")
def places(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("plates")
    for name, relief in {"grey": plate(), "colour": plate(is_colour=True)}.items():
        (folder / f"{name}.html").write_text(lc.page(relief, lc.Label("a plate", by="Ada")), encoding="utf-8")
    return {name: folder / f"{name}.html" for name in ("grey", "colour")}


@pytest.fixture
def visit(bare_browser: Any, places: dict[str, Path]) -> Iterator[Any]:
    """Opens a page in a browser without WebGL."""
    tabs = []

    def go(name: str = "grey") -> Any:
        tab, heard = opened(bare_browser, places[name], width=920, height=480, device_scale_factor=0.5)
        tabs.append((tab, heard))
        until(tab, CUBE)
        rested(tab)
        tab.evaluate("document.getElementById('lightcube').dispatchEvent(new PointerEvent('pointerdown'))")
        return tab

    yield go
    for tab, heard in tabs:
        assert heard == []
        tab.context.close()


def from_above(tab: Any) -> np.ndarray:
    """The picture that the page shows large, levels of one colour."""
    rested(tab)
    levels = tab.evaluate(f"[...{CUBE}.light()]")
    assert tab.locator(".wall canvas").evaluate("(canvas) => [canvas.width, canvas.height]") == [11, 13]
    return np.array(levels, float).reshape(13, 11, 4)[..., :3]


def test_a_picture_stands_where_its_lamp_is(visit: Any) -> None:
    tab, relief = visit(), plate()
    assert marked(tab) == ["…ash"]
    wanted = to_uint8(as_seen(relief, shown(relief))).astype(float)
    for number, (name, where) in enumerate(zip(("…birch", "…cedar", "…ash"), (180, 90, 0), strict=True)):
        tab.get_by_role("button", name=f"{NAMES[(1, 2, 0)[number]]},").click()
        stands(tab, where)
        assert marked(tab) == [name]
        assert np.abs(from_above(tab) - wanted[(1, 2, 0)[number]]).max() <= 1
    assert tab.locator(".wall .name").inner_text() == NAMES[0]


def test_keys_and_hands_move_the_lamp(visit: Any) -> None:
    tab = visit()
    tab.keyboard.press("PageDown")
    stands(tab, 90)
    tab.keyboard.press("ArrowRight")
    rested(tab)
    assert angle_deg(tab) == pytest.approx(91)
    assert tab.locator(".wall .name").inner_text() == "between two pictures"
    snap = tab.get_by_role("button", name="Snap")
    snap.click()
    snap.click()
    stands(tab, 90)
    snap.click()
    drag(tab, 40)
    rested(tab)
    assert angle_deg(tab) == pytest.approx(110, abs=2)
    tab.keyboard.press("Home")
    stands(tab, 0)
    tab.get_by_role("button", name="Play").click()
    until(tab, f"{CUBE}.angle > 2")


def test_a_lamp_that_stands_wrong_shows_it(visit: Any) -> None:
    tab, relief = visit(), plate()
    right = from_above(tab)
    tab.locator("canvas.room").focus()
    for _ in range(5):
        tab.keyboard.press("ArrowUp")
    higher = from_above(tab)
    assert "45° high" in tab.locator(".lift").inner_text()
    assert tab.locator(".wall .quality").inner_text() == ""
    wanted = to_uint8(as_seen(relief, shown(relief, (0.0, 5.0))))[0]
    assert np.abs(higher - wanted).max() <= 1
    assert np.abs(higher - right).max() > 5
    tab.get_by_role("button", name="Lower").click()
    rested(tab)
    assert "44° high" in tab.locator(".lift").inner_text()


def test_columns_can_be_seen_one_by_one(visit: Any) -> None:
    tab, relief = visit(), plate()
    tab.get_by_label("From how far one looks").select_option("columns")
    wanted = to_uint8(np.repeat(relief_shadow(relief, 0.0)[..., None], 3, axis=2))
    assert np.abs(from_above(tab) - wanted).max() <= 1


def test_three_lamps_make_one_picture_in_colour(visit: Any) -> None:
    tab, relief = visit("colour"), plate(is_colour=True)
    assert marked(tab) == ["sky"]
    turned_to(tab, 77.0)
    wanted = to_uint8(as_seen(relief, shown(relief, (77.0, 0.0))))[0]
    assert np.abs(from_above(tab) - wanted).max() <= 1
    assert np.ptp(from_above(tab), axis=2).max() > 20


def test_the_plate_on_the_table_follows_the_lamp_and_the_theme(visit: Any) -> None:
    tab, seen = visit(), []
    for where in (0.0, 200.0):
        turned_to(tab, where)
        seen.append(tab.locator("canvas.room").screenshot())
    tab.keyboard.press("t")
    rested(tab)
    seen.append(tab.locator("canvas.room").screenshot())
    assert len(set(seen)) == 3


def test_words_are_of_a_plate(visit: Any) -> None:
    tab = visit()
    tab.keyboard.press("d")
    tab.keyboard.press("?")
    rested(tab)
    said = tab.locator("#lightcube").inner_text()
    assert "by Ada" in said
    assert "11 × 13 columns" in said
    assert "wanted" in said
    for word in ("cube", "glass", "voxel", "shape", "scan-line"):
        assert word not in said.lower(), word


def test_what_is_shared_is_told(places: dict[str, Path]) -> None:
    assert f"its shadows are pictures: {', '.join(NAMES)}" in places["grey"].read_text(encoding="utf-8")
    picture = relief_preview(plate())
    assert picture.shape == (630, 1200, 3)
    alone = replace(plate(), wanted=plate().wanted[:1], names=("one",))
    assert np.any(relief_preview(alone) != picture)


def test_one_page_is_the_same_as_another(places: dict[str, Path]) -> None:
    assert page(plate(), lc.Label("a plate", by="Ada")) == places["grey"].read_text(encoding="utf-8")
