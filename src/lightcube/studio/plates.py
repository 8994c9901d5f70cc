"""What is said of a plate to whoever makes it: what it is, and what to do, without figures that have to be learned."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lightcube.scoring.metrics import mark, nearness
from lightcube.solids.relief import Relief, side_of

#: Display values below which black is called so.
_BLACK, _DARK = 0.25, 0.45
#: Decibels that nobody sees.
_SAME_DB = 1.0


def foretold(plate: Relief, scores: Mapping[str, Any]) -> list[str]:
    """How large a plate is, how dark its shadows can be, and how careful one has to be with its lamps."""
    wide, deep, high = plate.size_mm
    nozzle = f"with a nozzle of {plate.recipe.pitch_mm / 2:g} mm or finer"
    return [
        f"the plate is {wide:.3g} x {deep:.3g} mm, and {high:.2g} mm thick",
        f"print it lying on its back, in matt white, {nozzle}",
        _of_black(scores["black"]),
        _of_lamps(plate, scores),
    ]


def told(plate: Relief, scores: Mapping[str, Any]) -> list[str]:
    """The same, after how each picture has come out."""
    return [*came_out(plate, scores), *foretold(plate, scores)]


def came_out(plate: Relief, scores: Mapping[str, Any]) -> list[str]:
    """How each picture has come out, under which lamp."""
    if plate.is_colour:
        near, far = nearness(scores["near_psnr_mean"]), nearness(scores["psnr_mean"])
        lines = [f"in colour it is {near} near by and {far} from afar: red lamp right, green left, blue behind"]
    else:
        lines = [
            f"{each['name']} is {nearness(each['near_psnr'])} near by and {nearness(each['psnr'])} from afar, "
            f"under the lamp {side_of(each['azimuth_deg'])}"
            for each in scores["pictures"]
        ]
    if any(mark(each["psnr"]) == "poor" for each in scores["pictures"]):
        lines.append("what would help: fewer pictures, plainer ones, or a finer plate")
    return lines


def _of_black(black: float) -> str:
    """How dark its shadows can be."""
    if black < _BLACK:
        return "black comes out nearly black"
    return f"black comes out {'dark' if black < _DARK else 'middle'} grey: a higher relief makes it darker"


def _of_lamps(plate: Relief, scores: Mapping[str, Any]) -> str:
    """Where its lamps stand, and how exactly."""
    lamps = "one small lamp" if len(plate) == 1 else "small lamps, one at a time"
    lamps = "the three lamps together" if plate.is_colour else lamps
    where = f"light it in a dark room by {lamps}, far away and {plate.recipe.elevation_deg:g}° above level"
    right, worst = scores["psnr_mean"], min(scores["off"][f"3 deg {way}"] for way in ("higher", "lower"))
    if right - worst < _SAME_DB:
        return f"{where}; a few degrees more or less do no harm"
    if mark(right) == mark(worst):
        return f"{where}; 3° more or less make the pictures a little worse"
    return f"{where}, with care: 3° more or less make the pictures {mark(worst)}"
