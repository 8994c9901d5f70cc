"""What bends light on its way to the voxels: the clear body that they are part of, or the bath that they stand in."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.grid import Grid
from lightcube.optics.views import swept_mm

#: The body: the block of voxels itself, a cylinder or sphere cut of it, or a bath in which the block turns: with flat
#: sides that stand square to the light, or round.
Form = Literal["block", "cylinder", "sphere", "bath", "round-bath"]
#: Whether light may leave through the bottom of a block, or that stands on something.
Bottom = Literal["open", "blocked"]
#: Indices of refraction of things that light goes through.
_MOST_IOR = 4.0
#: From here on light that enters a face of a block never leaves through a neighbouring one.
LEAST_IOR = math.sqrt(2.0)
#: How wide a bath is in the circle that the turning block sweeps, where nothing is said.
_ROOMY = 1.1
#: How far behind the axis the screen stands, in half the body's width: pictures behind a round one of glass are as
#: wide as it, and no light that a block throws back inside falls on pictures 10 degrees off its faces' normals.
FAR_ROUND, FAR_BLOCK = 3.0, 6.0
_LARGEST_MM = 1e6


@dataclass(frozen=True)
class Glass:
    """A clear body with an index of refraction.

    Parameters
    ----------
    ior
        Index of refraction against the air, 1 to 4, a block's at least 1.4143; one number, or three for red, green and
        blue.
    form
        ``"block"``, of voxels; ``"cylinder"``, standing upright, or ``"sphere"``: the largest in the block of voxels,
        of which the corners then are not there; ``"bath"``, with flat sides square to the light, or ``"round-bath"``,
        in which a block of the same index turns.
    bottom
        Of a block: ``"open"``, or ``"blocked"`` where it stands on something that no light comes through. Cylinders
        stand on something.
    bath_mm
        From side to side of a bath, at least the diagonal of what turns in it; None = a tenth more than that.
    size_mm
        Sides ``(x, y, z)`` of what the light enters, mm: as `around` finds them; None = not known yet.

    Raises
    ------
    InputError
        Where a number is out of its range, or something is said that the form has not.

    Examples
    --------
    >>> import lightcube as lc
    >>> lc.Glass(1.5, "cylinder").around(lc.Grid((8, 10, 10), voxel_mm=2)).size_mm
    (20.0, 20.0, 16.0)
    """

    ior: float | tuple[float, ...] = 1.5
    form: Form = "block"
    bottom: Bottom = "open"
    bath_mm: float | None = None
    size_mm: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        given = tuple(float(ior) for ior in np.atleast_1d(self.ior))
        object.__setattr__(self, "ior", given[:1] if len(given) == 3 and len(set(given)) == 1 else given)
        if len(self.iors) not in (1, 3):
            raise InputError(f"ior is one index of refraction, or three for red, green and blue, not {len(self.iors)}")
        for ior in self.iors:
            if not 1 <= ior <= _MOST_IOR:
                raise InputError(f"an index of refraction lies between 1 and {_MOST_IOR:g}, not {ior:g}: glass has 1.5")
            if self.form == "block" and 1 < ior < LEAST_IOR:
                raise InputError(
                    f"an index of {ior:g} is too low for a block in air: below 1.4143 neighbouring faces let light "
                    "through: use a bath, or at least 1.415"
                )
        if self.form == "bath" and len(self.iors) > 1:
            raise InputError("a bath has one index of refraction, that of the block in it: give one number")
        if self.bottom == "blocked" and self.form != "block":
            raise InputError(
                f"whether light leaves through the bottom is asked of a block, not of a {self.form}: leave it out"
            )
        if self.bath_mm is not None and not (self.is_bath and 0 < self.bath_mm <= _LARGEST_MM):
            raise InputError(
                f"bath_mm is the width of a bath, above 0 and up to {_LARGEST_MM:g} mm, not {self.bath_mm:g} of a "
                f"{self.form}"
            )

    @property
    def iors(self) -> tuple[float, ...]:
        """Indices of refraction: one, or one of each colour."""
        return self.ior if isinstance(self.ior, tuple) else (self.ior,)

    @property
    def is_bath(self) -> bool:
        """Whether it is what the block stands in."""
        return self.form in ("bath", "round-bath")

    @property
    def is_round(self) -> bool:
        """Whether it is a lens: a cylinder, a sphere or a round bath."""
        return self.form in ("cylinder", "sphere", "round-bath")

    @property
    def bends(self) -> bool:
        """Whether any light is bent at all."""
        return any(ior != 1 for ior in self.iors)

    @property
    def radius_mm(self) -> float:
        """Half its width, mm."""
        if self.size_mm is None:
            raise InputError("how large this glass is, is not known: put it around a grid, glass.around(grid)")
        return self.size_mm[0] / 2

    @property
    def far_mm(self) -> float:
        """How far behind the axis a screen stands where nothing is said, mm."""
        return self.radius_mm * (FAR_ROUND if self.is_round else FAR_BLOCK)

    @checked
    def around(self, grid: Grid) -> Glass:
        """The same for the voxels of a grid: with its size."""
        wide, deep, high = (float(side) * count for side, count in zip(grid.sides_mm, grid.shape[::-1], strict=True))
        across = min(wide, deep)
        if self.form == "block":
            return replace(self, size_mm=(wide, deep, high))
        if self.form == "cylinder":
            return replace(self, size_mm=(across, across, high))
        if self.form == "sphere":
            return replace(self, size_mm=(min(across, high),) * 3)
        swept = 2 * swept_mm(grid)
        bath_mm = self.bath_mm or _ROOMY * swept
        if bath_mm < swept:
            raise InputError(
                f"a bath of {bath_mm:g} mm is too narrow for a block that sweeps a circle of {swept:.4g} mm as it "
                "turns: make bath_mm at least that"
            )
        return replace(self, size_mm=(bath_mm, bath_mm, math.inf))

    def inside_deg(self, elevation_deg: float) -> float:
        """Elevation inside, degrees, of light that enters an upright side with this elevation outside."""
        return math.degrees(math.asin(math.sin(math.radians(elevation_deg)) / self.iors[0]))

    def rise_mm(self, lights: Reals) -> Reals:
        """``(views,)``: how much higher than straight light that through the middle leaves, mm, of unit directions.

        Of blocks and spheres not: they are seen about the straight line through their middles.
        """
        if self.form in ("block", "sphere"):
            return np.zeros(len(lights))
        down, level = -lights[:, 2], np.hypot(lights[:, 0], lights[:, 1])
        return np.asarray(self.radius_mm * (down / level - down / np.sqrt(self.iors[0] ** 2 - down**2)))

    def focus_mm(self, lights: Reals) -> Reals:
        """``(views,)``: how far behind its axis a round body brings each light together; nearer no screen may stand."""
        index = np.full(len(lights), max(self.iors))
        if self.form != "sphere":
            index = np.sqrt(index**2 - lights[:, 2] ** 2) / np.hypot(lights[:, 0], lights[:, 1])
        with np.errstate(divide="ignore"):
            return np.asarray(self.radius_mm * index / (2 * (index - 1)))
