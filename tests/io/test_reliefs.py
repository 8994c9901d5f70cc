"""Files of reliefs: what is refused, and told apart from cubes."""

import json
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube.errors import InputError
from lightcube.io import is_relief, read_relief, save
from lightcube.jobs.reading import load
from lightcube.solids.relief import Relief, ReliefRecipe
from tests.hostile.harm import harmed


@pytest.fixture
def kept(tmp_path: Path) -> Path:
    heights = np.random.default_rng(0).uniform(0, 3, (5, 6))
    relief = Relief(heights, np.full((1, 5, 6), 0.5), ReliefRecipe(black=0.4))
    return save(relief, tmp_path / "plate.relief.zarr")


def changed(kept: Path, **said: Any) -> None:
    """Write other words into the file's own document."""
    file = kept / "zarr.json"
    document = json.loads(file.read_text())
    document["attributes"]["lightcube"] |= said
    file.write_text(json.dumps(document))


def test_a_name_tells_a_relief(kept: Path) -> None:
    assert is_relief(kept)
    assert is_relief("s3://bucket/a.RELIEF.zarr")
    assert not is_relief("cube.zarr")


@pytest.mark.parametrize(
    ("said", "sentence"),
    [
        ({"recipe": {"side": 128}}, "is a damaged relief"),
        ({"recipe": None}, "is a damaged relief"),
        ({"names": ["a", "b"]}, "1 picture with 2 names"),
        ({"cell": 0}, "do not fit"),
        ({"relief_version": 99}, "of a newer lightcube"),
        ({"kind": "shape"}, "is no relief"),
    ],
)
def test_words_that_cannot_be_are_refused(kept: Path, said: dict[str, Any], sentence: str) -> None:
    changed(kept, **said)
    with pytest.raises(InputError, match=sentence):
        read_relief(kept)


def test_arrays_that_are_lost_or_cut_are_told(kept: Path) -> None:
    chunk = next(file for file in (kept / "heights").rglob("*") if file.is_file() and file.name != "zarr.json")
    chunk.write_bytes(chunk.read_bytes()[:-9])
    with pytest.raises(InputError, match=r"plate\.relief\.zarr is a damaged"):
        read_relief(kept)
    chunk.unlink()
    with pytest.raises(InputError, match="are missing"):
        read_relief(kept)


def test_what_is_no_relief_is_told(tmp_path: Path, kept: Path) -> None:
    with pytest.raises(InputError, match="there is no relief"):
        read_relief(tmp_path / "none.relief.zarr")
    with pytest.raises(InputError, match=r"cube.zarr is no relief: give a folder that ends with .relief.zarr"):
        read_relief("cube.zarr")
    with pytest.raises(InputError, match="is a relief, no cube: lightcube play, score and info take it"):
        load(kept)


@pytest.mark.parametrize("name", ["zarr.json", "heights/zarr.json", "heights/c/0/0"])
def test_what_was_harmed_is_read_as_something_sane_or_refused_in_one_sentence(kept: Path, name: str) -> None:
    honest, refused = (kept / name).read_bytes(), 0
    for number in range(60):
        (kept / name).write_bytes(harmed(random.Random(f"{name}-{number}"), honest))  # noqa: S311 - the same each time
        said = ""
        try:
            assert np.all(np.isfinite(read_relief(kept).heights_px))
        except InputError as error:
            said = str(error)
        assert said.isprintable()
        refused += bool(said)
    assert refused > 20


def test_no_other_folder_is_replaced(tmp_path: Path, kept: Path) -> None:
    relief = read_relief(kept)
    save(relief, kept, overwrite=True)
    other = tmp_path / "notes.relief.zarr"
    other.mkdir()
    (other / "diary.txt").write_text("dear")
    with pytest.raises(InputError, match="a folder of something else"):
        save(relief, other, overwrite=True)
    assert (other / "diary.txt").read_text() == "dear"
