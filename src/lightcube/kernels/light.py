"""The law of light, compiled: what a screen shows where the light of several views adds up (`lightcube.optics.law`).

Absorbance is ``(views, entries)``; entry i of a view is of pixel ``i // channels`` and colour ``i % channels``. Here
light is added up; `lightcube.kernels.joint` has loops of its own, of logarithms and derivatives, over the same law.
Results do not depend on the number of threads.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled
from lightcube.kernels.exponential import exp

Array = NDArray[Any]

#: Entries that are worked on at a time, about, and parts that a picture's pixels are divided into at most.
_RUN, _PARTS = 2048, 16


class Mixture(NamedTuple):
    """Which views make which picture, and how strong.

    Picture p is made by views ``starts[p]`` to before ``starts[p + 1]``. `powers`, ``(views, channels)``, are P times
    the view's share; `light` and `shadow`, ``(views, pixels)``, are g and a, or ``(views, 1)`` where all pixels of a
    view are alike.
    """

    starts: Array
    powers: Array
    light: Array
    shadow: Array


@compiled(inline="always")
def falling(power: Any, light: Any) -> Any:
    """``P g``: what a view shows without a cube."""
    return power * light


@compiled(inline="always")
def divided(power: Any, light: Any, shadow: Any) -> tuple[Any, Any]:
    """``P g (1 - a)`` and ``P g a``: the light of a view that no cube can absorb, and that which one can."""
    full = falling(power, light)
    dark = full * shadow
    return full - dark, dark


@compiled(inline="always")
def shown(clear: Any, dark: Any, absorbance: Any) -> Any:
    """``P g (1 - a (1 - T))``, of both parts that light is `divided` into."""
    return clear + dark * exp(-absorbance)


@compiled
def of_pixels(values: Array, first: int, count: int) -> Array:
    """A view's g or a at `count` pixels from `first` on, where one number may stand for all."""
    return values[first : first + count] if len(values) > 1 else np.full(count, values[0])


@compiled
def divide(mixture: Mixture, view: int, start: int, count: int, clear: Array, dark: Array) -> None:
    """Write both parts of the light of a view for `count` entries from `start` on, which are whole pixels."""
    powers = mixture.powers[view]
    channels = len(powers)
    light = of_pixels(mixture.light[view], start // channels, count // channels)
    shadow = of_pixels(mixture.shadow[view], start // channels, count // channels)
    if channels == 3:  # the colours of most cubes: a number that the compiler knows is twice as fast, or more
        _divide_pixels(powers, light, shadow, 3, clear, dark)
    else:
        _divide_pixels(powers, light, shadow, channels, clear, dark)


@compiled(inline="always")
def _divide_pixels(powers: Array, light: Array, shadow: Array, channels: int, clear: Array, dark: Array) -> None:
    for k in range(len(light)):
        for c in range(channels):
            clear[k * channels + c], dark[k * channels + c] = divided(powers[c], light[k], shadow[k])


@compiled
def _add_view(clear: Array, dark: Array, absorbance: Array, total: Array) -> None:
    for i in range(len(absorbance)):
        total[i] += shown(clear[i], dark[i], absorbance[i])


@compiled
def _place(entries: Array, first: int, picture: Array) -> None:
    """Write pixels from number `first` on, rows bottom-up in each column, to a picture ``(row, column, channel)``."""
    if picture.shape[2] == 3:
        _place_pixels(entries, first, 3, picture)
    else:
        _place_pixels(entries, first, picture.shape[2], picture)


@compiled(inline="always")
def _place_pixels(entries: Array, first: int, channels: int, picture: Array) -> None:
    rows = picture.shape[0]
    row, column = rows - 1 - first % rows, first // rows
    for k in range(len(entries) // channels):
        for c in range(channels):
            picture[row, column, c] = entries[k * channels + c]
        row -= 1
        if row < 0:
            row, column = rows - 1, column + 1


def show(mixture: Mixture, pictures: Array, absorbance: Array, light: Array) -> None:
    """Write what picture ``pictures[k]`` shows to ``light[k]``, ``(row, column, channel)`` with the top row first.

    The pixels of a view are in the order of the matrix (`lightcube.kernels.layout`): its columns, bottom-up in each.
    """
    views = len(absorbance) * len(pictures) // (len(mixture.starts) - 1)
    work = 2 * views * absorbance.shape[1]
    tasks.run(_show, len(pictures) * _parts(absorbance.shape[1]), work, mixture, pictures, absorbance, light)


@compiled
def _parts(entries: int) -> int:
    return min(_PARTS, (entries + _RUN - 1) // _RUN)


@compiled
def _show(first: int, last: int, mixture: Mixture, pictures: Array, absorbance: Array, light: Array) -> None:
    channels, parts = mixture.powers.shape[1], _parts(absorbance.shape[1])
    pixels, run = absorbance.shape[1] // channels, max(_RUN // channels, 1) * channels
    total, clear, dark = np.empty(run, light.dtype), np.empty(run, light.dtype), np.empty(run, light.dtype)
    for task in range(first, last):
        picture, part = pictures[task // parts], task % parts
        begin, stop = part * pixels // parts * channels, (part + 1) * pixels // parts * channels
        for start in range(begin, stop, run):
            end = min(start + run, stop)
            total[:] = 0
            for view in range(mixture.starts[picture], mixture.starts[picture + 1]):
                divide(mixture, view, start, end - start, clear, dark)
                _add_view(clear, dark, absorbance[view, start:end], total)
            _place(total[: end - start], start // channels, light[task // parts])
