"""Opaque shapes on the page: drawn as bodies, told of in words of their own."""

import re
from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from lightcube.forward.casting import cast
from lightcube.optics.grid import Grid
from lightcube.scoring.overlap import overlaps
from lightcube.solids.shape import Shape, as_cube, hull
from lightcube.solids.walls import walls
from lightcube.viewer.page import page
from tests.helpers.browser import opened
from tests.helpers.paging import Evaluate
from tests.helpers.solid import of_pixels
from tests.helpers.visiting import CUBE, rested, until

GRID = Grid((12, 14, 16), 2.0)
BODY = ("model/body.js",)
#: A cube as the page has it, of a block of zeros and ones.
CUBE_OF = "{ shape: argument.shape, codes: Uint16Array.from(argument.inside.flatMap((each) => [each, each, each])) }"


def asked(evaluate: Evaluate, inside: np.ndarray, expression: str, **argument: Any) -> Any:
    """The value of an expression over the body of a block of voxels."""
    given = {"shape": inside.shape, "inside": inside.ravel().astype(int).tolist(), **argument}
    return evaluate(BODY, f"((body) => {expression})(bodyOf({CUBE_OF}))", given)


def ball(shape: tuple[int, int, int], radius: float) -> np.ndarray:
    z, y, x = np.indices(shape) + 0.5
    return (x - shape[2] / 2) ** 2 + (y - shape[1] / 2) ** 2 + (z - shape[0] / 2) ** 2 < radius**2


def test_a_ray_meets_a_ball_where_it_is(evaluate: Evaluate) -> None:
    shape, radius = (22, 24, 26), 9.0
    ways = np.random.default_rng(1).normal(size=(20, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    middle = np.array(shape[::-1]) / 2
    starts = middle - 30 * ways
    met = asked(
        evaluate,
        ball(shape, radius),
        "argument.ways.map((way, i) => meets(body, argument.starts[i], way))",
        ways=ways.tolist(),
        starts=starts.tolist(),
    )
    assert [each["far"] for each in met] == pytest.approx(20 * [30 - radius], abs=0.5)
    for each, way in zip(met, ways, strict=True):
        assert -way @ each["normal"] > 0.97
    aside = np.add(middle, (0, radius + 1.5, -40)).tolist()
    assert asked(evaluate, ball(shape, radius), "meets(body, argument.start, [0, 0, 1])", start=aside) is None


def test_a_plane_stays_where_it_is_and_what_is_thin_is_seen(evaluate: Evaluate) -> None:
    thick, wall, thread = (np.zeros((9, 10, 11), bool) for _ in range(3))
    thick[:5], wall[4], thread[4, 5] = True, True, True
    far = "meets(body, [5.2, 5.4, 20], [0, 0, -1])?.far ?? null"
    assert asked(evaluate, thick, far) == pytest.approx(15, abs=0.05)
    for thin in (wall, thread):
        assert asked(evaluate, thin, far) == pytest.approx(15, abs=0.5)


def test_a_body_is_closed_where_it_fills_its_block(evaluate: Evaluate) -> None:
    full = np.ones((7, 8, 9), bool)
    for axis, length in enumerate((9, 8, 7)):
        start, way = [4.4, 3.6, 3.3], [0.0, 0.0, 0.0]
        start[axis], way[axis] = 20.0 + length, -1.0
        met = asked(evaluate, full, "meets(body, argument.start, argument.way)", start=start, way=way)
        assert met["far"] == pytest.approx(20, abs=0.05)
        assert met["normal"] == pytest.approx([-each for each in way], abs=0.02)


def test_what_a_lamp_does_not_reach_is_dark(evaluate: Evaluate) -> None:
    block = np.zeros((14, 12, 12), bool)
    block[:3], block[9:11, 3:9, 3:9] = True, True  # a roof above a floor
    lamp = "[{ ways: () => [0, 0, 1], light: [1, 0.5, 0] }]"
    at = "((place) => brightness(body, { place, normal: [0, 0, 1] }, [0, 0, 1], %s))"
    open_, under = ([1.5, 1.5, 3.0], [6.0, 6.0, 3.0])
    lit, shade = (asked(evaluate, block, f"{at % lamp}(argument.place)", place=place) for place in (open_, under))
    dark = asked(evaluate, block, f"{at % '[]'}(argument.place)", place=open_)
    assert shade == pytest.approx(dark)
    assert lit[0] == pytest.approx(1)
    assert dark[0] < lit[1] < lit[0]
    assert lit[2] == pytest.approx(dark[2])


@pytest.fixture(scope="module")
def shape() -> Shape:
    """A plate of a front that has a hole, between three walls."""
    rig = walls(GRID).rig()
    front, side, top = (np.zeros(size, bool) for size in ((12, 16), (12, 14), (14, 16)))
    front[2:9, 2:13] = side[2:10, 3:11] = top[3:11, 2:13] = True  # the side's last row, nothing casts
    front[4:7, 5:9] = False
    return hull(of_pixels(rig, front, side, top), GRID)


@pytest.fixture(scope="module")
def place(shape: Shape, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("shape") / "shape.html"
    path.write_text(page(as_cube(shape), "a plate"), encoding="utf-8")
    return path


@pytest.fixture
def tab(browser: Any, place: Path) -> Iterator[Any]:
    yield from shown(browser, place)


@pytest.fixture
def bare_tab(bare_browser: Any, place: Path) -> Iterator[Any]:
    yield from shown(bare_browser, place)


def shown(browser: Any, place: Path) -> Iterator[Any]:
    tab, heard = opened(browser, place, width=700, height=420, device_scale_factor=0.5)
    until(tab, CUBE)
    rested(tab)
    yield tab
    assert heard == []
    tab.context.close()


def middle_of_room(tab: Any) -> np.ndarray:
    """Mean levels of the pixels in the room's middle, where the body is."""
    seen = np.asarray(Image.open(BytesIO(tab.locator("canvas.room").screenshot())).convert("RGB"), float)
    rows, columns = (slice(int(0.5 * side), int(0.56 * side)) for side in seen.shape[:2])
    return np.asarray(seen[rows, columns].mean(axis=(0, 1)))


def test_its_words_are_of_a_shape(tab: Any) -> None:
    tab.keyboard.press("d")
    rested(tab)
    tab.keyboard.press("?")
    said = tab.locator("#lightcube").inner_text() + " ".join(
        each
        for each in tab.evaluate(
            "[...document.querySelectorAll('[title], [aria-label]')].filter((e) => e.offsetParent)"
            ".map((e) => `${e.title} ${e.ariaLabel}`)"
        )
    )
    assert re.search(r"overlap \d+\.\d %", said)
    assert "shape" in said
    for word in (
        "glass",
        "extinction",
        "voxels alone",
        " dB",
        "Scan-line",
        "scan-line",
        "Lamp power",
        "cube",
        "thin beams",
    ):
        assert word not in said, word


@pytest.mark.parametrize("kind", ["tab", "bare_tab"])
def test_it_is_a_bright_body_before_dark_shadows(kind: str, request: pytest.FixtureRequest) -> None:
    """Its own warm tone where black glass was, with WebGL2 and without."""
    tab = request.getfixturevalue(kind)
    red, green, blue = middle_of_room(tab)
    assert red > 90
    assert red > green + 10 > blue + 15


def test_overlaps_are_shared_parts(shape: Shape) -> None:
    cube = as_cube(shape)
    assert cube.targets is not None
    found = overlaps(cube)
    for picture, wanted, each in zip(cast(cube), cube.targets, found, strict=True):
        shade, given = 1 - np.clip(picture[..., 0], 0, 1), (1 - wanted[..., 0] / 65535) * (wanted[..., 3] > 0)
        shade = shade * (wanted[..., 3] > 0)
        assert each == pytest.approx(np.minimum(shade, given).sum() / np.maximum(shade, given).sum(), abs=1e-4)
    assert min(found) == pytest.approx(7 / 8, abs=1e-3)
    none = replace(cube, targets=65535 * np.ones_like(cube.targets))
    assert overlaps(none) == [0, 0, 0]
