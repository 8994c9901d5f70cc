"""What a report says of a stack of films: how they are put together, what each looks like printed, and its ghosts."""

from collections.abc import Iterator
from html import escape

import numpy as np

from lightcube.drawing.assembly import assembly
from lightcube.optics.arrays import Reals
from lightcube.optics.cube import Cube
from lightcube.optics.ghosts import ghosts
from lightcube.optics.stack import Stack
from lightcube.optics.transfer import to_uint8
from lightcube.report.html import element, figure, image, number, sideways, table, text
from lightcube.wording import counted

#: Pixels that a film's picture is enlarged to by whole cells; films that are shown.
_SIDE, _MOST = 180, 24


def films(cube: Cube) -> str:
    """The films one by one."""
    stack = cube.grid
    assert isinstance(stack, Stack)  # noqa: S101 - nobody asks of anything else
    density = np.asarray(cube.extinction * stack.voxel_mm / np.log(10), np.float64)
    drawn = sideways(assembly(stack, cube.rig, cube.names), "How the films are put together")
    cards = [_card(cube, film, density) for film in range(min(stack.shape[0], _MOST))]
    more = stack.shape[0] - len(cards)
    note = "Each film as it looks before a white light, the top of the pictures up; 1 lies lowest."
    note += f" {counted(more, 'more film')} above these." if more else ""
    rows = [
        (film + 1, f"{stack.heights_mm[film]:g}", *_inks(density[:, film]), number(density[:, film].max()))
        for film in range(stack.shape[0])
    ]
    inks = ("red", "green", "blue") if len(density) == 3 else ("light",)
    heads = ("film", "height, mm", *(f"mean density, {ink}" for ink in inks), "darkest")
    return "\n".join(
        [
            figure(drawn, "Heights, gaps and lamps, and what each lamp shows.", class_="room"),
            text("p", note, class_="note"),
            element("div", "".join(cards), class_="tiny"),
            sideways(table("Every film", heads, rows, "figures"), "Every film"),
            text("h3", "Ghosts"),
            *_ghosts(stack, float(density.mean())),
        ]
    )


def _inks(density: Reals) -> list[str]:
    """Mean density of a film in each colour."""
    return [number(float(each.mean())) for each in density]


def _card(cube: Cube, film: int, density: Reals) -> str:
    """A film before a white light."""
    light = np.moveaxis(10.0 ** -density[[min(i, len(density) - 1) for i in range(3)], film], 0, -1)[::-1]
    times = max(1, round(_SIDE / max(light.shape[:2])))
    levels = to_uint8(light, cube.transfer).repeat(times, axis=0).repeat(times, axis=1)
    said = text("b", f"film {film + 1}") + escape(f" {density[:, film].mean():.2f}")
    return figure(image(levels, f"film {film + 1} before a white light"), said, class_="card")


def _ghosts(stack: Stack, density: float) -> Iterator[str]:
    """What becomes of light that is reflected between films."""
    count = stack.shape[0]
    rows = []
    for name, loose in (("loose, with air between", True), ("bonded, by oil or a laminate", False)):
        found = ghosts(count, density, loose=loose)
        rows.append((name, f"{found.through:.0%}", f"{found.displaced:.1%}", f"{found.within:.1%}"))
    heads = ("films", "light through clear ones", "ghosts elsewhere", "within a film")
    yield table("Light that is reflected twice", heads, rows, "figures")
    said = (
        f"By Fresnel's law, of films of a mean density of {density:.2f} that light meets upright: parts of what comes "
        "through. What lands elsewhere veils the pictures; what stays within a film blurs by less than its thickness."
    )
    yield text("p", said, class_="note")
