"""Shapes as folders: what is damaged, of another kind or newer is one sentence, and nothing of the kind is opened."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr

import lightcube as lc
from lightcube.errors import InputError
from lightcube.io import Output, read_shape, save
from lightcube.io.shapes import is_shape_folder
from lightcube.solids.shape import is_opaque
from tests.laws.test_writer import a_cube, a_shape


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return save(a_shape(0, ".shape.zarr"), tmp_path / "a.shape.zarr")


def changed(folder: Path, change: Callable[[dict[str, Any]], Any]) -> None:
    """Change what a shape's file says of itself."""
    file = folder / "zarr.json"
    document = json.loads(file.read_text())
    change(document["attributes"]["lightcube"])
    file.write_text(json.dumps(document))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda said: said.update(format_version=2), "in format 2 of a newer lightcube, and this one reads up to 1"),
        (lambda said: said.update(format_version=0), r"damaged shape \(format_version: "),
        (lambda said: said.update(kind="cube"), "is no shape: give a folder that lightcube hull wrote"),
        (lambda said: said.update(voxel_mm=-1.0), r"damaged shape \(voxel_mm: "),
        (lambda said: said.update(voxel_mm="wide"), r"damaged shape \(voxel_mm: "),
        (lambda said: said.update(more=1), r"damaged shape \(more: "),
        (lambda said: said.pop("rig"), r"damaged shape \(rig: "),
        (lambda said: said["names"].pop(), "damaged shape .*give one name each"),
        (lambda said: said["rig"]["views"]["lamps"].pop(), "damaged shape"),
        (lambda said: said["rig"]["views"].update(picture_shape=[4, 4]), "damaged shape .*silhouettes of"),
        (lambda said: said.clear(), "is no shape"),
    ],
)
def test_what_a_shape_cannot_say_is_one_sentence(folder: Path, change: Callable[[Any], Any], said: str) -> None:
    changed(folder, change)
    with pytest.raises(InputError, match=f"^[^\n]*{said}[^\n]*$"):
        read_shape(folder)


@pytest.mark.parametrize(
    ("name", "values", "said"),
    [
        ("0", np.arange(1287, dtype=np.float32).reshape(1, 9, 11, 13), "zeros, NaN or infinities"),
        ("0", np.ones((1, 9, 11, 13), np.float32), "nothing casts shadows"),
        ("0", np.full((1, 9, 11, 13), np.nan, np.float32), "zeros, NaN or infinities"),
        ("0", -np.ones((2, 9, 11, 13), np.float32), "not float32 of one channel"),
        ("0", -np.ones((1, 9, 11, 13)), "not float32 of one channel"),
        ("0", -np.ones((9, 11, 13), np.float32), "not an array with 4 axes"),
        ("silhouettes", np.full((2, 12, 20, 1), 2, np.uint8), "not zeros and ones of uint8"),
        ("silhouettes", np.ones((2, 12, 20, 1), np.int16), "not zeros and ones of uint8"),
        ("silhouettes", np.ones((2, 12, 21, 1), np.uint8), "silhouettes of"),
        ("silhouettes", np.repeat(np.array([1, 0], np.uint8), 240).reshape(2, 12, 20, 1), "is on its screen"),
        ("silhouettes", None, "silhouettes are missing"),
    ],
)
def test_arrays_that_are_none_of_a_shape_are_one_sentence(folder: Path, name: str, values: Any, said: str) -> None:
    shutil.rmtree(folder / name)
    if values is not None:
        zarr.create_array(str(folder / name), data=values)
    with pytest.raises(InputError, match=f"^[^\n]*damaged shape [^\n]*{said}[^\n]*$"):
        read_shape(folder)


def test_a_part_that_is_lost_is_told(folder: Path) -> None:
    chunk = next(file for file in sorted((folder / "0").rglob("*")) if file.is_file() and file.name != "zarr.json")
    chunk.unlink()
    with pytest.raises(InputError, match=r"damaged shape .*parts of its array '0' are missing"):
        read_shape(folder)


def test_cubes_and_shapes_are_not_taken_for_each_other(tmp_path: Path, folder: Path) -> None:
    cube = save(a_cube(0, ""), tmp_path / "b.zarr")
    shutil.copytree(cube, tmp_path / "b.shape.zarr")
    with pytest.raises(InputError, match="is no shape: give a folder that lightcube hull wrote"):
        read_shape(tmp_path / "b.shape.zarr")
    shutil.copytree(folder, tmp_path / "c.zarr")
    with pytest.raises(InputError, match=r"is a shape, no cube: let its name end with \.shape\.zarr"):
        lc.load(tmp_path / "c.zarr")
    assert is_opaque(lc.load(folder))
    with pytest.raises(InputError, match="has no suffix that a shape can have"):
        read_shape(cube)
    assert is_shape_folder(folder)
    assert not is_shape_folder(cube)
    with pytest.raises(InputError, match="is a folder of something else and is not overwritten"):
        Output(folder, "cube", overwrite=True).check()
    with pytest.raises(InputError, match="there is no folder"):
        read_shape(tmp_path / "none.shape.zarr")
