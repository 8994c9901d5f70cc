"""What whoever puts films together has to know, in words: which film lies where, and where lamps stand."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lightcube.optics.arrays import Reals
from lightcube.optics.cube import Cube
from lightcube.optics.moves import places_of
from lightcube.optics.stack import Stack
from lightcube.wording import counted

#: What is less than this, mm or degrees, is none.
_NONE = 1e-6
#: Where lamps are said to stand: so high above the films, mm; and what is too little to be told.
_HIGH_MM, _LEAST_MM = 1000.0, 0.005


@dataclass(frozen=True, eq=False)
class Assembly:
    """What the first page says.

    Parameters
    ----------
    title, subtitle
        What it is, and how large.
    heights_mm
        Of the films.
    heights
        The same in words.
    size_mm
        Width and height of a film.
    slopes
        Of the light of lamps that are far away, between the films, along x: mm for each mm down.
    sections
        Headings, and lines below them.
    """

    title: str
    subtitle: str
    heights_mm: tuple[float, ...]
    heights: tuple[str, ...]
    size_mm: tuple[float, float]
    slopes: tuple[float, ...]
    sections: tuple[tuple[str, tuple[str, ...]], ...]


def assembly(cube: Cube, stack: Stack, *, is_mirrored: bool) -> Assembly:
    """Say how a cube's stack is put together."""
    from lightcube.kernels.films import NEAR, SLOPE  # here: the compiler comes with them
    from lightcube.optics.films import paths

    light = paths(stack, cube.rig).table
    slopes = sorted({round(-float(row[SLOPE]), 4) for row in light if not row[NEAR]})
    count = stack.shape[0]
    _, ny, nx = stack.shape
    size, high = (nx * stack.voxel_mm, ny * stack.voxel_mm), stack.heights_mm[-1] - stack.heights_mm[0]
    sections = (
        ("How it is put together", _steps(cube, stack, is_mirrored=is_mirrored)),
        ("Films, the lowest first", _films(stack)),
        ("Light", _lamps(cube)),
        *((("Moves", _moves(cube, stack)),) if cube.rig.stops.films.shape[1] else ()),
    )
    return Assembly(
        f"Stack of {counted(count, 'film')}",
        f"{counted(len(cube.rig), 'picture')}, films of {size[0]:.4g} x {size[1]:.4g} mm, {high:.4g} mm high",
        stack.heights_mm,
        tuple(f"height {each - stack.heights_mm[0]:.4g} mm" for each in stack.heights_mm),
        size,
        tuple(slopes),
        sections,
    )


def _steps(cube: Cube, stack: Stack, *, is_mirrored: bool) -> tuple[str, ...]:
    """What is done one after the other."""
    side = "printed side down" if is_mirrored else "printed side up"
    between = "air: frames or spacers at the edges" if stack.index == 1 else f"plates of index {stack.index:g}, bonded"
    return (
        "1. Print all pages at 100 %, on one printer, all one way round. Measure both bars: where they are off, export",
        "    again with --scale-x and --scale-y of 100 / what you measured.",
        "2. Punch or drill both pin holes of each film. They are not symmetric: a film that is turned does not fit.",
        f"3. Stack the films on pins, film 1 lowest, {side}, arrows away from you; every F must read right from above.",
        f"    Between them is {between}.",
        f"4. Light it from above, in the dark; {_screen(cube, stack)}.",
    )


def _screen(cube: Cube, stack: Stack) -> str:
    """Where the screen is."""
    views = cube.rig.views
    if not np.any(views.lamps[:, 3]):
        return "white paper close below film 1 is the screen, and each picture moves aside as it lies lower"
    return f"the screen lies {stack.heights_mm[0] - float(views.origins_mm[0, 2]):.4g} mm below film 1"


def _films(stack: Stack) -> tuple[str, ...]:
    """A line for each film."""
    heights = np.array(stack.heights_mm)
    above = [f"{gap:.4g} mm to the next" for gap in np.diff(heights)] + ["the highest"]
    return tuple(
        f"film {number}: {height - heights[0]:.4g} mm above film 1; {gap}"
        for number, (height, gap) in enumerate(zip(heights.tolist(), above, strict=True), 1)
    )


def _lamps(cube: Cube) -> tuple[str, ...]:
    """A line for each lamp of each picture: where it stands, and how bright it is."""
    rig = cube.rig
    brightest = float(cube.powers.max())
    lines = [f"Powers are relative to a lamp that makes the bare screen white; the strongest is {brightest:.3g}."]
    for pair, (picture, lamp) in enumerate(rig.pairs.tolist()):
        view = int(np.flatnonzero((rig.sums.picture == picture) & (rig.sums.lamp == lamp))[0])
        powers = cube.powers[pair]
        colours = ("red", "green", "blue") if len(powers) == 3 else tuple(str(n + 1) for n in range(len(powers)))
        bright = ", ".join(f"{colour} {power:.3g}" for colour, power in zip(colours, powers, strict=True))
        lines.append(f"{cube.names[picture]}: {rig.lamps.names[lamp]}, {_where(rig.views.lamps[view])}; {bright}")
    return tuple(lines)


def _where(lamp: Reals) -> str:
    """Where a lamp stands, from a row of `Views.lamps`."""
    x, y, z, near = (float(each) for each in lamp)
    if near:
        return f"at {_aside(x, y)}, {z:.0f} mm above the middle"
    if z >= 0:
        return "from below"
    aslant = math.degrees(math.atan2(math.hypot(x, y), -z))
    return f"{aslant:.1f}° off upright: {_HIGH_MM:.0f} mm above, {_aside(-x / -z * _HIGH_MM, -y / -z * _HIGH_MM)}"


def _aside(x: float, y: float) -> str:
    """How far to the right and up something is from the middle, seen from above, to a tenth of a mm."""
    across = f"{abs(x):.4g} mm {'right' if x > 0 else 'left'}" if abs(x) >= _LEAST_MM else ""
    along = f"{abs(y):.4g} mm {'up' if y > 0 else 'down'}" if abs(y) >= _LEAST_MM else ""
    return " and ".join(part for part in (across, along) if part) or "over the middle"


def _moves(cube: Cube, stack: Stack) -> tuple[str, ...]:
    """A line for each picture: which films lie elsewhere."""
    lines = []
    for name, films in zip(cube.names, places_of(stack, cube.rig), strict=True):
        moves = [_moved(place, height_mm) for place, height_mm in zip(films, stack.heights_mm, strict=True)]
        told = [f"film {number} {move}" for number, move in enumerate(moves, 1) if move]
        lines.append(f"{name}: {'; '.join(told) or 'as they lie'}")
    return tuple(lines)


def _moved(place: Reals, height_mm: float) -> str:
    """How a film is moved, nothing where it is not; `place` as in `lightcube.optics.tables.Stops`."""
    cosine, sine, _, _, u, v, height = (float(each) for each in place)
    right, up = -(cosine * u - sine * v), -(sine * u + cosine * v)
    turn = math.degrees(math.atan2(sine, cosine))
    told = [_aside(right, up)] if max(abs(right), abs(up)) > _NONE else []
    told += [f"turned {turn:.4g}°"] if abs(turn) > _NONE else []
    told += [f"at height {height:+.4g} mm from the middle"] if abs(height - height_mm) > _NONE else []
    return ", ".join(told)
