"""What `lightcube bench` says: counted work, whole tables, absent peers. How fast anything is, no test knows."""

import builtins
import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube import bench
from lightcube.bench import clock, limits, loops, others, playing, products, starting
from lightcube.bench.report import markdown
from lightcube.cli.main import run
from lightcube.kernels import tasks
from tests.conftest import INTERPRETED

N = 4 if INTERPRETED else 24


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks so small that an interpreter is through with them, and one start instead of four."""
    monkeypatch.setattr(limits, "L1", 1024)
    monkeypatch.setattr(limits, "L2", 2048)
    monkeypatch.setattr(limits, "MEMORY", 4096)
    monkeypatch.setattr(limits, "_ROWS", 8)
    monkeypatch.setattr(bench, "_QUICK_LASTING", 1e-4)


@pytest.fixture
def no_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "starts", lambda: [{"command": "--help", "seconds": 1.0}])


def finite(found: Any) -> bool:
    if isinstance(found, dict):
        return all(finite(each) for each in found.values())
    if isinstance(found, list):
        return all(finite(each) for each in found)
    return not isinstance(found, float) or (math.isfinite(found) and found >= 0)


@pytest.mark.usefixtures("no_starts")
@pytest.mark.parametrize("peer_installed", [True, False])
def test_all_is_measured_and_all_is_in_the_tables(peer_installed: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if not peer_installed:
        real = builtins.__import__

        def missing(name: str, *rest: Any) -> Any:
            if name in ("astra", "torch"):
                raise ImportError(name)
            return real(name, *rest)

        monkeypatch.setattr(builtins, "__import__", missing)
    else:
        pytest.importorskip("astra")
    said: list[str] = []
    before = tasks.threads()
    found = bench.measure(N, 3, said.append, quick=True)
    assert tasks.threads() == before
    assert finite(found)
    assert {(each["elevation_deg"], each["threads"]) for each in found["kernels"]} == {
        (elevation_deg, threads) for elevation_deg in (0, 35) for threads in (1, before)
    }
    text = "\n".join(markdown(found))
    assert ("absent" not in text.replace("torch CSR @ dense | absent", "")) == peer_installed
    assert all(peer["name"] in text for peer in found["peers"])
    assert any("peer: scipy" in line for line in said)
    for line in text.splitlines():
        assert not line.startswith("|") or line.count("|") in (3, 4, 5, 6, 7)


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0, -20.0])
def test_multiply_adds_are_the_matrix_times_the_columns(elevation_deg: float) -> None:
    matrix = products.projector(5, 11, elevation_deg)
    assert products.columns_of(matrix) == (15 if elevation_deg == 0 else 3)
    assert products.multiply_adds(matrix) == matrix.to_sparse().nnz * products.columns_of(matrix)


def test_the_peers_have_the_same_matrix() -> None:
    matrix = products.projector(5, 3, 0.0)
    expected = matrix.to_sparse()
    assert np.allclose(others._sparse(matrix).toarray(), expected.toarray(), rtol=1e-6)


def test_peers_are_extrapolated_from_their_slice(monkeypatch: pytest.MonkeyPatch) -> None:
    def run(matrix: Any, repeats: int) -> others.Times:
        return {"seconds": 1.0, "median": 2.0}, {"seconds": 3.0, "median": 4.0}

    monkeypatch.setattr(others, "_PEERS", [("it", "numpy", "two columns", 2, run)])
    (peer,) = others.peers(products.projector(6, 2, 0.0), 9.0, 1, lambda name: None)
    assert (peer["parts"], peer["seconds"], peer["median"], peer["ratio"]) == (9, 36, 54, 4)
    assert (peer["forward"], peer["adjoint"]) == (9, 27)


def test_a_rate_is_how_often_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 0.0

    def work(times: int) -> None:
        nonlocal now
        now += 0.25 * times

    monkeypatch.setattr("lightcube.bench.clock.time.perf_counter", lambda: now)
    assert clock.rate(work, 10.0, 2) == pytest.approx(4)
    assert clock.seconds(lambda: work(2), 3) == {"seconds": 0.5, "median": 0.5}


@pytest.mark.parametrize("threads", [1, 2])
def test_the_loops_do_what_their_ceilings_count(threads: int) -> None:
    random = np.random.default_rng(0)
    blocks = random.random((threads, 5 * loops.ROW)).astype(np.float32)
    places = random.integers(0, 5, (threads, 7)).astype(np.int32) * loops.ROW
    weights = random.random(7).astype(np.float32)
    sums = np.zeros((threads, loops.ROW), np.float32)
    loops.from_rows(2, sums, blocks, places, np.zeros(7, np.int32), weights)
    rows = blocks.reshape(threads, 5, loops.ROW)
    for thread in range(threads):
        assert np.allclose(sums[thread], 2 * weights @ rows[thread][places[thread] // loops.ROW], rtol=1e-5)
    a, b, c = random.random((3, 101)).astype(np.float32)
    assert loops.read(a, threads).sum() == pytest.approx(a.sum(), rel=1e-5)
    loops.triad(a, b, c, threads)
    assert np.allclose(a, b + c / 2)
    assert np.all(loops.from_registers(60, loops.CHAINS[0], threads) == 2 * loops.CHAINS[0])


def test_the_second_of_two_starts_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[list[str]] = []
    monkeypatch.setattr("lightcube.bench.starting.subprocess.run", lambda command, **_: started.append(command))
    found = starting.starts()
    assert [each["command"] for each in found] == ["--help", "info", "play"]
    assert [command[3] for command in started] == ["--help", "--help", "info", "info", "play", "play"]
    monkeypatch.undo()
    subprocess.run([sys.executable, *started[0][1:]], check=True, capture_output=True)


@pytest.mark.usefixtures("no_starts")
def test_the_command_prints_json_or_tables(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    measured: list[tuple[int, int, bool]] = []

    def measure(n: int, views: int, say: Any, *, quick: bool) -> dict[str, Any]:
        measured.append((n, views, quick))
        say("something")
        return {"found": 1.0}

    monkeypatch.setattr(bench, "measure", measure)
    for words in (["--n", "3", "--json", "--quick"], ["--n", "3", "--pictures", "2", "--json"]):
        assert run(["bench", *words]) == 0
        printed = capsys.readouterr()
        assert json.loads(printed.out) == {"found": 1.0}
        assert "something ..." in printed.err
    assert measured == [(3, 3, True), (3, 2, False)]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--n", "1"], "--n"),
        (["--pictures", "0"], "--pictures"),
        (["--n", "2000", "--pictures", "100000"], "of memory"),
    ],
)
def test_bad_sizes_get_a_sentence(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["bench", *words]) == 2
    assert said in capsys.readouterr().err


def test_playback_shows_whole_screens() -> None:

    found = playing.playback(6, 35.0, 1)
    assert (found["rows"], found["columns"]) == (12, 10)
