"""The three kinds of TOML files have one reader: what it forgives, and what it says in one sentence."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from lightcube.errors import InputError
from lightcube.io import read_pictures, read_scene, read_stage
from lightcube.io._bounds import MOST_PICTURES
from lightcube.io._toml import read_tables

SCENE = """[camera]
type = "shadow"
cube_width = 3
[[shapes]]
type = "sphere"
radius = 1
colour = "#fff"
glass = 1
"""
STAGE = """lamp = [{ name = "sun", direction = [1, 0, 0] }]
screen = [{ name = "wall", centre_mm = [60, 0, 0], size_mm = [40, 40] }]
picture = [{ file = "0.png", screen = "wall" }]
[cube]
shape = [3, 3, 3]
"""
KINDS: dict[str, tuple[str, str, Callable[[Path], object]]] = {
    "views": ("span_deg = 90\n", "views.toml", lambda file: read_pictures(file.parent)),
    "scene": (SCENE, "ball.toml", read_scene),
    "stage": (STAGE, "room.toml", lambda file: read_stage(file)),
}


@pytest.fixture(params=KINDS)
def read(request: pytest.FixtureRequest, tmp_path: Path) -> Callable[[Callable[[str], bytes]], None]:
    """Writes a file of one of the kinds, changed, and reads it."""
    good, name, reader = KINDS[request.param]
    for i in range(2):
        Image.fromarray(np.full((3, 4, 3), 90 * i, np.uint8)).save(tmp_path / f"{i}.png")

    def write_and_read(change: Callable[[str], bytes]) -> None:
        (tmp_path / name).write_bytes(change(good))
        reader(tmp_path / name)

    return write_and_read


def test_a_byte_order_mark_and_lines_of_windows_do_no_harm(read: Callable[[Callable[[str], bytes]], None]) -> None:
    read(lambda good: ("\ufeff" + good).encode())
    read(lambda good: good.replace("\n", "\r\n").encode())


@pytest.mark.parametrize(
    ("begins", "said"),
    [
        (b"x = " + b"9" * 5000, "a number in it has thousands of digits"),
        (b"x = [1, -" + b"1_0" * 5000 + b"]", "a number in it has thousands of digits"),
        (b"x = " + b"[" * 5000, "nested too deep"),
        (b"x = " + b"{a=" * 5000, "nested too deep"),
        (b"a." * 150_000 + b"a = 1", "a key of it has more than 32 dots"),
        (b"[" + b"'a' . " * 150_000 + b"a]", "a key of it has more than 32 dots"),
        (b"x = { " + b'"a".' * 150_000 + b"a = 1}", "a key of it has more than 32 dots"),
        (b"#" * (2 << 20), "is larger than 1 MiB"),
        (b"x = [" + b"1," * 250_000 + b"]", "holds more values and keys"),
        (b"a.b.c.d.e.f.g.h = 1\n" * 30_000, "holds more values and keys"),
        (b"[[a]]\n" * 110_000, "holds more values and keys"),
        ("x = 1".encode("utf-16"), "line 1 is not in UTF-8, save it as UTF-8"),
        ("x = 1".encode("utf-16-le"), "save it as UTF-8"),
        (b"# a\n# \xff", "line 2 is not in UTF-8, save it as UTF-8"),
        (b"[[[", "is not a TOML file: "),
        (b"x = 1\nx = 2", "is not a TOML file: "),
        (b"'" + b"k" * 9999 + b"' = 1", "k...: no such key here"),
        (b'"a\\u001b[31m" = 1', r"'a\x1b[31m': no such key here"),
        (b"a = 0x" + b"f" * 5000, "a: no such key here"),
    ],
    ids=lambda value: str(value)[:20],
)
def test_what_is_wrong_is_one_short_sentence(
    read: Callable[[Callable[[str], bytes]], None], begins: bytes, said: str
) -> None:
    with pytest.raises(InputError) as caught:
        read(lambda good: begins + b"\n" + good.encode())
    assert said in str(caught.value)
    assert len(str(caught.value)) < 400
    assert str(caught.value).isprintable()


def test_a_file_of_as_many_pictures_as_there_can_be_is_read(tmp_path: Path) -> None:
    """Angles with all their digits and names of cameras; or a table for each picture of a stage."""
    file = tmp_path / "x.toml"
    angles = [360 / 7 * index for index in range(MOST_PICTURES)]
    file.write_text(f"angles_deg = {angles}\nnames = {[f'IMG_{index:05}.edited, 2' for index in range(MOST_PICTURES)]}")
    assert read_tables(file, "x")["angles_deg"] == angles
    shot = '[[picture]]\nfile = "photos/IMG_0001.jpeg"\nscreen = "wall"\nangle_deg = 12.25\nlamps = ["sun", "bulb"]\n'
    file.write_text(shot * MOST_PICTURES)
    assert len(read_tables(file, "x")["picture"]) == MOST_PICTURES
