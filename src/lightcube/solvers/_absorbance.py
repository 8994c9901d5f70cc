"""How finely absorbance is told apart on a screen."""

import numpy as np

from lightcube.optics.transfer import Transfer, encode
from lightcube.solvers.contract import Floats


def half_level(light: Floats, transfer: Transfer = "srgb") -> Floats:
    """Half a display level as absorbance: ``0.5 / 255 / |dg/du|`` with ``g`` the display value of ``u = ln light``.

    On the sRGB curve's power part ``dg/du = (g + 0.055) / 2.4``. Pixels on its straight toe, where nobody tells
    levels apart, are given the tolerance at the toe's end (0.049), so that it does not grow without limit. With
    ``"linear"`` it is ``dg/du = light``, floored at the light whose tolerance is the same.
    """
    if transfer == "linear":
        return (0.5 / 255 / np.maximum(light, 0.04)).astype(light.dtype)
    return 0.5 / 255 * 2.4 / (encode(np.maximum(light, 0.0031308).astype(light.dtype)) + 0.055)
