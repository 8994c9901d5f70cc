"""What is written is there as a whole and lasts, whatever ends the program that writes it."""

import errno
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lightcube as lc
from lightcube.errors import InputError
from lightcube.io import _workplaces
from lightcube.io._files import written_whole
from lightcube.io._workplaces import put, sweep, workplace
from lightcube.io.outputs import Kind, Output, Thing, write_together

KILLED = """
import os, signal, sys
from pathlib import Path
from lightcube.io._files import written_whole

with written_whole(Path(sys.argv[1]), overwrite=True, replaceable=None) as (fresh, give_its_name):
    fresh.write_text("half of it")
    print("begun", flush=True)
    {then}
    give_its_name()
"""


def writing(target: Path, then: str) -> "subprocess.Popen[str]":
    """Another program that is in the middle of writing `target`."""
    code = KILLED.format(then=then)
    program = subprocess.Popen(
        [sys.executable, "-c", code, str(target)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert program.stdout is not None
    assert program.stdout.readline() == "begun\n"
    return program


def hidden(folder: Path) -> list[str]:
    return [found.name for found in folder.iterdir() if found.name.startswith(".")]


def write(path: Path, text: str = "whole") -> None:
    with written_whole(path, overwrite=True, replaceable=None) as (fresh, give_its_name):
        fresh.write_text(text)
        give_its_name()


def test_what_a_killed_program_left_goes_with_the_next_that_writes_there(tmp_path: Path) -> None:
    program = writing(tmp_path / "one.txt", "os.kill(os.getpid(), signal.SIGKILL)")
    program.communicate()
    assert program.returncode == -signal.SIGKILL
    assert len(hidden(tmp_path)) == 1
    assert not (tmp_path / "one.txt").exists()
    write(tmp_path / "other.txt")
    assert sorted(found.name for found in tmp_path.iterdir()) == ["other.txt"]


@pytest.mark.parametrize("after", range(10))
def test_killed_while_it_tidied_the_next_one_tidies(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, after: int
) -> None:
    """The mark that says whose a workplace was goes last."""
    left = after

    def killed(remove: Any) -> Any:
        def removed(*what: Any, **where: Any) -> None:
            nonlocal left
            left -= 1
            if left < 0:
                raise KeyboardInterrupt
            remove(*what, **where)

        return removed

    with monkeypatch.context() as patch, suppress(KeyboardInterrupt), workplace(tmp_path / "one") as made:
        for name in ("a", "z", "folder"):
            folder_of(made / name, "old")
        (made / "file").write_text("old")
        for name in ("unlink", "rmdir"):
            patch.setattr(os, name, killed(getattr(os, name)))
    write(tmp_path / "other.txt")
    assert [found.name for found in tmp_path.iterdir()] == ["other.txt"]


def test_what_another_program_is_writing_stays(tmp_path: Path) -> None:
    program = writing(tmp_path / "one.txt", "sys.stdin.readline()")
    write(tmp_path / "other.txt")
    program.communicate("go on\n")
    assert program.returncode == 0
    assert (tmp_path / "one.txt").read_text() == "half of it"
    assert hidden(tmp_path) == []


def test_two_in_one_program_do_not_sweep_each_other(tmp_path: Path) -> None:
    with workplace(tmp_path / "one") as one, workplace(tmp_path / "other") as other:
        assert one.is_dir()
        assert other.is_dir()
        sweep(tmp_path)
        assert one.is_dir()
    assert hidden(tmp_path) == []


@pytest.mark.parametrize(
    "name", [".lightcube", ".lightcube-unfinished", ".lightcube-mine-notes", "lightcube-x-abcdefgh"]
)
def test_only_workplaces_are_swept(tmp_path: Path, name: str) -> None:
    (tmp_path / name).mkdir()
    (tmp_path / name / "owner").write_text("a friend")
    linked = tmp_path / "elsewhere"
    linked.mkdir()
    (linked / "owner").write_text("")
    (tmp_path / ".lightcube-link-abcdefgh").symlink_to(linked)
    full = tmp_path / ".lightcube-full-abcdefgh"  # of no program that marks its own
    full.mkdir()
    (full / "letter").write_text("dear")
    sweep(tmp_path)
    assert (tmp_path / name / "owner").exists()
    assert (linked / "owner").exists()
    assert (full / "letter").exists()


def folder_of(path: Path, text: str) -> Path:
    path.mkdir()
    (path / "zarr.json").write_text(text)
    return path


def test_a_folder_that_is_replaced_is_there_at_every_moment(tmp_path: Path) -> None:
    target, missing, done = folder_of(tmp_path / "cube.zarr", "0"), [], threading.Event()

    def look() -> None:
        while not done.is_set():
            if not target.is_dir():
                missing.append(True)

    looking, turns_s = threading.Thread(target=look), sys.getswitchinterval()
    sys.setswitchinterval(1e-5)  # so that it looks between any two steps, and none waits for its turn
    looking.start()
    for number in range(200):
        with workplace(target) as made:
            put(folder_of(made / "cube.zarr", str(number)), target, made / "old")
    done.set()
    looking.join()
    sys.setswitchinterval(turns_s)
    assert (target / "zarr.json").read_text() == "199"
    assert hidden(tmp_path) == []
    if sys.platform.startswith(("linux", "darwin")):
        assert not missing


@pytest.mark.parametrize("fails", [False, True])
def test_where_names_cannot_change_places_the_old_one_comes_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fails: bool
) -> None:
    monkeypatch.setattr(_workplaces, "_swapped", lambda one, other: False)
    target, fresh = folder_of(tmp_path / "cube.zarr", "old"), folder_of(tmp_path / "fresh", "new")
    renamed = Path.rename

    def rename(self: Path, other: Path) -> Path:
        if fails and self == fresh:
            raise OSError(28, "No space left on device")
        return renamed(self, other)

    monkeypatch.setattr(Path, "rename", rename)
    if fails:
        with pytest.raises(OSError, match="No space"):
            put(fresh, target, tmp_path / "aside")
    else:
        put(fresh, target, tmp_path / "aside")
    assert (target / "zarr.json").read_text() == ("old" if fails else "new")


@pytest.mark.parametrize("name", ["cube.zarr", "cube.zarr.zip", "cube.npz"])
def test_all_is_on_the_disk_before_it_has_its_name_and_the_name_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """At a power cut there is the old file or the new one."""
    settled: list[int] = []
    synced: Any = os.fsync

    def fsync(opened: int) -> None:
        synced(opened)
        settled.append(os.fstat(opened).st_ino)

    monkeypatch.setattr(os, "fsync", fsync)
    grid = lc.Grid((2, 3, 4))
    rig = lc.turntable(grid, [0.0, 90.0])
    lc.save(lc.Cube(np.zeros((3, 2, 3, 4), np.float32), grid, rig), tmp_path / name)
    target = tmp_path / name
    whole = {each.stat().st_ino for each in (target, *(target.rglob("*") if target.is_dir() else ()))}
    assert whole <= set(settled[:-1])
    assert settled[-1] == tmp_path.stat().st_ino


def test_what_a_link_leads_to_is_written_and_the_link_stays(tmp_path: Path) -> None:
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / "real.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to(tmp_path / "far" / "real.txt")
    write(tmp_path / "link.txt")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "far" / "real.txt").read_text() == "whole"
    assert hidden(tmp_path) == hidden(tmp_path / "far") == []


def test_names_of_any_length_have_workplaces(tmp_path: Path) -> None:
    write(tmp_path / ("ü" * 120 + ".txt"))
    assert len(list(tmp_path.iterdir())) == 1


def test_a_folder_that_cannot_be_written_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="there is no folder"):
        lc.save("<p>", tmp_path / "file" / "x.html")


@pytest.mark.parametrize(("number", "fails"), [(errno.EINVAL, False), (errno.ENOTSUP, False), (errno.EIO, True)])
def test_disks_that_cannot_be_asked_to_settle_are_written_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, fails: bool
) -> None:
    def fsync(_: int) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, "fsync", fsync)
    if fails:
        with pytest.raises(InputError, match=r"writing .* failed"):
            write(tmp_path / "x.txt")
    else:
        write(tmp_path / "x.txt")
    assert (tmp_path / "x.txt").exists() is not fails
    assert hidden(tmp_path) == []


@pytest.mark.parametrize("failing", [0, 1, 2])
@pytest.mark.parametrize("there", [False, True])
def test_of_several_none_is_named_where_one_cannot_be_made(tmp_path: Path, failing: int, *, there: bool) -> None:
    things: list[tuple[str, Kind, Thing]] = [
        ("a.json", "document", {"a": 1}),
        ("b.html", "page", "<p>"),
        ("c.png", "picture", np.zeros((2, 2, 3), np.uint8)),
    ]
    before = {name: b"old" for name, _, _ in things} if there else {}
    for name, data in before.items():
        (tmp_path / name).write_bytes(data)
    own, kinds, contents = zip(*things, strict=True)

    def together(names: Sequence[str]) -> None:
        outputs = [Output(tmp_path / name, kind, overwrite=True) for name, kind in zip(names, kinds, strict=True)]
        write_together(*zip(outputs, contents, strict=True))

    with pytest.raises(InputError):
        together([f"nowhere/{name}" if at == failing else name for at, name in enumerate(own)])
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir()} == before
    together(own)
    made = {each.name: each.read_bytes() for each in tmp_path.iterdir()}
    assert sorted(made) == sorted(own)
    assert b"old" not in made.values()


KILLED_BETWEEN = """
import os, signal, sys
from pathlib import Path
from lightcube.io import _files
from lightcube.io.outputs import Output, write_together

real, left = _files.put, int(sys.argv[2])

def put(*places):
    global left
    real(*places)
    left -= 1
    if not left:
        os.kill(os.getpid(), signal.SIGKILL)

_files.put = put
folder = Path(sys.argv[1])
write_together((Output(folder / "a.html", "page"), "<p>"), (Output(folder / "b.svg", "drawing"), "<svg>"))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="nobody is killed like that here")
@pytest.mark.parametrize("named", [1, 2])
def test_of_several_killed_between_their_names_the_same_again_finishes(tmp_path: Path, named: int) -> None:
    killed = subprocess.run([sys.executable, "-c", KILLED_BETWEEN, str(tmp_path), str(named)], check=False)
    assert killed.returncode == -signal.SIGKILL
    assert (tmp_path / "a.html").exists()
    assert (tmp_path / "b.svg").exists() is (named == 2)
    outputs = Output(tmp_path / "a.html", "page"), Output(tmp_path / "b.svg", "drawing")
    write_together(*zip(outputs, ("<p>", "<svg>"), strict=True))
    assert {each.name: each.read_text() for each in tmp_path.iterdir()} == {"a.html": "<p>", "b.svg": "<svg>"}
