"""Every verb that writes, killed at every event of the file system: files are whole, and the same command goes on.

The suite takes some events of each; ``LIGHTCUBE_KILLS=all``, or `make kills`, takes all of them, and 300 moments.
"""

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pytest
from PIL import Image

from tests.conftest import INTERPRETED
from tests.hostile.documents import STAGE

if sys.platform == "win32":
    pytest.skip("nothing forks here", allow_module_level=True)

ALL = os.environ.get("LIGHTCUBE_KILLS") == "all"
#: Of each command's events, so many in the suite, spread over all.
FEW = 3
#: So many moments for each signal.
MOMENTS = 100 if ALL else 1
SOLVE = ("--n", "8", "--picture-width", "0.7", "--iterations", "4", "--hold-deg", "0")
SMALL_RELIEF = ("--columns", "8", "--sweeps", "2")
#: What each command writes, and its words; `given` holds the pictures and a cube of them.
COMMANDS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "trace folder": (("t",), ("trace", "juggler", "-o", "t", "--count", "2", "--size", "8x8")),
    "trace movie": (("t.mp4",), ("trace", "juggler", "-o", "t.mp4", "--count", "2", "--size", "8x8")),
    **{
        f"solve {suffix}": ((f"a{suffix}",), ("solve", "given/photos", "-o", f"a{suffix}", *SOLVE))
        for suffix in (".zarr", ".zarr.zip", ".npz")
    },
    "solve units": (("a.zarr",), ("solve", "given/photos", "-o", "a.zarr", *SOLVE, "--elevation-deg", "0")),
    "publish": (("a.zarr",), ("publish", "a.zarr.partial")),
    **{
        f"play {suffix}": ((f"p{suffix}",), ("play", "given/c.zarr", "-o", f"p{suffix}", "--count", "2"))
        for suffix in ("", ".mp4", ".webm", ".gif", ".webp", ".apng", ".npy")
    },
    "relief": (
        ("p.stl", "p.relief.zarr", "s.png"),
        ("relief", "given/photos", "-o", "p.stl", "-o", "p.relief.zarr", "--sheet", "s.png", *SMALL_RELIEF),
    ),
    "score": (("s.png", "s.svg"), ("score", "given/c.zarr", "--sheet", "s.png", "--plot", "s.svg")),
    "view": (("v.html",), ("view", "given/c.zarr", "-o", "v.html")),
    "report": (("r.html",), ("report", "given/c.zarr", "-o", "r.html")),
    "draw cube": (("d.png",), ("draw", "given/c.zarr", "-o", "d.png")),
    "draw stage": (("d.svg",), ("draw", "given/stage.toml", "-o", "d.svg")),
}
#: What programs end with that are stopped; one that is told to end before it listens ends as the system has it.
ENDS = {signal.SIGKILL: (0, -9), signal.SIGTERM: (0, -15, 130), signal.SIGINT: (0, 130)}
#: Says when Python is up; what it writes is what `tests.hostile.kills` writes.
PROGRAM = "import tests.hostile.kills; from lightcube.__main__ import main; print(flush=True); main()"
Content: TypeAlias = dict[str, bytes]


class Killer:
    """The program of `tests.hostile.kills`, at work in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._whole: dict[str, dict[str, Content]] = {}
        self._said = (folder.parent / "said").open("w+")
        source = Path(__file__).parents[2]
        kept = {name: str(folder.parent / name) for name in ("XDG_CACHE_HOME", "TMPDIR")}
        for name in kept.values():
            Path(name).mkdir()
        paths = f"{source / 'src'}{os.pathsep}{source}"
        self._environment = {**os.environ, **kept, "NUMBA_NUM_THREADS": "1", "PYTHONPATH": paths}
        self._program = subprocess.Popen(
            [sys.executable, "-m", "tests.hostile.kills"],
            cwd=folder,
            env=self._environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._said,
            text=True,
        )

    def __call__(self, words: tuple[str, ...], at: int | str | None = None) -> tuple[int, int]:
        """The exit code of a command and the number of its events."""
        assert self._program.stdin is not None
        assert self._program.stdout is not None
        self._said.truncate(0)
        self._said.seek(0)
        self._program.stdin.write(json.dumps([words, at]) + "\n")
        self._program.stdin.flush()
        code, events = json.loads(self._program.stdout.readline() or "[-1, 0]")
        return code, events

    def whole(self, name: str) -> dict[str, Content]:
        """What a command of `COMMANDS` comes to, made once, and in this program: so all that it needs is loaded."""
        if name not in self._whole:
            outputs, words = COMMANDS[name]
            clean(self.folder)
            begun(self, name)
            assert self(words, "here") == (0, 0), self.said()
            self._whole[name] = {output: content(self.folder / output) for output in outputs}
        return self._whole[name]

    def program(self, words: tuple[str, ...], stop: tuple[float, signal.Signals] | None) -> tuple[int, str]:
        """Exit code of a program of its own that may be stopped after so many seconds, and what it says."""
        with subprocess.Popen(
            [sys.executable, "-c", PROGRAM, *words],
            cwd=self.folder,
            env=self._environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as running:
            assert running.stdout is not None
            running.stdout.readline()
            if stop is not None:
                time.sleep(stop[0])
                running.send_signal(stop[1])
            _, said = running.communicate()
        return running.returncode, said

    def said(self) -> str:
        return (self.folder.parent / "said").read_text()

    def finish(self) -> None:
        self._program.communicate()
        self._said.close()


@pytest.fixture(scope="module")
def killer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Killer]:
    folder = tmp_path_factory.mktemp("kills") / "at work"
    photos = folder / "given" / "photos"
    photos.mkdir(parents=True)
    for index, picture in enumerate(np.random.default_rng(0).integers(60, 250, (2, 6, 6, 3), np.uint8)):
        Image.fromarray(picture).save(photos / f"{index}.png")
    (folder / "given" / "stage.toml").write_text(STAGE.replace("one.png", "photos/0.png"))
    made = Killer(folder)
    assert made(("solve", "given/photos", "-o", "given/c.zarr", *SOLVE), "here") == (0, 0), made.said()
    yield made
    made.finish()


def content(path: Path) -> Content:
    """All that stands at a path, by name; nothing where there is nothing."""
    if path.is_dir():
        return {str(each.relative_to(path)): each.read_bytes() for each in sorted(path.rglob("*")) if each.is_file()}
    return {"": path.read_bytes()} if path.exists() else {}


def clean(folder: Path) -> None:
    for each in folder.iterdir():
        if each.name != "given":
            shutil.rmtree(each) if each.is_dir() else each.unlink()


def begun(killer: Killer, name: str) -> None:
    """What stands there before a command: for `publish` all units of a cube, for `solve units` one of two."""
    solve = COMMANDS["solve units"][1]
    if name in ("publish", "solve units"):
        assert killer((*solve, "--unit", "1/2"))[0] == 0, killer.said()
    if name == "publish":
        assert killer((*solve, "--unit", "2/2"))[0] == 0, killer.said()


@pytest.mark.skipif(INTERPRETED, reason="what is written is the same whether kernels are compiled or not")
@pytest.mark.parametrize(
    ("name", "replacing"),
    [*((name, False) for name in COMMANDS), *((name, True) for name in COMMANDS if name != "solve units")],
)
def test_killed_at_any_event_files_are_whole_and_the_same_command_goes_on(
    killer: Killer, name: str, *, replacing: bool
) -> None:
    """What had the name before stays until what is new is whole. In the end there is nothing beside it."""
    folder, (outputs, words) = killer.folder, COMMANDS[name]
    whole = killer.whole(name)
    old = dict.fromkeys(outputs, Content())
    if replacing:  # as another command of the kind made them
        old = {output: {**files, min(files): b"old"} for output, files in whole.items()}

    def prepared() -> None:
        clean(folder)
        begun(killer, name)
        for output in outputs if replacing else ():
            restore(folder / output, old[output])

    prepared()
    first = (*words, "--overwrite") if replacing else words
    code, events = killer(first)
    assert code == 0, killer.said()
    moments = range(1, events + 1) if ALL else np.unique(np.linspace(1, events, FEW).round().astype(int)).tolist()
    for moment in moments:
        prepared()
        assert killer(first, moment)[0] == -signal.SIGKILL, (moment, killer.said())
        finished(killer, first, old, whole)


@pytest.mark.skipif(INTERPRETED, reason="it takes too long to come to the moments in between")
@pytest.mark.parametrize("how", ENDS)
def test_killed_at_any_moment_files_are_whole_and_the_same_command_goes_on(killer: Killer, how: signal.Signals) -> None:
    """A program of its own, from its start to its end, by what a terminal and a system send; all commands in turn."""
    folder, chance = killer.folder, random.Random()  # noqa: S311 - another time, other moments
    took: dict[str, float] = {}
    names = chance.sample(list(COMMANDS), len(COMMANDS))
    for number in range(MOMENTS):
        name = names[number % len(names)]
        outputs, words = COMMANDS[name]
        if name not in took:
            clean(folder)
            begun(killer, name)
            began = time.monotonic()
            assert killer.program(words, None)[0] == 0
            took[name] = time.monotonic() - began
            assert {output: content(folder / output) for output in outputs} == killer.whole(name)
        clean(folder)
        begun(killer, name)
        moment = chance.uniform(0, took[name])
        code, said = killer.program(words, (moment, how))
        what = (number, name, moment, code, said)
        assert code in ENDS[how], what
        if code == 130:
            assert "interrupted" in said or "the same command goes on" in said, what
            assert "Traceback" not in said, what
        finished(killer, words, dict.fromkeys(outputs, Content()), killer.whole(name))


def finished(killer: Killer, words: tuple[str, ...], old: dict[str, Content], whole: dict[str, Content]) -> None:
    """What a killed command has left is the old or the new; the same command finishes it, and leaves nothing else."""
    folder = killer.folder
    for output, files in whole.items():
        assert content(folder / output) in (old[output], files), output
    code, _ = killer(words)
    if code == 2:  # killed when all was done and tidied, but perhaps the workplace of one of two: the next one does it
        assert "already" in killer.said()
        assert {output: content(folder / output) for output in whole} == whole
        code, _ = killer(("draw", "given/stage.toml", "-o", "swept.svg"))
        (folder / "swept.svg").unlink()
    assert code == 0, killer.said()
    assert {output: content(folder / output) for output in whole} == whole
    assert {each.name for each in folder.iterdir()} == {"given", *whole}
    assert not list((folder.parent / "TMPDIR").iterdir())


def restore(path: Path, files: Content) -> None:
    for name, data in files.items():
        (path / name).parent.mkdir(parents=True, exist_ok=True)
        (path / name).write_bytes(data)
