"""What states more than it holds, and what is no file: one sentence, little memory, and nothing is left behind."""

import json
import subprocess
import sys
import threading
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr
from PIL import Image
from zarr.codecs import BloscCodec, GzipCodec, ZstdCodec

import lightcube as lc
from lightcube.errors import InputError
from lightcube.io import read_pictures
from tests.hostile.bombs import CUBE, all_bombs

#: More than it takes to refuse what is not bounded, in megabytes.
MOST_MB = 500


@pytest.fixture(scope="module")
def said(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Any]]:
    """What each comes to, given to the first of the commands that would read it."""
    folder = tmp_path_factory.mktemp("bombs")
    done = subprocess.run(
        [sys.executable, "-m", "tests.hostile.bombs", str(folder / "all"), "first"], capture_output=True, text=True
    )
    assert not done.returncode, done.stderr
    return {found["name"]: found for found in map(json.loads, done.stdout.splitlines())}


@pytest.mark.parametrize("name", all_bombs())
def test_one_sentence_and_little_memory(name: str, said: dict[str, dict[str, Any]]) -> None:
    found = said[name]
    text = found["said"]
    assert found["code"] == 2, found
    assert text.startswith("lightcube: "), text
    assert len(text.splitlines()) == 1, text
    assert "Traceback" not in text
    assert not found["left"]
    assert found["megabytes"] <= MOST_MB


@pytest.mark.parametrize("suffix", [".png", ".tif", ".webp", ".jpg", ".gif"])
def test_all_that_fits_is_still_read(suffix: str, tmp_path: Path) -> None:
    """Pictures that are as small in the file as they can be for their size: of one colour, or of none."""
    path = tmp_path / f"x{suffix}"
    Image.new("RGB", (2000, 2000), (255, 255, 255)).save(path)
    (image,) = read_pictures(path, least=1).images
    assert image.shape == (2000, 2000, 3)
    assert image.min() > 0.99


@pytest.mark.parametrize("bits", [np.uint8, np.uint16])
@pytest.mark.parametrize("packed", ["zlib", "lzma", None])
def test_pages_that_unpack_to_what_they_state_are_read(bits: type, packed: str | None, tmp_path: Path) -> None:
    tifffile = pytest.importorskip("tifffile")
    full: Any = np.full((300, 500, 3), np.iinfo(bits).max, bits)
    tifffile.imwrite(tmp_path / "x.tif", full, compression=packed, photometric="rgb", rowsperstrip=7)
    (image,) = read_pictures(tmp_path / "x.tif", least=1).images
    assert image.min() > 0.99


@pytest.mark.parametrize(
    "packers", [[ZstdCodec()], [GzipCodec()], [BloscCodec(typesize=4)], None, [GzipCodec(), ZstdCodec()]]
)
def test_cubes_that_others_pack_anew_are_read_or_refused(packers: Any, tmp_path: Path) -> None:
    path = lc.save(CUBE, tmp_path / "x.zarr")
    group = zarr.open_group(path, mode="a")
    del group["0"]
    group.create_array("0", data=CUBE.extinction, chunks=(1, 2, 5, 6), compressors=packers)
    if packers and len(packers) > 1:
        with pytest.raises(InputError, match="GzipCodec, ZstdCodec, which is not read"):
            lc.load(path)
    else:
        assert np.array_equal(lc.load(path).extinction, CUBE.extinction)


def test_readers_in_many_threads_leave_nothing_set(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pillow's limit and the warnings' filters are the program's: the last reader puts back what the first found."""
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 100)
    Image.new("RGB", (40, 50)).save(tmp_path / "x.png")
    filters = list(warnings.filters)
    wrong: list[BaseException] = []

    def read() -> None:
        try:
            for _ in range(40):
                read_pictures(tmp_path / "x.png", least=1)
        except BaseException as error:
            wrong.append(error)

    threads = [threading.Thread(target=read) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong
    assert Image.MAX_IMAGE_PIXELS == 100
    assert list(warnings.filters) == filters
