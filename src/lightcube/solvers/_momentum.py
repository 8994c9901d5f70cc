"""Nesterov's momentum, kept for each column by itself."""

import numpy as np
from numpy.typing import NDArray


def run_ahead(
    momentum: NDArray[np.float64], restart: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """How far the next step may start ahead of the last point, as a part of the last change, and the next `momentum`.

    `momentum` starts at 1 and is ``(columns,)``, as is all else; a column that shall `restart` gets 0 and 1.
    ``(t - 1) / t'`` with ``t' = (1 + sqrt(1 + 4 t^2)) / 2``: Y. Nesterov, Soviet Math. Dokl. 27 (1983).
    """
    following = (1 + np.sqrt(1 + 4 * momentum**2)) / 2
    return np.where(restart, 0.0, (momentum - 1) / following), np.where(restart, 1.0, following)
