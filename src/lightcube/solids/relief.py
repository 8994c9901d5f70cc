"""A relief: square columns whose shadows are one picture for each of up to four low lamps (ShadowPix)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals, copied, keep, locked
from lightcube.optics.checks import check_fields
from lightcube.optics.transfer import encode
from lightcube.wording import counted

Method = Literal["global", "local"]

#: Where lamps stand: to the right, to the left, behind, in front; degrees from the right, against the clock from above.
LAMPS_DEG = (0.0, 180.0, 90.0, 270.0)
#: The most pictures that a relief has.
MOST = len(LAMPS_DEG)
#: How much lighter than the law of the floor allows black is, where nothing is said: columns that throw a shadow are
#: never all where the pictures want light.
_EASE = 1.5
#: Columns are no narrower than this, mm: no printer makes them.
LEAST_PITCH_MM = 0.05
_MOST_PITCH_MM = 1000.0
_LEAST_SIDE, _MOST_SIDE = 8, 2048
_LOWEST_DEG, _STEEPEST_DEG = 5.0, 80.0


@dataclass(frozen=True)
class ReliefRecipe:
    """All that decides a relief beside its pictures.

    Parameters
    ----------
    side
        Columns along a side of the square plate.
    method
        ``"global"``: all heights at once, by annealing, for photographs. ``"local"``: walls and floors between them,
        one or two pictures, exact, for flat art; refused where walls would rise higher than `relief_px`.
    relief_px
        How high the relief is, in columns of shadow that so much height throws.
    black
        The display value of the pictures' black; None: as dark as such a relief can be (`darkest`), and half as light
        again.
    elevation_deg
        How high the lamps stand.
    tolerance_deg
        Lamps that stand so much too high or too low are to show the pictures too (global).
    pitch_mm
        A column's side.
    layer_mm
        Heights are whole layers of a printer; None: any.
    bounce
        How much of its mean light a plate throws into its own shadows, 0 to 0.5; 0: none.
    steepest_px
        The greatest step between neighbouring columns (global).
    smooth
        How much steps between columns count beside the pictures (global).
    sweeps
        How often each column is offered another height (global).
    seed
        Of the random numbers (global). The same seed gives the same relief, with any number of threads.
    base_mm, frame_mm
        The plate below the lowest column, and how far it stands out around the picture.
    """

    side: int = 128
    method: Method = "global"
    relief_px: float = 10.0
    black: float | None = None
    elevation_deg: float = 45.0
    tolerance_deg: float = 3.0
    pitch_mm: float = 0.8
    layer_mm: float | None = None
    bounce: float = 0.0
    steepest_px: float = math.inf
    smooth: float = 0.002
    sweeps: int = 400
    seed: int = 0
    base_mm: float = 2.0
    frame_mm: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        self._check_plate()
        self._check_lamps()
        _within("a relief is {} to {} columns high, not {}", 0.5, self.relief_px, 200)
        _within("black is a display value from {} to {}, not {}", 0, self.black or 0, 0.95)
        _within("a plate throws {} to {} of its light into its shadows, not {}", 0, self.bounce, 0.5)
        _within("columns are offered heights {} to {} times, not {}", 1, self.sweeps, 100_000)
        _within("steps count {} to {} beside the pictures, not {}", 0, self.smooth, 10)
        _within("a seed is a whole number from {0} on, not {2}", 0, self.seed, math.inf)
        if self.steepest_px <= 0:
            raise InputError(f"steps between columns cannot be at most {self.steepest_px:g}: give more than 0")

    def _check_plate(self) -> None:
        """Raise `InputError` where nobody could print it."""
        _within("a relief has {} to {} columns a side, not {}", _LEAST_SIDE, self.side, _MOST_SIDE)
        if not LEAST_PITCH_MM <= self.pitch_mm <= _MOST_PITCH_MM:
            raise InputError(
                f"columns of {self.pitch_mm:g} mm cannot be made: take {LEAST_PITCH_MM} to {_MOST_PITCH_MM:g} mm "
                "(0.3 for resin, 0.8 for a nozzle of 0.4)"
            )
        if self.layer_mm is not None and not 0 < self.layer_mm <= self.top_mm:
            raise InputError(
                f"layers of {self.layer_mm:g} mm do not fit a relief {self.top_mm:.3g} mm high: take thinner ones"
            )
        _within("the plate is {} to {} mm thick, not {}", 0.1, self.base_mm, 1000)
        _within("a frame is {} to {} mm wide, not {}", 0, self.frame_mm, 1000)

    def _check_lamps(self) -> None:
        """Raise `InputError` where lamps would stand too low or too high."""
        if self.tolerance_deg < 0:
            raise InputError(f"a lamp cannot stand {self.tolerance_deg:g} degrees off: give 0 or more")
        lowest, highest = self.elevation_deg - self.tolerance_deg, self.elevation_deg + self.tolerance_deg
        if not _LOWEST_DEG <= lowest <= highest <= _STEEPEST_DEG:
            raise InputError(
                f"lamps of a relief stand {_LOWEST_DEG:g} to {_STEEPEST_DEG:g} degrees high, not {lowest:g} to "
                f"{highest:g}: choose another elevation, or a smaller tolerance"
            )

    @property
    def px_mm(self) -> float:
        """How much height throws a shadow of one column."""
        return self.pitch_mm * math.tan(math.radians(self.elevation_deg))

    @property
    def top_mm(self) -> float:
        """How high the relief is at most."""
        return self.relief_px * self.px_mm

    @property
    def slopes(self) -> tuple[float, ...]:
        """How far light descends over a column, at the lamps' elevation and, with a tolerance, below and above it."""
        wrong = (-self.tolerance_deg, self.tolerance_deg) if self.tolerance_deg and self.method == "global" else ()
        return tuple(slope(self.elevation_deg, self.elevation_deg + off) for off in (0.0, *wrong))

    @property
    def black_level(self) -> float:
        """The display value of black."""
        if self.black is not None:
            return self.black
        least = filled(_EASE * darkest(self.relief_px / max(self.slopes)), self.bounce)
        return min(0.95, math.ceil(100 * display(least)) / 100)


def _within(sentence: str, least: float, value: float, most: float) -> None:
    """Raise `InputError` with a sentence of the bounds and the value where it is beyond them."""
    if not least <= value <= most:
        raise InputError(sentence.format(f"{least:g}", f"{most:g}", f"{value:g}"))


def slope(made_for_deg: float, elevation_deg: float) -> float:
    """How far light of some elevation descends over a column, in that of the elevation that a relief is made for."""
    return math.tan(math.radians(elevation_deg)) / math.tan(math.radians(made_for_deg))


def darkest(relief_px: float) -> float:
    """The law of the floor: the least light of a dark area, the whole being 1.

    No shadow is longer than the relief is high, and what throws it is lit: of ``relief_px + 1`` columns one, at least.
    """
    return 1.0 / (relief_px + 1.0)


def filled(light: float, bounce: float) -> float:
    """Light of a dark area, and what a plate that is half lit throws there."""
    return light + bounce * (1 - light) / 2


def display(light: float) -> float:
    """The display value of linear light."""
    return float(encode(np.array([light]))[0])


def side_of(azimuth_deg: float) -> str:
    """Where a relief's lamp stands, in words."""
    return {0.0: "on the right", 180.0: "on the left", 90.0: "behind", 270.0: "in front"}[azimuth_deg]


@dataclass(frozen=True, eq=False)
class Relief:
    """A plate of square columns, and the pictures that its shadows are to be.

    Parameters
    ----------
    heights_px
        ``(row, column)``, the first row furthest away, from 0 on, in columns of shadow that so much height throws.
    wanted
        ``(picture, row, column)`` linear light, from black to 1; each pixel is a square of `cell` columns.
    recipe
        How it was made.
    names
        One name per picture.
    is_colour
        Whether the pictures are the red, green and blue of one, for lamps of these colours.
    cell
        Columns along a side of a picture's pixel.
    provenance
        What else is known of how it was made.

    Raises
    ------
    InputError
        Where shapes disagree, or a number is negative, NaN or infinite.
    """

    heights_px: Reals
    wanted: Reals
    recipe: ReliefRecipe
    names: tuple[str, ...] = ()
    is_colour: bool = False
    cell: int = 1
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_fields(self)
        keep(self, heights_px=np.float64, wanted=np.float64)
        count = len(self.wanted)
        if self.heights_px.ndim != 2 or self.wanted.ndim != 3 or not self.heights_px.size or not self.wanted.size:
            raise InputError(
                "a relief has heights (row, column) and wanted pictures (picture, row, column): give both so"
            )
        if not 1 <= count <= MOST or (self.is_colour and count != 3):
            raise InputError(f"a relief shows 1 to {MOST} pictures, or the three colours of one, not {count}")
        rows, columns = (self.cell * side for side in self.wanted.shape[1:])
        if self.cell < 1 or self.heights_px.shape != (rows, columns + (self.cell > 1)):
            raise InputError(
                f"heights of shape {self.heights_px.shape} do not fit pictures of {rows} x {columns} columns: "
                "give as many"
            )
        if not np.all(np.isfinite(self.heights_px)) or np.any(self.heights_px < 0):
            raise InputError("heights hold negative or non-finite numbers: every column needs one of at least 0")
        if not np.all((self.wanted >= 0) & (self.wanted <= 1)):
            raise InputError("wanted light must be a number from 0 to 1 at every pixel")
        names = self.names or tuple(str(number + 1) for number in range(count))
        if len(names) != count:
            raise InputError(f"{counted(count, 'picture')} with {counted(len(names), 'name')}: give one per picture")
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "provenance", copied(self.provenance))

    def __len__(self) -> int:
        """How many pictures there are."""
        return len(self.wanted)

    def __repr__(self) -> str:
        rows, columns = self.heights_px.shape
        return (
            f"<Relief of {counted(len(self), 'picture')}, {columns} x {rows} columns, {np.ptp(self.heights_mm):.3g} mm>"
        )

    @property
    def azimuths_deg(self) -> tuple[float, ...]:
        """Where each picture's lamp stands, degrees from the right of the plate, against the clock from above."""
        return LAMPS_DEG[: len(self)]

    @property
    def heights_mm(self) -> Reals:
        """Heights above the lowest that a column can have."""
        return np.asarray(self.heights_px * self.recipe.px_mm)

    @property
    def size_mm(self) -> tuple[float, float, float]:
        """Width, depth and height of the whole plate, with its base and frame."""
        rows, columns = self.heights_px.shape
        wide, deep = (side * self.recipe.pitch_mm + 2 * self.recipe.frame_mm for side in (columns, rows))
        return wide, deep, self.recipe.base_mm + float(self.heights_mm.max())

    def layered(self) -> Relief:
        """The same with heights of whole layers, where the recipe has layers."""
        if self.recipe.layer_mm is None:
            return self
        layer_px = self.recipe.layer_mm / self.recipe.px_mm
        return replace(self, heights_px=locked(np.rint(self.heights_px / layer_px) * layer_px))
