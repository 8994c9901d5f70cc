"""What the methods that work on logarithms share: the right-hand side ``b = ln P - ln B`` of ``A x = b``."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.absorption import absorbance
from lightcube.optics.transfer import Transfer, encode
from lightcube.solvers.contract import Floats


def lamp_per_entry(lamp_powers: Floats, view_of_row: NDArray[np.integer[Any]] | None, shape: tuple[int, int]) -> Floats:
    """Lamp power of each entry of `B`, ``(equations, columns)``, from powers ``(views, channels)``."""
    equations, columns = shape
    rows = np.zeros(equations, np.intp) if view_of_row is None else view_of_row
    return lamp_powers[rows][:, np.arange(columns) % lamp_powers.shape[1]]


def absorbance_wanted(
    B: Floats,
    lamp_powers: Floats,
    view_of_row: NDArray[np.integer[Any]] | None,
) -> Floats:
    """``ln P - ln B``, ``(equations, columns)`` in B's dtype; negative where more light is wanted than the lamp has."""
    return absorbance(B / lamp_per_entry(lamp_powers, view_of_row, (B.shape[0], B.shape[1])).astype(B.dtype))


def half_level(B: Floats, transfer: Transfer = "srgb") -> Floats:
    """Half a display level as absorbance: ``0.5 / 255 / |dg/du|`` with ``g`` the display value of ``u = ln B``.

    On the sRGB curve's power part ``dg/du = (g + 0.055) / 2.4``. Pixels on its straight toe, where nobody tells
    levels apart, are given the tolerance at the toe's end (0.049), so that it does not grow without limit. With
    ``"linear"`` it is ``dg/du = B``, floored at the light whose tolerance is the same.
    """
    if transfer == "linear":
        return (0.5 / 255 / np.maximum(B, 0.04)).astype(B.dtype)
    return 0.5 / 255 * 2.4 / (encode(np.maximum(B, 0.0031308).astype(B.dtype)) + 0.055)
