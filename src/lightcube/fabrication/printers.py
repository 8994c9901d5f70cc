"""Printers that build of droplets: what their slices are like."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

#: How a PolyJet printer works.
Mode = Literal["high-mix", "high-quality", "high-speed"]


@dataclass(frozen=True)
class Printing:
    """What a mode of a printer takes.

    Parameters
    ----------
    dpi
        Droplets an inch along x and y.
    layer_mm
        How high a slice is.
    most
        Materials at a time, the clear one among them.
    least
        Slices that a job has at least.
    """

    dpi: tuple[int, int]
    layer_mm: float
    most: int
    least: int = 30

    @property
    def sides_mm(self) -> tuple[float, float, float]:
        """Sides of a droplet along x, y and z."""
        return 25.4 / self.dpi[0], 25.4 / self.dpi[1], self.layer_mm


#: By mode; slices of a voxel print are 600 x 300 droplets an inch.
MODES: Mapping[Mode, Printing] = {
    "high-mix": Printing((600, 300), 0.027, 6),
    "high-quality": Printing((600, 300), 0.014, 6),
    "high-speed": Printing((600, 300), 0.027, 3),
}
