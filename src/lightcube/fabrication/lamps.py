"""Lamps for what is made: those that suit it best, and the one constant white lamp that would have to do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from lightcube.forward.casting import cast
from lightcube.optics.arrays import Floats, Images
from lightcube.optics.cube import Cube
from lightcube.optics.transfer import encode
from lightcube.pictures.targets import Targets
from lightcube.scoring.metrics import mean_psnr

#: Powers are looked for among so many between the bounds, even in their logarithms, and then between the neighbours.
_TRIED, _FINER = 33, 24
#: A step of the golden section.
_GOLDEN = (5**0.5 - 1) / 2


def under_white(cube: Cube) -> Images:
    """What the wall shows of each picture where every lamp has power 1, ``(picture, row, column, channel)``."""
    return np.stack(list(cast(cube, lamp_powers=np.ones_like(cube.powers))))


def white(cube: Cube, targets: Targets) -> tuple[float, float]:
    """The power of one constant white lamp under which a cube's pictures come nearest, and their mean PSNR, dB."""
    light = under_white(cube)
    least, most = float(cube.rig.lamps.least.min()), float(cube.rig.lamps.most.max())

    def worth(power: float) -> float:
        return mean_psnr(light * np.float32(power), targets)

    power = _best(worth, least, most)
    return power, worth(power)


def relit(cube: Cube, targets: Targets) -> Cube:
    """The same block under lamps that suit it best, within their bounds, one for each picture and colour.

    Pictures of several lamps keep theirs.
    """
    rig = cube.rig
    if len(rig.pairs) != len(rig):
        return cube
    light = under_white(cube)
    powers = cube.powers.copy()
    for picture, channel in np.ndindex(powers.shape):
        shown, wanted = light[picture, ..., channel], encode(targets.pictures[picture, ..., channel], targets.transfer)
        weight, lamp = targets.weight[picture], rig.pairs[picture, 1]
        worth = _nearness(shown, wanted, weight, targets)
        powers[picture, channel] = _best(worth, float(rig.lamps.least[lamp]), float(rig.lamps.most[lamp]))
    return replace(cube, lamp_powers=powers)


def _nearness(shown: Images, wanted: Floats, weight: Images, targets: Targets) -> Callable[[float], float]:
    """How near a picture's colour comes under a lamp of some power."""

    def worth(power: float) -> float:
        off = encode(shown * np.float32(power), targets.transfer) - wanted
        return -float(np.sum(weight * off**2, dtype=np.float64))

    return worth


def _best(worth: Callable[[float], float], least: float, most: float) -> float:
    """The power between bounds that is worth most."""
    if least == most:
        return least
    tried = np.linspace(np.log(least), np.log(most), _TRIED)
    top = int(np.argmax([worth(float(np.exp(each))) for each in tried]))
    low, high = float(tried[max(top - 1, 0)]), float(tried[min(top + 1, _TRIED - 1)])
    for _ in range(_FINER):
        left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        if worth(float(np.exp(left))) < worth(float(np.exp(right))):
            low = left
        else:
            high = right
    return float(np.exp((low + high) / 2))
