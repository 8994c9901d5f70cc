"""A stack of films for some pictures: how many cells, which lamps, and the room that all of it stands in."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Reals
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.moves import Move
from lightcube.optics.stack import MOST_FILMS, Stack
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.wording import counted

#: The steepest slope of lamps along each side of the films, where nothing says where they are: 40 degrees.
_STEEPEST = math.tan(math.radians(40))
#: And of films that no page holds: 32 degrees.
_MODERATE = math.tan(math.radians(32.01))
#: Short and long side of what a printer prints on A4, mm; films a little too large are as large.
_PAGE_MM, _SAME_MM = (198.0, 285.0), 1e-6
#: A film has no more cells along a side, and a pixel no more of them.
_MOST_CELLS, _MOST_A_PIXEL = 4096, 16
#: The name of the only screen, and of the lamp of films that are moved by hand.
WALL, ONLY = "wall", "lamp"


@dataclass(frozen=True)
class Films:
    """A stack of films before its pictures are known.

    Parameters
    ----------
    count
        How many films there are.
    gap_mm
        From one to the next, mm; 0 = they touch.
    heights_mm
        Where they lie, ascending, mm, instead of `count` and `gap_mm`.
    size_mm
        Longest side of the pictures, mm.
    pixels
        Pixels along it.
    cells_a_pixel
        Cells of a film along a pixel's side: with 1 pictures are poor, 2 are enough, 4 stand half the misplacement.
    index
        Index of refraction of what is between the films: 1 = air, 1.49 = acrylic.
    screen_mm
        From the lowest film to the screen below; None = through the stack's middle, as good as any under the parallel
        light of one lamp, or the lowest film where a lamp is near or has a size, or several are lit at once.

    Raises
    ------
    InputError
        Where a number is out of its range.
    """

    count: int = 5
    gap_mm: float = 12.0
    heights_mm: tuple[float, ...] = ()
    size_mm: float = 160.0
    pixels: int = 32
    cells_a_pixel: int = 2
    index: float = 1.0
    screen_mm: float | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        bounds = {
            "films": (len(self.heights_mm) or self.count, 1, MOST_FILMS),
            "pixels": (self.pixels, 1, _MOST_CELLS // self.cells_a_pixel if self.cells_a_pixel > 0 else 0),
            "cells_a_pixel": (self.cells_a_pixel, 1, _MOST_A_PIXEL),
            "gap_mm": (self.gap_mm, 0, 1e5),
            "size_mm": (self.size_mm, 1e-3, 1e5),
            "index": (self.index, 1, 3),
            "screen_mm": (self.screen_mm or 0.0, 0, 1e5),
        }
        for name, (value, least, most) in bounds.items():
            if not least <= value <= most:
                raise InputError(f"{name} of a stack of films lies between {least:g} and {most:g}, not {value:g}")

    @property
    def heights(self) -> Reals:
        """Heights of the films, about the middle of their stack, mm."""
        if self.heights_mm:
            given = np.array(self.heights_mm)
            return given - (given[0] + given[-1]) / 2
        return np.asarray((np.arange(self.count) - (self.count - 1) / 2) * self.gap_mm, np.float64)

    @property
    def pixel_mm(self) -> float:
        """Side of a pixel."""
        return self.size_mm / self.pixels

    @property
    def cell_mm(self) -> float:
        """Side of a cell."""
        return self.pixel_mm / self.cells_a_pixel

    def picture_shape(self, aspect: float) -> tuple[int, int]:
        """``(rows, columns)`` of pictures of so much width / height."""
        rows, columns = (self.pixels / aspect, self.pixels) if aspect >= 1 else (self.pixels, self.pixels * aspect)
        return max(1, round(rows)), max(1, round(columns))


@checked
def attenuator(
    names: Sequence[str],
    films: Films | None = None,
    aspect: float = 1.0,
    *,
    lamps: Sequence[Lamp] = (),
    lit: Sequence[Sequence[str]] = (),
    moves: Sequence[Move | None] = (),
) -> Stage:
    """The room of a stack of films: light falls from above on films that lie on each other, onto a screen below.

    Films, screen and pictures are seen from above: x runs to the right, y upwards in the pictures.

    Parameters
    ----------
    names
        Of the pictures.
    films
        How the films lie; None = ``Films()``.
    aspect
        Width / height of the pictures.
    lamps
        Where light comes from; none = a lamp for each picture, up to 40 degrees off upright along either side (for
        pictures of films that are moved, one upright lamp, aslant where their order changes).
    lit
        Names of each picture's lamps; none = each picture has its own, in order, or all have the only one.
    moves
        How the films lie for each picture; none = they are not moved.

    Raises
    ------
    InputError
        Where pictures would all be the same, lamps are along the films, or films would have too many cells.

    Examples
    --------
    >>> import lightcube as lc
    >>> stage = lc.attenuator(["spring", "summer", "autumn", "winter"], lc.Films(count=5, gap_mm=12))
    >>> stage.grid
    <stack of 5 films of 80 x 76 cells of 2.5 mm>
    >>> [tuple(round(part, 2) for part in lamp.direction) for lamp in stage.lamps]
    [(-0.63, 0.83, -1.0), (0.63, 0.83, -1.0), (-0.63, -0.83, -1.0), (0.63, -0.83, -1.0)]
    """
    films, names = films or Films(), list(names)
    if not names:
        raise InputError("no picture is wanted of these films: name at least one")
    if moves and len(moves) != len(names):
        raise InputError(f"{counted(len(moves), 'move')} for {counted(len(names), 'picture')}: give one for each")
    if not 1e-3 <= aspect <= 1e3:
        raise InputError(f"pictures are 0.001 to 1000 times as wide as high, not {aspect:g}")
    placed = [*moves] or [None] * len(names)
    given = tuple(lamps) or _usual_lamps(films, len(names), aspect, placed)
    shown = [tuple(each) for each in lit] or _own(given, len(names))
    if len(shown) != len(names):
        raise InputError(f"lamps of {counted(len(shown), 'picture')} for {len(names)}: say which lamp each one has")
    rows, columns = films.picture_shape(aspect)
    each = zip(names, [WALL] * len(names), shown, range(len(names)), placed, strict=True)
    shots = tuple(Shot(*one) for one in each)
    # parallel light of one lamp casts the same picture at any distance; other light a wall must stand in
    where = any(lamp.position_mm is not None or lamp.size_deg for lamp in given) or any(len(each) > 1 for each in shown)
    lowest = float(films.heights[0])
    low_mm = (lowest if where else 0.0) if films.screen_mm is None else lowest - films.screen_mm
    size_mm = columns * films.pixel_mm, rows * films.pixel_mm
    screen = Screen(WALL, (0.0, 0.0, low_mm), size_mm, films.pixel_mm, normal=(0.0, 0.0, 1.0), up=(0.0, 1.0, 0.0))
    bare = Stack((len(films.heights), 1, 1), films.cell_mm, heights_mm=tuple(films.heights.tolist()), index=films.index)
    stops = tuple(360.0 * number / len(names) for number in range(len(names)))
    stage = Stage(bare, given, (screen,), shots, stops, cube_turns=False)
    _check_unlike(stage)
    return replace(stage, grid=replace(bare, shape=(bare.shape[0], *_cells(stage, bare))))


def _usual_lamps(films: Films, count: int, aspect: float, moves: Sequence[Move | None]) -> tuple[Lamp, ...]:
    """Lamps of which nothing is said: one for each picture, or one for all where films are moved."""
    if any(moves):
        aslant = any(move is not None and move.order for move in moves)
        return (Lamp(ONLY, direction=(0.83, 0.42, -1.0) if aslant else (0.0, 0.0, -1.0)),)
    return tuple(
        Lamp(f"lamp {number}", direction=(float(x), float(y), -1.0))
        for number, (x, y) in enumerate(outside(lattice(films, count, aspect), films.index), 1)
    )


def lattice(films: Films, count: int, aspect: float = 1.0) -> Reals:
    """``(count, 2)``: slopes between the films of so many lamps, in rows, for pictures of so much width / height.

    As far apart as 40 degrees to either side allow, or less so that films fit on a sheet of A4: the farther, the better
    pictures are (docs/films.md). Where they fit on none, 32 degrees. From one film to the next their light moves by
    whole cells where films are so far apart: pixels then fall into cells only, and are exact with few beams.
    """
    across = math.ceil(math.sqrt(count))
    rows = math.ceil(count / across)
    places = np.array([(column, row) for row in range(rows) for column in range(across)], np.float64)[:count]
    counts = np.array([across, rows])
    high, wide = films.picture_shape(aspect)
    sides_mm, deep = np.array([wide, high]) * films.pixel_mm, 2 * float(np.max(np.abs(films.heights)))
    tried = [np.array(steps) for steps in itertools.product(*(_steps(films, int(each)) for each in counts))]
    fitting = [
        steps
        for steps in tried
        if np.all(np.sort(sides_mm + (counts - 1) / 2 * steps * deep) <= np.add(_PAGE_MM, _SAME_MM))
    ]
    moderate = [steps for steps in tried if np.all((counts - 1) / 2 * steps <= _MODERATE + _SAME_MM)]
    best = max(
        fitting or moderate or tried[:1], key=lambda steps: (np.min(steps[counts > 1], initial=1), np.sum(steps))
    )
    slopes = (places - (counts - 1) / 2) * best
    return np.asarray(np.where(slopes == 0, 0.0, slopes * (1, -1)))


def _steps(films: Films, count: int) -> list[float]:
    """From one lamp's slope to the next, of so many along a side: what may be chosen, in whole cells if that can be."""
    if count == 1:
        return [0.0]
    widest = 2 * _STEEPEST / (count - 1)
    apart = float(np.min(np.diff(films.heights))) if len(films.heights) > 1 else 0.0
    grain = (films.cell_mm / apart if apart > 0 else math.inf) * (2 if count % 2 == 0 else 1)  # of two none is upright
    whole = math.floor(widest / grain + 1e-9)
    return [grain * number for number in range(1, whole + 1)] or [widest / 2, widest]


def snapped(lamps: Sequence[Lamp], films: Films) -> tuple[Lamp, ...]:
    """Parallel lamps, moved so that their light moves by whole cells from one film to the next; others as they are."""
    apart = np.diff(films.heights)
    if len(apart) == 0 or np.ptp(apart) > 1e-9 * films.cell_mm or apart[0] <= 0:
        raise InputError("lamps snap to films that are evenly apart, and these are not: leave lamps where they are")
    cell = films.cell_mm / float(apart[0])
    found = []
    for lamp in lamps:
        if lamp.direction is None:
            found.append(lamp)
            continue
        x, y, z = lamp.direction
        slope = inside(np.array([[x / z, y / z]]) * -1, films.index) if z else np.full((1, 2), np.inf)
        if not np.all(np.isfinite(slope)):
            raise InputError(f"lamp {lamp.name!r}: direction runs along the films: let it fall on them from above")
        moved = outside(np.round(slope / cell) * cell, films.index)[0]
        found.append(replace(lamp, direction=(float(moved[0]), float(moved[1]), -1.0)))
    return tuple(found)


def outside(slopes: Reals, index: float) -> Reals:
    """Slopes in the air of light whose slopes between the films are given, by Snell's law."""
    tangent = np.linalg.norm(slopes, axis=1, keepdims=True)
    sine = index * tangent / np.sqrt(1 + tangent**2)
    if np.any(sine >= 1):
        most = math.degrees(math.asin(1 / index))
        raise InputError(
            f"no light comes in more than {most:.1f} degrees aslant, and lamps would need "
            f"{math.degrees(math.atan(float(tangent.max()))):.1f}: choose a wider gap or cells that are narrower"
        )
    return np.asarray(slopes * np.where(tangent > 0, sine / np.sqrt(1 - sine**2) / np.maximum(tangent, 1e-300), index))


def inside(slopes: Reals, index: float) -> Reals:
    """Slopes between the films of light whose slopes in the air are given: the inverse of `outside`."""
    return outside(slopes, 1 / index)


def _own(lamps: Sequence[Lamp], count: int) -> list[tuple[str, ...]]:
    """The lamp of each of so many pictures, in order."""
    if len(lamps) == 1:
        return [(lamps[0].name,)] * count
    if len(lamps) != count:
        raise InputError(
            f"{counted(len(lamps), 'lamp')} for {counted(count, 'picture')}: give one for each, or say which of them "
            "each picture has"
        )
    return [(lamp.name,) for lamp in lamps]


def _check_unlike(stage: Stage) -> None:
    """Raise `InputError` where two pictures are cast by the same light through films in the same place."""
    from lightcube.optics.films import paths  # here: the compiler comes with it

    assert isinstance(stage.grid, Stack)  # noqa: S101 - made so
    rig = stage.rig()
    lines = paths(stage.grid, rig).lines
    close = 1e-6 * stage.grid.voxel_mm
    beside = lines - lines[:, :1]  # only how films lie to each other counts, of the same part of them
    large = np.abs(lines[:, 0, :, :2]).sum(axis=-1) * np.max(rig.picture_shape)
    first = rig.starts[:-1]
    for second, other in enumerate(first[1:], 1):
        for one in range(second):
            same = rig.starts[one + 1] - first[one] == rig.starts[second + 1] - other == 1
            elsewhere = np.abs(lines[first[one], 0, :, 2] - lines[other, 0, :, 2]) >= large[other]
            if same and not np.any(elsewhere) and np.allclose(beside[first[one]], beside[other], rtol=0, atol=close):
                raise InputError(
                    f"pictures {stage.shots[one].name!r} and {stage.shots[second].name!r} are cast by the same light "
                    "through films that lie alike: let lamps stand elsewhere, or films be moved, or be apart"
                )


def _cells(stage: Stage, bare: Stack) -> tuple[int, int]:
    """``(ny, nx)`` of films that all pictures' light goes through."""
    from lightcube.optics.films import paths  # here: the compiler comes with it

    rig = stage.rig()
    rows, columns = rig.picture_shape
    corners = np.array([(column, row, 1) for column in (-0.5, columns - 0.5) for row in (-0.5, rows - 0.5)])
    at = paths(bare, rig).lines @ corners.T  # (views, films, uv, corners)
    half = np.max(np.abs(at), axis=(0, 1, 3)) / bare.voxel_mm
    across, along = (2 * math.ceil(float(each) - 1e-6) for each in half)
    if max(across, along) > _MOST_CELLS:
        raise InputError(
            f"these films would be {max(across, along)} cells wide, and {_MOST_CELLS} are the most: let lamps stand "
            "more upright, films lie nearer to each other, or cells be wider"
        )
    return along, across
