"""The matrix of bent light: what goes together is what goes one by one."""

import numpy as np
import pytest

from lightcube.kernels import tasks
from lightcube.optics.glass import Form, Glass
from lightcube.optics.grid import Grid
from lightcube.optics.refraction import bent
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.projection.bent import BentBeams
from lightcube.projection.projector import dot_test
from lightcube.projection.rays import Rays

#: A block, how many voxels wide its pixels are, and how high the lamp stands.
CASES = [
    pytest.param(Grid((3, 5, 7), 2.0), 1, 20.0, id="raised"),
    pytest.param(Grid((4, 5, 5), 1.5), 1, 0.0, id="level"),
    pytest.param(Grid((6, 8, 6), 1.5), 2, 35.0, id="pixels of 2 voxels"),
    pytest.param(Grid((8, 7, 5), 2.0, tall=0.5), 1, -25.0, id="from below, flat slices"),
    pytest.param(Grid((5, 40, 36), 1.0), 1, 4.0, id="several tiles and bricks"),
]
FORMS: list[Form] = ["block", "cylinder", "sphere", "bath", "round-bath"]


def room(grid: Grid, pixel: int, elevation_deg: float, form: Form) -> Rig:
    return turntable(grid, [0.0, 33.0, 90.0, 211.0], elevation_deg=elevation_deg, pixel=pixel, glass=Glass(1.5, form))


def heard(rig: Rig) -> np.ndarray:
    """Some pixels, in no order."""
    return np.random.default_rng(5).random((len(rig.views), *rig.picture_shape)) < 0.7


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(("grid", "pixel", "elevation_deg"), CASES)
def test_both_products_are_those_of_single_rays(grid: Grid, pixel: int, elevation_deg: float, form: Form) -> None:
    rig = room(grid, pixel, elevation_deg, form)
    for some in (None, heard(rig)):
        matrix, single = BentBeams(grid, rig.views, some, bent(rig)), Rays(grid, rig.views, some, bent(rig))
        assert matrix.shape == single.shape
        random = np.random.default_rng(1)
        x, b = random.random((matrix.shape[1], 3)), random.random((matrix.shape[0], 3))
        np.testing.assert_allclose(matrix.forward(x), single.forward(x), atol=1e-9)
        np.testing.assert_allclose(matrix.adjoint(b), single.adjoint(b), atol=1e-9)


@pytest.mark.parametrize(("dtype", "bound"), [(np.float32, 1e-5), (np.float64, 1e-12)])
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(("grid", "pixel", "elevation_deg"), CASES)
def test_the_adjoint_is_the_transpose(
    grid: Grid, pixel: int, elevation_deg: float, form: Form, dtype: type[np.floating], bound: float
) -> None:
    rig = room(grid, pixel, elevation_deg, form)
    assert dot_test(BentBeams(grid, rig.views, heard(rig), bent(rig)), 3, dtype) < bound


@pytest.mark.parametrize("form", FORMS)
def test_rows_and_the_sparse_matrix_are_the_same(form: Form) -> None:
    grid = Grid((3, 5, 7), 2.0)
    rig = room(grid, 1, 20.0, form)
    matrix = BentBeams(grid, rig.views, heard(rig), bent(rig))
    x = np.random.default_rng(1).random((matrix.shape[1], 2))
    sparse = matrix.to_sparse()
    np.testing.assert_allclose(sparse @ x, matrix.forward(x), atol=1e-9)
    for index in range(0, matrix.shape[0], 7):
        unknowns, lengths = matrix.row(index)
        own = np.zeros(matrix.shape[1])
        np.add.at(own, unknowns, lengths)
        np.testing.assert_allclose(own, sparse[[index]].toarray()[0], atol=1e-12)


def test_upright_sides_go_together_and_only_a_raised_block_and_spheres_have_single_rays() -> None:
    grid = Grid((8, 10, 10), 2.0)
    alone = {
        form: BentBeams(grid, rig.views, None, bent(rig))._rays is not None
        for form in FORMS
        for rig in [turntable(grid, [33.0], elevation_deg=20.0, picture_shape=(4, 6), glass=Glass(1.5, form))]
    }
    assert alone == {"block": True, "cylinder": False, "sphere": True, "bath": False, "round-bath": False}


def test_threads_change_no_bit() -> None:
    grid = Grid((5, 40, 36), 1.0)
    rig = room(grid, 1, 20.0, "block")
    matrix, before = BentBeams(grid, rig.views, None, bent(rig)), tasks.threads()
    x = np.random.default_rng(1).random((matrix.shape[1], 3), np.float32)
    found = []
    try:
        for threads in (1, 3):
            tasks.set_threads(threads)
            b = matrix.forward(x)
            found.append((b, matrix.adjoint(b)))
    finally:
        tasks.set_threads(before)
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one, other)
