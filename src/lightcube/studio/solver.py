"""What makes things, in a process of its own: it tells what happens through a pipe, and stops when it is told to."""

from __future__ import annotations

import signal
import threading
import time
import warnings
from base64 import b64encode
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any, Literal

from lightcube.errors import InputError
from lightcube.events import Interrupted, Progress, Said
from lightcube.studio.kept import png

#: Seconds between two looks at the wall at least, and so many times as long as one takes.
_LOOK_S, _PATIENCE = 0.7, 6.0
#: The same of cubes to be turned.
_TURN_S, _TURN_PATIENCE = 2.0, 12.0

Deed = Literal["start", "resume", "keep"]


@dataclass(frozen=True)
class Task:
    """What is to be made: of which pictures or room, where, how (as its verb takes it), and what it is called."""

    source: str
    out: str
    how: Any
    title: str


def run(pipe: Connection, make: Make, deed: Deed, task: Task) -> None:
    """Do what is asked for; the last that is told says how it ended.

    Parameters
    ----------
    make
        Makes a thing of its kind.
    deed
        Start anew, go on with what there is unfinished, or make the thing of what is there.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever began this says when it ends
    warnings.simplefilter("ignore")
    told = Told(pipe)
    try:
        make(told, deed, task)
    except Interrupted:
        told("stopped")
    except InputError as error:
        told("failed", sentence=f"{error}")
    except MemoryError:
        told("failed", sentence="the machine has not enough memory for this: make it smaller")
    except OSError as error:
        told("failed", sentence=f"the system refused it ({error.strerror or error}): make room, and go on")


class Told:
    """What is told through the pipe; nobody at its other end is as good as being told to stop."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe, self._lock = pipe, threading.Lock()
        self.stopping = threading.Event()
        threading.Thread(target=self._listen, daemon=True).start()

    def __call__(self, what: str, **facts: Any) -> None:
        """Tell something and its facts."""
        try:
            with self._lock:
                self._pipe.send((what, facts))
        except OSError:
            self.stopping.set()

    def compiling(self) -> None:
        """Tell that there is something to be compiled."""
        self("said", sentence="compiling, once: about half a minute", compiling=True)

    def event(self, event: Progress | Said) -> bool:
        """Tell what a verb tells; True where it is to stop."""
        if isinstance(event, Progress):
            figures = dict(event.figures)
            self("progress", done=event.done, of=event.of, psnr=figures.get("PSNR"), left_s=event.left_s)
        else:
            self("said", sentence=event.sentence, compiling=False)
        return self.stopping.is_set()

    def wall(self, names: Iterable[str], shown: Iterable[Any], fine: int) -> None:
        """Tell what the walls show, each in 8-bit levels."""
        images = (b64encode(png(levels)).decode() for levels in shown)
        pictures = [{"name": name, "image": image} for name, image in zip(names, images, strict=True)]
        self("wall", pictures=pictures, voxels=fine)

    def turn(self, thing: Any, title: str) -> None:
        """Tell a thing as the viewer takes it."""
        from lightcube.viewer.description import zipped
        from lightcube.viewer.page import parts_of

        description, data = parts_of(thing, title)
        self("cube", scene=zipped(description), voxels=data)

    def _listen(self) -> None:
        with suppress(EOFError, OSError):
            self._pipe.recv()
        self.stopping.set()


#: Makes a thing of a kind: see `run`.
Make = Callable[[Told, Deed, Task], None]


def solve(told: Told, deed: Deed, task: Task) -> None:
    """Solve a cube or films from the beginning or from where it was, or keep what is there."""
    if deed == "keep":
        _keep(told, task)
        return
    told("said", sentence="getting ready", compiling=False)
    from lightcube.kernels.compiled import when_compiling  # here: the compiler comes with it

    with when_compiling(told.compiling):
        from lightcube.backward.needs import job_memory
        from lightcube.jobs import publishing, running
        from lightcube.jobs.partial import DiskStore, load_job, open_partial, partial_path
        from lightcube.verbs import solving

        if deed == "resume":
            job, store = load_job(partial_path(task.out)), DiskStore(partial_path(task.out))
        else:
            planned = solving.read(task.source, task.how, told=False)(solving.rehearsals())
            job = solving.job(planned)
            solving.check_memory(job_memory(job))
            store = open_partial(task.out, job, overwrite=True)
        show = _Show(told, task.title)
        if not running.run(job, job.pieces, store, told.event, show):
            told("stopped")
            return
        told("said", sentence="looking at what it shows", compiling=False)
        cube = publishing.finish(job, store, task.out, overwrite=True).solution.cube
    show.wall(cube)
    told.turn(cube, task.title)
    told("done", **_facts(cube))


def _keep(told: Told, task: Task) -> None:
    """Make a cube of what is there."""
    from lightcube.jobs import publishing
    from lightcube.jobs.partial import partial_path
    from lightcube.scoring import metrics

    cube = publishing.publish(partial_path(task.out), overwrite=True).solution.cube
    _Show(told, task.title).wall(cube)
    told.turn(cube, task.title)
    told("kept", **_facts(cube, metrics.score(cube) if cube.targets is not None else None))


def _facts(cube: Any, scores: Any = None) -> dict[str, Any]:
    """How good a cube is, picture by picture."""
    found = scores or cube.scores
    pictures = [
        {"name": name, "psnr": None if view["psnr"] is None else float(view["psnr"])}
        for name, view in zip(cube.names, found.get("pictures", []), strict=False)
    ]
    return {"pictures": pictures, "psnr": float(found["psnr_mean"]) if "psnr_mean" in found else None}


class _Show:
    """Watches a solve: what the wall shows now, and the cube to be turned, as often as it costs little."""

    def __init__(self, told: Told, title: str) -> None:
        self._told, self._title, self._next_wall, self._next_turn = told, title, 0.0, 0.0

    def __call__(self, step: Any) -> None:
        """Look, where it is time."""
        now = time.monotonic()
        if step.cube is None or now < min(self._next_wall, self._next_turn):
            return
        cube = step.cube()
        if now >= self._next_wall:
            self.wall(cube)
            self._next_wall = time.monotonic() + max(_LOOK_S, _PATIENCE * (time.monotonic() - now))
        if now >= self._next_turn:
            began = time.monotonic()
            self._told.turn(cube, self._title)
            self._next_turn = time.monotonic() + max(_TURN_S, _TURN_PATIENCE * (time.monotonic() - began))

    def wall(self, cube: Any) -> None:
        """Tell what the wall shows at each stop."""
        from lightcube.forward.casting import cast
        from lightcube.optics.transfer import to_uint8

        shown = (to_uint8(picture, cube.transfer) for picture in cast(cube))
        self._told.wall(cube.names, shown, int(max(cube.grid.shape)))
