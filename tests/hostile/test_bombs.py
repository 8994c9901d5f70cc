"""What states more than it holds, and what is no file: one sentence, little memory, and nothing is left behind."""

import gzip
import json
import subprocess
import sys
import threading
import warnings
import zipfile
import zlib
from collections.abc import Iterator
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
from tests.hostile.bombs import CUBE, all_bombs, zip_of_blanks
from tests.hostile.pictures import blanks

#: More than it takes to refuse what is not bounded, in megabytes.
MOST_MB = 500


class Bomber:
    """The program of `tests.hostile.bombs`, which loads once what each of the commands needs."""

    def __init__(self, folder: Path) -> None:
        self._said = (folder / "said").open("w+")
        self._program = subprocess.Popen(
            [sys.executable, "-m", "tests.hostile.bombs", str(folder / "all"), "-"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._said,
            text=True,
        )

    def __call__(self, name: str) -> dict[str, Any]:
        """What a bomb comes to, given to the first of the commands that would read it."""
        assert self._program.stdin is not None
        assert self._program.stdout is not None
        self._program.stdin.write(f"{name}\n")
        self._program.stdin.flush()
        answer = self._program.stdout.readline()
        self._said.seek(0)
        assert answer, self._said.read()
        return dict(json.loads(answer))

    def finish(self) -> None:
        self._program.communicate()
        self._said.close()


@pytest.fixture(scope="module")
def bomber(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bomber]:
    made = Bomber(tmp_path_factory.mktemp("bombs"))
    yield made
    made.finish()


@pytest.mark.parametrize("name", all_bombs())
def test_one_sentence_and_little_memory(name: str, bomber: Bomber) -> None:
    found = bomber(name)
    text = found["said"]
    assert found["code"] == 2, found
    assert text.startswith("lightcube: "), text
    assert len(text.splitlines()) == 1, text
    assert "Traceback" not in text
    assert not found["left"]
    assert found["megabytes"] <= MOST_MB


def test_blanks_are_what_they_say() -> None:
    """Whoever unpacks them finds nothing wrong, but that it is much."""
    assert zlib.decompress(blanks(3_000_000)) == bytes(3_000_000)
    assert gzip.decompress(blanks(2_000_000, 31, b"ab")) == b"ab" + bytes(2_000_000)


def test_an_archive_of_blanks_is_whole(tmp_path: Path) -> None:
    with zipfile.ZipFile(zip_of_blanks(tmp_path / "x.zip", "b", 2_000_000, {"a": b"A"}, b"B")) as archive:
        assert archive.testzip() is None
        assert archive.read("b") == b"B" + bytes(2_000_000)


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
