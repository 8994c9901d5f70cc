"""What `play` shows: a cube's pictures at its stops or other angles, its screens side by side, or the whole room.

And how a movie goes: under a steady lamp, picture by picture, or resting on each stop under a lamp that comes and goes.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import cast

import numpy as np
from numpy.typing import NDArray

from lightcube.backward.mat import margin, widened
from lightcube.backward.recipe import recipe_of
from lightcube.drawing.eyes import camera_for
from lightcube.drawing.orbit import between, lamps_orbit, orbit_of, soft
from lightcube.drawing.poster import mat_pixels, poster
from lightcube.drawing.room import Room
from lightcube.drawing.sheet import beside_each_other, beside_targets
from lightcube.drawing.stacks import are_moved
from lightcube.drawing.tableau import Tableau
from lightcube.forward import casting
from lightcube.forward.dimming import Course, dimmed
from lightcube.forward.flicker import Flicker
from lightcube.optics.arrays import Counts
from lightcube.optics.cube import Cube
from lightcube.optics.light import Beams
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.optics.transfer import decode, encode, to_uint8
from lightcube.optics.views import Views
from lightcube.pictures.fitting import targets_of

Picture = NDArray[np.float32]
Levels = NDArray[np.uint8]
Frame = Picture | Levels

#: Pairs of neighbouring frames of a turn that tell whether it flickers.
_PAIRS = 6
#: Seconds that the eye waits, that it takes to the lamp, that the picture there gets calm, and that it stays.
_WAIT_S, _WAY_S, _CALM_S, _STAY_S = 0.5, 2.8, 0.5, 1.4
#: Frames that what changes takes at least, and the way to the lamp: else too much jumps from one to the next.
_FEWEST, _WAY = 6, 84
#: So much of its way glass is seen as one likes to see it.
_BARE = 0.35
#: A mat that is off its tone by more than this part of it is no calm one: a dark one's noise is as bright as it is.
_CALM = 0.25


@dataclass(frozen=True, eq=False)
class Show:
    """Pictures to be written, one after the other.

    Parameters
    ----------
    pictures
        ``(row, column, channel)`` each, linear light; or 8-bit display levels.
    count, rows
        How many there are, and how high.
    windows
        ``(count, 4)``: top, left, rows and columns of what was wanted in each picture; None = all of it.
    views
        Those of a turntable's, for the folder that they are written to; None = something else is shown.
    names
        One per picture, or None where they are numbered.
    """

    pictures: Iterator[Frame]
    count: int
    rows: int
    windows: Counts | None = None
    views: Views | None = None
    names: tuple[str, ...] | None = None


@dataclass(frozen=True)
class Look:
    """How screens are shown: of each the picture alone, how much finer than pixels, and in what light.

    As `lightcube.forward.casting.play` takes them.
    """

    picture_only: bool = False
    zoom: int = 1
    light: Beams = "area"

    def of(self, cube: Cube) -> Callable[[NDArray[np.float64] | None], Iterator[Picture]]:
        """A function of the angles that yields what is shown there; None = at the stops."""
        return casting.screens(cube, picture_only=self.picture_only, zoom=self.zoom, light=self.light)

    def rig(self, cube: Cube) -> Rig:
        """The cube's, with pictures as large as what is shown, in pixels."""
        return cube.rig if self.picture_only else cube.rig.whole(cube.grid)


def of_stops(cube: Cube, look: Look, *, target: bool) -> Show:
    """The pictures that a cube was made for, one by one."""
    show = _shown(cube, look, cube.rig, look.rig(cube), look.of(cube)(None), target=target)
    return replace(show, names=cube.names)


def of_turn(cube: Cube, angles_deg: NDArray[np.float64], look: Look, *, target: bool) -> Show:
    """The one screen of a cube at some angles."""
    now, whole = (rig.at(angles_deg)[0] for rig in (cube.rig, look.rig(cube)))
    return _shown(cube, look, now, whole, look.of(cube)(angles_deg), target=target)


def _shown(cube: Cube, look: Look, rig: Rig, whole: Rig, pictures: Iterator[Picture], *, target: bool) -> Show:
    """Pictures of the `whole` screen around those of a rig, each beside the wanted one if asked for."""
    rows = look.zoom * whole.picture_shape[0]
    if target:
        return Show(beside_targets(pictures, targets_of(cube), rig.stops.angle_deg, look.zoom), len(rig), rows)
    windows = look.zoom * np.hstack([rig.places_in(whole), rig.stops.window])
    return Show(pictures, len(rig), rows, windows, None if whole.elevation_deg is None else whole.views)


def of_screens(cube: Cube, angles_deg: NDArray[np.float64], look: Look) -> Show:
    """All screens of each angle side by side."""
    rig, show = look.rig(cube), look.of(cube)

    def beside() -> Iterator[Picture]:
        for angle_deg in angles_deg:
            now, _ = rig.at([angle_deg])
            yield beside_each_other(list(show(np.array([angle_deg]))), look.zoom * now.stops.window)

    return Show(beside(), len(angles_deg), look.zoom * int(rig.stops.window[:, 0].max()))


def of_room(cube: Cube, angles_deg: NDArray[np.float64], size: tuple[int, int]) -> Show:
    """The room in perspective at some angles, in frames of so many rows and columns."""
    room = Tableau(cube, size)
    return Show((room.seen(float(angle_deg)) for angle_deg in angles_deg), len(angles_deg), size[0])


def resting_room(cube: Cube, course: Course, size: tuple[int, int]) -> Show:
    """The room, whose lamps fade in, rest and fade out at each stop while the table turns in what other light there is.

    Of a stack films are moved then, if they are.

    8-bit display levels.
    """
    stops = np.unique(cube.angles_deg)
    room, grid = Tableau(cube, size), cube.grid
    moves = are_moved(grid, cube.rig) if isinstance(grid, Stack) else len(stops) > 1

    def frames() -> Iterator[Levels]:
        for here, there in zip(stops, [*stops[1:], stops[0] + 360], strict=True):
            unlit, lit = room.seen(here, lit=False), room.seen(here)
            parts = {p: decode(np.array(p, np.float32), cube.transfer) for p in course.lamp}
            levels = {p: to_uint8(unlit + part * (lit - unlit), cube.transfer) for p, part in parts.items()}
            for part in course.lamp[: len(course.lamp) - course.dark]:
                yield levels[part]
            for number in range(1, course.dark + 1):
                gone = (1 - np.cos(np.pi * number / course.dark)) / 2
                moved = room.seen(here + gone * (there - here), lit=False) if moves else unlit
                yield to_uint8(moved, cube.transfer)

    return Show(frames(), len(stops) * len(course.lamp), size[0])


def of_eye(cube: Cube, angles_deg: NDArray[np.float64], size: tuple[int, int], fps: float) -> Show:
    """The eye goes to where the lamp is, and noise becomes the picture, at each of some angles.

    There it is what the wall shows, the mean of each pixel. 8-bit display levels, from the lit room on.
    """
    room, start = Room(cube), orbit_of(camera_for(cube, size))
    course = Course.of(len(angles_deg), fps)
    wait, calm = (max(_FEWEST, round(seconds * fps)) for seconds in (_WAIT_S, _CALM_S))
    way = max(_WAY, round(_WAY_S * fps))
    fade = [decode(np.array(part / course.fade, np.float32), cube.transfer) for part in range(course.fade)]
    stay = round(_STAY_S * fps)

    def lights() -> Iterator[Picture]:
        for angle_deg in angles_deg.tolist():
            goal = lamps_orbit(*room.eyes_lamp(angle_deg), size)
            seen = room.seen(start.camera(size), angle_deg)
            yield from (part * seen for part in fade)
            yield from [seen] * wait
            for number in range(1, way + 1):
                gone = number / way
                bare = soft(np.clip((gone - _BARE) / (1 - _BARE), 0, 1))
                seen = room.seen(between(start, goal, soft(gone)).camera(size), angle_deg, bare=bare)
                yield seen
            rests = room.from_lamp(goal.camera(size), angle_deg)
            yield from (seen + number / calm * (rests - seen) for number in range(1, calm + 1))
            yield from [rests] * stay
            yield from (part * rests for part in reversed(fade))
            yield from [0 * rests] * course.dark

    count = len(angles_deg) * (2 * course.fade + wait + way + calm + stay + course.dark)
    return begun(Show((to_uint8(light, cube.transfer) for light in lights()), count, size[0]), course.fade)


def flickers(cube: Cube, angles_deg: NDArray[np.float64], look: Look) -> float:
    """How much of a wall jumps from frame to frame of a turn, 0 to 1: the mean of a few pairs of neighbours."""
    firsts = np.unique(np.linspace(0, max(len(angles_deg) - 2, 0), _PAIRS).round().astype(int))
    shares = []
    for first in firsts:
        flicker = Flicker()
        for _ in flicker.watched(of_screens(cube, angles_deg[first : first + 2], look).pictures, cube.transfer):
            pass
        shares.append(flicker.share)
    return float(np.mean(shares))


def unlike(cube: Cube, look: Look) -> float:
    """How much of a wall jumps from a stop's pictures to the next stop's, 0 to 1: the mean round the turn."""
    stops = np.unique(cube.angles_deg)
    flicker = Flicker()
    for _ in flicker.watched(of_screens(cube, np.append(stops, stops[:1]), look).pictures, cube.transfer):
        pass
    return flicker.share


def resting(cube: Cube, show: Show, course: Course) -> Show:
    """Each picture of a show, fading in, resting, and fading out into the dark: 8-bit display levels."""
    frames = dimmed(cast("Iterator[Picture]", show.pictures), course, cube.transfer)
    return Show(frames, show.count * len(course.lamp), show.rows)


def begun(show: Show, frame: int) -> Show:
    """The same loop from another of its frames on: what a movie is known by, before it plays, is its first."""

    def frames() -> Iterator[Frame]:
        before = list(islice(show.pictures, frame))
        yield from show.pictures
        yield from before

    return replace(show, pictures=frames())


def brightest(cube: Cube) -> float:
    """The brightest that a cube's lamps show past the cube, in display values."""
    rig = cube.rig
    light = np.max(cube.powers[rig.pair] * rig.sums.share, axis=1)
    return float(encode(np.bincount(rig.sums.picture, light).max(keepdims=True), cube.transfer)[0])


def shaped(cube: Cube, show: Show, size: tuple[int, int], captions: Sequence[str] | None) -> Show:
    """The same, large in a black frame of so many rows and columns, with names below if there are any.

    Of what surrounds the pictures only a calm mat is seen.
    """
    mat = show.windows is not None and bool(np.any(show.windows[:, :2])) and has_calm_mat(cube)

    def framed() -> Iterator[Picture]:
        pictures, begun = cast("Iterator[Picture]", show.pictures), show.windows
        for number, picture in enumerate(pictures):
            window = np.array([0, 0, *picture.shape[:2]]) if begun is None else begun[number]
            yield poster(picture, window, size, cube.transfer, captions[number] if captions else "", mat=mat)

    return Show(framed(), show.count, size[0])


def has_calm_mat(cube: Cube) -> bool:
    """Whether the mats that a cube was made with are calm as far as a poster shows them, at the stops, on the whole."""
    mat, shape = recipe_of(cube).mat, cube.rig.picture_shape
    wide, spare = mat_pixels(shape), margin(cube.rig, cube.grid, mat)
    if mat is None or min(spare) < wide:
        return False
    rig = widened(cube.rig, cube.grid, mat)
    around = np.zeros(rig.picture_shape, bool)
    for more, seen in ((wide, True), (0, False)):
        rows, columns = (slice(edge - more, edge + own + more) for edge, own in zip(spare, shape, strict=True))
        around[rows, columns] = seen
    off = [np.mean((encode(picture[around], cube.transfer) - mat.tone) ** 2) for picture in casting.cast(cube, rig)]
    return float(np.sqrt(np.mean(off))) <= _CALM * mat.tone


def captions_of(cube: Cube, angles_deg: NDArray[np.float64]) -> list[str]:
    """What stands below the pictures of each stop: their names, without the numbers that put files in order."""
    names = [re.sub(r"^\d+[-_. ]+(?=\S)", "", name).replace("_", " ") for name in cube.names]
    return [
        " · ".join(name for name, own in zip(names, cube.angles_deg, strict=True) if own == angle_deg)
        for angle_deg in angles_deg
    ]
