"""What can be taken away of each kind of thing, in words, and what is asked of whoever makes its file.

Who makes them stands in `lightcube.studio.away`, under the same names: all that makes files comes with it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, Literal, TypeVar

from lightcube.events import Tell
from lightcube.viewer.label import Label

#: What files are made of: a cube, a shape, or a relief.
Made = TypeVar("Made")
#: Films that a cube is made of.
FILMS = 5


@dataclass(frozen=True)
class Order(Generic[Made]):
    """What is asked for: of which thing, where its file lies, the file to be made, its label, and what is chosen."""

    thing: Made
    source: Path
    target: Path
    label: Label
    captions: bool
    tell: Tell


#: Makes a file, and returns sentences: how good it is, and what is to be known of it.
Maker = Callable[[Order[Made]], list[str]]


@dataclass(frozen=True)
class Thing:
    """Something to be taken away.

    Parameters
    ----------
    title, said
        For people: what it is called, what it is for.
    suffix
        Of its file.
    group
        Which of the page's rows it stands in.
    """

    title: str
    said: str
    suffix: str
    group: Literal["show", "know", "make"]


_SHEET = Thing("A sheet", "Each picture beside what was wanted.", "png", "know")

#: By what it is made of, in the page's order.
THINGS: Mapping[str, Mapping[str, Thing]] = {
    "cubes": {
        "page": Thing(
            "A page", "The cube to be turned by hand, in one file that opens in any browser.", "html", "show"
        ),
        "square": Thing("A square movie", "For messages and posts.", "mp4", "show"),
        "portrait": Thing("An upright movie", "For telephones and stories.", "mp4", "show"),
        "wide": Thing("A wide movie", "For screens and projectors.", "mp4", "show"),
        "room": Thing("A movie of the room", "Lamp, cube and walls, as the table turns.", "mp4", "show"),
        "sheet": _SHEET,
        "report": Thing("A report", "All that is known of the cube, to keep and to print.", "html", "know"),
        "cube": Thing("The cube itself", "In one file, to go on with.", "zarr.zip", "know"),
        "films": Thing("Films", f"The cube as {FILMS} printed transparencies, on pages.", "pdf", "make"),
        "shell": Thing("Shells", "Surfaces around what is darkest, for a 3-D printer.", "3mf", "make"),
        "slices": Thing(
            "Slices", "For printers of droplets (PolyJet): 3,704 pictures, 4 GB, an hour or more.", "zip", "make"
        ),
        "points": Thing("Points", "For a laser that marks glass inside.", "ply", "make"),
        "blender": Thing("A volume for Blender", "OpenVDB, in metres.", "vdb", "make"),
        "volume": Thing("A volume", "NRRD, for 3-D Slicer and others.", "nrrd", "make"),
        "paraview": Thing("A volume for ParaView", "VTI.", "vti", "make"),
        "schedule": Thing("A schedule", "When the table turns, and how bright lamps are.", "csv", "make"),
    },
    "films": {
        "print": Thing("Films to print", "A PDF: each film true to size, with its marks.", "pdf", "make"),
        "assembly": Thing("How they are put together", "Heights, gaps and lamps, as a drawing.", "svg", "make"),
        "page": Thing("A page", "The films under their lamps, in one file that opens in any browser.", "html", "show"),
        "room": Thing("A movie of the room", "Lamp after lamp over the films.", "mp4", "show"),
        "sheet": _SHEET,
        "report": Thing("A report", "All that is known of the films, to keep and to print.", "html", "know"),
        "films": Thing("The films themselves", "In one file, to go on with.", "zarr.zip", "know"),
    },
    "solids": {
        "3mf": Thing("For a 3-D printer", "3MF, in mm, with a small picture of it.", "3mf", "make"),
        "stl": Thing("For any 3-D printer", "STL, in mm; what every slicer reads.", "stl", "make"),
        "obj": Thing("For other programs", "OBJ, in mm.", "obj", "make"),
        "outlines": Thing("Outlines", "For cutters of paper and wood, in mm.", "svg", "make"),
        "page": Thing("A page", "The solid between its walls, in one file that opens in any browser.", "html", "show"),
        "shape": Thing("The solid itself", "In one file, to go on with.", "shape.zarr.zip", "know"),
    },
    "plates": {
        "3mf": Thing("For a 3-D printer", "3MF, in mm.", "3mf", "make"),
        "stl": Thing("For any 3-D printer", "STL, in mm; what every slicer reads.", "stl", "make"),
        "heights": Thing("Heights", "A grey picture, 16 bits, for milling and other programs.", "png", "make"),
        "page": Thing("A page", "The plate under its lamp, in one file that opens in any browser.", "html", "show"),
        "round": Thing("A movie of the lamp", "It goes round, and shows picture after picture.", "mp4", "show"),
        "sheet": Thing("A sheet", "What each lamp shows beside what was wanted.", "png", "know"),
        "relief": Thing("The plate itself", "In one file, to go on with.", "relief.zarr.zip", "know"),
    },
}
