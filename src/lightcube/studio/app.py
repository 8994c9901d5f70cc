"""The studio's application: its parts put together, guarded, with errors that are sentences."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib import import_module
from importlib.resources import files
from importlib.util import find_spec
from typing import Annotated, Any

from fastapi import APIRouter, FastAPI, Header, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, Response
from fastapi.sse import EventSourceResponse, ServerSentEvent
from pydantic import BaseModel, ConfigDict
from starlette.exceptions import HTTPException

from lightcube.errors import InputError, shown
from lightcube.studio.desk import Desk
from lightcube.studio.guard import LOOPBACK, Guard
from lightcube.studio.kinds import described
from lightcube.studio.project import MAKINGS, Project, Settings, said, updated

#: The parts of the page in their order: name, title, and which door it stands behind.
PARTS = (
    ("choosing", "What will it be?", "make"),
    ("pictures", "Pictures", "make"),
    ("forecast", "Forecast", "make"),
    ("solving", "Make", "make"),
    ("turning", "Turn", "make"),
    ("taking", "Take away", "make"),
    ("lessons", "Lessons", "lessons"),
    ("rooms", "Room", "room"),
)
_KINDS = {"html": "text/html", "css": "text/css", "js": "text/javascript", "svg": "image/svg+xml"}


class _Change(BaseModel):
    """What is changed of the settings; what is not said stays."""

    model_config = ConfigDict(extra="forbid")

    kind: str | None = None
    title: str | None = None
    making: dict[str, Any] | None = None
    shape: dict[str, Any] | None = None
    plate: dict[str, Any] | None = None
    films: dict[str, Any] | None = None
    part: str | None = None
    kept: Any = None


def make_app(project: Project, token: str, hosts: frozenset[str] = LOOPBACK) -> FastAPI:
    """The application of a project, behind a guard who wants the token.

    Parameters
    ----------
    hosts
        Names by which the machine may be called.
    """
    desk = Desk(project)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        desk.start()
        yield
        desk.close()

    app = FastAPI(title="lightcube studio", lifespan=lifespan, docs_url=None, redoc_url=None)
    app.state.desk = desk
    app.include_router(_own(desk))
    for name, _, _ in PARTS:
        if find_spec(f"lightcube.studio.{name}") is not None:
            app.include_router(import_module(f"lightcube.studio.{name}").router(desk))
    app.include_router(_pages())
    speak(app)
    app.add_middleware(Guard, token=token, hosts=hosts)
    return app


def _own(desk: Desk) -> APIRouter:
    """What is asked of the project as a whole."""
    router = APIRouter(prefix="/api")

    @router.get("/state")
    def state() -> dict[str, Any]:
        """How all stands."""
        return desk.state()

    @router.get("/kinds")
    def kinds() -> list[dict[str, Any]]:
        """What a project can become."""
        return described()

    @router.patch("/settings")
    def settings(change: _Change) -> dict[str, Any]:
        """Change what is to be made, how, its title, or what a part keeps."""
        asked = {name: getattr(change, name) for name in change.model_fields_set}

        def changed(before: Settings) -> Settings:
            update: dict[str, Any] = {name: asked[name] for name in ("kind", "title") if asked.get(name) is not None}
            for name in MAKINGS:
                if asked.get(name) is not None:
                    update[name] = getattr(before, name).model_dump() | asked[name]
            if asked.get("part") is not None:
                update["parts"] = before.parts | {asked["part"]: asked.get("kept")}
            return updated(before, update)

        names = {name: sorted(value) if isinstance(value, dict) else name for name, value in asked.items()}
        return desk.change(changed, moving=f"{names} {change.part}")

    @router.post("/undo")
    def undo() -> dict[str, Any]:
        """Undo the last change."""
        desk.project.step(-1)
        return desk.changed()

    @router.post("/redo")
    def redo() -> dict[str, Any]:
        """Do a change again that was undone."""
        desk.project.step(1)
        return desk.changed()

    @router.get("/events", response_class=EventSourceResponse)
    async def events(last_event_id: Annotated[str | None, Header()] = None) -> AsyncIterator[ServerSentEvent]:
        """All that happens, as it happens."""
        async for event in desk.hub.follow(last_event_id):
            yield ServerSentEvent(raw_data=event.text, event=event.name, id=desk.hub.id_of(event), retry=1000)

    return router


def _pages() -> APIRouter:
    """The page and what it is made of; the viewer's own modules and style are the page's too."""
    router = APIRouter(include_in_schema=False)

    @router.get("/")
    def page() -> Response:
        return _file("lightcube.studio", "studio.html")

    @router.get("/api/parts")
    def parts() -> list[dict[str, str]]:
        return [
            {"name": name, "title": title, "door": door}
            for name, title, door in PARTS
            if files("lightcube.studio").joinpath("web", "parts", f"{name}.js").is_file()
        ]

    @router.get("/web/{path:path}")
    def own(path: str) -> Response:
        return _file("lightcube.studio", path)

    @router.get("/viewer/{path:path}")
    def viewer(path: str) -> Response:
        return _file("lightcube.viewer", path)

    return router


def _file(package: str, path: str) -> Response:
    """A file of the page, by its path in the package's folder of them."""
    parts = path.split("/")
    kind = _KINDS.get(parts[-1].rpartition(".")[2])
    if kind is None or not all(part and part[0] != "." and part.isprintable() and "\\" not in part for part in parts):
        raise HTTPException(404)
    found = files(package).joinpath("web", *parts)
    if not found.is_file():
        raise HTTPException(404)
    return Response(found.read_bytes(), media_type=kind, headers={"cache-control": "no-cache"})


def speak(app: FastAPI) -> None:
    """Let an application say in a sentence what it refuses."""
    app.exception_handler(InputError)(_refused)
    app.exception_handler(RequestValidationError)(_invalid)
    app.exception_handler(HTTPException)(_unknown)


async def _refused(_: Request, error: Exception) -> Response:
    return JSONResponse({"sentence": f"{error}"}, status_code=400)


async def _invalid(_: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)  # noqa: S101 - for what else would this be called
    return JSONResponse({"sentence": shown(said(error.errors()))}, status_code=422)


async def _unknown(_: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)  # noqa: S101 - for what else would this be called
    sentences = {404: "there is no such thing in this studio", 405: "this cannot be done here"}
    return JSONResponse(
        {"sentence": sentences.get(error.status_code, f"{error.detail}")}, status_code=error.status_code
    )
