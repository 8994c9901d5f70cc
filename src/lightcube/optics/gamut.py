"""What dyes can make: the nearest amounts of an extinction, and what is out of their reach."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lightcube.optics.arrays import Flags, Reals, Volume
from lightcube.optics.dyes import Dyes

#: Voxels that are looked at together, how often at most, and the change of an amount that is none.
_MANY, _SWEEPS, _STILL = 1 << 14, 1000, 1e-6
#: A voxel is clear below this part of the darkest one's extinction; a mixture is off beyond this part of what the voxel
#: absorbs; and a colour counts as absorbed above this part of the one that it absorbs most.
_CLEAR, _OFF, _SEEN = 0.01, 0.05, 0.3
_COLOURS = ("red", "green", "blue")


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


@dataclass(frozen=True)
class OutOfReach:
    """What of an extinction dyes cannot make.

    Parameters
    ----------
    voxels
        Part of the voxels that are not clear whose nearest mixture is off by more than a twentieth of what they absorb.
    extinction
        What mixtures are off by, as a part of all extinction.
    worst
        Which colours those voxels absorb that are off by most together, ``"green alone"``; nothing where all are made.
    """

    voxels: float
    extinction: float
    worst: str


def out_of_reach(extinction: Volume, dyes: Dyes) -> OutOfReach:
    """How much of an extinction ``(channel, z, y, x)``, in 1/mm, dyes cannot make, by the `nearest` amounts."""
    off = np.abs(dyes.mixed(nearest(extinction, dyes)) - extinction).reshape(len(extinction), -1)
    wanted = extinction.reshape(len(extinction), -1)
    darkest = wanted.max(axis=0)
    matter = darkest > _CLEAR * float(darkest.max())
    missed = matter & (off.max(axis=0) > _OFF * darkest)
    if not missed.any():
        return OutOfReach(0.0, _part(off, wanted), "")
    absorbed = wanted[:, missed] > _SEEN * darkest[missed]
    kinds, which = np.unique(absorbed, axis=1, return_inverse=True)
    worst = kinds[:, np.argmax(np.bincount(which.ravel(), off[:, missed].sum(axis=0)))]
    return OutOfReach(float(missed.sum() / matter.sum()), _part(off, wanted), absorbed_by(worst))


def _part(some: Volume, of: Volume) -> float:
    whole = float(np.sum(of, dtype=np.float64))
    return float(np.sum(some, dtype=np.float64)) / whole if whole else 0.0


def colours(channels: int) -> tuple[str, ...]:
    """What colours of light are called."""
    return _COLOURS if channels == len(_COLOURS) else tuple(f"colour {number + 1}" for number in range(channels))


def absorbed_by(absorbed: Flags) -> str:
    """What is said of a place by the colours that it absorbs: ``"green alone"``, ``"red and blue"``."""
    names = [name for name, is_so in zip(colours(len(absorbed)), absorbed, strict=True) if is_so]
    if len(names) == 1:
        return f"{names[0]} alone"
    return f"{', '.join(names[:-1])} and {names[-1]}"


def alone(dyes: Dyes) -> list[tuple[str, str, float, str]]:
    """Of each colour the dye that absorbs it most purely, and what it takes with it.

    ``(colour, dye, part, other)``: of the other colour that suffers most it absorbs so large a part of what it absorbs
    of the colour itself. No mixture is purer, since every dye of it takes as much or more.
    """
    names, found = colours(dyes.channels), []
    for channel, name in enumerate(names):
        own = dyes.extinction[:, channel : channel + 1]
        parts = np.divide(dyes.extinction, own, out=np.full_like(dyes.extinction, np.inf), where=own > 0)
        parts[:, channel] = 0
        dye = int(np.argmin(parts.sum(axis=1)))
        other = int(np.argmax(parts[dye]))
        found.append((name, dyes.names[dye], float(parts[dye, other]), names[other]))
    return found
