"""Time the projections, to be compared with an earlier run.

    python -m pytest benchmarks/test_kernels_speed.py --benchmark-autosave
    python -m pytest benchmarks/test_kernels_speed.py --benchmark-compare

Nothing is asserted about time: `lightcube bench` says what the figures are worth on a machine.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lightcube.bench.products import columns_of, projector
from lightcube.forward.casting import player
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.views import Views, spread_angles, turntable_views
from lightcube.projection.projector import Projector

N, VIEWS, ANY_VIEWS = 96, 96, 24


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
@pytest.mark.parametrize("direction", ["forward", "adjoint"])
def test_product(benchmark: Callable[..., Any], direction: str, elevation_deg: float) -> None:
    matrix = projector(N, VIEWS, elevation_deg)
    rows = matrix.shape[1] if direction == "forward" else matrix.shape[0]
    given = np.random.default_rng(0).random((rows, columns_of(matrix)), dtype=np.float32)
    result = benchmark(getattr(matrix, direction), given)
    assert np.all(np.isfinite(result))


@pytest.mark.parametrize("point", [False, True])
@pytest.mark.parametrize("direction", ["forward", "adjoint"])
def test_product_of_any_rays(benchmark: Callable[..., Any], direction: str, point: bool) -> None:
    """Screens behind the cube that lean, in parallel light or before lamps three cubes away."""
    grid = Grid((N, N, N))
    table = turntable_views(
        grid, spread_angles(ANY_VIEWS, elevation_deg=35.0), elevation_deg=35.0, picture_shape=(N, N)
    )
    light = table.lamps[:, :3]
    lamps = np.column_stack([-3 * N * light, np.ones(len(table))]) if point else table.lamps
    matrix = Projector(grid, Views(lamps, N * light, table.column_steps_mm, table.row_steps_mm - 0.3 * light, (N, N)))
    rows = matrix.shape[1] if direction == "forward" else matrix.shape[0]
    given = np.random.default_rng(0).random((rows, columns_of(matrix)), dtype=np.float32)
    result = benchmark(getattr(matrix, direction), given)
    assert np.all(np.isfinite(result))


@pytest.mark.parametrize("elevation_deg", [0.0, 35.0])
def test_playback(benchmark: Callable[..., Any], elevation_deg: float) -> None:
    grid = Grid((N, N, N))
    extinction = np.full((3, *grid.shape), 1 / N, np.float32)
    show = player(Cube(extinction, grid, turntable(grid, [10.0], elevation_deg=elevation_deg)))
    assert np.all(benchmark(show, [77.7]) > 0)
