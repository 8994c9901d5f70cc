"""Light of several views that adds up on the screen."""

from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from lightcube.kernels import mixing
from lightcube.solvers.contract import Floats, Mixture


def mixed_light(mixture: Mixture, powers: NDArray[np.floating[Any]], absorbance: Floats) -> Floats:
    """What the screen shows at the absorbance of all views, under lamps of powers ``(lamps, channels)``.

    Returns
    -------
    ``(pictures, entries)``, linear light, the entries of a picture in the order of a view's in `absorbance`.
    """
    absorbed = absorbance.reshape(len(mixture.lamp), -1)
    logs = np.empty((len(mixture.starts) - 1, absorbed.shape[1]), absorbance.dtype)
    mixing.shine(for_kernels(mixture, powers, absorbance.dtype), absorbed, absorbance.shape[1], logs)
    return np.exp(logs, out=logs)


def for_kernels(mixture: Mixture, powers: NDArray[np.floating[Any]], dtype: DTypeLike) -> mixing.Mixture:
    """What the kernels want to know of the views and the power of their lamps."""
    strength = (powers[mixture.lamp] * mixture.share).astype(dtype)
    light, shadow = (each.astype(dtype, copy=False) for each in (mixture.light, mixture.shadow))
    return mixing.Mixture(mixture.starts, strength, light, shadow)
