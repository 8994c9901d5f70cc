"""Units on a real scheduler with workers in processes of their own: killed, stopped, misled; the cube is the same."""

import gc
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube import load
from lightcube.backward.job import Job
from lightcube.backward.solution import merged
from lightcube.backward.solving import make_job
from lightcube.backward.solving import solve_job as solved
from lightcube.cli.console import listening
from lightcube.errors import InputError
from lightcube.events import Progress, Said
from lightcube.jobs import cluster
from lightcube.jobs.partial import DiskStore, open_partial
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.views import spread_angles
from lightcube.pictures.targets import Targets
from tests.backward.test_job import same
from tests.cli.test_cli import pictures, run
from tests.conftest import INTERPRETED
from tests.helpers.recipes import asked
from tests.io.test_cubes import assert_same, content
from tests.io.test_places import bucket

__all__ = ["bucket", "pictures", "run"]

distributed = pytest.importorskip("distributed", reason="schedulers need the extra cluster")

pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")

GRID = Grid((12, 5, 6), 0.7) if INTERPRETED else Grid((12, 13, 14), 0.7)
PASSES = 12 if INTERPRETED else 400
#: Each pass leaves its state and takes its time; whoever gets to the third one of unit-1 first dies of it.
SLOW = """
import os, signal, time
from lightcube.backward import pieces
from lightcube.jobs.partial import DiskStore
pieces.FIRST_CHECKPOINT_S = pieces.CHECKPOINT_S = pieces._PATIENCE = 0.0
WRITE, kept = getattr(DiskStore.keep, "inner", DiskStore.keep), []
def slow(store, name, arrays):
    WRITE(store, name, arrays)
    kept.append(name)
    time.sleep(0.02)
    if DEADLY and kept.count("unit-1") == 3:
        try:
            os.close(os.open(DEADLY, os.O_CREAT | os.O_EXCL))
        except FileExistsError:
            return
        os.kill(os.getpid(), signal.SIGKILL)
slow.inner = WRITE  # dask loads this twice
DiskStore.keep = slow
"""


def some_job(**options: Any) -> Job:
    rig = turntable(GRID, spread_angles(3, elevation_deg=0.0), picture_shape=(12, 4))
    pictures = np.random.default_rng(5).uniform(0.1, 1, (3, 12, 4, 3)).astype(np.float32)
    return make_job(**asked(Targets(pictures, rig), GRID, **{"passes": 9, "units": 4, **options}))


@pytest.fixture(autouse=True)
def few_coarse_passes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lightcube.backward.job.COARSE_PASSES", 5)


@contextmanager
def scheduler(folder: Path, workers: int = 2, deadly: str = "", more: str = "") -> Iterator[str]:
    """A scheduler and its workers, all of them processes."""
    preload = folder / "slow.py"
    preload.write_text(
        f"DEADLY = {deadly!r}\n{SLOW}\nfrom lightcube.backward import job\njob.COARSE_PASSES = 5\n{more}"
    )
    told = folder / "scheduler.json"
    common = ("--dashboard-address", "127.0.0.1:0", "--scheduler-file", str(told))
    begin = "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0"
    work = "-m", "distributed.cli.dask_worker", "--no-nanny", "--nthreads", "1", "--preload", str(preload)
    commands = [(*begin, *common), *[(*work, *common)] * workers]
    with open(folder / "log.txt", "wb") as log:  # noqa: PTH123
        running = [subprocess.Popen([sys.executable, *each], cwd=folder, stdout=log, stderr=log) for each in commands]
        try:
            with distributed.Client(scheduler_file=str(told), timeout=60) as client:
                client.wait_for_workers(workers, timeout=60)
                address = client.scheduler.address
            yield address
        finally:
            for each in running:
                each.kill()
                each.wait()


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Two workers for all tests that leave them as they are."""
    with scheduler(tmp_path_factory.mktemp("two")) as address:
        yield address


def wait_for(true: Callable[[], object]) -> None:
    for _ in range(600):
        if true():
            return
        time.sleep(0.1)
    raise TimeoutError


def going_on(event: Progress | Said) -> bool:
    """Nobody stops the work."""
    return False


def test_one_worker_is_killed_and_the_cube_is_the_same(tmp_path: Path) -> None:
    made, marker = some_job(), tmp_path / "killed"
    store = open_partial(tmp_path / "a.zarr", made)
    with scheduler(tmp_path, deadly=str(marker)) as address:
        assert cluster.count_workers(address) == 2
        assert cluster.run(made, address, store, going_on)
        assert cluster.count_workers(address) == 1
    assert marker.exists()
    assert store.names() == set(made.pieces)
    assert same(merged(made, store), solved(made))


def begun(job: Job, store: DiskStore) -> bool:
    """Whether a unit is on its way."""
    return any(store.state(name) is not None for name in job.unit_names)


def pressing(monkeypatch: pytest.MonkeyPatch, pieces: int) -> None:
    """Press Ctrl-C once so many pieces are finished and a unit is on its way."""
    real = cluster._Meter.__call__

    def press(self: Any, finished: set[str]) -> tuple[int, int]:
        if len(finished) >= pieces and any(name.startswith("unit") for name in self._told):
            signal.raise_signal(signal.SIGINT)
        return real(self, finished)

    monkeypatch.setattr(cluster._Meter, "__call__", press)


def test_ctrl_c_keeps_states_and_the_work_goes_on_here(
    two: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = some_job(passes=PASSES)
    store = open_partial(tmp_path / "a.zarr", made)
    pressing(monkeypatch, 1)
    with listening("solving", as_json=True) as tell:
        assert not cluster.run(made, two, store, tell)
    with distributed.Client(two) as client:
        assert not any(client.call_stack().values())
    before = content(Path(store.folder))
    time.sleep(0.2)
    assert content(Path(store.folder)) == before
    assert begun(made, store)
    assert 0 < len(merged(made, store).residuals) < PASSES
    assert same(solved(made, store), solved(made))


def test_workers_stop_when_nobody_wants_their_work(two: str, tmp_path: Path) -> None:
    made = some_job(passes=PASSES)
    store = open_partial(tmp_path / "a.zarr", made)
    program = (
        "from lightcube.jobs import cluster; import sys\n"
        "from lightcube.jobs.partial import DiskStore, load_job\n"
        "store = DiskStore(sys.argv[1])\n"
        "cluster.run(load_job(sys.argv[1]), sys.argv[2], store, print)"
    )
    with subprocess.Popen([sys.executable, "-c", program, str(store.folder), two]) as client:
        wait_for(lambda: begun(made, store))
        client.kill()
    with distributed.Client(two) as client:
        wait_for(lambda: not any(client.call_stack().values()))
    assert len(store.names()) < len(made.pieces)
    assert begun(made, store)


def test_workers_say_what_is_wrong(two: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = some_job()
    store = open_partial(tmp_path / "a.zarr", made)
    with monkeypatch.context() as patch:
        patch.setattr(cluster, "version", lambda _: "9")
        with pytest.raises(InputError, match=r"lightcube is .* there, and 9 here"):
            cluster.run(made, two, store, going_on)
    (Path(store.folder) / "level-1.npz").write_bytes(b"half")
    with pytest.raises(InputError, match=r"worker at tcp://.* cannot solve unit-. .*level-1.npz is damaged"):
        cluster.run(made, two, store, going_on)


def test_a_local_scheduler_comes_and_goes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = some_job(lamp_power=1.0, units=3)  # no coarse passes: they are as many as they are in other processes
    monkeypatch.setattr("dask.system.CPU_COUNT", 2)
    assert cluster.count_workers("local") == 2
    before = children()  # a browser, say
    store = open_partial(tmp_path / "a.zarr", made)
    assert cluster.run(made, "local", store, going_on)
    assert not {at: line for at, line in children().items() if at not in before}
    assert same(merged(made, store), solved(made))


def children() -> dict[int, str]:
    """Commands of the processes that this one has started and that are still there, by their numbers."""
    psutil = pytest.importorskip("psutil")
    lines = {child.pid: " ".join(child.cmdline()) for child in psutil.Process().children(recursive=True)}
    return {number: line for number, line in lines.items() if "resource_tracker" not in line}


def test_schedulers_that_are_not_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "_CONNECT_S", 0.2)
    for address in ("tcp://127.0.0.1:1", "fax://127.0.0.1:1", "tcp://127.0.0.1:x", "nowhere at all"):
        with pytest.raises(InputError, match=f"there is no scheduler at {address}"):
            cluster.count_workers(address)
        gc.collect()  # what dask leaves of a client that did not connect must not be found while the next one starts
    monkeypatch.setitem(sys.modules, "distributed", None)
    for name in ("local", "tcp://127.0.0.1:1"):
        with pytest.raises(InputError, match=r"pip install 'lightcube\[cluster\]'"):
            cluster.count_workers(name)


@pytest.mark.skipif(INTERPRETED, reason="five interpreted solves take too long")
def test_the_command_line_solves_there_or_here(  # type: ignore[no-untyped-def]
    run, pictures: Path, bucket: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Begun with three workers and stopped, gone on with two, finished without any: at a URL."""
    out, here = f"{bucket}/cluster/a.npz", tmp_path / "a.npz"
    said = (
        "--shape",
        "6,7,8",
        "--hold-deg",
        "0",
        "--iterations",
        str(PASSES),
        "--max-extinction",
        "1",
        "--elevation-deg",
        "0",
    )
    with scheduler(tmp_path, workers=3) as address:
        for workers in (3, 2):
            with distributed.Client(address) as client:
                client.retire_workers(list(client.has_what())[workers:])
            assert cluster.count_workers(address) == workers
            with monkeypatch.context() as patch:
                pressing(patch, 1)
                stopped = run("solve", pictures, "-o", out, *said, "--scheduler", address)
            assert stopped.code == 130, stopped.err
            assert "the same command goes on" in stopped.err
    again = run("solve", pictures, "-o", out, *said)
    assert again.code == 0, again.err
    assert " of 3 units" in again.err
    for unit in ("1/3", "2/3", "3/3"):
        assert run("solve", pictures, "-o", here, *said, "--unit", unit).code == 0
    assert run("publish", f"{here}.partial").code == 0
    assert_same(load(out), load(here))


def test_one_says_how_many_units_there_are(run, pictures: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    told = run("solve", pictures, "-o", tmp_path / "a.npz", "--unit", "1/2", "--scheduler", "local")
    assert told.code == 2
    assert "--unit and --scheduler both say" in told.err
