"""Cubes that earlier versions wrote (files/README.md): what they say is read as the newest format says it."""

import json
import math
import shutil
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from lightcube import load, save, score
from lightcube.backward.recipe import recipe_of
from lightcube.errors import InputError
from lightcube.io import _metadata, _older
from lightcube.optics.light import Light
from lightcube.optics.material import Material
from lightcube.optics.setups import turntable
from tests.cli.test_cli import run
from tests.helpers import thin, wall
from tests.io.test_cubes import assert_same, change, put

__all__ = ["run"]

FILES = Path(__file__).parent / "files"
BLACK, ANY = 0.5 / 255, Material()
THREE = (10.0, 100.0, 250.0)
EVEN = (40.0, 160.0, 280.0)
#: The stage's lamps: light along (0.9, 0.35, -0.4), and a bulb at (-20, 1, 2) mm, whose place counts as a direction.
AMBER, BULB = (math.degrees(math.atan2(-z, math.hypot(x, y))) for x, y, z in ((0.9, 0.35, -0.4), (-20, 1, 2)))


class Told(NamedTuple):
    """What is known of a file beside its arrays."""

    file: str
    angles_deg: tuple[float, ...]
    elevations_deg: tuple[float, ...]
    picture_shape: tuple[int, int]
    names: tuple[str, ...] = ("ant", "bee", "cat")
    least: tuple[float, ...] = (1e-4,)
    most: tuple[float, ...] = (16.0,)
    black: tuple[float, ...] = (BLACK,)
    hold_deg: float = 0.0
    powers: str = "per-picture"
    material: Material = ANY

    @property
    def path(self) -> Path:
        return FILES / self.file

    @property
    def stem(self) -> str:
        return self.file.split(".")[0]


FIRST = Told(*("format-1-first.zarr.zip", EVEN, (20.0,) * 3, (5, 5)), least=(1.5,), most=(1.5,), material=Material(0.5))
LAMPS = Told(
    *("format-1-lamps.zarr.zip", THREE, (20.0,) * 3, (3, 3)), most=(8.0,), black=(0.05,), hold_deg=1.0, powers="shared"
)
LAST = Told(
    *("format-1-last.npz", (20.0, 80.0, 140.0), (0.0,) * 3, (3, 3), ("cat", "ant", "bee")),
    hold_deg=0.5,
    powers="shared",
)
STAGE = Told(
    *("format-2.zarr.zip", EVEN, (AMBER, BULB, BULB, AMBER), (4, 6)),
    least=(1e-4, 2.0),
    most=(16.0, 2.0),
    black=(0.05, 0.05),
)
THIRD = Told("format-3.zarr.zip", THREE, (30.0,) * 3, (3, 3), most=(8.0,), black=(0.05,))
THIN = Told("format-4-thin.zarr.zip", THREE, (20.0,) * 3, (3, 3), material=Material(0.5))
AREA = Told("format-4.zarr.zip", THREE, (20.0,) * 3, (3, 3), material=Material(3.0, "voxel"))
ALL = (FIRST, LAMPS, LAST, STAGE, THIRD, THIN, AREA)


def numbers(shape: tuple[int, ...], factor: int, modulus: int) -> Any:
    return (factor * np.arange(np.prod(shape)).reshape(shape)) % modulus


def each(*told: Told) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("told", told, ids=lambda one: one.stem)


@each(*ALL)
def test_every_number_is_as_it_was_written(told: Told) -> None:
    cube = load(told.path)
    np.testing.assert_array_equal(cube.extinction, numbers((3, 3, 5, 7), 37, 101) / 256)
    pairs = 4 if told is STAGE else 3
    np.testing.assert_array_equal(cube.powers, 0.5 + numbers((pairs, 3), 11, 13) / 8)
    levels = numbers((3, *told.picture_shape, 4), 29, 256)
    levels[..., -1] = 255
    levels[:, 0, 0, -1] = 0
    assert cube.targets is not None
    np.testing.assert_array_equal(cube.targets / 65535, levels / 255)
    assert cube.grid.voxel_mm == 1
    np.testing.assert_array_equal(cube.angles_deg, told.angles_deg)
    np.testing.assert_allclose(cube.rig.views.elevations_deg, told.elevations_deg, rtol=0, atol=1e-9)
    assert cube.rig.picture_shape == told.picture_shape
    assert cube.names == told.names
    assert (cube.transfer, cube.status, cube.hold_deg) == ("srgb", "complete", told.hold_deg)
    for found, wanted in zip(
        (cube.rig.lamps.least, cube.rig.lamps.most, cube.rig.screens.black),
        (told.least, told.most, told.black),
        strict=True,
    ):
        np.testing.assert_array_equal(found, wanted)


@each(*ALL)
def test_it_casts_what_the_program_cast_that_wrote_it(told: Told) -> None:
    with np.load(FILES / "shown.npz") as shown:
        wanted = shown[told.stem]
    play = wall.play if told is AREA else thin.play
    np.testing.assert_allclose(play(load(told.path)), wanted, rtol=1e-5)


@each(FIRST, LAMPS, LAST, THIRD, THIN, AREA)
def test_a_turntable_is_that_of_today_bit_for_bit(told: Told) -> None:
    cube = load(told.path)
    rig = turntable(
        cube.grid,
        told.angles_deg,
        elevation_deg=told.elevations_deg[0],
        picture_shape=told.picture_shape,
        power=1.5 if told is FIRST else None,
        power_max=told.most[0],
        black=told.black[0],
    )
    assert_same(cube.rig, rig)


@each(*ALL)
def test_what_is_not_said_is_as_it_was(told: Told) -> None:
    cube = load(told.path)
    recipe = recipe_of(cube)
    assert (recipe.solver.name, recipe.powers, recipe.bounded_by) == ("display", told.powers, told.material)
    assert recipe.hold_deg == told.hold_deg
    if told is AREA:
        assert recipe.light == Light(13, 7)
        assert recipe.mat is not None
        assert {"psnr_mean", "thin_psnr_mean", "pictures"} < set(cube.scores)
        assert "predicted" in cube.provenance
    else:
        assert recipe.light == Light.thin()
        assert recipe.mat is None
        assert set(cube.scores) == {"thin_psnr_mean", "thin_psnr_min"}
        assert not {"predicted", "lamp", "lamp_power", "lamp_max", "black", "angles_per_view"} & set(cube.provenance)


@each(*ALL)
def test_play_and_score_take_it_as_any_cube(run: Any, tmp_path: Path, told: Told) -> None:
    assert run("play", told.path, "--stops", "--picture-only", "-o", tmp_path / "a.npy").code == 0
    shown = np.load(tmp_path / "a.npy")
    np.testing.assert_array_equal(shown, wall.play(load(told.path)))
    found = run("score", told.path, "--json")
    assert found.code == 0
    assert json.loads(found.out)["psnr_mean"] == pytest.approx(score(load(told.path))["psnr_mean"])
    assert run("info", told.path).code == 0


@each(FIRST, STAGE, AREA)
def test_it_is_written_in_the_newest_format(tmp_path: Path, told: Told) -> None:
    cube = load(told.path)
    path = save(cube, tmp_path / "a.zarr")
    document = json.loads((path / "zarr.json").read_text())["attributes"]["lightcube"]
    assert document["format_version"] == _metadata.FORMAT_VERSION
    assert _older.newest(document, cube.targets) == (document, cube.targets)
    assert_same(load(path), cube)


@each(FIRST, THIRD)
def test_a_folder_is_read_as_its_archive_is(tmp_path: Path, told: Told) -> None:
    with zipfile.ZipFile(told.path) as archive:
        archive.extractall(tmp_path / "a.zarr")
    assert_same(load(tmp_path / "a.zarr"), load(told.path))


def test_methods_other_than_display_had_a_lamp_of_power_1(tmp_path: Path) -> None:
    path = Path(shutil.copy(LAST.path, tmp_path / "a.npz"))
    change(path, put("provenance", value={"method": "sirt"}))
    rig = load(path).rig
    assert (rig.lamps.least[0], rig.lamps.most[0]) == (1, 1)


@each(FIRST, STAGE, THIRD, THIN)
def test_nothing_of_an_older_document_is_changed(told: Told) -> None:
    with zipfile.ZipFile(told.path) as archive:
        document = json.loads(archive.read("zarr.json"))["attributes"]["lightcube"]
    before = json.dumps(document)
    _older.newest(document, None)
    assert json.dumps(document) == before


@pytest.mark.parametrize(
    ("told", "edit", "message"),
    [
        (LAST, lambda said: {"format_version": 1, "something": "else"}, "not as format 1 was"),
        (LAST, put("views", value=[]), "not as format 1 was"),
        (LAST, put("views", "lamps", value=[[1.0]]), "not as format 1 was"),
        (LAST, put("views", "row_steps", 0, value=[0, 0, 0]), "row_steps_mm of view 1 is 0"),
        (LAST, put("provenance", value=3), "not as format 1 was"),
        (LAST, put("provenance", "lamp", value=[]), "not as format 1 was"),
        (LAST, put("provenance", "black", value="dark"), "not as format 1 was"),
        (LAST, put("more", value=1), "more"),
        (STAGE, put("lighting", "more", value=1), "not as format 2 was.*lighting: more"),
        (STAGE, put("lighting", "share", value=[[-1.0]]), r"rig\.sums\.share"),
        (THIRD, put("rig", "stops", value=3), "not as format 3 was"),
        (THIN, put("scores", value=3), "not as format 4 was"),
        (AREA, put("format_version", value=5), "not those of uint16"),
    ],
)
def test_what_cannot_be_right_is_refused(tmp_path: Path, told: Told, edit: Any, message: str) -> None:
    path = Path(shutil.copy(told.path, tmp_path / told.file))
    change(path, edit)
    with pytest.raises(InputError, match=f"damaged light cube.*({message})") as caught:
        load(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_targets_of_another_kind_than_its_format_had_are_refused(tmp_path: Path) -> None:
    with np.load(LAST.path) as arrays:
        np.savez(tmp_path / "a.npz", **{**arrays, "targets": arrays["targets"].astype(np.uint16)})
    with pytest.raises(
        InputError, match=r"damaged light cube.*targets is an array of uint16, and its numbers are not those of uint8"
    ):
        load(tmp_path / "a.npz")


@pytest.mark.parametrize("told", [LAST, STAGE])
def test_pixels_that_were_cut_into_parts_are_refused(tmp_path: Path, told: Told) -> None:
    path = Path(shutil.copy(told.path, tmp_path / told.file))
    change(path, put("provenance", "pixel_samples", value=2))
    with pytest.raises(InputError, match=r"cut into parts.*make it again"):
        load(path)


def test_a_cube_of_today_may_remember_anything(tmp_path: Path) -> None:
    cube = replace(load(AREA.path), provenance={"pixel_samples": 2, "lamp": "global", "black": 0.5})
    assert_same(load(save(cube, tmp_path / "a.npz")), cube)
