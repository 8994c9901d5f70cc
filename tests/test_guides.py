"""Tutorials, how-tos and lessons do what they say: followed from top to bottom, in one folder, with smaller cubes."""

import contextlib
import io
import os
import re
import shlex
from pathlib import Path
from typing import Any

import pytest
import typer.core

from lightcube.cli.main import application
from tests.cli.test_cli import run
from tests.test_docs import PAGES, ROOT

GUIDES = [page for folder in ("tutorials", "how-to", "teach") for page in sorted((ROOT / "docs" / folder).glob("*.md"))]
INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT", "0") != "0"
#: What `--n` says, or nothing: a cube that is solved in a second.
SMALL = {"solve": 16, "check": 16, "hull": 32}

__all__ = ["run"]


def fences(page: Path) -> list[tuple[str, str]]:
    """The blocks of a page in order, each with its language."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", page.read_text(), re.DOTALL | re.MULTILINE)


def small(line: str) -> str:
    """The same command for a cube that is solved in a second, and a movie of few pictures."""
    verb = line.split()[1]
    if verb in SMALL and "--films" not in line and ".toml" not in line:
        line = re.sub(r"--n \d+", "", line) + f" --n {SMALL[verb]}"
    return line + " --fps 2" if verb == "play" and ".mp4" in line else line


def shrunk(text: str) -> str:
    """What is written into a file, of smaller cubes."""
    return text.replace("[64, 64, 64]", "[12, 12, 12]")


@pytest.mark.skipif(INTERPRETED, reason="interpreted cubes take minutes")
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("page", GUIDES, ids=lambda page: f"{page.parent.name}-{page.stem}")
def test_a_guide_does_what_it_says(run, page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    """Commands (`bash`) and Python run in order; a file is what begins with its name; output is what stands below."""
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "guide"}
    printed = ""
    for language, text in fences(page):
        if language == "python":
            with contextlib.redirect_stdout(io.StringIO()) as out:
                exec(compile(text, str(page), "exec"), names)  # noqa: S102
            printed = out.getvalue()
        elif language == "text" and printed:
            assert printed == text, page
        elif language == "toml" and (named := re.match(r"# (\S+\.toml)\n", text)):
            Path(named[1]).write_text(shrunk(text))
        elif language == "bash":
            for line in text.splitlines():
                done = run(*shlex.split(small(line), comments=True)[1:])
                assert done.code == 0, f"{line}: {done.err}"
        printed = printed if language == "python" else ""


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
