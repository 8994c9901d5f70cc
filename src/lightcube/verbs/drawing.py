"""What `draw` shows: a stage from above and from the side, how films are put together, or a room in perspective."""

import numpy as np
from numpy.typing import NDArray

from lightcube import io
from lightcube.drawing.assembly import assembly
from lightcube.drawing.stage import drawing
from lightcube.drawing.tableau import tableau
from lightcube.errors import InputError
from lightcube.optics.cube import Cube
from lightcube.optics.stack import Stack
from lightcube.optics.transfer import to_uint8
from lightcube.optics.views import check_angles

#: Rows and columns of the picture of a room.
ROOM = (540, 960)


def of_stage(path: str) -> str:
    """The drawing of a stage file's room at its first stop, or of its films: the text of an SVG."""
    stage = io.read_stage(path)[0]
    if isinstance(stage.grid, Stack):
        return assembly(stage.grid, stage.rig(), [shot.name for shot in stage.shots])
    return drawing(stage)


def of_films(cube: Cube) -> str:
    """How the films of a stack are put together: the text of an SVG; `InputError` where it is no stack."""
    if not isinstance(cube.grid, Stack):
        raise InputError("only films are drawn as an SVG: use one of .png, .webp, .jpg, .jpeg for the room of a cube")
    return assembly(cube.grid, cube.rig, cube.names)


def of_cube(cube: Cube, angle_deg: float | None = None) -> NDArray[np.uint8]:
    """The room of a cube in perspective, ``(row, column, 3)`` display levels.

    Parameters
    ----------
    angle_deg
        Of the turntable, degrees; the first stop where nothing is said.
    """
    (turned,) = cube.angles_deg[:1] if angle_deg is None else check_angles([angle_deg])
    return to_uint8(tableau(cube, float(turned), ROOM), cube.transfer)
