"""Makers of what is taken away of solids and plates: tables from a name of `THINGS` to what makes the file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from lightcube import io
from lightcube.drawing.outlines import outlines
from lightcube.drawing.relief_sheet import relief_sheet
from lightcube.events import counting
from lightcube.scoring.reliefs import score_relief
from lightcube.solids.reach import count_pieces
from lightcube.solids.relief import Relief
from lightcube.solids.shape import Shape, as_cube
from lightcube.studio import plates
from lightcube.studio.offered import Maker, Order
from lightcube.verbs import hull_words, hulls, reliefs, viewing
from lightcube.viewer.page import relief_page

#: Pictures a second of a movie of the lamp, and along its sides about so many pixels.
_FPS, _PIXELS = 30.0, 720
_STICKS = "it opens in any browser, without a network: mail it, or put it on a stick"


def _mesh(order: Order[Shape]) -> list[str]:
    """The solid for a printer; the file is read again, and it is said what that casts."""
    io.Output(order.target, "shape", overwrite=True).write(order.thing)
    found = hulls.certificate(str(order.target), order.thing)
    return hull_words.results(order.thing, found, count_pieces(order.thing.inside))


def _page(order: Order[Shape]) -> list[str]:
    """The page in which one looks at the solid between its walls."""
    made = viewing.page(as_cube(order.thing), order.label, order.tell)
    io.Output(order.target, "page", overwrite=True).write(made.text)
    return [f"its shadows are off by {made.worst_levels:.1f} of 255 levels at most", _STICKS]


def _outlines(order: Order[Shape]) -> list[str]:
    """The silhouettes for cutters."""
    io.Output(order.target, "drawing", overwrite=True).write(outlines(order.thing.silhouettes))
    return ["the silhouettes as the solid casts them, true to size in mm"]


def _shape(order: Order[Shape]) -> list[str]:
    """The solid in one file."""
    io.Output(order.target, "shape", overwrite=True).write(order.thing)
    return ["all of it: its field, silhouettes, lamps and screens, for this program"]


#: Of solids.
OF_SOLIDS: Mapping[str, Maker[Shape]] = {
    "3mf": _mesh,
    "stl": _mesh,
    "obj": _mesh,
    "outlines": _outlines,
    "page": _page,
    "shape": _shape,
}


def _plate(order: Order[Relief]) -> list[str]:
    """The plate as its suffix says: for a printer, as heights, or all of it."""
    io.Output(order.target, "relief", overwrite=True).write(order.thing)
    return plates.told(order.thing, score_relief(order.thing, off=True))


def _plates_page(order: Order[Relief]) -> list[str]:
    """The page in which the lamp goes round the plate."""
    io.Output(order.target, "page", overwrite=True).write(relief_page(order.thing, order.label))
    return ["its light is cast exactly", _STICKS]


def _sheet(order: Order[Relief]) -> list[str]:
    """What each lamp shows beside what was wanted."""
    scores = score_relief(order.thing, off=True)
    drawn = relief_sheet(order.thing, scores, order.label.title)
    io.Output(order.target, "picture", overwrite=True).write(drawn)
    return plates.came_out(order.thing, scores)


def _movie(order: Order[Relief]) -> list[str]:
    """A lamp that goes once round the plate."""
    turned, advance = reliefs.course(order.thing, even=False), counting(order.tell)

    def frames() -> Iterator[NDArray[np.float32]]:
        for number, picture in enumerate(reliefs.under_lamp(order.thing, turned)):
            yield picture
            advance(number + 1, len(turned))

    io.Output(order.target, "pictures", overwrite=True).write(
        frames(), count=len(turned), fps=_FPS, scale=_scale(order.thing), shared=True
    )
    return ["the lamp goes round once, and rests at each picture"]


def _scale(relief: Relief) -> int:
    """How large pixels of a movie are, even."""
    return max(2, 2 * round(_PIXELS / max(relief.wanted.shape[1:]) / 2))


#: Of plates.
OF_PLATES: Mapping[str, Maker[Relief]] = {
    "3mf": _plate,
    "stl": _plate,
    "heights": _plate,
    "page": _plates_page,
    "round": _movie,
    "sheet": _sheet,
    "relief": _plate,
}
