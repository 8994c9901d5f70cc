"""The matrix as scipy's iterative solvers want it. Importing this imports ``scipy.sparse.linalg``, which takes long."""

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator

from lightcube.errors import InputError

Floats = NDArray[np.floating[Any]]

if TYPE_CHECKING:
    _Operator = LinearOperator[np.floating[Any]]
else:
    _Operator = LinearOperator  # which takes no types before scipy 1.17


class Matrix(Protocol):
    """What multiplies blocks of columns."""

    shape: tuple[int, int]

    def forward(self, x: Floats) -> Floats:
        """``A @ x``."""

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b``."""


class MatrixOperator(_Operator):
    """A matrix with `forward` and `adjoint` as scipy's ``LinearOperator`` of one `dtype`; it pickles with its matrix.

    Vectors and blocks of other real numbers are converted to `dtype`.

    Raises
    ------
    InputError
        Where a product is asked for with complex numbers.
    """

    def __init__(self, matrix: Matrix, dtype: np.dtype[np.floating[Any]]) -> None:
        super().__init__(dtype, matrix.shape)  # type: ignore[call-arg] # the stubs know the functions' way only
        self._matrix = matrix

    def _matmat(self, X: NDArray[Any]) -> Floats:  # noqa: N803 - scipy's name
        return self._matrix.forward(self._real(X))

    def _rmatmat(self, X: NDArray[Any]) -> Floats:  # noqa: N803 - scipy's name
        return self._matrix.adjoint(self._real(X))

    def _matvec(self, x: NDArray[Any]) -> Floats:
        return self._matmat(x.reshape(-1, 1))

    def _rmatvec(self, x: NDArray[Any]) -> Floats:
        return self._rmatmat(x.reshape(-1, 1))

    def _real(self, array: NDArray[Any]) -> Floats:
        if np.iscomplexobj(array):
            raise InputError("this matrix multiplies no complex numbers: multiply real and imaginary parts one by one")
        return np.asarray(array, self.dtype)
