"""The page's cards: pictures shown are means over pixels, and what a pixel's beams pass is what the matrix says."""

import itertools
import re

import numpy as np
import pytest

from lightcube.optics.cube import Cube
from lightcube.optics.views import Views
from lightcube.viewer.packing import pack
from tests.helpers.areas import JUDGED, THIN, Points
from tests.helpers.plain import beam_of_pixel, lengths_of_beam
from tests.helpers.visiting import (
    COLUMNS,
    CUBES,
    GRID,
    ROWS,
    STOPS,
    Open,
    angle_deg,
    marked,
    pages,
    rested,
    right,
    shown,
    stands,
    turned_to,
    turning,
    visit,
)

__all__ = ["pages", "visit"]


def test_the_shown_picture_is_a_mean_over_pixels(visit: Open) -> None:
    tab, cube = visit(details=True), turning()
    for where in (10.0, 17.3, 130.0, 245.0):
        turned_to(tab, where)
        assert np.abs(shown(tab) - right(cube, where)[0]).max() <= 0.55
    tab.keyboard.press("w")
    assert np.abs(shown(tab) - right(cube, where, whole=True)[0]).max() <= 0.55
    tab.keyboard.press("w")
    assert np.abs(shown(tab) - right(cube, where)[0]).max() <= 0.55


def test_a_switch_shows_thin_beams(visit: Open) -> None:
    """By mouse and by key, in its place beside the others; what was shown comes back."""
    tab, cube = visit(details=True), turning()
    switch = tab.get_by_role("button", name="Thin beams")
    assert switch.get_attribute("aria-pressed") == "false"
    for turn_on, turn_off in (
        (switch.click, lambda: tab.keyboard.press("b")),
        (lambda: tab.keyboard.press("b"), switch.click),
    ):
        turn_on()
        assert np.abs(shown(tab) - right(cube, STOPS[0], thin=True)[0]).max() <= 0.55
        assert switch.get_attribute("aria-pressed") == "true"
        assert tab.locator(".compare figcaption").all_inner_texts() == ["wanted", "shown, thin beams"]
        assert "dB" not in tab.locator(".compare .facts").inner_text()  # a score is of all light
        turn_off()
        assert np.abs(shown(tab) - right(cube, STOPS[0])[0]).max() <= 0.55
        assert switch.get_attribute("aria-pressed") == "false"
        assert tab.locator(".compare figcaption").all_inner_texts() == ["wanted", "shown"]
        assert "dB" in tab.locator(".compare .facts").inner_text()
    assert np.abs(right(cube, STOPS[0]) - right(cube, STOPS[0], thin=True)).max() > 10


def test_a_stage_has_a_tab_for_every_screen(visit: Open) -> None:
    tab, cube = visit("stage", details=True), CUBES["stage"]()
    assert tab.locator(".tabs button").all_inner_texts() == ["wall", "floor"]
    assert marked(tab) == ["1"]
    assert not tab.get_by_role("button", name="Whole shadow").is_visible()
    pictures = right(cube, 0.0)
    for number, name in enumerate(("wall", "floor")):
        tab.get_by_role("button", name=name, exact=True).click()
        found = shown(tab)
        rows, columns = found.shape[:2]
        assert np.abs(found - pictures[number, :rows, :columns]).max() <= 0.55
        assert marked(tab) == [("1", "4")[number]]
    assert tab.locator(".lamps th").all_inner_texts() == ["sun"]


def test_the_film_strip_finds_a_picture_on_its_screen(visit: Open) -> None:
    tab, cube = visit("stage", details=True), CUBES["stage"]()
    for number in (4, 1, 3):  # wall and floor at each of three stops
        tab.get_by_role("button", name=re.compile(f"^{number + 1}, ")).click()
        stands(tab, float(cube.angles_deg[number]))
        assert marked(tab) == [str(number + 1)]
        screen = int(cube.rig.stops.screen[number])
        assert tab.locator(".tabs [aria-pressed=true]").inner_text() == ("wall", "floor")[screen]
        rows, columns = shown(tab).shape[:2]
        pictures = right(cube, float(cube.angles_deg[number]))
        assert np.abs(shown(tab) - pictures[screen, :rows, :columns]).max() <= 0.55


def test_the_whole_shadow_has_a_line_around_the_picture(visit: Open) -> None:
    tab, cube = visit(details=True), turning()
    tab.keyboard.press("w")
    whole = shown(tab)
    box, frame = (tab.locator(each).bounding_box() for each in (".choose canvas", ".choose .frame"))
    scale = box["width"] / whole.shape[1]
    top, left = round((frame["y"] - box["y"]) / scale), round((frame["x"] - box["x"]) / scale)
    framed = whole[top : top + ROWS, left : left + COLUMNS]
    assert np.abs(framed - right(cube, STOPS[0])[0]).max() <= 0.55


def passed(cube: Cube, views: Views, row: int, column: int, points: Points) -> tuple[int, np.ndarray]:
    """How many voxels the beams through points of a pixel meet, and the part of the light that is left on average."""
    met, left = np.zeros(GRID.shape, bool), np.zeros(3)
    for across, down in points:
        lengths = lengths_of_beam(GRID, *beam_of_pixel(views, 0, row + down, column + across))
        met |= lengths > 1e-9
        left += np.exp(-np.einsum("zyx,czyx->c", lengths, cube.extinction)) / len(points)
    return int(np.count_nonzero(met)), left


def test_a_pixel_says_what_its_light_passes(visit: Open) -> None:
    tab, cube = visit(width=1440, height=900, details=True), turning()
    packed = pack(cube).cube
    tab.locator(".choose canvas").scroll_into_view_if_needed()
    box = tab.locator(".choose canvas").bounding_box()
    for thin, where in itertools.product((False, True), STOPS[:2]):
        turned_to(tab, where)
        if tab.get_by_role("button", name="Thin beams").get_attribute("aria-pressed") != str(thin).lower():
            tab.keyboard.press("b")
        views = cube.rig.views.take([STOPS.index(where)])
        for row, column in [(0, 0), (5, 2), (7, 9)]:
            tab.mouse.move(
                box["x"] + (column + 0.5) / COLUMNS * box["width"], box["y"] + (row + 0.5) / ROWS * box["height"]
            )
            rested(tab)
            count, left = passed(packed, views, row, column, THIN if thin else JUDGED)
            said = tab.locator(".scanline > .facts").inner_text()
            numbers = [float(each) for each in re.findall(r"[\d.]+(?=[ ;])", said)]
            assert ("on average" in said) is not thin
            assert numbers[:2] == [column + 1, count]
            assert numbers[2:] == pytest.approx(100 * left, abs=0.51)
            assert tab.locator(".scanline header .facts").inner_text() == f"row {row + 1} of {ROWS}"


def test_the_keys_choose_a_row(visit: Open) -> None:
    tab = visit(details=True)
    chooser = tab.get_by_role("slider", name="Row of the shown picture")
    chooser.focus()
    for key, said in [("ArrowDown", "row 6 of 8"), ("ArrowUp", "row 5 of 8"), ("ArrowRight", "row 5 of 8, column 7")]:
        tab.keyboard.press(key)
        rested(tab)
        assert chooser.get_attribute("aria-valuetext") == said
    assert angle_deg(tab) == STOPS[0]
    assert "The light of pixel 7 passes" in tab.locator(".scanline > .facts").inner_text()


def test_pointing_at_the_slice_chooses_a_beam(visit: Open) -> None:
    """From above the light goes to the right and the picture's left is up."""
    tab = visit(details=True)
    tab.locator("canvas.slice").scroll_into_view_if_needed()
    box = tab.locator("canvas.slice").bounding_box()
    said = []
    for part in (0.45, 0.55):
        tab.mouse.move(box["x"] + box["width"] / 2, box["y"] + part * box["height"])
        rested(tab)
        said.append(int(re.findall(r"pixel (\d+)", tab.locator(".scanline > .facts").inner_text())[0]))
    assert said[0] <= COLUMNS / 2 < said[1]
