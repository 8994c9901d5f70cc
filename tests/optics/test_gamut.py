"""What dyes can make: against scipy's least squares within bounds, voxel by voxel."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from lightcube.io import read_dyes
from lightcube.optics.dyes import Dyes
from lightcube.optics.gamut import nearest

TWO = Dyes(("a", "b"), np.array([[3.0, 0.5, 0.1], [0.2, 2.0, 0.9]]), np.array([0.5, 1]), base=np.array([0.1, 0, 0.2]))


@pytest.mark.parametrize("dyes", [read_dyes("polyjet"), read_dyes("pla"), TWO])
def test_the_nearest_amounts_are_those_of_least_squares(dyes: Dyes) -> None:
    random = np.random.default_rng(0)
    extinction = random.gamma(0.3, 4.0, (3, 3, 4, 5)).astype(np.float32)
    found = nearest(extinction, dyes)
    assert found.shape == (len(dyes.names), 3, 4, 5)
    assert np.all((found >= 0) & (found <= dyes.limit[:, None, None, None]))
    off = np.linalg.norm(dyes.mixed(found) - extinction, axis=0)
    for place in np.ndindex(3, 4, 5):
        wanted = extinction[(slice(None), *place)] - dyes.base
        exact = lsq_linear(dyes.extinction.T, wanted, (np.zeros(len(dyes.names)), dyes.limit), tol=1e-12)
        assert off[place] == pytest.approx(np.sqrt(2 * exact.cost), abs=1e-4)


def test_what_is_mixed_is_found_again() -> None:
    dyes = read_dyes("pla")
    amounts = np.random.default_rng(1).random((3, 2, 3, 20_000 // 6)).astype(np.float32)  # more than one share
    np.testing.assert_allclose(nearest(dyes.mixed(amounts), dyes), amounts, atol=1e-4)
