"""The solve, in a process of its own: it tells what happens through a pipe, and stops when it is told to."""

from __future__ import annotations

import time
from base64 import b64encode
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Literal

from lightcube.studio.worker import Told, telling

#: Seconds between two looks at the wall at least, and so many times as long as one takes.
_LOOK_S, _PATIENCE = 0.7, 6.0
#: The same of cubes to be turned.
_TURN_S, _TURN_PATIENCE = 2.0, 12.0

Deed = Literal["start", "resume", "keep"]


def run(pipe: Connection, deed: Deed, pictures: str, out: str, options: Any, title: str) -> None:
    """Do what is asked for; the last that is told says how it ended.

    Parameters
    ----------
    deed
        Start anew, go on with what is in the unfinished cube of `out`, or make a cube of what is there.
    """
    with telling(pipe) as told:
        show = _Show(told, title)
        if deed == "keep":
            _keep(told, show, out)
        else:
            _solve(told, show, deed, pictures, out, options)


def _solve(told: Told, show: _Show, deed: Deed, pictures: str, out: str, options: Any) -> None:
    """Solve from the beginning, or from where it was."""
    from lightcube.backward.needs import job_memory
    from lightcube.jobs import publishing, running
    from lightcube.jobs.partial import DiskStore, load_job, open_partial, partial_path
    from lightcube.verbs import solving

    if deed == "resume":
        job, store = load_job(partial_path(out)), DiskStore(partial_path(out))
    else:
        planned = solving.read(pictures, options, told=False)(solving.rehearsals())
        job = solving.job(planned)
        solving.check_memory(job_memory(job))
        store = open_partial(out, job, overwrite=True)
    if not running.run(job, job.pieces, store, told.pass_on, show):
        told("stopped")
        return
    told("said", sentence="looking at what it shows")
    cube = publishing.finish(job, store, out, overwrite=True).solution.cube
    show.wall(cube)
    show.turn(cube)
    told("done", **_facts(cube))


def _keep(told: Told, show: _Show, out: str) -> None:
    """Make a cube of what is there."""
    from lightcube.jobs import publishing
    from lightcube.jobs.partial import partial_path
    from lightcube.scoring import metrics

    cube = publishing.publish(partial_path(out), overwrite=True).solution.cube
    show.wall(cube)
    show.turn(cube)
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
        self._told, self._title = told, title or "Light cube"
        self._next_wall, self._next_turn = 0.0, 0.0

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
            self.turn(cube)
            self._next_turn = time.monotonic() + max(_TURN_S, _TURN_PATIENCE * (time.monotonic() - began))

    def wall(self, cube: Any) -> None:
        """Tell what the wall shows at each stop."""
        from lightcube.forward.casting import cast
        from lightcube.optics.transfer import to_uint8
        from lightcube.studio.kept import png

        shown = [b64encode(png(to_uint8(picture, cube.transfer))).decode() for picture in cast(cube)]
        told = [{"name": name, "image": image} for name, image in zip(cube.names, shown, strict=True)]
        self._told("wall", pictures=told, voxels=int(max(cube.grid.shape)))

    def turn(self, cube: Any) -> None:
        """Tell the cube as the viewer takes it."""
        from lightcube.viewer.description import zipped
        from lightcube.viewer.page import contents

        description, voxels = contents(cube, self._title)
        self._told("cube", scene=zipped(description), voxels=voxels)


def places(folder: Path) -> tuple[str, str]:
    """Where a project's pictures are, and its cube."""
    from lightcube.studio.making import CUBE
    from lightcube.studio.project import MADE, PICTURES

    return str(folder / PICTURES), str(folder / MADE / CUBE)
