"""A project: a folder with pictures and settings, of which every change is kept and can be undone."""

from __future__ import annotations

import json
import math
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, model_validator

from lightcube.errors import InputError
from lightcube.io._bounds import check_text
from lightcube.io._files import system_errors
from lightcube.io._toml import read_tables
from lightcube.scene.description import sentence
from lightcube.studio.making import MOST_PICTURES, FilmsMaking, Making, PlateMaking, ShapeMaking, Strict

if sys.platform != "win32":
    import fcntl
else:
    import msvcrt

#: Of the file of settings; another one is not read.
FORMAT = 1
#: Changes that can be undone; seconds within which one thing that is changed again and again, as by a slider, is one.
_MOST_STEPS, _ONE_MOVE_S = 200, 1.5
#: How deeply tables of other parts stand in each other, and so many letters of them, at most.
_DEEPEST, _MOST_LETTERS = 12, 100_000
_FILE, _HISTORY, _LOCK = "project.toml", "history.json", ".studio.lock"
#: What a file is called before it is whole.
_HALF = ".half-written"
#: Folders: what was dropped, what is solved for, and what was made.
DROPPED, PICTURES, MADE = "dropped", "pictures", "made"

#: What can be made; the table of them is `lightcube.studio.kinds.KINDS`.
KindName = Literal["cube", "room", "shape", "plate", "films"]
#: Settings that say how something is made.
MAKINGS = ("making", "shape", "plate", "films")

_Part = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
_Key = Annotated[str, Field(pattern="^[0-9a-f]{16}$")]
_Name = Annotated[str, Field(min_length=1, max_length=80)]


class Crop(Strict):
    """What is taken of a picture, as parts of its width and height from its upper left."""

    left: _Part = 0.0
    top: _Part = 0.0
    width: Annotated[float, Field(ge=0.05, le=1, allow_inf_nan=False)] = 1.0
    height: Annotated[float, Field(ge=0.05, le=1, allow_inf_nan=False)] = 1.0

    @model_validator(mode="after")
    def _within(self) -> Crop:
        if self.left + self.width > 1.0001 or self.top + self.height > 1.0001:
            raise ValueError("the crop is not within its picture")
        return self


class Picture(Strict):
    """A picture of the strip: the key of its file, its name, and what is taken of it."""

    key: _Key
    name: _Name
    crop: Crop = Crop()


class Settings(Strict):
    """All that is said of a project: how each kind of thing is made, also of those that it is not now."""

    kind: KindName = "cube"
    title: Annotated[str, Field(max_length=120)] = ""
    pictures: Annotated[tuple[Picture, ...], Field(max_length=MOST_PICTURES)] = ()
    making: Making = Making()
    shape: ShapeMaking = ShapeMaking()
    plate: PlateMaking = PlateMaking()
    films: FilmsMaking = FilmsMaking()
    #: What other parts of the studio keep, by their names.
    parts: dict[Annotated[str, Field(pattern="^[a-z]{1,20}$")], Any] = {}  # noqa: RUF012 - pydantic copies it

    @model_validator(mode="after")
    def _each_once(self) -> Settings:
        if len({picture.key for picture in self.pictures}) < len(self.pictures):
            raise ValueError("a picture stands in the strip twice")
        if _is_deeper(self.parts, _DEEPEST) or len(json.dumps(self.parts, allow_nan=False)) > _MOST_LETTERS:
            raise ValueError("more is said of the other parts than is kept")
        return self


@dataclass(frozen=True)
class _Step:
    """Settings, and how the history has them."""

    settings: Settings
    text: str

    @classmethod
    def of(cls, settings: Settings) -> _Step:
        return cls(settings, json.dumps(settings.model_dump(mode="json")))


@dataclass(frozen=True)
class _History:
    """All settings that one can come back to, and which of them count: one value, as other threads read it any time."""

    steps: tuple[_Step, ...]
    at: int

    @property
    def now(self) -> Settings:
        """The settings that count."""
        return self.steps[self.at].settings


class Project:
    """A folder that one studio has to itself.

    Parameters
    ----------
    folder
        Is made where there is none.

    Raises
    ------
    InputError
        Where it cannot be written, another studio has it, or its settings are damaged or of a newer version.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = Path(folder).absolute()
        self._lock = threading.RLock()
        self._moved = ("", -math.inf)
        with system_errors(self.folder, "writing"):
            self.folder.mkdir(parents=True, exist_ok=True)
        self._owner = _locked(self.folder)
        try:
            for name in (DROPPED, PICTURES, MADE):
                with system_errors(self.folder / name, "writing"):
                    (self.folder / name).mkdir(exist_ok=True)
            self._tidy()
            self._history = self._read()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Let others have the folder."""
        if self._owner >= 0:
            os.close(self._owner)
        self._owner = -1

    @property
    def settings(self) -> Settings:
        """How it stands now."""
        return self._history.now

    @property
    def keys(self) -> frozenset[str]:
        """The pictures of all settings that one can come back to."""
        return frozenset(picture.key for step in self._history.steps for picture in step.settings.pictures)

    def change(self, change: Callable[[Settings], Settings], moving: str = "") -> Settings:
        """Change the settings and keep them; `InputError` where they cannot be, or not be written.

        Changes of the same thing, named by `moving`, that follow each other closely are undone as one.
        """
        with self._lock:
            before = self.settings
            after = updated(change(before), {})
            if after == before:
                return before
            begun = self._history.steps[: self._history.at + 1 - self._is_moving(moving)]
            is_back = after == begun[-1].settings
            steps = begun if is_back else (*begun, _Step.of(after))[-_MOST_STEPS:]
            self._keep(_History(steps, len(steps) - 1))
            self._moved = "" if is_back else moving, time.monotonic()
            return after

    def _is_moving(self, moving: str) -> bool:
        """Whether a change goes on with the one before."""
        what, when = self._moved
        return "" != moving == what and time.monotonic() - when < _ONE_MOVE_S

    def step(self, way: Literal[-1, 1]) -> Settings:
        """Undo a change, or do it again; `InputError` where there is none."""
        with self._lock:
            steps, at = self._history.steps, self._history.at + way
            if not 0 <= at < len(steps):
                raise InputError("there is nothing to undo" if way < 0 else "there is nothing to do again")
            self._keep(_History(steps, at))
            self._moved = ("", -math.inf)
            return self.settings

    def described(self) -> dict[str, Any]:
        """Settings and what can be done, as plain JSON."""
        history = self._history
        return {
            "folder": str(self.folder),
            "settings": history.now.model_dump(mode="json"),
            "can_undo": history.at > 0,
            "can_redo": history.at + 1 < len(history.steps),
        }

    def path(self, *parts: str) -> Path:
        """A path in the folder; `InputError` where it would lead out of it."""
        found = self.folder.joinpath(*parts)
        if any(part in ("", ".", "..") or "/" in part or "\\" in part or "\0" in part for part in parts):
            raise InputError("this is no file of the project: give the name of one that is in it")
        if not found.resolve().is_relative_to(self.folder.resolve()):
            raise InputError("this leads out of the project's folder: only what is in it is read and written")
        return found

    def write(self, data: bytes, *parts: str) -> None:
        """Write a file of the folder, whole or not at all."""
        with self._written(data, *parts):
            pass

    @contextmanager
    def _written(self, data: bytes, *parts: str, is_vital: bool = True) -> Iterator[None]:
        """Write a file beside its place, which it takes after what is done inside.

        What is not vital may be lost when the power is.
        """
        target = self.path(*parts)
        begun = target.with_name(f".{target.name}.{threading.get_ident()}{_HALF}")
        try:
            with system_errors(target, "writing"), begun.open("wb") as opened:
                opened.write(data)
                if is_vital:
                    opened.flush()
                    os.fsync(opened.fileno())
            yield
            with system_errors(target, "writing"):
                begun.replace(target)
        finally:
            with suppress(OSError):
                begun.unlink(missing_ok=True)

    def _keep(self, history: _History) -> None:
        """Write settings and history, both or none, and only then believe them."""
        texts = ", ".join(step.text for step in history.steps)
        text = f'{{"format": {FORMAT}, "at": {history.at}, "steps": [{texts}]}}'
        with self._written(text.encode(), _HISTORY, is_vital=False):
            self.write(toml_text(history.now).encode(), _FILE)
        self._history = history

    def _tidy(self) -> None:
        """Remove what a studio that was killed had half written."""
        for folder in (self.folder, *(self.folder / name for name in (DROPPED, PICTURES, MADE))):
            for begun in folder.glob(f".*{_HALF}"):
                with suppress(OSError):
                    begun.unlink()

    def _read(self) -> _History:
        """What was kept; the settings count, and a history that ends elsewhere is none."""
        file = self.path(_FILE)
        if not file.exists():
            self.write(toml_text(Settings()).encode(), _FILE)
            return _History((_Step.of(Settings()),), 0)
        settings = _of_tables(read_tables(file, str(file)), str(file))
        try:
            history = json.loads(self.path(_HISTORY).read_bytes())
            steps = tuple(_Step.of(Settings.model_validate(step)) for step in history["steps"])
            found = _History(steps, int(history["at"]))
            if 0 <= found.at < len(steps) and found.now == settings:
                return found
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            pass  # it was not written yet, or is damaged: what was changed can then not be undone
        return _History((_Step.of(settings),), 0)


def updated(settings: Settings, update: dict[str, Any]) -> Settings:
    """Settings of which some fields are others, every one looked at again; `InputError` says which cannot be."""
    try:
        return Settings.model_validate(settings.model_dump(warnings=False) | update)
    except ValidationError as error:
        raise InputError(said(error.errors())) from error


def _is_deeper(value: Any, most: int) -> bool:
    """Whether lists and tables stand in each other more deeply than so."""
    inside = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return most < 0 or any(_is_deeper(each, most - 1) for each in inside)


def said(problems: Sequence[Any]) -> str:
    """The first of what pydantic found wrong, as a sentence."""
    if not problems:
        return "this cannot be read"
    problem = problems[0]
    if problem["type"] == "value_error":  # it is a sentence already
        return f"{problem['ctx']['error']}"
    return sentence(problem | {"loc": [each for each in problem["loc"] if each not in ("body", "query")]})


def _of_tables(tables: dict[str, Any], called: str) -> Settings:
    """Settings of the tables of a file; `InputError` names the file."""
    version = tables.pop("format", None)
    if version != FORMAT:
        newer = isinstance(version, int) and version > FORMAT
        helps = "update lightcube" if newer else "move the file away to begin anew"
        raise InputError(f"{called} has format {version}, and this studio reads {FORMAT}: {helps}")
    try:
        tables["parts"] = json.loads(tables.get("parts", "{}"))
        return Settings.model_validate(tables)
    except ValidationError as error:
        raise InputError(
            f"{called} is damaged: {said(error.errors())}; mend it, or move it away to begin anew"
        ) from error
    except (ValueError, TypeError, RecursionError) as error:
        raise InputError(f"{called} is damaged in its parts: mend it, or move it away to begin anew") from error


def toml_text(settings: Settings) -> str:
    """The file of settings."""
    plain = settings.model_dump(mode="json")
    lines = [f"format = {FORMAT}", *(f"{name} = {_text(plain[name])}" for name in ("kind", "title"))]
    lines.append(f"parts = {_text(json.dumps(plain['parts']))}")
    for made in MAKINGS:
        lines += ["", f"[{made}]", *(f"{name} = {_text(value)}" for name, value in plain[made].items())]
    for picture in plain["pictures"]:
        crop = ", ".join(f"{name} = {value!r}" for name, value in picture["crop"].items())
        lines += ["", "[[pictures]]", f"key = {_text(picture['key'])}", f"name = {_text(picture['name'])}"]
        lines.append(f"crop = {{ {crop} }}")
    text = "\n".join(lines) + "\n"
    check_text(len(text))
    return text


def _text(value: str | float) -> str:
    """A value as TOML has it: JSON's escapes, and DEL, which only TOML wants escaped."""
    if not isinstance(value, str):
        return json.dumps(value)
    safe = value.encode("utf-8", "replace").decode()
    return json.dumps(safe, ensure_ascii=False).replace("\x7f", "\\u007f")


def _locked(folder: Path) -> int:
    """Take the folder for this studio alone; the system gives it back however the studio ends."""
    file = folder / _LOCK
    with system_errors(file, "writing"):
        owner = os.open(file, os.O_RDWR | os.O_CREAT, 0o600)
    try:
        if sys.platform != "win32":
            fcntl.flock(owner, fcntl.LOCK_EX | fcntl.LOCK_NB)
        else:
            msvcrt.locking(owner, msvcrt.LK_NBLCK, 1)
    except OSError as error:
        os.close(owner)
        raise InputError(
            f"{folder} is open in another studio already: go on there, or close it, or name another folder"
        ) from error
    return owner
