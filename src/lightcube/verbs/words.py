"""What is said of plans, stages and jobs, in sentences and tables."""

from typing import Any

import numpy as np

from lightcube.backward import recipe
from lightcube.optics.views import held
from lightcube.pictures.arranging import shifted, spread_over_screen
from lightcube.pictures.fitting import fit, fit_report
from lightcube.pictures.frames import Frames
from lightcube.planning.consistency import advice, check
from lightcube.planning.plan import Plan, Prepared
from lightcube.planning.prediction import Prediction, as_json, predict
from lightcube.verbs.options import Options

#: A picture below this PSNR, dB, is hardly recognised.
POOR_DB = 25.0


def table(facts: dict[str, Any]) -> list[str]:
    """Facts as aligned lines: how full the cube is, and what contradicts itself."""
    totals = facts["moments"]
    off = f"{totals['across']:.1%} of the width" + f", {totals['down']:.1%} of the height" * (facts["elevation"] != 0)
    conflicts = len({(each["row"]) for each in facts["row_conflicts"]})
    rows = {
        "load": f"{facts['load']:.1f}, well up to {facts['load_limit']:g}",
        "mirrored pairs": len(facts["mirrored"]) or "none",
        "same pictures": len(facts["duplicates"]) or "none",
        "white rows": sum(last - first + 1 for runs in facts["white_rows"].values() for first, last in runs) or "none",
        "row conflicts": f"in {conflicts} of {facts['rows']} rows" if conflicts else "none",
        "totals differ": f"{totals['total']:.0%} (a solid's shadows: 5% at most); margin and lamp take it up",
        "centroids": f"off by {off}",
    }
    return [f"{name:<16}{value}" for name, value in rows.items()]


def facts(prepared: Prepared, options: Options) -> dict[str, Any]:
    """What can be known before solving, for JSON."""
    planned = prepared.plan
    found = check(planned.frames, planned.grid, options.power)
    return {
        "names": list(planned.frames.names),
        "angles": [float(angle) for angle in planned.frames.views.angles],
        "voxels": list(planned.grid.shape),
        "frame_width": planned.frames.views.picture_shape[1] / planned.grid.shape[1],
        "hold": planned.hold,
        **found,
        "predicted": as_json(planned.prediction),
        "shift": options.shift,
        "order": None
        if prepared.order is None
        else {
            "best": [int(picture) for picture in prepared.order.pictures],
            "gain_db": prepared.order.best_db - prepared.order.given_db,
        },
    }


def in_short(prepared: Prepared, options: Options) -> list[str]:
    """Lines that `solve` says before it starts."""
    planned = prepared.plan
    nz, ny, nx = planned.grid.shape
    lines = [
        fit_report(prepared.pictures, planned.frames, options.fit),
        f"cube of {nx} x {ny} x {nz} voxels, {expected(planned)}"
        + " by method display" * (options.method != "display"),
    ]
    if planned.hold:
        angles = len(held(planned.frames.views, planned.hold, planned.grid)) // len(planned.frames)
        lines.append(f"held {planned.hold:g} degrees either way: {angles} angles a picture, and as many times the work")
    lines += gain(prepared, options)
    return lines


def expected(planned: Plan) -> str:
    """What is predicted, in words."""
    prediction = planned.prediction
    more = " or more" if prediction.psnr_mean >= 50 else ""
    return f"PSNR of {prediction.psnr_mean:.0f} dB{more} expected (worst {prediction.psnr_min:.0f})"


def gain(prepared: Prepared, options: Options) -> list[str]:
    """What another order would gain, or which one is used."""
    order = prepared.order
    if order is None:
        return []
    better = order.best_db - order.given_db
    if options.order == "best":
        return [f"order (worth {better:.1f} dB in a draft): {', '.join(prepared.frames.names)}"]
    return [f"another order would gain about {better:.1f} dB: --order best"] if better >= 1 else []


def what_to_change(prepared: Prepared, options: Options) -> list[str]:
    """Sentences on what is wrong with the pictures, and where the prediction is poor, what would help and how much."""
    planned = prepared.plan
    if options.paper:  # all that would help contradicts it
        return []
    found = advice(check(planned.frames, planned.grid, options.power))
    if planned.prediction.psnr_mean >= POOR_DB:
        return [sentence for sentence in found if not sentence.startswith("The load")]
    return [*found, *_remedies(prepared, options)]


def _remedies(prepared: Prepared, options: Options) -> list[str]:
    """What three changes would bring, predicted."""
    planned, lamps = prepared.plan, options.lamps
    now = planned.frames.views.picture_shape[1] / planned.grid.shape[1]
    tried: list[str] = []

    def tell(change: str, prediction: Prediction) -> None:
        tried.append(f"{change}: {prediction.psnr_mean:.0f} dB")

    every_second = np.arange(0, len(planned.frames), 2)
    if len(every_second) > 1:
        fewer = planned.frames.take(every_second)
        tell(f"{len(fewer)} of the pictures", predict(fewer, planned.grid, hold=planned.hold, **lamps))
    smaller = narrower(prepared, options, 0.7 * now)
    tell(f"--frame-width {0.7 * now:.2g}", predict(smaller, planned.grid, hold=planned.hold, **lamps))
    most = min(16 * options.power, recipe.LAMP_MOST)
    if options.lamp != "fixed" and most > options.power:
        stronger = predict(planned.frames, planned.grid, hold=planned.hold, **(lamps | {"lamp_max": most}))
        tell(f"--lamp-max {most:g}", stronger)
    return [f"Hardly recognisable pictures are expected; what would come of {'; of '.join(tried)}."] if tried else []


def narrower(prepared: Prepared, options: Options, width: float) -> Frames:
    """The frames as they would be at another width, at the same stops."""
    views = prepared.frames.views
    elevation = float(views.elevations[0])
    frames = fit(
        prepared.pictures,
        prepared.plan.grid,
        angles=views.angles,
        elevation=elevation,
        frame_width=width,
        fit=options.fit,
    )
    if options.shift:
        frames = shifted(frames, spread_over_screen(frames, prepared.plan.grid, options.shift))
    return prepared.order(frames) if options.order == "best" and prepared.order is not None else frames


def needed(needs: dict[str, Any]) -> str:
    """What a job will need, in words."""
    units = f"in {needs['units']} units" if needs["units"] > 1 else "in one unit"
    memory = f"{needs['memory'] / 1e9:.2g} GB of memory ({needs['free_memory'] / 1e9:.2g} GB are free)"
    if needs["seconds"] is None:
        return f"{memory}, {units}"
    return f"{memory}, {units}, at most {needs['passes']:.0f} passes, about {duration(needs['seconds'])}"


def duration(seconds: float) -> str:
    """A time for people: "40 s", "12 min", "3.5 h"."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"
