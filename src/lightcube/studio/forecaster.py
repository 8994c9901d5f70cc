"""The forecast, in a process of its own: small cubes are solved, and tell how each picture's wall will look.

What is told of other things than cubes on a turntable stands in `lightcube.studio.foretelling`.
"""

from __future__ import annotations

import os
import signal
import time
import warnings
from base64 import b64encode
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.studio.kept import linear, png
from lightcube.studio.makers import without_commands
from lightcube.studio.project import Crop
from lightcube.studio.worker import why
from lightcube.verbs.options import Options

#: Voxels across and passes of the first look, and of cubes that lack a picture.
FIRST, _LACKING = (20, 8), (16, 10)
#: Of a picture as it is read, pixels along a side.
_SIDE = 200
#: So much more than the picture is shown of its wall, on all sides.
_AROUND = 0.16
#: Where all is expected to be exact nothing of the room is taken, dB, and where pictures become poor all of it.
_EMPTY_DB, _FULL_DB = 52.0, 26.0
#: Of more pictures than this it is not asked which costs most.
_MOST_LACKING = 16
#: What a question has of each picture.
_OF_PICTURES = ("keys", "names", "files", "crops")
#: Seconds without another question before what takes long is begun.
_PAUSE_S = 0.8


@dataclass(frozen=True)
class Asked:
    """What a forecast is asked for.

    Parameters
    ----------
    number
        Later questions have larger ones.
    foretell, how
        Who answers for what is to be made, and how that is made, as its verb takes it.
    keys, names, files, crops
        Of the pictures as they were dropped.
    source
        The same as the verb reads them.
    title
        What it will be called.
    """

    number: int
    foretell: Foretell
    how: Any
    keys: tuple[str, ...]
    names: tuple[str, ...]
    files: tuple[Path, ...]
    crops: tuple[Crop, ...]
    source: Path
    title: str

    def in_order(self, order: Any) -> Asked:
        """The same of the pictures in another order, where there is one."""
        if order is None:
            return self
        moved: dict[str, Any] = {
            name: tuple(getattr(self, name)[each] for each in order.pictures) for name in _OF_PICTURES
        }
        return replace(self, **moved)


@dataclass(frozen=True)
class Look:
    """How a picture's wall will look, in 8-bit levels, how good that is, as a mark and in figures, and why."""

    name: str
    levels: NDArray[np.uint8]
    mark: str
    worth: str
    reason: str = ""


class _Newer(Exception):  # noqa: N818 - nothing is wrong
    """Something else is asked for by now."""


def run(pipe: Connection) -> None:
    """Answer what is asked through the pipe, the newest first, until nobody is there any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warnings.simplefilter("ignore")
    with suppress(AttributeError, OSError):
        os.nice(5)  # a solve goes first
    looking = Looking(pipe)
    from lightcube.kernels.compiled import when_compiling  # here: the compiler comes with it

    with suppress(EOFError, OSError), when_compiling(lambda: pipe.send(("compiling", {}))):
        with suppress(_Newer):
            looking.warm()
        pipe.send(("ready", {}))
        while True:
            asked = pipe.recv()
            while pipe.poll():
                asked = pipe.recv()
            with suppress(_Newer):
                looking.answer(asked)


@dataclass
class Looking:
    """Small cubes, and what is kept of them."""

    pipe: Connection
    kept: Any = None
    #: The order that was found best for pictures, by their keys and crops: it is looked for by the whole look only.
    orders: dict[tuple[Any, ...], Any] = field(default_factory=dict)

    def warm(self) -> None:
        """Load, and compile where that was never done, before anything is asked."""
        rng = np.random.default_rng(0)
        images = tuple(rng.random((12, 12, 3)).astype(np.float32) for _ in range(2))
        planned = _planned(images, ("a", "b"), Options(n=24, picture_width=0.5, hold_deg=0.0, grain=0.0))
        self.look(planned, FIRST)
        self.kept = None

    def answer(self, asked: Asked) -> None:
        """Tell more and more of one question."""
        try:
            for told in asked.foretell(self, asked):
                notes = without_commands(told.get("notes", ()))
                self.pipe.send(("forecast", {"number": asked.number, **told, "notes": notes}))
                self.give_way()
        except _Newer:
            raise
        except Exception as error:  # whatever it is, the next question is answered
            self.pipe.send(("forecast", {"number": asked.number, "stage": "failed", "sentence": why(error)}))

    def look(self, planned: Any, size: tuple[int, int] | None = None) -> tuple[Any, Any]:
        """Solve a small cube: from the one before, of a size and so many passes, or as predictions are fitted to."""
        from lightcube.backward.job import FEW
        from lightcube.planning.prediction import rehearsed

        width, passes, points = (*size, FEW) if size else (None, None, None)
        small, cube = rehearsed(
            planned.targets,
            planned.grid,
            planned.recipe,
            width=width,
            passes=passes,
            points=points,
            start=self.kept if size else None,
            callback=self.watch,
        )
        self.kept = cube if size else self.kept
        return small, cube

    def watch(self, _: Any) -> None:
        """Look on while something is solved."""
        self.give_way()

    def give_way(self) -> None:
        """Leave a question where another one is asked."""
        if self.pipe.poll():
            raise _Newer

    def show(self, asked: Asked, cube: Any) -> None:
        """Tell the small cube itself, to be turned until there is a better one."""
        from lightcube.studio.viewed import viewed

        if self.pipe.poll(_PAUSE_S):
            raise _Newer
        self.pipe.send(("cube", {"number": asked.number, **viewed(cube, asked.title or "A first idea")}))


#: Tells more and more of what will come of a question.
Foretell = Callable[[Looking, Asked], Iterator[dict[str, Any]]]


def of_a_turntable(looking: Looking, asked: Asked) -> Iterator[dict[str, Any]]:
    """What will come of a cube on a turntable."""
    began = time.monotonic()
    images = tuple(_read(file, crop) for file, crop in zip(asked.files, asked.crops, strict=True))
    planned = _planned(images, asked.names, replace(asked.how, grain=0.0, order="given"))
    quick = _ordered(looking, asked, planned)
    yield told_of_cube(asked, quick, *looking.look(quick, FIRST), began, "first")
    if asked.how.order == "best":
        planned = _planned(images, asked.names, replace(asked.how, grain=0.0))
        looking.orders = {(asked.keys, asked.crops): planned.order}
    small, cube = looking.look(planned)
    told = told_of_cube(asked, planned, small, cube, began, "whole") | {"notes": planned.doubtful}
    yield told
    looking.show(asked, cube)
    if 2 < len(asked.keys) <= _MOST_LACKING:
        yield told | {"stage": "costs", "costs": _costs(looking, planned)}


def _ordered(looking: Looking, asked: Asked, planned: Any) -> Any:
    """A plan in the order that was found best for its pictures before, where they are to be in the best one."""
    order = looking.orders.get((asked.keys, asked.crops)) if asked.how.order == "best" else None
    return planned if order is None else replace(planned, targets=order(planned.targets), order=order)


def _planned(images: tuple[NDArray[np.float32], ...], names: tuple[str, ...], options: Options) -> Any:
    from lightcube.pictures.pictures import Pictures
    from lightcube.verbs import solving

    planning = solving.of_pictures(lambda: Pictures(images, names), options)
    return planning(rehearsals=solving.rehearsals(), told=False)


def told_of_cube(asked: Asked, planned: Any, small: Any, cube: Any, began: float, stage: str) -> dict[str, Any]:
    """What the walls of a small cube look like, how good the large one will be, and how full."""
    from lightcube.planning.prediction import law, reached, rehearsal_of

    across = max(cube.grid.shape[1:])
    ratio = max(planned.grid.shape[1:]) / across
    told = law(reached(small, cube), ratio, rehearsal_of(planned.recipe))
    reasons = [_reason(mark_of(psnr), wanted) for psnr, wanted in zip(told, small.pictures, strict=True)]
    mean = float(np.mean(told))
    return facts(asked.in_order(planned.order), looks_of(cube, told, reasons), began, stage) | {
        "psnr": round(mean, 1),
        "full": round(min(max((_EMPTY_DB - mean) / (_EMPTY_DB - _FULL_DB), 0.03), 1.0), 3),
        "angles_deg": [round(float(each), 2) for each in planned.targets.rig.stops.angle_deg],
        "voxels": across,
    }


def mark_of(psnr: float) -> str:
    """Good, fair or poor."""
    from lightcube.scoring.metrics import mark

    return mark(float(psnr))


def looks_of(cube: Any, told: Iterable[float], reasons: Sequence[str]) -> list[Look]:
    """How the walls of a cube look, and how good they are said to be."""
    each = zip(cube.names, _walls(cube), told, reasons, strict=True)
    return [Look(name, levels, mark_of(psnr), f"{psnr:.1f} dB", reason) for name, levels, psnr, reason in each]


def facts(asked: Asked, looks: Sequence[Look], began: float, stage: str, notes: Sequence[str] = ()) -> dict[str, Any]:
    """What is told of all pictures, whoever foretold it; `notes` are sentences on the whole."""
    keys = dict(zip(asked.names, asked.keys, strict=True))
    pictures = [
        {
            "key": keys[look.name] if len(keys) == len(looks) and look.name in keys else asked.keys[number],
            "name": look.name,
            "image": b64encode(png(look.levels)).decode(),
            "mark": look.mark,
            "worth": look.worth,
            "reason": look.reason,
        }
        for number, look in enumerate(looks)
    ]
    return {
        "stage": stage,
        "pictures": pictures,
        "notes": list(notes),
        "seconds": round(time.monotonic() - began, 3),
    }


def _costs(looking: Looking, planned: Any) -> list[float]:
    """By how many dB the others become better without each picture."""
    from lightcube.planning.prediction import reached, rehearsed

    def without(number: int | None) -> NDArray[np.float64]:
        kept = np.array([each for each in range(len(planned.targets)) if each != number])
        targets = planned.targets if number is None else planned.targets.take(kept)
        width, passes = _LACKING
        found = rehearsed(targets, planned.grid, planned.recipe, width=width, passes=passes, callback=looking.watch)
        return np.asarray(reached(*found))

    everyone = without(None)
    costs = []
    for number in range(len(everyone)):
        gained = without(number) - np.delete(everyone, number)
        costs.append(round(float(np.mean(gained)), 2))
    return costs


@lru_cache(maxsize=128)
def _read(file: Path, crop: Crop) -> NDArray[np.float32]:
    return linear(file, crop, _SIDE)


def _walls(cube: Any) -> Iterator[NDArray[np.uint8]]:
    """Each picture on its wall, with some of what is around it."""
    from lightcube.forward.casting import play
    from lightcube.optics.transfer import to_uint8

    for shown, window in zip(play(cube), cube.rig.stops.window, strict=True):
        sides = []
        for whole, own in zip(shown.shape[:2], window, strict=True):
            seen = min(whole, int(own) + 2 * max(1, round(_AROUND * int(own))))
            first = (whole - seen) // 2
            sides.append(slice(first, first + seen))
        yield to_uint8(shown[sides[0], sides[1]], cube.transfer)


def _reason(word: str, wanted: NDArray[np.float32]) -> str:
    """Why a picture becomes as it does, as far as the picture itself tells."""
    if word == "good":
        return ""
    light = wanted.mean(axis=2)
    if float(np.mean(light > 0.6)) > 0.5:
        return "mostly bright: hardly any glass may stand in its light"
    if float(np.mean(light < 0.03)) > 0.5:
        return "mostly dark: the light of the others falls into it"
    if float(np.mean(wanted.max(axis=2) - wanted.min(axis=2))) > 0.45:
        return "strong colours: the glass for them stands in the way of others"
    return "too much is asked of the glass: fewer or narrower pictures help"
