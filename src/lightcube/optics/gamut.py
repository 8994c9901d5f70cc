"""What dyes can make: the nearest amounts of an extinction, and what is out of their reach."""

from __future__ import annotations

import numpy as np

from lightcube.optics.arrays import Reals, Volume
from lightcube.optics.dyes import Dyes

#: Voxels that are looked at together, how often at most, and the change of an amount that is none.
_MANY, _SWEEPS, _STILL = 1 << 14, 1000, 1e-6


def nearest(extinction: Volume, dyes: Dyes) -> Volume:
    """Amounts ``(dye, ...)`` within the limits whose extinction is nearest to one ``(channel, ...)``, in 1/mm.

    Least squares, dye after dye as far as its limits let it, until none moves any more.
    """
    wanted = extinction.reshape(len(extinction), -1)
    amounts = np.empty((len(dyes.names), wanted.shape[1]), np.float32)
    for first in range(0, wanted.shape[1], _MANY):
        part = slice(first, first + _MANY)
        amounts[:, part] = _nearest(wanted[:, part] - dyes.base[:, None], dyes)
    return amounts.reshape(-1, *extinction.shape[1:])


def _nearest(left: Reals, dyes: Dyes) -> Reals:
    """The same of extinction beyond the clear material's, which is written over."""
    amounts = np.zeros((len(dyes.names), left.shape[1]))
    sizes = np.sum(dyes.extinction**2, axis=1)
    for _ in range(_SWEEPS):
        moved = 0.0
        for own, extinction, size, limit in zip(amounts, dyes.extinction, sizes, dyes.limit, strict=True):
            step = np.clip(own + extinction @ left / size, 0, limit) - own
            own += step
            left -= extinction[:, None] * step
            moved = max(moved, float(np.abs(step).max()))
        if moved < _STILL:
            break
    return amounts
