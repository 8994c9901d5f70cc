"""A project keeps what is said, can undo it, has its folder to itself, and says what is wrong with it."""

import errno
import os
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer

pytest.importorskip("fastapi", reason="the studio's extra is not installed")

from hypothesis import given, settings
from hypothesis import strategies as st

from lightcube.cli import main
from lightcube.errors import InputError
from lightcube.studio.kinds import command_of
from lightcube.studio.making import Making, of_cube, option_words
from lightcube.studio.project import Crop, Picture, Project, Settings, toml_text
from lightcube.verbs.options import Options

NAMES = (
    "\x1b[31mred",
    "\u202egnp.exe",
    "<script>alert(1)</script>",
    'a"b\\c',
    "a\nb = 1",
    "\x7f\x00",
    "💡" * 20,
    "' OR 1=1",
)


def titled(title: str) -> Any:
    return lambda before: before.model_copy(update={"title": title})


def test_what_is_said_is_there_when_it_is_opened_again(tmp_path: Path) -> None:
    first = Project(tmp_path / "a")
    for title in ("one", "two", "three"):
        first.change(titled(title))
    first.step(-1)
    first.close()
    again = Project(tmp_path / "a")
    assert again.settings.title == "two"
    assert again.step(1).title == "three"
    assert [again.step(-1).title for _ in range(3)] == ["two", "one", ""]
    with pytest.raises(InputError, match="nothing to undo"):
        again.step(-1)
    again.change(titled("other"))
    with pytest.raises(InputError, match="nothing to do again"):
        again.step(1)


def test_what_changes_nothing_is_no_step(tmp_path: Path) -> None:
    project = Project(tmp_path)
    project.change(titled("one"))
    project.change(titled("one"))
    assert project.step(-1).title == ""
    assert not project.described()["can_undo"]


def showing(*keys: str) -> Any:
    pictures = tuple(Picture(key=key, name="a") for key in keys)
    return lambda before: before.model_copy(update={"pictures": pictures})


def keeping(parts: dict[str, Any]) -> Any:
    return lambda before: before.model_copy(update={"parts": parts})


def test_what_is_moved_along_is_undone_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr("lightcube.studio.project.time.monotonic", lambda: now[0])
    project = Project(tmp_path)
    for when, title, moving in (
        (0, "a", "x"),
        (1, "b", "x"),
        (2, "c", "x"),
        (3, "d", "y"),
        (5, "e", "y"),
        (5, "f", ""),
    ):
        now[0] = when
        project.change(titled(title), moving)
    assert [project.step(-1).title for _ in range(4)] == ["e", "d", "c", ""]
    project.step(1)
    project.change(titled("g"), "x")
    project.change(titled("c"), "x")  # moved back it was never moved
    project.change(titled("h"), "x")
    project.change(titled("c"), "x")
    project.change(titled("i"), "x")
    project.step(-1)
    project.change(titled("k"), "x")  # and nobody moves on from where an undo led
    assert [project.step(-1).title for _ in range(2)] == ["c", ""]
    project.change(titled("l"), "x")
    project.change(titled(""), "x")
    project.change(titled("m"), "x")
    assert project.step(-1).title == ""


def test_all_pictures_that_can_come_back_are_known(tmp_path: Path) -> None:
    project = Project(tmp_path)
    keys = [f"{number:016x}" for number in range(3)]
    for key in keys:
        project.change(showing(key))
    project.step(-1)
    assert project.keys == set(keys)
    project.change(titled("other"))
    assert project.keys == set(keys[:2])
    project.close()
    assert Project(tmp_path).keys == set(keys[:2])


def test_numbers_that_are_none_are_not_kept(tmp_path: Path) -> None:
    project = Project(tmp_path)
    for number in (float("nan"), float("inf")):
        with pytest.raises(InputError, match="not JSON compliant"):
            project.change(keeping({"rooms": [number]}))


@pytest.mark.parametrize("name", NAMES)
def test_hostile_names_come_back_as_they_are(name: str) -> None:
    picture = Picture(key="0123456789abcdef", name=name, crop=Crop(left=0.125, width=0.5))
    settings = Settings(title=name, pictures=(picture,), parts={"rooms": {"name": name}})
    tables = tomllib.loads(toml_text(settings))
    assert (tables["title"], tables["pictures"][0]["name"]) == (name, name)
    assert tables["pictures"][0]["crop"]["left"] == 0.125


def test_a_second_studio_says_so(tmp_path: Path) -> None:
    first = Project(tmp_path)
    with pytest.raises(InputError, match="open in another studio already"):
        Project(tmp_path)
    first.close()
    Project(tmp_path).close()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("format = 2\n", "has format 2, and this studio reads 1: update lightcube"),
        ("title = 'x'\n", "has format None, and this studio reads 1: move the file away"),
        ("format = 1\n[making]\nvoxels = 1e9\n", "is damaged: making.voxels"),
        ("format = 1\nmagic = 1\n", "is damaged: magic: no such key here"),
        ("format = 1\nparts = '{'\n", "is damaged in its parts"),
        ("format = 1\n[[pictures]]\nkey = '../../etc'\nname = 'a'\n", r"is damaged: pictures"),
        ("format = ", "is not a TOML file"),
        ("\0", "holds bytes of 0"),
    ],
)
def test_settings_that_cannot_be_are_one_sentence(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "project.toml").write_text(text)
    with pytest.raises(InputError, match=said):
        Project(tmp_path)
    (tmp_path / "project.toml").unlink()
    Project(tmp_path).close()  # nobody holds the folder


def test_a_damaged_history_costs_only_itself(tmp_path: Path) -> None:
    project = Project(tmp_path)
    project.change(titled("one"))
    project.close()
    (tmp_path / "history.json").write_text('{"at": 7, "steps": [')
    again = Project(tmp_path)
    assert (again.settings.title, again.described()["can_undo"]) == ("one", False)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="whoever may write everywhere is not refused")
def test_a_folder_that_cannot_be_written_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "shut").mkdir(mode=0o500)
    with pytest.raises(InputError, match=r"writing .* failed"):
        Project(tmp_path / "shut")


def test_a_file_in_the_place_of_the_folder_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for place in ("file", "file/below"):
        with pytest.raises(InputError, match=r"writing .* failed"):
            Project(tmp_path / place)


def test_a_full_disk_is_a_sentence_and_the_settings_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    project = Project(tmp_path)
    project.change(titled("one"))

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("lightcube.studio.project.os.fsync", full)
    with pytest.raises(InputError, match="no space is left on the disk"):
        project.change(titled("two"))
    assert project.settings.title == "one"
    assert tomllib.loads((tmp_path / "project.toml").read_text())["title"] == "one"
    assert not [each.name for each in tmp_path.iterdir() if each.name.startswith(".project")]


@pytest.mark.parametrize("parts", [("..", "a"), ("a/b",), ("",), (".",), ("a\0",), ("..\\a",), ("way", "out")])
def test_no_path_leads_out_of_the_folder(parts: tuple[str, ...], tmp_path: Path) -> None:
    project = Project(tmp_path / "project")
    (project.folder / "way").symlink_to(tmp_path)
    with pytest.raises(InputError, match=r"no file of the project|out of the project's folder"):
        project.path(*parts)


@cache
def solve_command() -> Any:
    """The command as the terminal has it."""
    return typer.main.get_command(main.application(["solve"])).commands["solve"]  # type: ignore[attr-defined]


@settings(max_examples=30)
@given(
    making=st.builds(
        Making,
        voxels=st.integers(16, 160),
        width=st.floats(0.2, 1),
        lamp=st.floats(1, 64),
        hold_deg=st.floats(0, 6),
        richness=st.one_of(st.just(0.0), st.floats(0.01, 1)),
        fit=st.sampled_from(["crop", "pad"]),
        mat=st.sampled_from(["dark", "grey", "light", "none"]),
        order=st.sampled_from(["given", "best"]),
        quality=st.sampled_from(["draft", "normal", "best"]),
        stands=st.sampled_from(["air", "block", "cylinder"]),
    )
)
def test_the_command_says_what_the_sliders_say(making: Making) -> None:
    """Read again as the command line reads it, the words are the very options."""
    typed = command_of(Path("/a folder"), Settings(making=making)).split(" ", 2)[2]
    assert typed.startswith("'/a folder/pictures' -o '/a folder/made/cube.zarr'")
    words = ["pictures", "-o", "cube.zarr", *option_words(of_cube(making))]
    given = solve_command().make_context("solve", words).params
    given["ior"] = None if given["ior"] is None else (float(given["ior"]),)
    said = Options(**{name: value for name, value in given.items() if name in Options.__dataclass_fields__})
    assert said == of_cube(making)


def test_a_disk_that_is_full_for_the_history_alone_changes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Settings and history are written both or none: what stands in one is in the other, too."""
    project = Project(tmp_path)
    project.change(titled("one"))
    written = Path.open

    def full(path: Path, *how: Any, **more: Any) -> Any:
        if "history" in path.name and "w" in "".join(how):
            raise OSError(errno.ENOSPC, "No space left on device")
        return written(path, *how, **more)

    monkeypatch.setattr(Path, "open", full)
    with pytest.raises(InputError, match="no space is left"):
        project.change(titled("two"))
    monkeypatch.undo()
    assert project.settings.title == "one"
    project.close()
    again = Project(tmp_path)
    assert (again.settings.title, again.described()["can_undo"]) == ("one", True)


def test_what_a_killed_studio_had_half_written_goes_and_nothing_else(tmp_path: Path) -> None:
    Project(tmp_path).close()
    half, other = ".project.toml.12.half-written", ".bash_history.1"
    for folder in (tmp_path, tmp_path / "made"):
        for name in (half, other):
            (folder / name).write_text("x")
    Project(tmp_path).close()
    for folder in (tmp_path, tmp_path / "made"):
        assert not (folder / half).exists()
        assert (folder / other).exists()


def test_settings_can_be_read_while_they_change(tmp_path: Path) -> None:
    """A change that goes back makes the history shorter: who reads meanwhile sees the one or the other."""
    project = Project(tmp_path)
    seen = []

    class Watched(Project):
        def __setattr__(self, name: str, value: Any) -> None:
            super().__setattr__(name, value)
            seen.append(self.settings.title)  # as another thread may, after every single step

    project.change(titled("one"), "x")
    project.__class__ = Watched
    project.change(titled(""), "x")
    assert set(seen) == {""}
