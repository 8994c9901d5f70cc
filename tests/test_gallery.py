"""The gallery's scripts: each is told, shown, made once, and has a command that the command line takes."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from tests.test_guides import understood

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "docs" / "_ext"))

import tiles  # noqa: E402

NAMES = tiles.names()
#: Bytes that a thumbnail may take.
MOST_BYTES = 15_000


@pytest.mark.parametrize("name", NAMES)
def test_every_tile_says_what_it_is_and_has_a_command_that_the_command_line_takes(name: str) -> None:
    told = tiles.tile(name)
    assert 0 < len(told.title) <= 60
    assert told.told.endswith(".")
    lines = told.commands.splitlines()
    assert lines
    for line in lines:
        program, *words = shlex.split(line)
        assert program == "lightcube"
        understood(words)
        for path in re.findall(r"examples/\S+", line):
            assert (ROOT / path).exists(), path


def test_every_tile_has_a_small_thumbnail_and_there_is_no_other() -> None:
    assert {path.stem for path in tiles.KEPT.iterdir()} == set(NAMES)
    for path in tiles.KEPT.iterdir():
        with Image.open(path) as image:
            assert image.size == (480, 320), path
        assert path.stat().st_size <= MOST_BYTES, path


def test_the_gallery_shows_every_tile_once() -> None:
    page = (ROOT / "docs" / "gallery" / "index.md").read_text()
    shown = [name for block in re.findall(r"```\{tiles\}\n(.*?)```", page, re.DOTALL) for name in block.split()]
    assert sorted(shown) == NAMES


def test_a_tile_is_made_anew_only_when_what_decides_it_has_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scripts, read = tmp_path / "scripts", tmp_path / "read"
    for folder in (scripts, read):
        folder.mkdir()
    for name, place in {"SCRIPTS": scripts, "MADE": tmp_path / "made", "READ": (read,)}.items():
        monkeypatch.setattr(tiles, name, place)
    (scripts / "tile.py").write_text("")
    counting = "import pathlib, sys\nplace = pathlib.Path(sys.argv[1])\n"
    counting += f"open({str(tmp_path / 'runs')!r}, 'a').write('x')\n(place / 'page.html').write_text('alive')\n"
    (scripts / "one.py").write_text(counting)
    runs = [1]

    def check(more: int) -> None:
        runs[0] += more
        assert (tiles.make("one") / "page.html").read_text() == "alive"
        assert len((tmp_path / "runs").read_text()) == runs[0]

    check(0)
    check(0)  # nothing has changed
    (scripts / "one.py").write_text(counting + "# other words\n")
    check(1)
    (scripts / "tile.py").write_text("# what is shared\n")
    check(1)
    (read / "stage.toml").write_text("# what is read\n")
    check(1)
    check(0)
    (scripts / "one.py").write_text(counting + "raise SystemExit('no lamp')\n")
    for _ in range(2):  # what failed is not taken for made
        with pytest.raises(RuntimeError, match=r"one\.py of the gallery failed: no lamp"):
            tiles.make("one")


def test_the_papers_cube_makes_a_page_and_comes_back_exactly(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="letters are drawn with lightcube[plot]")
    script = tiles.SCRIPTS / "paper_cube.py"
    done = subprocess.run([sys.executable, script, tmp_path], capture_output=True, text=True, check=True)
    assert float(done.stdout.split()[-1]) < 1e-6
    assert {path.name for path in tmp_path.iterdir()} == {"page.html", "thumbnail.webp", "told.json"}
    assert "<!doctype html>" in (tmp_path / "page.html").read_text()
