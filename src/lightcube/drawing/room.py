"""A picture of the room in perspective: the cube of glass, its lamps, and the screens that carry its shadows."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing.beam import draw_beam, off_pictures
from lightcube.drawing.camera import FINE, Camera, Canvas, Floats, Reals, Region, fitting
from lightcube.drawing.poster import iris
from lightcube.drawing.standing import (
    PlacedLamp,
    PlacedScreen,
    Standing,
    corners_of,
    extent,
    size_of,
    standing,
    table_of,
)
from lightcube.forward.casting import screens
from lightcube.kernels.layout import columns_from_volume, pictures_from_columns
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.transfer import decode
from lightcube.optics.views import Views, unit
from lightcube.projection.projector import Projector

#: Angles that stand for all that the table comes to, degrees.
_AROUND = tuple(np.arange(0.0, 360.0, 30.0))
#: Degrees: what the picture's width spans, how high the eye may stand, and the azimuths that it is tried at.
_FIELD, _HEIGHTS, _AZIMUTHS = 36.0, (10.0, 27.0, 48.0), tuple(np.arange(7.5, 360.0, 15.0))
#: Stops at which eyes are tried at most.
_MOST_STOPS = 12
#: Parts of the picture that stay free at its edges; what standing high costs, and what the first stop is worth more.
_MARGIN, _HIGH, _FIRST = 0.05, 0.12, 0.1
#: What it is worth that screens stand to the right: one reads on from the lamp, through the glass, to the picture.
_RIGHT = 0.03
#: A lamp's radius, in widths of the cube.
_LAMP = 0.036
#: Linear light of the room and of what stands in it.
_FLOOR, _FAR, _GRID = (0.05, 0.052, 0.058), (0.009, 0.0095, 0.0115), (0.1, 0.103, 0.11)
_BACK, _FRAME, _TABLE, _RIM = (0.03, 0.03, 0.032), (0.09, 0.09, 0.095), (0.16, 0.16, 0.165), (0.25, 0.25, 0.25)
#: A wall reaches so many widths of the cube beyond its picture on each side; what it shows of the room.
_WALL, _UNLIT = 2.2, (0.05, 0.052, 0.058)
#: Glass that is denser is drawn thinner: the absorbance of a mean chord through the cube, at most.
_DENSE = 0.7
_EDGE, _DARK_LAMP = (0.75, 0.86, 1.0), (0.16, 0.16, 0.17)


def room_picture(cube: Cube, angle_deg: float, camera: Camera) -> Floats:
    """The room at a turntable angle (degrees), ``(row, column, 3)`` linear light, 1 = white."""
    return room_player(cube, camera)(angle_deg)


def room_player(cube: Cube, camera: Camera) -> Callable[..., Floats]:
    """Make a function of the angle (degrees) that shows what `room_picture` does; with ``lit=False`` lamps are off.

    What does not turn is drawn once, and the cube is laid out for casting once.
    """
    cast = screens(cube, picture_only=False, zoom=1, light="area")
    glass = columns_from_volume(cube.extinction) * _thinner(cube)
    whole = cube.rig.whole(cube.grid)
    dark = np.zeros((*whole.picture_shape, 3), np.float32)
    low = min(float(extent(cube.grid, standing(cube, angle_deg))[:, 2].min()) for angle_deg in _AROUND)
    empty = Canvas(camera)
    _floor(empty, cube.grid, low - 0.02 * size_of(cube.grid))

    known: tuple[Reals, Canvas] | None = None  # where screens stood, and the room with them, without lamps

    def show(angle_deg: float, *, lit: bool = True) -> Floats:
        nonlocal known
        now = standing(cube, angle_deg)
        if not lit:
            now = replace(now, lamps=tuple(replace(lamp, light=0 * lamp.light) for lamp in now.lamps))
        pictures = list(cast([angle_deg])) if lit else [dark] * len(now.screens)
        places = np.array([screen.corners for screen in now.screens])
        if lit or known is None or not np.allclose(known[0], places):
            canvas = empty.copy()
            for screen, picture in _on_walls(cube, angle_deg, now.screens, pictures):
                _show_screen(canvas, screen, picture)
            known = known if lit else (places, canvas.copy())
        else:
            canvas = known[1].copy()
        absorbed = _enter(canvas, cube.grid, now.turn)
        table = _table(canvas, cube.grid, now)
        _overlay(canvas, cube.grid, now, table, front=False)
        if absorbed is not None:
            _absorb(canvas, cube, glass, now.turn, absorbed)
        _overlay(canvas, cube.grid, now, table, front=True)
        if lit:
            off, rig = off_pictures(canvas, now.screens), cube.rig.at([angle_deg])[0]
            windows = rig.places_in(whole.at([angle_deg])[0])
            lamps = dict(zip(np.unique(cube.rig.sums.lamp), now.lamps, strict=True))
            for number, (screen, picture, (top, left)) in enumerate(zip(now.screens, pictures, windows, strict=True)):
                own = picture[top:, left:][: screen.pixels[0], : screen.pixels[1]]
                for lamp in np.unique(rig.sums.lamp[(rig.sums.picture == number) & np.any(rig.sums.share > 0, axis=1)]):
                    draw_beam(canvas, cube.grid, lamps[lamp], screen, own, off)
        return canvas.picture()

    return show


def _thinner(cube: Cube) -> np.float32:
    """So much thinner is glass drawn than it is, so that one sees into it."""
    size = np.array(cube.grid.size_mm)
    chord = 2 * np.prod(size) / np.sum(np.prod(size) / size)  # four times the volume over the surface
    return np.float32(min(1.0, _DENSE / max(float(np.mean(cube.extinction)) * chord, 1e-9)))


def _on_walls(
    cube: Cube, angle_deg: float, placed: tuple[PlacedScreen, ...], light: Sequence[Floats]
) -> list[tuple[PlacedScreen, Floats]]:
    """Each screen with what it shows; one without edges on a wall, with an iris that keeps light to picture and mat."""
    whole, now = cube.rig.whole(cube.grid), cube.rig.at([angle_deg])[0]
    if whole is cube.rig:
        return list(zip(placed, light, strict=True))
    shown = []
    for screen, picture, place in zip(placed, light, now.places_in(whole.at([angle_deg])[0]), strict=True):
        pixel = float(np.linalg.norm(screen.right)), float(np.linalg.norm(screen.down))
        left, top = (math.ceil(_WALL * size_of(cube.grid) / side) for side in pixel)
        corner = screen.corner - left * screen.right - top * screen.down
        wall = replace(screen, corner=corner, pixels=(screen.pixels[0] + 2 * top, screen.pixels[1] + 2 * left))
        around = np.pad(picture, ((top, top), (left, left), (0, 0)))
        part = around[place[0] :, place[1] :][: wall.pixels[0], : wall.pixels[1]]
        open_part = iris(wall.pixels, (top, left, *screen.pixels))
        away = np.linalg.norm((np.indices(wall.pixels).T + 0.5 - np.divide(wall.pixels, 2)) * pixel[::-1], axis=-1).T
        unlit = np.exp(-((away / size_of(cube.grid) / 1.6) ** 2))[..., None] * np.array(_UNLIT)
        shown.append((wall, (part * decode(open_part, cube.transfer) + unlit).astype(np.float32)))
    return shown


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
    others = [standing(cube, angle_deg) for angle_deg in _AROUND]
    points = np.concatenate([extent(cube.grid, room) for room in rooms + others])
    across = math.tan(math.radians(_FIELD) / 2)
    best, chosen = -math.inf, (np.ones(3), np.zeros(3))
    for height, azimuth in product(_HEIGHTS, _AZIMUTHS):
        above, around = math.radians(height), math.radians(azimuth)
        ahead = -np.array([math.cos(above) * math.cos(around), math.cos(above) * math.sin(around), math.sin(above)])
        right = unit(np.cross(ahead, (0.0, 0.0, 1.0)))
        axes = np.stack([right, np.cross(right, ahead), ahead])
        eye = fitting(points, axes, (across, across * size[0] / size[1]), _MARGIN)
        seen = [_worth(cube.grid, room, eye) for room in rooms]
        aside = np.mean([np.sign(np.mean(screen.corners, axis=0) @ right) for room in rooms for screen in room.screens])
        worth = float(np.mean(seen)) + _FIRST * seen[0] - _HIGH * (height > _HEIGHTS[1]) + _RIGHT * float(aside)
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
        hidden |= away < 2 * _LAMP * size_of(grid)
    return hidden


def _behind_cube(grid: Grid, room: Standing, points: Reals, eye: Reals) -> NDArray[np.bool_]:
    """Whether the cube stands between each point and the eye."""
    half = np.array(grid.size_mm[::-1]) / 2
    starts, ways = points @ room.turn, (eye - points) @ room.turn
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = (np.array([-half, half])[:, None] - starts) / ways
    first, last = ends.min(axis=0).max(axis=1), ends.max(axis=0).min(axis=1)
    return np.asarray((first < last) & (last > 0) & (first < 1))


def _floor(canvas: Canvas, grid: Grid, height: float) -> None:
    """Draw the floor, with lines as far from each other as the cube is wide; they end softly, so pixels do."""
    step = size_of(grid)
    ways = np.array([step, 0.0, 0.0]), np.array([0.0, -step, 0.0])
    solid, x, y = canvas.plane((0.0, 0.0, height), *ways, canvas.whole)
    canvas.near[...] = np.maximum(solid, 0)
    near, x, y = (each[::FINE, ::FINE] for each in (solid, x, y))
    radius = np.hypot(x, y)
    lines = np.zeros_like(near)
    for place in (x, y):
        grain = np.abs(_slope(place, 0)) + np.abs(_slope(place, 1)) + 1e-6
        line = np.clip(0.5 + (0.006 - np.abs(place - np.rint(place))) / grain, 0, 1) * np.clip(1 - 4 * grain, 0, 1)
        lines = np.maximum(lines, line)
    far, floor, bright = (np.array(each, np.float32) for each in (_FAR, _FLOOR, _GRID))
    light = floor + 0.6 * lines[..., None] * (bright - floor)
    light = far + np.exp(-((radius / 5) ** 2))[..., None] * (light - far)
    light *= 1 - 0.55 * np.exp(-((radius / 0.75) ** 2))[..., None]
    light = np.where(near[..., None] > 0, light, far)
    for i, j in product(range(FINE), repeat=2):
        canvas.light[i::FINE, j::FINE] = light


def _slope(values: Floats, axis: int) -> Floats:
    """From each number to the next one."""
    last = values.take([-1], axis)
    return np.diff(values, axis=axis, append=last)


def _show_screen(canvas: Canvas, screen: PlacedScreen, picture: Floats) -> None:
    """Draw a screen with what it shows on its lit side."""
    region = canvas.around(screen.corners)
    near, across, below = canvas.plane(screen.corner, screen.right, screen.down, region)
    rows, columns = screen.pixels
    onto = (across >= 0) & (across <= columns) & (below >= 0) & (below <= rows)
    inside = np.asarray(onto & (near > canvas.near[region]))
    canvas.near[region][inside] = near[inside]
    if (canvas.eye - screen.corner) @ screen.facing <= 0:
        canvas.light[region][inside] = _BACK
        return
    from scipy.ndimage import map_coordinates  # here: it takes longer to load than a small cube to play

    places = np.stack([below[inside], across[inside]]) - np.float32(0.5)
    for channel in range(3):
        shown = picture[:rows, :columns, min(channel, picture.shape[2] - 1)]
        canvas.light[region][inside, channel] = map_coordinates(shown, places, order=1, mode="nearest")


def _enter(canvas: Canvas, grid: Grid, turn: Reals) -> Region | None:
    """Note where rays enter the cube; return the region where they do, None where none does."""
    corners = corners_of(grid, turn)
    if np.all((corners - canvas.eye) @ canvas.axes[2] <= 0):
        return None
    region = canvas.around(corners)
    first, last = np.zeros_like(canvas.near[region]), np.full_like(canvas.near[region], np.inf)
    for axis, half in zip(turn.T, np.array(grid.size_mm[::-1]) / 2, strict=True):
        start, way = np.float32(canvas.eye @ axis), canvas.along(axis, region)
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = (np.float32(-half) - start) / way, (np.float32(half) - start) / way
        first, last = np.fmax(first, np.fmin(*ends)), np.fmin(last, np.fmax(*ends))
    canvas.glass[region] = np.where(first < last, 1 / np.maximum(first, 1e-9), 0)
    return region


def _absorb(canvas: Canvas, cube: Cube, glass: Floats, turn: Reals, region: Region) -> None:
    """Dim what lies behind the cube by its transmittance."""
    tops, lefts = (slice(part.start // FINE, -(-part.stop // FINE)) for part in region)
    pixels = slice(tops.start * FINE, tops.stop * FINE), slice(lefts.start * FINE, lefts.stop * FINE)
    met, solid = canvas.glass[pixels], canvas.near[pixels]
    shape = tops.stop - tops.start, lefts.stop - lefts.start
    heard = np.any(met.reshape(shape[0], FINE, shape[1], FINE) > 0, axis=(1, 3))[None]
    if not np.any(heard):
        return
    beyond = 1.01 * float(np.max((corners_of(cube.grid, turn) - canvas.eye) @ canvas.axes[2]))
    right, up, ahead = canvas.axes
    height, width = canvas.near.shape
    middle = (np.array([lefts.start + lefts.stop, tops.start + tops.stop]) * FINE - (width, height)) / 2 / canvas.focal
    plane = canvas.eye + beyond * (ahead + middle[0] * right - middle[1] * up)
    step = beyond * FINE / canvas.focal
    eye = np.append(canvas.eye @ turn, 1.0)
    views = Views(eye[None], (plane @ turn)[None], (step * right @ turn)[None], (-step * up @ turn)[None], shape)
    matrix = Projector(cube.grid, views, heard)
    columns = matrix.forward(glass.reshape(matrix.shape[1], -1))
    left = np.exp(-pictures_from_columns(columns, shape, columns.shape[1])[0])
    behind = met > solid
    for i, j in product(range(FINE), repeat=2):
        light = canvas.light[pixels][i::FINE, j::FINE]
        light *= np.where(behind[i::FINE, j::FINE, None], left, np.float32(1))


def _overlay(canvas: Canvas, grid: Grid, room: Standing, table: "_Table", *, front: bool) -> None:
    """Draw the table, the lamps and thin lines: those that lie before the cube's glass, or those behind it."""
    region, near, layers = table
    for light, part in layers:
        canvas.blend(region, near, light, part, front)
    for screen in room.screens:
        for start, end in zip(screen.corners, np.roll(screen.corners, -1, axis=0), strict=True):
            canvas.line(start, end, _FRAME, 0.9, 1.2, front)
    for lamp in room.lamps:
        _draw_lamp(canvas, grid, lamp, front)
    if front:
        _draw_edges(canvas, grid, room.turn)


#: Where a table is in the picture, its inverse depth, and light to lay over it with its strength.
_Table = tuple[Region, Floats, list[tuple[tuple[float, float, float], Floats]]]


def _table(canvas: Canvas, grid: Grid, room: Standing) -> _Table:
    """A disc of frosted glass, with a rim and marks that turn with the cube."""
    middle, right, down = table_of(grid, room)
    region = canvas.around(middle + np.array(list(product((-1, 1), repeat=2))) @ np.stack([right, down]))
    near, x, y = canvas.plane(middle, right, down, region)
    radius = np.hypot(x, y)
    grain = 1 / np.maximum(near * np.float32(canvas.focal * np.linalg.norm(right)), 1e-9)
    inside = np.clip(0.5 + (1 - radius) / grain, 0, 1)
    rim = np.clip(0.5 + (radius - 0.975) / grain, 0, 1) * inside
    turn = np.arctan2(y, x) / (np.pi / 6)
    aside = np.abs(turn - np.rint(turn)) * (np.pi / 6) * radius
    marks = np.clip(0.5 + (0.012 - aside) / grain, 0, 1) * np.clip(0.5 + (radius - 0.9) / grain, 0, 1) * inside
    return region, near, [(_TABLE, 0.25 * inside), (_RIM, 0.6 * rim), (_RIM, 0.5 * marks)]


def _draw_lamp(canvas: Canvas, grid: Grid, lamp: PlacedLamp, front: bool) -> None:
    """A disc in its colour that glows while it is lit; parallel light has a line to the cube's middle."""
    lit = bool(np.any(lamp.light > 0))
    pure = lamp.light[[min(i, len(lamp.light) - 1) for i in range(3)]] / lamp.light.max(initial=1e-9)
    if lamp.parallel and lit:
        canvas.line(lamp.place, np.zeros(3), pure, 0.22, 1.2, front)
    x, y, near = canvas.seen(lamp.place)[0]
    if near == 0:
        return
    radius = _LAMP * size_of(grid) * near * canvas.focal
    region = canvas.around(lamp.place, 5 * radius)
    rows, columns = (np.arange(part.start, part.stop) + 0.5 for part in region)
    away = np.hypot(columns - x, rows[:, None] - y).astype(np.float32) / np.float32(radius)
    body = np.clip(0.5 + (1 - away) * radius, 0, 1)
    if lit:
        canvas.blend(region, near, pure, 0.55 * np.exp(-((away / 1.7) ** 2)) * (away < 5), front)
    canvas.blend(region, near, 0.3 + 0.7 * pure if lit else _DARK_LAMP, body, front)


def _draw_edges(canvas: Canvas, grid: Grid, turn: Reals) -> None:
    """The cube's edges, fainter where they are seen through it."""
    corners, half = corners_of(grid, turn), np.array(grid.size_mm[::-1]) / 2
    eye = canvas.eye @ turn
    for a, b in [(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit]:
        faces = np.rint((corners[a] + corners[b]) @ turn / (2 * half))  # the two that meet there: 1, -1, or 0
        before = bool(np.any(faces * eye > half))
        part, width = (0.7, 1.2) if before else (0.13, 1.0)
        canvas.line(corners[a], corners[b], _EDGE, part, width, None)
