"""The forecast, in a process of its own: small cubes are solved, and tell how each picture's wall will look."""

from __future__ import annotations

import os
import signal
import time
import warnings
from base64 import b64encode
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.studio.kept import linear, png
from lightcube.studio.project import Crop
from lightcube.verbs.options import Options

#: Voxels across and passes of the first look, and of cubes that lack a picture.
_FIRST, _LACKING = (20, 8), (16, 10)
#: Of a picture as it is read, pixels along a side.
_SIDE = 200
#: So much more than the picture is shown of its wall, on all sides.
_AROUND = 0.16
#: Where all is expected to be exact nothing of the room is taken, dB, and where pictures become poor all of it.
_EMPTY_DB, _FULL_DB = 52.0, 26.0
#: Of more pictures than this it is not asked which costs most.
_MOST_LACKING = 16
#: Seconds without another question before what takes long is begun.
_PAUSE_S = 0.8
#: A picture costs the others something where they gain so many dB without it.
_COSTS_DB = 0.7


@dataclass(frozen=True)
class Asked:
    """What a forecast is asked for: a number, the pictures' keys, names, files and crops, and how the cube is made."""

    number: int
    keys: tuple[str, ...]
    names: tuple[str, ...]
    files: tuple[Path, ...]
    crops: tuple[Crop, ...]
    options: Options
    title: str


class _Newer(Exception):  # noqa: N818 - nothing is wrong
    """Something else is asked for by now."""


def run(pipe: Connection) -> None:
    """Answer what is asked through the pipe, the newest first, until nobody is there any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warnings.simplefilter("ignore")
    with suppress(AttributeError, OSError):
        os.nice(5)  # a solve goes first
    looking = _Looking(pipe)
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
class _Looking:
    """Small cubes, and what is kept of them."""

    pipe: Connection
    kept: Any = None
    #: The order that was found best for pictures, by their keys and crops: it is looked for by the whole look only.
    _orders: dict[tuple[Any, ...], Any] = field(default_factory=dict)

    def warm(self) -> None:
        """Load, and compile where that was never done, before anything is asked."""
        rng = np.random.default_rng(0)
        images = tuple(rng.random((12, 12, 3)).astype(np.float32) for _ in range(2))
        planned = self._plan(images, ("a", "b"), Options(n=24, picture_width=0.5, hold_deg=0.0, grain=0.0))
        self._look(planned, _FIRST)
        self.kept = None

    def answer(self, asked: Asked) -> None:
        """Tell more and more of one question."""
        try:
            for facts in self._answers(asked):
                self.pipe.send(("forecast", {"number": asked.number, **facts}))
                self._give_way()
        except InputError as error:
            self.pipe.send(("forecast", {"number": asked.number, "stage": "failed", "sentence": f"{error}"}))

    def _answers(self, asked: Asked) -> Iterator[dict[str, Any]]:
        began = time.monotonic()
        images = tuple(_read(file, crop) for file, crop in zip(asked.files, asked.crops, strict=True))
        quick = self._ordered(asked, self._plan(images, asked.names, replace(asked.options, grain=0.0, order="given")))
        small, self.kept = self._look(quick, _FIRST, self.kept)
        yield self._told(asked, quick, small, self.kept, began, "first")
        planned = quick
        if asked.options.order == "best":
            planned = self._plan(images, asked.names, replace(asked.options, grain=0.0))
            self._orders = {(asked.keys, asked.crops): planned.order}
        small, cube = self._look(planned)
        told = self._told(asked, planned, small, cube, began, "whole")
        yield told
        self._turn(asked, cube)
        if 2 < len(asked.keys) <= _MOST_LACKING:
            yield told | {"stage": "costs", "costs": self._costs(planned)}

    def _ordered(self, asked: Asked, planned: Any) -> Any:
        """A plan in the order that was found best for its pictures before, where they are to be in the best one."""
        order = self._orders.get((asked.keys, asked.crops)) if asked.options.order == "best" else None
        return planned if order is None else replace(planned, targets=order(planned.targets), order=order)

    def _plan(self, images: tuple[NDArray[np.float32], ...], names: tuple[str, ...], options: Options) -> Any:
        from lightcube.pictures.pictures import Pictures
        from lightcube.verbs import solving

        planning = solving.of_pictures(lambda: Pictures(images, names), options)
        return planning(rehearsals=solving.rehearsals(), told=False)

    def _look(self, planned: Any, size: tuple[int, int] | None = None, start: Any = None) -> tuple[Any, Any]:
        """Solve a small cube: of a size and so many passes, or as predictions are fitted to."""
        from lightcube.backward.job import FEW
        from lightcube.planning.prediction import rehearsed

        width, passes, points = (*size, FEW) if size else (None, None, None)
        return rehearsed(
            planned.targets,
            planned.grid,
            planned.recipe,
            width=width,
            passes=passes,
            points=points,
            start=start,
            callback=self._watch,
        )

    def _watch(self, _: Any) -> None:
        self._give_way()

    def _give_way(self) -> None:
        """Leave a question where another one is asked."""
        if self.pipe.poll():
            raise _Newer

    def _told(self, asked: Asked, planned: Any, small: Any, cube: Any, began: float, stage: str) -> dict[str, Any]:
        """What the walls look like, and how good they are."""
        from lightcube.planning.prediction import law, reached, rehearsal_of
        from lightcube.scoring.metrics import mark

        across = max(cube.grid.shape[1:])
        ratio = max(planned.grid.shape[1:]) / across
        told = law(reached(small, cube), ratio, rehearsal_of(planned.recipe))
        keys = asked.keys if planned.order is None else [asked.keys[number] for number in planned.order.pictures]
        pictures = []
        for key, name, psnr, wall, wanted in zip(
            keys, planned.targets.names, told, _walls(cube), small.pictures, strict=True
        ):
            word = mark(float(psnr))
            pictures.append(
                {
                    "key": key,
                    "name": name,
                    "image": b64encode(png(wall)).decode(),
                    "psnr": round(float(psnr), 1),
                    "mark": word,
                    "reason": _reason(word, wanted),
                }
            )
        mean = float(np.mean(told))
        return {
            "stage": stage,
            "pictures": pictures,
            "psnr": round(mean, 1),
            "full": round(min(max((_EMPTY_DB - mean) / (_EMPTY_DB - _FULL_DB), 0.03), 1.0), 3),
            "angles_deg": [round(float(each), 2) for each in planned.targets.rig.stops.angle_deg],
            "voxels": across,
            "seconds": round(time.monotonic() - began, 3),
        }

    def _turn(self, asked: Asked, cube: Any) -> None:
        """Tell the small cube itself, to be turned until there is a better one."""
        from lightcube.viewer.description import zipped
        from lightcube.viewer.page import contents

        if self.pipe.poll(_PAUSE_S):
            raise _Newer
        description, voxels = contents(cube, asked.title or "A first idea")
        self.pipe.send(("cube", {"scene": zipped(description), "voxels": voxels}))

    def _costs(self, planned: Any) -> list[float]:
        """By how many dB the others become better without each picture."""
        from lightcube.planning.prediction import reached, rehearsed

        def without(number: int | None) -> NDArray[np.float64]:
            kept = np.array([each for each in range(len(planned.targets)) if each != number])
            targets = planned.targets if number is None else planned.targets.take(kept)
            width, passes = _LACKING
            found = rehearsed(targets, planned.grid, planned.recipe, width=width, passes=passes, callback=self._watch)
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
