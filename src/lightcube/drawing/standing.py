"""What stands where in the room at a turntable angle: the cube, the screens and the lamps.

Lengths are mm. The room's axes is the cube's at angle 0. Where the table carries the cube, what the rig says in
the cube's axes is turned with it; where the cube stands still, the two are one.
"""

from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing.stacks import films_at, lowered, sheets
from lightcube.forward.turning import moment
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.optics.views import Views, rotations, unit

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
    """What stands where at an angle, in the room's axes; `films` is where those of a stack lie (`tables.Stops`)."""

    turn: Reals
    axis: Reals
    screens: tuple[PlacedScreen, ...]
    lamps: tuple[PlacedLamp, ...]
    films: Reals = field(default_factory=lambda: np.zeros((0, 7)))


def drawn(cube: Cube) -> Cube:
    """The cube with every picture that its rig shows, and endless screens where they can be seen: behind the cube.

    Where level light shows every picture again half a turn on, mirrored, there are as many pictures more. Parallel
    light without a disc casts the same shadow on every parallel screen; those of glass stand far behind it anyway. It
    keeps no targets. A stack's pictures lie on a sheet below it (`lightcube.drawing.stacks`).
    """
    if isinstance(cube.grid, Stack):
        return replace(cube, rig=lowered(cube.grid, cube.rig), targets=None)
    rig = cube.rig.both_sides
    times = len(rig) // len(cube.rig)
    light = rig.views.lamps[:, :3]
    level = np.hypot(light[:, 0], light[:, 1])
    anywhere = rig.screens.endless[rig.stops.screen][rig.sums.picture] & (rig.sums.disc_deg == 0) & (rig.glass is None)
    away = np.where(anywhere, _BEHIND * cube.grid.size_mm[1] / np.maximum(level, 1e-9), 0.0)
    views = replace(rig.views, origins_mm=rig.views.origins_mm + away[:, None] * light)
    powers, names = np.tile(cube.powers, (times, 1)), times * cube.names
    return replace(cube, rig=replace(rig, views=views), lamp_powers=powers, names=names, targets=None)


def standing(cube: Cube, angle_deg: float) -> Standing:
    """Where the cube, the screens and the lamps stand at an angle (degrees)."""
    cube = drawn(cube)
    rig, powers = moment(cube, [angle_deg])
    turn = rotations(rig.turning.axis, np.array([angle_deg if carries_cube(rig) else 0.0]))[0]
    starts = rig.starts
    screens = []
    for picture, pixels in enumerate(rig.stops.window):
        its = slice(starts[picture], starts[picture + 1])
        middle = rig.views.origins_mm[its].mean(axis=0)  # of a pixel's samples
        screens.append(_placed(turn, middle, rig.views, starts[picture], (int(pixels[0]), int(pixels[1]))))
    light = powers[rig.pair] * rig.sums.share
    lamps = []
    for number in range(len(rig.lamps.names)):
        if not np.any(cube.rig.sums.lamp == number):
            continue
        place, parallel = _lamp_place(cube.rig, number, angle_deg)
        lamps.append(PlacedLamp(turn @ place, parallel, light[rig.sums.lamp == number].sum(axis=0)))
    axis = rig.turning.axis * (1 if rig.turning.axis[2] >= 0 else -1)
    films = films_at(cube.grid, cube.rig, angle_deg) if isinstance(cube.grid, Stack) else np.zeros((0, 7))
    return _clear(cube.grid, Standing(turn, unit(axis), tuple(screens), tuple(lamps), films))


def carries_cube(rig: Rig) -> bool:
    """Whether the table carries the cube."""
    return bool(np.any(rig.turning.turns & (rig.turning.way < 0)))


def _placed(turn: Reals, middle: Reals, views: Views, view: int, pixels: tuple[int, int]) -> PlacedScreen:
    """The upper left `pixels` of a view's raster, in the room."""
    right, down = views.column_steps_mm[view], views.row_steps_mm[view]
    rows, columns = views.picture_shape
    return PlacedScreen(turn @ (middle - columns / 2 * right - rows / 2 * down), turn @ right, turn @ down, pixels)


def _lamp_place(rig: Rig, number: int, angle_deg: float) -> tuple[Reals, bool]:
    """Where a lamp stands (or the way its light travels) in the cube's axes, lit or not, and whether it is the way."""
    picture = int(rig.sums.picture[np.argmax(rig.sums.lamp == number)])
    alone = rig.take([picture])
    lamps = alone.turned(angle_deg - alone.stops.angle_deg).views.lamps[
        alone.sums.lamp == number
    ]  # of a disc's samples
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
    solid = [corners_of(grid, room.turn)]
    if isinstance(grid, Stack):
        solid.append(sheets(grid, room.films).reshape(-1, 3))
    else:
        solid.append(middle + np.cos(turns) * right + np.sin(turns) * down)
    solid += [screen.corners for screen in room.screens]
    around = 0.1 * size_of(grid) * np.concatenate([np.eye(3), -np.eye(3)])
    far = _FAR * max(float(np.linalg.norm(points, axis=1).max()) for points in solid)
    return np.concatenate(solid + [lamp.place + around for lamp in room.lamps if np.linalg.norm(lamp.place) < far])
