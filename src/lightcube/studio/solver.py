"""What makes things, in a process of its own: it tells what happens through a pipe, and stops when it is told to."""

from __future__ import annotations

import time
from base64 import b64encode
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any, Literal

from lightcube.studio.kept import png
from lightcube.studio.worker import Told, telling

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
    with telling(pipe) as told:
        make(told, deed, task)


#: Makes a thing of a kind: see `run`.
Make = Callable[[Told, Deed, Task], None]


def tell_wall(told: Told, names: Iterable[str], shown: Iterable[Any], fine: int) -> None:
    """Tell what the walls show, each in 8-bit levels."""
    images = (b64encode(png(levels)).decode() for levels in shown)
    pictures = [{"name": name, "image": image} for name, image in zip(names, images, strict=True)]
    told("wall", pictures=pictures, voxels=fine)


def tell_thing(told: Told, thing: Any, title: str) -> None:
    """Tell a thing as the viewer takes it."""
    from lightcube.studio.viewed import viewed

    told("cube", **viewed(thing, title))


def solve(told: Told, deed: Deed, task: Task) -> None:
    """Solve a cube or films from the beginning or from where it was, or keep what is there."""
    if deed == "keep":
        _keep(told, task)
        return
    from lightcube.jobs import publishing, running
    from lightcube.jobs.partial import DiskStore, load_job, open_partial, partial_path
    from lightcube.verbs import solving

    if deed == "resume":
        job, store = solving.fitted(load_job(partial_path(task.out))), DiskStore(partial_path(task.out))
    else:
        planned = solving.read(task.source, task.how, told=False)(solving.rehearsals())
        job = solving.fitted(solving.job(planned))
        store = open_partial(task.out, job, overwrite=True)
    show = _Show(told, task.title)
    if not running.run(job, job.pieces, store, told.pass_on, show):
        told("stopped")
        return
    told("said", sentence="looking at what it shows")
    cube = publishing.finish(job, store, task.out, overwrite=True).solution.cube
    show.wall(cube)
    tell_thing(told, cube, task.title)
    told("done", **_facts(cube))


def _keep(told: Told, task: Task) -> None:
    """Make a cube of what is there."""
    from lightcube.jobs import publishing
    from lightcube.jobs.partial import partial_path
    from lightcube.scoring import metrics

    cube = publishing.publish(partial_path(task.out), overwrite=True).solution.cube
    _Show(told, task.title).wall(cube)
    tell_thing(told, cube, task.title)
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
            tell_thing(self._told, cube, self._title)
            self._next_turn = time.monotonic() + max(_TURN_S, _TURN_PATIENCE * (time.monotonic() - began))

    def wall(self, cube: Any) -> None:
        """Tell what the wall shows at each stop."""
        from lightcube.forward.casting import cast
        from lightcube.optics.transfer import to_uint8

        shown = (to_uint8(picture, cube.transfer) for picture in cast(cube))
        tell_wall(self._told, cube.names, shown, int(max(cube.grid.shape)))
