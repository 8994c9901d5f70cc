"""The clear body that bends the light: its outline, and bent beams from the lamp to the wall."""

from collections.abc import Iterator

import numpy as np

from lightcube.drawing import tones
from lightcube.drawing.camera import Canvas
from lightcube.drawing.standing import Reals, Standing
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.views import unit

#: Straight pieces of a circle, and how high a bath is drawn, in heights of the block: as on the page.
_PIECES, _BATH_HIGH = 24, 1.25
#: Beams are drawn at these parts of a picture's sides, on so many screens at most: as on the page.
_PARTS, _MOST = (0.12, 0.37, 0.63, 0.88), 3


def is_cut(glass: Glass | None) -> bool:
    """Whether the glass is cut round, so that the block's edges are not there."""
    return glass is not None and glass.form in ("cylinder", "sphere")


def body_edges(glass: Glass, grid: Grid, light: Reals) -> Reals:
    """``(edges, 2, 3)``: the outline of what the light enters, mm in the cube's axes, besides the block's own edges.

    Parameters
    ----------
    light
        ``(3,)``: the way of the light, to which a bath with flat sides stands square.
    """
    turn = np.linspace(0, 2 * np.pi, _PIECES + 1)
    one, other, none = glass.radius_mm * np.cos(turn), glass.radius_mm * np.sin(turn), 0 * turn
    if glass.form == "block":
        return np.zeros((0, 2, 3))
    if glass.form == "sphere":
        circles = [np.stack(each, axis=1) for each in ((none, one, other), (one, none, other), (one, other, none))]
        return np.concatenate([_joined(each) for each in circles])
    high = (glass.size_mm or (0, 0, 0))[2] / 2
    high = high if np.isfinite(high) else _BATH_HIGH * grid.size_mm[0] / 2
    ahead = unit(light * (1.0, 1.0, 0.0))
    left, up = np.array([-ahead[1], ahead[0], 0.0]), np.array([0.0, 0.0, high])
    if glass.form == "bath":
        corners = glass.radius_mm * np.array([a * ahead + b * left for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
        around = np.concatenate([corners, corners[:1]])
        upright = np.stack([corners - up, corners + up], axis=1)
        return np.concatenate([_joined(around - up), _joined(around + up), upright])
    circle = np.stack([one, other, none], axis=1)
    sides = glass.radius_mm * np.stack([-left, left])
    return np.concatenate([_joined(circle - up), _joined(circle + up), np.stack([sides - up, sides + up], axis=1)])


def _joined(points: Reals) -> Reals:
    """Pieces from each point to the next one."""
    return np.stack([points[:-1], points[1:]], axis=1)


def bent_ways(rig: Rig) -> Iterator[tuple[int, Reals]]:
    """Of some pixels of each picture, its number, and where the light enters the glass, leaves it, and falls, mm.

    One view stands for all of a picture's: the middle one.
    """
    from lightcube.optics.refraction import bent  # here: a compiler comes with it

    starts, views = rig.starts, rig.views
    rows, columns = views.picture_shape
    for picture in range(min(len(rig), _MOST)):
        view = int(starts[picture] + starts[picture + 1]) // 2
        found, window = bent(rig, [view]), rig.stops.window[picture]
        for row, column in ((int(down * window[0]), int(across * window[1])) for down in _PARTS for across in _PARTS):
            if found.through[0, row, column] > 0:
                across, down = column - (columns - 1) / 2, row - (rows - 1) / 2
                steps = across * views.column_steps_mm[view] + down * views.row_steps_mm[view]
                ends = found.lines_mm[0, row, column].reshape(2, 3)
                yield picture, np.concatenate([ends, [views.origins_mm[view] + steps]])


def draw_body(canvas: Canvas, grid: Grid, rig: Rig, now: Standing, part: float) -> None:
    """The outline of what bends the light, `part` as strong as it may be."""
    if rig.glass is not None:
        for ends in body_edges(rig.glass, grid, rig.views.lamps[0, :3]) @ now.turn.T:
            canvas.line(ends, tones.EDGE, (0.5 * part, 0.5 * part), 1.1, None)


def draw_bent(canvas: Canvas, rig: Rig, now: Standing, part: float) -> None:
    """Some beams from the lamp through the glass to the walls."""
    strength = 0.3 * part
    for picture, way in bent_ways(rig):
        enters, leaves, pixel = way @ now.turn.T
        lamp = now.lamps[int(np.searchsorted(np.unique(rig.sums.lamp), rig.sums.lamp[rig.starts[picture]]))]
        back = unit(lamp.place)
        start = enters + ((lamp.place - enters) @ back) * back
        for ends, parts in (([start, enters], (0.0, strength)), ([enters, leaves], (strength, strength))):
            canvas.line(ends, tones.HINT, parts, 1.0, None)
        canvas.line([leaves, pixel], tones.HINT, (strength, strength), 1.0, None)
