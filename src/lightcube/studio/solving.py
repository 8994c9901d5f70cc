"""Making things in the studio: in a process of its own, paused, kept and gone on with, also after a kill.

One thing is made at a time: what a project is not to become any more rests, and goes on when it is chosen again.
"""

from __future__ import annotations

import json
import threading
import time
from pathlib import Path
from typing import Any, Literal

from fastapi import APIRouter
from fastapi.responses import Response

from lightcube.errors import InputError
from lightcube.io._files import system_errors
from lightcube.jobs.partial import discard_partial, is_partial, partial_path
from lightcube.studio import solver
from lightcube.studio.desk import Desk
from lightcube.studio.kinds import KINDS, check_there, command_of, made_of, used
from lightcube.studio.project import MADE, KindName, Settings
from lightcube.studio.worker import Worker

Status = Literal["idle", "running", "stopping", "resting", "paused", "done", "kept", "failed"]
#: What can be done in which state.
_MAY: dict[str, frozenset[Status]] = {
    "start": frozenset({"idle", "paused", "done", "kept", "failed"}),
    "stop": frozenset({"running"}),
    "pause": frozenset({"running"}),
    "resume": frozenset({"paused", "kept", "failed"}),
    "keep": frozenset({"running", "paused", "failed"}),
    "discard": frozenset({"paused", "failed"}),
}
#: What only can be done where there is something to go on with, and where there is nothing.
_GOING_ON, _AT_ONCE = frozenset({"pause", "resume", "keep", "discard"}), frozenset({"stop"})
#: Seconds that a solve is given to keep what it has, when the studio ends.
_GRACE_S = 8.0
#: Points of the curve that are told.
_CURVE = 240
#: Seconds between two tellings of how far it is, at least.
_BETWEEN_S = 0.1


def router(desk: Desk) -> APIRouter:
    """What is asked of the making, and the thing for the viewer."""
    routes = APIRouter(prefix="/api")
    every = {name: Solving(desk, name) for name in KINDS}

    def now() -> Solving:
        return every[desk.project.settings.kind]

    desk.parts["solving"] = lambda: now().described()
    desk.parts["resting"] = lambda: [name for name, solving in every.items() if solving.status == "resting"]
    for solving in every.values():
        desk.starting.append(solving.go_on)
        desk.minding.append(solving.mind)
        desk.closing.append(solving.close)

    @routes.post("/solving/{deed}")
    def do(deed: Literal["start", "stop", "pause", "resume", "keep", "discard"]) -> dict[str, Any]:
        """Start, stop, pause, go on, stop and keep what is there, or throw what is unfinished away."""
        if deed == "start":
            desk.mind()  # what vanished from the folder since the last change is written again
        return now().do(deed)

    @routes.get("/solving")
    def stands() -> dict[str, Any]:
        """How the making stands, with what the wall shows now and the curve of how it went."""
        return now().described() | {"wall": now().wall, "curve": now().curve}

    @routes.get("/cube", response_class=Response)
    def cube() -> Response:
        """The newest thing that there is, as the viewer reads it; nothing before."""
        thing = now().thing()
        return Response(thing, media_type="application/json") if thing else Response(status_code=204)

    return routes


class Solving:
    """How a thing of one kind is made of a desk's project."""

    def __init__(self, desk: Desk, name: KindName) -> None:
        self._desk, self._lock, self._name, self._kind = desk, threading.RLock(), name, KINDS[name]
        self._worker: Worker | None = None
        self._after = ""
        self._thing, self._told_at = b"", 0.0
        self.wall: dict[str, Any] = {"pictures": [], "voxels": 0}
        self.curve: list[list[float]] = []
        self._out = str(desk.project.folder / MADE / self._kind.file)
        self._facts: dict[str, Any] = {"status": "idle", "version": 0, "pictures": [], "made_of": "", **_nothing()}
        self._before = dict(self._facts), self.wall
        self._facts |= self._remembered()

    def described(self) -> dict[str, Any]:
        """How it stands, as plain JSON."""
        with self._lock:
            settings = self._settings
            not_here = _AT_ONCE if self._kind.can_pause else _GOING_ON
            can = {deed for deed, states in _MAY.items() if self.status in states}
            return {
                **{name: value for name, value in self._facts.items() if name != "made_of"},
                "kind": self._name,
                "can": sorted(can - not_here),
                "changed": self._has_changed(),
                "command": command_of(self._desk.project.folder, settings) if used(settings) else "",
            }

    @property
    def status(self) -> Status:
        """How it stands, in a word."""
        status: Status = self._facts["status"]
        return status

    @property
    def _is_chosen(self) -> bool:
        """Whether the project is to become this."""
        return self._desk.project.settings.kind == self._name

    @property
    def _settings(self) -> Settings:
        """The project's, as if it were to become this."""
        return self._desk.project.settings.model_copy(update={"kind": self._name})

    def do(self, deed: str) -> dict[str, Any]:
        """Do what is asked; `InputError` where it cannot be done now."""
        with self._lock:
            if deed not in self.described()["can"]:
                stands = f"{self._kind.called} {self._kind.are} {_SAID[self.status]}"
                raise InputError(f"{stands}: {deed} is for another moment")
            if deed == "start":
                check_there(self._desk.project)
                self._begin("start")
            elif deed == "resume":
                self._resume()
            elif deed == "discard":
                if is_partial(partial_path(self._out)):
                    discard_partial(self._out)
                self._restore()
            elif self._worker is None or self.status != "running":
                self._begin("keep")
            else:
                self._after = deed
                self._set(status="stopping")
                self._worker.stop()
            return self.described()

    def mind(self) -> None:
        """Rest where the project is to become something else, and go on where it is to become this again."""
        with self._lock:
            if self.status == "running" and not self._is_chosen:
                assert self._worker is not None  # noqa: S101 - it runs
                self._set(status="resting")
                self._worker.stop()
            elif self.status == "resting" and self._is_chosen and self._worker is None:
                self._resume()

    def go_on(self) -> None:
        """Go on with what ran when the studio was ended or killed."""
        with self._lock:
            if self.status == "running":
                self._facts["status"] = "resting"
            elif self.status == "stopping":
                self._facts["status"] = "paused" if self._kind.can_pause else "idle"
        self.mind()

    def thing(self) -> bytes:
        """The newest thing as the viewer takes it; nothing where there is none."""
        with self._lock:
            if self._thing:
                return self._thing
            is_newest = self.status != "running"
        file = self._viewed()
        with system_errors(file, "reading"):
            kept = file.read_bytes() if file.is_file() else b""
        return kept if is_newest and kept else self._desk.first_cube() or kept

    def close(self) -> None:
        """End the process; what it has reached is kept, and gone on with when the studio starts again."""
        with self._lock:
            worker, self._worker = self._worker, None
        if worker is not None:
            worker.close(_GRACE_S)

    def _begin(self, deed: solver.Deed) -> None:
        """Start a process that does it."""
        settings, source = self._settings, str(self._desk.project.folder / self._kind.source)
        task = solver.Task(source, self._out, self._kind.how(settings), self._kind.called_in(settings))
        if self._worker is not None:  # it has told its last already, and is about to end
            self._worker.close()
        try:
            self._worker = Worker(self._lock, solver.run, (self._kind.make, deed, task), self._heard, self._ended)
        except InputError as error:
            self._set(status="failed", sentence=f"{error}")
            return
        if deed == "start":
            if self.status != "resting":
                self._before = dict(self._facts), self.wall
            self.curve, self.wall, self._thing = [], {"pictures": [], "voxels": 0}, b""
            self._facts |= _nothing() | {"made_of": made_of(settings), "pictures": [], "said": []}
        self._set(status="stopping" if deed == "keep" else "running", sentence="")

    def _resume(self) -> None:
        """Go on with what there is of it, or begin anew where there is nothing."""
        self._begin("resume" if self._is_begun() else "start")

    def _restore(self) -> None:
        """Let it stand as it did before it was begun."""
        before, self.wall = self._before
        self._thing = b""
        self._set(**before)

    def _heard(self, what: str, facts: dict[str, Any]) -> None:
        """Take up one thing that was told."""
        if what == "wall":
            self.wall = facts
            self._tell({"wall": facts})
        elif what == "cube":
            self._thing = json.dumps(facts).encode()
            self._set(version=self._facts["version"] + 1)
        elif what == "progress":
            if facts["psnr"] is not None:
                self.curve.append([facts["done"] / max(facts["of"], 1), round(facts["psnr"], 2)])
                self.curve = self.curve if len(self.curve) <= _CURVE else self.curve[::2]
            psnr = self._facts["psnr"] if facts["psnr"] is None else facts["psnr"]
            self._facts |= facts | {"psnr": psnr, "sentence": ""}
            if time.monotonic() - self._told_at > _BETWEEN_S:
                self._tell(self.described())
        elif what == "said":
            self._set(sentence=facts["sentence"])
        elif what in ("done", "kept"):
            self._set(status=what, left_s=None, sentence=self._kept_for_later(), **facts)
        elif what == "failed":
            self._set(status="failed", left_s=None, sentence=facts["sentence"])

    def _kept_for_later(self) -> str:
        """Keep what is turned for when the studio is started again; says why where it cannot be."""
        try:
            self._desk.project.write(self._thing, MADE, self._viewed().name)
        except InputError as error:
            return f"{error}"
        return ""

    def _ended(self, last: str) -> None:
        """The process is gone: as it was told to, or not."""
        self._worker = None
        after, self._after = self._after, ""
        if self.status == "resting":
            self.mind()  # it may have been chosen again by now
        elif last == "stopped" and after == "keep":
            self._begin("keep")
        elif last == "stopped" and self._kind.can_pause:
            self._set(status="paused", left_s=None, sentence="")
        elif last == "stopped":
            self._restore()
        elif last not in ("done", "kept", "failed") and self._kind.can_pause:
            self._set(status="paused", left_s=None, sentence="solving was ended from outside: go on, nothing is lost")
        elif last not in ("done", "kept", "failed"):
            self._set(status="failed", left_s=None, sentence="the making was ended from outside: begin anew")

    def _set(self, **facts: Any) -> None:
        """Change how it stands, keep that where it is another state, and tell everybody."""
        before = self.status
        self._facts |= facts
        if self.status != before or "pictures" in facts:
            kept = {name: value for name, value in self._facts.items() if name not in ("sentence", "left_s")}
            try:
                self._desk.project.write(
                    json.dumps(kept | {"curve": self.curve, "wall": self.wall}).encode(),
                    MADE,
                    f"{self._kind.stem}.json",
                )
            except InputError as error:
                self._facts["sentence"] = f"{error}"
        self._tell(self.described())

    def _tell(self, facts: dict[str, Any]) -> None:
        """Tell everybody, where the project is to become this."""
        self._told_at = time.monotonic()
        if self._is_chosen:
            self._desk.hub.tell("solving", facts)

    def _viewed(self) -> Path:
        """Where that is kept which is turned when the studio is started again."""
        return self._desk.project.path(MADE, f"{self._kind.stem}.view.json")

    def _is_begun(self) -> bool:
        """Whether there is something of an unfinished cube."""
        partial = partial_path(self._out)
        return is_partial(partial) and any(each.name.endswith(".npz") for each in partial.iterdir())  # type: ignore[union-attr]

    def _has_changed(self) -> bool:
        """Whether the cube was made of something else than what stands there now."""
        return self._facts["made_of"] not in ("", made_of(self._settings))

    def _remembered(self) -> dict[str, Any]:
        """How it stood when the studio was last open; nothing where that is not known."""
        try:
            kept = json.loads(self._desk.project.path(MADE, f"{self._kind.stem}.json").read_bytes())
            self.curve, self.wall = kept.pop("curve"), kept.pop("wall")
            if kept["status"] in _SAID:
                return {name: kept[name] for name in self._facts if name in kept}
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            pass  # it was never solved, or that is damaged
        return {"status": "paused"} if self._is_begun() else {}


def _nothing() -> dict[str, Any]:
    """Nothing is reached yet."""
    return {"done": 0, "of": 0, "psnr": None, "left_s": None, "sentence": "", "said": []}


_SAID: dict[str, str] = {
    "idle": "not begun",
    "running": "being made",
    "stopping": "about to stop",
    "resting": "about to go on",
    "paused": "paused",
    "done": "finished",
    "kept": "kept as it was reached",
    "failed": "not finished",
}
