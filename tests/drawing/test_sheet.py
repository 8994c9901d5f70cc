"""Contact sheets: every picture beside what was wanted, exactly, in even tiles, with words that stay in their place."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from lightcube.drawing.sheet import MOST, contact_sheet, difference, pair
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import to_uint8
from lightcube.optics.views import spread_angles
from lightcube.pictures.targets import Targets

Levels = NDArray[np.uint8]


def wanted(count: int, rows: int = 3, columns: int = 5, names: tuple[str, ...] = ()) -> Targets:
    grid = Grid((rows, columns, columns), 0.5)
    rig = turntable(grid, spread_angles(count), picture_shape=(rows, columns))
    light = np.random.default_rng(count).random((count, rows, columns, 3)).astype(np.float32)
    return Targets(light, rig, None, names)


def shown(targets: Targets) -> NDArray[np.float32]:
    return np.random.default_rng(99).random(targets.pictures.shape).astype(np.float32)


def box_of(sheet: Levels, picture: Levels) -> tuple[int, int, int]:
    """Top and left of a picture on a sheet, and how many times as large it is: there it is, pixel by pixel."""
    there = np.argwhere(np.all(sheet == picture[0, 0], axis=-1))
    (top, left), (bottom, _) = there.min(axis=0), there.max(axis=0)
    zoom = int(bottom - top + 1)
    large = picture.repeat(zoom, axis=0).repeat(zoom, axis=1)
    np.testing.assert_array_equal(sheet[top : top + len(large), left : left + large.shape[1]], large)
    return int(top), int(left), zoom


def test_every_picture_stands_beside_what_was_wanted_in_even_tiles() -> None:
    targets = wanted(7)
    cast = shown(targets)
    sheet = contact_sheet(cast, targets, [30.0] * 7, "a title")
    places = [
        (box_of(sheet, to_uint8(targets.pictures[view])), box_of(sheet, to_uint8(cast[view]))) for view in range(7)
    ]
    steps = {(right[0] - left[0], right[1] - left[1], left[2], right[2]) for left, right in places}
    assert steps == {(0, 5 * 48 + 6, 48, 48)}
    lines = sorted({left[0] for left, _ in places})
    across = sorted({left[1] for left, _ in places})
    assert len(set(np.diff(lines))) == len(set(np.diff(across))) == 1
    assert [left[:2] for left, _ in places] == [(top, side) for top in lines for side in across][:7]


def test_smaller_pictures_have_tiles_as_large() -> None:
    targets = wanted(4)
    window = np.array([[3, 5], [2, 5], [3, 1], [3, 5]])
    rig = replace(targets.rig, stops=replace(targets.rig.stops, window=window))
    targets, cast = replace(targets, rig=rig), shown(targets)
    sheet = contact_sheet(cast, targets, [30.0] * 4)
    tiles = [
        box_of(sheet, to_uint8(cast[view])[:rows, :columns]) for view, (rows, columns) in enumerate(window.tolist())
    ]
    assert [zoom for _, _, zoom in tiles] == [48, 48, 48, 48]
    assert [top - tiles[0][0] for top, _, _ in tiles[:2]] == [0, 24]  # in the middle of its tile
    assert sheet.shape == contact_sheet(cast, wanted(4), [30.0] * 4).shape


@pytest.mark.parametrize(("rows", "columns", "zoom"), [(200, 300, 1), (60, 40, 4), (500, 800, None)])
def test_small_pictures_grow_by_whole_pixels_and_large_ones_shrink(rows: int, columns: int, zoom: int | None) -> None:
    targets = wanted(1, rows, columns)
    colours = np.array([[0.1, 0.6, 0.3], [0.6, 0.1, 0.9]], np.float32)  # not those of any letter's edge
    flat = replace(targets, pictures=np.broadcast_to(colours[0], targets.pictures.shape))
    sheet = contact_sheet(np.broadcast_to(colours[1], targets.pictures.shape), flat, [30.0])
    for colour in colours:
        high, wide = np.ptp(np.argwhere(np.all(sheet == to_uint8(colour), axis=-1)), axis=0) + 1
        assert (high, wide) == ((rows * zoom, columns * zoom) if zoom else (250, 400))


def test_words_stay_in_their_tile() -> None:
    plain = contact_sheet(shown(wanted(4)), wanted(4, names=("a", "a", "a", "a")), [30.0] * 4, "t")
    names = ("a", "a much too long name\n\x07 " * 20, "a", "a")
    named = contact_sheet(shown(wanted(4)), wanted(4, names=names), [30.0] * 4, "t")
    assert named.shape == plain.shape
    columns = np.flatnonzero(np.any(named != plain, axis=(0, 2)))
    left = box_of(plain, to_uint8(wanted(4).pictures[1]))[1]
    assert left <= columns.min()
    assert columns.max() < left + 2 * 5 * 48 + 6
    titled = contact_sheet(shown(wanted(4)), wanted(4, names=names), [30.0] * 4, "title " * 2000)
    assert titled.shape == plain.shape
    assert np.all(titled[:, -44:] == titled[0, 0])


@pytest.mark.parametrize("count", [2, 5, 16, 31, 50])
def test_a_sheet_has_about_the_shape_of_paper(count: int) -> None:
    targets = wanted(count, 4, 4)
    cast = shown(targets)
    sheet = contact_sheet(cast, targets, [1.0] * count)
    assert 0.9 < sheet.shape[1] / sheet.shape[0] < 2.4
    drawn = np.unique(np.linspace(0, count - 1, min(count, MOST)).round().astype(int))
    codes, on_it = np.array([1 << 16, 1 << 8, 1]), np.zeros(1 << 24, bool)
    on_it[sheet @ codes] = True
    for view in range(count):
        assert on_it[to_uint8(cast[view])[0, 0] @ codes] == (view in drawn)


def test_differences_are_drawn_so_many_times_as_large_around_grey() -> None:
    targets = wanted(2)
    weights = np.ones(targets.pictures.shape[:3], np.float32)
    weights[1, 0, 2] = 0
    targets = replace(targets, weights=weights)
    cast = np.clip(targets.pictures[1] + np.float32(0.02), 0, 1)
    before, after = (each.astype(int) for each in pair(cast, targets, 1))
    once, often = (difference(cast, targets, 1, gain).astype(int) for gain in (1, 8))
    assert np.all(often[0, 2] == 128)
    wide = np.abs(often - 127.5) < 120
    assert np.all(np.abs((often - 127.5) - 8 * (after - before))[wide] <= 9)
    assert np.any(often > 140)
    assert np.all(np.abs((once - 127.5) - (after - before)) <= 2)
