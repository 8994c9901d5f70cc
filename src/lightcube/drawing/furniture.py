"""What stands in the room beside the cube's glass: floor, walls, the table, lamps, and thin lines."""

from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from lightcube.drawing import tones
from lightcube.drawing.camera import FINE, Canvas, Floats, Reals, Region
from lightcube.drawing.standing import PlacedLamp, PlacedScreen, Standing, corners_of, size_of, table_of
from lightcube.optics.grid import Grid
from lightcube.optics.transfer import decode, encode
from lightcube.optics.views import unit

#: With more lamps on a screen than this, lines to its corners would hide the room.
_MOST_HINTED = 6
#: Parts along a pixel's side that a picture is enlarged to before it is drawn, and a side of it then, at most.
_FINER, _LARGEST = 8, 1024
#: Degrees between a table's marks; every so many-th is longer.
_MARKS, _LONG = 5.0, 6


def draw_floor(canvas: Canvas, grid: Grid, room: Standing, height: float, means: list[Reals]) -> Floats:
    """Draw the floor and what is far behind it, with shadows of what stands there and what pictures throw back.

    Returns its inverse depth. Its lines are as far from each other as the cube is wide; they end softly, so pixels do.

    Parameters
    ----------
    means
        Of the light of each screen's picture.
    """
    size = size_of(grid)
    solid, x, y = canvas.plane((0.0, 0.0, height), np.array([size, 0.0, 0.0]), np.array([0.0, size, 0.0]), canvas.whole)
    canvas.near[...] = np.maximum(solid, 0)
    near, x, y = (each[::FINE, ::FINE] for each in (solid, x, y))
    lines = np.maximum(*(_line(place, 0.004, _grain(place)) for place in (x, y)))
    floor, bright, far = (np.array(each, np.float32) for each in (tones.FLOOR, tones.LINES, tones.FAR))
    light = floor + np.float32(0.55) * lines[..., None] * (bright - floor)
    light = far + np.exp(-(x**2 + y**2) / 14)[..., None] * (light - far)
    dark, spill = _shadows(x, y, grid, room, height, means)
    light = light * (1 - np.float32(tones.SHADE) * dark[..., None]) + spill
    light = np.where(near[..., None] > 0, light, _backdrop(canvas))
    rows, columns = (((np.arange(count) + 0.5) / count - 0.5) ** 2 for count in canvas.camera.size)
    light = (light * (1 - 0.42 * (rows[:, None] + columns))[..., None]).astype(np.float32)
    for i, j in product(range(FINE), repeat=2):
        canvas.light[i::FINE, j::FINE] = light
    return canvas.near.copy()


def _shadows(
    x: Floats, y: Floats, grid: Grid, room: Standing, height: float, means: list[Reals]
) -> tuple[Floats, Floats]:
    """How dark each place of the floor is, and the light that pictures throw there; lengths are the cube's widths."""
    size = size_of(grid)
    ground = np.array([0.0, 0.0, height])
    middle, right, _ = table_of(grid, room)
    hover, radius = (middle - ground) / size, float(np.linalg.norm(right)) / size
    away = np.maximum(np.hypot(x - hover[0], y - hover[1]) - 0.8 * radius, 0)
    dark, spill = _blob(away, hover[2], 0.24), np.zeros((*x.shape, 3), np.float32)
    for screen, mean in zip(room.screens, means, strict=True):
        across, below = screen.pixels[1] * screen.right / size, screen.pixels[0] * screen.down / size
        start = (screen.corner - ground) / size + below / 2
        along = np.clip(
            ((x - start[0]) * across[0] + (y - start[1]) * across[1]) / max(float(across[:2] @ across[:2]), 1e-9), 0, 1
        )
        aside = np.hypot(x - start[0] - along * across[0], y - start[1] - along * across[1])
        aside = np.maximum(aside - 0.4 * np.hypot(*below[:2]), 0)
        above = max(start[2] - abs(below[2]) / 2 - abs(across[2]) / 2, 0)
        dark = np.maximum(dark, 0.7 * _blob(aside, above, 0.16))
        spill += (0.5 * tones.GLOW * np.exp(-2.5 * aside**2)[..., None] * mean).astype(np.float32)
    return dark.astype(np.float32), spill


def _blob(distance: Floats, height: float, size: float) -> Floats:
    """A soft shadow of something so large and so high above the floor."""
    soft = size + 0.55 * max(height, 0.0)
    return np.asarray(np.exp(-((distance / soft) ** 2)) * size / soft, np.float32)


def _backdrop(canvas: Canvas) -> Floats:
    """What is far away: a little brighter higher up."""
    ways = canvas.ways(canvas.whole)
    rise = np.clip(ways[..., 2:] / np.linalg.norm(ways, axis=-1, keepdims=True), 0, 1)
    return np.asarray(np.array(tones.FAR) * (1 + 0.35 * _smooth(rise / 0.7)), np.float32)


def _smooth(part: NDArray[np.floating]) -> NDArray[np.floating]:
    """Begin and end softly, from 0 to 1."""
    part = np.clip(part, 0, 1)
    return np.asarray(part * part * (3 - 2 * part))


def _grain(place: Floats) -> Floats:
    """How far a place goes on from pixel to pixel."""
    down, along = (np.diff(place, axis=axis, append=place.take([-1], axis)) for axis in (0, 1))
    return np.asarray(np.hypot(down, along) + np.float32(1e-6))


def _within(distance: NDArray[np.floating], grain: Floats) -> Floats:
    """1 inside, 0 outside, softly over a pixel."""
    return np.asarray(np.clip(0.5 + distance / grain, 0, 1), np.float32)


def _line(place: Floats, half: float, grain: Floats) -> Floats:
    """Thin lines at whole numbers, fading where they are too fine to be seen."""
    return _within(half - np.abs(place - np.rint(place)), grain) * np.clip(1.5 - 4 * grain, 0, 1)


def draw_wall(canvas: Canvas, screen: PlacedScreen, wide: ArrayLike, picture: Floats) -> None:
    """Draw a screen with what it shows, and the wall or frame around it, in which it glows.

    Parameters
    ----------
    wide
        Of the frame, mm; or of its left, right, upper and lower parts.
    """
    steps = np.array([np.linalg.norm(screen.right), np.linalg.norm(screen.down)])
    beyond = np.broadcast_to(np.asarray(wide, np.float64), 4).reshape(2, 2) / steps[:, None]
    outer = screen.corner - beyond[0, 0] * screen.right - beyond[1, 0] * screen.down
    size = np.array(screen.pixels[::-1]) + beyond.sum(axis=1)
    across, below = size[0] * screen.right, size[1] * screen.down
    region = canvas.around(outer + np.array([0 * across, across, across + below, below]))
    near, x, y = canvas.plane(screen.corner, screen.right, screen.down, region)
    rows, columns = screen.pixels
    edges = [count / 2 - np.abs(place - count / 2) for place, count in ((x, columns), (y, rows))]
    seen = near > canvas.near[region]
    for place, count, (before, after) in zip((x, y), (columns, rows), beyond, strict=True):
        seen &= (place >= -before) & (place <= count + after)
    if not np.any(seen):
        return
    canvas.near[region][seen] = near[seen]
    lit = (canvas.eye - screen.corner) @ screen.facing > 0
    beside = sum(
        np.maximum(-edge[seen] / (count / 2), 0) ** 2 for edge, count in zip(edges, (columns, rows), strict=True)
    )
    glow = 0.22 * tones.GLOW * np.exp(-5 * np.asarray(beside))[:, None] * picture.mean(axis=(0, 1))
    wall = np.array(tones.WALL) + glow if lit else np.tile(tones.BACK, (len(glow), 1))
    inside = (edges[0][seen] >= 0) & (edges[1][seen] >= 0)
    shown = _enlarged(picture, y[seen][inside], x[seen][inside])
    wall[inside] = shown if lit else tones.BACK + tones.THROUGH * (shown - tones.BACK)
    canvas.light[region][seen] = wall


def draw_picture(canvas: Canvas, screen: PlacedScreen, picture: Floats) -> None:
    """Draw a screen's picture alone, from whichever side it is seen."""
    near, x, y = canvas.plane(screen.corner, screen.right, screen.down, canvas.whole)
    inside = (near > 0) & (x >= 0) & (x <= screen.pixels[1]) & (y >= 0) & (y <= screen.pixels[0])
    canvas.light[inside] = _enlarged(picture, y[inside], x[inside])


def _enlarged(picture: Floats, rows: Floats, columns: Floats) -> Floats:
    """A picture's light between its pixels, ``(places, 3)``: smooth in display values, of which there are no steps."""
    if picture.shape[0] * picture.shape[1] == 1:
        return np.broadcast_to(picture[0], (len(rows), 3))
    from scipy.ndimage import map_coordinates  # here: it takes longer to load than a small cube to play

    finer = max(1, min(_FINER, _LARGEST // max(picture.shape[:2])))
    size = finer * picture.shape[1], finer * picture.shape[0]
    places = finer * np.stack([rows, columns]) - np.float32(0.5)
    shown = []
    for channel in range(3):
        levels = Image.fromarray(encode(np.ascontiguousarray(picture[..., min(channel, picture.shape[2] - 1)]), "srgb"))
        smooth = np.asarray(levels.resize(size, Image.Resampling.BICUBIC))
        shown.append(map_coordinates(smooth, places, order=1, mode="nearest"))
    return np.asarray(decode(np.maximum(np.stack(shown, axis=-1), 0), "srgb"), np.float32)


#: Where a table is in the picture, its inverse depth, and light to lay over it with its strength.
Layers = tuple[Region, Floats, list[tuple[Reals, Floats]]]


def table_layers(canvas: Canvas, grid: Grid, room: Standing, floor: Floats) -> Layers:
    """A disc of frosted glass, with a rim and marks that turn with the cube, which shades it; clearer before walls."""
    middle, right, down = table_of(grid, room)
    region = canvas.around(middle + np.array(list(product((-1, 1), repeat=2))) @ np.stack([right, down]))
    near, x, y = canvas.plane(middle, right, down, region)
    radius = np.hypot(x, y)
    grain = 1 / np.maximum(near * np.float32(canvas.focal * np.linalg.norm(right)), 1e-9)
    inside = _within(1 - radius, grain)
    foot = np.abs(corners_of(grid, room.turn) @ np.stack([right, down]).T).max(axis=0) / (right @ right)
    upright = np.sum(np.abs(room.turn.T @ room.axis) < 1e-6) == 2
    gone = np.maximum(np.abs(x) - foot[0], 0) ** 2 + np.maximum(np.abs(y) - foot[1], 0) ** 2
    under = (0.5 if upright else 0.0) * np.exp(-gone / 0.012)
    tone = (1 - 0.25 * np.minimum(radius, 1) ** 2) * (1 - tones.SHADE * under)
    frost = np.where(canvas.near[region] == floor[region], np.float32(0.68), np.float32(0.1)) * inside
    rim = _within(radius - np.float32(0.985), grain) * inside
    turn = np.arctan2(y, x) / np.radians(_MARKS)
    fine = grain / (np.radians(_MARKS) * np.maximum(radius, 0.1))
    longer = np.rint(turn) % _LONG == 0
    marks = np.maximum(
        _line(turn, 0.035, fine) * _within(radius - np.float32(0.95), grain),
        longer * _line(turn, 0.055, fine) * _within(radius - np.float32(0.925), grain),
    )
    zero = _within(0.014 - np.hypot(x - 0.885, y), grain)
    thin = np.maximum(np.maximum(0.75 * rim, 0.6 * marks * inside), 0.9 * zero)
    return region, near, [(tone[..., None] * np.array(tones.TABLE), frost), (np.array(tones.RIM), thin)]


def draw_lamp(canvas: Canvas, grid: Grid, lamp: PlacedLamp, part: float, front: bool) -> None:
    """A ball in its colour, white in its middle, that glows while it is lit; `part` is how strong all that is."""
    x, y, near = canvas.seen(lamp.place)[0]
    if near == 0 or part == 0:
        return
    radius = max(tones.LAMP_RADIUS * size_of(grid) * near * canvas.focal, 2.5 * FINE)
    region = canvas.around(lamp.place, 6 * radius)
    rows, columns = (np.arange(each.start, each.stop) + 0.5 for each in region)
    away = np.hypot(columns - x, rows[:, None] - y).astype(np.float32) / np.float32(radius)
    ball = part * np.clip(0.5 + (1 - away) * radius, 0, 1)
    if not np.any(lamp.light > 0):
        canvas.blend(region, near, tones.OFF, ball, front)
        return
    pure = pure_light(lamp)
    beyond = np.maximum(away - 1, 0)
    canvas.blend(region, near, pure, part * 0.6 * np.exp(-0.9 * beyond) * _smooth((5 - beyond) / 3), front)
    white = (0.25 + 0.65 * np.exp(-1.2 * away**2))[..., None]
    canvas.blend(region, near, pure + white * (1 - pure), ball, front)


def pure_light(lamp: PlacedLamp) -> Reals:
    """The colour of a lamp's light, ``(3,)``, its brightest part 1."""
    return np.asarray(lamp.light[[min(i, len(lamp.light) - 1) for i in range(3)]] / lamp.light.max(initial=1e-9))


def draw_hints(canvas: Canvas, room: Standing, lit: list[list[PlacedLamp]], part: float, front: bool) -> None:
    """Thin lines from parallel lamps to the cube's middle, and from lamps to the corners of what they light.

    Parameters
    ----------
    lit
        For each screen the lamps that light it.
    part
        How strong they are, 0 to 1.
    """

    def draw(ends: ArrayLike, parts: tuple[float, float]) -> None:
        canvas.line(ends, tones.HINT, (part * parts[0], part * parts[1]), 1.0, front)

    for lamp in room.lamps:
        if lamp.parallel and np.any(lamp.light > 0):
            draw([lamp.place, np.zeros(3)], (0.4, 0.1))
    for screen, lamps in zip(room.screens, lit, strict=True):
        strength = 0.26 / max(len(lamps), 1) ** 0.5
        for lamp, corner in product(lamps if len(lamps) <= _MOST_HINTED else [], screen.corners):
            way = -unit(lamp.place)
            start = corner - ((corner - lamp.place) @ way) * way if lamp.parallel else lamp.place
            draw([start, corner], (0.0 if lamp.parallel else strength, strength))


def draw_sheets(canvas: Canvas, corners: Reals, part: float) -> None:
    """The edges of films ``(films, 4, 3)``, fainter behind the first, and what holds corners that lie on each other."""
    order = np.argsort(-np.abs(corners[:, 0, 2] - canvas.eye[2]))
    for depth, number in enumerate(order):
        ends, first = corners[number], depth == len(order) - 1
        strength = part * (0.8 if first else 0.42)
        for i in range(4):
            canvas.line([ends[i], ends[(i + 1) % 4]], tones.EDGE, (strength, strength), 1.3 if first else 1.1, None)
    low, high = corners[np.argmin(corners[:, 0, 2])], corners[np.argmax(corners[:, 0, 2])]
    if np.allclose(corners[:, :, :2], corners[0, :, :2]):
        for bottom, top in zip(low, high, strict=True):
            canvas.line([bottom, top], tones.EDGE, (0.22 * part, 0.22 * part), 1.0, None)


def draw_edges(canvas: Canvas, grid: Grid, turn: Reals, part: float) -> None:
    """The cube's edges, fainter where they are seen through it."""
    corners, half = corners_of(grid, turn), np.array(grid.size_mm[::-1]) / 2
    eye = canvas.eye @ turn
    for a, b in [(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit]:
        faces = np.rint((corners[a] + corners[b]) @ turn / (2 * half))  # the two that meet there: 1, -1, or 0
        before = bool(np.any(faces * eye > half))
        strength = part * (0.75 if before else 0.16)
        canvas.line([corners[a], corners[b]], tones.EDGE, (strength, strength), 1.3 if before else 1.0, None)
