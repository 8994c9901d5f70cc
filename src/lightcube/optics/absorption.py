"""Beer–Lambert absorption, in the field's words and in the paper's.

A beam that runs ``l`` mm through material of extinction ``sigma`` (1/mm) keeps the fraction
``T = exp(-sigma * l)`` of its light. The absorbance ``-ln T`` adds up along the beam: ``b = A x``.
The paper (Rankin & Boyapati, eq. 1-3) writes a voxel of side ``s`` as its transparency
``k = exp(-alpha)`` with ``alpha = sigma * L`` and ``L = sqrt(2) * s``, the voxel's diagonal.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError


def absorbance(transmittance: NDArray[np.floating]) -> NDArray[np.floating]:
    """``-ln T``, elementwise; `InputError` where `transmittance` is not positive and finite."""
    if not np.all(np.isfinite(transmittance)) or np.any(transmittance <= 0):
        raise InputError("a transmittance must be positive and finite: raise black pixels to the screen's black first")
    return -np.log(transmittance)


def transmittance(absorbance: NDArray[np.floating]) -> NDArray[np.floating]:
    """``exp(-b)``, elementwise."""
    return np.exp(-absorbance)


def transparency(extinction: NDArray[np.floating], voxel_mm: float) -> NDArray[np.floating]:
    """Return the paper's ``k = exp(-sigma * sqrt(2) * s)`` of voxels of side `voxel_mm` (paper, eq. 1-3)."""
    return np.exp(-extinction * (math.sqrt(2) * voxel_mm))


def extinction(transparency: NDArray[np.floating], voxel_mm: float) -> NDArray[np.floating]:
    """Extinction (1/mm) of voxels of the paper's transparency ``k`` in (0, 1]: the inverse of `transparency`."""
    return absorbance(transparency) / (math.sqrt(2) * voxel_mm)
