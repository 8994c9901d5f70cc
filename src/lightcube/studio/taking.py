"""Take away: pages, movies, reports and files for makers, each with what it is worth before it is saved."""

from __future__ import annotations

import json
import threading
from pathlib import Path
from typing import Any
from urllib.parse import quote

from fastapi import APIRouter
from fastapi.responses import FileResponse, Response
from pydantic import BaseModel, ConfigDict, Field

from lightcube.errors import InputError
from lightcube.events import Interrupted, Progress, Said
from lightcube.io._files import system_errors
from lightcube.studio.desk import Desk
from lightcube.studio.kinds import Kind, kind_of
from lightcube.studio.project import MADE

#: Where things lie that were made to be taken away, and what is known of these, by what they were made of and name.
_AWAY, _KNOWN = "away", "taking.json"
#: How far a thing is that was just begun.
_NOTHING = {"done": 0, "of": 0}
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
    """Makes one thing at a time, beside all else that goes on."""

    def __init__(self, desk: Desk) -> None:
        self._desk, self._lock = desk, threading.RLock()
        self._made: dict[str, dict[str, Any]] = self._read()
        self._doing: dict[str, Any] | None = None
        self._failed: dict[str, str] = {}
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None

    def state(self) -> dict[str, Any]:
        """How it stands, as plain JSON."""
        from lightcube.studio import away  # here: all that makes files comes with it

        kind, made = kind_of(self._desk.project.settings), self._made_at()
        with self._lock:
            things = []
            for name, thing in away.things(kind.things).items():
                known = self._made.get(_key(kind, name))
                if known is not None and not self._path(kind, known["file"]).is_file():
                    known = None
                told: dict[str, Any] = {"name": name, "title": thing.title, "said": thing.said, "suffix": thing.suffix}
                told |= {"group": thing.group, "made": None, "failed": self._failed.get(_key(kind, name), "")}
                if known is not None:
                    told["made"] = {**known, "is_old": known["of"] != made}
                things.append(told)
            doing = self._doing if self._doing is None or self._doing["kind"] == kind.stem else {"name": "", **_NOTHING}
            return {"has_cube": made is not None, "kind": kind.stem, "things": things, "doing": doing}

    def begin(self, name: str, asked: _Asked) -> None:
        """Begin to make a thing; `InputError` where there is none of the name, nothing to make it of, or no time."""
        from lightcube.studio import away

        kind = kind_of(self._desk.project.settings)
        things = away.things(kind.things)
        if name not in things:
            raise InputError(f"nothing that can be taken away has this name: ask for one of {', '.join(things)}")
        if self._made_at() is None:
            there = "is none of" if kind.are == "is" else "are none of"
            raise InputError(f"there {there} {kind.called} yet: make {'it' if kind.are == 'is' else 'them'} first")
        with self._lock:
            if self._doing is not None:
                raise InputError(f"{self._doing['title'].lower()} is being made: wait for it, or stop it")
            self._doing = {"name": name, "kind": kind.stem, "title": things[name].title, **_NOTHING}
            self._failed.pop(_key(kind, name), None)
            self._stop.clear()
            self._thread = threading.Thread(target=self._make, args=(kind, name, asked), daemon=True)
            self._thread.start()
        self._tell()

    def stop(self) -> None:
        """Stop what is being made, at its next step."""
        self._stop.set()

    def close(self) -> None:
        """Stop, and wait a little for it."""
        self.stop()
        if self._thread is not None:
            self._thread.join(5)

    def file(self, name: str) -> Path:
        """Where the file of a thing lies; `InputError` where it was not made."""
        with self._lock:
            kind = kind_of(self._desk.project.settings)
            known = self._made.get(_key(kind, name))
        path = None if known is None else self._path(kind, known["file"])
        if path is None or not path.is_file():
            raise InputError("this was not made yet, or its file is gone: make it first")
        return path

    def _make(self, kind: Kind, name: str, asked: _Asked) -> None:
        """Make a thing, in a thread of its own; whatever is wrong with it is told."""
        from lightcube.studio import away
        from lightcube.viewer.label import Label

        try:
            title = self._desk.project.settings.title or kind.title.removeprefix("A ").capitalize()
            folder = self._desk.project.path(MADE, _AWAY, kind.stem)
            with system_errors(folder, "writing"):
                folder.mkdir(parents=True, exist_ok=True)
            target = self._path(kind, f"{_called(title)}-{name}.{away.things(kind.things)[name].suffix}")
            of, label = self._made_at(kind), Label(title, asked.by, asked.note)
            source = self._desk.project.path(MADE, kind.file)
            said = away.make(kind.things, name, source, target, label, self._told, captions=asked.captions)
            known = {"file": target.name, "bytes": target.stat().st_size, "said": list(said), "of": of}
            with self._lock:
                self._made[_key(kind, name)] = known
                self._desk.project.write(json.dumps(self._made).encode(), MADE, _KNOWN)
        except Interrupted:
            pass
        except InputError as error:
            self._failed[_key(kind, name)] = f"{error}"
        except MemoryError:
            self._failed[_key(kind, name)] = "this needs more memory than there is: make it smaller"
        except OSError as error:
            self._failed[_key(kind, name)] = f"its file cannot be written ({error.strerror}): is the disk full?"
        finally:
            with self._lock:
                self._doing = None
            self._tell()

    def _told(self, event: Progress | Said) -> bool:
        """Pass on how far it is; True where it is to stop."""
        if isinstance(event, Progress) and self._doing is not None:
            before = self._doing
            self._doing = {**before, "done": event.done, "of": event.of}
            if before["of"] != event.of or 50 * event.done // max(1, event.of) != 50 * before["done"] // max(
                1, event.of
            ):
                self._desk.hub.tell("taking", {"doing": self._doing})
        return self._stop.is_set()

    def _tell(self) -> None:
        self._desk.hub.tell("taking", self.state())

    def _made_at(self, kind: Kind | None = None) -> float | None:
        """When what things are made of was made; None where there is nothing."""
        kind = kind or kind_of(self._desk.project.settings)
        file = self._desk.project.path(MADE, kind.file) / "zarr.json"
        return file.stat().st_mtime if file.is_file() else None

    def _path(self, kind: Kind, name: str) -> Path:
        return self._desk.project.path(MADE, _AWAY, kind.stem, name)

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


def _key(kind: Kind, name: str) -> str:
    """What a thing is known by: what it is made of, and its name."""
    return f"{kind.stem}/{name}"


def _called(title: str) -> str:
    """A title as it can stand in the name of a file, on any system."""
    letters = "".join(letter if letter.isalnum() else "-" for letter in title)[:_MOST_LETTERS]
    return "-".join(part for part in letters.split("-") if part) or "light-cube"
