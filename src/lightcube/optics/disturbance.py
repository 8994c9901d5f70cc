"""A set-up that is a little off: turned, moved, too bright, coarse, not quite black; films that lie or print wrong."""

import math
from dataclasses import dataclass, fields

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.haze import Phase


@dataclass(frozen=True)
class Disturbance:
    """How a real set-up differs from the one that a cube was made for.

    Parameters
    ----------
    turn_deg
        Degrees by which the cube stands turned at every stop.
    turn_of_64_deg
        The same of a cube 64 voxels wide, a finer one in proportion less: it moves the rim by as much of a voxel.
    right_voxels, up_voxels
        Voxels by which it stands off the axis, to the right and up as seen from the lamp.
    lamp
        Fraction by which the lamp is too strong.
    levels
        Highest of the whole numbers that extinction is rounded to, per colour, the largest extinction being
        that number; 0 = not rounded.
    black
        Light on the screen where it should be black, as a fraction of white, added in linear light.
    disc_deg
        Angular diameter of the lamp's disc where it should have none, degrees; the screen then stands one cube width
        behind the turning cube's reach (`lightcube.optics.setups.soft`), and behind glass where it stands.
    further
        By how much of the cube's width every screen stands too far away, along the light through its picture's middle.
    haze
        Optical thickness along the cube's longest side of haze that the cube was not made for: lamps are turned up for
        what it takes, and its veil is `lightcube.optics.haze.veil_part`'s estimate.
    phase
        Where haze throws light.
    ior
        By how much the glass's index of refraction is too high.
    """

    turn_deg: float = 0.0
    right_voxels: float = 0.0
    up_voxels: float = 0.0
    lamp: float = 0.0
    levels: int = 0
    black: float = 0.0
    turn_of_64_deg: float = 0.0
    disc_deg: float = 0.0
    further: float = 0.0
    haze: float = 0.0
    phase: Phase = "isotropic"
    ior: float = 0.0

    def __post_init__(self) -> None:
        numbers = self.turn_deg, self.turn_of_64_deg, self.right_voxels, self.up_voxels, self.lamp, self.black
        least = min(self.levels, self.black, self.disc_deg, self.haze)
        if (
            not np.all(np.isfinite([*numbers, self.disc_deg, self.further, self.haze, self.ior]))
            or self.lamp <= -1
            or least < 0
        ):
            raise InputError(
                f"no set-up is off by {self!r}: give finite numbers, lamp above -1, levels, black, disc, haze of at "
                "least 0"
            )

    def __str__(self) -> str:
        off = "too far" if self.further > 0 else "too near"
        aside = "ahead" if self.phase == "forward" else "to all sides"
        said = {
            f"turned {self.turn_deg:g}°": self.turn_deg,
            f"turned {self.turn_of_64_deg:g}° · 64 / n": self.turn_of_64_deg,
            f"{self.right_voxels:g} voxel to the right": self.right_voxels,
            f"{self.up_voxels:g} voxel up": self.up_voxels,
            f"lamp {100 * self.lamp:+.3g} %": self.lamp,
            f"extinction in {self.levels + 1} levels": self.levels,
            f"black at {100 * self.black:.3g} % of white": self.black,
            f"lamp of {self.disc_deg:g}°, screen a cube's width behind (as made, behind glass)": self.disc_deg,
            f"index of refraction {self.ior:+g}": self.ior,
            f"screen {100 * abs(self.further):g} % of the cube's width {off}": self.further,
            f"haze that throws {-100 * math.expm1(-self.haze):.0f} % {aside} along the cube (an estimate)": self.haze,
        }
        return ", ".join(words for words, number in said.items() if number) or "as made"


#: What `robust` tries, by name; lamps of a size only where they have none, on a turntable; other distances of screens
#: only where they matter, and other indices of refraction only of glass.
DISTURBANCES = {
    "undisturbed": Disturbance(),
    "turned": Disturbance(turn_deg=0.2),
    "turned-as-64": Disturbance(turn_of_64_deg=0.2),
    "sideways": Disturbance(right_voxels=0.5),
    "up": Disturbance(up_voxels=0.5),
    "lamp": Disturbance(lamp=0.02),
    "extinction": Disturbance(levels=255),
    "black": Disturbance(black=0.01),
    "disc": Disturbance(disc_deg=0.5),
    "far": Disturbance(further=0.05),
    "near": Disturbance(further=-0.05),
    "haze": Disturbance(haze=0.1),
    "haze-more": Disturbance(haze=0.4),
    "haze-ahead": Disturbance(haze=0.1, phase="forward"),
    "haze-ahead-more": Disturbance(haze=0.4, phase="forward"),
    "index": Disturbance(ior=0.001),
    "index-more": Disturbance(ior=0.01),
    "all": Disturbance(0.2, 0.5, 0.5, 0.02, 255, 0.01),
}


@dataclass(frozen=True)
class FilmsOff:
    """How films that were printed and put together differ from those that were solved for.

    Parameters
    ----------
    shift_mm, height_mm
        How far each film lies off along either side, and in height, root of the mean square.
    stretch
        By how much each film is printed too large, root of the mean square, as a part of its size.
    lamp_deg
        By how many degrees every lamp stands off, all the same way.
    disc_deg
        Angular diameter of lamps that should have none, degrees.
    ink, ink_each
        By how much all ink is too strong, and each colour of each film, root of the mean square.
    gain
        Dot gain at half coverage: so much more of the film is covered than was asked for.
    levels
        Of coverage, highest of the whole numbers that it is rounded to; 0 = not rounded.
    ghosts
        Light that was reflected between films, evenly spread, as a part of a picture's mean.
    """

    shift_mm: float = 0.0
    height_mm: float = 0.0
    stretch: float = 0.0
    lamp_deg: float = 0.0
    disc_deg: float = 0.0
    ink: float = 0.0
    ink_each: float = 0.0
    gain: float = 0.0
    levels: int = 0
    ghosts: float = 0.0

    def __post_init__(self) -> None:
        numbers = [getattr(self, each.name) for each in fields(self)]
        least = min(number for each, number in zip(fields(self), numbers, strict=True) if each.name != "ink")
        if not np.all(np.abs(numbers) <= _MOST) or least < 0 or self.ink <= -1 or self.disc_deg >= 90:
            raise InputError(f"no films are off by {self!r}: give numbers of at least 0, ink above -1, disc below 90")

    @property
    def is_random(self) -> bool:
        """Whether it is another thing each time."""
        return bool(self.shift_mm or self.height_mm or self.stretch or self.ink_each)

    def __str__(self) -> str:
        said = {
            f"films {self.shift_mm:g} mm off": self.shift_mm,
            f"heights {self.height_mm:g} mm off": self.height_mm,
            f"each film's size {100 * self.stretch:g} % off": self.stretch,
            f"lamps {self.lamp_deg:g}° off": self.lamp_deg,
            f"lamps of {self.disc_deg:g}°, as the sun": self.disc_deg,
            f"all ink {100 * self.ink:+g} %": self.ink,
            f"each ink of each film {100 * self.ink_each:g} % off": self.ink_each,
            f"dot gain {100 * self.gain:g} %": self.gain,
            f"{self.levels + 1} levels of ink": self.levels,
            f"ghosts {100 * self.ghosts:g} % of the mean light": self.ghosts,
        }
        return ", ".join(words for words, number in said.items() if number) or "as made"


#: No number of films that are off is larger.
_MOST = 1e6
#: What is tried of films, by name.
FILMS_OFF = {
    "undisturbed": FilmsOff(),
    "shifted": FilmsOff(shift_mm=0.1),
    "shifted-more": FilmsOff(shift_mm=0.2),
    "heights": FilmsOff(height_mm=0.2),
    "heights-more": FilmsOff(height_mm=0.5),
    "stretched": FilmsOff(stretch=0.002),
    "lamps": FilmsOff(lamp_deg=0.2),
    "lamps-more": FilmsOff(lamp_deg=0.5),
    "sun": FilmsOff(disc_deg=0.53),
    "ink": FilmsOff(ink=-0.05),
    "ink-each": FilmsOff(ink_each=0.05),
    "gain": FilmsOff(gain=0.05),
    "gain-more": FilmsOff(gain=0.1),
    "levels": FilmsOff(levels=255),
    "ghosts": FilmsOff(ghosts=0.02),
    "ghosts-more": FilmsOff(ghosts=0.08),
    "together": FilmsOff(shift_mm=0.2, ink_each=0.05, ghosts=0.02),
}
#: What each disturbance is, by name, for people.
SAID = {name: str(each) for name, each in {**DISTURBANCES, **FILMS_OFF}.items()}
