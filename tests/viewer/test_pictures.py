"""The pictures of the pages in the docs: taken here, and kept where ``LIGHTCUBE_PICTURES`` names a folder."""

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from lightcube import io
from lightcube.backward import solving
from lightcube.backward.mat import Mat
from lightcube.backward.recipe import Quality, Recipe
from lightcube.optics.cube import Cube
from lightcube.pictures.samples import photographs
from lightcube.planning.plan import plan
from lightcube.scoring import metrics
from lightcube.viewer.page import page
from tests.cli.test_cli import run
from tests.helpers.browser import opened
from tests.helpers.visiting import rested

__all__ = ["run"]

#: Voxels across, how well they are solved for, and pixels to a pixel of the page: those of the docs take minutes.
SIDE = 48 if "LIGHTCUBE_PICTURES" in os.environ else 16
QUALITY: Quality = "normal" if "LIGHTCUBE_PICTURES" in os.environ else "draft"
SHARP = 1.0 if "LIGHTCUBE_PICTURES" in os.environ else 0.5


@pytest.fixture(scope="module")
def cube() -> Cube:
    """Eight photographs in mats and held, as `lightcube solve` makes them."""
    planned = plan(photographs(8), SIDE, Recipe.of_quality(QUALITY, mat=Mat()), longest_hold=True, smooth=True)
    found = solving.solve(planned.targets, planned.grid, planned.recipe).cube
    return replace(found, scores=metrics.score(found, planned.targets))


def kept(picture: bytes, name: str, tmp_path: Path) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Write a screenshot where it is asked for, and return its levels."""
    path = Path(os.environ.get("LIGHTCUBE_PICTURES", tmp_path)) / name
    path.write_bytes(picture)
    image = Image.open(path).convert("RGB")
    image.save(path, optimize=True)
    return np.asarray(image)


@pytest.mark.parametrize(
    ("name", "width", "height", "scheme", "keys"),
    [
        ("page.png", 1200, 750, "dark", ["Home"]),  # so that it does not turn by itself
        ("page-phone.png", 390, 844, "light", ["Home"]),
        ("page-tour.png", 1200, 750, "light", ["g", *["ArrowRight"] * 6]),
    ],
)
def test_the_page_is_drawn(
    browser: Any, cube: Cube, tmp_path: Path, name: str, width: int, height: int, scheme: str, keys: list[str]
) -> None:
    io.save(page(cube, "photographs"), tmp_path / "photographs.html")
    tab, heard = opened(
        browser,
        tmp_path / "photographs.html",
        width=width,
        height=height,
        color_scheme=scheme,
        device_scale_factor=SHARP,
    )
    room = tab.locator("canvas.room")
    room.wait_for()
    for key in keys:
        tab.keyboard.press(key)
    tab.evaluate("document.querySelector('.hint').remove()")
    rested(tab)  # and is drawn sharply
    seen = kept(tab.screenshot(), name, tmp_path)
    box = {each: round(SHARP * size) for each, size in (room.bounding_box() or {}).items()}
    drawn = seen[box["y"] : box["y"] + box["height"], box["x"] : box["x"] + box["width"]]
    assert np.all(np.std(drawn.reshape(-1, 3), axis=0) > 20)
    assert len(np.unique(drawn.reshape(-1, 3), axis=0)) > 1000
    assert not heard
    tab.context.close()


@pytest.mark.usefixtures("large_rooms")
def test_the_report_is_drawn(run: Any, browser: Any, cube: Cube, tmp_path: Path) -> None:
    io.save(cube, tmp_path / "photographs.zarr")
    title = ("--title", "Eight photographs")
    assert run("report", tmp_path / "photographs.zarr", "-o", tmp_path / "report.html", *title).code == 0
    tab, heard = opened(browser, tmp_path / "report.html", width=1000, height=1330, device_scale_factor=SHARP)
    assert np.std(kept(tab.screenshot(), "report.png", tmp_path)) > 20
    assert not heard
    tab.context.close()


def test_the_sheet_is_drawn(run: Any, cube: Cube, tmp_path: Path) -> None:
    io.save(cube, tmp_path / "photographs.zarr")
    assert run("score", tmp_path / "photographs.zarr", "--sheet", tmp_path / "sheet.png").code == 0
    assert np.std(kept((tmp_path / "sheet.png").read_bytes(), "sheet.png", tmp_path)) > 20
