"""Kernels on several threads: the same bits for any number, at once, after a fork, with Ctrl-C; and what is refused."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lightcube
from lightcube import cores
from lightcube.__main__ import main
from lightcube.backward.recipe import Recipe
from lightcube.backward.solving import solve
from lightcube.errors import InputError
from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled
from lightcube.optics.grid import Grid
from lightcube.optics.law import Mixture, shown_light
from lightcube.optics.setups import turntable
from lightcube.optics.views import spread_angles, turntable_views
from lightcube.pictures.targets import Targets
from lightcube.projection.projector import Projector
from lightcube.projection.rays import Rays
from lightcube.scene.tracer import scene_rig, scene_targets
from lightcube.solvers.contract import Lighting, Wanted
from lightcube.solvers.display import display_values
from tests.conftest import INTERPRETED
from tests.helpers.recipes import asked
from tests.helpers.solver_problems import DenseOperator
from tests.projection.test_rays import BRICKS, lamps_for, lit, screens_for

FIVE = Recipe(passes=5)
compiled_only = pytest.mark.skipif(INTERPRETED, reason="there is one thread")
ROOT = Path(__file__).parents[2]


@pytest.fixture
def little_is_worth_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Threads share even the smallest loops, task by task."""
    monkeypatch.setattr(tasks, "LEAST_WORK", 1)


@pytest.fixture(autouse=True)
def as_before() -> Iterator[None]:
    with tasks.using(tasks.threads()):
        yield


def pictures(number: int = 0, elevation_deg: float = 35.0) -> tuple[Targets, Grid]:
    grid = Grid((2, 19, 18))
    views = turntable(
        grid, spread_angles(3, elevation_deg=elevation_deg), elevation_deg=elevation_deg, picture_shape=(2, 9)
    )
    return Targets(np.random.default_rng(number).random((3, 2, 9, 3), dtype=np.float32), views), grid


def of_solver(method: str, elevation_deg: float, **options: Any) -> list[Any]:
    targets, grid = pictures(elevation_deg=elevation_deg)
    solution = solve(**asked(targets, grid, method=method, passes=4, **options))
    return [solution.cube.extinction, solution.cube.powers, solution.residuals]


def of_matrix() -> list[Any]:
    found = []
    for elevation_deg, views in ((0.0, 1), (0.0, 9), (35.0, 4)):
        grid = Grid((2, 19, 18))
        matrix = Projector(grid, turntable_views(grid, np.arange(views) * 17.0 + 3, elevation_deg=elevation_deg))
        x = np.random.default_rng(0).random((matrix.shape[1], 6 if elevation_deg == 0 else 3), dtype=np.float32)
        found += [matrix.forward(x), matrix.adjoint(matrix.forward(x))]
    return found


def of_rays() -> list[Any]:
    found = []
    for shape in BRICKS:
        grid = Grid(shape)
        lamps = [lamps_for(shape)[name] for name in ("-y", "aslant", "near", "inside")]
        matrix = Rays(grid, lit(grid, lamps, list(screens_for(shape).values()), (2, 3)))
        for columns in (3, 5):
            x = np.random.default_rng(0).random((matrix.shape[1], columns), dtype=np.float32)
            found += [matrix.forward(x), matrix.adjoint(matrix.forward(x))]
    return found


def of_mixture() -> list[Any]:
    random = np.random.default_rng(0)
    views, pixels = 60, 300
    lit = random.random((2, views, pixels), dtype=np.float32)
    mixture = Mixture(np.array([0, 50, 60]), random.random((views, 3)), *lit)
    matrix = DenseOperator(random.random((views * pixels, 4)).astype(np.float32))
    wanted = random.uniform(0.1, 9, (2 * pixels, 3)).astype(np.float32)
    found = []
    for lamp in (np.arange(views) // 25, np.arange(views) // 50):  # several lamps for a picture, and one for each
        lamps = np.full((lamp[-1] + 1, 3), 0.01), np.full((lamp[-1] + 1, 3), 4.0)
        wish = Wanted(wanted, lighting=Lighting(lamp, mixture), lamp_bounds=lamps)
        result = display_values(matrix, wish, iterations=6)
        found += [result.x, result.lamp_powers, result.residuals]
    return found


def of_light() -> list[Any]:
    random = np.random.default_rng(0)
    lit = random.random((2, 60, 1300), dtype=np.float32)
    mixture = Mixture(np.array([0, 50, 59, 60]), random.random((60, 3)), *lit)
    return [shown_light(mixture, random.random((60, 3)), random.random((60, 3900), dtype=np.float32), (26, 50))]


def of_scene() -> list[Any]:
    scene = lightcube.read_scene("gems")
    grid, views = scene_rig(scene, 2, (12, 9), None, None)
    shaded = lightcube.read_scene("juggler")
    return [
        scene_targets(scene, views, grid).pictures,
        scene_targets(shaded, scene_rig(shaded, 2, (12, 9), None, None)[1], grid).pictures,
    ]


OPERATIONS: dict[str, Callable[[], list[Any]]] = {
    "matrix": of_matrix,
    "rays": of_rays,
    "mixture": of_mixture,
    "light": of_light,
    "scene": of_scene,
    "display, raised": lambda: of_solver("display", 35.0),
    "display, level, held": lambda: of_solver("display", 0.0, hold_deg=3.0),
    "display, bounded": lambda: of_solver("display", 35.0, max_extinction=0.5),
    "gauss-seidel": lambda: of_solver("gauss-seidel", 0.0),
    "row-reduction": lambda: of_solver("row-reduction", 0.0),
    "sirt": lambda: of_solver("sirt", 35.0),
    "cgls": lambda: of_solver("cgls", 35.0),
}


@compiled_only
@pytest.mark.usefixtures("little_is_worth_it")
@pytest.mark.parametrize("operation", OPERATIONS)
def test_results_are_the_same_for_any_number_of_threads(operation: str) -> None:
    found = []
    for count in (1, 2, 3, 5):
        tasks.set_threads(count)
        found.append([np.ascontiguousarray(array).tobytes() for array in OPERATIONS[operation]()])
    assert all(each == found[0] for each in found)


@pytest.mark.usefixtures("little_is_worth_it")
def test_cubes_may_be_solved_at_the_same_time_in_one_process() -> None:
    tasks.set_threads(3)
    alone = [solve(*pictures(number), recipe=FIVE).cube.extinction for number in range(4)]
    with ThreadPoolExecutor(4) as pool:
        together = pool.map(lambda number: solve(*pictures(number), recipe=FIVE).cube.extinction, [*range(4)] * 3)
        assert all(np.array_equal(alone[index % 4], found) for index, found in enumerate(together))


@compiled
def count_up(first: int, last: int, times: int, counts: np.ndarray[Any, Any]) -> None:
    """Spend some time on each task, and count how often it is done."""
    for task in range(first, last):
        x = 1.0
        for i in range(times):
            x = x * 1.0000001 + 1e-9 * i
        counts[task] += 1 if x > 0 else 2


@pytest.mark.parametrize("threads", [1, 2, 5])
@pytest.mark.parametrize("count", [0, 1, 2, 7, 1000])
@pytest.mark.parametrize("work", [0, 1, tasks.LEAST_WORK, 3 * tasks.LEAST_WORK, 10**12])
def test_every_task_is_done_once(work: int, count: int, threads: int) -> None:
    tasks.set_threads(threads)
    counts = np.zeros(count, np.int64)
    tasks.run(count_up, count, work, 3, counts)
    assert np.all(counts == 1)


def test_small_work_wakes_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr(tasks._Helpers, "call", never)
    tasks.set_threads(2)
    tasks.run(count_up, 100, tasks.LEAST_WORK, 3, np.zeros(100, np.int64))


def test_what_goes_wrong_in_a_helper_comes_to_whoever_called() -> None:
    here, helped = threading.get_ident(), threading.Event()

    def broken(first: int, last: int) -> None:
        if threading.get_ident() == here:
            helped.wait(20)
        else:
            helped.set()
            raise ZeroDivisionError

    if not INTERPRETED:
        tasks.set_threads(2)
        with pytest.raises(ZeroDivisionError):
            tasks.run(broken, 100, 10**9)
    counts = np.zeros(50, np.int64)
    tasks.run(count_up, 50, 10**9, 3, counts)
    assert np.all(counts == 1)


def test_a_machine_that_gives_no_threads_computes(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(_: object) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refused)
    monkeypatch.setattr(tasks, "_helpers", tasks._Helpers())
    tasks.set_threads(2)
    counts = np.zeros(50, np.int64)
    tasks.run(count_up, 50, 10**9, 3, counts)
    assert np.all(counts == 1)


@compiled_only
@pytest.mark.parametrize("threads", [1, 2])
def test_other_threads_run_while_a_kernel_does(threads: int) -> None:
    """One long call: if it held Python's lock, the other thread would stand still for as long as it takes."""
    tasks.set_threads(threads)
    tasks.run(count_up, 1, 1, 3, np.zeros(1, np.int64))  # compiled
    turns, ended = [time.monotonic()], threading.Event()

    def tick() -> None:
        while not ended.is_set():
            turns.append(time.monotonic())
            time.sleep(1e-3)

    other = threading.Thread(target=tick)
    other.start()
    began = time.monotonic()
    tasks.run(count_up, 1, 1, 2 * 10**8, np.zeros(1, np.int64))
    took = time.monotonic() - began
    ended.set()
    other.join()
    assert np.max(np.diff(turns)) < 0.7 * took


@compiled_only
@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_in_a_kernel_ends_it_soon_and_the_next_one_runs(threads: int) -> None:
    tasks.set_threads(threads)
    counts = np.zeros(10_000, np.int64)
    tasks.run(count_up, 1, 1, 3, counts)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT))
    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            tasks.run(count_up, len(counts), 10**12, 10**6, counts)
    finally:
        timer.join()
        signal.signal(signal.SIGINT, before)
    done = counts.sum()
    assert done < 2000  # not all of them
    time.sleep(0.1)
    assert counts.sum() == done  # nobody goes on behind the caller's back
    counts[:] = 0
    tasks.run(count_up, len(counts), 10**12, 3, counts)
    assert np.all(counts == 1)


def _solve_after_fork(wanted: np.ndarray[Any, Any], answers: Any) -> None:
    same = np.array_equal(solve(*pictures(), recipe=FIVE).cube.extinction, wanted)
    helped = INTERPRETED or any(each.name.startswith("lightcube-") for each in threading.enumerate())
    answers.put((bool(same), helped))


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="processes do not fork here")
@pytest.mark.usefixtures("little_is_worth_it")
def test_a_forked_process_solves_too() -> None:
    tasks.set_threads(3)
    wanted = solve(*pictures(), recipe=FIVE).cube.extinction
    fork = multiprocessing.get_context("fork")
    answers = fork.Queue()
    child = fork.Process(target=_solve_after_fork, args=(wanted, answers), daemon=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # that there are threads, as of Python 3.12
        child.start()
    try:
        assert answers.get(timeout=120) == (True, True)
    finally:
        child.kill()
        child.join()
    assert np.array_equal(solve(*pictures(), recipe=FIVE).cube.extinction, wanted)


@pytest.mark.parametrize("count", [0, -1, 2.0, "two", True])
def test_what_is_no_number_of_threads_is_refused(count: Any) -> None:
    before = lightcube.threads()
    with pytest.raises(InputError, match="give a whole number of at least 1"):
        lightcube.threads(count)
    assert lightcube.threads() == before


def test_more_threads_than_cores_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NUMBA_NUM_THREADS", raising=False)
    with pytest.raises(InputError, match=f"threads: {cores.free_cores() + 1} are too many"):
        lightcube.threads(cores.free_cores() + 1)
    assert lightcube.threads(cores.free_cores()) == lightcube.threads() == cores.free_cores()


def test_the_environment_says_how_many_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tasks, "_threads", None)
    monkeypatch.setenv("NUMBA_NUM_THREADS", "7")
    assert lightcube.threads() == 7
    assert lightcube.threads(7) == 7
    with pytest.raises(InputError, match="threads: 1 contradicts NUMBA_NUM_THREADS=7"):
        lightcube.threads(1)


@pytest.mark.parametrize("said", ["0", "many"])
def test_an_environment_that_says_nonsense_is_a_sentence(said: str) -> None:
    """Numba alone would end with a traceback, at the import."""
    told = {**os.environ, "NUMBA_NUM_THREADS": said}
    command = [sys.executable, "-c", "from lightcube.__main__ import main; main()", "score", "no.zarr"]
    run = subprocess.run(command, env=told, capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert run.stderr == (
        f"lightcube: NUMBA_NUM_THREADS={said} in the environment: give a whole number of at least 1, or leave it out\n"
    )


@pytest.mark.parametrize("said", ["0", "-1", "two", "1.5", "1000000"])
def test_the_command_line_refuses_what_is_no_number_of_threads(
    said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("NUMBA_NUM_THREADS", raising=False)
    monkeypatch.setattr(sys, "argv", ["lightcube", "solve", "no-folder", "-o", "no.zarr", f"--threads={said}"])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
    assert "threads" in line
    assert "give" in line


def test_threads_of_the_command_line_hold_and_stand_in_no_cube(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_NUM_THREADS", "2")
    lightcube.save(pictures()[0].pictures, tmp_path / "pictures")
    for name, options in (("one", ["--threads", "2"]), ("other", [])):
        tasks.set_threads(1)
        command = ["lightcube", "solve", str(tmp_path / "pictures"), "-o", str(tmp_path / f"{name}.zarr"), "--n", "9"]
        monkeypatch.setattr(sys, "argv", [*command, "--iterations", "2", "--elevation-deg", "0", *options])
        with pytest.raises(SystemExit) as stop:
            main()
        assert not stop.value.code
        assert lightcube.threads() == (2 if options else 1)
    one, other = (lightcube.load(str(tmp_path / f"{name}.zarr")) for name in ("one", "other"))
    assert one.provenance == other.provenance
    assert np.array_equal(one.extinction, other.extinction)


def test_free_cores_are_those_of_affinity_and_container(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(8)), raising=False)
    monkeypatch.setattr(cores, "_GROUPS", tmp_path)
    group, old = tmp_path / "a" / "b", tmp_path / "cpu" / "c"
    group.mkdir(parents=True)
    old.mkdir(parents=True)
    lines = ["4:cpu,cpuacct:/c", "3:memory:/c", "0::/a/b"]
    real = cores._lines
    monkeypatch.setattr(cores, "_lines", lambda file: lines if file.is_relative_to("/proc") else real(file))
    assert cores.free_cores() == 8
    (group / "cpu.max").write_text("max 100000\n")
    assert cores.free_cores() == 8
    (tmp_path / "a" / "cpu.max").write_text("250000 100000\n")
    assert cores.free_cores() == 3
    (old / "cpu.cfs_quota_us").write_text("-1\n")
    (old / "cpu.cfs_period_us").write_text("100000\n")
    assert cores.free_cores() == 3
    (old / "cpu.cfs_quota_us").write_text("50000\n")
    assert cores.free_cores() == 1


_WITHOUT_CACHE = """
import warnings
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    import numpy as np
    import lightcube
    from lightcube.kernels.momentum import run_ahead
    x, ahead = np.ones((3, 5)), np.ones(5)
    for _ in range(2):
        run_ahead(x, x + 1, ahead)
    print(np.all(x == 5))
print(*(each.message for each in said), sep="; ")
"""


@compiled_only
def test_where_nothing_can_be_written_kernels_run_and_a_note_says_so(tmp_path: Path) -> None:
    """A folder that is a file: as for a user without a home of an installation that is not theirs."""
    (tmp_path / "no-folder").touch()
    told = {
        **os.environ,
        "NUMBA_CACHE_LOCATOR_CLASSES": "UserProvidedCacheLocator",
        "NUMBA_CACHE_DIR": str(tmp_path / "no-folder" / "cache"),
    }
    run = subprocess.run([sys.executable, "-c", _WITHOUT_CACHE], env=told, capture_output=True, text=True, check=False)
    assert run.stderr == ""
    lines = run.stdout.splitlines()
    assert lines[0] == "True"
    assert lines[1].startswith("there is no place to keep compiled kernels")
    assert ";" not in lines[1]
