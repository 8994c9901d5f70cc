"""What can be asked of a relief: made of pictures, its lamp moved round it, what is to be said of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube import io
from lightcube.drawing.relief_sheet import as_seen, in_words
from lightcube.errors import InputError
from lightcube.events import Tell
from lightcube.pictures.pictures import Pictures
from lightcube.scoring.metrics import mark
from lightcube.scoring.reliefs import score_relief
from lightcube.solids.relief import MOST, Relief, ReliefRecipe, side_of
from lightcube.solids.relief_light import relief_shadow, shown
from lightcube.solids.relief_making import relief
from lightcube.verbs.words import duration
from lightcube.wording import counted

#: Pictures of a lamp that goes round once; and for how many it rests where a picture stands.
ROUND, REST = 240, 40
#: Sweeps are as many times fewer where it is only asked what is to be expected.
QUICK = 10


def read(sources: Sequence[str]) -> Pictures:
    """The pictures of files and folders, one after the other; `InputError` where there are too many."""
    each = [io.read_pictures(source, least=1) for source in sources]
    if len({pictures.transfer for pictures in each}) > 1:
        raise InputError("pictures are of several transfers: give some of one")
    images = tuple(image for pictures in each for image in pictures.images)
    if len(images) > MOST:
        raise InputError(f"a relief shows 1 to {MOST} pictures, not {len(images)}: give fewer")
    return Pictures(images, tuple(name for pictures in each for name in pictures.names), transfer=each[0].transfer)


def rehearsed(
    pictures: Pictures, recipe: ReliefRecipe, *, colour: bool, tell: Tell | None = None
) -> tuple[Relief, float]:
    """A relief made with a tenth of the sweeps, and how many seconds all of them take.

    Takes and raises what `lightcube.relief` does.
    """
    share = QUICK if recipe.method == "global" and recipe.sweeps >= QUICK else 1
    relief(pictures, replace(recipe, sweeps=1), colour=colour)  # what is to be compiled is, before the clock runs
    began = perf_counter()
    made = relief(pictures, replace(recipe, sweeps=recipe.sweeps // share), colour=colour, tell=tell)
    return made, share * (perf_counter() - began)


def expected(pictures: Pictures, recipe: ReliefRecipe, *, colour: bool) -> dict[str, Any]:
    """What a relief would be at least, and how long it takes: as its rehearsal is."""
    made, seconds = rehearsed(pictures, recipe, colour=colour)
    return facts_of(made, score_relief(made, off=True), seconds)


def facts_of(made: Relief, scores: Mapping[str, Any], seconds: float) -> dict[str, Any]:
    """What a rehearsal and its scores tell."""
    recipe = made.recipe
    kept = ("psnr_mean", "psnr_min", "near_psnr_mean", "near_psnr_min", "black", "off")
    wide, deep, _ = made.size_mm
    size_mm = [wide, deep, recipe.base_mm + recipe.top_mm]
    return {
        "seconds": seconds,
        "size_mm": size_mm,
        "sweeps": recipe.sweeps,
        **{each: scores[each] for each in kept},
    }


def foretold(expected: Mapping[str, Any]) -> list[str]:
    """What is to be expected, in sentences."""
    wide, deep, high = expected["size_mm"]
    higher, lower = expected["off"]["3 deg higher"], expected["off"]["3 deg lower"]
    size = f"plate {wide:.4g} x {deep:.4g} x {high:.3g} mm at most, black {expected['black']:.2f}"
    good = in_words(expected["near_psnr_mean"], expected["psnr_mean"])
    return [
        f"{size}; it takes about {duration(expected['seconds'])}",
        f"pictures, with {counted(expected['sweeps'], 'sweep')} already: {good}",
        f"lamps 3° too high or too low: {higher:.1f} and {lower:.1f} dB from afar",
    ]


def course(relief: Relief, *, even: bool) -> NDArray[np.float64]:
    """Degrees by which the lamp has gone round, picture after picture; it rests at the pictures unless `even`."""
    steps = np.arange(ROUND) * 360.0 / ROUND
    if even:
        return steps
    return np.repeat(steps, np.where(np.isin(steps, stops_deg(relief)), REST, 1))


def stops_deg(relief: Relief) -> NDArray[np.float64]:
    """By how many degrees the lamp has gone round at each picture; coloured lamps go round together."""
    return np.array([0.0] if relief.is_colour else relief.azimuths_deg)


def under_lamp(relief: Relief, turned_deg: NDArray[np.float64]) -> Iterator[NDArray[np.float32]]:
    """What a lamp shows that has gone round so far, as an eye near by sees it, ``(row, column, 3)`` linear light.

    Of a colour relief all three lamps go round together.
    """
    before, picture = math.nan, np.zeros(0, np.float32)
    for turned in turned_deg:
        if turned != before:
            light = shown(relief, (turned, 0.0)) if relief.is_colour else relief_shadow(relief, turned)[None]
            before, picture = turned, as_seen(relief, light)[0]
        yield picture


def told(relief: Relief, scores: Mapping[str, Any]) -> list[str]:
    """How good each picture is and how to light the plate, in sentences."""
    wide, deep, high = relief.size_mm
    lines = []
    if relief.is_colour:
        said = in_words(scores["near_psnr_mean"], scores["psnr_mean"])
        lines.append(f"in colour: {said}; red lamp right, green left, blue behind")
    else:
        lines += [
            f"{each['name']}: {in_words(each['near_psnr'], each['psnr'])}, lamp {side_of(each['azimuth_deg'])}"
            for each in scores["pictures"]
        ]
    lines.append(
        f"plate {wide:.4g} x {deep:.4g} x {high:.3g} mm, columns of {relief.recipe.pitch_mm:g} mm; "
        f"{'lamps' if len(relief) > 1 else 'lamp'} {relief.recipe.elevation_deg:g}° above it"
    )
    if "off" in scores:
        higher, lower, right = scores["off"]["3 deg higher"], scores["off"]["3 deg lower"], scores["psnr_mean"]
        lines.append(
            f"lamps 3° too high or too low: {higher:.1f} and {lower:.1f} dB from afar, {right:.1f} where right"
        )
    if "drift_px" in relief.provenance:
        lines.append(f"walls drift by {relief.provenance['drift_px']:.1f} columns of shadow")
    if any(mark(each["psnr"]) == "poor" for each in scores["pictures"]):
        lines.append("what would help: fewer pictures, plainer ones, or more columns (--columns)")
    nozzle = f"with a nozzle of {relief.recipe.pitch_mm / 2:g} mm or finer"
    lines.append(f"print it lying on its back, in matt white, {nozzle}")
    lines.append("light it by one small lamp far away, in a dark room: +x is right, +y behind")
    return lines


def scored(relief: Relief, scores: Mapping[str, Any]) -> list[str]:
    """Figures of each picture, line by line, and their means."""
    lines = [f"{'picture':>20} {'lamp':>12} {'PSNR':>7} {'SSIM':>7} {'near':>7}"]
    lines += [
        f"{each['name'][:20]:>20} {side_of(each['azimuth_deg']):>12} {each['psnr']:7.2f} {each['ssim']:7.3f} "
        f"{each['near_psnr']:7.2f}"
        for each in scores["pictures"]
    ]
    lines.append(
        f"mean {scores['psnr_mean']:.2f} dB, worst {scores['psnr_min']:.2f}, SSIM {scores['ssim_mean']:.3f}, as seen "
        f"with a blur of two columns; black is {scores['black']:.2f} ({counted(len(relief), 'picture')})"
    )
    lines += [f"lamps {what}: {decibels:.2f} dB" for what, decibels in scores.get("off", {}).items()]
    return lines
