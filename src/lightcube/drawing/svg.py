"""Small pieces of drawings: the text of SVG elements, names beside symbols, hulls; lengths are pixels, y is down."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import product
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import shown

Reals = NDArray[np.float64]
#: Least x and y, largest x and y.
Box = tuple[float, float, float, float]
#: Names longer than so many letters are shortened.
_LETTERS = 22


def polygon(points: Reals, style: str, title: str = "") -> str:
    """A filled outline ``(n, 2)``; `style` is more attributes, `title` its tooltip."""
    inside = element("title", title) if title else ""
    return f'<polygon points="{_listed(points)}" {style}>{inside}</polygon>'


def path(points: Sequence[Reals], style: str) -> str:
    """A line through points."""
    return f'<polyline points="{_listed(points)}" fill="none" {style}/>'


def disc(place: Reals, radius: float, style: str) -> str:
    """A circle."""
    return f'<circle cx="{place[0]:.2f}" cy="{place[1]:.2f}" r="{radius:g}" {style}/>'


def text(x: float, y: float, words: str, style: str = "") -> str:
    """Words, at their left end unless `style` says otherwise."""
    return element("text", words, f'x="{x:.1f}" y="{y:.1f}" {style}')


def element(name: str, words: str, style: str = "") -> str:
    """An element of words: what is markup in them, or no letter that XML knows or that people see, is escaped."""
    return f"<{name}{style and f' {style}'}>{escape(shown(words))}</{name}>"


def hex_of(colour: Reals) -> str:
    """Display values from 0 to 1 as ``#rrggbb``."""
    return "#" + "".join(f"{round(255 * float(part)):02x}" for part in np.clip(colour, 0, 1))


def moved(place: Reals, x: float, y: float) -> Reals:
    """A place so far to the right and down."""
    return place + np.array([x, y])


def hull(points: Reals) -> Reals:
    """Corners of the convex hull of points in the plane, in order (A. M. Andrew's monotone chain, 1979)."""
    ordered = [np.array(point) for point in np.unique(np.round(points, 6), axis=0)]
    halves: list[Reals] = []
    for run in (ordered, ordered[::-1]):
        chain: list[Reals] = []
        for point in run:
            while len(chain) > 1 and _cross(chain[-1] - chain[-2], point - chain[-2]) <= 0:
                chain.pop()
            chain.append(point)
        halves += chain[:-1]
    return np.array(halves or ordered)


def around(points: Reals) -> Box:
    """The smallest box around points."""
    (left, top), (right, bottom) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return left, top, right, bottom


@dataclass
class Labels:
    """Names beside symbols, off each other.

    Parameters
    ----------
    room
        Where names may stand.
    paper, quiet
        Colours of what is behind the names, and of the lines that lead to them.
    taken, busy
        Boxes where no name may stand, and those that names better neither stand in nor cross.
    """

    room: Box
    paper: str
    quiet: str
    taken: list[Box] = field(default_factory=list)
    busy: list[Box] = field(default_factory=list)

    def mark(self, place: Reals, radius: float) -> None:
        """Keep names off a symbol."""
        self.taken.append((place[0] - radius, place[1] - radius, place[0] + radius, place[1] + radius))

    def label(self, place: Reals, name: str, radius: float) -> str:
        """A name beside a symbol, shortened if it is long; nothing where there is no room (give a tooltip too)."""
        shown = name if len(name) <= _LETTERS else name[: _LETTERS - 1] + "…"
        found = min(self._places(place, (6.9 * len(shown) + 4, 14.0), radius), default=None)
        if found is None:
            return ""
        _, gap, box = found
        self.taken.append(box)
        middle = np.array([box[0] + box[2], box[1] + box[3]]) / 2
        start = place + (middle - place) / np.linalg.norm(middle - place) * (radius + 2)
        edge = np.clip(start, (box[0] + 1, box[1] + 1), (box[2] - 1, box[3] - 1))
        leader = path([start, edge], f'stroke="{self.quiet}" stroke-width="0.7"') if gap > 12 else ""
        halo = f'paint-order="stroke" stroke="{self.paper}" stroke-width="3" stroke-linejoin="round"'
        return leader + text(middle[0], middle[1] + 4, shown, f'class="label" text-anchor="middle" {halo}')

    def _places(self, place: Reals, size: tuple[float, float], radius: float) -> Iterator[tuple[float, float, Box]]:
        """Cost, gap to the symbol and box of every place that is free; the way out of the drawing is tried first."""
        wide, high = size
        middle = (self.room[0] + self.room[2]) / 2, (self.room[1] + self.room[3]) / 2
        outward = math.atan2(place[1] - middle[1], place[0] - middle[0])
        for gap, turn in product((4.0, 12.0, 22.0, 34.0, 48.0, 64.0), range(16)):
            angle = outward + (turn + 1) // 2 * (-1) ** turn * math.pi / 8
            x = place[0] + math.cos(angle) * (radius + gap + wide / 2)
            y = place[1] + math.sin(angle) * (radius + gap + high / 2)
            box = (x - wide / 2, y - high / 2, x + wide / 2, y + high / 2)
            if _within(box, self.room) and not any(_meet(box, other) for other in self.taken):
                crossed = sum(8 if _within(box, other) else 30 for other in self.busy if _meet(box, other))
                yield gap + 1.5 * turn + crossed, gap, box


def _meet(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def _within(one: Box, other: Box) -> bool:
    return other[0] <= one[0] and one[2] <= other[2] and other[1] <= one[1] and one[3] <= other[3]


def _cross(a: Reals, b: Reals) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _listed(points: Sequence[Reals] | Reals) -> str:
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in points)
