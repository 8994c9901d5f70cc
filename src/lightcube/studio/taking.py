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
from lightcube.studio.project import MADE

#: The cube of a project, where things made of it lie, and what is known of these.
CUBE, _AWAY, _KNOWN = "cube.zarr", "away", "taking.json"
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
        from lightcube.studio.away import THINGS  # here: all that makes files comes with it

        cube = self._cube_as_of()
        with self._lock:
            things = []
            for name, thing in THINGS.items():
                known = self._made.get(name)
                if known is not None and not self._path(known["file"]).is_file():
                    known = None
                told: dict[str, Any] = {"name": name, "title": thing.title, "said": thing.said, "suffix": thing.suffix}
                told |= {"group": thing.group, "made": None, "failed": self._failed.get(name, "")}
                if known is not None:
                    told["made"] = {**known, "is_old": known["of"] != cube}
                things.append(told)
            return {"has_cube": cube is not None, "things": things, "doing": self._doing}

    def begin(self, name: str, asked: _Asked) -> None:
        """Begin to make a thing; `InputError` where there is none of the name, nothing to make it of, or no time."""
        from lightcube.studio.away import THINGS

        if name not in THINGS:
            raise InputError(f"nothing that can be taken away has this name: ask for one of {', '.join(THINGS)}")
        if self._cube_as_of() is None:
            raise InputError("there is no cube yet: make one first")
        with self._lock:
            if self._doing is not None:
                busy = THINGS[self._doing["name"]].title.lower()
                raise InputError(f"{busy} is being made: wait for it, or stop it")
            self._doing = {"name": name, "done": 0, "of": 0}
            self._failed.pop(name, None)
            self._stop.clear()
            self._thread = threading.Thread(target=self._make, args=(name, asked), daemon=True)
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
            known = self._made.get(name)
        path = None if known is None else self._path(known["file"])
        if path is None or not path.is_file():
            raise InputError("this was not made yet, or its file is gone: make it first")
        return path

    def _make(self, name: str, asked: _Asked) -> None:
        """Make a thing, in a thread of its own; whatever is wrong with it is told."""
        from lightcube.studio import away
        from lightcube.viewer.label import Label

        try:
            title = self._desk.project.settings.title or "Light cube"
            folder = self._desk.project.path(MADE, _AWAY)
            with system_errors(folder, "writing"):
                folder.mkdir(exist_ok=True)
            target = self._path(f"{_called(title)}-{name}.{away.THINGS[name].suffix}")
            of, label = self._cube_as_of(), Label(title, asked.by, asked.note)
            source = self._desk.project.path(MADE, CUBE)
            said = away.make(name, source, target, label, self._told, captions=asked.captions)
            known = {"file": target.name, "bytes": target.stat().st_size, "said": list(said), "of": of}
            with self._lock:
                self._made[name] = known
                self._desk.project.write(json.dumps(self._made).encode(), MADE, _KNOWN)
        except Interrupted:
            pass
        except InputError as error:
            self._failed[name] = f"{error}"
        except MemoryError:
            self._failed[name] = "this needs more memory than there is: make a smaller cube"
        except OSError as error:
            self._failed[name] = f"its file cannot be written ({error.strerror}): look whether the disk is full"
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

    def _cube_as_of(self) -> float | None:
        """When the cube was made; None where there is none."""
        file = self._desk.project.path(MADE, CUBE) / "zarr.json"
        return file.stat().st_mtime if file.is_file() else None

    def _path(self, name: str) -> Path:
        return self._desk.project.path(MADE, _AWAY, name)

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


def _called(title: str) -> str:
    """A title as it can stand in the name of a file, on any system."""
    letters = "".join(letter if letter.isalnum() else "-" for letter in title)[:_MOST_LETTERS]
    return "-".join(part for part in letters.split("-") if part) or "light-cube"
