"""The matrix of amounts of dyes: through any matrix of extinction to the absorbance of each colour.

Unknowns are ``(dye, unknown)``, equations ``(colour, equation)`` of that matrix, which may be of a block of voxels or
of anything else that is multiplied by columns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from lightcube.kernels.layout import empty
from lightcube.optics.arrays import Floats, Reals

if TYPE_CHECKING:
    from scipy.sparse import csr_array


class Operator(Protocol):
    """What multiplies blocks of columns, colours side by side as the innermost."""

    @property
    def shape(self) -> tuple[int, int]:
        """``(equations, unknowns)`` of one column."""

    def forward(self, x: Floats) -> Floats:
        """``A @ x``."""

    def adjoint(self, b: Floats) -> Floats:
        """``A.T @ b``."""

    def to_sparse(self) -> csr_array:
        """The same matrix, float64."""


class Inked:
    """``E (A f)``: amounts f of dyes to absorbance, for a matrix A and what each dye absorbs.

    Parameters
    ----------
    matrix
        A, whose columns are colours, of whatever there is several of (slices under a level lamp), colours innermost.
    extinction
        E, ``(dye, colour)``, at least 0, of an amount of 1.

    Attributes
    ----------
    shape
        ``(colours * equations, dyes * unknowns)``; a column for all colours of one column of A.
    """

    shape: tuple[int, int]

    def __init__(self, matrix: Operator, extinction: Reals) -> None:
        self._matrix, self._extinction = matrix, extinction
        dyes, colours = extinction.shape
        equations, unknowns = matrix.shape
        self.shape = colours * equations, dyes * unknowns

    def forward(self, x: Floats) -> Floats:
        """``E (A x)`` for `x` of shape ``(dyes * unknowns, columns)``."""
        dyes, colours = self._extinction.shape
        equations, unknowns = self._matrix.shape
        amounts = x.reshape(dyes, unknowns, -1)
        mixed = _mixed(amounts, self._extinction)
        absorbed = self._matrix.forward(mixed.reshape(unknowns, -1)).reshape(equations, -1, colours)
        return _laid(absorbed.transpose(2, 0, 1)).reshape(self.shape[0], -1)

    def adjoint(self, b: Floats) -> Floats:
        """The exact transpose of `forward`, of ``(colours * equations, columns)``."""
        colours = self._extinction.shape[1]
        equations, unknowns = self._matrix.shape
        lost = _laid(b.reshape(colours, equations, -1).transpose(1, 2, 0))
        back = self._matrix.adjoint(lost.reshape(equations, -1)).reshape(unknowns, -1, colours)
        # Of the transpose the dyes are what colours were: side by side, and then one after the other.
        return _laid(_mixed(back.transpose(2, 0, 1), self._extinction.T).transpose(2, 0, 1)).reshape(self.shape[1], -1)

    def to_sparse(self) -> csr_array:
        """The same matrix, float64."""
        from scipy.sparse import csr_array, kron  # here: it takes long to load

        return csr_array(kron(self._extinction.T, self._matrix.to_sparse(), "csr"))


def _mixed(parts: Floats, weights: Reals) -> Floats:
    """Sums of parts ``(part, ...)`` by weights ``(part, sum)``, side by side, ``(..., sum)``; always in one order."""
    factors = weights.astype(parts.dtype)
    sums = empty((*parts.shape[1:], weights.shape[1]), parts.dtype)
    for number, own in enumerate(factors.T):
        total = own[0] * parts[0]
        for part, factor in zip(parts[1:], own[1:], strict=True):
            total += factor * part
        sums[..., number] = total
    return sums


def _laid(array: Floats) -> Floats:
    """A contiguous copy."""
    copy = empty(array.shape, array.dtype)
    copy[...] = array
    return copy
