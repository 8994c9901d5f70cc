"""What `score` finds of a cube: figures, between the pictures too and in a set-up that is off, and pictures of them."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing import plots
from lightcube.drawing.sheet import contact_sheet
from lightcube.errors import InputError
from lightcube.events import Tell, counting
from lightcube.forward import casting
from lightcube.optics.cube import Cube
from lightcube.optics.naming import is_dial
from lightcube.pictures.targets import Targets
from lightcube.scoring import metrics
from lightcube.scoring.between import Curve, curve
from lightcube.scoring.robust import robust

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Found:
    """How good a cube is.

    Parameters
    ----------
    scores
        As `lightcube.score`, with ``between`` and ``robust`` where they were asked for, for JSON.
    curve
        What ``between`` was made of, or None.
    """

    scores: dict[str, Any]
    curve: Curve | None


def score(cube: Cube, targets: Targets, tell: Tell, *, between: bool = False, off: bool = False) -> Found:
    """Compare what a cube casts with what was wanted.

    Parameters
    ----------
    tell
        Is told how much of what was asked for besides is done.
    between
        Whether PSNR and SSIM between the pictures are asked for, and how far each one stands.
    off
        Whether what a set-up costs that is a little off is asked for.

    Raises
    ------
    InputError
        Where the targets do not fit the cube's views, or nothing is between its stops.
    """
    if between and is_dial(cube.rig):
        raise InputError("nothing turns from one of these pictures to the next: leave out --between and --plot")
    scores, found, advance = metrics.score(cube, targets), None, counting(tell)
    if between:
        found = curve(cube, targets, callback=advance)
        columns = {"angles_deg": found.angles_deg, "nearest": found.nearest, "psnr": found.psnr, "ssim": found.ssim}
        scores["between"] = {name: column.tolist() for name, column in {**columns, "lobe_deg": found.lobes_deg}.items()}
    if off:
        scores["robust"] = robust(cube, targets, callback=advance)
    return Found(scores, found)


def sheet(cube: Cube, targets: Targets, found: Found, title: str) -> NDArray[np.uint8]:
    """Each view as it is shown beside what was wanted, under a title, ``(row, column, 3)`` display levels."""
    psnr = [view["psnr"] for view in found.scores["pictures"]]
    return contact_sheet(casting.play(cube, picture_only=True), targets, psnr, title)


def plot(found: Curve) -> "Figure":
    """PSNR against the turntable angle."""
    return plots.between_plot({"": found})
