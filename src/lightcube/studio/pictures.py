"""The pictures of a project: dropped in any format, cropped, named, put in order; and sets to try things with."""

from __future__ import annotations

import re
import secrets
import shutil
import tempfile
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import lru_cache
from io import BytesIO
from pathlib import Path, PurePath
from typing import Annotated, Any, Literal

import numpy as np
from fastapi import APIRouter, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response
from numpy.typing import NDArray
from PIL import Image
from pydantic import BaseModel, Field
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect

from lightcube import io
from lightcube.errors import InputError, shown
from lightcube.io._files import system_errors
from lightcube.io.pictures import is_pictures
from lightcube.io.pictures_folder import VIEWS_FILE, views_text
from lightcube.optics.transfer import to_uint8
from lightcube.studio.desk import Desk
from lightcube.studio.kept import box, dropped, png, smaller
from lightcube.studio.kinds import kind_of, used
from lightcube.studio.making import MOST_PICTURES
from lightcube.studio.project import DROPPED, PICTURES, Crop, Picture, Project, Settings
from lightcube.studio.samples import SAMPLES

#: Pixels of a picture in the strip.
_STRIP = 260
#: Letters of a name that are kept.
_NAME = 60

#: Files of dropped pictures; where there are so many, those that nobody can come back to go, unless they are as fresh.
_OWN, _MANY, _FRESH_S = re.compile("[0-9a-f]{16}[.]png"), 4 * MOST_PICTURES, 3600.0
#: What the folders are called in which files arrive.
_INCOMING = ".incoming-"

_Key = Annotated[str, Field(pattern="^[0-9a-f]{16}$")]
#: One file at a time is read: each may take much memory.
_READING = threading.Lock()


class _Edit(BaseModel):
    """What is changed of a picture; what is not said stays."""

    name: Annotated[str, Field(min_length=1, max_length=80)] | None = None
    crop: Crop | None = None


class _Order(BaseModel):
    """The keys of all pictures, in their new order."""

    keys: Annotated[list[_Key], Field(max_length=MOST_PICTURES)]


class Film(BaseModel):
    """Which part of a film or an animation is taken; None = all, or as is usual."""

    from_s: Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)] | None = None
    to_s: Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)] | None = None
    every: Annotated[int, Field(ge=1, le=100_000)] | None = None

    def part(self, room: int) -> dict[str, Any]:
        """The same as `lightcube.io.read_pictures` takes it, and no more than there is room for."""
        said = self.model_dump(exclude_none=True)
        return said | {"most": min(room, 12 if self.every is None else room)}


def router(desk: Desk) -> APIRouter:
    """What is asked of pictures."""
    strip = Strip(desk)
    desk.parts["pictures"] = strip.described
    desk.minding.append(strip.write)
    desk.starting += [strip.write, strip.tidy]
    routes = APIRouter(prefix="/api")
    routes.include_router(_taking_in(desk, strip))
    routes.include_router(_changing(desk, strip))
    return routes


def _taking_in(desk: Desk, strip: Strip) -> APIRouter:
    """How pictures come in."""
    routes = APIRouter()

    @routes.post("/uploads")
    async def upload(
        request: Request,
        name: Annotated[str, Query(min_length=1, max_length=300)],
        film: Annotated[Film, Query()],
    ) -> dict[str, Any]:
        """Take a file of pictures, which is the body, by the name that it has."""
        strip.room()
        with _incoming(desk.project, name) as file:
            try:
                with system_errors(desk.project.folder / _file_name(name), "writing"), file.open("wb") as opened:
                    async for chunk in request.stream():
                        opened.write(chunk)
            except ClientDisconnect:
                raise InputError(f"{shown(name)} did not come to its end: drop it again") from None
            return await run_in_threadpool(strip.take, file, name, film)

    @routes.post("/samples/{name}")
    def sample(name: Literal["photographs", "letters", "ball"]) -> dict[str, Any]:
        """Add pictures to try things with."""
        return strip.add([(to_uint8(image), title) for image, title in SAMPLES[name].make()])

    return routes


def _changing(desk: Desk, strip: Strip) -> APIRouter:
    """What is done to those that are there."""
    routes = APIRouter()

    @routes.patch("/pictures/{key}")
    def edit(key: _Key, change: _Edit) -> dict[str, Any]:
        """Name or crop a picture."""
        said = {
            field: getattr(change, field) for field in change.model_fields_set if getattr(change, field) is not None
        }
        return strip.edit(key, lambda picture: picture.model_copy(update=said))

    @routes.delete("/pictures/{key}")
    def remove(key: _Key) -> dict[str, Any]:
        """Take a picture out of the strip."""
        return strip.edit(key, lambda _: None)

    @routes.put("/pictures")
    def arrange(order: _Order) -> dict[str, Any]:
        """Put the pictures in another order, or remove those that are not named."""

        def changed(before: Settings) -> Settings:
            known = {picture.key: picture for picture in before.pictures}
            if not set(order.keys) <= set(known):
                raise InputError("the order names a picture that is not in the strip: look at it again")
            return before.model_copy(update={"pictures": tuple(known[key] for key in dict.fromkeys(order.keys))})

        return desk.change(changed)

    @routes.get("/pictures/{key}", response_class=Response)
    def picture(key: _Key, small: bool = False) -> Response:
        """A picture as it is kept, or as it stands in the strip."""
        file = dropped(desk.project, key)
        if not file.is_file():
            raise HTTPException(404)
        with system_errors(file, "reading"):
            data, kind = (_small(file), "image/jpeg") if small else (file.read_bytes(), "image/png")
        return Response(data, media_type=kind, headers={"cache-control": "private, max-age=86400, immutable"})

    return routes


class Strip:
    """The pictures of a desk's project."""

    def __init__(self, desk: Desk) -> None:
        self._desk, self._written, self._names = desk, dict[str, Picture](), b""
        self._lock = threading.Lock()

    def room(self) -> int:
        """How many pictures can be added; `InputError` where none can."""
        room = MOST_PICTURES - len(self._desk.project.settings.pictures)
        if room < 1:
            raise InputError(
                f"a project has at most {MOST_PICTURES} pictures, and it has as many: remove some, or begin another one"
            )
        return room

    def take(self, file: Path, name: str, film: Film) -> dict[str, Any]:
        """Add the pictures of a file that was sent; the answer says what was noticed."""
        part = film.part(self.room()) if io.is_film(file) else {}
        with _READING, warnings.catch_warnings(record=True) as noticed:
            warnings.simplefilter("always", UserWarning)
            try:
                found = io.read_pictures(file, least=1, **part)
            except InputError as error:
                raise InputError(_by_name(f"{error}", file, name)) from None
        title = PurePath(_file_name(name)).stem
        several = len(found) > 1
        kept = [
            (to_uint8(smaller(image)), f"{title} {number}" if several else title)
            for number, image in enumerate(found.images, 1)
        ]
        notes = dict.fromkeys(_by_name(f"{each.message}", file, name) for each in noticed)
        return self.add(kept) | {"notes": list(notes)}

    def add(self, images: Sequence[tuple[NDArray[np.uint8], str]]) -> dict[str, Any]:
        """Add pictures, as many as there is room for."""
        added = []
        if sum(1 for _ in self._desk.project.path(DROPPED).iterdir()) > _MANY:
            self.tidy(_FRESH_S)
        for levels, title in images[: self.room()]:
            key = secrets.token_hex(8)
            self._desk.project.write(png(levels), DROPPED, f"{key}.png")
            added.append(Picture(key=key, name=shown(title)[:_NAME].strip() or "picture"))
        return self._desk.change(
            lambda before: before.model_copy(update={"pictures": (*before.pictures, *added)[:MOST_PICTURES]})
        )

    def edit(self, key: str, change: Callable[[Picture], Picture | None]) -> dict[str, Any]:
        """Change a picture, or remove it where that makes None of it."""

        def changed(before: Settings) -> Settings:
            if all(picture.key != key for picture in before.pictures):
                raise InputError("this picture is not in the strip any more: it may have been removed in another tab")
            made = (change(picture) if picture.key == key else picture for picture in before.pictures)
            return before.model_copy(update={"pictures": tuple(picture for picture in made if picture is not None)})

        return self._desk.change(changed)

    def described(self) -> dict[str, Any]:
        """What is to be known of the pictures beside the settings."""
        missing = [
            picture.key
            for picture in self._desk.project.settings.pictures
            if not dropped(self._desk.project, picture.key).is_file()
        ]
        samples = [{"name": name, "title": sample.title} for name, sample in SAMPLES.items()]
        settings = self._desk.project.settings
        least, most = kind_of(settings).counts(settings)
        places = list(kind_of(settings).places(settings))
        counts = {"used": len(used(settings)), "least": least, "takes": most, "places": places}
        return {"missing": missing, "most": MOST_PICTURES, "samples": samples, **counts}

    def write(self) -> None:
        """Write the pictures that are used, cropped and in order, where commands read them."""
        project = self._desk.project
        with self._lock:
            wanted = {f"{number:04d}.png": each for number, each in enumerate(used(project.settings), 1)}
            there = _names_in(project)
            for name, picture in wanted.items():
                file = dropped(project, picture.key)
                if (self._written.get(name) != picture or name not in there) and file.is_file():
                    project.write(_cropped(file, picture.crop), PICTURES, name)
                    self._written[name] = picture
            for stale in there - {*wanted, VIEWS_FILE}:
                with suppress(OSError):
                    project.path(PICTURES, stale).unlink()
                self._written.pop(stale, None)
            names = views_text(None, [picture.name for picture in wanted.values()]).encode()
            if names != self._names or VIEWS_FILE not in there:
                project.write(names, PICTURES, VIEWS_FILE)
                self._names = names

    def tidy(self, older_s: float = 0.0) -> None:
        """Remove what was dropped and cannot come back by undoing, and what a killed studio left half taken."""
        project = self._desk.project
        needed, since = project.keys, time.time() - older_s
        for file in project.path(DROPPED).iterdir():
            with suppress(OSError):
                if _OWN.fullmatch(file.name) and file.stem not in needed and file.stat().st_mtime <= since:
                    file.unlink()
        for folder in project.folder.glob(f"{_INCOMING}*"):
            with suppress(OSError):
                if folder.stat().st_mtime <= since:
                    shutil.rmtree(folder)


def _names_in(project: Project) -> set[str]:
    """Names of what was written before for the command."""
    with system_errors(project.path(PICTURES), "reading"):
        return {
            each.name for each in project.path(PICTURES).iterdir() if each.suffix == ".png" or each.name == VIEWS_FILE
        }


def _cropped(file: Path, crop: Crop) -> bytes:
    """What is taken of a picture, as a PNG."""
    with system_errors(file, "reading"):
        if crop == Crop():
            return file.read_bytes()
        stream = BytesIO()
        with Image.open(file) as image:
            image.crop(box(crop, image.size)).save(stream, "png", compress_level=3)
        return stream.getvalue()


@lru_cache(maxsize=256)
def _small(file: Path) -> bytes:
    """A picture as it stands in the strip."""
    stream = BytesIO()
    with Image.open(file) as image:
        image.thumbnail((_STRIP, _STRIP))
        image.convert("RGB").save(stream, "jpeg", quality=85)
    return stream.getvalue()


@contextmanager
def _incoming(project: Project, name: str) -> Iterator[Path]:
    """A file for what is being sent, which goes away; its suffix says what it is."""
    suffix = PurePath(_file_name(name)).suffix.lower()
    if not suffix.isascii() or not suffix[1:].isalnum() or len(suffix) > 6 or not is_pictures(Path(f"x{suffix}")):
        raise InputError(f"{shown(name)} is no picture, animation or video that is known here: drop another file")
    with system_errors(project.folder, "writing"):
        made = tempfile.TemporaryDirectory(prefix=_INCOMING, dir=project.folder)
    with made as folder:
        yield Path(folder) / f"file{suffix}"


def _file_name(name: str) -> str:
    """The last part of a name that a browser tells, whatever system it is on."""
    return PurePath(name.replace("\\", "/")).name


def _by_name(said: str, file: Path, name: str) -> str:
    """What was said of a file that was sent, by the name that people know it by."""
    return said.replace(str(file), name)
