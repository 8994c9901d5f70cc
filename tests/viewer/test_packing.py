"""What a page holds of a cube: how it is rounded, what is lost, and what the page is told."""

import base64
import gzip
import json
import math
import re
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from lightcube import io
from lightcube.errors import InputError
from lightcube.forward.turning import moment
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import encode
from lightcube.viewer import packing
from lightcube.viewer.description import describe, zipped
from lightcube.viewer.packing import BITS, lost, pack
from lightcube.viewer.page import page
from tests.cli.test_cli import run
from tests.helpers.thin import cast

__all__ = ["run"]

GRID = Grid((3, 5, 7), 1.3)
#: Stops and elevation: raised; level; level with two stops half a turn apart, which have powers of their own.
TURNTABLES = [([10.0, 100.0, 215.0], 35.0), ([20.0, 75.0, 140.0], 0.0), ([20.0, 75.0, 200.0], 0.0)]


def random_cube(
    angles_deg: list[float], elevation_deg: float, *, channels: int = 3, seed: int = 3, grid: Grid = GRID, **more: Any
) -> Cube:
    """A cube that casts pictures of 3 x 5 pixels, off the middle by whole pixels."""
    rng = np.random.default_rng(seed)
    rig = turntable(grid, angles_deg, elevation_deg=elevation_deg, picture_shape=(3, 5))
    aside = rng.integers(-1, 2, (2, len(angles_deg), 1))
    rig = rig.shifted(aside[..., 0].T)
    extinction = rng.exponential(0.1, (channels, *grid.shape)).astype(np.float32)
    powers = rng.uniform(0.5, 4, (len(angles_deg), channels))
    targets = rng.integers(0, 65536, (len(angles_deg), 3, 5, channels + 1), np.uint16)
    return Cube(extinction, grid, rig, powers, targets=targets, **more)


def decoded(data: bytes, count: int, bits: int) -> list[int]:
    """The codes of a page's bytes, bit by bit."""
    raw = gzip.decompress(data)
    low = bits - 8
    stream = [byte >> i & 1 for byte in raw[count:] for i in range(8)]
    rests = [sum(stream[low * place + i] << i for i in range(low)) for place in range(count)]
    return [(high << low) + rest for high, rest in zip(raw[:count], rests, strict=True)]


@pytest.mark.parametrize("bits", BITS)
@pytest.mark.parametrize("channels", [1, 3])
def test_the_codes_come_back_from_the_bytes(channels: int, bits: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packing, "BITS", (bits,))
    packed = pack(random_cube(*TURNTABLES[0], channels=channels))
    assert packed.bits == bits
    assert decoded(packed.data(), packed.codes.size, bits) == packed.codes.ravel().tolist()


@settings(max_examples=30)
@given(st.floats(1e-4, 3e3), st.integers(0, 100))
def test_rounding_is_by_half_a_step_at_most(scale: float, seed: int) -> None:
    cube = random_cube(*TURNTABLES[0], seed=seed)
    cube = replace(cube, extinction=cube.extinction**3 * np.float32(scale))
    packed = pack(cube)
    rates = np.array(packed.rates)[:, None, None, None]
    step = (cube.extinction + packed.least) * np.expm1(rates)  # to the next code
    assert np.all(np.abs(packed.cube.extinction - cube.extinction) <= 0.51 * step + 1e-6 * cube.extinction.max())
    assert packed.codes.max() == 2**packed.bits - 1
    again = pack(packed.cube)
    np.testing.assert_array_equal(again.codes, packed.codes)


def test_shadows_that_need_it_get_more_bits() -> None:
    cube = random_cube(*TURNTABLES[0])
    taken = []
    for scale in (1, 20, 160):  # bright lamps behind dark glass
        dark = replace(
            cube, extinction=cube.extinction * np.float32(scale), lamp_powers=cube.powers * math.exp(0.4 * scale)
        )
        packed = pack(dark)
        assert packed.lost == lost(dark, packed.cube)
        assert packed.lost[0] < 1
        taken.append(packed.bits)
    assert tuple(taken) == BITS


def test_what_is_clear_stays_clear() -> None:
    cube = random_cube(*TURNTABLES[0])
    clear = replace(cube, extinction=cube.extinction * np.array([0, 1, 0], np.float32)[:, None, None, None])
    packed = pack(clear)
    assert not np.any(packed.cube.extinction[[0, 2]])
    assert np.any(packed.cube.extinction[1])
    holes = replace(cube, extinction=np.where(cube.extinction > 0.1, cube.extinction, 0))
    assert np.all((pack(holes).cube.extinction == 0) | (holes.extinction > 0))


@pytest.mark.parametrize(("angles_deg", "elevation_deg"), TURNTABLES)
def test_what_is_lost_is_what_one_sees(angles_deg: list[float], elevation_deg: float) -> None:
    cube = random_cube(angles_deg, elevation_deg)
    packed = pack(cube)
    middles = [(a + b) / 2 for a, b in zip(angles_deg, [*angles_deg[1:], angles_deg[0] + 360], strict=True)]
    shown = [
        255 * encode(np.minimum(np.stack(list(cast(each, *moment(each, at)))), 1))
        for each in (cube, packed.cube)
        for at in [[*angles_deg, *middles]]
    ]
    off = np.abs(shown[0] - shown[1])
    np.testing.assert_allclose(packed.lost, (off.max(), np.sqrt(np.mean(off**2))), rtol=1e-3)
    assert off.max() < 1


def picture(uri: str) -> NDArray[np.uint8]:
    return np.asarray(Image.open(BytesIO(base64.b64decode(uri.split(",")[1]))))


@pytest.mark.parametrize("channels", [1, 3])
def test_wanted_pictures_are_the_targets_and_clear_elsewhere(channels: int) -> None:
    cube = random_cube(*TURNTABLES[0], channels=channels)
    assert cube.targets is not None
    targets = cube.targets.copy()
    targets[:, :2, :, -1] = 0
    cube = replace(cube, targets=targets)
    told = describe(cube, pack(cube), "three")
    for uri, levels in zip(told["wanted"], targets, strict=True):
        assert uri.startswith("data:image/png")
        wanted = np.broadcast_to(np.rint(levels[..., :-1] / 257), (3, 5, 3))
        np.testing.assert_array_equal(picture(uri)[..., :3], wanted)
        np.testing.assert_array_equal(picture(uri)[..., 3] > 0, levels[..., -1] > 0)


def test_many_wanted_pictures_lose_a_little(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lightcube.viewer.description._EXACT", 100)
    cube = random_cube(*TURNTABLES[0])
    assert all(uri.startswith("data:image/webp") for uri in describe(cube, pack(cube), "three")["wanted"])


@pytest.mark.parametrize(("angles_deg", "elevation_deg"), TURNTABLES)
def test_the_description_is_plain_json(angles_deg: list[float], elevation_deg: float) -> None:
    cube = random_cube(angles_deg, elevation_deg, names=("é", "<b>", "c"))
    told = json.loads(gzip.decompress(zipped(describe(cube, pack(cube), "title"))))
    mirrored = elevation_deg == 0 and 200.0 not in angles_deg
    assert [each["mirrored"] for each in told["pictures"]] == [False] * 3 + [True] * 3 * mirrored
    assert [each["name"] for each in told["pictures"][:3]] == ["é", "<b>", "c"]
    assert all(each["psnr"] is not None for each in told["pictures"])
    assert len(told["views"]) == len(told["pairs"]) == len(told["pictures"])
    assert told["views"][0]["reach_mm"] == [None, None]
    assert told["whole_shadow"] is not None


def test_a_cube_without_targets_has_none() -> None:
    cube = replace(random_cube(*TURNTABLES[0]), targets=None)
    told = describe(cube, pack(cube), "three")
    assert told["wanted"] == []
    assert all(each["wanted"] is None and each["psnr"] is None for each in told["pictures"])


def test_an_unfinished_cube_says_so() -> None:
    cube = random_cube(*TURNTABLES[0], status="interrupted")
    assert "unfinished" in describe(cube, pack(cube), "three")["title"]


def test_a_page_is_whole_and_asks_for_nothing() -> None:
    text = page(random_cube(*TURNTABLES[0]), "<script>&")
    assert not re.search(r"\{\{\w+\}\}", text.replace("{{element:", ""))
    assert "&lt;script&gt;&amp;" in text
    for word in ("http://www", "https://", "//cdn", "import(", "fetch("):
        assert word not in text.replace("http://www.w3.org/2000/svg", ""), word


def test_colours_that_no_page_shows_are_refused() -> None:
    with pytest.raises(InputError, match="this one has 2"):
        pack(random_cube(*TURNTABLES[0], channels=2))


def test_more_voxels_than_a_browser_takes_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packing, "_TEXTURE", 6)
    with pytest.raises(InputError, match="leave out --full"):
        pack(random_cube(*TURNTABLES[0]))


def test_the_command_writes_a_page(run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    io.save(random_cube(*TURNTABLES[0]), tmp_path / "my cube.zarr")
    done = run("view", "my cube.zarr", "--json")
    assert done.code == 0, done.err
    told = json.loads(done.out)
    assert told["out"] == "my cube.html"
    assert (tmp_path / "my cube.html").stat().st_size == told["bytes"]
    assert told["worst_levels"] < 1
    again = run("view", "my cube.zarr")
    assert again.code == 2
    assert "exists already" in again.err
    assert run("view", "my cube.zarr", "--overwrite").code == 0
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    assert run("view", "my cube.zarr", "-o", "b.html", "--open").code == 0
    assert opened == [(tmp_path / "b.html").as_uri()]


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (("nothing.zarr",), "there is no nothing.zarr"),
        ((".",), "'.' names no cube"),
        (("cube.zarr", "-o", "folder.html"), "folder.html is a folder, and what is written is a file"),
        (("cube.zarr", "-o", "page.png"), "use one of .html, .htm"),
        (("cube.zarr", "-o", "no/page.html"), "there is no folder no"),
        (("notes.txt",), "no suffix"),
        (("begun.zarr.partial",), "start again"),
    ],
)
def test_bad_input_is_a_sentence(
    run: Any,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    asked: tuple[str, ...],
    said: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    io.save(random_cube(*TURNTABLES[0]), "cube.zarr")
    Path("notes.txt").write_text("no cube")
    Path("begun.zarr.partial").mkdir()
    Path("folder.html").mkdir()
    before = sorted(tmp_path.iterdir())
    done = run("view", *asked)
    assert done.code == 2
    assert said in done.err
    assert "Traceback" not in done.err
    assert len(done.err.strip().splitlines()) == 1
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("a/b.zarr", "b"),
        ("b.zarr.zip", "b"),
        ("b.npz", "b"),
        ("x.y.zarr.partial", "x.y"),
        ("s3://k/b.zarr", "b"),
        ("a/b.shape.zarr", "b"),
        ("x.y.Relief.zarr", "x.y"),
        (".shape.zarr", ".shape.zarr"),
    ],
)
def test_a_page_is_named_after_its_cube(path: str, name: str) -> None:
    assert io.bare_name(path) == name
