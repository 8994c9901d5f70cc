"""Questions to small cubes: each is asked once, by its contents, and answers that make no sense are asked anew."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lightcube.backward.mat import Mat
from lightcube.backward.recipe import Recipe
from lightcube.events import Interrupted, Progress, Said
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.pictures.targets import Targets
from lightcube.planning import order, rehearsals
from lightcube.planning.order import Order
from lightcube.planning.prediction import AREA, Prediction
from lightcube.planning.rehearsals import Rehearsals

GRID = Grid((3, 5, 7))
TARGETS = Targets(
    np.random.default_rng(0).uniform(0.1, 1, (2, 3, 5, 3)).astype(np.float32),
    turntable(GRID, [10.0, 100.0], picture_shape=(3, 5)),
)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Recipe]:
    """Every question that a small cube is asked."""
    calls: list[Recipe] = []

    def predict(targets: Targets, _grid: Grid, recipe: Recipe) -> Prediction:
        calls.append(recipe)
        return Prediction(np.arange(30.25, 30 + len(targets)), 4)

    def best_order(targets: Targets, _grid: Grid, recipe: Recipe) -> Order:
        calls.append(recipe)
        return Order(np.arange(len(targets))[::-1].astype(np.intp), 20.5, 21.5)

    monkeypatch.setattr(rehearsals, "predict", predict)
    monkeypatch.setattr(order, "best_order", best_order)
    return calls


def test_a_question_is_asked_once(asked: list[Recipe]) -> None:
    known: dict[str, Any] = {}
    for _ in range(2):
        small = Rehearsals(known)
        assert small.predict(TARGETS, GRID, Recipe()).psnr.tolist() == [30.25, 31.25]
        assert small.best_order(TARGETS, GRID, Recipe()).pictures.tolist() == [1, 0]
    assert len(asked) == len(known) == 2


def test_what_decides_the_answer_is_part_of_the_question(asked: list[Recipe]) -> None:
    small = Rehearsals()
    darker = replace(TARGETS, pictures=TARGETS.pictures * np.float32(0.5))
    for targets, grid, recipe in (
        (TARGETS, GRID, Recipe()),
        (darker, GRID, Recipe()),
        (TARGETS, replace(GRID, voxel_mm=2.0), Recipe()),
        (TARGETS, GRID, Recipe(hold_deg=1.0)),
        (TARGETS, GRID, Recipe(mat=Mat())),
    ):
        small.predict(targets, grid, recipe)
    assert len(asked) == 5


def test_other_laws_are_other_questions(asked: list[Recipe], monkeypatch: pytest.MonkeyPatch) -> None:
    known: dict[str, Any] = {}
    Rehearsals(known).predict(TARGETS, GRID, Recipe())
    monkeypatch.setattr("lightcube.planning.prediction.AREA", AREA._replace(bias=1.0))
    Rehearsals(known).predict(TARGETS, GRID, Recipe())
    assert len(asked) == 2


@pytest.mark.parametrize("nonsense", [None, [], {}, {"psnr": "x", "rehearsed": 4}, {"psnr": [1.0], "rehearsed": 4}])
def test_nonsense_that_is_remembered_is_asked_anew(asked: list[Recipe], nonsense: object) -> None:
    known: dict[str, Any] = {}
    Rehearsals(known).predict(TARGETS, GRID, Recipe())
    known[next(iter(known))] = nonsense
    assert Rehearsals(known).predict(TARGETS, GRID, Recipe()).psnr.tolist() == [30.25, 31.25]
    assert len(asked) == 2
    known |= {key: {"pictures": [0, 0], "given_db": 1.0, "best_db": 2.0} for key in known}
    Rehearsals(known).predict(TARGETS, GRID, Recipe())
    assert len(asked) == 3


@pytest.mark.parametrize("pictures", [[0, 0], [0], [0, 2], ["a", "b"]])
def test_an_order_that_is_none_is_looked_for_anew(asked: list[Recipe], pictures: list[object]) -> None:
    known: dict[str, Any] = {}
    Rehearsals(known).best_order(TARGETS, GRID, Recipe())
    known[next(iter(known))] = {"pictures": pictures, "given_db": 1.0, "best_db": 2.0}
    assert Rehearsals(known).best_order(TARGETS, GRID, Recipe()).pictures.tolist() == [1, 0]
    assert len(asked) == 2


def test_it_tells_what_it_tries_and_stops_where_it_is_told_to(asked: list[Recipe]) -> None:
    told: list[Progress | Said] = []
    small = Rehearsals(tell=told.append)
    for hold_deg in (0.0, 0.5, 0.0):
        small.predict(TARGETS, GRID, Recipe(hold_deg=hold_deg))
    steps = [step for step in told if isinstance(step, Progress)]
    assert [step.figures["width"] for step in steps] == pytest.approx([1.0, 1.0])
    assert [step.figures["hold"] for step in steps] == [0.0, 0.5]
    assert all(0 <= step.done < step.of for step in steps)
    with pytest.raises(Interrupted):
        Rehearsals(tell=lambda _: True).predict(TARGETS, GRID, Recipe())
