"""A function of somebody else solves cubes, with all around it that the package's own methods have."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lightcube.backward.solving import make_job, solve_job
from lightcube.backward.store import MemoryStore
from lightcube.errors import InputError
from lightcube.jobs.partial import load_job, open_partial
from lightcube.jobs.reading import load
from lightcube.optics.grid import Grid
from lightcube.solvers.method import Method
from tests.backward.test_job import LEVEL, SHAPE, same, some_targets
from tests.helpers.recipes import asked
from tests.helpers.solver_problems import plain_descent

PLACE = "tests.helpers.solver_problems:plain_descent"
#: Level slabs, and colours under a raised lamp, in parts; both start from half the size, and the second is held.
KINDS: list[dict[str, Any]] = [{**LEVEL, "lamp_power": 1.0}, {"units": 2, "hold_deg": 2.0, "lamp_power": 2.0}]


def job(elevation_deg: float = 35.0, size: tuple[int, int] = (3, 5), **options: Any) -> Any:
    targets, grid = some_targets(size=size, elevation_deg=elevation_deg), Grid(SHAPE, 0.7)
    return make_job(**asked(targets, grid, **{"passes": 12, "method": plain_descent, **options}))


@pytest.mark.parametrize("options", KINDS, ids=str)
def test_a_function_is_stopped_and_goes_on_to_the_same_bits(
    options: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("lightcube.backward.units.COARSEST", 4)
    made, store = job(**options), MemoryStore()
    assert made.levels == 1
    straight = solve_job(made)
    assert straight.cube.provenance["method"] == PLACE
    for _ in range(40):
        calls = 0

        def fourth(step: Any) -> bool:
            nonlocal calls
            calls += 1
            return calls == 4

        stopped = solve_job(made, store, fourth)
        if stopped.cube.status == "complete":
            break
    assert same(stopped, straight)


def test_its_figures_add_up_over_units_as_sums_do() -> None:
    one, two = (solve_job(job(lamp_power=1.0, units=units)) for units in (1, 2))
    np.testing.assert_allclose(two.residuals, one.residuals, rtol=1e-5)
    assert np.all(two.cube.powers == 1)


def test_it_is_known_by_its_name_on_the_disk(tmp_path: Path) -> None:
    """Begun as a function, continued by its name; what another one began is not gone on with."""
    out = tmp_path / "a.zarr"
    made = job(lamp_power=1.0)
    solve_job(made, open_partial(out, made), lambda step: step.iteration == 5)
    with pytest.warns(UserWarning, match="still being made"):
        assert load(tmp_path / "a.zarr.partial").provenance["method"] == PLACE
    again = load_job(tmp_path / "a.zarr.partial")
    assert again.recipe.solver == Method(plain_descent)
    assert same(solve_job(again, open_partial(out, job(lamp_power=1.0, method=PLACE))), solve_job(made))
    with pytest.raises(InputError, match=f"method was {PLACE} and is sirt"):
        open_partial(out, job(lamp_power=1.0, method="sirt"))


def test_what_no_name_leads_to_is_solved_but_not_kept_on_the_disk(tmp_path: Path) -> None:
    made = job(method=lambda A, wanted, **more: plain_descent(A, wanted, **more))
    assert np.array_equal(solve_job(made).cube.extinction, solve_job(job()).cube.extinction)
    with pytest.raises(InputError, match="an unfinished cube cannot go on"):
        open_partial(tmp_path / "a.zarr", made)
    assert not list(tmp_path.iterdir())


def test_a_name_that_is_gone_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "gone_tomorrow.py").write_text("from tests.helpers.solver_problems import plain_descent as today")
    monkeypatch.syspath_prepend(tmp_path)
    made = job(method="gone_tomorrow:today")
    solve_job(made, open_partial(tmp_path / "a.zarr", made), lambda step: step.iteration == 2)
    (tmp_path / "gone_tomorrow.py").write_text("")
    monkeypatch.delitem(sys.modules, "gone_tomorrow")
    with pytest.raises(InputError, match="method gone_tomorrow:today cannot be imported"):
        load(tmp_path / "a.zarr.partial")


def test_what_it_cannot_do_is_refused_unless_it_says_that_it_can() -> None:
    with pytest.raises(InputError, match=f"method {PLACE} cannot choose lamp powers"):
        job(powers="shared")
    with pytest.raises(InputError, match=f"method {PLACE} cannot choose the power of lamp"):
        job(lamp_max=4.0)
    assert not job(method=Method(plain_descent, chooses_lamps=True)).targets.rig.lamps.are_fixed
    assert job(method=Method(plain_descent, coarse_to_fine=False)).levels == 0
