"""Files of all kinds with bytes changed, lost or put in: they are read as something sane, or refused in one sentence.

``LIGHTCUBE_FUZZ`` says how many of each kind; `make fuzz` takes 2000. An input is made of its kind and number alone.
"""

import os
import random
import signal
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import lightcube as lc
from lightcube.errors import InputError
from lightcube.io import read_stage

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
STAGE = """
[cube]
shape = [6, 5, 7]
size_mm = 100
[[lamp]]
name = "lamp"
direction = [1, 0, -0.2]
[[screen]]
name = "wall"
centre_mm = [150, 0, -30]
size_mm = [75, 75]
[[picture]]
file = "one.png"
screen = "wall"
"""
VIEWS = 'angles_deg = [0.0, 40.5]\nelevation_deg = 35.0\nnames = ["one", "two é"]\n'
#: What sizes and counts are replaced by.
NUMBERS = (b"\xff\xff\xff\xff", b"\0\0\0\0", b"\x7f\xff\xff\xff", b"\0\0\0\1", b"1e999", b"nan", b"9" * 30)


def saved(suffix: str, folder: Path) -> bytes:
    """An honest file of a kind."""
    path = folder / f"honest{suffix}"
    if suffix in (".npz", ".zarr.zip"):
        lc.save(CUBE, path)
    elif suffix in (".tif", ".jpg"):
        Image.fromarray(np.uint8(255 * PICTURES[0])).save(path)
    elif suffix == ".png":
        lc.save(PICTURES[:1], path)
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


def harmed(chance: random.Random, honest: bytes) -> bytes:
    """The same file with one to twenty places changed, one in five of them cut short too."""
    data = bytearray(honest)
    for _ in range(chance.choice((1, 2, 5, 20))):
        at, length = chance.randrange(len(data)), chance.randrange(1, 20)
        how = chance.randrange(4)
        if how == 0:
            data[at] = chance.randrange(256)
        elif how == 1:
            number = chance.choice(NUMBERS)
            data[at : at + len(number)] = number
        elif how == 2 and len(data) > length:
            del data[at : at + length]
        else:
            data[at:at] = chance.randbytes(length)
    return bytes(data[: chance.randrange(1, len(data))] if chance.random() < 0.2 else data)


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
    **dict.fromkeys((".npz", ".zarr.zip"), look_at_a_cube),
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
        path.write_bytes(harmed(random.Random(f"{suffix}-{number}"), honest))  # noqa: S311 - the same each time
        said = sentence_of(READERS[suffix], path, f"{suffix} {number}")
        assert said.isprintable(), (suffix, number)  # on one line, and no terminal's cursor moves
        refused += bool(said)
        left = {found.name for found in folder.iterdir()} - {path.name, "1.png", "2.png", "one.png"}
        assert not left, (suffix, number)
    assert refused > COUNT / 10


def test_honest_files_are_read(tmp_path: Path) -> None:
    """So that it is the harm that is refused."""
    for suffix, reader in READERS.items():
        honest = saved(suffix, tmp_path)
        (tmp_path / suffix.strip(".")).mkdir()
        path = tmp_path / suffix.strip(".") / (suffix if suffix[0] != "." else f"x{suffix}")
        path.write_bytes(honest)
        reader(path)
