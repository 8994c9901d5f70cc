"""Pictures to try the studio with: photographs, letters, and a ball that bounces."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.transfer import decode
from lightcube.studio.kept import smaller

Images = list[tuple[NDArray[np.float32], str]]
_Stroke = tuple[tuple[float, float], tuple[float, float]]

#: Pixels along a side of what is drawn; strokes are made this many times finer, and averaged.
_SIDE, _FINE = 240, 3
#: Letters as strokes on a field of 4 x 6, and the colour of each, in display values.
_LETTERS: dict[str, tuple[list[_Stroke], tuple[float, float, float]]] = {
    "L": ([((0, 0), (0, 6)), ((0, 6), (4, 6))], (0.90, 0.30, 0.22)),
    "I": ([((2, 0), (2, 6)), ((0.8, 0), (3.2, 0)), ((0.8, 6), (3.2, 6))], (0.96, 0.68, 0.20)),
    "N": ([((0, 6), (0, 0)), ((0, 0), (4, 6)), ((4, 6), (4, 0))], (0.22, 0.64, 0.42)),
    "E": ([((0, 0), (0, 6)), ((0, 0), (4, 0)), ((0, 3), (3.2, 3)), ((0, 6), (4, 6))], (0.24, 0.44, 0.86)),
    "A": ([((0, 6), (2, 0)), ((2, 0), (4, 6)), ((0.9, 3.6), (3.1, 3.6))], (0.60, 0.32, 0.76)),
}
_WORD, _BALLS = "LINEA", 8


@dataclass(frozen=True)
class Sample:
    """A set of pictures: what people call it, and what makes it."""

    title: str
    make: Callable[[], Images]


def _photographs() -> Images:
    """Six photographs that come with scikit-image."""
    from lightcube.pictures.samples import photographs  # here: it reads them

    found, wanted = photographs(16), ("astronaut", "coffee", "cat", "rocket", "retina", "colours")
    return [(smaller(found.images[found.names.index(name)]), name) for name in wanted]


def _letters() -> Images:
    """The letters of a word, dark on light, each in a colour of its own."""
    return [(_letter(letter), letter) for letter in _WORD]


def _letter(letter: str) -> NDArray[np.float32]:
    strokes, colour = _LETTERS[letter]
    across, down = _field()
    far = np.full(across.shape, np.inf)
    for (x0, y0), (x1, y1) in strokes:
        along = ((across - x0) * (x1 - x0) + (down - y0) * (y1 - y0)) / ((x1 - x0) ** 2 + (y1 - y0) ** 2)
        along = np.clip(along, 0, 1)
        far = np.minimum(far, np.hypot(across - x0 - along * (x1 - x0), down - y0 - along * (y1 - y0)))
    return _painted([(far < 0.55, colour)])


def _ball() -> Images:
    """A ball that bounces, once round."""
    across, down = _field()
    made = []
    for number in range(_BALLS):
        part = number / _BALLS
        height = 4 * part * (1 - part)
        x, y = 2 + 1.5 * math.sin(2 * math.pi * part), 5.4 - 4.4 * height
        ball = np.hypot(across - x, down - y) < 0.95
        shadow = np.hypot((across - x) / (0.95 - 0.3 * height), (down - 6.6) / 0.22) < 1
        made.append((_painted([(shadow, (0.66, 0.65, 0.68)), (ball, (0.88, 0.32, 0.16))]), f"ball {number + 1}"))
    return made


def _field() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places across and down of all fine pixels, where letters stand in the middle."""
    fine = (np.arange(_SIDE * _FINE) + 0.5) / (_SIDE * _FINE) * 8.4
    shape = len(fine), len(fine)
    return np.broadcast_to(fine - 2.2, shape), np.broadcast_to((fine - 1.2)[:, None], shape)


def _painted(shapes: list[tuple[NDArray[np.bool_], tuple[float, float, float]]]) -> NDArray[np.float32]:
    """Shapes in their colours on warm white, in linear light."""
    picture = np.empty((_SIDE * _FINE, _SIDE * _FINE, 3), np.float32)
    picture[:] = decode(np.array((0.96, 0.94, 0.90), np.float32))
    for inside, colour in shapes:
        picture[inside] = decode(np.array(colour, np.float32))
    return picture.reshape(_SIDE, _FINE, _SIDE, _FINE, 3).mean(axis=(1, 3))


SAMPLES = {
    "photographs": Sample("Six photographs", _photographs),
    "letters": Sample("Five letters", _letters),
    "ball": Sample("A bouncing ball", _ball),
}
