"""What stands where in the room at a turntable angle: the cube, the screens and the lamps.

Lengths are mm. The room's frame is the cube's at angle 0. Where the table carries the cube, what the lighting says in
the cube's frame is turned with it; where the cube stands still, the two frames are one.
"""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from lightcube.forward.turning import exposures_at, views_at
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Lighting, turned_by
from lightcube.optics.views import Views, rotations, turn_period, turned, unit

Reals = NDArray[np.float64]

#: Where a turntable's screen stands, in widths of the cube behind its middle.
_BEHIND = 1.5
#: A lamp so many times as far from the cube as anything else need not be seen.
_FAR = 3.0


@dataclass(frozen=True)
class PlacedScreen:
    """A screen in the room: its upper left corner, steps from pixel to pixel, and how many rows and columns."""

    corner: Reals
    right: Reals
    down: Reals
    pixels: tuple[int, int]

    @property
    def corners(self) -> Reals:
        """``(4, 3)``, in order around it."""
        across, below = self.pixels[1] * self.right, self.pixels[0] * self.down
        return self.corner + np.array([0 * across, across, across + below, below])

    @property
    def facing(self) -> Reals:
        """Unit vector towards those for whom its pictures are not mirrored."""
        return unit(np.cross(self.down, self.right))


@dataclass(frozen=True)
class PlacedLamp:
    """A lamp in the room: where it is drawn, whether its light is parallel, and its light, 0 where it is off."""

    place: Reals
    parallel: bool
    light: Reals


@dataclass(frozen=True)
class Standing:
    """What stands where at an angle, in the room's frame."""

    turn: Reals
    axis: Reals
    screens: tuple[PlacedScreen, ...]
    lamps: tuple[PlacedLamp, ...]


def as_stage(cube: Cube) -> Cube:
    """The cube of a turntable as one of a stage that shows the same at every angle; a stage's cube as it is.

    Its one lamp and one screen stand still while the table turns, the screen behind the cube, where parallel light
    casts the same shadow. Where level light shows every picture again half a turn on, mirrored, there are as many
    pictures more. It keeps no targets.

    Raises
    ------
    InputError
        Where the lamps stand at several elevations.
    """
    if cube.lighting is not None:
        return cube
    views_at(cube, [0.0])  # refuses lamps at several elevations
    views, powers, names = cube.views, cube.powers, cube.names
    if turn_period(views) == 180:
        again = turned(views, 180.0)
        aside = np.sum(again.origins * again.column_steps, axis=1) / np.sum(again.column_steps**2, axis=1)
        again = replace(again, origins=again.origins - 2 * aside[:, None] * again.column_steps)
        views, powers, names = _both(views, again), np.tile(powers, (2, 1)), 2 * names
    light = views.lamps[:, :3]
    away = _BEHIND * cube.grid.size_mm[1] / np.hypot(light[:, 0], light[:, 1])
    views = replace(views, origins=views.origins + away[:, None] * light)
    count = len(views)
    lighting = Lighting(
        picture=np.arange(count),
        lamp=np.zeros(count, np.intp),
        share=np.ones((count, powers.shape[1])),
        reach_mm=np.full((count, 2), np.inf),
        falloff_mm=np.zeros((count, 2)),
        full_at_mm=np.full(count, np.inf),
        disc_deg=np.zeros(count),
        cosine=np.zeros(count, bool),
        turning=np.ones((count, 2), bool),
        way=np.full((count, 2), -1.0),
        axis=np.array([0.0, 0.0, 1.0]),
        angle=views.angles,
        screen=np.zeros(count, np.intp),
        window=np.tile(views.picture_shape, (count, 1)),
        least=np.ones(1),
        most=np.ones(1),
        lamp_names=("lamp",),
        screen_names=("screen",),
    )
    return replace(cube, views=views, lamp_powers=powers, names=names, lighting=lighting, targets=None)


def _both(first: Views, second: Views) -> Views:
    arrays = {
        name: np.concatenate([getattr(first, name), getattr(second, name)])
        for name in ("lamps", "origins", "column_steps", "row_steps")
    }
    return Views(**arrays, picture_shape=first.picture_shape)


def standing(cube: Cube, angle: float) -> Standing:
    """Where the cube, the screens and the lamps stand at an angle (degrees)."""
    cube = as_stage(cube)
    assert cube.lighting is not None  # noqa: S101 - a stage's
    views, lighting, powers = exposures_at(cube, [angle])
    carried = np.any(lighting.turning & (lighting.way < 0))
    turn = rotations(lighting.axis, np.array([angle if carried else 0.0]))[0]
    starts = lighting.starts
    screens = []
    for picture, pixels in enumerate(lighting.window):
        its = slice(starts[picture], starts[picture + 1])
        middle = views.origins[its].mean(axis=0)  # of a pixel's samples
        screens.append(_placed(turn, middle, views, starts[picture], (int(pixels[0]), int(pixels[1]))))
    light = powers[lighting.pair] * lighting.share
    lamps = []
    for number in range(len(lighting.lamp_names)):
        if not np.any(cube.lighting.lamp == number):
            continue
        place, parallel = _lamp_place(cube, cube.lighting, number, angle)
        lamps.append(PlacedLamp(turn @ place, parallel, light[lighting.lamp == number].sum(axis=0)))
    axis = lighting.axis * (1 if lighting.axis[2] >= 0 else -1)
    return _clear(cube.grid, Standing(turn, unit(axis), tuple(screens), tuple(lamps)))


def _placed(turn: Reals, middle: Reals, views: Views, view: int, pixels: tuple[int, int]) -> PlacedScreen:
    """The upper left `pixels` of a view's raster, in the room."""
    right, down = views.column_steps[view], views.row_steps[view]
    rows, columns = views.picture_shape
    return PlacedScreen(turn @ (middle - columns / 2 * right - rows / 2 * down), turn @ right, turn @ down, pixels)


def _lamp_place(cube: Cube, lighting: Lighting, number: int, angle: float) -> tuple[Reals, bool]:
    """Where a lamp stands (or the way its light travels) in the cube's frame, lit or not, and whether it is the way."""
    picture = int(lighting.picture[np.argmax(lighting.lamp == number)])
    alone, kept = lighting.take([picture])
    moved = turned_by(cube.views.take(kept), alone, angle - lighting.angle[picture])
    lamps = moved.lamps[alone.lamp == number]  # of a disc's samples
    return lamps[:, :3].mean(axis=0), not lamps[0, 3]


def _clear(grid: Grid, room: Standing) -> Standing:
    """The same with suns on the lines of parallel light, clear of the cube."""
    screens = max(float(np.linalg.norm(screen.corners.mean(axis=0))) for screen in room.screens)
    away = max(1.45 * float(np.linalg.norm(grid.size_mm)) / 2, 0.6 * screens)
    lamps = [replace(each, place=-away * unit(each.place)) if each.parallel else each for each in room.lamps]
    return replace(room, lamps=tuple(lamps))


def size_of(grid: Grid) -> float:
    """The cube's longest side, mm."""
    return max(grid.size_mm)


def corners_of(grid: Grid, turn: Reals) -> Reals:
    """``(8, 3)``: the cube's, in the room; those whose numbers differ in one bit share an edge."""
    half = np.array(grid.size_mm[::-1]) / 2
    return np.asarray(np.array(list(product((-1, 1), repeat=3))) * half @ turn.T)


def table_of(grid: Grid, room: Standing) -> tuple[Reals, Reals, Reals]:
    """Middle of the table's disc, and two radii of it that turn with the cube."""
    corners = corners_of(grid, room.turn)
    along = corners @ room.axis
    radius = 1.12 * float(np.linalg.norm(corners - along[:, None] * room.axis, axis=1).max())
    start = np.array((1.0, 0.0, 0.0)) if abs(room.axis[0]) < 0.9 else np.array((0.0, 1.0, 0.0))
    start = room.turn @ unit(start - (start @ room.axis) * room.axis)
    return (along.min() - 0.03 * radius) * room.axis, radius * start, radius * np.cross(start, room.axis)


def extent(grid: Grid, room: Standing) -> Reals:
    """Points between which everything lies, but lamps that stand far from all else."""
    middle, right, down = table_of(grid, room)
    turns = np.radians(np.arange(0, 360, 15.0))[:, None]
    solid = [corners_of(grid, room.turn), middle + np.cos(turns) * right + np.sin(turns) * down]
    solid += [screen.corners for screen in room.screens]
    around = 0.1 * size_of(grid) * np.concatenate([np.eye(3), -np.eye(3)])
    far = _FAR * max(float(np.linalg.norm(points, axis=1).max()) for points in solid)
    return np.concatenate(solid + [lamp.place + around for lamp in room.lamps if np.linalg.norm(lamp.place) < far])
