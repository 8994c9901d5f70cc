"""The parts of a report, as HTML: what is said of a cube, in the order in which it is asked."""

from collections.abc import Iterator
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.drawing import charts
from lightcube.drawing.stage import drawing
from lightcube.optics.cube import Cube
from lightcube.optics.disturbance import SAID
from lightcube.optics.naming import is_dial, told_apart
from lightcube.optics.stack import Stack
from lightcube.optics.told import remembered
from lightcube.planning.feasibility import facts
from lightcube.planning.prediction import MOST_DB
from lightcube.report.html import element, figure, figure_tiles, image, number, pairs, sentences, sideways, table, text
from lightcube.report.measuring import EXACT, Findings, gain
from lightcube.report.words import span
from lightcube.scoring.between import LOBE_DB
from lightcube.scoring.metrics import FAIR_DB, GOOD_DB, WELL_DB, grain_word, mark
from lightcube.wording import counted, in_ev

#: What a PSNR means.
_LADDER = (
    f"PSNR is of what a wall shows: from {FAIR_DB:g} dB on a picture is called fair here, from {WELL_DB:g} dB on good, "
    f"and {GOOD_DB:g} dB can hardly be told from what was wanted."
)
#: What extinction in few levels costs where it is worth a word, dB, and the absorbance of a voxel that is dark enough.
_COARSE_DB, _DARK = 20, 10


def figures(found: Findings, compared: str) -> str:
    """How good it is, in numbers: of the whole, and of every picture."""
    cube, scores = found.cube, found.scores
    worst = min(scores["pictures"], key=lambda view: float(view["psnr"]))["name"]
    tiles = {
        "mean PSNR": (f"{number(scores['psnr_mean'])} dB", _predicted(cube, "psnr_mean")),
        "worst PSNR": (f"{number(scores['psnr_min'])} dB", worst),
        "SSIM": (number(scores["ssim_mean"], 4), "mean; 1 is perfect"),
        "CIEDE2000": (number(scores["delta_e_mean"]), "mean; below 1 is invisible"),
        "grain": (number(scores["grain_rms"], 3), f"inside pixels; {grain_word(scores['grain_rms'])}"),
        "thin beams": (f"{number(scores['thin_psnr_mean'])} dB", "through the middles of pixels, as in the paper"),
    }
    if "mat_rms" in scores:
        beyond = f"; beyond it {number(scores['beyond_rms'], 2)}" if "beyond_rms" in scores else ""
        tiles["mat"] = (number(scores["mat_rms"], 3), f"off its tone; 0 is calm{beyond}")
    return "\n".join(
        [
            figure_tiles(tiles),
            text("p", f"{compared} {_LADDER}", class_="note"),
            sideways(_table(found), "The figures"),
        ]
    )


def _predicted(cube: Cube, name: str) -> str:
    """What was predicted, if it was."""
    predicted = remembered(cube).get("predicted")
    if predicted is None:
        return "mean over the pictures" if name == "psnr_mean" else ""
    return f"predicted: {number(predicted[name], 1)} dB" + " or more" * (predicted[name] >= MOST_DB)


def _range_ev(cube: Cube) -> str:
    """Least and largest power of a cube's lamps in stops of a camera."""
    least, most = in_ev(float(cube.powers.min())), in_ev(float(cube.powers.max()))
    return least if least == most else f"{least} to {most}"


def settings(found: Findings) -> str:
    """What cube, lamp and solver were set to."""
    cube, made = found.cube, remembered(found.cube)
    kinds = {"per-picture": "one per picture and colour", "shared": "one per colour"}
    kinds |= {"coarse": "one per picture and colour, found at half the size"}
    lamps = cube.rig.lamps
    fixed = lamps.are_fixed and "powers" in made
    kind = "fixed" if fixed else kinds.get(str(made.get("powers")), "–")
    most = "" if fixed else f", at most {lamps.most.max():g} or {in_ev(lamps.most.max())}"
    reasons = {
        "enough": "the pictures were good enough",
        "converged": "nothing was left to gain",
        "iterations": "that was all that was allowed",
        "callback": "it was stopped",
    }
    passes = f"{made['iterations']}" if "iterations" in made else "–"
    reason = reasons.get(str(made.get("stop_reason")))
    nz, ny, nx = cube.grid.shape
    sides = cube.grid.sides_in_words.replace("x", "×")
    is_stack = isinstance(cube.grid, Stack)
    held = f"{cube.hold_deg:g}° on either side of a stop" if cube.hold_deg else "none"
    return pairs(
        {
            **({"Films": f"{nz} of {nx} × {ny} cells of {sides}"} if is_stack else {}),
            **({} if is_stack else {"Voxels": f"{nx} × {ny} × {nz} of {sides}"}),
            **_placed(cube),
            "Lamp power": f"{span(cube.powers, '.4g')}, that is {_range_ev(cube)} ({kind}{most})",
            **({} if is_stack else {"Hold": held}),
            "Method": str(made.get("method", "–")),
            "Passes": f"{passes}: {reason}" if reason else passes,
            "Extinction": f"{cube.extinction.mean():.4g} per mm on average, {cube.extinction.max():.4g} at most",
            "Transfer": cube.transfer,
        }
    )


def _placed(cube: Cube) -> dict[str, str]:
    """Stops, lamps and screens."""
    rig = cube.rig
    said = {
        **({} if is_dial(rig) else {"Stops": _stops(np.unique(cube.angles_deg))}),
        "Lamps": ", ".join(rig.lamps.names),
        "Screens": ", ".join(rig.screens.names),
    }
    if rig.elevation_deg is not None and not is_dial(rig):
        said["Lamp elevation"] = f"{rig.elevation_deg:g}°"
    if np.any(rig.sums.disc_deg):
        said["Lamp size"] = ", ".join(
            f"{disc_deg:g}°" for disc_deg in np.unique(rig.sums.disc_deg[rig.sums.disc_deg > 0])
        )
        if rig.elevation_deg is not None:
            said["Screen stands"] = f"{rig.behind_mm[0]:.4g} mm behind the cube's middle"
    return said


def _stops(angles_deg: NDArray[np.float64]) -> str:
    """How many stops, and where the first and the last one are."""
    return (
        f"{len(angles_deg)}, from {angles_deg.min():.6g}° to {angles_deg.max():.6g}°"
        if len(angles_deg) > 1
        else f"{angles_deg[0]:.6g}°"
    )


def pictures(found: Findings) -> str:
    """Every picture as it is cast, beside what was wanted."""
    total = len(found.cube.names)
    note = "On the left what was wanted, on the right what the wall shows; grey is what nobody asked for."
    if len(found.pictures) < total:
        note += f" {len(found.pictures)} of {total} pictures are here, evenly chosen; the table of figures has all."
    if not _exact(found):
        note += " To keep the page small they lost a little; no figure did."
    cards = "\n".join(_card(found, number) for number in sorted(found.pictures))
    return "\n".join([text("p", note, class_="note"), element("div", cards, class_="sheet")])


def _exact(found: Findings) -> bool:
    """Whether the page has room for the pictures without loss."""
    return sum(each[0].shape[0] * each[0].shape[1] for each in found.pictures.values()) <= EXACT


def _card(found: Findings, index: int) -> str:
    """Wanted and shown, side by side, and what they are."""
    view = found.scores["pictures"][index]
    both = "".join(_image(found, index, kind) for kind in ("wanted", "shown"))
    how = mark(view["psnr"])
    caption = f"{_named(found, index)} {text('span', how, class_=how)} {escape(_apart(found)[index])}"
    return figure(element("div", both, class_="pair"), caption, class_="card")


def _apart(found: Findings) -> list[str]:
    """What tells each picture apart."""
    rig = found.cube.rig
    return told_apart(rig) if is_dial(rig) else [f"at {round(angle_deg, 2):g}°" for angle_deg in found.cube.angles_deg]


def _named(found: Findings, index: int) -> str:
    """Number and name of a picture."""
    return f"{index + 1} {text('b', found.cube.names[index])}"


def _image(found: Findings, index: int, kind: str) -> str:
    """One of the three pictures that are kept of each."""
    levels = found.pictures[index][("wanted", "shown", "difference").index(kind)]
    return image(levels, f"{kind}: {found.cube.names[index]}", exact=_exact(found))


def _differences(found: Findings) -> str:
    """Shown less wanted, of every picture."""
    cards = []
    for index in sorted(found.pictures):
        times = gain(found.scores["pictures"][index]["psnr"])
        said = _named(found, index) + text("div", f"{times}\u00a0times" if times > 1 else "as it is")
        cards.append(figure(_image(found, index, "difference"), said, class_="card"))
    note = (
        "What the wall shows less what was wanted, around grey: brighter where it is too bright. Small differences are "
        "drawn larger, as many times as stands below each."
    )
    return text("h3", "Differences") + text("p", note, class_="note") + element("div", "".join(cards), class_="tiny")


def _table(found: Findings) -> str:
    """One row per picture."""
    cube, expected = found.cube, _expected(found.cube)
    heads = ["no.", "picture", "shown" if is_dial(cube.rig) else "angle", "PSNR, dB", "SSIM", "CIEDE2000"]
    heads += ["predicted, dB"] * (expected is not None)
    heads += [f"{LOBE_DB:g} dB over"] * (found.curve is not None)
    heads += ["screen"] * (len(cube.rig.screens.names) > 1)
    return table("Every picture", heads, list(_rows(found, expected)), "figures")


def _rows(found: Findings, expected: list[float] | None) -> Iterator[list[object]]:
    rig = found.cube.rig
    for index, view in enumerate(found.scores["pictures"]):
        told = _apart(found)[index] if is_dial(rig) else f"{view['angle_deg']:.3f}°"
        row: list[object] = [index + 1, view["name"], told, number(view["psnr"])]
        row += [number(view["ssim"], 4), number(view["delta_e"])]
        row += [] if expected is None else [number(expected[index], 1)]
        row += [] if found.curve is None else [f"{found.curve.lobes_deg[index]:.2f}°"]
        row += [rig.screens.names[rig.stops.screen[index]]] if len(rig.screens.names) > 1 else []
        yield row


def _expected(cube: Cube) -> list[float] | None:
    """What was predicted of each picture."""
    views = remembered(cube).get("predicted", {}).get("pictures", [])
    return [float(each) for each in views] if len(views) == len(cube.names) else None


def curves(found: Findings) -> str:
    """PSNR of each picture, PSNR between the stops, and the lamp's powers."""
    cube, scores, expected = found.cube, found.scores, _expected(found.cube)
    each = np.array([view["psnr"] for view in scores["pictures"]])
    mean, worst = number(scores["psnr_mean"]), number(scores["psnr_min"])
    label = f"PSNR of {counted(len(each), 'picture')}: {mean} dB on average, worst {worst} dB"
    said = "PSNR of each picture, the worst one in a colour of its own, the mean as a line"
    said += ", and what was predicted as short lines." if expected else "."
    bars = charts.picture_bars(cube.names, each, None if expected is None else np.array(expected), label)
    return "\n".join(
        [
            figure(sideways(bars, "PSNR of each picture"), escape(said + " Numbers are those of the table.")),
            *_between(found),
            figure(sideways(_powers(cube), "Lamp powers"), escape(_powers_said(cube))),
            _differences(found),
        ]
    )


def _between(found: Findings) -> Iterator[str]:
    """What is seen between the stops."""
    curve = found.curve
    if isinstance(found.cube.grid, Stack):
        return
    if curve is None:
        yield text("p", "Nothing turns: there is nothing to be seen between the stops.")
        return
    lobes = f"{curve.lobes_deg.min():.2f}° to {curve.lobes_deg.max():.2f}°, {curve.lobes_deg.mean():.2f}° on average"
    stands = f"A picture stays above {LOBE_DB:g} dB over {lobes}."
    drawn = charts.between_curve(curve, f"PSNR against the turntable's angle. {stands}")
    said = f"PSNR of the nearer picture as the table turns; dots are the stops. {stands}"
    yield figure(sideways(drawn, "PSNR against the angle"), escape(said))


def _powers(cube: Cube) -> str:
    """The lamp's powers over the pictures."""
    places, most = (cube.rig.pairs[:, 0] + 1).astype(np.float64), float(cube.rig.lamps.most.max())
    return charts.lamp_powers(
        places, cube.powers, most, f"Lamp powers from {span(cube.powers, '.4g')}, at most {most:g}"
    )


def _powers_said(cube: Cube) -> str:
    """What the drawing of powers shows."""
    colours = "; red discs, green squares, blue triangles" if cube.powers.shape[1] == 3 else ""
    lamps = ", of each of its lamps" if len(cube.rig.lamps.names) > 1 else ""
    past = "films" if isinstance(cube.grid, Stack) else "cube"
    return (
        f"Power of the lamp for each picture and colour{lamps}; 1 shows white past the {past}, and "
        f"twice as much is 1 EV more{colours}. "
        "The dashed line is the largest that was allowed."
    )


def disturbances(found: Findings) -> str:
    """What is left of the pictures in a set-up that is not perfect."""
    best = found.robust["undisturbed"]["psnr_mean"]
    is_relit = "relit_mean" in found.robust["undisturbed"]
    rows = [
        (
            *(SAID[name], number(left["psnr_mean"]), number(left["psnr_min"]), number(best - left["psnr_mean"])),
            *([number(left["relit_mean"])] if is_relit else []),
        )
        for name, left in found.robust.items()
    ]
    heads = ("what is off", "mean PSNR, dB", "worst, dB", "costs, dB", *(["relit, dB"] if is_relit else []))
    parts = [table("What is left of the pictures", heads, rows, "figures")]
    if is_relit:
        relit = "Relit: under an exposure found anew for each picture and colour, as one shows or photographs it."
        parts.append(text("p", relit, class_="note"))
    darkest = float(found.cube.extinction.max()) * found.cube.grid.voxel_mm
    if (
        "extinction" in found.robust
        and found.robust["extinction"]["psnr_mean"] < best - _COARSE_DB
        and darkest > 1.1 * _DARK
    ):
        bound = number(_DARK / found.cube.grid.voxel_mm)
        parts.append(
            element(
                "p",
                "A few voxels are far darker than the others, so 256 even levels are too coarse for these (below 0 dB "
                f"the screen is much brighter than white). Solved with <code>--max-extinction {bound}</code>, no voxel "
                f"darker than an absorbance of {_DARK}, such a cube is as good and bears them far better.",
                class_="note",
            )
        )
    return "\n".join(parts)


def before(found: Findings) -> str:
    """What was known before solving, and what came of it."""
    parts = [*_told(found)]
    if isinstance(found.cube.grid, Stack):
        pass  # its room stands with its films
    elif found.stage is not None:
        parts += _room(found)
    elif found.preflight is not None:
        parts.append(pairs(_checked(found.preflight)))
    else:
        parts.append(text("p", "The stage's file says more of its room: give it as the pictures of this report."))
    if found.advice:
        parts.append(sentences(found.advice))
    else:
        parts.append(text("p", "Nothing is known to be wrong with these pictures."))
    return "\n".join(parts)


def _told(found: Findings) -> Iterator[str]:
    """Predicted and reached."""
    predicted = remembered(found.cube).get("predicted")
    if predicted is None:
        yield text("p", "What to expect was not predicted.")
        return
    rows = [
        (what, number(predicted[name], 1), number(found.scores[name]), f"{found.scores[name] - predicted[name]:+.1f}")
        for what, name in (("mean PSNR, dB", "psnr_mean"), ("worst PSNR, dB", "psnr_min"))
    ]
    yield table("What was predicted, and what came", ("what", "predicted", "came", "difference"), rows, "figures")
    yield text("p", f"{MOST_DB:g} dB stands for all that is above.", class_="note")


def _checked(known: dict[str, Any]) -> dict[str, object]:
    """What `lightcube.check` found, in words."""
    totals = known["moments"]
    white = sum(last - first + 1 for runs in known["white_rows"].values() for first, last in runs)
    down = f", {totals['down']:.1%} of the height" if known["elevation_deg"] else ""
    return {
        "Load": f"{known['load']:.2f}; unrelated pictures come out well up to {known['load_limit']:g}",
        "Mirrored pairs": len(known["mirrored"]) or "none",
        "Same pictures": len(known["duplicates"]) or "none",
        "White rows": white or "none",
        "Rows that contradict each other": len({each["row"] for each in known["row_conflicts"]}) or "none",
        "Totals differ": f"{totals['total']:.0%} (a solid's shadows: 5% at most)",
        "Centroids": f"off by {totals['across']:.1%} of the width{down}",
    }


def _room(found: Findings) -> Iterator[str]:
    """The stage, drawn, and where its pictures stand."""
    assert found.stage is not None  # noqa: S101 - asked before
    yield figure(sideways(drawing(found.stage), "The room"), "The room from above and from the side.", class_="room")
    rows = [
        (
            each["name"],
            each["screen"],
            ", ".join(each["lamps"]),
            each["stop"],
            f"{each['beams_in_cube']:.0%}",
            number(each["pixel_in_voxels"]),
        )
        for each in facts(found.stage)["per_picture"]
    ]
    heads = ("picture", "screen", "lamps", "stop", "beams through the cube", "voxels a pixel")
    yield sideways(table("Where the pictures stand", heads, rows, "figures"), "Where the pictures stand")
