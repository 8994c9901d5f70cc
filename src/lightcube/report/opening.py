"""How a report begins: what the cube is called, what it looks like, and what is good of it and what is not."""

from dataclasses import dataclass

import numpy as np

from lightcube.optics.cube import Cube
from lightcube.optics.naming import moves_of, told_apart
from lightcube.optics.stack import Stack
from lightcube.report import bending, verdict
from lightcube.report.html import element, figure, image, sentences, text
from lightcube.report.measuring import Findings
from lightcube.report.words import span
from lightcube.wording import counted


@dataclass(frozen=True)
class Heading:
    """What stands at the head of a report.

    Parameters
    ----------
    title
        What the cube is called.
    by, date, note
        Who made it, when, and a word on it; empty = nothing is said of that.
    """

    title: str
    by: str = ""
    date: str = ""
    note: str = ""


def headed(kind: str, heading: Heading, lead: str) -> list[str]:
    """What kind of thing it is, what it is called, by whom and when it was made, what it is, and whom it is for."""
    lines = [text("p", kind, class_="kind"), text("h1", heading.title)]
    signed = " · ".join(filter(None, (heading.by, heading.date)))
    lines += [text("p", signed, class_="signed")] * bool(signed)
    lines.append(text("p", lead, class_="lead"))
    return [*lines, text("p", heading.note, class_="dedication")] if heading.note else lines


def opening(found: Findings, heading: Heading) -> str:
    """Title, date, what it is, and the cube in its room."""
    cube = found.cube
    is_stack = isinstance(cube.grid, Stack)
    lines = headed("Stack of films" if is_stack else "Light cube", heading, _what(found))
    if cube.status != "complete":
        what = "stack" if is_stack else "cube"
        warning = f"This {what} is unfinished: its solver was stopped early, or it is still being made."
        lines.insert(0, text("p", warning, class_="warning"))
    there = _first_shown(cube)
    stop = told_apart(cube.rig)[0] if is_stack else f"the table at {round(cube.angles_deg[0], 2):g}°"
    what, lit = ("films", "films") if is_stack else ("cube", "glass")
    seen = image(found.room, f"The {what} in its room, {stop}, lit: {there}", exact=False)
    caption = text("span", f"In its room, {stop}: lamp, {lit}, and {there}.")
    lines.append(figure(seen, caption, class_="room-picture"))
    return "\n".join(lines)


def _first_shown(cube: Cube) -> str:
    """What stands on the walls at the first stop."""
    names = [cube.names[number] for number in np.flatnonzero(cube.angles_deg == cube.angles_deg[0])]
    if isinstance(cube.grid, Stack):
        return f"{names[0]} on the paper"
    return f"{names[0]} on the wall" if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]} on the walls"


def _what(found: Findings) -> str:
    """What it is, in two sentences."""
    cube = found.cube
    nz, ny, nx = cube.grid.shape
    rows, columns = cube.rig.stops.window.T
    if isinstance(cube.grid, Stack):
        return _what_films(cube, f"{span(columns)}\u00a0×\u00a0{span(rows)}")
    size = " × ".join(f"{length:.6g}" for length in cube.grid.size_mm[::-1])
    count = len(cube.names)
    if count == 1:
        shows = "its shadow is a picture"
    elif len(np.unique(cube.angles_deg)) == count:
        shows = f"at each of {counted(count, 'stop')} its shadow is another picture"
    else:
        shows = f"its shadows are {counted(count, 'picture')}"
    said = (
        f"Light falls through a block of coloured glass; {shows}. It is {size} mm large, of {nx} × {ny} × {nz} "
        f"voxels; its pictures have {span(columns)} × {span(rows)} pixels."
    )
    bent = "".join(f" {sentence}" for sentence in bending.sentences(cube.rig))
    return (said + bent).replace(" × ", "\u00a0×\u00a0").replace(" mm ", "\u00a0mm ")


def _what_films(cube: Cube, pixels: str) -> str:
    """What a stack is, in two sentences; its pictures have so many `pixels`."""
    nz, ny, nx = cube.grid.shape
    high, deep, wide = (f"{length:.4g}" for length in cube.grid.size_mm)
    how = "as films are moved" if any(moves_of(cube.rig)) else "under each lamp"
    return (
        f"Light falls through {counted(nz, 'printed film')} that lie above each other; {how} their shadow is another "
        f"of {counted(len(cube.names), 'picture')}. Films are {wide}\u00a0×\u00a0{deep}\u00a0mm large, of "
        f"{nx}\u00a0×\u00a0{ny} cells, the lowest {high}\u00a0mm below the highest; pictures have {pixels} pixels."
    )


def judged(found: Findings) -> str:
    """What is good and what is not, side by side."""
    columns = {"What is good": verdict.good(found), "What is not": verdict.wanting(found)}
    parts = []
    for name, said in columns.items():
        told = list(said) or ["Nothing that was looked at."]
        parts.append(element("div", text("h3", name) + sentences(told)))
    return element("div", "".join(parts), class_="verdict")
