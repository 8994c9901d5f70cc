"""Programs that are started with streams closed or full, and in odd surroundings: a sentence, or it works."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import lightcube as lc
from tests.hostile.bombs import CUBE

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
