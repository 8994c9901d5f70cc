"""The forecast tells more and more of a question, in the order in which the pictures will stand."""

from multiprocessing import Pipe
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

pytest.importorskip("fastapi", reason="the studio's extra is not installed")

from lightcube.planning.order import Order
from lightcube.studio.forecaster import Asked, Looking, of_a_turntable
from lightcube.studio.project import Crop
from lightcube.verbs.options import Options


def test_a_first_look_has_the_order_that_was_found_best(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The pictures have one name, as those of a film may: they are known by their keys."""
    found = Order(np.array([2, 0, 1]), 20.0, 30.0)
    monkeypatch.setattr("lightcube.planning.order.best_order", lambda *_: found)
    keys, files = tuple(f"{number:016x}" for number in range(3)), tuple(tmp_path / f"{number}.png" for number in "abc")
    for number, file in enumerate(files):
        Image.new("RGB", (7, 5), (80 * number, 90, 200 - 80 * number)).save(file)
    ours, theirs = Pipe()
    looking = Looking(theirs)

    def asked(order: Any) -> list[list[str]]:
        options = Options(n=16, picture_width=0.5, hold_deg=0.0, order=order)
        pictures = keys, ("one name",) * 3, files, (Crop(),) * 3
        answers = of_a_turntable(looking, Asked(1, of_a_turntable, options, *pictures, tmp_path, ""))
        return [[each["key"] for each in next(answers)["pictures"]] for _ in range(2)]

    told = [asked(order) for order in ("best", "best", "given")]
    best = [keys[2], keys[0], keys[1]]
    assert told == [[list(keys), best], [best, best], [list(keys), list(keys)]]
    ours.close()


def test_whatever_goes_wrong_is_told_and_the_next_question_is_answered(tmp_path: Path) -> None:
    ours, theirs = Pipe()

    def wrong(*_: Any) -> Any:
        raise MemoryError

    Looking(theirs).answer(Asked(7, wrong, None, (), (), (), (), tmp_path, ""))
    told, facts = ours.recv()
    assert (told, facts["number"], facts["stage"]) == ("forecast", 7, "failed")
    assert "not enough memory" in facts["sentence"]
    ours.close()
