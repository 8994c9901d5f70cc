"""What drawings of rooms have in common: their colours and letters, the signs of lamps, and the scale bar."""

import math
from collections.abc import Iterator

import numpy as np

from lightcube.drawing.svg import Reals, disc, hex_of, path, text
from lightcube.optics.transfer import encode

CARD, PAPER, LINE, INK, QUIET = "#f4f2ec", "#fdfcf9", "#dcd8cd", "#33383c", "#7b8085"
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif"
#: White lamps are drawn in this colour.
_AMBER = (0.93, 0.66, 0.16)
#: A scale bar is so long at most, pixels.
_BAR = 150


def sun(place: Reals, colour: tuple[float, ...]) -> str:
    """The sign of parallel light."""
    fill, edge = tints(colour)
    rays = [np.array([math.cos(turn), math.sin(turn)]) for turn in np.arange(8) * math.pi / 4]
    style = f'stroke="{edge}" stroke-width="1.4" stroke-linecap="round"'
    lines = "".join(path([place + 8.5 * ray, place + 11.5 * ray], style) for ray in rays)
    return lines + disc(place, 6, f'fill="{fill}" stroke="{edge}" stroke-width="1.2"')


def bulb(place: Reals, colour: tuple[float, ...]) -> str:
    """The sign of a lamp at a place."""
    fill, edge = tints(colour)
    foot = f'<rect x="{place[0] - 2.6:.1f}" y="{place[1] + 6:.1f}" width="5.2" height="5" rx="1.2" fill="{INK}"/>'
    return foot + disc(place, 7, f'fill="{fill}" stroke="{edge}" stroke-width="1.4"')


def tints(colour: tuple[float, ...]) -> tuple[str, str]:
    """A lamp's colour on paper, and a darker one for its edges; white becomes amber."""
    light = encode(np.array(colour, np.float64) / max(colour))
    pure = light - 0.75 * light.min()
    shown = np.array(_AMBER) if np.ptp(light) < 0.2 else 0.92 * pure / pure.max()
    luminance = float(shown @ (0.2126, 0.7152, 0.0722))
    shown = shown * min(1.0, 0.7 / luminance)
    return hex_of(shown), hex_of(0.68 * shown)


def scale_bar(x: float, y: float, scale: float) -> Iterator[str]:
    """A bar of a round length from a place on, with that length behind it; `scale` is pixels per mm."""
    length = max(n * 10.0**e for e in range(-6, 8) for n in (1, 2, 5) if n * 10.0**e * scale <= _BAR)
    bar = [np.array([x, y - 4 - d]) for d in (5, 0)]
    end = np.array([length * scale, 0.0])
    yield path([bar[0], bar[1], bar[1] + end, bar[0] + end], f'stroke="{INK}" stroke-width="1.4"')
    yield text(x + 8 + end[0], y, f"{length / 1000:g} m" if length >= 1000 else f"{length:g} mm")
