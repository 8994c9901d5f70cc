"""Running the pieces of a job on the workers of a dask scheduler: the units at the same time, each where there is room.

Workers get the place of the partial folder and the name of a piece, nothing else: they read the job there and write
what they finish there. A worker may die, and a piece may be solved twice: what stands in the folder is the same.
"""

import logging
import signal
import threading
import time
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from importlib.metadata import version
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from lightcube import cores
from lightcube.backward.job import Job, shares
from lightcube.backward.pieces import Step, solve_piece
from lightcube.errors import InputError
from lightcube.events import Progress, Said, Tell
from lightcube.jobs.partial import DiskStore, load_job
from lightcube.wording import counted

if TYPE_CHECKING:
    from distributed import Client, Future, LocalCluster, Worker

#: The scheduler that is started and ended with the job, with one worker for each core of this machine.
LOCAL = "local"
#: Seconds to look for a scheduler, between two looks at the work, and between two words of a worker.
_CONNECT_S, _BEAT_S, _WORD_S = 10, 0.2, 0.5
#: A piece that fails is tried so many times more: folders on a network do not always answer.
_RETRIES = 2

#: Threads of a worker take turns: each piece has all of its cores, and no two of them lie in its memory.
_TURN = threading.Lock()


def count_workers(scheduler: str) -> int:
    """Tell how many workers a scheduler has; as many as there are cores for ``"local"``.

    Raises
    ------
    InputError
        Where there is no such scheduler, it has no worker, or the extra ``cluster`` is missing.
    """
    if scheduler == LOCAL:
        return _cores()
    with _connected(scheduler) as client:
        count = len(client.nthreads())
    if count == 0:
        raise InputError(f"the scheduler at {scheduler} has no workers: start some with dask worker {scheduler}")
    return count


def run(job: Job, scheduler: str, store: DiskStore, tell: Tell) -> bool:
    """Solve what is not finished of a job on the workers of a scheduler; False where `tell` stopped it.

    Parameters
    ----------
    scheduler
        An address, or ``"local"``.
    store
        In a folder that all workers reach under the same name. Pieces that are stopped, here or by losing the
        scheduler, keep their states there.

    Raises
    ------
    InputError
        Where workers cannot be reached or found, die again and again, or say why they cannot go on.
    """
    done = store.names()
    if not store.is_empty():
        units = len(done.intersection(job.unit_names))
        facts = {"units_done": units, "units": job.units}
        tell(Said(f"going on from {units} of {counted(job.units, 'unit')}", "resumed", facts))
    place = str(store.folder.absolute()) if isinstance(store.folder, Path) else store.folder
    with _connected(scheduler) as client:
        meter, topic = _Meter(job), uuid4().hex
        client.subscribe_topic(topic, meter.hear)
        tasks: dict[str, Future[None]] = {}
        level = None
        for name in (name for name in job.pieces if name not in done):
            said = place, name, version("lightcube"), topic, job.room, level
            tasks[name] = client.submit(solve_there, *said, key=f"{name}-{topic}", retries=_RETRIES)
            if name not in job.unit_names:
                level = tasks[name]
        try:
            stopped = False
            while not (stopped or _settled(tasks.values())):
                time.sleep(_BEAT_S)
                finished = done.union(name for name, task in tasks.items() if task.status == "finished")
                stopped = bool(tell(Progress(*meter(finished), {"pieces": len(finished)})))
            for name, task in tasks.items():
                _check(name, task, scheduler)
            return all(task.done() for task in tasks.values())
        finally:
            _stop(client, tasks.values())


def solve_there(place: str, name: str, written_by: str, topic: str, room: int, after: object) -> None:
    """Solve a piece: what a worker does.

    Parameters
    ----------
    place
        The partial folder.
    name
        Of the piece; those that it needs are finished.
    written_by
        The version of lightcube that asks for it.
    topic
        Under which events ``[name, part of all the work]`` are logged.
    room
        Bytes that it may take to keep pieces of rays.
    after
        The task that is waited for.
    """
    from distributed import get_worker

    from lightcube.kernels import tasks  # here: the compiler comes with it

    worker = get_worker()
    key, told = worker.get_current_task(), 0.0

    def watching(step: Step) -> bool:
        nonlocal told
        if time.monotonic() - told > _WORD_S:
            worker.log_event(topic, [name, step.done])
            told = time.monotonic()
        return _is_unwanted(worker, key)

    with _TURN:
        if _is_unwanted(worker, key):
            return
        tasks.set_threads(min(worker.state.nthreads, cores.default()))
        try:
            if version("lightcube") != written_by:
                raise InputError(f"lightcube is {version('lightcube')} there, and {written_by} here")
            solve_piece(replace(load_job(place), room=room), name, DiskStore(place), watching)
        except InputError as error:
            raise InputError(
                f"the worker at {worker.address} cannot solve {name} in {place} ({error}): mend that, and the same "
                "command goes on"
            ) from error


def dask_setup(worker: "Worker") -> None:
    """Leave Ctrl-C to the program that started this worker; dask calls this in each one of a local scheduler."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _is_unwanted(worker: "Worker", key: Any) -> bool:
    """Whether a running task was cancelled, or whoever wanted it is gone."""
    task = worker.state.tasks.get(key)
    return task is None or task.state == "cancelled"


def _settled(tasks: Iterable["Future[None]"]) -> bool:
    """Whether there is nothing to wait for: all is done, or something went wrong."""
    states = {task.status for task in tasks}
    # lost is what was done by a worker that died: it is done again, which finds the piece finished
    return states <= {"finished"} or not states <= {"pending", "finished", "lost"}


def _check(name: str, task: "Future[None]", scheduler: str) -> None:
    """Raise `InputError` where a task failed."""
    from distributed import KilledWorker

    if not task.done():
        return
    try:
        task.result()
    except InputError:
        raise
    except KilledWorker as error:
        raise InputError(
            f"{error.allowed_failures + 1} workers of {scheduler} died over {name}, for lack of memory perhaps: use "
            "larger ones, or a smaller --memory with another name"
        ) from error
    except CancelledError as error:
        raise InputError(f"the scheduler at {scheduler} is gone: the same command goes on, or without it") from error
    except Exception as error:  # whatever happens on other machines
        raise InputError(
            f"{name} failed at {scheduler} ({' '.join(str(error).split())[:200]}): give scheduler and workers the "
            "same packages as here"
        ) from error


def _stop(client: "Client", tasks: Iterable["Future[None]"]) -> None:
    """Cancel what is not done, and wait until it has kept its state."""
    running = [task for task in tasks if not task.done()]
    if not running or client.status != "running":
        return
    keys = {task.key for task in running}
    client.cancel(running)
    while client.status == "running":
        with suppress(OSError):  # a worker died meanwhile
            if all(keys.isdisjoint(of_worker) for of_worker in client.call_stack().values()):
                return
        time.sleep(_BEAT_S)


@contextmanager
def _connected(scheduler: str) -> Iterator["Client"]:
    """Yield a client of a scheduler; a local one is started, and ends with it."""
    _need_distributed()
    from distributed import Client
    from distributed.utils import silence_logging_cmgr

    with ExitStack() as stack:
        stack.enter_context(silence_logging_cmgr(logging.CRITICAL))  # what goes wrong is said in sentences
        try:
            client = Client(stack.enter_context(_local()) if scheduler == LOCAL else scheduler, timeout=_CONNECT_S)
        except (OSError, ValueError, TypeError) as error:
            raise InputError(
                f"there is no scheduler at {scheduler} ({' '.join(str(error).split())[:150]}): start one with dask "
                "scheduler and give the address that it says, or use local"
            ) from error
        yield stack.enter_context(client)


def _local() -> "LocalCluster":
    """Start a scheduler with its workers."""
    from distributed import LocalCluster

    return LocalCluster(
        n_workers=_cores(),
        threads_per_worker=1,
        memory_limit=None,  # what a unit needs is known: nobody has to be killed for it
        dashboard_address="127.0.0.1:0",  # wherever there is room
        preload=[__name__],
        silence_logs=logging.CRITICAL,
    )


def _cores() -> int:
    _need_distributed()
    from dask.system import CPU_COUNT

    return CPU_COUNT


def _need_distributed() -> None:
    try:
        import distributed  # noqa: F401
    except ImportError:
        raise InputError("--scheduler needs more packages: pip install 'lightcube[cluster]'") from None


class _Meter:
    """How much of a job is done, as its workers tell."""

    def __init__(self, job: Job) -> None:
        work = shares(job)
        total = sum(work.values())
        self._own: Mapping[str, float] = {name: each / total for name, each in work.items()}
        self._before = dict(zip(work, accumulate(self._own.values(), initial=0.0), strict=False))
        self._told: dict[str, float] = {}
        self._passes = job.recipe.passes or 1

    def hear(self, event: tuple[float, tuple[str, float]]) -> None:
        """Take in what a worker says, in a thread of the client's own."""
        name, share = event[1]
        self._told[name] = share

    def __call__(self, finished: Iterable[str]) -> tuple[int, int]:
        """Passes that are done, and all of them, where these pieces are finished."""
        parts = {name: share - self._before[name] for name, share in self._told.copy().items()}
        parts |= {name: self._own[name] for name in finished}
        return round(sum(parts.values()) * self._passes), self._passes
