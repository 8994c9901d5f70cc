"""What a job will need is told quickly: how fast this machine is, is measured once."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lightcube.backward.needs import Speed, job_memory
from lightcube.backward.recipe import Recipe
from lightcube.backward.solving import make_job
from lightcube.errors import InputError
from lightcube.optics.glass import Glass
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


def test_pieces_of_rays_take_half_of_what_memory_is_free_and_are_no_reason_to_refuse(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rig = turntable(GRID, [10.0, 130.0], elevation_deg=20, picture_shape=(3, 3), glass=Glass(1.5, "sphere"))
    job = make_job(Targets(np.full((2, 3, 3, 3), 0.5, np.float32), rig), GRID)
    all_of_it, least = job_memory(job), job_memory(replace(job, room=0))

    def needed(free: int, processes: int = 1) -> int:
        monkeypatch.setattr("lightcube.verbs.solving.io.free_memory", lambda: free)
        return job_memory(solving.fitted(job, processes))

    assert all_of_it > least
    assert needed(2 * all_of_it) == needed(4 * all_of_it, 2) == all_of_it
    assert needed(2 * all_of_it - 2) == needed(2 * least, 2) == needed(least) == least
    with pytest.raises(InputError, match="GB are free"):
        needed(least - 1)
