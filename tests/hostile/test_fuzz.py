"""Files of all kinds with bytes changed, lost or put in: they are read as something sane, or refused in one sentence.

``LIGHTCUBE_FUZZ`` says how many of each kind; `make fuzz` takes 2000. An input is made of its kind and number alone.
Every other one is harmed inside one of its parts, whose checksum holds, so that the harm is looked at.
"""

import json
import os
import random
import signal
import warnings
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from numcodecs import GZip, Zstd
from PIL import Image

import lightcube as lc
from lightcube.errors import InputError
from lightcube.io import read_stage
from tests.hostile.documents import STAGE
from tests.hostile.harm import harmed, harmed_inside, zip_of

COUNT = int(os.environ.get("LIGHTCUBE_FUZZ", "50"))
#: No input may take longer, in seconds.
HANG_S = 60
PICTURES = np.random.default_rng(0).random((3, 12, 10, 3)).astype(np.float32)
GRID = lc.Grid((4, 5, 6))
CUBE = lc.Cube(
    np.random.default_rng(1).random((3, *GRID.shape)).astype(np.float32),
    GRID,
    lc.turntable(GRID, [0.0, 90.0, 200.0], elevation_deg=30, picture_shape=(4, 4)),
)
VIEWS = 'angles_deg = [0.0, 40.5]\nelevation_deg = 35.0\nnames = ["one", "two é"]\n'


def saved(suffix: str, folder: Path) -> bytes:
    """An honest file of a kind."""
    path = folder / f"honest{suffix}"
    if suffix in (".npz", ".zarr.zip"):
        lc.save(CUBE, path)
    elif suffix in (".tif", ".jpg"):
        Image.fromarray(np.uint8(255 * PICTURES[0])).save(path)
    elif suffix == ".png":
        lc.save(PICTURES[:1], path)
    elif suffix == "gzip.zarr.zip":
        return packed_by_gzip(saved(".zarr.zip", folder))
    elif suffix == "views.toml":
        return VIEWS.encode()
    elif suffix == "stage.toml":
        return STAGE.encode()
    elif suffix == "scene.toml":
        import lightcube.scene

        return (Path(lightcube.scene.__file__).parent / "library" / "juggler.toml").read_bytes()
    else:
        lc.save(PICTURES, path)
    return path.read_bytes()


def packed_by_gzip(archive: bytes) -> bytes:
    """The same cube in a zip archive, its array packed by gzip, as other programs may write it."""
    with zipfile.ZipFile(BytesIO(archive)) as opened:
        members = {name: opened.read(name) for name in opened.namelist()}
    array = json.loads(members["0/zarr.json"])
    array["codecs"][-1] = {"name": "gzip", "configuration": {"level": 5}}
    members["0/zarr.json"] = json.dumps(array).encode()
    for name in [name for name in members if name.startswith("0/c/")]:
        members[name] = GZip().encode(Zstd().decode(members[name]))
    return zip_of(members)


def look_at_pictures(path: Path) -> None:
    for image in lc.read_pictures(path, least=1).images:
        assert np.all((image >= 0) & (image <= 1.0001))


def look_at_a_folder(path: Path) -> None:
    for name in ("1.png", "2.png"):
        Image.fromarray(np.uint8(255 * PICTURES[0])).save(path.with_name(name))
    look_at_pictures(path.parent)


def look_at_a_stage(path: Path) -> None:
    Image.fromarray(np.uint8(255 * PICTURES[0])).save(path.with_name("one.png"))
    read_stage(path)


def look_at_a_cube(path: Path) -> None:
    cube = lc.load(path)
    assert np.all(np.isfinite(cube.extinction))
    if cube.extinction.size * len(cube.rig.views) * np.prod(cube.rig.picture_shape) < 1e6:
        assert np.all(np.isfinite(lc.play(cube, cube.angles_deg[:1])))


READERS: dict[str, Callable[[Path], object]] = {
    **dict.fromkeys((".png", ".jpg", ".tif", ".gif", ".webp", ".apng", ".mp4", ".webm"), look_at_pictures),
    **dict.fromkeys((".npz", ".zarr.zip", "gzip.zarr.zip"), look_at_a_cube),
    "views.toml": look_at_a_folder,
    "stage.toml": look_at_a_stage,
    "scene.toml": lc.read_scene,
}


@contextmanager
def no_hang() -> Iterator[None]:
    """Fail where something takes too long, also within Python code that never ends."""

    def stop(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(HANG_S)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def sentence_of(reader: Callable[[Path], object], path: Path, name: str) -> str:
    """What a reader says of a file that it refuses; nothing where it reads it."""
    try:
        with no_hang(), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            reader(path)
    except InputError as error:
        return str(error)
    except Exception as error:
        raise AssertionError(f"{name}: {type(error).__name__}: {error}") from error
    return ""


@pytest.mark.parametrize("suffix", READERS)
def test_what_was_harmed_is_read_as_something_sane_or_refused_in_one_sentence(suffix: str, tmp_path: Path) -> None:
    honest = saved(suffix, tmp_path)
    refused = 0
    for number in range(COUNT):
        folder = tmp_path / str(number)
        folder.mkdir()
        path = folder / (suffix if suffix[0] != "." else f"x{suffix}")
        harm = harmed_inside if number % 2 else harmed
        path.write_bytes(harm(random.Random(f"{suffix}-{number}"), honest))  # noqa: S311 - the same each time
        said = sentence_of(READERS[suffix], path, f"{suffix} {number}")
        assert said.isprintable(), (suffix, number)  # on one line, and no terminal's cursor moves
        refused += bool(said)
        left = {found.name for found in folder.iterdir()} - {path.name, "1.png", "2.png", "one.png"}
        assert not left, (suffix, number)
    assert refused > COUNT / 10


def test_honest_files_are_read(tmp_path: Path) -> None:
    """So that it is the harm that is refused."""
    for suffix, reader in READERS.items():
        folder = tmp_path / suffix.strip(".")
        folder.mkdir()
        path = folder / (suffix if suffix[0] != "." else f"x{suffix}")
        path.write_bytes(saved(suffix, folder))
        reader(path)
