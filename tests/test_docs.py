"""The README's code runs, its verbs are the command line's, and its links lead somewhere."""

import os
import re
import shlex
from pathlib import Path
from typing import Any

import pytest

from lightcube.cli import main
from lightcube.io import scene_names
from tests.cli.test_cli import run

ROOT = Path(__file__).parent.parent
#: All pages but those that the site's build makes: of the program, of the notebook, and of the gallery's scripts.
WRITTEN = sorted(
    page
    for page in (ROOT / "docs").rglob("*.md")
    if "made" not in page.parts and (page.parent.name != "gallery" or page.stem == "index")
)
PAGES = [ROOT / "README.md", *WRITTEN, ROOT / "CONTRIBUTING.md"]
#: Pages whose blocks stand each for itself: those of guides are followed in order (`test_guides`).
APART = [page for page in PAGES if not {"tutorials", "how-to", "teach"} & set(page.relative_to(ROOT).parts)]
INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT", "0") != "0"

__all__ = ["run"]


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(), re.DOTALL)


def small(code: str) -> str:
    """The same with smaller cubes where kernels run interpreted."""
    if not INTERPRETED:
        return code
    for large, little in (
        ("64, 64", "6, 6"),
        ("(6, 6, 64)", "(6, 6, 6)"),
        ("--n 64", "--n 8"),
        ("32x32", "4x4"),
        ("(64, 48)", "(4, 3)"),
    ):
        code = code.replace(large, little)
    return code.replace("iterations=60", "iterations=2").replace("--count 16", "--count 3")


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("page", APART, ids=lambda p: p.name)
def test_python_blocks_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for code in blocks(page, "python"):
        exec(compile(small(code), str(page), "exec"), {})  # noqa: S102


@pytest.mark.skipif(INTERPRETED, reason="two passes come to other figures")
def test_a_method_of_ones_own_is_short_and_gains_what_its_page_says() -> None:
    page = ROOT / "docs" / "your-own-method.md"
    code, told = blocks(page, "python")[0], dict(re.findall(r"\| `(\w+)` \| (0\.\d+) \|", page.read_text()))
    assert len(re.findall(r"^(?:def|    ).*", code.split("\n# Two even blocks")[0], re.MULTILINE)) <= 30
    found: dict[str, Any] = {}
    exec(compile(code, str(page), "exec"), found)  # noqa: S102
    assert found["errors"] == pytest.approx({name: float(error) for name, error in told.items()}, rel=0.01)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_the_readmes_commands_run(run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    """With smaller cubes, and a movie of few pictures."""
    monkeypatch.chdir(tmp_path)
    lines = [line for block in blocks(ROOT / "README.md", "bash") for line in block.splitlines()]
    assert len(lines) >= 5
    for line in lines:
        brief = small(line).replace("--n 64", "--n 16").replace("turn.mp4", "turn.mp4 --fps 1")
        done = run(*shlex.split(brief, comments=True)[1:])
        assert done.code == 0, f"{line}: {done.err}"


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CHANGELOG.md"], ids=lambda p: p.name)
def test_no_page_has_a_gap(page: Path) -> None:
    assert "@@" not in page.read_text()


def test_the_readme_names_every_scene() -> None:
    readme = (ROOT / "README.md").read_text()
    for name in scene_names():
        assert f"`{name}`" in readme, name


def test_the_readme_names_every_verb() -> None:
    readme = (ROOT / "README.md").read_text()
    for name in main.COMMANDS:
        assert f"| `{name}" in readme, name


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_between_pages_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
        assert target.startswith("https://") or (page.parent / target).exists(), target
