"""The room, and beside it what stands on its walls, large: as one sees it who stands before them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from PIL import Image, ImageDraw

from lightcube.drawing.camera import FINE, Camera, Canvas, Floats, Reals
from lightcube.drawing.eyes import camera_for
from lightcube.drawing.furniture import draw_wall
from lightcube.drawing.room import Room
from lightcube.drawing.standing import PlacedScreen, standing
from lightcube.optics.cube import Cube
from lightcube.optics.views import unit

#: The walls' part of a picture where they stand to the right of the room, as in a wide one, and where they stand below.
_RIGHT, _BELOW = 0.36, 0.47
#: A picture is wide that has at most so many rows for each column; more walls than so many have no place beside a room.
_WIDE, _MOST = 0.8, 3
#: A picture's part of its wall's place, and how strong the threads are that lead to it.
_SPAN, _THREAD = 0.84, 0.15
#: A wall that fills its place goes on so many times as far beyond its picture as the eye is away.
_WALL = 4.0
#: Samples along a pixel's side of a thread.
_SOFT = 4


def tableau(cube: Cube, angle_deg: float, size: tuple[int, int]) -> Floats:
    """What `Tableau.seen` shows at a turntable angle (degrees), in so many rows and columns."""
    return Tableau(cube, size).seen(angle_deg)


@dataclass(frozen=True)
class _Part:
    """A part of a picture."""

    top: int
    left: int
    rows: int
    columns: int

    def of(self, picture: Floats) -> Floats:
        return picture[self.top : self.top + self.rows, self.left : self.left + self.columns]


def _divided(size: tuple[int, int], count: int) -> tuple[_Part, list[_Part]]:
    """The room's part of a picture, and those of so many walls: none where they are too many."""
    rows, columns = size
    if count > _MOST:
        return _Part(0, 0, rows, columns), []
    if rows <= _WIDE * columns:
        left = columns - round(_RIGHT * columns)
        ends = np.linspace(0, rows, count + 1).astype(int)
        walls = [_Part(a, left, b - a, columns - left) for a, b in pairwise(ends)]
        return _Part(0, 0, rows, left), walls
    top = rows - round(_BELOW * rows)
    ends = np.linspace(0, columns, count + 1).astype(int)
    return _Part(0, 0, top, columns), [_Part(top, a, rows - top, b - a) for a, b in pairwise(ends)]


class Tableau:
    """A cube's room and its walls in one picture, to be drawn at any angle.

    Parameters
    ----------
    size
        Rows and columns of the picture.
    like
        Another cube's, from whose place this one is seen: None = from where it is seen best.
    """

    def __init__(self, cube: Cube, size: tuple[int, int], like: Tableau | None = None) -> None:
        self._cube, self._size, self._room = cube, size, Room(cube)
        screens = standing(cube, float(cube.angles_deg[0])).screens
        self._own, self._walls = _divided(size, len(screens))
        own = self._own.rows, self._own.columns
        self._camera: Camera = camera_for(cube, own) if like is None else like._camera
        self._below = self._own.columns == size[1]
        across = [Canvas(self._camera).seen(screen.corners.mean(axis=0))[0, 0] for screen in screens]
        self._order = np.argsort(across if self._below else np.negative(across))  # so that few threads cross

    def seen(self, angle_deg: float, *, lit: bool = True) -> Floats:
        """The picture at a turntable angle (degrees), ``(row, column, 3)`` linear light.

        Parameters
        ----------
        lit
            Whether the lamps are on; else the walls are dark.
        """
        picture = np.zeros((*self._size, 3), np.float32)
        self._own.of(picture)[...] = self._room.seen(self._camera, angle_deg, lit=lit)
        screens = standing(self._cube, angle_deg).screens
        shown = self._room.shown(angle_deg, lit=lit)
        ends: list[Reals] = []
        for part, number in zip(self._walls, self._order, strict=False):
            screen = screens[number]
            canvas = Canvas(_before(screen, part))
            draw_wall(canvas, screen, _WALL * float(np.linalg.norm(canvas.eye - screen.corner)), shown[number])
            part.of(picture)[...] = canvas.picture()
            near, far = (each.seen(screen.corners)[:, :2] / FINE for each in (canvas, Canvas(self._camera)))
            # the two corners on the side from which the threads come: the others would cross the picture
            ends += [np.stack([far[i], near[i] + (part.left, part.top)]) for i in ((0, 1) if self._below else (0, 3))]
        if lit and ends:
            picture += _THREAD * _drawn(ends, self._size)[..., None] * (1 - picture)
        return picture


def _before(screen: PlacedScreen, part: _Part) -> Camera:
    """A camera that stands squarely before a screen."""
    across, below = (count * step for count, step in zip(screen.pixels[::-1], (screen.right, screen.down), strict=True))
    wide, high = float(np.linalg.norm(across)), float(np.linalg.norm(below))
    half = max(wide, high * part.columns / part.rows) / 2 / _SPAN
    middle, away = screen.corners.mean(axis=0), 4 * max(wide, high)
    eye, up = middle + away * screen.facing, -unit(screen.down)
    field = 2 * math.degrees(math.atan(half / away))
    return Camera(tuple(eye), tuple(middle), tuple(up), field, (part.rows, part.columns))


def _drawn(lines: list[Reals], size: tuple[int, int]) -> Floats:
    """``(row, column)`` from 0 to 1: thin lines between pairs of places."""
    sheet = Image.new("L", (_SOFT * size[1], _SOFT * size[0]))
    for ends in lines:
        ImageDraw.Draw(sheet).line([tuple(_SOFT * end) for end in ends], 255, _SOFT)
    return np.asarray(sheet.reduce(_SOFT), np.float32) / np.float32(255)
