"""Plots: functions that return matplotlib figures."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing.sheet import MOST, pair
from lightcube.drawing.standing import Standing, corners_of, drawn, extent, standing, table_of
from lightcube.drawing.svg import hull
from lightcube.errors import InputError
from lightcube.forward.casting import play
from lightcube.forward.turning import moment
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.transfer import encode
from lightcube.optics.views import unit
from lightcube.pictures.fitting import targets_of
from lightcube.pictures.targets import Targets
from lightcube.scoring.between import LOBE_DB, Curve
from lightcube.scoring.metrics import GOOD_DB, check_same_views, score_pictures

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Reals = NDArray[np.float64]

_INK, _QUIET, _FAINT = "#33383c", "#7b8085", "#dddddd"
#: Colours that everybody can tell apart (M. Okabe, K. Ito), and markers, of lamp powers up to 1, 4, 16, 64, ….
_BY_POWER = (("#D55E00", "v"), ("#E69F00", "D"), ("#0072B2", "o"), ("#009E73", "s"), ("#CC79A7", "^"), ("#000000", "p"))
_HOLLOW = "P<>*Xd"
#: Loads that are written on their axis.
_LOADS = (0.25, 0.5, 1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32, 64)
#: White lamps are drawn in this colour.
_AMBER = (0.93, 0.66, 0.16)


def _figure(width: float, height: float) -> "Figure":
    """Return an empty figure of that size in inches, or raise `InputError` where matplotlib is missing."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise InputError("drawing a plot needs one more package: pip install 'lightcube[plot]'") from None
    return Figure(figsize=(width, height), layout="constrained")


def between_plot(curves: dict[str, Curve]) -> "Figure":
    """PSNR against the turntable angle, the stops marked, one panel above the other.

    Parameters
    ----------
    curves
        By the title of their panel; a single one may have none (``""``).
    """
    figure = _figure(9.0, 1.2 + 2.0 * len(curves))
    panels = np.atleast_1d(figure.subplots(len(curves), 1, sharey=True))
    for axes, (title, curve) in zip(panels, curves.items(), strict=True):
        low, high = float(curve.angles_deg[0]), float(curve.angles_deg[0]) + curve.period_deg
        starts = np.flatnonzero(np.diff(curve.nearest)) + 1
        for number, part in enumerate(np.split(np.arange(len(curve.angles_deg)), starts)):
            axes.plot(curve.angles_deg[part], curve.psnr[part], color=("#20639b", "#3caea3")[number % 2], linewidth=1.2)
        stops = curve.offsets_deg == 0
        axes.plot(curve.angles_deg[stops], curve.psnr[stops], "o", color="#173f5f", markersize=3.5)
        axes.axhline(LOBE_DB, color="#999", linewidth=0.8, linestyle="--")
        axes.set(xlim=(low, high), ylabel="PSNR, dB", title=title)
        axes.spines[["top", "right"]].set_visible(False)
        if curve.period_deg == 360:
            axes.set_xticks(np.arange(45 * np.ceil(low / 45), high + 1e-9, 45))
    panels[-1].set_xlabel("turntable angle, degrees")
    return figure


def sheet_plot(cube: Cube, targets: Targets | None = None) -> "Figure":
    """Contact sheet: each picture as it is shown below what was wanted, with its angle and PSNR.

    Parameters
    ----------
    targets
        What was wanted; None = the 8-bit targets that the cube keeps. Of more than 32 pictures, 32 are shown.

    Raises
    ------
    InputError
        Where the cube keeps no targets and none are given, or they do not fit its pictures.
    """
    wanted = targets_of(cube) if targets is None else targets
    check_same_views(cube, wanted)
    shown = play(cube, picture_only=True)
    scores = score_pictures(shown, wanted)["pictures"]
    count = len(wanted)
    chosen = np.unique(np.linspace(0, count - 1, min(count, MOST)).round().astype(int))
    rows, columns = wanted.rig.picture_shape
    lines = math.ceil(len(chosen) / max(2, round(8 * min(1.0, rows / columns))))
    across = math.ceil(len(chosen) / lines)
    wide = 1.25 * max(1.0, columns / rows)
    figure = _figure(wide * across, lines * (2 * wide * rows / columns + 0.45) + 0.2)
    figure.suptitle("above what was wanted, below what is shown", fontsize=9, color=_INK)
    panels = figure.subplots(lines, across, squeeze=False).ravel()
    for axes, view in zip(panels, chosen, strict=False):
        gap = np.full((max(1, rows // 32), columns, 3), 255, np.uint8)
        above, below = pair(shown[view], wanted, int(view))
        axes.imshow(np.concatenate([above, gap, below]), interpolation="nearest")
        score = scores[view]
        axes.set_title(
            f"{score['name'][:16]}\n{score['angle_deg']:.4g}°  {score['psnr']:.1f} dB", fontsize=7, color=_INK
        )
    for axes in panels:
        axes.set_axis_off()
    return figure


Points = Sequence[tuple[float, float]]


def capacity_plot(
    curves: Mapping[float, Points], others: Mapping[str, Points] | None = None, *, elevation_deg: float = 0.0
) -> "Figure":
    """Mean PSNR against the load, a curve for each bound on the lamp power; the dashed line is where pictures are good.

    Parameters
    ----------
    curves
        By the largest lamp power: points ``(load, mean PSNR in dB)`` as `lightcube.planning.consistency.load` and
        `lightcube.predict` or `lightcube.score` tell them.
    others
        More such points by what they are, drawn hollow and not joined.
    elevation_deg
        Of the lamp, degrees; it decides what a load is.
    """
    figure = _figure(9.0, 5.3)
    axes = figure.subplots()
    for power in sorted(curves, reverse=True):
        colour, marker = _BY_POWER[round(math.log(max(power, 1.0), 4)) % len(_BY_POWER)]
        look: dict[str, Any] = {"color": colour, "marker": marker, "linewidth": 1.8, "markersize": 6.5}
        axes.plot(*zip(*sorted(curves[power]), strict=True), label=f"lamp power up to {power:g}", **look)
    for number, (label, points) in enumerate((others or {}).items()):
        look = {"color": _INK, "marker": _HOLLOW[number % len(_HOLLOW)], "linestyle": "", "markerfacecolor": "none"}
        axes.plot(*zip(*points, strict=True), label=label, markersize=6.5, **look)
    axes.axhline(GOOD_DB, color=_QUIET, linewidth=0.8, linestyle="--")
    lamp, size, side = "level lamp", "width", "the cube"
    if elevation_deg:
        lamp, size, side = f"lamp raised by {elevation_deg:g}°", "area", "a side of the cube"
    axes.set(title=f"How much a cube holds, {lamp}", ylabel="mean PSNR, dB", xscale="log")
    axes.set_xlabel(f"load: number of pictures × {size} of a picture / {size} of {side}")
    low, high = axes.get_xlim()
    ticks = [each for each in _LOADS if low <= each <= high]
    axes.set_xticks(ticks, [f"{each:g}" for each in ticks])
    axes.minorticks_off()
    axes.grid(color=_FAINT, linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="best")
    return figure


class _Beam(NamedTuple):
    """Light of a lamp to the corners of a screen: ``(4, 3)`` each, where it starts and where it ends, mm."""

    colour: tuple[float, ...]
    starts: Reals
    ends: Reals


def geometry_plot(cube: Cube, angle_deg: float | None = None) -> "Figure":
    """The set-up from above and from the side, to one scale: cube, lamps, screens, stops, and light to their corners.

    Parameters
    ----------
    angle_deg
        Of the turntable, degrees; None = the first stop's. The pointer shows it among the stops around the table.
    """
    rig = drawn(cube).rig
    at = float(rig.stops.angle_deg[0]) if angle_deg is None else angle_deg
    room = standing(cube, at)
    points = extent(cube.grid, room)
    middle, half = (points.max(axis=0) + points.min(axis=0)) / 2, np.ptp(points, axis=0) / 2
    high = 1.1 * float(half[1:].max())
    wide = max(1.1 * float(half[0]), high / 1.4)
    figure = _figure(10.0, 1.2 + 4.2 * high / wide)
    figure.suptitle(f"The set-up, the table at {at:.4g}°", color=_INK)
    for axes, name, up in zip(figure.subplots(1, 2), ("from above", "from the side"), (1, 2), strict=True):
        _draw_table(axes, cube.grid, rig, room, at, up)
        for beam in _beams(cube, room, at):
            _draw_beam(axes, beam, up)
        _draw_solids(axes, cube.grid, rig, room, up)
        axes.set(xlim=(middle[0] - wide, middle[0] + wide), ylim=(middle[up] - high, middle[up] + high))
        axes.set(aspect="equal", xlabel="x, mm", ylabel=f"{'xyz'[up]}, mm")
        axes.set_title(name, fontsize=10, color=_QUIET)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def _colour(rig: Rig, lamp: int) -> tuple[float, ...]:
    """Of a lamp, from 0 to 1; one for white ones that can be seen on paper."""
    light = encode(np.asarray(rig.sums.of_colours(3)[rig.sums.lamp == lamp].sum(axis=0)))
    if np.ptp(light) < 0.2 * light.max():
        return _AMBER
    return tuple(float(part) for part in 0.9 * light / light.max())


def _beams(cube: Cube, room: Standing, angle_deg: float) -> Iterator[_Beam]:
    """Of every lamp that shines on a screen at that angle."""
    rig, powers = moment(cube, [angle_deg])
    lit = np.any(powers[rig.pair] * rig.sums.share > 0, axis=1)
    lamps = list(np.unique(rig.sums.lamp))
    for screen, number in sorted(set(zip(rig.sums.picture[lit].tolist(), rig.sums.lamp[lit].tolist(), strict=True))):
        lamp, ends = room.lamps[lamps.index(number)], room.screens[screen].corners
        starts = np.broadcast_to(lamp.place, (4, 3))
        if lamp.parallel:  # from the plane through the lamp's sign
            way = -unit(lamp.place)
            starts = ends - ((ends - lamp.place) @ way)[:, None] * way
        yield _Beam(_colour(rig, number), starts, ends)


def _draw_beam(axes: "Axes", beam: _Beam, up: int) -> None:
    x, y = np.stack([beam.starts, beam.ends])[..., [0, up]].transpose(2, 0, 1)
    axes.fill(*hull(np.column_stack([x.ravel(), y.ravel()])).T, color=beam.colour, alpha=0.13, linewidth=0)
    axes.plot(x, y, color=beam.colour, alpha=0.6, linewidth=0.7)


def _draw_table(axes: "Axes", grid: Grid, rig: Rig, room: Standing, angle_deg: float, up: int) -> None:
    """Draw the turntable, a tick for each stop where the axis points at who looks, and the pointer."""
    middle, right, down = table_of(grid, replace(room, turn=np.eye(3)))
    way = -math.copysign(1.0, float(room.axis @ rig.turning.axis))  # from right to down is clockwise

    def rim(degrees: Reals, radius: float) -> Reals:
        turns = way * np.radians(degrees)[:, None]
        return np.asarray(middle + radius * (np.cos(turns) * right + np.sin(turns) * down))[:, (0, up)]

    disc = np.arange(0.0, 360.0, 5.0)
    axes.fill(*hull(rim(disc, 1.0)).T, facecolor="#ece8de", edgecolor="#b9b3a4", linewidth=0.8, closed=True)
    stops = np.unique(rig.stops.angle_deg)
    if abs(np.cross((1.0, 0.0, 0.0), np.eye(3)[up]) @ room.axis) < 0.5 or len(stops) == 1:
        return
    for ends in zip(rim(stops, 0.94), rim(stops, 1.0), strict=True):
        axes.plot(*np.stack(ends).T, color=_INK, linewidth=0.9)
    tip = np.concatenate([rim(np.array([angle_deg]), 0.99), rim(angle_deg + np.array([-3.0, 3.0]), 0.9)])
    axes.fill(*tip.T, color=_INK)


def _draw_solids(axes: "Axes", grid: Grid, rig: Rig, room: Standing, up: int) -> None:
    """Draw the cube, the screens and the lamps, with the names of these."""
    plane = [0, up]
    corners = corners_of(grid, room.turn)[:, plane]
    axes.fill(*hull(corners).T, facecolor="#d3e2f2", edgecolor="#3f6c99", alpha=0.85, linewidth=1.3, zorder=3)
    for first in range(8):
        for second in {first | 1, first | 2, first | 4} - {first}:
            axes.plot(*corners[[first, second]].T, color="#3f6c99", alpha=0.5, linewidth=0.6, zorder=3)
    for place, (number, screen) in enumerate(zip(np.unique(rig.stops.screen), room.screens, strict=True)):
        outline = screen.corners[:, plane]
        axes.fill(*outline.T, facecolor="#8d979e22", edgecolor=_INK, linewidth=1.8, zorder=4)
        ends = outline[np.argmax(outline[:, 1])], outline[np.argmin(outline[:, 1])]
        _name(axes, rig.screens.names[number], ends[place % 2], (4, -11)[place % 2])
    for place, (number, lamp) in enumerate(zip(np.unique(rig.sums.lamp), room.lamps, strict=True)):
        sign: dict[str, Any] = {"marker": (12, 1, 0), "markersize": 15} if lamp.parallel else {"marker": "o"}
        lit = _colour(rig, number) if np.any(lamp.light > 0) else "white"
        axes.plot(*lamp.place[plane], color=lit, markeredgecolor=_INK, markeredgewidth=0.7, zorder=5, **sign)
        _name(axes, rig.lamps.names[number], lamp.place[plane], (10, -17, 20)[place % 3])


def _name(axes: "Axes", name: str, place: Reals, points: float) -> None:
    """Write a name so far above a place."""
    look: dict[str, Any] = {"fontsize": 8, "color": _INK, "ha": "center", "zorder": 6}
    axes.annotate(name, (float(place[0]), float(place[1])), (0, points), textcoords="offset points", **look)
