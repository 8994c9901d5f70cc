"""What a report says of a cube, measured: scores, pictures to look at, curves, disturbances, pre-flight."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing.sheet import difference, pair
from lightcube.drawing.tableau import tableau
from lightcube.forward.casting import cast
from lightcube.optics.cube import Cube
from lightcube.optics.stage import Stage
from lightcube.optics.transfer import to_uint8
from lightcube.pictures.fitting import as_levels
from lightcube.pictures.targets import Targets
from lightcube.planning.consistency import advice, check
from lightcube.planning.feasibility import doubtful
from lightcube.planning.reachable import sentences
from lightcube.scoring.between import Curve, curve
from lightcube.scoring.metrics import check_same_views, score
from lightcube.scoring.robust import disturbances, robust

Levels = NDArray[np.uint8]

#: Pixels of all pictures together that a page holds without loss, and those that it holds at all (with a little loss):
#: wanted, shown and difference of so many stay below 10 MB.
EXACT, MOST = 700_000, 8_000_000
#: Rows and columns of the picture of the room.
ROOM = (720, 1280)
#: Differences of pictures that are at least so good (dB) are drawn so many times as large.
_SMALL_DB, _GAIN = 30.0, 8


@dataclass(frozen=True, eq=False)
class Findings:
    """Everything that was measured of a cube.

    Parameters
    ----------
    cube, targets, stage
        The cube, what was wanted of it, and the stage that they are from.
    scores
        As `lightcube.score`.
    room
        The cube in its room at its first stop, 8-bit RGB.
    pictures
        By their number: wanted, shown and difference, 8-bit RGB; evenly chosen ones where there are too many.
    curve
        What is seen between the stops; None where nothing turns.
    robust
        As `lightcube.scoring.robust.robust`.
    preflight
        As `lightcube.check`; None in rooms that it was not measured for.
    advice
        What is wrong with the pictures, a sentence each.
    apart
        By how many display levels of 255 the targets are, at most, from those that the cube was made for; None where
        it keeps none.
    """

    cube: Cube
    targets: Targets
    stage: Stage | None
    scores: dict[str, Any]
    room: Levels
    pictures: dict[int, list[Levels]]
    curve: Curve | None
    robust: dict[str, Any]
    preflight: dict[str, Any] | None
    advice: list[str]
    apart: int | None


def measure(
    cube: Cube, targets: Targets, stage: Stage | None = None, callback: Callable[[int, int], None] | None = None
) -> Findings:
    """Measure all that a report says of a cube and of what was wanted of it.

    Parameters
    ----------
    stage
        That the targets are from, if it is at hand.
    callback
        Called with how many pictures are compared, and how many there are as far as is known.

    Raises
    ------
    InputError
        Where the targets do not fit the cube's views.
    """
    check_same_views(cube, targets)
    tell = callback or (lambda done, of: None)
    rest = (len(disturbances(cube)) + 1) * len(targets)
    turns = bool(np.any(cube.rig.turning.turns))
    between = curve(cube, targets, callback=lambda done, of: tell(done, of + rest)) if turns else None
    of = rest + (0 if between is None else len(between.angles_deg))
    left = robust(cube, targets, callback=lambda done, _: tell(of - rest + done, of))
    pictures: dict[int, list[Levels]] = {number: [] for number in chosen(targets)}
    scores = score(cube, targets)
    for number, picture in enumerate(cast(cube)):
        if number in pictures:
            rows, columns = targets.rig.stops.window[number]
            off = difference(picture, targets, number, gain(scores["pictures"][number]["psnr"]))
            three = [*pair(picture, targets, number), off]
            pictures[number] = [each[:rows, :columns] for each in three]
    tell(of, of)
    facts = check(targets, cube.grid) if cube.rig.is_thin and cube.rig.elevation_deg is not None else None
    said = sentences(targets) if facts is None else advice(facts)
    if stage is not None:
        said = [*doubtful(stage), *said]
    room = to_uint8(tableau(cube, float(cube.angles_deg[0]), ROOM))
    return Findings(cube, targets, stage, scores, room, pictures, between, left, facts, said, _apart(cube, targets))


def chosen(targets: Targets, most: int = MOST) -> list[int]:
    """Numbers of the pictures that a page has room for, evenly chosen: those of at most so many pixels together."""
    rows, columns = targets.rig.picture_shape
    room = min(len(targets), max(1, most // (rows * columns)))
    return [int(number) for number in np.unique(np.linspace(0, len(targets) - 1, room).round())]


def gain(psnr: float) -> int:
    """How many times as large as it is the difference of such a picture is drawn."""
    return _GAIN if psnr >= _SMALL_DB else 1


def _apart(cube: Cube, targets: Targets) -> int | None:
    """Largest difference, in levels, of the targets from the cube's own; their weights count too."""
    if cube.targets is None:
        return None
    return max(
        int(np.max(np.abs(own.astype(np.int32) - given)))
        for own, given in zip(cube.targets, as_levels(targets), strict=True)
    )
