"""The report of a relief: wanted and cast under each lamp, its heights and steps, lamps that stand wrong, the print."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np

from lightcube.drawing import charts
from lightcube.drawing.relief_sheet import as_seen, in_words
from lightcube.optics.arrays import Reals
from lightcube.optics.transfer import to_uint8
from lightcube.report.html import element, figure, image, number, pairs, plain, sideways, table, text
from lightcube.report.opening import Heading, headed
from lightcube.report.page import Origin, document, read_files, written_by
from lightcube.report.printed import print_tiles
from lightcube.scoring import relief_facts
from lightcube.scoring.metrics import mark
from lightcube.scoring.reliefs import BLURS, compared, score_relief
from lightcube.solids.relief import Relief, darkest, display, side_of
from lightcube.solids.relief_light import shown
from lightcube.solids.relief_mesh import relief_mesh
from lightcube.wording import counted

#: How much too high and too round lamps are tried, degrees.
_HIGHER_DEG = (-8.0, -5.0, -3.0, -1.5, 0.0, 1.5, 3.0, 5.0, 8.0)
_ROUND_DEG = (0.0, 1.0, 2.0, 3.0, 5.0, 8.0)
#: Classes of steps.
_CLASSES = 16


@dataclass(frozen=True, eq=False)
class ReliefFindings:
    """All that was measured of a relief.

    Parameters
    ----------
    relief, scores, light
        The relief, `lightcube.score_relief` of it, and what its lamps show, linear light.
    higher, rounder
        PSNR ``(picture, place)`` seen from afar, of lamps that stand too high and too far round.
    volume_mm3, faces
        Of its mesh.
    """

    relief: Relief
    scores: Mapping[str, Any]
    light: Reals
    higher: Reals
    rounder: Reals
    volume_mm3: float
    faces: int


def measure_relief(relief: Relief, callback: Callable[[int, int], None]) -> ReliefFindings:
    """Measure all that a report says of a relief; `callback` is told how many of how many lamps were tried."""
    tried = [(0.0, off) for off in _HIGHER_DEG] + [(off, 0.0) for off in _ROUND_DEG]
    of, found = len(tried) + 1, []
    for done, off_deg in enumerate(tried, start=1):
        found.append([psnr for psnr, _ in compared(relief, _standing(relief, off_deg), BLURS["far"])])
        callback(done, of)
    psnr, mesh = np.array(found).T, relief_mesh(relief)
    scores = score_relief(relief, off=True)
    callback(of, of)
    many = len(_HIGHER_DEG)
    return ReliefFindings(relief, scores, shown(relief), psnr[:, :many], psnr[:, many:], mesh.volume_mm3, len(mesh))


def _standing(relief: Relief, off_deg: tuple[float, float]) -> Reals:
    """What lamps show that stand so wrong, no lower and no higher than lamps can stand."""
    elevation_deg = relief.recipe.elevation_deg
    return shown(relief, (off_deg[0], float(np.clip(off_deg[1], 1 - elevation_deg, 89 - elevation_deg))))


def relief_page(found: ReliefFindings, heading: Heading, origins: Sequence[Origin]) -> str:
    """The text of a relief's report."""
    parts = {
        "Pictures": _pictures(found),
        "Heights": _heights(found),
        "Lamps that stand a little wrong": _lamps(found),
        "The print": _print(found),
        "How it was made": _made(found, origins),
    }
    return document(heading.title, _head(found, heading), parts)


def _head(found: ReliefFindings, heading: Heading) -> str:
    """Title and what it is."""
    relief, (rows, columns) = found.relief, found.relief.heights_px.shape
    shows = "one picture in colour, under three lamps" if relief.is_colour else f"{counted(len(relief), 'picture')}"
    lead = (
        f"One white plate of {columns} × {rows} columns, whose shadows are {shows}. Seen from afar they come to "
        f"{number(found.scores['psnr_mean'], 1)} dB of what was wanted on average, "
        f"{number(found.scores['psnr_min'], 1)} at worst; from near by to {number(found.scores['near_psnr_mean'], 1)}."
    )
    return "\n".join(headed("Relief", heading, lead))


def _pictures(found: ReliefFindings) -> str:
    """Wanted and cast, and figures."""
    relief = found.relief
    wanted, cast = (to_uint8(as_seen(relief, light)) for light in (relief.wanted, found.light))
    names = [relief.names[0].removesuffix(" red")] if relief.is_colour else list(relief.names)
    cards = []
    for index, name in enumerate(names):
        both = "".join(
            image(picture[index], f"{what}: {name}") for what, picture in (("wanted", wanted), ("cast", cast))
        )
        psnr = found.scores["near_psnr_mean"] if relief.is_colour else found.scores["pictures"][index]["near_psnr"]
        where = "red, green and blue lamps" if relief.is_colour else f"lamp {side_of(relief.azimuths_deg[index])}"
        caption = f"{index + 1} {text('b', name)} {text('span', mark(psnr), class_=mark(psnr))}, {where}"
        cards.append(figure(element("div", both, class_="pair"), caption, class_="card"))
    rows = [
        (index + 1, each["name"], side_of(each["azimuth_deg"]), number(each["psnr"]), number(each["ssim"], 3),
         number(each["near_psnr"]), number(each["near_ssim"], 3))
        for index, each in enumerate(found.scores["pictures"])
    ]  # fmt: skip
    heads = ("no.", "picture", "lamp", "PSNR from afar, dB", "SSIM", "near by, dB", "SSIM")
    note = "Left what was wanted, right what the lamp shows, both as an eye near by sees them: it blurs one column."
    floor = display(darkest(relief.recipe.relief_px))
    law = (
        f"Black is {relief.recipe.black_level:.2f} in display values. What throws a shadow is lit itself, so that of a "
        f"dark area no relief {relief.recipe.relief_px:g} columns high shows less than {floor:.2f}."
    )
    return "\n".join(
        [
            text("p", note, class_="note"),
            element("div", "".join(cards), class_="sheet"),
            text("p", law),
            sideways(table("Every picture", heads, rows, "figures"), "The figures"),
        ]
    )


def _heights(found: ReliefFindings) -> str:
    """The height map, and how high steps are."""
    relief = found.relief
    top_mm = float(max(relief.heights_mm.max(), 1e-9))
    levels = np.rint(255 * relief.heights_mm / top_mm).astype(np.uint8)
    drawn = image(np.repeat(levels[..., None], 3, axis=2), "Heights: white is high")
    steps = np.concatenate([np.abs(np.diff(relief.heights_mm, axis=axis)).ravel() for axis in (0, 1)])
    edges = np.linspace(0, max(float(steps.max()), 1e-9), _CLASSES + 1)
    parts = 100 * np.histogram(steps, edges)[0] / max(len(steps), 1)
    said = (
        f"Steps between neighbouring columns: {steps.mean():.2g} mm on average, {steps.max():.3g} mm at most. High "
        "thin ridges break; --steepest bounds them."
    )
    chart = charts.shares(edges, parts, ("step, mm", "part of all steps, %"), said)
    return "\n".join(
        [
            figure(element("div", drawn, class_="map"), f"Heights: black is 0, white {top_mm:.3g} mm.", class_="card"),
            figure(sideways(chart, "Steps between columns"), escape(said)),
        ]
    )


def _lamps(found: ReliefFindings) -> str:
    """What lamps cost that stand a little wrong."""
    relief, names = found.relief, found.relief.names
    made = f"made for {relief.recipe.elevation_deg:g}°"
    made += f" and {relief.recipe.tolerance_deg:g}° below and above" if len(relief.recipe.slopes) > 1 else ""
    off = found.scores["off"]
    rows = [(what, number(psnr), number(found.scores["psnr_mean"] - psnr)) for what, psnr in off.items()]
    parts = [table("What is left of the pictures", ("all lamps", "mean PSNR, dB", "costs, dB"), rows, "figures")]
    for places, psnr, across in (
        (_HIGHER_DEG, found.higher, "lamps too high, degrees"),
        (_ROUND_DEG, found.rounder, "lamps too far round, degrees"),
    ):
        said = f"PSNR of each picture from afar, {across}; the plate is {made}."
        lines = dict(zip(names, psnr, strict=True))
        parts.append(figure(sideways(charts.scored_lines(np.array(places), lines, across, said), across), escape(said)))
    return "\n".join(parts)


def _print(found: ReliefFindings) -> str:
    """What a print takes."""
    recipe = found.relief.recipe
    layers = "" if recipe.layer_mm is None else f" Heights are whole layers of {recipe.layer_mm:g} mm."
    said = (
        f"Columns are {recipe.pitch_mm:g} mm wide: print it lying on its back, in matt white, with a nozzle of "
        f"{recipe.pitch_mm / 2:g} mm or finer.{layers} The mesh has {found.faces} faces."
    )
    return "\n".join([print_tiles(found.volume_mm3, found.relief.size_mm), text("p", said)])


def _made(found: ReliefFindings, origins: Sequence[Origin]) -> str:
    """What the relief remembers, and the file."""
    facts = {name.replace("_", " "): plain(value) for name, value in relief_facts.facts(found.relief).items()}
    words = in_words(found.scores["near_psnr_mean"], found.scores["psnr_mean"])
    lines = [text("p", f"On the whole: {words}."), pairs(facts), *written_by(), *read_files(origins)]
    return "\n".join(lines)
