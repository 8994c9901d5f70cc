"""How a movie of a cube goes: resting on each stop under a lamp that comes and goes, or evenly under a steady lamp."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing import shows
from lightcube.drawing.poster import SIZES, Format
from lightcube.drawing.shows import Frame, Look, Show
from lightcube.errors import InputError
from lightcube.forward.dimming import Course
from lightcube.forward.flicker import Flicker
from lightcube.forward.turning import turn
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.light import Beams
from lightcube.optics.stack import Stack
from lightcube.optics.transfer import Transfer

Angles = NDArray[np.float64]

#: Frames a second where nothing is said.
FPS = 30.0
#: Small frames are so many times less wide and high.
_LESS = 3
#: Stops whose pictures flow into each other differ in so much of the wall at most.
_ALIKE = 0.15
#: Rows and columns of a room's frames where nothing is said, and seconds that the table turns between two stops.
ROOM, _TURN_S = (540, 960), 0.7

#: The pictures on the wall, the room in which it stands, or the way of an eye through it to where the lamp is.
View = Literal["wall", "room", "eye"]


@dataclass(frozen=True, eq=False)
class Film:
    """Frames of a movie, which `lightcube.save` takes as they come, once.

    Parameters
    ----------
    show
        The frames.
    fps
        So many a second.
    transfer
        How linear light becomes display values.
    said
        In a sentence, how it goes.
    flicker
        How much of it jumps from frame to frame: 0 until they came.
    """

    show: Show
    fps: float
    transfer: Transfer
    said: str = ""
    flicker: Flicker = field(default_factory=Flicker)

    def __len__(self) -> int:
        """How many frames there are."""
        return self.show.count

    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames: linear light, or 8-bit display levels."""
        return self.flicker.watched(self.show.pictures, self.transfer)

    @property
    def warning(self) -> str:
        """A sentence where what came flickers, else nothing."""
        if not self.flicker.is_much:
            return ""
        return (
            f"this flickers: {self.flicker.share:.0%} of the pixels jump by a fifth of the range or more from a frame "
            "to the next, which does harm to some who look at it: leave out --even, --stops and angles, and the lamp "
            "rests on the stops"
        )


def size_of(format: Format, *, small: bool = False) -> tuple[int, int]:  # noqa: A002
    """Rows and columns of a format's frames, or of frames a third as wide and high."""
    rows, columns = SIZES[format]
    return (rows // _LESS, columns // _LESS) if small else (rows, columns)


def frames_of(output: str, shape: Format | None, fps: float | None = None) -> tuple[tuple[int, int] | None, float]:
    """Rows and columns of a format's frames, and how many a second; a GIF is a third as wide and as fast: small."""
    small = shape is not None and output.lower().endswith(".gif")
    size = None if shape is None else size_of(shape, small=small)
    return size, (FPS / 3 if small else FPS) if fps is None else fps


@checked
def film(
    cube: Cube,
    *,
    view: View = "wall",
    format: Format | None = None,  # noqa: A002 - what people call it
    captions: bool = False,
    even: bool = False,
    picture_only: bool = False,
    zoom: int = 1,
    light: Beams = "area",
    fps: float = FPS,
) -> Film:
    """Make the frames of a movie that loops: ``lc.save(lc.film(cube), "turn.mp4", fps=30)``.

    The lamp fades in on a stop, rests for a second and fades out, and the table turns in the dark to the next: what a
    wall shows under a lamp that is dimmed. Where pictures flow into each other it turns evenly, under a steady lamp.

    Parameters
    ----------
    view
        ``"room"``: the room in perspective, with lamps, glass, walls, and the light on its way between them, and the
        pictures beside it. ``"eye"``: the eye goes to where the lamp is, and noise becomes the first stop's picture.
    format
        ``"square"``, ``"portrait"`` or ``"wide"``: the picture large in the dark, 1080 x 1080, 1080 x 1920 or
        1920 x 1080 pixels; None = the whole screen, a pixel each.
    captions
        Whether names stand below the pictures; they need a format.
    even
        Turn evenly under a steady lamp in any case.
    picture_only, zoom, light
        As `lightcube.play` takes them.
    fps
        Frames a second.

    Examples
    --------
    >>> import lightcube as lc, numpy as np
    >>> grid = lc.Grid((4, 6, 6))
    >>> cube = lc.Cube(np.zeros((3, 4, 6, 6), np.float32), grid, lc.turntable(grid, [20, 80], picture_shape=(4, 4)))
    >>> film = lc.film(cube)
    >>> len(film), film.said[:37]
    (120, 'the pictures flow into each other (0.')
    """
    style = Style(None if format is None else size_of(format), captions, fps, view)
    return filmed(cube, Look(picture_only, zoom, light), style, turn(cube), even=even)


@dataclass(frozen=True)
class Style:
    """How a movie looks.

    Parameters
    ----------
    size
        Rows and columns of a frame that the picture stands large in; None = the screen alone.
    captions
        Whether names stand below the pictures.
    fps
        Frames a second.
    view
        The wall, the room, or an eye on its way to the lamp.
    """

    size: tuple[int, int] | None = None
    captions: bool = False
    fps: float = FPS
    view: View = "wall"

    def __post_init__(self) -> None:
        if not (math.isfinite(self.fps) and 1e-3 <= self.fps <= 1000):
            raise InputError(f"frames per second must be a number from 0.001 to 1000, not {self.fps}")
        if self.captions and self.view != "wall":
            raise InputError("captions stand below pictures on the wall: leave them out, or show the wall")
        if self.captions and self.size is None:
            raise InputError("captions stand in the dark around a picture: give a format too, square, portrait or wide")


def filmed(
    cube: Cube, look: Look, style: Style, turned: Angles, *, even: bool, target: bool = False, screens: bool = False
) -> Film:
    """The film of a cube.

    Parameters
    ----------
    turned
        Angles of an even turn, degrees.
    even
        Turn evenly in any case.
    target, screens
        As `lightcube.drawing.shows` has them: the wanted picture beside each, all screens side by side.
    """
    if style.view == "eye":
        return to_the_lamp(cube, style, cube.angles_deg[:1])
    beside = screens or len(cube.rig.screens.names) > 1
    may_flow = bool(np.any(cube.rig.turning.turns)) and not even and len(turned) > 1
    may_flow = may_flow and shows.unlike(cube, look) <= _ALIKE
    share = shows.flickers(cube, turned, look) if may_flow else 1.0
    if even or share <= Flicker.MUCH:
        if style.view == "room":
            steady = in_room(cube, style, turned)
            return steady if even else replace(steady, said=_flows(share))
        show = shows.of_screens(cube, turned, look) if beside else shows.of_turn(cube, turned, look, target=target)
        steady = styled(cube, show, style, turned)
        return steady if even else replace(steady, said=_flows(share))
    stops = np.unique(cube.angles_deg)
    if style.view == "room":
        course = Course.of(len(stops), style.fps, 1.0, _TURN_S)
        show = shows.resting_room(cube, course, style.size or ROOM)
        return _resting(show, course, len(stops), style, cube)
    show = shows.of_screens(cube, stops, look) if beside else shows.of_stops(cube, look, target=target)
    lit = styled(cube, show, style, stops if beside else cube.angles_deg)
    course = Course.of(show.count, style.fps, shows.brightest(cube) if style.size is None else 1.0)
    return _resting(shows.resting(cube, lit.show, course), course, show.count, style, cube)


def _resting(show: Show, course: Course, stops: int, style: Style, cube: Cube) -> Film:
    """The film of a lamp that comes and goes, from the middle of its first rest on."""
    begun = shows.begun(show, course.fade + course.rest // 2)
    return Film(begun, style.fps, cube.transfer, _rests(stops, course, cube))


def styled(cube: Cube, show: Show, style: Style, angles_deg: Angles) -> Film:
    """The film whose frames are the pictures of a show, each at its angle."""
    if style.size is not None:
        names = shows.captions_of(cube, angles_deg) if style.captions else None
        show = shows.shaped(cube, show, style.size, names)
    return Film(show, style.fps, cube.transfer)


def in_room(cube: Cube, style: Style, angles_deg: Angles) -> Film:
    """The film whose frames are the room at some angles."""
    return Film(shows.of_room(cube, angles_deg, style.size or ROOM), style.fps, cube.transfer)


def to_the_lamp(cube: Cube, style: Style, angles_deg: Angles) -> Film:
    """The film of an eye that goes to where the lamp is, at each of some angles."""
    show = shows.of_eye(cube, angles_deg, style.size or ROOM, style.fps)
    times = "" if len(angles_deg) == 1 else f", {len(angles_deg)} times"
    said = (
        f"{show.count / style.fps:.0f} s: the eye goes to where the lamp is{times}, and noise becomes the picture; "
        "there it is as the wall has it"
    )
    return Film(show, style.fps, cube.transfer, said)


def _flows(share: float) -> str:
    return (
        f"the pictures flow into each other ({share:.1%} of the pixels jump from a frame to the next), so the table "
        "turns evenly under a steady lamp"
    )


def _rests(stops: int, course: Course, cube: Cube) -> str:
    rest_s, all_s = course.rest / course.fps, stops * course.seconds
    what, then = "stops", ", and the table turns in the dark to the next"
    if isinstance(cube.grid, Stack):
        what, then = "pictures", ", and the next one is made ready in the dark"
    many = f"at each of {stops} {what}" if stops > 1 else "on the one stop"
    dark = then if stops > 1 else ""
    return (
        f"{all_s:.0f} s: {many} the lamp fades in, rests for {rest_s:.2g} s and fades out, as a wall shows it under a "
        f"lamp that is dimmed{dark}"
    )
