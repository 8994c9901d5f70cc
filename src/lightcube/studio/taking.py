"""Take away: pages, movies, reports and files for makers, each with what it is worth before it is saved."""

from __future__ import annotations

import json
import shutil
import threading
from pathlib import Path
from typing import Any
from urllib.parse import quote

from fastapi import APIRouter
from fastapi.responses import FileResponse, Response
from pydantic import BaseModel, ConfigDict, Field

from lightcube.errors import InputError
from lightcube.io._files import system_errors
from lightcube.studio.desk import Desk
from lightcube.studio.kinds import Kind, kind_of
from lightcube.studio.offered import THINGS
from lightcube.studio.project import MADE
from lightcube.studio.worker import Worker
from lightcube.viewer.label import Label

#: Where things lie that were made to be taken away, and what is known of these, by what they were made of and name.
_AWAY, _KNOWN = "away", "taking.json"
#: Where a thing is while it is made; seconds that it is given to stop by itself.
_MAKING, _PATIENCE_S = ".making", 3.0
#: How far a thing is that was just begun.
_NOTHING = {"done": 0, "of": 0, "sentence": ""}
#: Letters of a file's name at most.
_MOST_LETTERS = 60


class _Asked(BaseModel):
    """How a thing is to be made."""

    model_config = ConfigDict(extra="forbid")

    by: str = Field("", max_length=200)
    note: str = Field("", max_length=600)
    captions: bool = False


def router(desk: Desk) -> APIRouter:
    """What is asked of things to be taken away."""
    made, taking = APIRouter(prefix="/api/taking"), Taking(desk)
    desk.parts["taking"] = taking.state
    desk.closing.append(taking.close)

    @made.get("")
    def state() -> dict[str, Any]:
        """What can be made, and what was."""
        return taking.state()

    @made.post("/stop")
    def stop() -> dict[str, Any]:
        """Stop what is being made."""
        taking.stop()
        return taking.state()

    @made.post("/{name}")
    def begin(name: str, asked: _Asked) -> dict[str, Any]:
        """Make a thing; its file can be saved once that is told of."""
        taking.begin(name, asked)
        return taking.state()

    @made.get("/{name}/file", response_class=FileResponse)
    def file(name: str) -> Response:
        """The file of a thing that was made."""
        path = taking.file(name)
        said = f"attachment; filename*=UTF-8''{quote(path.name)}"
        return FileResponse(path, media_type="application/octet-stream", headers={"content-disposition": said})

    return made


class Taking:
    """Makes one thing at a time, in a process of its own, beside all else that goes on."""

    def __init__(self, desk: Desk) -> None:
        self._desk, self._lock = desk, threading.RLock()
        self._made: dict[str, dict[str, Any]] = self._read()
        self._worker: Worker | None = None
        self._doing: dict[str, Any] | None = None
        self._of: float | None = None
        self._failed: dict[str, str] = {}

    def state(self) -> dict[str, Any]:
        """How it stands, as plain JSON."""
        kind = kind_of(self._desk.project.settings)
        made = self._made_at(kind)
        with self._lock:
            things = []
            for name, thing in THINGS[kind.things].items():
                key = _key(kind.stem, name)
                told: dict[str, Any] = {"name": name, "title": thing.title, "said": thing.said, "suffix": thing.suffix}
                told |= {"group": thing.group, "made": None, "failed": self._failed.get(key, "")}
                known = self._made.get(key)
                if known is not None and self._path(kind.stem, known["file"]).is_file():
                    told["made"] = {**known, "is_old": known["of"] != made}
                things.append(told)
            return {"has_cube": made is not None, "kind": kind.stem, "things": things, "doing": self._doing_now(kind)}

    def begin(self, name: str, asked: _Asked) -> None:
        """Begin to make a thing; `InputError` where there is none of the name, nothing to make it of, or no time."""
        settings = self._desk.project.settings
        kind, title = kind_of(settings), kind_of(settings).called_in(settings)
        things = THINGS[kind.things]
        if name not in things:
            raise InputError(f"nothing that can be taken away has this name: ask for one of {', '.join(things)}")
        with self._lock:
            if self._doing is not None:
                raise InputError(f"{self._doing['title'].lower()} is being made: wait for it, or stop it")
            self._of = self._made_at(kind)
            if self._of is None:
                it = "it" if kind.are == "is" else "them"
                raise InputError(f"{kind.called} {kind.are} not made yet: make {it} first")
            target = self._emptied() / f"{_called(title)}-{name}.{things[name].suffix}"
            source, label = self._desk.project.path(MADE, kind.file), Label(title, asked.by, asked.note)
            given = (kind.things, name, source, target, label, asked.captions)
            self._worker = Worker(self._lock, _make, given, self._heard, self._ended)
            self._failed.pop(_key(kind.stem, name), None)
            self._doing = {"name": name, "kind": kind.stem, "title": things[name].title, **_NOTHING}
            self._tell()

    def stop(self) -> None:
        """Stop what is being made; at once where its next step is far."""
        with self._lock:
            if self._worker is not None:
                self._worker.stop(_PATIENCE_S)

    def close(self) -> None:
        """Stop what is being made, at once."""
        with self._lock:
            worker, self._worker = self._worker, None
        if worker is not None:
            worker.close()

    def file(self, name: str) -> Path:
        """Where the file of a thing lies; `InputError` where it was not made."""
        with self._lock:
            kind = kind_of(self._desk.project.settings)
            known = self._made.get(_key(kind.stem, name))
        path = None if known is None else self._path(kind.stem, known["file"])
        if path is None or not path.is_file():
            raise InputError("this was not made yet, or its file is gone: make it first")
        return path

    def _heard(self, what: str, facts: dict[str, Any]) -> None:
        """Take up one thing that was told."""
        assert self._doing is not None  # noqa: S101 - by whom would it be told
        before, key = self._doing, _key(self._doing["kind"], self._doing["name"])
        if what == "progress":
            self._doing = {**before, "done": facts["done"], "of": facts["of"], "sentence": ""}
            if _step_of(self._doing) != _step_of(before):
                self._desk.hub.tell("taking", {"doing": self._doing_now()})
        elif what == "said":
            self._doing = {**before, **_NOTHING, "sentence": facts["sentence"]}
            self._desk.hub.tell("taking", {"doing": self._doing_now()})
        elif what == "failed":
            self._failed[key] = facts["sentence"]
        elif what == "made":
            try:
                self._keep(key, before["kind"], **facts)
            except (InputError, OSError) as error:
                self._failed[key] = f"its file cannot be kept ({error}): make room on the disk, and make it again"

    def _keep(self, key: str, kind: str, file: str, said: list[str]) -> None:
        """Give what was made its place, and know of it."""
        before = self._made.get(key)
        if before is not None and before["file"] != file:  # it had another title
            self._path(kind, before["file"]).unlink(missing_ok=True)
        self._path(kind).mkdir(exist_ok=True)
        for each in self._path(_MAKING).iterdir():
            each.replace(self._path(kind, each.name))
        self._made[key] = {"file": file, "bytes": self._path(kind, file).stat().st_size, "said": said, "of": self._of}
        self._desk.project.write(json.dumps(self._made).encode(), MADE, _KNOWN)

    def _ended(self, last: str) -> None:
        """The process is gone: it is done, was stopped, or was killed."""
        assert self._doing is not None  # noqa: S101 - it was doing something
        assert self._worker is not None  # noqa: S101 - by it
        if last not in ("made", "failed", "stopped") and not self._worker.is_stopping:
            key = _key(self._doing["kind"], self._doing["name"])
            self._failed[key] = "this was ended from outside, perhaps for want of memory: make it again"
        self._worker = self._doing = None
        shutil.rmtree(self._path(_MAKING), ignore_errors=True)
        self._tell()

    def _doing_now(self, kind: Kind | None = None) -> dict[str, Any] | None:
        """What is being made; without a name where it is made of what the project is not to become now."""
        kind = kind or kind_of(self._desk.project.settings)
        is_other = self._doing is not None and self._doing["kind"] != kind.stem
        return {"name": "", **_NOTHING} if is_other else self._doing

    def _emptied(self) -> Path:
        """The folder in which things are made: nothing of it counts before it is whole."""
        folder = self._path(_MAKING)
        with system_errors(folder, "writing"):
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
        return folder

    def _tell(self) -> None:
        self._desk.hub.tell("taking", self.state())

    def _made_at(self, kind: Kind) -> float | None:
        """When what things are made of was made; None where there is nothing."""
        try:
            return (self._desk.project.path(MADE, kind.file) / "zarr.json").stat().st_mtime
        except OSError:
            return None

    def _path(self, *names: str) -> Path:
        """In the folder of what is taken away: by what it is made of, and name."""
        return self._desk.project.path(MADE, _AWAY, *names)

    def _read(self) -> dict[str, dict[str, Any]]:
        """What was made before the studio was started; what is damaged was not made."""
        try:
            found = json.loads(self._desk.project.path(MADE, _KNOWN).read_bytes())
            return {
                name: {
                    "file": str(each["file"]),
                    "bytes": int(each["bytes"]),
                    "said": list(each["said"]),
                    "of": each["of"],
                }
                for name, each in found.items()
            }
        except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
            return {}


def _make(*given: Any) -> None:
    """What makes things, in a process of its own; here: all that makes files comes with it."""
    from lightcube.studio import away

    away.run(*given)


def _key(kind: str, name: str) -> str:
    """What a thing is known by: what it is made of, and its name."""
    return f"{kind}/{name}"


def _step_of(doing: dict[str, Any]) -> tuple[int, int]:
    """What is worth telling of how far a thing is."""
    return doing["of"], 50 * doing["done"] // max(1, doing["of"])


def _called(title: str) -> str:
    """A title as it can stand in the name of a file, on any system."""
    letters = "".join(letter if letter.isalnum() else "-" for letter in title)[:_MOST_LETTERS]
    return "-".join(part for part in letters.split("-") if part) or "light-cube"
