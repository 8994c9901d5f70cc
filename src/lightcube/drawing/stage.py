"""A drawing of a stage from above and from the side, to scale, as the text of an SVG."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lightcube.drawing.bending import bent_ways, body_edges
from lightcube.drawing.signs import CARD, FONT, INK, LINE, PAPER, QUIET, bulb, scale_bar, sun, tints
from lightcube.drawing.svg import Box, Labels, around, disc, element, hull, moved, path, polygon, text
from lightcube.optics.glass import Glass
from lightcube.optics.rig import Rig
from lightcube.optics.stage import Lamp, Screen, Stage
from lightcube.optics.views import rotations, unit
from lightcube.wording import counted

Reals = NDArray[np.float64]

#: Pixels: the card, its margin, its head and foot, what panels leave free at their edges, the least and most they show.
_WIDTH, _MARGIN, _HEAD, _FOOT, _EDGE, _LEAST, _MOST = 1000, 24, 78, 58, 56, 260, 500
_CUBE, _INSIDE, _TABLE, _RIM, _GLASS = "#3f6c99", "#d3e2f2", "#ece8de", "#b9b3a4", "#8d979e"


def drawing(stage: Stage) -> str:
    """Draw the room at the first stop: the text of an SVG, 1000 pixels wide, of which ``class`` tells the parts.

    Left from above, x to the right and y up, right from the side, x to the right and z up, both to the same scale.
    ``cube``, ``table``, ``screen``, ``lamp`` and ``beam`` are the outlines of those; a beam is the light of a lamp that
    passes the cube's box on its way to the plane of a screen whose picture it makes at this stop.
    """
    room = _Room(stage)
    low, high = room.extent
    span = np.maximum(high - low, 1e-9)
    wide = (_WIDTH - 3 * _MARGIN) / 2
    scale = float(min((wide - 2 * _EDGE) / span[0], (_MOST - 2 * _EDGE) / span[1:].max()))
    height = max(_LEAST, scale * float(span[1:].max()) + 2 * _EDGE)
    middle = (low + high) / 2
    panels = []
    for number, (name, letters) in enumerate((("from above", "xy"), ("from the side", "xz"))):
        left = _MARGIN + number * (wide + _MARGIN)
        axes = tuple(np.eye(3)["xyz".index(letter)] for letter in letters)
        names = Labels((left + 4, _HEAD + 28, left + wide - 4, _HEAD + height - 4), PAPER, QUIET)
        box = (left, _HEAD, left + wide, _HEAD + height)
        panels.append(_Panel(name, letters, axes, box, scale, middle, names))
    whole = _HEAD + height + _FOOT
    angle = f"{stage.stops_deg[0]:g}°"
    title = f"The room at stop 1 of {len(stage.stops_deg)}, the table at {angle}" if room.has_table else "The room"
    size = f'viewBox="0 0 {_WIDTH} {whole:.0f}" width="{_WIDTH}" height="{whole:.0f}"'
    style = f'font-family={quoteattr(FONT)} font-size="12" fill="{INK}"'
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" {style}>',
        element("title", title),
        element("desc", _described(stage)),
        f'<rect width="{_WIDTH}" height="{whole:.0f}" rx="14" fill="{CARD}"/>',
        text(_MARGIN + 2, 36, title, 'font-size="19" font-weight="600"'),
        text(_MARGIN + 2, 58, _counted(stage), f'fill="{QUIET}"'),
        *(part for number, panel in enumerate(panels) for part in _panel(room, panel, f"stage-panel-{number}")),
        *_foot(room, scale, _HEAD + height + 34),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


@dataclass(frozen=True)
class _Room:
    """Where everything stands at the first stop, mm in the room's axes."""

    stage: Stage

    def placed(self, points: ArrayLike, turns: bool) -> Reals:
        """Points (or directions) as the table has turned them, if it does."""
        array = np.asarray(points, np.float64)
        if not turns:
            return array
        return np.asarray(array @ rotations(self.stage.axis, np.array([self.stage.stops_deg[0]]))[0].T)

    @cached_property
    def rig(self) -> Rig:
        """The pictures of this stop, in the cube's axes."""
        rig = self.stage.rig()
        return rig.take(np.flatnonzero((rig.stops.angle_deg - self.stage.stops_deg[0]) % 360 == 0))

    @property
    def glass(self) -> Glass | None:
        """What bends the light."""
        return None if self.stage.glass is None else self.rig.glass

    @property
    def has_table(self) -> bool:
        """Whether anything turns at all."""
        return len(self.stage.stops_deg) > 1

    @cached_property
    def cube(self) -> Reals:
        """``(8, 3)``: corners; those whose numbers differ in one bit share an edge."""
        half = np.array(self.stage.grid.size_mm[::-1]) / 2
        return self.placed(np.array(list(product((-1, 1), repeat=3))) * half, self.stage.cube_turns)

    @property
    def axis(self) -> Reals:
        """Unit vector along the turntable's axis."""
        return np.array(self.stage.axis) / np.linalg.norm(self.stage.axis)

    def rim(self, degrees: ArrayLike, radius: float = 1.0, drop: float = 0.0) -> Reals:
        """Points of the table's rim, counter-clockwise about its axis from the room's x (or, along x, from y)."""
        axis = self.axis
        start = np.array((1.0, 0.0, 0.0)) if abs(axis[0]) < 0.9 else np.array((0.0, 1.0, 0.0))
        start = start - (start @ axis) * axis
        start /= np.linalg.norm(start)
        along = self.cube @ axis
        size = 1.12 * float(np.linalg.norm(self.cube - along[:, None] * axis, axis=1).max())
        turn = np.radians(np.asarray(degrees, np.float64))[:, None]
        circle = np.cos(turn) * start + np.sin(turn) * np.cross(axis, start)
        return np.asarray(radius * size * circle - (float(along.max()) + size * (0.03 + drop)) * axis)

    def screen(self, screen: Screen) -> tuple[Reals, Reals, Reals]:
        """A screen's corners ``(4, 3)`` in order, its middle, and the unit vector out of its lit side."""
        right, down = (step / screen.pitch_mm for step in screen.steps)
        wide, high = screen.size_mm
        corners = [a * wide / 2 * right + b * high / 2 * down for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        middle = np.array(screen.centre_mm)
        placed = self.placed([*(middle + corner for corner in corners), middle], screen.turns)
        return placed[:4], placed[4], self.placed(screen.facing, screen.turns)

    @cached_property
    def lamps(self) -> dict[str, Reals]:
        """Where each lamp is drawn: parallel light comes from a sun on its side of the cube, clear of other lamps."""
        radius = float(np.linalg.norm(self.cube, axis=1).max())
        stands = [lamp for lamp in self.stage.lamps if lamp.position_mm is not None]
        points = {lamp.name: self.placed(np.array(lamp.position_mm), lamp.turns) for lamp in stands}
        solid = [self.screen(each)[1] for each in self.stage.screens] + list(points.values())
        near = max(2.0 * radius, 0.6 * max(float(np.linalg.norm(each)) for each in solid))
        for lamp in self.stage.lamps:
            if lamp.direction is not None:
                tries = [-self.way(lamp) * near * factor for factor in (1.0, 1.15, 1.3, 1.45, 1.6)]
                clear = [min(0.25 * near, *(_apart(each, other) for other in solid)) for each in tries]
                points[lamp.name] = tries[int(np.argmax(clear))]
                solid.append(points[lamp.name])
        return points

    def way(self, lamp: Lamp) -> Reals:
        """Unit direction of parallel light."""
        way = self.placed(np.array(lamp.direction), lamp.turns)
        return np.asarray(way / np.linalg.norm(way))

    @cached_property
    def extent(self) -> tuple[Reals, Reals]:
        """Least and largest x, y and z of what is to be seen."""
        seen = [self.cube, *(self.screen(each)[0] for each in self.stage.screens), np.array(list(self.lamps.values()))]
        if self.has_table:
            seen.append(self.rim(np.arange(0, 360, 15.0)))
        far = max(float(np.linalg.norm(each, axis=1).max()) for each in seen)
        light = [points for _, _, points in self.beams()]
        seen += [each[np.linalg.norm(each, axis=1) < 1.2 * far] for each in light]
        points = np.concatenate(seen)
        return points.min(axis=0), points.max(axis=0)

    def beams(self) -> Iterator[tuple[Lamp, Screen, Reals]]:
        """The beams of each lamp and screen of a picture of this stop, as points whose hull they fill."""
        shots = [
            shot for shot in self.stage.shots if (self.stage.stops_deg[shot.stop] - self.stage.stops_deg[0]) % 360 == 0
        ]
        for name, lit in dict.fromkeys((shot.screen, lamp) for shot in shots for lamp in shot.lamps):
            screen, lamp = self.stage.screen(name), self.stage.lamp(lit)
            yield lamp, screen, self._beam(lamp, screen)

    def _beam(self, lamp: Lamp, screen: Screen) -> Reals:
        corners, middle, normal = self.screen(screen)
        source = self.lamps[lamp.name]
        ways = self.cube - source if lamp.direction is None else np.broadcast_to(self.way(lamp), (8, 3))
        starts = np.broadcast_to(source, (8, 3)) if lamp.direction is None else self.cube
        fall = ways @ normal
        far = (middle - starts) @ normal / np.where(np.abs(fall) < 1e-9, 1e-9, fall)
        if lamp.direction is None:
            # past a corner beside or behind the lamp no shadow ends: then its light to the screen alone
            lands = np.all((far > 0) & (far < 100))
            return np.concatenate([source[None], starts + far[:, None] * ways if lands else corners])
        distance = 0.75 * float(np.linalg.norm(source))
        along = self.cube @ ways[0]
        lands = np.all((far > 0) & (far < 100 * distance))
        ends = far if lands else distance - along
        return np.concatenate([self.cube - (along + distance)[:, None] * ways, self.cube + ends[:, None] * ways])


def _apart(one: Reals, other: Reals) -> float:
    """How far two places are from each other in the panel where they are nearest."""
    x, y, z = one - other
    return min(math.hypot(x, y), math.hypot(x, z))


@dataclass(frozen=True)
class _Panel:
    """One of the two drawings: the room's axes to the right and up, their names, and its place on the card."""

    name: str
    letters: str
    axes: tuple[Reals, ...]
    box: Box
    scale: float
    middle: Reals
    names: Labels

    def at(self, points: Reals) -> Reals:
        """``(n, 2)``: where points of the room are drawn."""
        left, top, right, bottom = self.box
        x, y = ((np.atleast_2d(points) - self.middle) @ axis * self.scale for axis in self.axes)
        return np.stack([(left + right) / 2 + x, (top + bottom) / 2 - y], axis=1)

    @property
    def view(self) -> Reals:
        """Unit vector towards who looks."""
        return np.cross(self.axes[0], self.axes[1])

    def on_paper(self, way: Reals) -> Reals:
        """A direction in the room as it is seen, shorter if aslant; y down."""
        return np.array([way @ self.axes[0], -(way @ self.axes[1])])


def _panel(room: _Room, panel: _Panel, key: str) -> Iterator[str]:
    """Everything in one panel, back to front; names come last."""
    left, top, right, bottom = panel.box
    box = f'x="{left:.0f}" y="{top:.0f}" width="{right - left:.0f}" height="{bottom - top:.0f}" rx="9"'
    yield f'<clipPath id="{key}"><rect {box}/></clipPath>'
    yield f'<rect {box} fill="{PAPER}" stroke="{LINE}"/>'
    yield f'<g clip-path="url(#{key})" aria-label={quoteattr(panel.name)}>'
    if room.has_table:
        yield _table(room, panel)
    beams = list(room.beams())
    faint = max(0.05, 0.17 / math.sqrt(max(len(beams), 1)))
    for lamp, screen, points in [] if room.glass else beams:
        fill, edge = tints(lamp.colour)
        lines = f'stroke="{edge}" stroke-opacity="0.35" stroke-width="0.8"'
        style = f'class="beam" fill="{fill}" fill-opacity="{faint:.3f}" {lines}'
        yield polygon(hull(panel.at(points)), style, f"{lamp.name} → {screen.name}")
    solids = [(float(np.max(room.cube @ panel.view)), _cube(room, panel))]
    solids += [(float(room.screen(each)[1] @ panel.view), _screen(room, panel, each)) for each in room.stage.screens]
    yield from (solid for _, solid in sorted(solids, key=lambda pair: pair[0]))
    yield from _bent(room, panel)
    if room.has_table and abs(room.axis @ panel.view) > 0.5:
        yield from _stops(room, panel)
    yield from (_lamp(room, panel, each) for each in room.stage.lamps)
    yield "</g>"
    panel.names.busy.append(around(panel.at(room.cube)))
    named = [(room.lamps[each.name], each.name, 12.0) for each in room.stage.lamps]
    named += [(room.screen(each)[1], each.name, 7.0) for each in room.stage.screens]
    yield from (panel.names.label(panel.at(place)[0], name, radius) for place, name, radius in named)
    yield text(left + 14, top + 22, panel.name, f'font-size="11" letter-spacing="0.6" fill="{QUIET}"')
    yield _axes(panel)


def _cube(room: _Room, panel: _Panel) -> str:
    corners = panel.at(room.cube)
    shape = "×".join(f"{length:g}" for length in room.stage.grid.size_mm[::-1])
    edges = [
        path([corners[a], corners[b]], f'stroke="{_CUBE}" stroke-width="0.7" stroke-opacity="0.45"')
        for a in range(8)
        for b in (a | 1, a | 2, a | 4)
        if a < b
    ]
    style = (
        f'class="cube" fill="{_INSIDE}" fill-opacity="0.8" stroke="{_CUBE}" stroke-width="1.5" stroke-linejoin="round"'
    )
    return polygon(hull(corners), style, f"cube, {shape} mm") + "".join(edges)


def _bent(room: _Room, panel: _Panel) -> Iterator[str]:
    """The outline of what bends the light, its bottom where that is blocked, and beams that it bends."""
    if room.glass is None:
        return
    grid, turns = room.stage.grid, room.stage.cube_turns
    for ends in body_edges(room.glass, grid, room.rig.views.lamps[0, :3]):
        style = f'class="glass" stroke="{_CUBE}" stroke-width="1.2" stroke-opacity="0.8"'
        yield path(list(panel.at(room.placed(ends, turns))), style)
    if room.glass.bottom == "blocked" and abs(room.axis @ panel.view) < 0.5:
        low = room.cube[np.argsort(room.cube @ room.axis)[:4]]
        style = f'class="blocked" fill="{INK}" fill-opacity="0.25" stroke="{INK}" stroke-width="3"'
        yield polygon(hull(panel.at(low)), style, "no light leaves through the bottom")
    for picture, (enters, leaves, pixel) in bent_ways(room.rig):
        lamp = room.stage.lamps[int(room.rig.sums.lamp[room.rig.starts[picture]])]
        way = np.asarray(unit(room.rig.views.lamps[room.rig.starts[picture], :3]))
        back = float(np.linalg.norm(room.lamps[lamp.name])) + float(enters @ way)
        points = room.placed([enters - max(back, 0.0) * way, enters, leaves, pixel], turns)
        style = f'class="bent" stroke="{tints(lamp.colour)[1]}" stroke-width="1" stroke-opacity="0.75"'
        yield path(list(panel.at(points)), style)


def _table(room: _Room, panel: _Panel) -> str:
    turn = np.arange(0, 360, 5.0)
    slab = np.concatenate([panel.at(room.rim(turn)), panel.at(room.rim(turn, drop=0.05))])
    style = f'class="table" fill="{_TABLE}" stroke="{_RIM}" stroke-width="1"'
    return polygon(hull(slab), style, "turntable")


def _stops(room: _Room, panel: _Panel) -> Iterator[str]:
    """Ticks and numbers of the stops, as many as there is room for, and the pointer that turns with the table."""
    stops = np.array(room.stage.stops_deg)
    for outer, inner in zip(panel.at(room.rim(stops)), panel.at(room.rim(stops, 0.95)), strict=True):
        yield path([inner, outer], f'stroke="{QUIET}" stroke-width="1"')
    shown: list[Reals] = []
    halo = f'paint-order="stroke" stroke="{PAPER}" stroke-width="2" stroke-opacity="0.7"'
    for number, place in enumerate(panel.at(room.rim(stops, 1.11)), 1):
        if all(np.hypot(*(place - other)) > 15 for other in shown):
            shown.append(place)
            panel.names.mark(place, 6.5)
            style = f'font-size="9" text-anchor="middle" fill="{QUIET}" {halo}'
            yield text(place[0], place[1] + 3, str(number), style)
    pointer = np.concatenate([room.rim(stops[:1], 0.95), room.rim(stops[0] + np.array([-3.5, 3.5]), 0.86)])
    yield polygon(panel.at(pointer), f'fill="{INK}"', "stop 1")


def _screen(room: _Room, panel: _Panel, screen: Screen) -> str:
    """The screen, and a pin out of its lit side: a ring where it points at who looks, crossed where away."""
    corners, middle, normal = room.screen(screen)
    outline, place, way = panel.at(corners), panel.at(middle)[0], panel.on_paper(normal)
    style = (
        f'class="screen" fill="{_GLASS}" fill-opacity="0.13" stroke="{INK}" stroke-width="2.6" stroke-linejoin="round"'
    )
    parts = [polygon(outline, style, screen.name)]
    panel.names.mark(place, 6)
    panel.names.busy.append(around(outline))
    thin = f'stroke="{INK}" stroke-width="1.2"'
    if np.hypot(*way) > 0.35:
        tip = place + 11 * way
        panel.names.mark(tip, 4)
        parts += [path([place, tip], thin), disc(tip, 2.6, f'fill="{INK}"')]
    else:
        parts.append(disc(place, 4.5, f'fill="{PAPER}" {thin}'))
        if normal @ panel.view > 0:
            parts.append(disc(place, 1.6, f'fill="{INK}"'))
        else:
            parts += [path([moved(place, -3, -3 * s), moved(place, 3, 3 * s)], thin) for s in (-1, 1)]
    return "".join(parts)


def _lamp(room: _Room, panel: _Panel, lamp: Lamp) -> str:
    """A sun with an arrow for parallel light, a bulb for a point."""
    place = panel.at(room.lamps[lamp.name])[0]
    panel.names.mark(place, 12)
    symbol = sun(place, lamp.colour) if lamp.direction is not None else bulb(place, lamp.colour)
    if lamp.direction is not None and np.hypot(*(way := panel.on_paper(room.way(lamp)))) > 0.25:
        unit = way / np.hypot(*way)
        tail, tip = place + 17 * unit, place + 17 * unit + 26 * way
        panel.names.busy.append(around(np.array([tail, tip])))
        side = np.array([-unit[1], unit[0]])
        edge = tints(lamp.colour)[1]
        symbol += path([tail, tip - 3 * unit], f'stroke="{edge}" stroke-width="1.8" stroke-linecap="round"')
        symbol += polygon(
            np.array([tip + 2 * unit, tip - 5 * unit + 4 * side, tip - 5 * unit - 4 * side]), f'fill="{edge}"'
        )
    return f'<g class="lamp">{element("title", lamp.name)}{symbol}</g>'


def _axes(panel: _Panel) -> str:
    """Which way the room's axes go, in the lower left corner."""
    corner = np.array([panel.box[0] + 18, panel.box[3] - 16])
    quiet = f'font-size="10" fill="{QUIET}"'
    return (
        path([moved(corner, 0, -22), corner, moved(corner, 22, 0)], f'stroke="{QUIET}" stroke-width="1"')
        + text(corner[0] + 26, corner[1] + 3, panel.letters[0], quiet)
        + text(corner[0] - 2, corner[1] - 27, panel.letters[1], quiet)
    )


def _foot(room: _Room, scale: float, y: float) -> Iterator[str]:
    """The scale bar and what the signs mean."""
    yield from scale_bar(_MARGIN + 2, y, scale)
    x = _MARGIN + 250.0
    quiet = f'fill="{QUIET}"'
    for sign, words in _signs(room, y - 4):
        yield f'<g transform="translate({x:.0f} 0)">{sign}{text(24, y, words, quiet)}</g>'
        x += 24 + 6.0 * len(words) + 26


def _signs(room: _Room, y: float) -> Iterator[tuple[str, str]]:
    at = np.array([8.0, y])
    if any(lamp.direction is not None for lamp in room.stage.lamps):
        yield sun(at, (1.0, 1.0, 1.0)), "parallel light"
    if any(lamp.position_mm is not None for lamp in room.stage.lamps):
        yield bulb(at, (1.0, 1.0, 1.0)), "point lamp"
    pin = path([moved(at, -3, -8), moved(at, -3, 8)], f'stroke="{INK}" stroke-width="2.6"')
    pin += path([moved(at, -3, 0), moved(at, 5, 0)], f'stroke="{INK}" stroke-width="1.2"')
    yield pin + disc(moved(at, 6, 0), 2.6, f'fill="{INK}"'), "screen, pin on its lit side"
    if room.has_table:
        arrow = np.array([moved(at, -6, 4), moved(at, 6, 0), moved(at, -6, -4)])
        yield polygon(arrow, f'fill="{INK}"'), "the table's pointer; numbers: stops"


def _counted(stage: Stage) -> str:
    """How much there is of everything, in one line."""
    counts = [(len(stage.lamps), "lamp"), (len(stage.screens), "screen"), (len(stage.stops_deg), "stop")]
    counts.append((len(stage.shots), "picture"))
    shape = " × ".join(str(n) for n in reversed(stage.grid.shape))
    size = " × ".join(f"{length:.4g}" for length in reversed(stage.grid.size_mm))
    said = [counted(count, what) for count, what in counts]
    return "  ·  ".join([f"cube of {shape} voxels, {size} mm", *said])


def _described(stage: Stage) -> str:
    lamps, screens = (", ".join(each.name for each in things) for things in (stage.lamps, stage.screens))
    return f"Seen from above and from the side: {_counted(stage)}. Lamps: {lamps}. Screens: {screens}."
