"""How a stack of films is put together: where its lamps stand, how far its films are apart, and what each lamp shows.

It is the text of an SVG, 1000 pixels wide.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from xml.sax.saxutils import quoteattr

import numpy as np

from lightcube.drawing.signs import CARD, FONT, INK, LINE, PAPER, QUIET, bulb, scale_bar, sun, tints
from lightcube.drawing.stacks import followed, is_anywhere, lowered
from lightcube.drawing.svg import Labels, Reals, disc, element, moved, path, polygon, text
from lightcube.optics.moves import places_of
from lightcube.optics.naming import clock, lamps_of, moves_of, off_upright_deg, shifts_of
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.wording import counted

#: Pixels: the card, its margin, its head and foot; a panel, and what is free at its edges; a line of the table.
_WIDTH, _MARGIN, _HEAD, _FOOT, _PANEL, _EDGE, _ROW = 1000, 24, 78, 58, 400, 46, 27
#: Pixels from a film to the next, at least, where heights are not to scale; numbered films at most; lines at most.
_APART, _NUMBERED, _MOST = 15.0, 24, 24
#: Pixels between a lamp and the top film, and room for lamps above it.
_AWAY, _SKY = 92.0, 118.0
_FILM, _TINT = "#3f6c99", "#d3e2f2"
_GREY = f'font-size="11" fill="{QUIET}"'


def assembly(stack: Stack, rig: Rig, names: Sequence[str]) -> str:
    """Draw how films are put together; `names` are those of the rig's pictures.

    Of its parts ``class`` tells what they are: ``film``, ``sheet``, ``lamp``, ``beam``, ``gap``, ``shift``.
    """
    room = _Films(stack, rig, tuple(names))
    rows = min(len(names), _MOST) + (len(names) > _MOST)
    whole = _HEAD + _PANEL + 30 + _ROW * (rows + 1) + _FOOT
    wide = (_WIDTH - 3 * _MARGIN) / 2
    size = f'viewBox="0 0 {_WIDTH} {whole:.0f}" width="{_WIDTH}" height="{whole:.0f}"'
    style = f'font-family={quoteattr(FONT)} font-size="12" fill="{INK}"'
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" {style}>',
        element("title", "How the films are put together"),
        element("desc", f"{room.said}. Lamps: {', '.join(rig.lamps.names)}. Pictures: {', '.join(names)}."),
        f'<rect width="{_WIDTH}" height="{whole:.0f}" rx="14" fill="{CARD}"/>',
        text(_MARGIN + 2, 36, "How the films are put together", 'font-size="19" font-weight="600"'),
        text(_MARGIN + 2, 58, room.said, f'fill="{QUIET}"'),
        *_framed("from above", _MARGIN, _above(room, _MARGIN, wide)),
        *_framed("from the side", 2 * _MARGIN + wide, _aside(room, 2 * _MARGIN + wide, wide)),
        *_table(room, _HEAD + _PANEL + 38),
        *scale_bar(_MARGIN + 2, whole - 26, room.scale),
        *_signs(room, whole - 26),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


@dataclass(frozen=True)
class _Films:
    """A stack with its lamps and pictures, as it is drawn."""

    stack: Stack
    given: Rig
    names: tuple[str, ...]

    @cached_property
    def rig(self) -> Rig:
        """With its sheets where they are drawn."""
        return lowered(self.stack, self.given)

    @property
    def said(self) -> str:
        """How much there is of everything."""
        films, ny, nx = self.stack.shape
        high, deep, wide = (f"{length:.4g}" for length in self.stack.size_mm)
        between = "" if self.stack.index == 1 else f"in a medium of index {self.stack.index:g}, "
        return (
            f"stack of {counted(films, 'film')} of {nx} × {ny} cells, {between}{wide} × {deep} × {high} mm  ·  "
            f"{counted(len(self.lamps), 'lamp')}  ·  {counted(len(self.names), 'picture')}"
        )

    @cached_property
    def lamps(self) -> list[int]:
        """Numbers of the lamps that light a picture."""
        return sorted(set(self.rig.sums.lamp.tolist()))

    def towards(self, lamp: int) -> Reals:
        """Unit vector from the middle of the films to a lamp."""
        table = self.rig.views.lamps[int(np.argmax(self.rig.sums.lamp == lamp))]
        way = table[:3] if table[3] else -table[:3]
        return np.asarray(way / np.linalg.norm(way))

    def is_near(self, lamp: int) -> bool:
        """Whether a lamp is at a place."""
        return bool(self.rig.views.lamps[int(np.argmax(self.rig.sums.lamp == lamp)), 3])

    def colour(self, lamp: int) -> tuple[float, ...]:
        """A lamp's light."""
        return tuple(self.rig.sums.of_colours(3)[int(np.argmax(self.rig.sums.lamp == lamp))].tolist())

    def sign(self, lamp: int, place: Reals) -> str:
        """A lamp, drawn at a place, with its name."""
        drawn = (bulb if self.is_near(lamp) else sun)(place, self.colour(lamp))
        return f'<g class="lamp">{element("title", self.rig.lamps.names[lamp])}{drawn}</g>'

    def place_in_words(self, lamp: int) -> str:
        """Where a lamp stands: degrees off upright, and where the hand of a clock points, seen from above."""
        way = self.towards(lamp)
        off = float(off_upright_deg(way))
        hand = clock(float(way[0]), float(way[1]))
        said = f"{off:.1f}° off upright, at {hand}" if hand else "upright"
        if not self.is_near(lamp):
            return said
        place = self.rig.views.lamps[int(np.argmax(self.rig.sums.lamp == lamp)), :3]
        return f"{said}, {np.linalg.norm(place):.4g} mm away"

    @cached_property
    def sheets(self) -> Reals:
        """``(pictures, 4, 3)``: corners of each picture on its sheet, mm."""
        views, first = self.rig.views, self.rig.starts[:-1]
        rows, columns = self.rig.picture_shape
        right, down = views.column_steps_mm[first] * columns / 2, views.row_steps_mm[first] * rows / 2
        corners = [a * right + b * down for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        return views.origins_mm[first][:, None] + np.stack(corners, axis=1)

    @cached_property
    def scale(self) -> float:
        """Pixels per mm, of both panels."""
        wide = (_WIDTH - 3 * _MARGIN) / 2 - 2 * _EDGE - 60
        across = max(self.stack.size_mm[2], self.stack.size_mm[1], float(np.ptp(self.sheets[..., 0])))
        deep = self.stack.heights_mm[-1] - min(float(self.sheets[..., 2].min()), self.stack.heights_mm[0])
        return float(min(wide / across, (_PANEL - _SKY - 40) / max(deep, 1e-9)))

    @cached_property
    def spread(self) -> bool:
        """Whether films are drawn farther apart than they are, so that they can be told apart."""
        gaps = np.diff(self.stack.heights_mm) * self.scale
        return len(gaps) > 0 and float(gaps.min()) < _APART - 4 and self.stack.shape[0] <= _NUMBERED

    @cached_property
    def levels(self) -> Reals:
        """Pixels above the lowest film at which each is drawn."""
        if self.spread:
            return np.asarray(np.arange(self.stack.shape[0]) * _APART, np.float64)
        return np.asarray((np.array(self.stack.heights_mm) - self.stack.heights_mm[0]) * self.scale, np.float64)

    def level(self, z: Reals) -> Reals:
        """Pixels above the lowest film at which heights are drawn."""
        low, high = self.stack.heights_mm[0], self.stack.heights_mm[-1]
        part = np.clip((z - low) / max(high - low, 1e-9), 0, 1)
        beyond = np.minimum(z - low, 0) + np.maximum(z - high, 0)
        return np.asarray(beyond * self.scale + part * self.levels[-1], np.float64)


def _framed(name: str, left: float, parts: Iterator[str]) -> Iterator[str]:
    """A panel with a name, and what is in it."""
    wide = (_WIDTH - 3 * _MARGIN) / 2
    box = f'x="{left:.0f}" y="{_HEAD}" width="{wide:.0f}" height="{_PANEL}" rx="9"'
    key = name.replace(" ", "-")
    yield f'<clipPath id="films-{key}"><rect {box}/></clipPath>'
    yield f'<rect {box} fill="{PAPER}" stroke="{LINE}"/>'
    yield f'<g clip-path="url(#films-{key})" aria-label={quoteattr(name)}>'
    yield from parts
    yield "</g>"
    yield text(left + 14, _HEAD + 22, name, f'font-size="11" letter-spacing="0.6" fill="{QUIET}"')


def _above(room: _Films, left: float, wide: float) -> Iterator[str]:
    """The films from above, and the lamps around them: the farther from the middle, the more aslant is their light."""
    middle = np.array([left + wide / 2, _HEAD + _PANEL / 2 + 6])
    half = np.array(room.stack.size_mm[:0:-1]) / 2 * room.scale
    corners = middle + np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half
    style = f'class="film" fill="{_TINT}" fill-opacity="0.75" stroke="{_FILM}" stroke-width="1.5"'
    yield polygon(corners, style, "films")
    ways = [room.towards(lamp) for lamp in room.lamps]
    steepest = max(float(off_upright_deg(way)) for way in ways)
    step = next(each for each in (5, 10, 15, 30) if each * 4 >= steepest or each == 30)
    pixels = (_PANEL / 2 - 44) / max(step * math.ceil(steepest / step), step)
    for number in range(1, math.ceil(steepest / step) + 1):
        yield disc(middle, number * step * pixels, f'fill="none" stroke="{LINE}" stroke-width="1"')
        yield text(middle[0] + 3, middle[1] + number * step * pixels - 4, f"{number * step}°", _GREY)
    names = Labels((left + 4, _HEAD + 28, left + wide - 4, _HEAD + _PANEL - 4), PAPER, QUIET)
    places = [middle + off_upright_deg(way) * pixels * _flat(way) for way in ways]
    for lamp, place in zip(room.lamps, places, strict=True):
        names.mark(place, 12)
        line = f'stroke="{tints(room.colour(lamp))[1]}" stroke-width="1.2" stroke-dasharray="2 4"'
        yield path([place, middle], line)
        yield room.sign(lamp, place)
    for lamp, place in zip(room.lamps, places, strict=True):
        yield names.label(place, room.rig.lamps.names[lamp], 12.0)
    yield text(left + wide - 14, _HEAD + 22, "rings: degrees off upright", f'text-anchor="end" {_GREY}')
    yield text(left + 14, _HEAD + _PANEL - 12, "12:00 is the top of the pictures", _GREY)


def _flat(way: Reals) -> Reals:
    """Which way on paper something lies, seen from above: y is down."""
    length = float(np.hypot(way[0], way[1]))
    return np.array([way[0], -way[1]]) / length if length > 1e-9 else np.zeros(2)


def _aside(room: _Films, left: float, wide: float) -> Iterator[str]:
    """The films from the side with their numbers and gaps, the light of each lamp, and the sheet below."""
    base = _HEAD + _SKY + 14 + float(room.levels[-1])
    middle = left + wide / 2 - 14

    def at(x: Reals, z: Reals) -> Reals:
        return np.stack([middle + room.scale * x, base - room.level(z)], axis=-1)

    yield from (_beam(room, lamp, at) for lamp in room.lamps)
    heights = sorted({round(float(sheet[:, 2].mean()), 6) for sheet in room.sheets})
    for z in heights:
        sheet = room.sheets[np.abs(room.sheets[..., 2].mean(axis=1) - z) < 1e-5]
        ends = at(np.array([sheet[..., 0].min(), sheet[..., 0].max()]), np.array([z, z]))
        yield path([*ends], f'class="sheet" stroke="{INK}" stroke-width="3" stroke-linecap="round"')
        yield text(ends[0][0], ends[0][1] + 16, "sheet of paper, or a wall", _GREY)
    half = room.stack.size_mm[2] / 2 * room.scale
    shown = room.stack.shape[0] <= _NUMBERED
    for number, level in enumerate(room.levels, 1):
        ends = np.array([[middle - half, base - level], [middle + half, base - level]])
        yield path([*ends], f'class="film" stroke="{_FILM}" stroke-width="2.2"')
        if shown or number in (1, room.stack.shape[0]):
            yield text(ends[0][0] - 8, ends[0][1] + 4, str(number), 'font-size="11" text-anchor="end"')
    yield from _gaps(room, middle + half + 10, base, heights)
    yield from _over(room, np.array([middle, base - room.levels[-1]]), (left, wide))


def _over(room: _Films, top: Reals, panel: tuple[float, float]) -> Iterator[str]:
    """Lamps over the films, seen from the side, with their names; some stand behind others."""
    named: dict[tuple[float, float], list[str]] = {}
    for lamp in room.lamps:
        way = room.towards(lamp)
        x, y = top + _AWAY * np.array([way[0], -abs(way[2])])
        named.setdefault((round(x), round(y)), []).append(room.rig.lamps.names[lamp])
        yield room.sign(lamp, np.array([x, y]))
    left, wide = panel
    names = Labels((left + 4, _HEAD + 28, left + wide - 4, _HEAD + _PANEL - 4), PAPER, QUIET)
    for spot in named:
        names.mark(np.array(spot), 12)
    yield from (names.label(np.array(spot), ", ".join(own), 12.0) for spot, own in named.items())


def _beam(room: _Films, lamp: int, at: Callable[[Reals, Reals], Reals]) -> str:
    """The light of a lamp that makes its first picture, from above the films to the sheet."""
    view = int(np.argmax(room.rig.sums.lamp == lamp))
    sheet = room.sheets[room.rig.sums.picture[view]]
    low, high = room.stack.heights_mm[0], room.stack.heights_mm[-1]
    top = high + 0.62 * _AWAY / room.scale
    if room.is_near(lamp):
        top = float(np.clip(room.rig.views.lamps[view, 2], high, top))
    heights = np.array([sheet[:, 2].mean(), low, high, top])
    ends = followed(room.stack, room.rig, view, sheet, np.sort(heights))
    sides = [ends[..., 0].min(axis=0), ends[..., 0].max(axis=0)[::-1]]
    outline = at(np.concatenate(sides), np.concatenate([np.sort(heights), np.sort(heights)[::-1]]))
    fill, edge = tints(room.colour(lamp))
    faint = max(0.06, 0.17 / math.sqrt(len(room.lamps)))
    style = f'class="beam" fill="{fill}" fill-opacity="{faint:.3f}" stroke="{edge}" stroke-opacity="0.3"'
    return polygon(outline, style, room.rig.lamps.names[lamp])


def _gaps(room: _Films, x: float, base: float, sheets: Sequence[float]) -> Iterator[str]:
    """How far films are apart, and the sheet below the lowest."""
    heights, levels = np.array(room.stack.heights_mm), room.levels
    gaps = np.diff(heights)
    alike = len(gaps) > 0 and float(np.ptp(gaps)) < 1e-6 * max(float(gaps.max()), 1e-9)
    if alike:
        times = f"{len(gaps)} × " if len(gaps) > 1 else ""
        yield from _measured(x, base - levels[-1], base - levels[0], times + _gap(gaps[0]))
    elif len(gaps) <= _NUMBERED:
        for gap, low, high in zip(gaps, levels[:-1], levels[1:], strict=True):
            yield from _measured(x, base - high, base - low, _gap(gap))
    low = sheets[0] if sheets else heights[0]
    free = all(is_anywhere(room.stack, room.given))
    below = base - float(room.level(np.array(low)))
    if below > base + 4:
        near = any(room.is_near(lamp) for lamp in room.lamps)
        said = f"{heights[0] - low:.4g} mm"
        if free:
            said = "larger, farther" if near else "any distance"
        yield from _measured(x, base, below, said)
    if room.spread:
        yield text(x - 2, base - levels[-1] - 10, "not to scale", _GREY)


def _gap(gap_mm: float) -> str:
    """How far one film is from the next."""
    return f"{gap_mm:.4g} mm" if gap_mm else "touching"


def _measured(x: float, top: float, bottom: float, said: str) -> Iterator[str]:
    """A dimension, its ends and its length in words."""
    line = f'class="gap" stroke="{QUIET}" stroke-width="1"'
    ends = [(x + 4, top + 1), (x, top + 1), (x, bottom - 1), (x + 4, bottom - 1)]
    yield path([np.array(end) for end in ends], line)
    yield text(x + 8, (top + bottom) / 2 + 4, said, _GREY)


def _table(room: _Films, y: float) -> Iterator[str]:
    """A line for each picture: its name, its lamps, where these stand, and how the films lie."""
    moves, lamps = moves_of(room.rig), lamps_of(room.rig)
    columns = (_MARGIN + 4.0, 270.0, 420.0, 640.0)
    heads = ("picture", "lamp", "where it stands", "films" if any(moves) else "")
    yield from (text(x, y + 6, head, _GREY) for x, head in zip(columns, heads, strict=True))
    places, longest = places_of(room.stack, room.rig), 1e-9
    longest = max(longest, float(np.abs(shifts_of(places)[0]).max()))
    for picture, name in enumerate(room.names[:_MOST]):
        row = y + 6 + _ROW * (picture + 1)
        yield path([np.array([_MARGIN, row - 18]), np.array([_WIDTH - _MARGIN, row - 18])], f'stroke="{LINE}"')
        own = room.rig.sums.lamp[room.rig.sums.picture == picture].tolist()
        yield text(columns[0], row, _cut(name, 34))
        yield text(columns[1], row, _cut(lamps[picture], 21))
        yield text(columns[2], row, room.place_in_words(own[0]) if len(own) == 1 else counted(len(own), "lamp"))
        if any(moves):
            yield from _shifts(np.array([columns[3] + 8, row - 4]), places[picture], longest)
            yield text(columns[3] + 28, row, _cut(moves[picture] or "as they are", 46))
    if len(room.names) > _MOST:
        more = counted(len(room.names) - _MOST, "more picture")
        yield text(columns[0], y + 6 + _ROW * (_MOST + 1), f"and {more}", _GREY)


def _shifts(middle: Reals, places: Reals, longest: float) -> Iterator[str]:
    """Which way each film is slid, as arrows; the longest slide of all pictures is longest."""
    yield disc(middle, 1.6, f'fill="{QUIET}"')
    for right, up in shifts_of(places)[0]:
        length = math.hypot(right, up)
        if length < 1e-6:
            continue
        way = np.array([right, -up]) / length
        side = np.array([-way[1], way[0]])
        tip = middle + way * (5 + 7 * length / longest)
        style = f'class="shift" stroke="{_FILM}" stroke-width="1.6" stroke-linecap="round"'
        yield path([middle, tip - 2 * way], style)
        yield polygon(np.array([tip, tip - 4 * way + 2.6 * side, tip - 4 * way - 2.6 * side]), f'fill="{_FILM}"')


def _cut(words: str, most: int) -> str:
    """Words, shortened if they are long."""
    return words if len(words) <= most else words[: most - 1] + "…"


def _signs(room: _Films, y: float) -> Iterator[str]:
    """What the signs mean."""
    x, at = _MARGIN + 250.0, np.array([8.0, y - 4])
    signs = [(sun(at, (1.0, 1.0, 1.0)), "parallel light")] * any(not room.is_near(lamp) for lamp in room.lamps)
    signs += [(bulb(at, (1.0, 1.0, 1.0)), "lamp at a place")] * any(room.is_near(lamp) for lamp in room.lamps)
    ends = [moved(at, -8, 0), moved(at, 8, 0)]
    signs.append((path(ends, f'stroke="{_FILM}" stroke-width="2.2"'), "film; 1 lies lowest"))
    for sign, words in signs:
        yield f'<g transform="translate({x:.0f} 0)">{sign}{text(24, y, words, _GREY)}</g>'
        x += 24 + 6.0 * len(words) + 26
