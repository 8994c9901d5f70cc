"""Slices of droplets: as much of each resin as was asked for, spread evenly, and read back as what they are."""

import json
import shutil
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

import lightcube as lc
from lightcube.errors import InputError
from lightcube.fabrication.blocks import Blocks
from lightcube.fabrication.boxes import edges, means
from lightcube.fabrication.droplets import Droplets
from lightcube.fabrication.noise import blue_order
from lightcube.fabrication.printers import MODES
from lightcube.fabrication.resins import ConvertedCube, mixed
from lightcube.kernels import tasks
from lightcube.optics.dyes import Dyes
from tests.helpers.made import a_cube, in_dyes, some_dyes, with_own_targets

#: Five times as large as a printer's.
SIDES = (25.4 / 120, 25.4 / 60, 0.135)


@pytest.fixture(scope="module")
def cube() -> lc.Cube:
    return in_dyes()


@pytest.fixture(scope="module")
def printed(cube: lc.Cube, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Slices of a cube of dyes."""
    folder = tmp_path_factory.mktemp("print") / "print"
    lc.export(cube, folder, "polyjet")
    return folder


def test_an_order_takes_every_place_once_and_any_first_part_is_spread_evenly() -> None:
    """Of blue noise hardly any place is taken beside another one, and means over parts of a tile are all alike."""
    order = blue_order((1.0, 2.0, 1.0), 16)
    assert np.array_equal(np.sort(order.ravel()), np.arange(16**3))
    plain = np.random.default_rng(0).permutation(16**3).reshape(order.shape)
    for part in (0.03, 0.1, 0.4):
        spread, random = (each < part * each.size for each in (order, plain))
        alike = [each.reshape(4, 4, 4, 4, 4, 4).mean(axis=(1, 3, 5)).std() for each in (spread, random)]
        assert alike[0] < 0.7 * alike[1]


def test_means_over_boxes_are_those_of_the_parts_they_cover() -> None:
    values = np.random.default_rng(0).random((3, 5, 4))
    cut = edges(7, 0.9, 5, 1.0)  # 6.3 over 5: the outer ones stand out, where there is nothing
    found = means(values, 1, cut)
    for box, (low, high) in enumerate(pairwise(cut)):
        parts = [max(0.0, min(high, k + 1) - max(low, k)) for k in range(5)]
        np.testing.assert_allclose(found[:, box], np.einsum("k,ikj->ij", parts, values) / (high - low))
    np.testing.assert_allclose(found.sum(axis=1) * 0.9, values.sum(axis=1))


def block_of(parts: list[float], voxels: tuple[int, int, int] = (20, 21, 22)) -> Droplets:
    amounts = np.broadcast_to(np.array(parts, np.float32)[:, None, None, None], (len(parts), *voxels)).copy()
    return Droplets(amounts, lc.Grid(voxels, 0.7), SIDES, tuple(range(len(parts))), 3)


def counted(made: Droplets) -> NDArray[np.int64]:
    """How many droplets there are of each material, of which three are dyes."""
    return np.sum([np.bincount(made.layer(number).ravel(), minlength=4) for number in range(made.shape[0])], axis=0)


def test_as_many_droplets_are_of_each_dye_as_were_asked_for() -> None:
    """Within 1 %, small parts too: no ink is lost where an error would have to add up first."""
    for parts in ([0.003, 0.05, 0.0004], [0.3, 0.3, 0.35], [0.01, 0.9, 0.05]):
        made = block_of(parts, (40, 40, 40))
        found = counted(made)
        wanted = made.expected()
        assert np.all(np.abs(found[1:] - wanted) < np.maximum(0.01 * wanted, 3 * np.sqrt(wanted) / 4))


def test_fractions_are_kept_within_one_percent_in_a_varied_block() -> None:
    amounts = (np.random.default_rng(1).random((3, 20, 24, 22)) ** 6 * 0.4).astype(np.float32)
    made = Droplets(amounts, lc.Grid((20, 24, 22), 0.9), SIDES, (2, 0, 1), 1)
    found = counted(made)
    np.testing.assert_allclose(found[1:], made.expected(), rtol=0.01)


def test_light_that_falls_through_is_less_noisy_than_through_droplets_thrown_at_random() -> None:
    """Along each axis, over pixels of four droplets."""
    made = block_of([0.03], (30, 60, 28))
    block = np.stack([made.layer(number) for number in range(128)]) == 1
    block = block[tuple(slice(size // 4 * 4) for size in block.shape)]
    thrown = np.random.default_rng(0).random(block.shape) < block.mean()
    for axis in range(3):
        noise = []
        for each in (block, thrown):
            shadow = each.sum(axis=axis, dtype=float)
            rows, columns = shadow.shape
            noise.append(shadow.reshape(rows // 4, 4, columns // 4, 4).mean(axis=(1, 3)).std())
        assert noise[0] < 0.75 * noise[1]


def test_droplets_are_the_same_however_many_threads_there_are_and_another_seed_makes_others(cube: lc.Cube) -> None:
    made = mixed(cube, None)
    blocks = [Droplets(made.amounts, cube.grid, MODES["high-mix"].sides_mm, made.order, seed) for seed in (1, 1, 2)]
    layers = []
    for block, threads in zip(blocks, (1, 3, 1), strict=True):
        with tasks.using(threads):
            layers.append(block.layer(40))
    assert np.array_equal(layers[0], layers[1])
    assert not np.array_equal(layers[0], layers[2])
    assert np.array_equal(blocks[0].layer(40), layers[0])  # whatever was asked for before


def test_slices_are_as_the_sidecar_says(cube: lc.Cube, printed: Path) -> None:
    png = pytest.importorskip("png", reason="pypng is of the extra readers")
    said = json.loads((printed / "slices.json").read_text())
    files = sorted(printed.glob("*.png"))
    assert [file.name for file in files] == [f"slice_{number:04d}.png" for number in range(said["droplets"]["z"])]
    assert set(said["files"]) == {file.name for file in files}
    assert said["droplets"] == {"x": 84, "y": 36, "z": 76}
    for axis, mm in zip("xyz", (25.4 / 600, 25.4 / 300, 0.027), strict=True):
        assert abs(said["size_mm"][axis] - said["droplets"][axis] * mm) < 1e-9
    colours = {tuple(each["rgba"]): each["name"] for each in said["palette"]}
    assert list(colours.values()) == ["clear", "cyan", "magenta", "yellow"]
    wide, high, rows, info = png.Reader(bytes=files[30].read_bytes()).asRGBA8()
    assert (wide, high) == (84, 36)
    assert {tuple(row[4 * x : 4 * x + 4]) for row in map(list, rows) for x in range(wide)} <= set(colours)
    assert (info["physical"].x, info["physical"].y) == (23622, 11811)  # a metre: 600 and 300 an inch


def test_what_another_program_reads_casts_what_was_predicted(cube: lc.Cube, printed: Path) -> None:
    """Pixel by pixel, without this package's reader."""
    png = pytest.importorskip("png", reason="pypng is of the extra readers")
    said = json.loads((printed / "slices.json").read_text())
    of_colour = {tuple(each["rgba"]): each["extinction"] for each in said["palette"]}
    layers = []
    for file in sorted(printed.glob("*.png")):
        wide, _, rows, _ = png.Reader(bytes=file.read_bytes()).asRGBA8()
        pixels = [[of_colour[tuple(row[4 * x : 4 * x + 4])] for x in range(wide)] for row in map(list, rows)]
        layers.append(np.array(pixels)[::-1].repeat(2, axis=0))  # from the back to the front; twice as long as wide
    volume = np.stack(layers).transpose(3, 0, 1, 2).astype(np.float32)
    side = 25.4 / 600
    block = lc.Cube(
        volume, lc.Grid(volume.shape[1:], side, 0.027 / side), cube.rig, lc.read_export(printed).powers, cube.targets
    )
    np.testing.assert_allclose(lc.read_export(printed).extinction, volume)
    assert abs(lc.score(block)["psnr_mean"] - said["predicted"]["psnr_mean"]) < 0.05
    assert said["predicted"]["psnr_mean"] > 20


@pytest.mark.parametrize("flips", ["x", "y", "z", "xz"])
def test_flipped_slices_are_mirrored_and_are_read_as_the_same_block(
    cube: lc.Cube, printed: Path, tmp_path: Path, flips: str
) -> None:
    lc.export(cube, tmp_path / "a", "polyjet", flips=flips, score=False)
    np.testing.assert_array_equal(lc.read_export(tmp_path / "a").extinction, lc.read_export(printed).extinction)
    slices_in = [
        np.stack([np.asarray(Image.open(f)) for f in sorted(at.glob("*.png"))]) for at in (printed, tmp_path / "a")
    ]
    axes = tuple("zyx".index(axis) for axis in flips)
    np.testing.assert_array_equal(np.flip(slices_in[0], axes), slices_in[1])


def test_an_edited_a_missing_a_resized_and_a_jpeg_slice_are_told(printed: Path, tmp_path: Path) -> None:
    folder = tmp_path / "a"
    shutil.copytree(printed, folder)
    file = folder / "slice_0007.png"
    whole = Image.open(printed / "slice_0007.png").convert("RGBA")
    before = lc.read_export(printed)

    def harmed(image: Image.Image | None, forced: str | None) -> None:
        if image is None:
            file.unlink()
        else:
            image.save(file)
        with pytest.raises(InputError, match=r"slice_0007\.png is (not the file that was exported|missing).*--force"):
            lc.read_export(folder)
        if forced is None:
            assert lc.read_export(folder, force=True).extinction.shape == before.extinction.shape
        else:
            with pytest.raises(InputError, match=forced):
                lc.read_export(folder, force=True)

    edited = whole.copy()
    edited.putpixel((3, 4), (250, 1, 2, 255))
    harmed(edited, None)
    harmed(None, None)
    harmed(whole.resize((40, 20)), "is 40 x 20 pixels, not 84 x 36: it was resized")
    whole.convert("RGB").save(tmp_path / "a.jpg", quality=60)
    harmed(Image.open(tmp_path / "a.jpg").convert("RGBA"), None)
    said = json.loads((folder / "slices.json").read_text())
    said["files"] = {name: digest for name, digest in said["files"].items() if name != file.name}
    (folder / "slices.json").write_text(json.dumps(said))  # of which somebody took the digest too
    with pytest.raises(InputError, match=r"has \d+ pixels of colours that are no material's: it was edited, or went"):
        lc.read_export(folder)
    file.write_bytes(b"no picture")
    with pytest.raises(InputError, match="is no picture, or is damaged"):
        lc.read_export(folder)
    (folder / "slices.json").unlink()
    with pytest.raises(InputError, match=r"has no slices\.json, which says what its colours are of"):
        lc.read_export(folder)


@pytest.mark.filterwarnings("ignore::lightcube.fabrication.resins.ConvertedCube")
def test_what_no_printer_prints_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    at, cube, dyes = tmp_path / "a", in_dyes(), some_dyes()
    six = Dyes(tuple("abcdef"), np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [0, 1, 1], [1, 0, 1]]) * 3.0)
    film = Dyes(("c", "m"), np.array([[2.0, 0.1, 0], [0.1, 2, 0.1]]), kind="ink")
    assert cube.amounts is not None
    none = cube.amounts
    many = np.concatenate([none, none]).astype(np.float32) / np.float32(2)
    of_six = replace(cube, amounts=many, dyes=six, extinction=six.mixed(many))
    refused: list[tuple[lc.Cube, dict[str, Any], str]] = [
        (a_cube(), {}, "was not solved in dyes: name the resins"),
        (of_six, {}, "7 materials with the clear one are more than the 6 that mode high-mix"),
        (cube, {"mode": "high-speed"}, "4 materials with the clear one are more than the 3 that mode high-speed"),
        (cube, {"resins": film}, "these are inks for films"),
        (in_dyes((2, 9, 9), 0.1), {}, "is 8 slices of 27 micrometres high, and a print has 30 to 9999"),
        (cube, {"resins": replace(dyes, label=np.full((3, 3), 9, np.uint8))}, "two materials have the same label"),
        (cube, {"flips": "w"}, "flips are axes, each of x, y and z once at most"),
        (cube, {"prefix": "a/b"}, "a prefix is up to 40 letters and digits"),
        (cube, {"seed": -1}, "a seed is a whole number from 0"),
        (cube, {"levels": 3}, "polyjet takes flips and mode and prefix and resins and seed, not levels"),
    ]
    for given, options, match in refused:
        with pytest.raises(InputError, match=match):
            lc.export(given, at, "polyjet", **options)
        assert list(tmp_path.iterdir()) == []
    with pytest.raises(InputError, match="the cube is clear all over"):
        lc.export(replace(cube, amounts=0 * none, extinction=dyes.mixed(0 * none)), at, "polyjet")
    assert list(tmp_path.iterdir()) == []


def test_a_resin_that_nothing_is_of_is_left_out(cube: lc.Cube, tmp_path: Path) -> None:
    assert cube.amounts is not None
    none = np.concatenate([cube.amounts[:2], 0 * cube.amounts[2:]])
    said = lc.export(replace(cube, amounts=none, extinction=some_dyes().mixed(none)), tmp_path / "a", "polyjet")
    assert [each["name"] for each in said["palette"]] == ["clear", "cyan", "magenta"]
    assert said["notes"][0] == "nothing of the cube is of yellow, which printers refuse: left out"
    assert lc.read_export(tmp_path / "a").extinction.max() > 1


def test_a_resin_of_which_no_droplet_comes_out_leaves_nothing_behind(
    cube: lc.Cube, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Droplets, "layer", lambda self, number: np.zeros(self.shape[1:], np.uint8))
    with pytest.raises(InputError, match="no droplet came out as cyan, which printers refuse"):
        lc.export(cube, tmp_path / "a", "polyjet")
    assert list(tmp_path.iterdir()) == []


def test_a_cube_of_free_colours_is_mixed_with_a_warning_and_new_lamps(tmp_path: Path) -> None:
    free = a_cube((8, 12, 14), 0.25)
    free = with_own_targets(replace(free, extinction=free.extinction * 2))
    with pytest.warns(ConvertedCube, match=r"[0-9.]+% of all extinction is out of their reach"):
        said = lc.export(free, tmp_path / "a", "polyjet", resins=some_dyes())
    found = said["predicted"]
    assert found["psnr_mean"] > found["psnr_mean_of_old_lamps"]
    assert 0 < said["conversion"]["out_of_reach_extinction"] < 1
    assert not np.array_equal(lc.read_export(tmp_path / "a").powers, free.powers)


def test_blocks_let_through_what_their_droplets_do() -> None:
    """Along the axes, on average; single droplets are just what they are, and more are never darker than their mean."""
    extinction = np.random.default_rng(0).random((3, 2, 6, 8)) ** 8 * 12
    one = Blocks.of((2, 6, 8), (0.1, 0.2, 0.15), 10**6)
    assert one.counts == (2, 12, 8)
    np.testing.assert_allclose(one.seen(extinction[:, :1]), extinction[:, 0].repeat(2, axis=1), atol=1e-12)
    long = Blocks.of((2, 6, 8), (0.1, 0.2, 0.05), 100)  # flat droplets are two to a block before they are side by side
    assert (long.each, long.counts, long.repeats) == ((2, 1, 1), (1, 12, 8), 2)
    assert long.seen(extinction).shape == (3, 12, 8)
    few = Blocks.of((2, 6, 8), (0.1, 0.2, 0.15), 40)
    assert few.each == (2, 1, 2)
    assert few.counts == (1, 6, 4)
    found = few.seen(extinction)
    assert np.all(found <= extinction.reshape(3, 2, 6, 1, 4, 2).mean(axis=(1, 3, 5)) + 1e-12)
    flat = np.full_like(extinction, 2.5)
    np.testing.assert_allclose(few.seen(flat), 2.5)
    lit = np.exp(-extinction.mean(axis=1) * 0.3).reshape(3, 6, 4, 2).mean(axis=3)  # from below
    assert np.all(found <= np.maximum(-np.log(lit) / 0.3, found))
