"""Names that are no UTF-8, move a terminal's cursor or turn its letters round, in all places where names are given."""

import json
import os
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import lightcube as lc
from lightcube.cli.main import run
from lightcube.io import read_pictures
from tests.hostile.bombs import CUBE

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="other systems take no names that are no text")
NAMES = [os.fsdecode(b"\xff\xfe"), "\x1b[31m", "\u202etxt.", "a\tb\rc", "\u2066\u200f\u200b", "-n '$(x)\""]
RAW = ("\x1b", "\u202e", "\r", "\u2066", "\u200b", "\udcff")


@pytest.fixture(params=NAMES, ids=ascii)
def folder(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A folder of such a name, in which there are a cube and a folder of pictures of such names."""
    made = tmp_path / request.param
    pictures = made / f"{request.param}pictures"
    pictures.mkdir(parents=True)
    for number in range(2):
        Image.new("RGB", (4, 4), (90 * number, 9, 9)).save(pictures / f"{number}{request.param}.png")
    (pictures / f"{request.param}.txt").touch()
    lc.save(CUBE, made / f"{request.param}.zarr")
    return made


def test_every_verb_reads_and_writes_them(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name = folder.name
    cube, pictures = str(folder / f"{name}.zarr"), str(folder / f"{name}pictures")
    for words in (
        ["info", cube],
        ["info", "--json", cube],
        ["play", cube, "-o", str(folder / f"{name}.gif"), "--stops"],
        ["play", cube, "-o", str(folder / f"{name}.mp4"), "--stops"],
        ["view", cube, "-o", str(folder / f"{name}.html")],
        ["draw", cube, "-o", str(folder / f"{name}.png")],
        ["score", cube, pictures],
        ["score", "--json", cube, pictures],
        ["report", cube, pictures, "-o", str(folder / f"{name}r.html")],
    ):
        assert run(words) == 0, words
        said = "".join(capsys.readouterr())
        assert not any(raw in said for raw in RAW), said
        if "--json" in words:
            json.loads(said[said.index("{") :].split("\nnote")[0])
    for page in (f"{name}.html", f"{name}r.html"):
        (folder / page).read_bytes().decode()


def test_every_sentence_and_note_shows_them_escaped(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    gone = str(folder / f"gone{folder.name}")
    for words in (
        ["check", gone],
        ["solve", gone, "-o", f"{gone}.zarr"],
        ["info", f"{gone}.zarr"],
        ["publish", f"{gone}.zarr.partial"],
        ["trace", f"{gone}.toml", "-o", f"{gone}x"],
        ["play", str(folder / f"{folder.name}.zarr"), "-o", f"{gone}/x.gif"],
        ["solve", str(folder / f"{folder.name}pictures"), "-o", f"{gone}/x.zarr", "--n", "4"],
    ):
        assert run(words) == 2, words
        said = capsys.readouterr().err
        assert said.splitlines()[-1].startswith("lightcube: ")
        assert not any(raw in said for raw in RAW), said


@pytest.mark.filterwarnings("ignore:.*was left out")
def test_names_of_pictures_can_be_written_again(folder: Path, tmp_path: Path) -> None:
    pictures = read_pictures(folder / f"{folder.name}pictures")
    cube = lc.Cube(np.ones((3, 4, 5, 6), np.float32), CUBE.grid, CUBE.rig, names=pictures.names)
    for suffix in (".zarr", ".npz", ".zarr.zip"):
        assert lc.load(lc.save(cube, tmp_path / f"x{suffix}")).names == pictures.names
