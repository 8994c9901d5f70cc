"""A room with a cube on a turntable, lamps and screens, and which picture is wanted where: it makes views.

The room's axes are right-handed with z up, and the cube's middle is their origin; lengths are mm, angles degrees.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals
from lightcube.optics.checks import check_fields
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid
from lightcube.optics.material import Material
from lightcube.optics.moves import Move, moved
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.optics.tables import (
    POWER_MAX,
    POWER_MIN,
    POWER_MOST,
    Fading,
    Lamps,
    Screens,
    Stops,
    Sums,
    Turning,
    check_veil,
)
from lightcube.optics.transfer import BLACK
from lightcube.optics.views import MOST_DEG, Views, unit
from lightcube.wording import counted

Vector = tuple[float, float, float]

#: A stage has no more screens and lamps than this, and no screen more pixels along a side.
MOST_SCREENS, MOST_LAMPS, MOST_PIXELS = 32, 256, 2048
#: Numbers nearer to 0, or farther from it, are no lengths (mm) and directions: beyond them digits run out.
_LEAST, _MOST = 1e-9, 1e15


@dataclass(frozen=True)
class Lamp:
    """A lamp: parallel light from far away, or a point.

    Parameters
    ----------
    name
        What pictures call it.
    direction
        The way its light travels, of any length; then it is parallel.
    position_mm
        Where it stands, mm; then it is a point. One of the two is given.
    colour
        Its light in linear red, green and blue, each at least 0.
    power
        Its power where that is fixed, linear light: 1 shows white where a beam meets nothing.
    power_max
        Largest power where it is not.
    turns
        Whether the table carries it.
    size_deg
        Angular diameter of its disc as seen from the cube's middle, degrees below 90; 0 = none.
    reach_mm, falloff_mm
        So far behind the cube its shadows keep their strength; beyond, they fade to 1/e every `falloff_mm`.
    full_at_mm
        At this distance a point lamp shows its power, elsewhere by the inverse square; infinity = at every distance.

    Raises
    ------
    InputError
        Where a number is out of its range, or not one of `direction` and `position_mm` is given.
    """

    name: str
    direction: Vector | None = None
    position_mm: Vector | None = None
    colour: Vector = (1.0, 1.0, 1.0)
    power: float | None = None
    power_max: float = POWER_MAX
    turns: bool = False
    size_deg: float = 0.0
    reach_mm: float = math.inf
    falloff_mm: float = 0.0
    full_at_mm: float = math.inf

    def __post_init__(self) -> None:
        check_fields(self, f"lamp {self.name!r}")
        _check_lamp(self)


@dataclass(frozen=True)
class Screen:
    """A flat screen.

    Parameters
    ----------
    name
        What pictures call it.
    centre_mm
        Where its middle is, mm.
    size_mm
        Width and height.
    pitch_mm
        From one pixel to the next.
    normal
        The way its lit side faces; default to the cube's middle.
    up
        What is up in its pictures; default up in the room, on a floor or ceiling the way of the x axis.
    rear
        Whether it is looked at from behind: pictures are mirrored for it.
    turns
        Whether the table carries it.
    reach_mm, falloff_mm
        As a lamp's, for all shadows on this screen.
    cosine
        Whether light that falls aslant is spread over more of the screen.
    black
        Display value, from half a level of 255 to below 1, that it cannot be darker than; pixels darker than it are
        wanted at it.

    Raises
    ------
    InputError
        Where a number is out of its range, or `up` points out of the screen.
    """

    name: str
    centre_mm: Vector
    size_mm: tuple[float, float]
    pitch_mm: float
    normal: Vector | None = None
    up: Vector | None = None
    rear: bool = False
    turns: bool = False
    reach_mm: float = math.inf
    falloff_mm: float = 0.0
    cosine: bool = False
    black: float = BLACK

    def __post_init__(self) -> None:
        check_fields(self, f"screen {self.name!r}")
        _check_screen(self)

    @property
    def pixels(self) -> tuple[int, int]:
        """How many rows and columns of pixels there are."""
        wide, high = self.size_mm
        return max(1, round(high / self.pitch_mm)), max(1, round(wide / self.pitch_mm))

    @property
    def facing(self) -> Reals:
        """Unit vector out of its lit side."""
        return unit(self.normal if self.normal is not None else -np.array(self.centre_mm))

    @property
    def steps(self) -> tuple[Reals, Reals]:
        """From a pixel to the next one to its right, and to the next one below it."""
        normal = self.facing
        flat = bool(np.hypot(normal[0], normal[1]) < 1e-9)
        up = np.array(self.up if self.up is not None else ((1.0, 0.0, 0.0) if flat else (0.0, 0.0, 1.0)))
        up = unit(up - (up @ normal) * normal)
        right = np.cross(up, normal)
        return self.pitch_mm * (-right if self.rear else right), -self.pitch_mm * up


#: What a stage knows by its name.
_Named = TypeVar("_Named", Lamp, Screen)


@dataclass(frozen=True)
class Shot:
    """A picture that is wanted: its name, on which screen, under which lamps, at which stop (counted from 0).

    And how the films of a stack lie for it; None = as they lie in the stack.
    """

    name: str
    screen: str
    lamps: tuple[str, ...]
    stop: int = 0
    move: Move | None = None

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Stage:
    """What stands in the room.

    Parameters
    ----------
    grid
        The cube, its middle at the origin.
    lamps, screens, shots
        Names are used once; every shot names a screen and lamps that are there.
    stops_deg
        Turntable angles, degrees; a positive angle turns what the table carries counter-clockwise about `axis`.
    axis
        Of the turntable, through the cube's middle.
    cube_turns
        Whether the table carries the cube.
    material
        What bounds the extinction of this block; None = as the recipe says. Of cubes only what is clear counts.
    glass
        What bends the light on its way to the voxels; None = nothing.
    veil
        Light that each lamp lays evenly over its screens, as a part of what it brings to a bare one, from 0 to below 1.

    Raises
    ------
    InputError
        Where a name is unknown or used twice, or the turntable's stops or axis are none.

    Examples
    --------
    >>> import lightcube as lc
    >>> sun = lc.Lamp("sun", direction=(1, 0, -0.5))
    >>> wall = lc.Screen("wall", (9, 0, -3), (5, 5), 1)
    >>> shots = lc.Shot("a", "wall", ("sun",)), lc.Shot("b", "wall", ("sun",), stop=1)
    >>> lc.Stage(lc.Grid((6, 8, 8)), (sun,), (wall,), shots, stops_deg=(20, 80)).rig()
    <rig of 2 pictures of 5 x 5 pixels, 2 views>
    """

    grid: Grid
    lamps: tuple[Lamp, ...]
    screens: tuple[Screen, ...]
    shots: tuple[Shot, ...]
    stops_deg: tuple[float, ...] = (0.0,)
    axis: Vector = (0.0, 0.0, 1.0)
    cube_turns: bool = True
    material: Material | None = None
    glass: Glass | None = None
    veil: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        _check_names("lamp", [lamp.name for lamp in self.lamps], MOST_LAMPS)
        _check_names("screen", [screen.name for screen in self.screens], MOST_SCREENS)
        if not self.shots:
            raise InputError("no picture is wanted on this stage: name at least one, its screen, lamps and stop")
        for shot in self.shots:
            self._check_shot(shot)
        if not self.stops_deg or not np.all(np.abs(self.stops_deg) <= MOST_DEG):
            raise InputError(
                f"the turntable's stops must be finite numbers of degrees up to {MOST_DEG:g}, and at least one"
            )
        _check_vector("the turntable", "axis", self.axis)
        check_veil(self.veil)

    def __repr__(self) -> str:
        counts = {"lamp": self.lamps, "screen": self.screens, "picture": self.shots, "stop": self.stops_deg}
        said = ", ".join(counted(len(each), name) for name, each in counts.items())
        return f"<stage of {said}, {self.grid!r}>"

    def lamp(self, name: str) -> Lamp:
        """The lamp of this name."""
        return _named("lamp", self.lamps, name)

    def screen(self, name: str) -> Screen:
        """The screen of this name."""
        return _named("screen", self.screens, name)

    def rig(self) -> Rig:
        """Views of every picture, one for each of its lamps, and how they make it.

        Pictures are as large as the largest screen; smaller ones keep the upper left of theirs (`Stops.window`).
        """
        shots = list(enumerate(self.shots))
        lit = [(p, self.screen(shot.screen), self.lamp(name)) for p, shot in shots for name in shot.lamps]
        sizes = [screen.pixels for _, screen, _ in lit]
        shape = max(rows for rows, _ in sizes), max(columns for _, columns in sizes)
        lamps, screens = ([each.name for each in things] for things in (self.lamps, self.screens))
        carried = [[each.turns != self.cube_turns for each in (lamp, screen)] for _, screen, lamp in lit]
        way = np.full((len(lit), 2), -1.0 if self.cube_turns else 1.0)
        least, most = (np.array(powers) for powers in zip(*(_powers(lamp) for lamp in self.lamps), strict=True))
        standing = Rig(
            _views(lit, shape),
            Sums(
                picture=np.array([p for p, _, _ in lit]),
                lamp=np.array([lamps.index(lamp.name) for _, _, lamp in lit]),
                share=np.array([lamp.colour for _, _, lamp in lit]),
                disc_deg=np.array([lamp.size_deg for _, _, lamp in lit]),
            ),
            Fading(
                reach_mm=np.array([(lamp.reach_mm, screen.reach_mm) for _, screen, lamp in lit]),
                falloff_mm=np.array([(lamp.falloff_mm, screen.falloff_mm) for _, screen, lamp in lit]),
                full_at_mm=np.array([lamp.full_at_mm for _, _, lamp in lit]),
                cosine=np.array([screen.cosine for _, screen, _ in lit]),
                veil=np.full(len(lit), self.veil),
            ),
            Turning(np.array(carried), way, np.array(self.axis)),
            Stops(
                angle_deg=np.zeros(len(self.shots)),
                screen=np.array([screens.index(shot.screen) for shot in self.shots]),
                window=np.array([self.screen(shot.screen).pixels for shot in self.shots]),
            ),
            Lamps(tuple(lamps), least, most),
            Screens(tuple(screens), np.array([each.black for each in self.screens]), np.zeros(len(screens), np.bool_)),
        )
        if self.glass is not None and (self.glass.bends or self.glass.is_bath):
            body = self.glass.around(self.grid)
            standing = replace(standing.by_colour(3) if len(body.iors) > 1 else standing, glass=body)
        if isinstance(self.grid, Stack):
            standing = moved(standing, self.grid, [shot.move for shot in self.shots])
        return standing.turned([self.stops_deg[shot.stop] for shot in self.shots])

    def _check_shot(self, shot: Shot) -> None:
        screens, lamps = ([each.name for each in things] for things in (self.screens, self.lamps))
        if shot.screen not in screens:
            raise InputError(
                f"picture {shot.name!r}: there is no screen {shot.screen!r}: use one of {', '.join(screens)}"
            )
        if not shot.lamps:
            raise InputError(f"picture {shot.name!r}: no lamp is lit: name one of {', '.join(lamps)}")
        for name in shot.lamps:
            if name not in lamps:
                raise InputError(f"picture {shot.name!r}: there is no lamp {name!r}: use one of {', '.join(lamps)}")
        if len(set(shot.lamps)) < len(shot.lamps):
            raise InputError(f"picture {shot.name!r} names a lamp twice: name each lamp once")
        if shot.move is not None and not isinstance(self.grid, Stack):
            raise InputError(f"picture {shot.name!r}: only the films of a stack are moved: leave out its move")
        if not 0 <= shot.stop < len(self.stops_deg):
            raise InputError(
                f"picture {shot.name!r}: there is no stop {shot.stop + 1}: the turntable has {len(self.stops_deg)}"
            )


def _named(kind: str, things: Sequence[_Named], name: str) -> _Named:
    """The lamp or screen of a name."""
    for thing in things:
        if thing.name == name:
            return thing
    raise InputError(f"there is no {kind} {name!r}: use one of {', '.join(each.name for each in things)}")


def _powers(lamp: Lamp) -> tuple[float, float]:
    """Least and largest power of a lamp."""
    return (POWER_MIN, lamp.power_max) if lamp.power is None else (lamp.power, lamp.power)


def _views(lit: Sequence[tuple[int, Screen, Lamp]], shape: tuple[int, int]) -> Views:
    """A view for each picture's lamp, as all stands at angle 0."""
    places = [(lamp.direction, 0.0) if lamp.position_mm is None else (lamp.position_mm, 1.0) for _, _, lamp in lit]
    return Views(
        lamps=np.array([(*place, point) for place, point in places if place is not None]),
        origins_mm=np.array([_middle(screen, shape) for _, screen, _ in lit]),
        column_steps_mm=np.array([screen.steps[0] for _, screen, _ in lit]),
        row_steps_mm=np.array([screen.steps[1] for _, screen, _ in lit]),
        picture_shape=shape,
    )


def _middle(screen: Screen, shape: tuple[int, int]) -> Reals:
    """Middle of a raster of `shape` whose upper left is the screen's."""
    rows, columns = screen.pixels
    right, down = screen.steps
    return np.asarray(np.array(screen.centre_mm) + (shape[1] - columns) / 2 * right + (shape[0] - rows) / 2 * down)


def _check_names(kind: str, names: Sequence[str], most: int) -> None:
    if not names:
        raise InputError(f"there is no {kind} on this stage: give at least one")
    if len(names) > most:
        raise InputError(
            f"a stage has at most {most} {kind}s, not {len(names)}: leave out {names[most]!r} and the like"
        )
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"there are two {kind}s called {name!r}: give each a name of its own")


def _check_vector(who: str, key: str, vector: Sequence[float]) -> None:
    if len(vector) != 3 or not _LEAST <= math.hypot(*vector) <= _MOST:  # also refuses NaN
        raise InputError(
            f"{who}: {key} must be three finite numbers that are not all 0 nor beyond {_MOST:g}, not {tuple(vector)}"
        )


def _check_least(who: str, key: str, value: float, least: float, *, above: bool = False) -> None:
    if not (value > least if above else value >= least):
        raise InputError(f"{who}: {key} must be {'above' if above else 'at least'} {least:g}, not {value:g}")


def _check_fading(who: str, reach_mm: float, falloff_mm: float) -> None:
    _check_least(who, "reach_mm", reach_mm, 0)
    _check_least(who, "falloff_mm", falloff_mm, 0)
    if falloff_mm > 0 and math.isinf(reach_mm):
        raise InputError(f"{who}: falloff_mm says how shadows fade beyond reach_mm, which is not given: give it, or 0")


def _check_lamp(lamp: Lamp) -> None:
    who = f"lamp {lamp.name!r}"
    if (lamp.direction is None) == (lamp.position_mm is None):
        raise InputError(f"{who}: give either a direction (parallel light) or a position_mm (a point), one of the two")
    if lamp.direction is not None:
        _check_vector(who, "direction", lamp.direction)
    if lamp.position_mm is not None:
        _check_vector(who, "position_mm", lamp.position_mm)
    if len(lamp.colour) != 3 or not all(0 <= part <= 1e6 for part in lamp.colour) or not any(lamp.colour):
        raise InputError(f"{who}: colour must be three numbers of at least 0, not all 0, not {lamp.colour}")
    for key, power in (("power", lamp.power), ("power_max", lamp.power_max)):
        if power is not None and not POWER_MIN <= power <= POWER_MOST:
            raise InputError(f"{who}: {key} must lie between {POWER_MIN:g} and 1e6, not {power:g}")
    if not 0 <= lamp.size_deg < 90:
        raise InputError(f"{who}: size_deg must be at least 0 and below 90, not {lamp.size_deg:g}")
    if lamp.position_mm is None and lamp.full_at_mm < math.inf:
        raise InputError(
            f"{who}: full_at_mm is for point lamps, and parallel light is the same everywhere: leave it out"
        )
    _check_fading(who, lamp.reach_mm, lamp.falloff_mm)
    _check_least(who, "full_at_mm", lamp.full_at_mm, 0, above=True)


def _check_screen(screen: Screen) -> None:
    who = f"screen {screen.name!r}"
    if screen.normal is None:
        _check_vector(who, "centre_mm", screen.centre_mm)
    else:
        _check_vector(who, "normal", screen.normal)
    if len(screen.centre_mm) != 3 or not math.hypot(*screen.centre_mm) <= _MOST:
        raise InputError(f"{who}: centre_mm must be three finite numbers not beyond {_MOST:g}, not {screen.centre_mm}")
    for length in screen.size_mm:
        _check_least(who, "size_mm", length, 0, above=True)
    if not _LEAST <= screen.pitch_mm <= _MOST:
        raise InputError(f"{who}: pitch_mm must lie between {_LEAST:g} and {_MOST:g}, not {screen.pitch_mm:g}")
    if not max(screen.size_mm) / screen.pitch_mm <= MOST_PIXELS:
        raise InputError(f"{who}: more than {MOST_PIXELS} pixels along a side: make it smaller, or pitch_mm larger")
    if screen.up is not None:
        _check_vector(who, "up", screen.up)
        if np.linalg.norm(np.cross(unit(screen.up), screen.facing)) < 1e-6:
            raise InputError(f"{who}: up must not point straight out of the screen, {screen.up}")
    _check_fading(who, screen.reach_mm, screen.falloff_mm)
    if not BLACK <= screen.black < 1:
        raise InputError(
            f"{who}: black must be a display value from {BLACK:.4f}, half a level, to below 1, not {screen.black:g}"
        )
