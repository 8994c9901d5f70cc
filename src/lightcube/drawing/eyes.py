"""From where a room is seen: the eye that sees lamp, glass and pictures best."""

import math
from itertools import product

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing import tones
from lightcube.drawing.camera import Camera, Reals, fitting
from lightcube.drawing.standing import Standing, corners_of, extent, size_of, standing
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.stack import Stack
from lightcube.optics.views import unit

#: Angles that stand for all that the table comes to, degrees.
AROUND = tuple(np.arange(0.0, 360.0, 30.0))
#: Degrees: what the picture's width spans, how high the eye may stand, and the azimuths that it is tried at.
_FIELD, _HEIGHTS, _AZIMUTHS = 36.0, (10.0, 27.0, 48.0), tuple(np.arange(7.5, 360.0, 15.0))
#: Over films the eye stands so high: it looks between them, and onto the sheet below.
_OVER_FILMS = (27.0, 34.0)
#: Stops at which eyes are tried at most.
_MOST_STOPS = 12
#: Parts of the picture that stay free at its edges; what standing high costs, and what the first stop is worth more.
_MARGIN, _HIGH, _FIRST = 0.05, 0.12, 0.1
#: What it is worth that screens stand to the right: one reads on from the lamp, through the glass, to the picture.
_RIGHT = 0.03
#: What it is worth that what stands on a level screen is not upside down.
_UPRIGHT = 0.4


def camera_for(cube: Cube, size: tuple[int, int] = (540, 960)) -> Camera:
    """A camera that sees the cube, all screens and all lamps at every angle of the table, from above.

    Of eyes all around, it is the one that sees most of the screens' lit sides at the cube's stops, past the cube, the
    lamps and other screens. Where that is alike all around, as with a lamp that circles, the first stop is seen best.

    Parameters
    ----------
    size
        Rows and columns of its picture.
    """
    stops = np.unique(cube.angles_deg)
    rooms = [standing(cube, stop) for stop in stops[:: math.ceil(len(stops) / _MOST_STOPS)]]
    others = [standing(cube, angle_deg) for angle_deg in AROUND]
    points = np.concatenate([extent(cube.grid, room) for room in rooms + others])
    across = math.tan(math.radians(_FIELD) / 2)
    best, chosen = -math.inf, (np.ones(3), np.zeros(3))
    heights = _OVER_FILMS if isinstance(cube.grid, Stack) else _HEIGHTS
    for height, azimuth in product(heights, _AZIMUTHS):
        above, around = math.radians(height), math.radians(azimuth)
        ahead = -np.array([math.cos(above) * math.cos(around), math.cos(above) * math.sin(around), math.sin(above)])
        right = unit(np.cross(ahead, (0.0, 0.0, 1.0)))
        axes = np.stack([right, np.cross(right, ahead), ahead])
        eye = fitting(points, axes, (across, across * size[0] / size[1]), _MARGIN)
        seen = [_worth(cube.grid, room, eye) for room in rooms]
        aside = np.mean([np.sign(np.mean(screen.corners, axis=0) @ right) for room in rooms for screen in room.screens])
        level = np.mean([unit(-screen.down)[:2] @ ahead[:2] for room in rooms for screen in room.screens])
        turned = _UPRIGHT * float(level) + _RIGHT * float(aside)
        worth = float(np.mean(seen)) + _FIRST * seen[0] - _HIGH * (height == _HEIGHTS[-1]) + turned
        if worth > best + 1e-9:
            best, chosen = worth, (eye, eye - (eye @ ahead) * ahead)
    eye, target = chosen
    return Camera((eye[0], eye[1], eye[2]), (target[0], target[1], target[2]), (0.0, 0.0, 1.0), _FIELD, size)


def _worth(grid: Grid, room: Standing, eye: Reals) -> float:
    """How much of the screens' lit sides and of the cube an eye sees.

    Roots of what is seen of each screen: a second screen is worth more than more of the first.
    """
    parts = (np.arange(5) + 0.5) / 5
    spots = np.array(list(product(parts, parts)))
    places = np.array([s.corner + spots * s.pixels @ np.array([s.down, s.right]) for s in room.screens])
    ways = eye - places
    facing = np.array([screen.facing for screen in room.screens])
    slant = np.einsum("spi,si->sp", ways, facing) / np.linalg.norm(ways, axis=-1)
    points = places.reshape(-1, 3)
    hidden = _behind_screens(room, points, eye) | _behind_lamps(grid, room, points, eye)
    free = ~(hidden | _behind_cube(grid, room, points, eye)).reshape(slant.shape)
    cube = ~_behind_screens(room, corners_of(grid, room.turn), eye)
    return float(np.mean(np.sqrt(np.mean(free * np.maximum(slant, 0) ** 2, axis=1))) + np.mean(cube))


def _behind_screens(room: Standing, points: Reals, eye: Reals) -> NDArray[np.bool_]:
    """Whether a screen stands between each point and the eye."""
    hidden = np.zeros(len(points), bool)
    ways = eye - points
    for screen in room.screens:
        normal = screen.facing
        with np.errstate(divide="ignore", invalid="ignore"):
            part = (screen.corner - points) @ normal / (ways @ normal)
            places = points + part[:, None] * ways - screen.corner
            across, below = (places @ step / (step @ step) for step in (screen.right, screen.down))
            inside = (across > 0) & (across < screen.pixels[1]) & (below > 0) & (below < screen.pixels[0])
        hidden |= inside & (part > 1e-6) & (part < 1)
    return hidden


def _behind_lamps(grid: Grid, room: Standing, points: Reals, eye: Reals) -> NDArray[np.bool_]:
    """Whether a lamp or its glow stands between each point and the eye."""
    hidden = np.zeros(len(points), bool)
    ways = eye - points
    for lamp in room.lamps:
        part = np.clip(np.sum((lamp.place - points) * ways, axis=1) / np.sum(ways**2, axis=1), 0, 1)
        away = np.linalg.norm(points + part[:, None] * ways - lamp.place, axis=1)
        hidden |= away < 2 * tones.LAMP_RADIUS * size_of(grid)
    return hidden


def _behind_cube(grid: Grid, room: Standing, points: Reals, eye: Reals) -> NDArray[np.bool_]:
    """Whether the cube stands between each point and the eye."""
    half = np.array(grid.size_mm[::-1]) / 2
    starts, ways = points @ room.turn, (eye - points) @ room.turn
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = (np.array([-half, half])[:, None] - starts) / ways
    first, last = ends.min(axis=0).max(axis=1), ends.max(axis=0).min(axis=1)
    return np.asarray((first < last) & (last > 0) & (first < 1))
