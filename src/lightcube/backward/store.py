"""Where the work on a cube is kept, piece by piece."""

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Arrays = Mapping[str, NDArray[Any]]


class Store(Protocol):
    """Keeps what becomes of the pieces of one job: results of those that are finished, checkpoints of the others.

    Whatever is asked of it, a result or a checkpoint is there as a whole or not at all, and to finish a piece twice
    does no harm.
    """

    def names(self) -> frozenset[str]:
        """Names of the pieces that are finished."""

    def finished(self, name: str) -> Arrays | None:
        """Return the result of a piece, or None where it is not finished."""

    def finish(self, name: str, arrays: Arrays) -> None:
        """Keep the result of a piece, and forget its checkpoint."""

    def state(self, name: str) -> Arrays | None:
        """Return the newest checkpoint of a piece, or None where there is none."""

    def keep(self, name: str, arrays: Arrays) -> None:
        """Keep a checkpoint of a piece in place of the one before; the arrays change once this returns."""


class MemoryStore:
    """A store that lives as long as the program."""

    def __init__(self) -> None:
        self._results: dict[str, Arrays] = {}
        self._states: dict[str, Arrays] = {}

    def names(self) -> frozenset[str]:
        """Names of the pieces that are finished."""
        return frozenset(self._results)

    def finished(self, name: str) -> Arrays | None:
        """Return the result of a piece, or None where it is not finished."""
        return self._results.get(name)

    def finish(self, name: str, arrays: Arrays) -> None:
        """Keep the result of a piece, and forget its checkpoint."""
        self._results[name] = dict(arrays)
        self._states.pop(name, None)

    def state(self, name: str) -> Arrays | None:
        """Return the newest checkpoint of a piece, or None where there is none."""
        return self._states.get(name)

    def keep(self, name: str, arrays: Arrays) -> None:
        """Keep a copy of a checkpoint in place of the one before."""
        self._states[name] = {key: np.array(array) for key, array in arrays.items()}
