"""What commands remember for each other: there again, bounded, and never in the way."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from lightcube.io import Remembered, remembered


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where answers lie."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "lightcube"


def test_what_was_put_is_there_for_the_next(folder: Path) -> None:
    Remembered()["a"] = {"psnr": [1.5, 2.0], "rehearsed": 20}
    again = Remembered()
    assert again["a"] == {"psnr": [1.5, 2.0], "rehearsed": 20}
    assert list(again) == ["a"]
    assert [path.name for path in folder.iterdir()] == ["a.json"]
    del again["a"]
    assert "a" not in again
    with pytest.raises(KeyError):
        del again["a"]


@pytest.mark.parametrize("text", [b"", b"{", b"\xff\xfe", b"[" * 30_000, b" " * 50_000 + b"1"])
def test_what_is_no_answer_is_not_there(folder: Path, text: bytes) -> None:
    folder.mkdir()
    (folder / "a.json").write_bytes(text)
    assert "a" not in Remembered()


def test_the_oldest_half_goes_where_there_is_no_more_room(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remembered, "MOST", 4)
    known = Remembered()
    for age, name in enumerate("abcd"):
        known[name] = age
        os.utime(folder / f"{name}.json", (age, age))
    known["e"] = 4
    assert sorted(known) == ["c", "d", "e"]


#: Puts an answer in children, each of which is killed one event of the file system later; says how many were.
KILLED = """
import itertools, os, signal, sys
from lightcube.io import Remembered

def put(at):
    def hear(event, _, left=itertools.count(1)):
        if (event == "open" or event.startswith(("os.", "tempfile."))) and next(left) == at:
            os.kill(os.getpid(), signal.SIGKILL)

    known = Remembered()
    known["before"] = 1  # imports what is needed
    sys.addaudithook(hear)
    known["a"] = list(range(9))

for at in itertools.count(1):
    child = os.fork()
    if not child:
        put(at)
        os._exit(0)
    if not os.waitpid(child, 0)[1]:
        break
print(at - 1)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="nothing forks here")
def test_what_a_killed_program_left_is_removed_by_the_next(folder: Path) -> None:
    ran = subprocess.run([sys.executable, "-c", KILLED], check=True, capture_output=True, text=True)
    assert int(ran.stdout) > 5
    Remembered()["b"] = 2
    assert sorted(path.name for path in folder.iterdir()) == ["a.json", "b.json", "before.json"]
    assert json.loads((folder / "a.json").read_text()) == list(range(9))


def test_what_is_too_large_is_not_kept(folder: Path) -> None:
    known = Remembered()
    known["a"] = "x" * (remembered.LARGEST + 1)
    assert "a" not in known
    assert len(known) == 0


def test_where_nothing_can_be_written_nothing_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    known = Remembered()
    known["a"] = 1
    assert list(known) == []


def test_without_a_home_nothing_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "not/absolute")

    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", homeless)
    known = Remembered()
    known["a"] = 1
    assert (list(known), "a" in known) == ([], False)
