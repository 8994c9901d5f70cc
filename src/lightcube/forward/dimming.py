"""A lamp that comes and goes: it fades in on a stop, rests, fades out, and the table turns in the dark to the next.

What is shown is what a wall shows under a dimmed lamp: the light times the lamp's part, and then the display's curve.
A fade is even in display values, which is how the eye takes it: of sRGB and of a plain power alike a part of the light
is nearly a part of the display value, so no pixel changes faster than the lamp does.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.transfer import Transfer, decode, encode, to_uint8

Picture = NDArray[np.float32]
Levels = NDArray[np.uint8]

#: Seconds that the lamp fades, that it rests, and that a wall stays dark.
FADE_S, REST_S, DARK_S = 0.6, 1.0, 0.25
#: Seconds that all stops may take before they are shown more briefly, and the least part of their time that stays: a
#: stop is then shown for 1.1 s, a third of what would be three flashes a second.
LONG_S, LEAST = 60.0, 0.45
#: A fade has so many frames at least: white changes by a sixth of the range from one to the next. Where a lamp is
#: brighter than white it has so many for each white, so that no pixel jumps by a fifth; up to so many, from which on
#: few frames have pixels that do.
_FRAMES, _EACH, _MOST_FRAMES = 6, 5, 45
#: Display values are known in such steps, up to so many times white.
_STEPS, _MOST = 8192, 7.999


@dataclass(frozen=True)
class Course:
    """How the lamp comes and goes at each stop.

    Parameters
    ----------
    fade, rest, dark
        Frames: of a fade in or out, of the rest between them, and in the dark after them.
    fps
        Frames a second.
    """

    fade: int
    rest: int
    dark: int
    fps: float

    @classmethod
    def of(cls, stops: int, fps: float, bright: float = 1.0, dark_s: float = DARK_S) -> Course:
        """The course for so many stops: where there are many, shorter at each, so that it stays watchable.

        Parameters
        ----------
        bright
            The brightest that is shown, in display values.
        dark_s
            Seconds in the dark.
        """
        whole = 2 * FADE_S + REST_S + dark_s
        part = float(np.clip(LONG_S / (stops * whole), LEAST, 1.0))
        least = max(_FRAMES, min(math.ceil(_EACH * bright) + 1, _MOST_FRAMES))
        fade, rest, dark = (round(part * s * fps) for s in (FADE_S, REST_S, dark_s))
        return cls(max(least, fade), max(1, rest), max(1, dark), fps)

    @property
    def lamp(self) -> tuple[float, ...]:
        """The lamp's part of its light at each frame of a stop, in display values; the first and the last are dark."""
        fade = np.arange(self.fade) / self.fade
        return (*fade.tolist(), *[1.0] * self.rest, *fade[::-1].tolist(), *[0.0] * self.dark)

    @property
    def seconds(self) -> float:
        """Of one stop."""
        return len(self.lamp) / self.fps


def dimmed(pictures: Iterable[Picture], course: Course, transfer: Transfer) -> Iterator[Levels]:
    """Yield 8-bit display levels of each picture under the lamp of each frame of its stop.

    Parameters
    ----------
    pictures
        One a stop, linear light.
    """
    tables = {part: _table(part, transfer) for part in course.lamp}
    for picture in pictures:
        codes = (np.clip(encode(picture, transfer), 0, _MOST) * _STEPS).astype(np.uint16)
        shown = {part: table[codes] for part, table in tables.items()}
        for part in course.lamp:
            yield shown[part]


def _table(part: float, transfer: Transfer) -> Levels:
    """Display levels of all display values under a lamp that shows white as `part`."""
    light = decode(np.arange(2**16) / _STEPS + 0.5 / _STEPS, transfer)
    return to_uint8(light * decode(np.array(part), transfer), transfer)
