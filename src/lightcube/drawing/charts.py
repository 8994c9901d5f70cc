"""Curves and bars of a report as inline SVG, whose colours are those of the page (`style.css`)."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing.svg import disc, path, polygon, text
from lightcube.scoring.between import LOBE_DB, Curve

Reals = NDArray[np.float64]

#: Of a chart in its own units, and what is left free for the numbers at its edges.
_WIDTH, _HEIGHT, _LEFT, _RIGHT, _TOP, _BOTTOM = 720.0, 230.0, 46.0, 10.0, 16.0, 38.0
#: Names at the ends of lines stand so far apart.
_LETTERS = 12.0
#: At most so many ticks along an axis.
_TICKS = 9


@dataclass
class _Chart:
    """A coordinate system that is drawn into; `across` and `up` are the least and the largest value of its axes."""

    across: tuple[float, float]
    up: tuple[float, float]
    logarithmic: bool = False
    parts: list[str] = field(default_factory=list)

    def at(self, x: Reals | float, y: Reals | float) -> Reals:
        """``(n, 2)``: where values are drawn."""
        x, y = np.broadcast_arrays(np.atleast_1d(x), np.atleast_1d(y))
        low, high = self.up
        if self.logarithmic:
            y, low, high = np.log(y), math.log(low), math.log(high)
        right = _LEFT + (x - self.across[0]) / (self.across[1] - self.across[0]) * (_WIDTH - _LEFT - _RIGHT)
        down = _HEIGHT - _BOTTOM - (y - low) / (high - low) * (_HEIGHT - _TOP - _BOTTOM)
        return np.stack([right, down], axis=1)

    def line(self, y: float, kind: str) -> None:
        """A line from side to side."""
        ends = np.array(self.across)
        self.parts.append(path(list(self.at(ends, y)), f'class="{kind}"'))

    def axes(self, across: Sequence[float], up: Sequence[float], names: tuple[str, str]) -> None:
        """Numbers along both axes, lines across, and what the axes are."""
        for value in up:
            self.line(value, "grid")
            place = self.at(self.across[0], value)[0]
            self.parts.append(text(place[0] - 6, place[1] + 4, f"{value:g}", 'text-anchor="end"'))
        floor = self.up[0]
        for value in across:
            place = self.at(value, floor)[0]
            self.parts.append(text(place[0], place[1] + 15, f"{value:g}", 'text-anchor="middle"'))
        self.parts.append(text(_WIDTH - _RIGHT, _HEIGHT - 5, names[0], 'text-anchor="end" class="name"'))
        self.parts.append(text(4, 10, names[1], 'class="name"'))

    def drawing(self, label: str) -> str:
        """The text of the SVG; `label` says in words what it shows."""
        box = f'viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}"'
        return "\n".join([f'<svg class="chart" {box} role="img" aria-label={quoteattr(label)}>', *self.parts, "</svg>"])


def picture_bars(names: Sequence[str], psnr: Reals, expected: Reals | None, label: str) -> str:
    """PSNR of each picture as a bar, the mean as a line, and what was expected of each as a mark."""
    count = len(names)
    highest = max(psnr.max(), LOBE_DB, 0.0 if expected is None else expected.max())
    chart = _Chart((0.5, count + 0.5), (min(0.0, float(psnr.min())), 1.06 * float(highest)))
    numbers = [number for number in _ticks(1, count) if number == int(number) and number >= 1]
    chart.axes(numbers, _ticks(*chart.up), ("picture", "PSNR, dB"))
    half = 0.36 if count < 120 else 0.5
    base = max(0.0, chart.up[0])
    for number, (name, value) in enumerate(zip(names, psnr, strict=True), start=1):
        sides = number + half * np.array([-1, -1, 1, 1])
        kind = "worst" if value == psnr.min() else "bar"
        corners = chart.at(sides, np.array([base, value, value, base]))
        chart.parts.append(polygon(corners, f'class="{kind}"', f"{number} {name}: {value:.2f} dB"))
    if expected is not None:
        for number, value in enumerate(expected, start=1):
            chart.parts.append(path(list(chart.at(number + half * np.array([-1, 1]), value)), 'class="expected"'))
    chart.line(float(psnr.mean()), "mean")
    return chart.drawing(label)


def between_curve(curve: Curve, label: str) -> str:
    """PSNR against the angle; the parts that belong to neighbouring pictures differ in colour, the stops are dots."""
    start = float(curve.angles_deg[0])
    up = min(0.0, float(curve.psnr.min())), 1.06 * float(curve.psnr.max())
    chart = _Chart((start, start + curve.period_deg), up)
    turn = np.arange(-360.0, 721.0, 45.0 if curve.period_deg == 360 else 30.0)
    shown = [float(angle) for angle in turn if chart.across[0] <= angle <= chart.across[1]]
    chart.axes(shown, _ticks(*chart.up), ("turntable angle, degrees", "PSNR, dB"))
    if chart.up[1] > LOBE_DB:
        chart.line(LOBE_DB, "limit")
    starts = np.flatnonzero(np.diff(curve.nearest)) + 1
    for number, part in enumerate(np.split(np.arange(len(curve.angles_deg)), starts)):
        line = chart.at(curve.angles_deg[part], curve.psnr[part])
        chart.parts.append(path(list(line), f'class="curve-{number % 2}"'))
    stops = np.flatnonzero(curve.offsets_deg == 0)
    for place in chart.at(curve.angles_deg[stops], curve.psnr[stops]):
        chart.parts.append(disc(place, 2.6 if len(stops) < 60 else 1.4, 'class="stop"'))
    return chart.drawing(label)


def lamp_powers(places: Reals, powers: Reals, most: float, label: str) -> str:
    """Lamp powers ``(lamps, colours)`` over the pictures that they are for, counted from 1, on a logarithmic scale."""
    low, high = float(powers.min()), max(float(powers.max()), most)
    chart = _Chart((0.5, float(places.max()) + 0.5), (low / 1.25, high * 1.25), logarithmic=True)
    numbers = [number for number in _ticks(1, float(places.max())) if number == int(number) and number >= 1]
    chart.axes(numbers, _doublings(*chart.up), ("picture", "lamp power"))
    chart.line(most, "limit")
    size = 3.2 if len(places) < 120 else 1.8
    for colour, values in enumerate(powers.T):
        side = 0.16 * (colour - (powers.shape[1] - 1) / 2)
        kind = f'class="colour-{colour}"' if powers.shape[1] == 3 else 'class="stop"'
        chart.parts += [_mark(place, colour, size, kind) for place in chart.at(places + side, values)]
    return chart.drawing(label)


def shares(edges: Reals, parts: Reals, names: tuple[str, str], label: str) -> str:
    """Bars ``parts`` (per cent) over the stretches between `edges`; `names` are those of the axes."""
    chart = _Chart((float(edges[0]), float(edges[-1])), (0.0, 1.06 * max(float(parts.max()), 1e-9)))
    chart.axes(_ticks(*chart.across), _ticks(*chart.up), names)
    for low, high, part in zip(edges[:-1], edges[1:], parts, strict=True):
        corners = chart.at(np.array([low, low, high, high]), np.array([0, part, part, 0]))
        chart.parts.append(polygon(corners, 'class="bar"', f"{low:.3g} to {high:.3g}: {part:.1f} %"))
    return chart.drawing(label)


def scored_lines(places: Reals, lines: Mapping[str, Reals], across: str, label: str) -> str:
    """PSNR of some pictures against one number, each by its name."""
    every = np.concatenate(list(lines.values()))
    low = max(0.0, 5 * math.floor(float(every.min()) / 5) - 5)
    chart = _Chart((float(places[0]), float(places[-1])), (low, float(every.max()) + 2))
    chart.axes(_ticks(*chart.across), _ticks(*chart.up), (across, "PSNR, dB"))
    ends = {name: chart.at(places[-1], values[-1])[0] for name, values in lines.items()}
    free = math.inf
    for name in sorted(ends, key=lambda each: -ends[each][1]):  # from below, so that no name lies on another
        free = min(free - _LETTERS, ends[name][1] - 4)
        chart.parts.append(text(ends[name][0] - 4, free, name, 'text-anchor="end"'))
    for number, values in enumerate(lines.values()):
        chart.parts.append(path(list(chart.at(places, values)), f'class="curve-{number % 2}"'))
    return chart.drawing(label)


def _mark(place: Reals, colour: int, size: float, kind: str) -> str:
    """A disc, a square or a triangle, so that colours differ in shape too."""
    if colour == 0:
        return disc(place, size, kind)
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)] if colour == 1 else [(0, -1.3), (1.2, 0.9), (-1.2, 0.9)]
    return polygon(place + size * 0.95 * np.array(corners, np.float64), kind)


def _ticks(low: float, high: float) -> list[float]:
    """Round numbers from low to high."""
    rough = max(high - low, 1e-9) / _TICKS
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= rough)
    first = math.ceil(low / step - 1e-9)
    return [number * step for number in range(first, math.floor(high / step + 1e-9) + 1)]


def _doublings(low: float, high: float) -> list[float]:
    """Powers of two between, every second or fourth where they are many; round numbers where there is but one."""
    exponents = range(math.ceil(math.log2(low)), math.floor(math.log2(high)) + 1)
    step = max(1, -(-len(exponents) // _TICKS))
    found = [2.0**exponent for exponent in exponents if exponent % step == 0]
    return found if len(found) > 1 else _ticks(low, high)
