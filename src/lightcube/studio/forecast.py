"""The forecast in the studio: asked after every change, told to every tab, by a process of its own."""

from __future__ import annotations

import json
import threading
from typing import Any

from fastapi import APIRouter

from lightcube.studio import forecaster
from lightcube.studio.desk import Desk
from lightcube.studio.kept import dropped
from lightcube.studio.kinds import kind_of, made_of, used
from lightcube.studio.worker import Worker


def router(desk: Desk) -> APIRouter:
    """What is asked of the forecast."""
    routes = APIRouter(prefix="/api")
    forecast = Forecast(desk)
    desk.parts["forecast"] = forecast.described
    desk.starting += [forecast.begin, forecast.ask]
    desk.minding.append(forecast.ask)
    desk.closing.append(forecast.close)
    desk.first_cube = forecast.thing

    @routes.get("/forecast")
    def told() -> dict[str, Any]:
        """What the forecast tells now."""
        return forecast.described()

    return routes


#: What is told of pictures of some kinds, and at some stages, only.
_OF_CUBES = {"costs", "full", "psnr", "angles_deg", "voxels"}


class Forecast:
    """The forecast of a desk's project."""

    def __init__(self, desk: Desk) -> None:
        self._desk, self._lock = desk, threading.RLock()
        self._worker: Worker | None = None
        self._number, self._asked, self._kind = 0, "", ""
        self._thing = b""
        self._facts: dict[str, Any] = {"status": "none", "pictures": [], "notes": [], "cube": 0}

    def described(self) -> dict[str, Any]:
        """What is told, as plain JSON."""
        with self._lock:
            return dict(self._facts)

    def begin(self) -> None:
        """Start the process that looks."""
        with self._lock:
            self._worker = Worker(self._lock, forecaster.run, (), self._heard, self._ended)

    def ask(self) -> None:
        """Ask for a forecast of how the project stands, unless it is that one already."""
        with self._lock:
            if not self._desk.is_started:
                return
            project = self._desk.project
            settings = project.settings
            kind, pictures = kind_of(settings), used(settings)
            files = tuple(dropped(project, picture.key) for picture in pictures)
            if len(pictures) < max(1, kind.counts(settings)[0]) or not all(file.is_file() for file in files):
                self._asked = ""
                self._number += 1
                self._thing = b""
                self._set(status="none", pictures=[], notes=[])
                return
            question = forecaster.Asked(
                self._number + 1,
                kind.foretell,
                kind.how(settings),
                tuple(picture.key for picture in pictures),
                tuple(picture.name for picture in pictures),
                files,
                tuple(picture.crop for picture in pictures),
                project.folder / kind.source,
                settings.title,
            )
            about = made_of(settings)
            if about == self._asked:
                return
            if settings.kind != self._kind:
                self._kind, self._thing = settings.kind, b""
                self._set(pictures=[], notes=[])
            self._asked = about
            self._number = question.number
            self._set(status="compiling" if self._facts["status"] == "compiling" else "looking")
            if self._worker is None:
                self.begin()
            assert self._worker is not None  # noqa: S101 - it has begun
            self._worker.send(question)

    def thing(self) -> bytes:
        """The small cube as the viewer takes it, to be turned while there is none other; nothing before."""
        return self._thing

    def close(self) -> None:
        """End the process; nothing of it is needed."""
        with self._lock:
            worker, self._worker = self._worker, None
        if worker is not None:
            worker.close()

    def _ended(self, _: str) -> None:
        """It was killed: the next question starts it again."""
        self._worker, self._asked = None, ""
        self._set(status="failed", sentence="the forecast was ended from outside: change anything to see it again")

    def _heard(self, what: str, facts: dict[str, Any]) -> None:
        """Take up what was told; answers to what is not asked any more are left out."""
        if what == "compiling" and self._facts["status"] in ("looking", "none"):
            self._set(status="compiling")
        elif what == "ready" and self._facts["status"] == "compiling":
            self._set(status="looking" if self._asked else "none")
        elif what == "cube" and facts.pop("number") == self._number:
            self._thing = json.dumps(facts).encode()
            self._facts["cube"] += 1
            self._desk.hub.tell("forecast", {"cube": self._facts["cube"]})
        elif what == "forecast" and facts["number"] == self._number:
            stage = facts.pop("stage")
            self._set(status=stage, sentence=facts.pop("sentence", ""), **facts)

    def _set(self, **facts: Any) -> None:
        self._facts |= facts
        if "pictures" in facts:  # what was told of others is not of these
            for name in _OF_CUBES - set(facts):
                self._facts.pop(name, None)
        self._desk.hub.tell("forecast", self._facts)
