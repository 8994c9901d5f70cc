"""What small cubes are asked: how good pictures become, and in which order best; each question once."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, MutableMapping
from contextlib import suppress
from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from lightcube.backward.job import Job, fingerprint
from lightcube.backward.recipe import Recipe
from lightcube.errors import InputError
from lightcube.events import Interrupted, Progress, Tell
from lightcube.optics.grid import Grid
from lightcube.pictures.targets import Targets
from lightcube.planning.prediction import HOLD, Prediction, predict, rehearsal_of

if TYPE_CHECKING:
    from lightcube.planning.order import Order

Answer = TypeVar("Answer", "Prediction", "Order")

#: A plan takes about so many answers: what a bar of them is as long as.
_EXPECTED = 4


class Rehearsals:
    """Answers of small cubes, which take a second each; what was answered before is looked up.

    Parameters
    ----------
    known
        Answers by question, where they are looked up and put: plain JSON, by what is 64 hexadecimal digits; None = only
        as long as this lives.
    tell
        Told of each question before it is asked; True raises `lightcube.events.Interrupted`.
    """

    def __init__(self, known: MutableMapping[str, Any] | None = None, tell: Tell | None = None) -> None:
        self._known = {} if known is None else known
        self._tell, self._asked = tell, 0

    def predict(self, targets: Targets, grid: Grid, recipe: Recipe) -> Prediction:
        """As `lightcube.predict`."""

        def answer() -> Prediction:
            return predict(targets, grid, recipe)

        def read(plain: Any) -> Prediction:
            psnr = np.array(plain["psnr"], np.float64)
            if psnr.shape != (len(targets),):
                raise ValueError
            return Prediction(psnr, plain["rehearsed"])

        question = ["prediction", *rehearsal_of(recipe), HOLD]
        return self._answered(question, (targets, grid, recipe), answer, read)

    def best_order(self, targets: Targets, grid: Grid, recipe: Recipe) -> Order:
        """As `lightcube.best_order`."""
        from lightcube.planning import order  # here: the compiler comes with it

        def answer() -> Order:
            return order.best_order(targets, grid, recipe)

        def read(plain: Any) -> Order:
            pictures = np.array(plain["pictures"], np.intp)
            if sorted(pictures) != list(range(len(targets))):
                raise ValueError
            return order.Order(pictures, plain["given_db"], plain["best_db"])

        return self._answered(["order"], (targets, grid, recipe), answer, read)

    def _answered(
        self,
        question: list[Any],
        of: tuple[Targets, Grid, Recipe],
        answer: Callable[[], Answer],
        read: Callable[[Any], Answer],
    ) -> Answer:
        """The answer that is known, or a new one; what is no answer to the question is not known."""
        asked = json.dumps([question, fingerprint(Job(*of))], sort_keys=True)
        key = hashlib.sha256(asked.encode()).hexdigest()
        if key in self._known:
            with suppress(TypeError, ValueError, KeyError, InputError):
                return read(self._known[key])
        self._say(*of)
        found = answer()
        self._known[key] = {
            each.name: value.tolist() if isinstance(value := getattr(found, each.name), np.ndarray) else value
            for each in fields(found)
        }
        return found

    def _say(self, targets: Targets, grid: Grid, recipe: Recipe) -> None:
        if self._tell is None:
            return
        wide = targets.rig.picture_shape[1] * targets.rig.views.pixel_in(grid)[1]
        figures = {"width": wide / grid.shape[1], "hold": recipe.hold_deg}
        if self._tell(Progress(self._asked, max(_EXPECTED, self._asked + 1), figures)):
            raise Interrupted
        self._asked += 1
