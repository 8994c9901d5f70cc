"""What `draw` shows: a stage from above and from the side, or the room of a cube in perspective."""

import numpy as np
from numpy.typing import NDArray

from lightcube import io
from lightcube.drawing.stage import drawing
from lightcube.drawing.tableau import tableau
from lightcube.optics.cube import Cube
from lightcube.optics.transfer import to_uint8
from lightcube.optics.views import check_angles


def of_stage(path: str) -> str:
    """The drawing of a stage file's room at its first stop: the text of an SVG."""
    return drawing(io.read_stage(path)[0])


def of_cube(cube: Cube, angle_deg: float | None = None) -> NDArray[np.uint8]:
    """The room of a cube in perspective, ``(row, column, 3)`` display levels.

    Parameters
    ----------
    angle_deg
        Of the turntable, degrees; the first stop where nothing is said.
    """
    (turned,) = cube.angles_deg[:1] if angle_deg is None else check_angles([angle_deg])
    return to_uint8(tableau(cube, float(turned), (540, 960)), cube.transfer)
