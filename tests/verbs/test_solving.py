"""What a job will need is told quickly: how fast this machine is, is measured once."""

from pathlib import Path

import numpy as np
import pytest

from lightcube.backward.needs import Speed
from lightcube.backward.recipe import Recipe
from lightcube.backward.solving import make_job
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.pictures.targets import Targets
from lightcube.verbs import solving

GRID = Grid((3, 5, 7))


@pytest.fixture
def measured(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[float]:
    """What speeds were measured, one faster than the other, in a cache of its own."""
    found: list[float] = []

    def measure(job: object) -> Speed:
        found.append(1.0 / (1 + len(found)))
        return Speed(found[-1], 0.0)

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(solving, "measured_speed", measure)
    return found


def seconds(recipe: Recipe) -> float:
    rig = turntable(GRID, [10.0, 130.0], elevation_deg=20, picture_shape=(3, 3))
    targets = Targets(np.full((2, 3, 3, 3), 0.5, np.float32), rig)
    return float(solving.needs(make_job(targets, GRID, recipe))["seconds"])


def test_a_speed_is_measured_once_for_jobs_of_a_kind(measured: list[float]) -> None:
    first = seconds(Recipe(passes=10))
    assert seconds(Recipe(passes=20)) == pytest.approx(2 * first)
    assert len(measured) == 1
    seconds(Recipe(passes=10, dtype="float64"))
    assert len(measured) == 2


@pytest.mark.parametrize("damage", ["", "[1]", '{"a": 1}', '["x", 2]'])
def test_a_damaged_memory_is_none(measured: list[float], tmp_path: Path, damage: str) -> None:
    seconds(Recipe())
    for file in (tmp_path / "lightcube").glob("*.json"):
        file.write_text(damage)
    seconds(Recipe())
    assert len(measured) == 2
