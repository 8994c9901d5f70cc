"""The site's reference has every name, option, key and sentence; a page of it asks nothing of a network."""

import re
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import commands
import names
import numpy as np
import pytest
import schemas
import sentences
import stored
from marked import plain

import lightcube as lc
from lightcube.cli import main
from lightcube.io import _metadata, _older, _relief_json, _shape_json
from tests.cli.test_cli import run

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
#: Files of each kind, written by hand: all their keys are to be found.
WRITTEN = {
    "stage": sorted((ROOT / "examples" / "stages").glob("*.toml")),
    "films": sorted((ROOT / "examples" / "films").glob("*.toml")),
    "scene": sorted((ROOT / "src" / "lightcube" / "scene" / "library").glob("*.toml")),
    "material": sorted((ROOT / "src" / "lightcube" / "materials").glob("*.toml")),
}
#: What is by name in these files, so that its keys are anyone's.
NAMED = {"ink", "groups"}

__all__ = ["run"]


def test_every_public_name_stands_in_one_room_with_a_purpose() -> None:
    by_room = names.rooms()
    assert sorted(name for room in by_room.values() for name in room) == sorted(lc.__all__)
    assert set(by_room) <= set(names.purposes())
    pages = names.pages()
    for room, of_room in by_room.items():
        entries = re.findall(r"^\.\. auto\w+:: (\w+)$", pages[f"python/{room}.md"], re.MULTILINE)
        assert entries == of_room
        for name in of_room:
            assert f"`~lightcube.{name}`" in pages["python.txt"]


@pytest.mark.parametrize("name", main.COMMANDS)
def test_a_commands_page_has_what_its_help_has(name: str, run: Any) -> None:
    said = run(name, "--help").out
    options = set(re.findall(r"^  (?:-\w, )?(--[\w-]+)", said, re.MULTILINE)) - {"--help"}
    page = commands.page(name)
    assert options == set(re.findall(r"^:::\{option\} .*?(--[\w-]+)", page, re.MULTILINE))
    for typed in re.findall(r"^  (lightcube .*)$", said, re.MULTILINE):
        assert typed in page
    assert f"[{name}]" in commands.pages()["commands.txt"]


def keys(value: Any) -> Iterator[str]:
    """Every key of a TOML file, at any depth."""
    if isinstance(value, dict):
        for key, each in value.items():
            yield key
            yield from keys(list(each.values()) if key in NAMED else each)
    elif isinstance(value, list):
        for each in value:
            yield from keys(each)


@cache
def page_of(kind: str) -> str:
    """The page of a kind of file."""
    return schemas.page(next(each for each in schemas.FILES if each.name == kind))


@pytest.mark.parametrize(("kind", "file"), [(kind, file) for kind, files in WRITTEN.items() for file in files])
def test_keys_of_files_are_on_their_page(kind: str, file: Path) -> None:
    page = page_of(kind)
    found = set(keys(tomllib.loads(file.read_text())))
    assert found
    assert {key for key in found if f"| `{key}` |" not in page} == set()


@pytest.mark.parametrize("kind", ["cube", "shape"])
def test_what_stands_beside_arrays_is_on_the_page_as_the_model_has_it(kind: str) -> None:
    arrays = "\n".join(stored.arrays(kind))
    written = set(re.findall(r"`(\w+)`", arrays.split("has the keys")[1]))
    page = page_of(kind)
    assert written == {key for key in written if f"| `{key}` |" in page}
    assert "`0` | `(c, z, y, x)` | `float32`" in arrays


@cache
def listed() -> list[str]:
    """Every sentence that the page has."""
    return [each for room in sentences.by_room().values() for each in room]


def as_pattern(sentence: str) -> str:
    """What a sentence of the page stands for."""
    return "".join(".*" if part.startswith("‹") else re.escape(part) for part in re.split(r"(‹[^›]*›)", sentence))


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: lc.Grid((0, 1, 1)),
        lambda: lc.read_scene("nobody"),
        lambda: lc.spread_angles(0),
        lambda: lc.load("nowhere.zarr"),
        lambda: lc.Cube(np.full((3, 1, 2, 3), -1.0), lc.Grid((1, 2, 3)), lc.turntable(lc.Grid((1, 2, 3)), [1.0])),
    ],
)
def test_what_is_said_is_on_the_page_of_sentences(wrong: Any) -> None:
    with pytest.raises(lc.InputError) as told:
        wrong()
    assert any(re.fullmatch(as_pattern(each), str(told.value), re.DOTALL) for each in listed()), str(told.value)


#: A sentence says what to do behind a colon, or what is allowed.
REMEDY = re.compile(r": |\bmust\b|, not |\blies? |\bat (least|most)\b|\bas in\b|\btakes? |\bsay |\bgive ")
#: Those whose end is said elsewhere: by what they are put into, or by what is put into them.
PARTS = ("‹path› holds ‹held›, and ‹needed›", "lightcube is ‹…› there", "in this room ‹…›", "on this stage ‹…›")


def test_every_sentence_says_what_to_do_or_what_is_allowed() -> None:
    assert [said for said in listed() if not REMEDY.search(said) and not said.startswith(PARTS)] == []


def test_sentences_are_read_as_they_are_written() -> None:
    source = """
raise InputError(f"{path} has {len(x)} parts" ": " f"give {self._most}")
raise InputError(str(error)) from error
raise PydanticCustomError("colour", "must be red")
raise InputError("no " + kind + ": give one")
"""
    said = ["‹path› has ‹…› parts: give ‹most›", "must be red", "no ‹kind›: give one"]
    assert list(sentences.of_source(source)) == said


def test_plain_words_stay_plain() -> None:
    assert plain("a_b *c* --dry-run [d|e]") == r"a\_b \*c\* `--dry-run` \[d\|e\]"


def test_results_in_sentences_and_types_by_their_names() -> None:
    pytest.importorskip("sphinx")
    docstrings = pytest.importorskip("docstrings")
    lines = ["A.", "", "Returns", "-------", "One: a line,", "and another.", "", "Raises", "------", "E", "    F."]
    docstrings.told(None, "", "", None, None, lines)
    assert lines[2:7] == ["Returns", "-------", ":", "    One: a line,", "    and another."]
    assert lines[-4:] == ["Raises", "------", "E", "    F."]
    typed = ["Returns", "-------", "cube", "    As given."]
    docstrings.told(None, "", "", None, None, typed)
    assert typed == ["Returns", "-------", "cube", "    As given."]
    array = "~numpy.ndarray[tuple[~typing.Any, ...], ~numpy.dtype[~numpy.float32]] | None"
    assert docstrings.short(array) == "NDArray[~numpy.float32] | None"
    assert docstrings.short("~lightcube.optics.grid.Grid") == "~lightcube.Grid"
    assert docstrings.short("~lightcube.optics.views.Other") == "~lightcube.optics.views.Other"


def test_a_page_asks_nothing_of_a_network(tmp_path: Path) -> None:
    pytest.importorskip("furo")
    build = pytest.importorskip("sphinx.cmd.build").build_main
    (tmp_path / "index.md").write_text("# A\n\n$a_b$ and\n\n$$\\sum_k a^2$$\n\n```python\nprint(1)\n```\n")
    ours = "extensions=myst_parser,sphinx_copybutton,formulas"
    assert build(["-q", "-W", "-c", str(DOCS), "-D", ours, str(tmp_path), str(tmp_path / "site")]) == 0
    page = (tmp_path / "site" / "index.html").read_text()
    assert page.count("<math") == 2
    fetched = re.findall(r"<(?:script|link|img|iframe)[^>]*?(?:src|href)=\"([^\"]*)\"", page)
    assert len(fetched) > 5
    assert [address for address in fetched if "//" in address] == []
    styles = "".join(file.read_text() for file in (tmp_path / "site" / "_static").rglob("*.css"))
    assert re.findall(r"(?:url\(|@import)\s*['\"]?(?:https?:)?//", styles) == []


def test_dead_links_are_found(tmp_path: Path) -> None:
    pytest.importorskip("sphinx")
    dead = pytest.importorskip("dead_links").dead
    (tmp_path / "below").mkdir()
    (tmp_path / "a.html").write_text(
        '<p id="here"><a href="#here"></a><a href="below/b.html?x#there"></a><a href="https://a.b/c"></a>'
        '<img src="below/no.png"><a href="#nowhere"></a>'
    )
    (tmp_path / "below" / "b.html").write_text('<p id="there"><a href="../a.html#there"></a><iframe src="b.html">')
    assert list(dead(tmp_path)) == ["a.html: below/no.png", "a.html: #nowhere", "below/b.html: ../a.html#there"]


def test_what_is_promised_of_files_is_what_is_read() -> None:
    promised = (DOCS / "reference" / "promises.md").read_text()
    assert f"| {_metadata.FORMAT_VERSION} | {_older.FIRST} to {_metadata.FORMAT_VERSION} |" in promised
    assert f"`.shape.zarr.zip` | {_shape_json.FORMAT_VERSION} |" in promised
    assert f"`.relief.zarr` | {_relief_json._VERSION} |" in promised


def test_the_version_is_one() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert f"\nversion: {project['version']}\n" in (ROOT / "CITATION.cff").read_text()
    newest = re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert newest is not None
    assert newest[1] == project["version"]


def test_how_to_start_names_every_extra_that_is_not_for_developers() -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    named = re.findall(r"^\| `(\w+)` \|", (DOCS / "start.md").read_text(), re.MULTILINE)
    assert set(named) == set(extras) - {"dev", "docs", "oracle", "readers"}
