"""What verbs tell as they go on, that they stop where they are told to, and that they print nothing."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lightcube.events import Interrupted, Progress, Said, Tell
from lightcube.io import read_scene, save
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.pictures.fitting import as_levels, targets_of
from lightcube.pictures.targets import Targets
from lightcube.scoring import metrics
from lightcube.verbs import reporting, scoring, tracing, viewing
from lightcube.viewer import smaller
from tests.helpers.wall import play


@pytest.fixture
def cube() -> Cube:
    """A cube with the pictures that it casts."""
    grid = Grid((3, 5, 7), 2.0)
    extinction = np.random.default_rng(0).uniform(0, 0.1, (3, 3, 5, 7)).astype(np.float32)
    made = Cube(extinction, grid, turntable(grid, [10.0, 100.0], picture_shape=(3, 5)))
    return replace(made, targets=as_levels(Targets(play(made), made.rig)))


def works(cube: Cube, folder: Path) -> dict[str, Callable[[Tell], object]]:
    """Work by name, as a function of what is told of it."""
    file = save(cube, folder / "a.npz", overwrite=True)
    wanted = targets_of(cube)
    return {
        "between": lambda tell: scoring.score(cube, wanted, tell, between=True),
        "off": lambda tell: scoring.score(cube, wanted, tell, off=True),
        "report": lambda tell: reporting.report(cube, str(file), None, tell),
        "trace": lambda tell: tracing.trace(read_scene("gems"), tell, count=3, size=(5, 4)),
        "view": lambda tell: viewing.page(cube, "a", tell),
    }


@pytest.mark.parametrize("name", ["between", "off", "report", "trace", "view"])
def test_verbs_tell_how_far_they_are_and_stop_where_they_are_told_to(
    cube: Cube, tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.setattr(smaller, "MOST_SIDE", 4)
    work, told = works(cube, tmp_path)[name], list[Progress | Said]()
    work(told.append)
    steps = [event for event in told if isinstance(event, Progress)]
    assert len(steps) == len(told) >= 1
    assert all(0 <= step.done <= step.of for step in steps)
    assert [step.done for step in steps] == sorted(step.done for step in steps)
    assert steps[-1].done == steps[-1].of or name == "view"  # where the smaller cube is good enough before

    heard = list[Progress | Said]()

    def stop(event: Progress | Said) -> bool:
        heard.append(event)
        return True

    with pytest.raises(Interrupted):
        work(stop)
    assert len(heard) == 1
    assert capfd.readouterr() == ("", "")


def test_scores_hold_what_was_asked_for(cube: Cube) -> None:
    wanted = targets_of(cube)
    plain = scoring.score(cube, wanted, lambda _: None)
    assert plain.scores == metrics.score(cube, wanted)
    assert plain.curve is None
    more = scoring.score(cube, wanted, lambda _: None, between=True, off=True)
    assert more.scores == {**plain.scores, "between": more.scores["between"], "robust": more.scores["robust"]}
    assert more.curve is not None
    assert len(more.curve.psnr) == len(more.scores["between"]["psnr"])
    assert scoring.sheet(cube, wanted, plain, "a").dtype == np.uint8


def test_a_page_says_what_it_holds(cube: Cube, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = viewing.page(cube, "a", lambda _: None)
    assert whole.shape == (3, 5, 7)
    assert whole.text.startswith("<!doctype html>")
    monkeypatch.setattr(smaller, "MOST_SIDE", 4)
    assert viewing.is_solved_anew(cube, full=False)
    assert not viewing.is_solved_anew(cube, full=True)
    assert max(viewing.page(cube, "a", lambda _: None).shape) == 4
    assert viewing.page(cube, "a", lambda _: None, full=True).shape == (3, 5, 7)
