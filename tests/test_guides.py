"""Tutorials, how-tos and lessons do what they say: followed from top to bottom, in one folder, with smaller cubes."""

import os
import re
import shlex
import shutil
from pathlib import Path
from runpy import run_path
from typing import Any

import numpy as np
import pytest
import typer.core
from PIL import Image

import lightcube as lc
from lightcube.cli.main import application
from lightcube.optics.transfer import to_uint8
from lightcube.pictures.samples import photographs
from tests.helpers.browser import opened
from tests.test_docs import APART, PAGES, ROOT

FOLLOWER, SLIDES = (run_path(str(ROOT / "examples" / f"{name}.py")) for name in ("guides", "slides"))
fences, follow, slides = FOLLOWER["fences"], FOLLOWER["follow"], SLIDES["slides"]
GUIDES = [page for page in PAGES if page not in APART]
LESSONS = sorted((ROOT / "docs" / "teach").glob("[0-9]*.md"))
INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT", "0") != "0"
#: How many voxels each command takes here: a second's work.
VOXELS = {"solve": 16, "check": 16, "hull": 32}


def small(line: str) -> str:
    """The same command for a cube that is solved in a second, and a movie of few pictures."""
    verb = line.split()[1]
    if "--films" in line:
        return re.sub(r"--assembly-mm \S+", "", line) + " --n 12 --iterations 4 --size-mm 60"
    if verb in VOXELS and ".toml" not in line:
        line = re.sub(r" --n \d+", "", line) + f" --n {VOXELS[verb]}"
    return line + " --fps 1" if verb == "play" and ".mp4" in line else line


def smaller(text: str) -> str:
    """The same file, of smaller cubes."""
    return text.replace("[64, 64, 64]", "[12, 12, 12]")


@pytest.fixture(scope="module")
def at_hand(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a how-to begins with, as its index says: photographs, three shapes, a film, and a cube."""
    folder = tmp_path_factory.mktemp("at-hand")
    (folder / "photos").mkdir()
    for image, name in zip(photographs(4).images, "abcd", strict=True):
        Image.fromarray(to_uint8(image[:90, :120])).save(folder / "photos" / f"{name}.png")
    for name, side in (("front", 20), ("side", 24), ("top", 28)):
        Image.fromarray(np.pad(np.zeros((side, side), np.uint8), 8, constant_values=255)).save(folder / f"{name}.png")
    plan = lc.plan(lc.read_pictures(folder / "photos"), 16)
    cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
    lc.save(cube, folder / "cube.zarr")
    film = to_uint8(lc.play(cube, np.arange(0, 96, 4), picture_only=True))
    lc.save(np.kron(film, np.ones((1, 4, 4, 1), np.uint8)), folder / "film.mp4", fps=12)
    return folder


@pytest.mark.skipif(INTERPRETED, reason="interpreted, it takes minutes")
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("page", GUIDES, ids=lambda page: f"{page.parent.name}-{page.stem}")
def test_a_guide_does_what_it_says(at_hand: Path, page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if page.stem == "film-stack":
        pytest.importorskip("reportlab")
    if page.parent.name == "how-to":
        shutil.copytree(at_hand, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    follow(page, small, smaller)


def test_every_program_that_makes_figures_is_named() -> None:
    page = (ROOT / "docs" / "how-to" / "reproduce-tables.md").read_text()
    for folder in ("benchmarks", "examples"):
        for program in (ROOT / folder).glob("*.py"):
            assert f"{folder}/{program.name}`" in page or f"{folder}.{program.stem}`" in page, program


@pytest.mark.parametrize("page", PAGES, ids=lambda page: f"{page.parent.name}-{page.stem}")
def test_every_command_of_a_page_is_understood(page: Path) -> None:
    for language, text in fences(page):
        if language not in ("", "bash", "sh", "console", "text"):
            continue
        for line in text.replace("\\\n", " ").splitlines():
            if line.startswith("lightcube "):
                understood(shlex.split(line, comments=True)[1:])


def understood(words: list[str]) -> None:
    """Nothing runs: the command is there, and takes these options and arguments."""
    group = typer.main.get_command(application(words))
    assert isinstance(group, typer.core.TyperGroup)
    group.commands[words[0]].make_context(words[0], list(words[1:])).close()


def shown_for(lesson: Path) -> Path:
    return lesson.parent / "slides" / f"{lesson.name[0]}.md"


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.stem)
def test_slides_are_one_file_that_asks_no_network(lesson: Path) -> None:
    source = shown_for(lesson)
    made, pictures = slides(source), source.read_text().count("![")
    assert made.count("<section>") == source.read_text().count("\n---\n") + 1
    assert made.count('src="data:image/') == made.count("src=") == pictures
    assert not re.search(r"https?://|@import|url\(", made)


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.stem)
def test_numbers_on_slides_are_those_of_the_lesson(lesson: Path) -> None:
    """What has a point or two figures: lessons compute theirs, slides repeat them."""

    def numbers(page: Path) -> set[str]:
        return set(re.findall(r"\d+[.,][\d.,]*\d|\d\d+", page.read_text()))

    assert numbers(shown_for(lesson)) <= numbers(lesson)


def test_slides_turn_by_keys(browser: Any, tmp_path: Path) -> None:
    (tmp_path / "1.html").write_text(slides(shown_for(LESSONS[0])))
    tab, errors = opened(browser, tmp_path / "1.html")
    said = []
    for key in ("ArrowRight", "ArrowLeft", "End", " ", "Home"):
        tab.keyboard.press(key)
        said.append(tab.evaluate("[...document.querySelectorAll('section')].findIndex(s => s.offsetHeight > 0)"))
    assert (said, errors) == ([1, 0, 7, 7, 0], [])


def test_every_lesson_has_slides_a_worksheet_and_answers() -> None:
    for lesson in LESSONS:
        sheets = lesson.parent / "worksheets"
        asked = re.findall(r"^(\d+)\. ", (sheets / f"{lesson.name[0]}.md").read_text(), re.MULTILINE)
        answered = re.findall(r"\*\*(\d+)\.\*\*", (sheets / f"{lesson.name[0]}-answers.md").read_text())
        assert shown_for(lesson).exists()
        assert asked == answered == [str(number + 1) for number in range(len(asked))]
