"""The sheet of what will be asked for: crops are seen where they are, and every picture is named once."""

from dataclasses import replace

import numpy as np
import pytest

from lightcube.drawing.crops import wanted_sheet
from lightcube.drawing.sheet import BETWEEN
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.pictures.fitting import Fit, fit
from lightcube.pictures.pictures import Pictures

GRID = Grid((6, 6, 6), 1.0)
#: Where the first tile stands, and what lies between two.
GAP, TOP = 44, 73 + 36 + 2 * 44


def bright_where(x: float, y: float, shape: tuple[int, int] = (40, 90)) -> Pictures:
    """Pictures of one grey with a focus."""
    image = np.full((*shape, 3), 0.5, np.float32)
    return Pictures((image, image), ("a", "b"), focus=(x, y))


def sheet_of(pictures: Pictures, way: Fit, shape: tuple[int, int] = (6, 6)) -> np.ndarray:
    targets = fit(pictures, turntable(GRID, [0.0, 90.0], picture_shape=shape), way)
    return wanted_sheet(pictures, targets, way, [0, 1])


def lit(sheet: np.ndarray) -> tuple[int, int]:
    """First and last column of what is not dimmed of the first picture as it was read, which is 240 pixels wide."""
    row = sheet[TOP + 120, GAP : GAP + 240, 0].astype(int)
    bright = np.flatnonzero(row > row.max() - 8)
    return int(bright[0]), int(bright[-1]) + 1


@pytest.mark.parametrize("x", [0.0, 0.3, 0.5, 0.6, 1.0])
def test_what_is_cut_off_is_dark_and_follows_the_focus(x: float) -> None:
    """Of 90 x 40 pixels a square of 40 is left: 107 of 240 on paper."""
    first, last = lit(sheet_of(bright_where(x, 0.5), "crop"))
    assert last - first == pytest.approx(106.7, abs=1.5)
    assert first == pytest.approx(min(max(240 * x - 53.3, 0), 240 - 106.7), abs=1.5)


def test_nothing_is_dark_where_nothing_is_cut_off() -> None:
    for way in ("pad", "stretch"):
        assert lit(sheet_of(bright_where(0.1, 0.5), way)) == (0, 240)


def test_what_is_wanted_stands_beside_and_order_is_minded() -> None:
    dark, light = (np.full((6, 6, 3), value, np.float32) for value in (0.0, 1.0))
    pictures = Pictures((dark, light), ("dark", "light"))
    targets = fit(pictures, turntable(GRID, [0.0, 90.0], picture_shape=(6, 6)))
    turned = replace(targets, pictures=targets.pictures[::-1], names=targets.names[::-1])
    for wanted, order, levels in ((targets, [0, 1], [0, 255]), (turned, [1, 0], [255, 0])):
        sheet = wanted_sheet(pictures, wanted, "crop", order)
        for place, level in enumerate(levels):
            left = GAP + place * (2 * 240 + BETWEEN + GAP)
            assert [int(sheet[TOP + 120, left + more, 0]) for more in (120, 240 + BETWEEN + 120)] == [level, level]


def test_a_film_of_many_pictures_is_shown_in_part() -> None:
    image = np.full((6, 6, 3), 0.5, np.float32)
    pictures = Pictures((image,) * 70, tuple(map(str, range(70))))
    targets = fit(pictures, turntable(GRID, np.linspace(0, 359, 70), picture_shape=(6, 6)))
    sheet = wanted_sheet(pictures, targets, "crop", range(70))
    assert sheet.shape[0] * sheet.shape[1] < 40 * (240 + 130) * (486 + GAP)
