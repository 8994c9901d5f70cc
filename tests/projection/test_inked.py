"""The matrix of amounts of dyes, over a block of voxels and over any other matrix."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import DTypeLike, NDArray
from scipy.sparse import csr_array

from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.projection.inked import Inked, Operator
from lightcube.projection.projector import Projector, dot_test

E = np.array([[3.0, 0.5, 0.1], [0.2, 2.0, 0.9], [0.1, 0.2, 4.0], [2.0, 2.0, 2.0]])
GRID = Grid((3, 5, 7), 0.5)


class Sheets:
    """Any other matrix: no block of voxels, no views."""

    def __init__(self) -> None:
        random = np.random.default_rng(0).random((2, 11, 6))
        self.matrix = csr_array(np.where(random[0] < 0.4, random[1], 0.0))
        self.shape = (11, 6)

    def forward(self, x: NDArray[Any]) -> NDArray[Any]:
        return np.asarray(self.matrix @ x, x.dtype)

    def adjoint(self, b: NDArray[Any]) -> NDArray[Any]:
        return np.asarray(self.matrix.T @ b, b.dtype)

    def to_sparse(self) -> csr_array:
        return self.matrix


MATRICES: dict[str, Operator] = {
    "level": Projector(GRID, turntable(GRID, [20.0, 70.0], picture_shape=(3, 5))),
    "raised": Projector(GRID, turntable(GRID, [20.0, 70.0], elevation_deg=35, picture_shape=(3, 5))),
    "sheets": Sheets(),
}


@pytest.mark.parametrize("name", MATRICES)
@pytest.mark.parametrize("colours", [1, 2, 3])
@pytest.mark.parametrize("dyes", [1, 3, 4])
def test_it_is_the_matrix_of_each_pair_of_a_dye_and_a_colour(name: str, dyes: int, colours: int) -> None:
    """Block by block: what a dye absorbs of a colour times the matrix; `to_sparse` says the same."""
    matrix, extinction = MATRICES[name], E[:dyes, :colours]
    inked, plain = Inked(matrix, extinction), matrix.to_sparse().toarray()
    whole = np.block([[extinction[dye, colour] * plain for dye in range(dyes)] for colour in range(colours)])
    random = np.random.default_rng(1)
    x, b = random.random((inked.shape[1], 2)), random.random((inked.shape[0], 2))
    assert inked.shape == whole.shape
    np.testing.assert_allclose(inked.forward(x), whole @ x, atol=1e-12)
    np.testing.assert_allclose(inked.adjoint(b), whole.T @ b, atol=1e-12)
    np.testing.assert_allclose(inked.to_sparse().toarray(), whole, atol=1e-12)


@pytest.mark.parametrize("name", MATRICES)
@pytest.mark.parametrize(("dtype", "most"), [("float32", 1e-6), ("float64", 1e-12)])
def test_its_transpose_is_exact(name: str, dtype: DTypeLike, most: float) -> None:
    inked = Inked(MATRICES[name], E)
    assert dot_test(inked, columns=2, dtype=dtype) < most
    assert inked.forward(np.ones((inked.shape[1], 1), dtype)).dtype == dtype
