"""What may be said of how a cube is solved, and what contradicts itself."""

from collections.abc import Mapping
from typing import Literal, get_args

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.rig import LAMP_MIN
from lightcube.optics.transfer import BLACK
from lightcube.solvers import find_method
from lightcube.solvers.contract import Solver
from lightcube.solvers.method import Method

#: Each view and colour has its own power, each colour one, each its own as found at half the size, or all a given one.
Powers = Literal["per-view", "global", "coarse", "fixed"]

#: Largest power of a lamp that is not fixed, unless another one is given.
LAMP_MAX = 16.0
#: No lamp may be stronger.
LAMP_MOST = 1e6
#: At most so many passes of method display, and the PSNR of all pixels, dB, that is enough: for a look, for use, and
#: for the last tenth of a dB.
Quality = Literal["draft", "normal", "best"]
QUALITIES: Mapping[Quality, tuple[int, float]] = {"draft": (30, 36.0), "normal": (200, 42.0), "best": (1000, np.inf)}


def _check_lamp(method: Method, lamp: Powers | None, lamp_power: float | None, lamp_max: float | None) -> Powers:
    """Return the kind of lamp that is meant, or raise `InputError` where its options contradict each other."""
    if lamp is None:
        lamp = "per-view" if method.chooses_lamps and lamp_power is None else "fixed"
    if lamp not in get_args(Powers):
        raise InputError(f"unknown lamp {lamp!r}: use one of {', '.join(get_args(Powers))}")
    if not method.chooses_lamps and (lamp != "fixed" or lamp_max is not None):
        raise InputError(f"method {method.name} cannot choose lamp powers: give one lamp power, or use method display")
    if lamp == "fixed" and lamp_max is not None:
        raise InputError("a fixed lamp has no largest power: leave that out, or use a lamp per-view or global")
    if lamp != "fixed" and lamp_power is not None:
        raise InputError(f"a lamp that is {lamp} has no given power: leave that out, or use a fixed lamp")
    if lamp_power is not None and not LAMP_MIN <= lamp_power <= LAMP_MOST:
        raise InputError(f"a lamp power must lie between {LAMP_MIN:g} and 1e6, not {lamp_power:g}")
    if lamp_max is not None and not 1 <= lamp_max <= LAMP_MOST:
        raise InputError(f"the largest lamp power must lie between 1 and 1e6, not {lamp_max:g}")
    return lamp


def check_options(
    method: str | Solver | Method,
    lamp: Powers | None = None,
    lamp_power: float | None = None,
    lamp_max: float | None = None,
    max_extinction: float = np.inf,
    iterations: int | None = None,
    black: float = BLACK,
) -> Powers:
    """Return the kind of lamp that is meant, or raise `InputError` where `solve` would refuse its options."""
    if not max_extinction > 0:
        raise InputError(f"the largest extinction must be a positive number (1/mm), not {max_extinction}")
    if not BLACK <= black < 1:
        raise InputError(f"black must be a display value from {BLACK:.4f}, half a level, to below 1, not {black:g}")
    if iterations is not None and iterations < 1:
        raise InputError(f"a solver needs at least 1 iteration, not {iterations}")
    return _check_lamp(find_method(method), lamp, lamp_power, lamp_max)
