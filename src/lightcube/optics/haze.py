"""What haze does to light, estimated: how much of it goes straight on, and what the rest lays over pictures.

A clear resin throws light aside. What is thrown aside is lost to its beam, exactly as if it were absorbed; part of it
reaches the screen elsewhere, as a veil that is taken as even. How large a veil is was found by Monte Carlo (volpath of
Mitsuba 3, twice scattered light and all) for cubes of photographs of 40 mm with a screen three of their widths behind,
in matched surroundings, and is interpolated here by the optical thickness along a side. It is an estimate: other
pictures, distances and sizes have other veils.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

import numpy as np

#: Light is thrown to all sides alike, or mostly ahead (Henyey and Greenstein's g of 0.9), as by grains larger than its
#: waves.
Phase = Literal["isotropic", "forward"]

#: Part of all light on the screen that is veil, by phase and scattering (1/mm) of a cube of `MEASURED_MM`.
VEILS: Mapping[tuple[Phase, float], float] = {
    ("isotropic", 0.002): 0.002,
    ("isotropic", 0.01): 0.010,
    ("isotropic", 0.02): 0.027,
    ("isotropic", 0.05): 0.17,
    ("forward", 0.01): 0.31,
    ("forward", 0.05): 0.86,
    ("forward", 0.1): 0.985,
}
MEASURED_MM = 40.0
#: From this g on scattering counts as forward.
FORWARD = 0.5


def phase_of(g: float) -> Phase:
    """Which of the two a mean cosine of scattering is nearer to."""
    return "forward" if g >= FORWARD else "isotropic"


def veil_part(thickness: float, phase: Phase) -> float:
    """Part of all light on the screen that is veil, by the optical thickness along the cube's side.

    Between the measured ones the odds, veil to picture, follow a power of the thickness; below the thinnest they are in
    proportion to it.
    """
    at = [(scattering * MEASURED_MM, part / (1 - part)) for (kind, scattering), part in VEILS.items() if kind == phase]
    thick, odds = (np.array(each) for each in zip(*at, strict=True))
    if thickness <= thick[0]:
        ratio = odds[0] * thickness / thick[0]
    else:
        ratio = math.exp(float(np.interp(math.log(thickness), np.log(thick), np.log(odds))))
    return float(ratio / (1 + ratio))
