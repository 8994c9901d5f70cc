"""How much is done is told in parts of the work; where errors fall as usual, it is right where that ends early too."""

import math
from typing import Any

import numpy as np
import pytest

from lightcube.backward.job import FEW_PASSES, Job, phase_work, shares
from lightcube.backward.reckoning import FIRST_LOOK, Reckoning, is_look, is_look_ahead
from lightcube.backward.solving import make_job
from lightcube.optics.grid import Grid
from lightcube.optics.light import Light
from lightcube.optics.setups import turntable
from lightcube.pictures.targets import Targets
from tests.helpers.recipes import asked

WANTED = 1e-4


def job(**options: Any) -> Job:
    grid = Grid((50, 50, 50))
    rig = turntable(grid, [10.0, 130.0], elevation_deg=20, picture_shape=(4, 6))
    targets = Targets(np.full((2, 4, 6, 3), 0.5, np.float32), rig)
    return make_job(**asked(targets, grid, **{"passes": 120, "light": Light(13, 7), **options}))


def told(made: Job, errors: Any, wanted: float = WANTED, ahead: float = 0.0) -> tuple[list[float], list[float]]:
    """Work done at each pass of the last piece, and which part of all that is said to be; ends as `solve` does."""
    name = made.unit_names[-1]
    reckoning, work, said = Reckoning(made, name, wanted), [], []
    before = sum(list(shares(made).values())[:-1])
    for number, phase in enumerate(made.phases(name)):
        reckoning.begin(number)
        assert phase.passes is not None
        for iteration in range(1, phase.passes + 1):
            last = number + 1 == len(made.phases(name))
            if not last and is_look_ahead(iteration, phase.passes):
                reckoning.looked_ahead(ahead)
            error = errors(iteration) if last and is_look(iteration) else math.inf
            if error < math.inf:
                reckoning.looked(iteration, error)
            work.append(before + phase_work(made, phase, iteration))
            said.append(reckoning.done(iteration, phase.passes))
            if error <= wanted:
                return work, said
        before += phase_work(made, phase)
    return work, said


def test_without_an_end_before_it_is_the_part_of_the_work() -> None:
    made = job()
    work, said = told(made, lambda iteration: 1.0, wanted=0.0)
    total = sum(shares(made).values())
    np.testing.assert_allclose(said, np.array(work) / total)
    assert said[-1] == 1.0
    assert len(said) == 120
    assert len(made.phases("unit-0")) == 2


@pytest.mark.parametrize("end", [FIRST_LOOK, 14, 28, 60, 79])
@pytest.mark.parametrize("power", [0.52, 0.6, 0.7])
def test_the_time_left_is_right_within_a_half_from_a_fifth_on(end: int, power: float) -> None:
    """Where errors fall with powers that were seen, to what is wanted after so many passes of the last phase."""

    def errors(iteration: int) -> float:
        return WANTED * (end / iteration) ** power

    made = job()
    work, said = told(made, errors, ahead=errors(FIRST_LOOK) / 0.23)
    assert len(said) - FEW_PASSES < 1.16 * end + 2  # it ends at the look after
    whole = work[-1]
    reckoned = np.array(work) / np.array(said)
    late = np.array(work) > max(0.2 * whole, work[FEW_PASSES // 2])
    assert np.all(reckoned[late] < 1.5 * whole)
    assert np.all(reckoned[late] > whole / 1.5)


def test_it_never_becomes_less_whatever_is_seen() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        _, said = told(job(), lambda iteration: float(rng.uniform(1.01, 9) * WANTED), ahead=float(rng.uniform(0, 1e-2)))
        assert np.all(np.diff(said) >= 0)
        assert 0 < said[0] <= said[-1] <= 1
        assert len(said) == 120


def test_looks_become_rarer() -> None:
    looks = [iteration for iteration in range(1, 200) if is_look(iteration)]
    assert looks[:4] == [8, 10, 12, 14]
    assert np.all(np.diff(looks, 2) >= 0)
    assert len(looks) < 30
