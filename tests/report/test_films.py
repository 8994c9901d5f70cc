"""The report of a stack: its films one by one, ghosts, what it costs to be off, and no word of a turntable."""

import base64
import html
import re
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

import lightcube as lc
from lightcube.optics.cube import Cube
from lightcube.optics.disturbance import FILMS_OFF
from lightcube.optics.ghosts import ghosts
from lightcube.optics.transfer import to_uint8
from lightcube.pictures.fitting import targets_of
from lightcube.report import measuring
from lightcube.report.films import films
from lightcube.report.measuring import measure
from lightcube.report.opening import Heading
from lightcube.report.page import Command, page
from tests.helpers.films import stack_of


def stack_cube() -> Cube:
    """Three films of noise, each denser than the one before."""
    stage = lc.attenuator(["one", "two"], lc.Films(count=3, gap_mm=12, pixels=4, size_mm=60))
    random, rig = np.random.default_rng(1), stage.rig()
    extinction = random.uniform(0, 0.1, (3, *stage.grid.shape)) * np.array([1, 2, 3])[:, None, None]
    wanted = random.integers(1, 65536, (2, *rig.picture_shape, 4), np.uint16)
    return Cube(extinction.astype(np.float32), stack_of(stage), rig, targets=wanted, names=("one", "two"))


@pytest.fixture
def text(monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setattr(measuring, "ROOM", (27, 48))
    cube = stack_cube()
    return page(measure(cube, targets_of(cube)), Heading("films", by="Ada"), "Compared.", Command(), [])


def test_a_report_of_films_speaks_of_films(text: str) -> None:
    said = html.unescape(re.sub(r"<style>.*?</style>|<[^>]*>", " ", text, flags=re.DOTALL))
    for word in ("Stack of films", "under lamp 1", "How the films are put together", "Ghosts", "on the paper", "relit"):
        assert word in said
    for word in ("voxel", "turntable", "the table at", "Hold", "block of coloured glass", "Nothing turns"):
        assert word not in said
    assert all(str(off) in said for off in FILMS_OFF.values())


def test_each_film_is_shown_as_it_is_printed() -> None:
    cube = stack_cube()
    shown = films(cube)
    pictures = re.findall(r'src="data:image/png;base64,([^"]*)" alt="film', shown)
    density = cube.extinction * cube.grid.voxel_mm / np.log(10)
    assert len(pictures) == 3
    for film, picture in enumerate(pictures):
        with Image.open(BytesIO(base64.b64decode(picture))) as image:
            levels = np.asarray(image)
        times = levels.shape[0] // cube.grid.shape[1]
        light = np.moveaxis(10.0 ** -density[:, film].astype(float), 0, -1)[::-1]
        np.testing.assert_array_equal(levels[::times, ::times], to_uint8(light, "srgb"))
        assert f"<b>film {film + 1}</b> {density[:, film].mean():.2f}" in shown
    assert shown.count(f">{density.max():.2f}<") == 1  # of the darkest film alone
    for loose in (True, False):
        found = ghosts(3, float(density.mean()), loose=loose)
        assert f">{found.through:.0%}<" in shown
        assert f">{found.displaced:.1%}<" in shown
