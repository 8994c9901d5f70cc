"""Cubes in notebooks: what shows itself, the widget in a real browser, and the example, which runs."""

import base64
import builtins
import json
import math
import sys
from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

import lightcube as lc
from lightcube.drawing.strip import thumbnails
from lightcube.errors import InputError
from lightcube.optics import showing
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.optics.transfer import to_uint8
from lightcube.viewer import notebook
from lightcube.viewer.description import describe, zipped
from lightcube.viewer.modules import joined, source
from lightcube.viewer.packing import pack
from tests.conftest import INTERPRETED
from tests.helpers.wall import play

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "light-cube.ipynb"
SHAPE = (3, 5, 7)
WIDGET = "application/vnd.jupyter.widget-view+json"


def turning(count: int = 3, channels: int = 3) -> Cube:
    grid = Grid(SHAPE, 2.0)
    rig = turntable(grid, np.arange(count) * 360 / count + 20.0, elevation_deg=35.0, picture_shape=(3, 5))
    extinction = np.random.default_rng(3).uniform(0, 0.2, (channels, *SHAPE)).astype(np.float32)
    powers = np.random.default_rng(4).uniform(0.5, 2, (count, channels))
    return Cube(extinction, grid, rig, powers, scores={"psnr_mean": 41.26})


def staged() -> Cube:
    """Two lamps together on one screen, each alone on it, and another screen: pictures of two sizes, four pairs."""
    stage = Stage(
        Grid(SHAPE, 2.0),
        (
            Lamp("bulb", position_mm=(-40.0, 6.0, 9.0), power_max=4),
            Lamp("sun", direction=(0.2, 1.0, -0.1), power_max=4),
        ),
        (
            Screen("wall", (50.0, 0.0, -4.0), (12.0, 8.0), 2.0, (-1.0, 0.0, 0.0)),
            Screen("end", (3.0, 40.0, -4.0), (8.0, 10.0), 2.0, (0.0, -1.0, 0.0)),
        ),
        (Shot("a", "wall", ("bulb", "sun")), Shot("b", "end", ("sun",)), Shot("c", "wall", ("bulb",), 1)),
        stops_deg=(10.0, 130.0),
    )
    rig = stage.rig()
    extinction = np.random.default_rng(3).uniform(0, 0.1, (3, *SHAPE)).astype(np.float32)
    powers = np.random.default_rng(4).uniform(0.5, 1, (len(rig.pairs), 3))
    return Cube(extinction, stage.grid, rig, powers)


@pytest.fixture
def kernel(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if this were the kernel of a notebook."""
    monkeypatch.setattr(notebook, "_shell", lambda: SimpleNamespace(kernel="a kernel"))


@pytest.fixture
def no_anywidget(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name.startswith("anywidget"):
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)


def tiles_of(png: bytes, pictures: list[NDArray[np.uint8]], per_line: int) -> Iterator[NDArray[np.uint8]]:
    """Every tile of a strip, at its own size again, by the sizes of the pictures that it shows."""
    strip = np.asarray(Image.open(BytesIO(png)))
    scales = [max(1, round(96 / min(picture.shape[:2]))) for picture in pictures]
    high, wide = (max(s * p.shape[axis] for s, p in zip(scales, pictures, strict=True)) + 6 for axis in (0, 1))
    for number, (scale, picture) in enumerate(zip(scales, pictures, strict=True)):
        line, place = divmod(number, per_line)
        top, left = 6 + line * high, 6 + place * wide
        rows, columns = picture.shape[:2]
        yield strip[top : top + rows * scale : scale, left : left + columns * scale : scale]


@pytest.mark.parametrize("cube", [turning(), turning(channels=1), staged()], ids=["turntable", "grey", "stage"])
def test_the_strip_is_what_the_cube_shows_at_its_stops(cube: Cube) -> None:
    windows = cube.rig.stops.window
    shown = [to_uint8(each[:rows, :columns]) for each, (rows, columns) in zip(play(cube), windows, strict=True)]
    pictures = [np.broadcast_to(each, (*each.shape[:2], 3)).astype(np.uint8) for each in shown]
    for tile, picture in zip(tiles_of(thumbnails(cube), pictures, 3), pictures, strict=True):
        np.testing.assert_array_equal(tile, picture)


def test_of_many_pictures_the_strip_shows_sixteen_from_first_to_last() -> None:
    cube = turning(40)
    pictures = list(to_uint8(play(cube))[np.linspace(0, 39, 16).round().astype(int)])
    for tile, picture in zip(tiles_of(thumbnails(cube), pictures, 8), pictures, strict=True):
        np.testing.assert_array_equal(tile, picture)


def test_of_many_pictures_on_a_stage_each_keeps_its_own_lamps() -> None:
    cube = staged()
    rig = cube.rig.take(np.arange(18) % 3)
    pairs = np.random.default_rng(9).uniform(0.3, 1, (len(rig.pairs), 3))
    many = replace(cube, rig=rig, names=(), lamp_powers=pairs)
    chosen = np.linspace(0, 17, 16).round().astype(int)
    pictures = [to_uint8(play(many)[c])[: rig.stops.window[c, 0], : rig.stops.window[c, 1]] for c in chosen]
    for tile, picture in zip(tiles_of(thumbnails(many), pictures, 8), pictures, strict=True):
        np.testing.assert_array_equal(tile, picture)


@pytest.mark.usefixtures("kernel")
def test_a_cube_shows_itself_as_widget_picture_and_text() -> None:
    pytest.importorskip("anywidget", reason="anywidget is not installed")
    cube = turning()
    parts = notebook.displayed(cube)
    assert sorted(parts) == [WIDGET, "image/png", "text/plain"]
    assert parts["text/plain"] == repr(cube)
    assert base64.b64decode(parts["image/png"]) == thumbnails(cube)
    json.dumps(parts)
    bundle = (notebook.show(cube)._repr_mimebundle_() or ({},))[0]
    assert bundle.pop(WIDGET) != parts.pop(WIDGET)
    assert bundle == parts


@pytest.mark.usefixtures("kernel")
def test_a_cube_too_large_for_a_page_shows_its_pictures_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(notebook, "MOST_SIDE", 1)
    assert sorted(notebook.displayed(turning())) == ["image/png", "text/plain"]


@pytest.mark.usefixtures("kernel", "no_anywidget")
def test_without_anywidget_a_cube_is_a_picture_and_show_says_what_to_install() -> None:
    assert sorted(notebook.displayed(turning())) == ["image/png", "text/plain"]
    with pytest.raises(InputError, match=r"pip install 'lightcube\[notebook\]'"):
        notebook.show(turning())


@pytest.mark.usefixtures("kernel")
def test_a_cube_that_no_page_shows_is_still_shown() -> None:
    large = replace(turning(2), extinction=np.zeros((2, *SHAPE), np.float32), lamp_powers=None)
    assert list(notebook.displayed(large)) == ["text/plain"]
    assert list(notebook.displayed(turning(channels=2))) == ["text/plain"]


def test_outside_of_notebooks_nothing_is_sent_to_a_widget(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "IPython", raising=False)
    assert sorted(notebook.displayed(turning())) == ["image/png", "text/plain"]
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: SimpleNamespace()))
    assert list(notebook.displayed(turning())) == ["text/plain"]


def test_the_package_says_how_a_cube_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    assert lc.show is notebook.show
    monkeypatch.delitem(sys.modules, "IPython", raising=False)
    cube = turning()
    assert cube._repr_mimebundle_(include=None, exclude=None) == notebook.displayed(cube)
    monkeypatch.setattr(showing, "by", None)
    assert cube._repr_mimebundle_() == {"text/plain": repr(cube)}


@pytest.fixture(scope="module")
def widget() -> Any:
    pytest.importorskip("anywidget", reason="anywidget is not installed")
    return notebook.show(turning())


@given(angle_deg=st.floats(-1e9, 1e9))
def test_the_widgets_angle_is_within_a_turn(widget: Any, angle_deg: float) -> None:
    widget.angle_deg = angle_deg
    assert 0 <= widget.angle_deg < 360
    assert math.isclose(math.remainder(widget.angle_deg - angle_deg, 360), 0, abs_tol=1e-6)


@pytest.mark.parametrize("angle_deg", [math.nan, math.inf])
def test_an_angle_that_is_none_is_refused(widget: Any, angle_deg: float) -> None:
    with pytest.raises(InputError, match="finite angle"):
        widget.angle_deg = angle_deg


def test_the_widget_has_what_a_page_has_and_starts_at_the_first_stop() -> None:
    pytest.importorskip("anywidget", reason="anywidget is not installed")
    cube = turning()
    fresh, packed = notebook.show(cube), pack(cube)
    assert fresh.voxels == packed.data()
    assert fresh.scene == zipped(describe(cube, packed, "light cube"))
    assert fresh.angle_deg == cube.angles_deg[0]
    heard: list[float] = []
    fresh.observe(lambda change: heard.append(change["new"]), "angle_deg")
    fresh.angle_deg = 400.0
    assert heard == [40.0]


#: A model as anywidget hands it in, and a place for the widget; `save_changes` is counted.
HOST = """
const heard = [], state = { angle_deg: argument.angle_deg };
for (const name of ["scene", "voxels"]) {
  const bytes = Uint8Array.from(atob(argument[name]), (letter) => letter.charCodeAt(0));
  state[name] = new DataView(bytes.buffer);
}
window.model = {
  saved: 0,
  get: (name) => state[name],
  set(name, value) {
    state[name] = value;
    heard.filter((each) => each[0] === `change:${name}`).forEach((each) => each[1]());
  },
  on: (name, callback) => heard.push([name, callback]),
  off(name, callback) {
    const place = heard.findIndex((each) => each[0] === name && each[1] === callback);
    if (place >= 0) heard.splice(place, 1);
  },
  save_changes() { this.saved += 1; },
  heard,
};
const style = document.createElement("style");
style.textContent = argument.style;
const el = document.createElement("div");
document.body.replaceChildren(style, el);
window.cleanup = await render({ model, el });
"""


def hosted(tab: Any, cube: Cube) -> None:
    """Render a cube's widget in a page, as anywidget does; the model is ``window.model``."""
    packed = pack(cube)
    parts = {"scene": zipped(describe(cube, packed, "light cube")), "voxels": packed.data()}
    argument = {name: base64.b64encode(part).decode() for name, part in parts.items()}
    code = f"async (argument) => {{\n{joined('widget.js')}\n{HOST}\n}}"
    tab.evaluate(code, {**argument, "angle_deg": float(cube.angles_deg[1]), "style": source("style.css")})


def angle_of(tab: Any) -> float:
    return float(tab.evaluate("model.get('angle_deg')"))


@pytest.fixture
def tab(browser: Any) -> Iterator[Any]:
    page = browser.new_page(viewport={"width": 900, "height": 700}, device_scale_factor=0.25)
    yield page
    page.close()


def test_the_models_angle_turns_the_cube(tab: Any) -> None:
    cube = turning()
    hosted(tab, cube)
    shown = "document.querySelector('.lightcube').lightcube.angle"
    assert tab.evaluate(shown) == pytest.approx(cube.angles_deg[1])
    tab.evaluate("model.set('angle_deg', 77.5)")
    tab.wait_for_function(f"Math.abs({shown} - 77.5) < 1e-9")
    assert angle_of(tab) == 77.5


def test_a_drag_and_a_key_set_the_models_angle(tab: Any) -> None:
    cube = turning()
    hosted(tab, cube)
    before = angle_of(tab)
    box = tab.locator(".lightcube canvas").first.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    tab.mouse.move(x, y)
    tab.mouse.down()
    tab.mouse.move(x + 60, y, steps=4)
    tab.wait_for_function(f"model.get('angle_deg') !== {before} && model.saved > 0")
    tab.mouse.up()
    assert 0 <= angle_of(tab) < 360
    tab.evaluate(f"model.set('angle_deg', {cube.angles_deg[1]})")
    tab.locator(".lightcube canvas").first.focus()
    tab.keyboard.press("PageDown")
    tab.wait_for_function(f"Math.abs(model.get('angle_deg') - {cube.angles_deg[2]}) < 1e-6")


def test_a_widget_that_is_taken_away_leaves_nothing(tab: Any) -> None:
    hosted(tab, turning())
    tab.evaluate("cleanup()")
    assert tab.evaluate("[model.heard.length, document.querySelectorAll('.lightcube').length]") == [0, 0]


def test_damage_is_told_in_the_widgets_place(tab: Any) -> None:
    cube = turning()
    packed = pack(cube)
    parts = {"scene": zipped(describe(cube, packed, "")), "voxels": packed.data()[:-20]}
    argument = {name: base64.b64encode(part).decode() for name, part in parts.items()}
    code = f"async (argument) => {{\n{joined('widget.js')}\n{HOST}\n}}"
    tab.evaluate(code, {**argument, "angle_deg": 0.0, "style": ""})
    assert len(tab.locator("body").inner_text().split()) > 3


def stored() -> Any:
    return pytest.importorskip("nbformat", reason="nbformat is not installed").read(EXAMPLE, as_version=4)


def test_the_example_is_stored_without_outputs() -> None:
    cells = stored().cells
    assert all(not cell.outputs and cell.execution_count is None for cell in cells if cell.cell_type == "code")
    assert 5 <= sum(cell.cell_type == "code" for cell in cells) <= 9


#: The same with less to solve for.
SMALLER = {"pictures, 32": "pictures, 16", "Grid((48, 48, 48), voxel_mm=1.5": "Grid((20, 20, 20), voxel_mm=3.6"}
SMALLER |= {"side=64, sweeps=60": "side=24, sweeps=9"}


@pytest.mark.skipif(INTERPRETED, reason="interpreted solves take too long")
def test_the_example_runs(tmp_path: Path) -> None:
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    pytest.importorskip("anywidget", reason="anywidget is not installed")
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    client = pytest.importorskip("nbclient", reason="nbclient is not installed")
    example = stored()
    for large, small in SMALLER.items():
        assert any(large in cell.source for cell in example.cells), large
        for cell in example.cells:
            cell.source = cell.source.replace(large, small)
    client.NotebookClient(example, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [output for cell in example.cells if cell.cell_type == "code" for output in cell.outputs]
    assert {output.output_type for output in outputs} == {"stream", "execute_result"}
    assert {output.get("name", "stdout") for output in outputs} == {"stdout"}
    shown = [output.data for output in outputs if "data" in output]
    assert sum(WIDGET in each for each in shown) == 3
    assert sum("image/png" in each for each in shown) == 8
