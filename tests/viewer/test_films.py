"""Films on the page: the same light as the package's, exactly, also where they lie off, and pictures to choose."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lightcube as lc
from lightcube.errors import InputError
from lightcube.forward.casting import cast
from lightcube.optics.cube import Cube
from lightcube.optics.moves import misplaced, moved
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.pictures.fitting import targets_of
from lightcube.scoring import metrics
from lightcube.viewer.films import describe_films, films_data
from tests.helpers.browser import opened
from tests.helpers.films import room
from tests.helpers.paging import Evaluate
from tests.helpers.visiting import CUBE, marked, rested, until

LAW = ("model/data.js", "model/films.js")
STACK = Stack((3, 12, 14), 2.0, heights_mm=(-9.0, 1.0, 8.0))
#: What is between films, whether lamps are near, whether they have a size, whether films are moved.
KINDS = {
    "air": (1.0, False, 0.0, False),
    "acrylic": (1.49, False, 0.0, False),
    "near": (1.0, True, 0.0, False),
    "soft": (1.0, False, 4.0, False),
    "moved": (1.0, False, 0.0, True),
}


def stack_cube(kind: str = "air", channels: int = 3) -> Cube:
    index, near, disc_deg, moves = KINDS[kind]
    stack = replace(STACK, index=index)
    rig = room(stack, near=near, low_mm=-9.0 if near else 0.0)
    rig = replace(rig, turning=replace(rig.turning, turns=np.zeros((2, 2), np.bool_)))
    if disc_deg:
        rig = replace(rig, sums=replace(rig.sums, disc_deg=np.full(2, disc_deg)))
    if moves:
        rig = moved(rig, stack, [None, lc.Move("m", (2, 1, 3), ((3, 0), (0, 0), (1, -2.5)), (90, 180, -90))])
    if channels != 3:
        rig = replace(rig, sums=replace(rig.sums, share=np.ones((2, 1))))
    random = np.random.default_rng(6)
    extinction = random.uniform(0, 0.5, (channels, *stack.shape)).astype(np.float32)
    wanted = random.integers(1, 65536, (2, *rig.picture_shape, channels + 1), np.uint16)
    powers = random.uniform(0.5, 2, (2, channels))
    return Cube(extinction, stack, rig, powers, targets=wanted, names=("ann", "bob"))


def asked(evaluate: Evaluate, cube: Cube, expression: str, **more: Any) -> Any:
    """The value of an expression over a page's scene, and its films and wanted pictures."""
    given = {"scene": describe_films(cube, "films"), "data": list(films_data(cube)), **more}
    text = f"""(async () => {{
      const scene = argument.scene;
      const {{ films, wanted }} = filmsOf(await gunzip(Uint8Array.from(argument.data)), scene);
      return {expression};
    }})()"""
    return evaluate(LAW, text, given)


def off_by(cube: Cube, off_mm: float) -> Rig:
    """Films laid wrongly as the page lays them."""
    assert isinstance(cube.grid, Stack)
    ways = np.random.default_rng(0).standard_normal((cube.grid.shape[0], 2))
    return misplaced(cube.rig, cube.grid, np.column_stack([off_mm * ways, np.zeros(len(ways))]))


@pytest.mark.parametrize("off_mm", [0.0, 0.3])
@pytest.mark.parametrize("kind", KINDS)
def test_the_page_casts_the_same_light(evaluate: Evaluate, kind: str, off_mm: float) -> None:
    cube = stack_cube(kind)
    text = "scene.pictures.map((_, picture) => [...castFilms(scene, films, picture, argument.off)])"
    shown = asked(evaluate, cube, text, off=off_mm)
    wanted = list(cast(cube, off_by(cube, off_mm)))
    assert max(float(np.ptp(picture)) for picture in wanted) > 0.2
    np.testing.assert_allclose(shown, [picture.ravel() for picture in wanted], rtol=0, atol=2e-5)


def test_one_colour_is_seen_as_grey(evaluate: Evaluate) -> None:
    cube = stack_cube(channels=1)
    shown = asked(evaluate, cube, "[...castFilms(scene, films, 1, 0)]")
    grey = list(cast(cube))[1].reshape(-1, 1)
    np.testing.assert_allclose(np.reshape(shown, (-1, 3)), np.repeat(grey, 3, axis=1), atol=2e-5)


def test_the_page_scores_as_the_package_does(evaluate: Evaluate) -> None:
    cube = stack_cube()
    text = "scene.pictures.map((_, picture) => psnrOf(scene, wanted, picture, castFilms(scene, films, picture, 0)))"
    wanted = np.array(cube.targets)
    wanted[..., 3] = 65535  # all pixels count alike there
    even = replace(cube, targets=wanted)
    scores = [each["psnr"] for each in metrics.score(even, targets_of(even))["pictures"]]
    np.testing.assert_allclose(asked(evaluate, even, text), scores, atol=1e-3)
    assert asked(evaluate, replace(cube, targets=None), "psnrOf(scene, wanted, 0, [])") is None


def test_films_that_are_cut_off_are_refused(evaluate: Evaluate) -> None:
    text = "(() => { try { filmsOf(new Uint8Array(8), scene); } catch (error) { return error.message; } })()"
    assert "8 bytes, not" in asked(evaluate, stack_cube(), text)


@pytest.mark.parametrize("what", ["turned", "fading", "colours", "notebook"])
def test_what_the_page_could_not_cast_is_refused(what: str) -> None:
    cube = stack_cube()
    assert isinstance(cube.grid, Stack)
    if what == "turned":
        cube = replace(cube, rig=moved(cube.rig, cube.grid, [None, lc.Move("m", turn_deg=(0, 10, 0))]))
    if what == "fading":
        cube = replace(cube, rig=replace(cube.rig, fading=replace(cube.rig.fading, cosine=np.array([True, False]))))
    if what == "colours":
        cube = stack_cube(channels=2)
    if what == "notebook":
        from lightcube.viewer.page import contents

        with pytest.raises(InputError, match="a notebook turns cubes"):
            contents(cube, "films")
        return
    with pytest.raises(InputError, match="play th"):
        lc.page(cube, "films")


@pytest.fixture
def visit(bare_browser: Any, tmp_path: Path) -> Iterator[Any]:
    """Opens the page of some films in a browser without WebGL."""
    (tmp_path / "films.html").write_text(lc.page(stack_cube("moved"), lc.Label("films", by="Ada")), encoding="utf-8")
    tab, heard = opened(bare_browser, tmp_path / "films.html", width=920, height=480, device_scale_factor=0.5)
    until(tab, CUBE)
    rested(tab)
    yield tab
    assert heard == []
    tab.context.close()


def test_pictures_are_chosen_and_films_laid_wrongly_by_hand(visit: Any) -> None:
    tab, cube = visit, stack_cube("moved")

    def light() -> np.ndarray:
        rested(tab)
        return np.array(tab.evaluate(f"[...{CUBE}.light()]"))

    assert marked(tab) == ["ann"]
    tab.keyboard.press("ArrowRight")
    np.testing.assert_allclose(light(), list(cast(cube))[1].ravel(), atol=2e-5)
    assert (marked(tab), tab.evaluate(f"{CUBE}.picture")) == (["bob"], 1)
    assert "film" in tab.locator(".told").first.inner_text()
    slider = tab.get_by_role("slider", name="Films off by, mm")
    slider.fill("0.3")
    np.testing.assert_allclose(light(), list(cast(cube, off_by(cube, 0.3)))[1].ravel(), atol=2e-5)
    assert "films off by 0.30 mm" in tab.locator(".controls").inner_text()
    tab.get_by_role("button", name="ann,").click()
    np.testing.assert_allclose(light(), next(cast(cube, off_by(cube, 0.3))).ravel(), atol=2e-5)


def test_the_eye_goes_round_the_films(visit: Any) -> None:
    tab = visit
    seen = [tab.locator("canvas.room").screenshot()]
    tab.mouse.move(200, 250)
    tab.mouse.down()
    tab.mouse.move(260, 230, steps=4)
    tab.mouse.up()
    rested(tab)
    seen.append(tab.locator("canvas.room").screenshot())
    tab.locator("canvas.room").dblclick(position={"x": 200, "y": 250})
    rested(tab)
    seen.append(tab.locator("canvas.room").screenshot())
    assert seen[0] != seen[1]
    assert seen[1] != seen[2]
