"""All that decides the bits of a cube beside pictures, grid and views."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any, Literal, get_args

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.optics.material import Material
from lightcube.optics.rig import LAMP_MIN
from lightcube.optics.transfer import BLACK
from lightcube.solvers import METHODS

#: Each picture and colour has a power of its own, all pictures share one of each colour, or each has its own as it was
#: found at half the size.
Powers = Literal["per-picture", "shared", "coarse"]
#: Largest power of a lamp unless another one is given; no lamp may be stronger than the other.
LAMP_MAX, LAMP_MOST = 16.0, 1e6
#: For a look, for use, and for the last tenth of a dB.
Quality = Literal["draft", "normal", "best"]
#: At most so many passes of method display, and the PSNR of all pixels, dB, that is enough.
QUALITIES: Mapping[Quality, tuple[int, float]] = {"draft": (30, 36.0), "normal": (200, 42.0), "best": (1000, math.inf)}


@dataclass(frozen=True)
class Recipe:
    """How a cube is solved: two cubes of the same recipe, pictures, grid and views are the same, bit for bit.

    Parameters
    ----------
    method
        A name in `lightcube.METHODS`.
    powers
        ``"per-picture"``: each picture and colour has the lamp power that suits it best; ``"shared"``: each colour has
        one for all pictures; ``"coarse"``: as per-picture, but found at half the size and then kept.
    lamp_power
        Power of a turntable's lamp where it is fixed, linear light: 1 shows white where a beam meets nothing. Methods
        that cannot choose powers take 1 where nothing is said.
    lamp_max
        Largest power of a turntable's lamp that is not fixed, at least 1; None = 16.
    hold_deg
        Degrees on either side of its stop over which each picture shall stand, at most half the way to the next one:
        it is asked for at several angles, under one lamp power.
    material
        What bounds the extinction.
    black
        Display value, in [0, 1), that the screen cannot be darker than; pixels darker than it are wanted at it.
    passes
        At most so many at full size; None = the method's own number.
    enough_db
        Method display stops as soon as the mean squared difference of all weighted pixels (the too dark ones
        linearised) is as small as at this PSNR, dB.
    dtype
        Of the computation: ``"float32"`` or ``"float64"``.

    Raises
    ------
    InputError
        For what cannot be: an unknown method, numbers out of their range, a method that cannot do what is asked for.
    """

    method: str = "display"
    powers: Powers = "per-picture"
    lamp_power: float | None = None
    lamp_max: float | None = None
    hold_deg: float = 0.0
    material: Material = field(default_factory=Material)
    black: float = BLACK
    passes: int | None = None
    enough_db: float = math.inf
    dtype: str = "float32"

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise InputError(f"unknown method {self.method!r}: use one of {', '.join(METHODS)}")
        if self.powers not in get_args(Powers):
            raise InputError(f"unknown lamp powers {self.powers!r}: use one of {', '.join(get_args(Powers))}")
        self._check_lamp()
        if not self.hold_deg >= 0:
            raise InputError(f"a hold must be a number of degrees of at least 0, not {self.hold_deg:g}")
        if not BLACK <= self.black < 1:
            raise InputError(
                f"black must be a display value from {BLACK:.4f}, half a level, to below 1, not {self.black:g}"
            )
        if self.passes is not None and self.passes < 1:
            raise InputError(f"a solver needs at least 1 pass, not {self.passes}")
        if np.dtype(self.dtype) not in (np.float32, np.float64):
            raise InputError(f"cubes are computed in float32 or float64, not in {self.dtype}")
        for name in ("lamp_power", "lamp_max", "hold_deg", "black", "enough_db"):
            value = getattr(self, name)
            object.__setattr__(self, name, None if value is None else float(value))
        object.__setattr__(self, "dtype", np.dtype(self.dtype).name)

    def _check_lamp(self) -> None:
        if not self.chooses_powers and (self.powers != "per-picture" or self.lamp_max is not None):
            raise InputError(
                f"method {self.method} cannot choose lamp powers: give one lamp power, or use method display"
            )
        if self.lamp_power is not None and (self.powers != "per-picture" or self.lamp_max is not None):
            raise InputError(
                "a lamp of one given power has neither a largest power nor powers that are shared or coarse: leave "
                "that power out, or the other"
            )
        if self.lamp_power is not None and not LAMP_MIN <= self.lamp_power <= LAMP_MOST:
            raise InputError(f"a lamp power must lie between {LAMP_MIN:g} and 1e6, not {self.lamp_power:g}")
        if self.lamp_max is not None and not 1 <= self.lamp_max <= LAMP_MOST:
            raise InputError(f"the largest lamp power must lie between 1 and 1e6, not {self.lamp_max:g}")

    @classmethod
    def of_quality(cls, quality: Quality, **more: Any) -> "Recipe":
        """So many passes, or fewer where the pictures are good enough before; `more` are the other fields."""
        passes, enough = QUALITIES[quality]
        return cls(passes=passes, enough_db=enough, **more)

    @property
    def chooses_powers(self) -> bool:
        """Whether the method finds lamp powers."""
        return self.method == "display"

    @property
    def lamp_bounds(self) -> tuple[float, float]:
        """Least and largest power of a turntable's lamp; the same where it is fixed."""
        if self.lamp_power is not None or not self.chooses_powers:
            return (self.lamp_power or 1.0,) * 2
        return LAMP_MIN, self.lamp_max or LAMP_MAX

    @property
    def is_lamp_fixed(self) -> bool:
        """Whether a turntable's lamp has one given power."""
        least, most = self.lamp_bounds
        return least == most

    def by_display(self, passes: int) -> "Recipe":
        """The same lamps, hold, material and screen by so many passes of method display: what a rehearsal solves."""
        power = self.lamp_bounds[1] if self.is_lamp_fixed else None
        return replace(
            self, method="display", lamp_power=power, passes=passes, enough_db=math.inf, dtype=Recipe().dtype
        )

    def plain(self) -> dict[str, str | float | None]:
        """Every field by name, as JSON has it: infinity, which it has not, is None."""
        flat = {**asdict(self), **asdict(self.material)}
        del flat["material"]
        return {name: None if value in _NONE else value for name, value in flat.items()}


_NONE = (None, math.inf)
_MATERIAL = tuple(each.name for each in fields(Material))


def from_plain(said: Mapping[str, Any]) -> Recipe:
    """The recipe whose `Recipe.plain` this is; what is missing is as usual, and what is no field is left out.

    Raises
    ------
    InputError
        Where a value cannot be.
    """
    own = {each.name for each in fields(Recipe)} - {"material"}
    given = {name: value for name, value in said.items() if value is not None}
    material = Material(**{name: given[name] for name in _MATERIAL if name in given})
    return Recipe(material=material, **{name: given[name] for name in own if name in given})


def recipe_of(cube: Cube) -> Recipe:
    """How a cube was made, from what it remembers; of one that was not solved, no lamp is stronger than its own."""
    made = dict(cube.provenance)
    if "powers" not in made and cube.lighting is None:
        made["lamp_max"] = max(1.0, float(cube.powers.max()))
    return replace(from_plain(made), hold_deg=cube.hold_deg)
