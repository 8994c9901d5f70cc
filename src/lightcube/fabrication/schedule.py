"""What stands beside a cube and has to be built too: when a turntable turns, and how bright its lamps are then.

Its timing is that of the movies (`lightcube.forward.dimming`): a lamp fades in on a stop, rests, fades out, and the
table turns in the dark to the next.
"""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from lightcube.fabrication import lamps
from lightcube.fabrication.planned import Advance, File, Planned
from lightcube.forward.dimming import Course
from lightcube.io._files import Replaceable
from lightcube.io._places import Place, name_of
from lightcube.optics.arrays import Reals
from lightcube.optics.cube import Cube
from lightcube.optics.transfer import decode
from lightcube.pictures.fitting import targets_of
from lightcube.scoring.metrics import score_pictures

#: Steps a second in which times are counted, as frames of the movies are; points of a fade that are told.
_BEAT, _POINTS = 30.0, 11


@dataclass(frozen=True)
class Schedule:
    """How a schedule is written: a table for people and spreadsheets with all of it beside, or just all of it."""

    called: ClassVar[str] = "a schedule"
    suffixes: ClassVar[tuple[str, ...]] = (".csv", ".json")
    replaceable: ClassVar[Replaceable] = None

    def plan(self, cube: Cube, at: Place) -> Planned:
        """What would be written."""
        is_table = name_of(at).lower().endswith(".csv")
        document = schedule(cube)

        def write(path: Path, _: Advance) -> None:
            path.write_bytes(as_csv(document))

        return Planned((File(at, write),) if is_table else (), document)


def schedule(cube: Cube) -> dict[str, Any]:
    """Everything that a stepper motor and lamps of three colours have to do for one round, and what a white lamp would.

    Powers are relative to a lamp that shows white behind no glass, levels to the brightest that is asked for, and an EV
    is a factor of two.
    """
    stops = np.unique(cube.angles_deg)
    course = Course.of(len(stops), _BEAT)
    fade_s, rest_s, dark_s = (frames / _BEAT for frames in (course.fade, course.rest, course.dark))
    dark_s = dark_s if len(stops) > 1 else 0.0
    steps = np.arange(_POINTS) / (_POINTS - 1)
    document = {
        "stops": len(stops),
        "round_s": len(stops) * (2 * fade_s + rest_s + dark_s),
        "brightest": float(cube.powers.max()),
        "fade": {
            "said": "part of the light at so many seconds of a fade in; a fade out is the same backwards",
            "seconds": (steps * fade_s).tolist(),
            "light": decode(steps, cube.transfer).tolist(),
        },
        "rows": _rows(cube, stops, fade_s, rest_s, dark_s),
    }
    return document if cube.targets is None else {**document, "one_white_lamp": _white(cube)}


def _rows(cube: Cube, stops: Reals, fade_s: float, rest_s: float, dark_s: float) -> list[dict[str, Any]]:
    """A row for each lamp at each stop, in the order in which they come."""
    rig, rows = cube.rig, []
    brightest, colours = float(cube.powers.max()), _colours(len(cube.extinction))
    turned = np.diff(stops, prepend=stops[-1] - 360.0)
    for number, (angle_deg, turn_deg) in enumerate(zip(stops.tolist(), turned.tolist(), strict=True)):
        for pair, (picture, lamp) in enumerate(rig.pairs.tolist()):
            if rig.stops.angle_deg[picture] != angle_deg:
                continue
            of_colours = list(zip(colours, cube.powers[pair].tolist(), strict=True))
            rows.append(
                {
                    "stop": number + 1,
                    "at_s": round(number * (2 * fade_s + rest_s + dark_s), 6),
                    "angle_deg": angle_deg,
                    "turn_deg": turn_deg if len(stops) > 1 else 0.0,
                    "picture": cube.names[picture],
                    "screen": rig.screens.names[rig.stops.screen[picture]],
                    "lamp": rig.lamps.names[lamp],
                    **{f"power_{colour}": power for colour, power in of_colours},
                    **{f"level_{colour}": power / brightest for colour, power in of_colours},
                    **{f"ev_{colour}": math.log2(power / brightest) for colour, power in of_colours},
                    "fade_in_s": fade_s,
                    "rest_s": rest_s,
                    "fade_out_s": fade_s,
                    "dark_s": dark_s,
                }
            )
    return rows


def _colours(channels: int) -> tuple[str, ...]:
    return ("red", "green", "blue") if channels == 3 else tuple(f"colour_{channel + 1}" for channel in range(channels))


def _white(cube: Cube) -> dict[str, Any]:
    """How good the same cube is under one white lamp of one power, and what it has to be."""
    targets = targets_of(cube)
    power, _ = lamps.white(cube, targets)
    scores = score_pictures(lamps.under_white(cube) * np.float32(power), targets)
    return {"power": power, "psnr_mean": scores["psnr_mean"], "psnr_min": scores["psnr_min"]}


def as_csv(document: dict[str, Any]) -> bytes:
    """The rows of a schedule as a table."""
    table = io.StringIO()
    writer = csv.DictWriter(table, list(document["rows"][0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(
        {name: round(value, 6) if isinstance(value, float) else _text(value) for name, value in row.items()}
        for row in document["rows"]
    )
    return table.getvalue().encode()


def _text(value: Any) -> Any:
    """A name that no spreadsheet takes for a formula."""
    return f"'{value}" if isinstance(value, str) and value[:1] in ("=", "+", "-", "@", "\t") else value
