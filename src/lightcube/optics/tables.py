"""The tables that a `Rig` is made of: a row for every view, picture, lamp or screen."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import DTypeLike

from lightcube.errors import InputError
from lightcube.optics.arrays import Counts, Flags, Reals, keep
from lightcube.optics.checks import check_fields
from lightcube.optics.transfer import BLACK

#: Bounds of the power of a lamp of which nothing is said; the lower one is that of any lamp that is not fixed.
POWER_MIN, POWER_MAX = 1e-4, 16.0
#: Any length of an axis.
_ANY = -1
#: No lamp may be stronger.
POWER_MOST = 1e6
#: No number is larger, but for lengths that may be endless.
_LARGEST = 1e12
_ENDLESS = ("reach_mm", "falloff_mm", "full_at_mm")


class _Columns:
    """Arrays of one row per view or picture, which cannot be written to."""

    def _keep(self, rows: str, **kinds: tuple[DTypeLike, tuple[int | None, ...]]) -> None:
        """Make arrays the value's own: dtypes and shapes by name, None where there is one for each of `rows`."""
        check_fields(self)
        keep(self, **{name: kind for name, (kind, _) in kinds.items()})
        count = len(np.atleast_1d(getattr(self, rows)))
        for name, (_, asked) in kinds.items():
            shape, found = tuple(count if n is None else n for n in asked), getattr(self, name).shape
            if len(found) != len(shape) or any(n not in (m, _ANY) for m, n in zip(found, shape, strict=True)):
                raise InputError(f"{name} of a rig has shape {found}, not {shape}")
            size = np.abs(getattr(self, name))
            if not np.all((size <= _LARGEST) | ((name in _ENDLESS) & np.isinf(size))):
                raise InputError(f"{name} of a rig holds NaN or numbers beyond {_LARGEST:g}: mend it")


@dataclass(frozen=True, eq=False)
class Sums(_Columns):
    """Which views add up to which picture, under which lamp and with what share; those of a picture follow each other.

    Parameters
    ----------
    picture
        ``(views,)``: the picture that each view adds to, ascending from 0, none left out.
    lamp
        ``(views,)``: the lamp of each view, a number into the rig's `Lamps`.
    share
        ``(views, channels)`` of at least 0: the lamp's colour, divided among the samples of its disc and of pixels; one
        channel = the same for any number of colours.
    disc_deg
        ``(views,)``: angular diameter of the lamp's disc as seen from the cube's middle, degrees, of which the view is
        the middle; 0 where it has none, or the view is a sample of it.
    square
        ``(views,)``: side, in pixels, of the square about each pixel's middle whose mean the view is, exactly; 0, as
        where nothing is said = its middle beam alone. Only films can be cast so (`lightcube.projection.films`).
    """

    picture: Counts
    lamp: Counts
    share: Reals
    disc_deg: Reals
    square: Reals = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        if np.size(self.square) == 0:
            object.__setattr__(self, "square", np.zeros(np.shape(self.picture)))
        self._keep(
            "picture",
            picture=(np.intp, (None,)),
            lamp=(np.intp, (None,)),
            share=(np.float64, (None, _ANY)),
            disc_deg=(np.float64, (None,)),
            square=(np.float64, (None,)),
        )
        steps = np.diff(self.picture, prepend=-1)
        if not len(self.picture) or np.any((steps != 0) & (steps != 1)) or steps[0] != 1:
            raise InputError("views of a rig must be in the order of their pictures, none of which is left out")
        if np.any(self.share < 0):
            raise InputError("a rig's shares must be at least 0")
        if np.any(self.square < 0):
            raise InputError("the squares of a rig's pixels must have sides of at least 0")

    def of_colours(self, channels: int) -> Reals:
        """``(views, channels)``: the share of each view and colour."""
        return np.broadcast_to(self.share, (len(self.share), channels))


@dataclass(frozen=True, eq=False)
class Fading(_Columns):
    """How light and shadows change with distance and slant, and what lies over them.

    Parameters
    ----------
    reach_mm, falloff_mm
        ``(views, 2)``, of the lamp and of the screen: so far behind the cube the shadow keeps its full strength, and
        over each such length beyond it fades to 1/e (0 = it ends there). Both apply.
    full_at_mm
        ``(views,)``: so far from it a point lamp shows its power, and elsewhere by the inverse square of the distance;
        infinity = the same everywhere.
    cosine
        ``(views,)`` bool: whether light that falls aslant on the screen is spread over more of it.
    veil
        ``(views,)`` from 0 to below 1: light that lies evenly over the screen whatever the cube, thrown aside by its
        haze or by the room, as a part of what the lamp brings to a bare wall; 0, as where nothing is said = none.
    """

    reach_mm: Reals
    falloff_mm: Reals
    full_at_mm: Reals
    cosine: Flags
    veil: Reals = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        if np.size(self.veil) == 0:
            object.__setattr__(self, "veil", np.zeros(np.shape(self.full_at_mm)))
        self._keep(
            "full_at_mm",
            reach_mm=(np.float64, (None, 2)),
            falloff_mm=(np.float64, (None, 2)),
            full_at_mm=(np.float64, (None,)),
            cosine=(np.bool_, (None,)),
            veil=(np.float64, (None,)),
        )
        for veil in np.unique(self.veil):
            check_veil(float(veil))

    @classmethod
    def none(cls, views: int) -> Fading:
        """Light and shadows that are the same everywhere."""
        return cls(np.full((views, 2), np.inf), np.zeros((views, 2)), np.full(views, np.inf), np.zeros(views, np.bool_))

    @property
    def is_none(self) -> bool:
        """Whether light and shadows are the same everywhere, and nothing lies over them."""
        return bool(
            np.all(np.isinf(self.reach_mm))
            and np.all(np.isinf(self.full_at_mm))
            and not np.any(self.cosine)
            and not np.any(self.veil)
        )


@dataclass(frozen=True, eq=False)
class Turning(_Columns):
    """What goes round the cube when the table turns.

    Parameters
    ----------
    turns
        ``(views, 2)`` bool: whether the lamp, and the screen, goes round the cube.
    way
        ``(views, 2)``: which way, in the cube's axes, as the angle rises: 1 counter-clockwise about `axis`, else -1.
    axis
        ``(3,)``, of the turntable.
    """

    turns: Flags
    way: Reals
    axis: Reals

    def __post_init__(self) -> None:
        self._keep("turns", turns=(np.bool_, (None, 2)), way=(np.float64, (None, 2)), axis=(np.float64, (3,)))


@dataclass(frozen=True, eq=False)
class Stops(_Columns):
    """Where each picture stands.

    Parameters
    ----------
    angle_deg, screen
        ``(pictures,)``: angle of the stop (degrees), and the screen, a number into the rig's `Screens`.
    window
        ``(pictures, 2)``: how many rows and columns of the picture, from its upper left, lie on the screen.
    films
        ``(pictures, films, 7)``: where each film of a stack lies for each picture, ``(a, b, c, d, x, y, z)``: at (X, Y)
        in the block's axes, mm, and height z, is what the film has at ``u = a X + b Y + x``, ``v = c X + d Y + y``. No
        films, as where nothing is said = all lie as the stack has them.
    """

    angle_deg: Reals
    screen: Counts
    window: Counts
    films: Reals = field(default_factory=lambda: np.zeros((0, 0, 7)))

    def __post_init__(self) -> None:
        if np.size(self.films) == 0:
            object.__setattr__(self, "films", np.zeros((np.size(self.angle_deg), 0, 7)))
        self._keep(
            "angle_deg",
            angle_deg=(np.float64, (None,)),
            screen=(np.intp, (None,)),
            window=(np.intp, (None, 2)),
            films=(np.float64, (None, _ANY, 7)),
        )


@dataclass(frozen=True, eq=False)
class Lamps(_Columns):
    """The lamps: their names, and bounds of their power, equal where it is fixed; linear light, 1 shows white."""

    names: tuple[str, ...]
    least: Reals
    most: Reals

    def __post_init__(self) -> None:
        self._keep("names", least=(np.float64, (None,)), most=(np.float64, (None,)))
        if not np.all((self.least > 0) & (self.least <= self.most)):
            raise InputError("the powers of a rig's lamps must be above 0, the least before the largest")

    @property
    def are_fixed(self) -> bool:
        """Whether every lamp has one given power."""
        return bool(np.array_equal(self.least, self.most))


@dataclass(frozen=True, eq=False)
class Screens(_Columns):
    """The screens: their names, the display value that each cannot be darker than, and whether it has no edges."""

    names: tuple[str, ...]
    black: Reals
    endless: Flags

    def __post_init__(self) -> None:
        self._keep("names", black=(np.float64, (None,)), endless=(np.bool_, (None,)))
        for black in self.black:
            check_black(float(black))


def check_black(black: float) -> None:
    """Raise `InputError` unless a screen can be as dark as this display value and no darker."""
    if not BLACK <= black < 1:
        raise InputError(f"black must be a display value from {BLACK:.4f}, half a level, to below 1, not {black:g}")


def check_veil(veil: float) -> None:
    """Raise `InputError` unless so much of a lamp's light can lie evenly over a wall."""
    if not 0 <= veil < 1:
        raise InputError(f"a veil is a part of the lamp's light, from 0 to below 1, not {veil:g}")


def power_bounds(power: float | None, power_max: float | None = None) -> tuple[float, float]:
    """Least and largest power of a lamp: those that are said, or as usual; `InputError` where they cannot be."""
    if power is not None and not POWER_MIN <= power <= POWER_MOST:
        raise InputError(f"a lamp power must lie between {POWER_MIN:g} and 1e6, not {power:g}")
    if power_max is not None and not 1 <= power_max <= POWER_MOST:
        raise InputError(f"the largest lamp power must lie between 1 and 1e6, not {power_max:g}")
    return (POWER_MIN, power_max or POWER_MAX) if power is None else (power, power)
