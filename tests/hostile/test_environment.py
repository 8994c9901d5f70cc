"""Programs that are started with streams closed or full, and in odd surroundings: a sentence, or it works."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import lightcube as lc
from tests.conftest import INTERPRETED
from tests.hostile.bombs import CUBE

compiled_only = pytest.mark.skipif(INTERPRETED, reason="kernels run interpreted: there is no compiler")
SOURCES = Path(lc.__file__).parents[1]
pytestmark = pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no disk that is always full")
SURROUNDINGS = {
    "threads 0": ("", {"NUMBA_NUM_THREADS": "0"}, 2),
    "threads abc": ("", {"NUMBA_NUM_THREADS": "abc"}, 2),
    "threads 999": ("", {"NUMBA_NUM_THREADS": "999"}, 0),
    "cache": ("", {"NUMBA_CACHE_DIR": "/proc/nowhere"}, 0),
    "layer": ("", {"NUMBA_THREADING_LAYER": "nonsense"}, 0),
    "home": ("", {"HOME": "/proc/nowhere", "XDG_CACHE_HOME": ""}, 0),
    "letters": ("", {"LC_ALL": "C", "PYTHONIOENCODING": "ascii"}, 0),
    "temporary": ("", {"TMPDIR": "/nowhere"}, 0),
    "columns 0": ("", {"COLUMNS": "0"}, 0),
    "columns abc": ("", {"COLUMNS": "abc"}, 0),
    "nothing in": ("<&-", {}, 0),
    "nothing out": (">&-", {}, 0),
    "no errors": ("2>&-", {}, 0),
    "nothing at all": ("<&- >&- 2>&-", {}, 0),
    "full": (">/dev/full", {}, 2),
    "errors full": ("2>/dev/full", {}, 0),
}


def called(words: str, changes: dict[str, str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["/bin/sh", "-c", f"exec {sys.executable} -m lightcube {words}"],
        capture_output=True,
        text=True,
        env={**os.environ, **changes},
    )


@pytest.mark.parametrize("name", SURROUNDINGS)
def test_a_sentence_or_it_works(name: str, tmp_path: Path) -> None:
    streams, changes, code = SURROUNDINGS[name]
    path = lc.save(CUBE, tmp_path / "c.npz")
    compute = f"play {path} -o {tmp_path / 'o.npy'} --stops" if "NUMBA" in str(changes) else f"info {path}"
    done = called(f"{compute} {streams}", changes)
    assert done.returncode == code, done
    assert "Traceback" not in done.stderr
    assert len(done.stderr.splitlines()) == (code == 2)
    if not code and ">" not in streams.replace("2>", ""):
        assert done.stdout.strip()


@pytest.mark.parametrize("streams", ["2>/dev/full", "2>&-", ">/dev/full", ">&-"])
def test_what_cannot_be_is_still_told_by_the_exit_code(streams: str, tmp_path: Path) -> None:
    assert called(f"info {tmp_path / 'gone.npz'} {streams}", {}).returncode == 2


@pytest.mark.parametrize(
    ("words", "code"), [("info {}", 0), ("trace gems -o out", 2), ("trace gems.toml -o out", 2), ("demo", 2)]
)
def test_that_the_current_folder_is_gone_is_told(words: str, code: int, tmp_path: Path) -> None:
    """What is given as a whole path is read all the same."""
    path, gone = lc.save(CUBE, tmp_path / "c.npz"), tmp_path / "gone"
    gone.mkdir()
    done = subprocess.run(
        ["/bin/sh", "-c", f"cd {gone} && rmdir {gone} && exec {sys.executable} -m lightcube {words.format(path)}"],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": str(SOURCES)},
    )
    assert done.returncode == code, done
    assert done.stderr.startswith("lightcube: the current folder is gone: change to one" if code else "")
    assert len(done.stderr.splitlines()) == (code == 2)


@compiled_only
def test_where_no_kernel_can_be_kept_a_command_works_and_says_so(tmp_path: Path) -> None:
    """As for a user without a home, of an installation that is read-only."""
    path = lc.save(CUBE, tmp_path / "c.npz")
    nowhere = {"HOME": "/proc/nowhere", "XDG_CACHE_HOME": "", "NUMBA_CACHE_DIR": "/proc/nowhere"}
    done = called(
        f"play {path} -o {tmp_path / 'o.npy'} --stops",
        {**nowhere, "NUMBA_CACHE_LOCATOR_CLASSES": "UserProvidedCacheLocator"},
    )
    assert done.returncode == 0, done
    assert done.stderr.count("note: there is no place to keep compiled kernels") == 1
    assert (tmp_path / "o.npy").is_file()


def bits(_: int = 0) -> str:
    """What a small cube and a shadow of it are, by a digest; loops are long enough for several threads."""
    grid = lc.Grid((24, 24, 24))
    rig = lc.turntable(grid, [0.0, 50.0, 110.0], elevation_deg=20)
    pictures = np.random.default_rng(0).random((3, *rig.picture_shape, 3)).astype(np.float32)
    cube = lc.solve(lc.Targets(pictures, rig), grid, lc.Recipe(passes=2)).cube
    return hashlib.sha256(cube.extinction.tobytes() + lc.play(cube, [3.0]).tobytes()).hexdigest()


FORKING = """
import multiprocessing, os, sys
from tests.hostile.test_environment import bits
before = bits()
there, here = os.pipe()
child = os.fork()
if not child:
    os.write(here, bits().encode())
    os._exit(0)
os.close(here)
assert os.waitpid(child, 0)[1] == 0
assert os.read(there, 100).decode() == before
for method in multiprocessing.get_all_start_methods():
    with multiprocessing.get_context(method).Pool(2 if method == "fork" else 1) as pool:  # others load all anew
        assert set(pool.map(bits, range(2))) == {before}, method
assert bits() == before
"""


@compiled_only
@pytest.mark.parametrize("threads", ["1", "2"])
def test_children_of_a_program_that_computed_compute_the_same(threads: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", FORKING],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[2],
        env={**os.environ, "NUMBA_NUM_THREADS": threads},
        timeout=300,  # a child that waits for threads it does not have would wait for ever
    )
    assert done.returncode == 0, done.stderr
