"""What is said of plans, stages and jobs, in sentences and tables."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from lightcube.backward.wishes import held
from lightcube.jobs.publishing import Published
from lightcube.optics.light import Beams
from lightcube.optics.rig import Rig
from lightcube.optics.stage import Stage
from lightcube.optics.tables import POWER_MOST
from lightcube.pictures.fitting import fit_report
from lightcube.pictures.targets import Targets
from lightcube.planning import feasibility
from lightcube.planning.consistency import advice, check
from lightcube.planning.measured import is_measured
from lightcube.planning.plan import Plan, narrower
from lightcube.planning.prediction import MOST_DB, as_json
from lightcube.planning.rehearsals import Rehearsals

if TYPE_CHECKING:
    from lightcube.planning.order import Order

#: A picture below this PSNR, dB, is hardly recognised.
POOR_DB = 25.0


def table(planned: Plan) -> list[str]:
    """Aligned lines: how full the cube is, what contradicts itself, and where all stands on a stage."""
    full = (
        _contradictions(check(planned.targets, planned.grid)) if is_measured(planned.targets.rig, planned.grid) else []
    )
    return full if planned.stage is None else [*full, *([""] if full else []), *_places(planned.stage)]


def _contradictions(facts: dict[str, Any]) -> list[str]:
    totals = facts["moments"]
    off = f"{totals['across']:.1%} of the width" + f", {totals['down']:.1%} of the height" * (
        facts["elevation_deg"] != 0
    )
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


def _places(stage: Stage) -> list[str]:
    """A line for each picture of a stage."""
    heads = f"{'picture':>20} {'screen':>12} {'stop':>5} {'angle':>8} {'pixels':>11} {'through cube':>13}"
    lines = [f"{heads} {'voxels a pixel':>15}  lamps"]
    for each in feasibility.facts(stage)["per_picture"]:
        where = f"{each['name'][:20]:>20} {each['screen'][:12]:>12} {each['stop']:>5} {each['angle_deg']:>8.2f}"
        seen = f"{each['beams_in_cube']:>13.0%} {each['pixel_in_voxels']:>15.2f}"
        lines.append(f"{where} {each['columns']:>4} x {each['rows']:<4} {seen}  {', '.join(each['lamps'])}")
    return lines


def facts(planned: Plan, order: "Order | None") -> dict[str, Any]:
    """What can be known before solving, for JSON; `order` is the best one, if it was looked for."""
    targets = planned.targets
    known: dict[str, Any] = {
        "names": list(targets.names),
        "angles_deg": [float(angle_deg) for angle_deg in targets.angles_deg],
        "voxels": list(planned.grid.shape),
        "picture_width": _picture_width(planned),
        "hold_deg": planned.recipe.hold_deg,
        "predicted": as_json(planned.prediction),
        "shift": planned.shift,
        "order": None
        if order is None
        else {"best": [int(picture) for picture in order.pictures], "gain_db": order.best_db - order.given_db},
        "impossible": planned.impossible,
        "doubtful": planned.doubtful,
    }
    if is_measured(targets.rig, planned.grid):
        known |= check(targets, planned.grid)
    return known if planned.stage is None else known | feasibility.facts(planned.stage)


def in_short(planned: Plan, order: "Order | None") -> list[str]:
    """Lines that `solve` says before it starts; `order` is the best one, if it was looked for."""
    nz, ny, nx = planned.grid.shape
    hold_deg = planned.recipe.hold_deg
    lines = [_wanted(planned), f"cube of {nx} x {ny} x {nz} voxels{expected(planned)}"]
    if hold_deg:
        angles = len(held(planned.targets.rig, planned.recipe, planned.grid)) // len(planned.targets)
        lines.append(f"held {hold_deg:g} degrees either way: {angles} angles a picture, and as many times the work")
    return [
        *lines,
        *gain(planned, order),
        *planned.doubtful,
        *unsampled(planned.targets.rig, "thin" if planned.recipe.beams.is_thin else "area"),
    ]


def _wanted(planned: Plan) -> str:
    """What happens to the pictures; in a room that is described, on how many screens they are, and so on."""
    if planned.stage is None:
        return fit_report(planned.pictures, planned.targets, planned.fit)
    rig = planned.targets.rig
    counts = {
        "picture": len(rig),
        "screen": len(rig.screens.names),
        "lamp": len(rig.lamps.names),
        "stop": len(planned.stage.stops_deg),
    }
    views = f", {len(rig.views)} views" if len(rig.views) != len(rig) else ""
    return ", ".join(f"{count} {name}{'s' * (count != 1)}" for name, count in counts.items()) + views


def unsampled(rig: Rig, light: Beams) -> list[str]:
    """A sentence where lamps have a size that thin beams do not mind."""
    if light != "thin" or not np.any(rig.sums.disc_deg):
        return []
    names = dict.fromkeys(rig.lamps.names[lamp] for lamp in rig.sums.lamp[rig.sums.disc_deg > 0])
    return [f"thin beams do not mind the size of lamp {', '.join(map(repr, names))}: leave out --light thin"]


def expected(planned: Plan) -> str:
    """What is predicted, in words that go on with a sentence."""
    prediction = planned.prediction
    if not prediction.is_known:
        told = planned.impossible or is_measured(planned.targets.rig, planned.grid)
        return "" if told else "; how good they become was not measured in rooms like this"
    more = " or more" if prediction.psnr_mean >= MOST_DB else ""
    by = " by method display" * (planned.recipe.method != "display")
    return f", PSNR of {prediction.psnr_mean:.0f} dB{more} expected (worst {prediction.psnr_min:.0f}){by}"


def gain(planned: Plan, order: "Order | None") -> list[str]:
    """What another order would gain, or which one is used."""
    if order is None:
        return []
    better = order.best_db - order.given_db
    if planned.order is not None:
        return [f"order (worth {better:.1f} dB in a draft): {', '.join(planned.targets.names)}"]
    return [f"another order would gain about {better:.1f} dB: --order best"] if better >= 1 else []


def what_to_change(planned: Plan, small: Rehearsals) -> list[str]:
    """Sentences on what is wrong with the pictures, and where the prediction is poor, what would help and how much.

    None of a stage: they name options that it leaves no room for.
    """
    if planned.stage is not None:
        return []
    found = advice(check(planned.targets, planned.grid))
    if planned.prediction.is_known and planned.prediction.psnr_mean < POOR_DB:
        return [*found, *_remedies(planned, small)]
    return [sentence for sentence in found if not sentence.startswith("The load")]


def _remedies(planned: Plan, small: Rehearsals) -> list[str]:
    """What three changes would bring, predicted."""
    rig, lamps = planned.targets.rig, planned.targets.rig.lamps
    power = float(lamps.most.max())
    now = _picture_width(planned)
    tried: list[str] = []

    def tell(change: str, targets: Targets) -> None:
        tried.append(f"{change}: {small.predict(targets, planned.grid, planned.recipe).psnr_mean:.0f} dB")

    every_second = np.arange(0, len(planned.targets), 2)
    if len(every_second) > 1:
        tell(f"{len(every_second)} of the pictures", planned.targets.take(every_second))
    tell(f"--picture-width {0.7 * now:.2g}", narrower(planned, 0.7 * now))
    most = min(16 * power, POWER_MOST)
    if not lamps.are_fixed and most > power:
        stronger = replace(rig, lamps=replace(lamps, most=np.full(len(lamps.names), most)))
        tell(f"--lamp-max {most:g}", replace(planned.targets, rig=stronger))
    return [f"Hardly recognisable pictures are expected; what would come of {'; of '.join(tried)}."] if tried else []


def _picture_width(planned: Plan) -> float:
    """Width of a plan's pictures as a part of the cube's."""
    rig, grid = planned.targets.rig, planned.grid
    return rig.picture_shape[1] * rig.views.pixel_in(grid)[1] / grid.shape[1]


def needed(needs: dict[str, Any]) -> str:
    """What a job will need, in words."""
    units = f"in {needs['units']} units" if needs["units"] > 1 else "in one unit"
    memory = f"{needs['memory'] / 1e9:.2g} GB of memory ({needs['free_memory'] / 1e9:.2g} GB are free)"
    if needs["seconds"] is None:
        return f"{memory}, {units}"
    return f"{memory}, {units}, at most {needs['passes']:.0f} passes, about {duration(needs['seconds'])}"


def holds(made: Published) -> str:
    """How much of a published cube is finished, and what the rest is."""
    rest = "the rest is as far as it was solved, or what it would start from; solve --overwrite goes on with it"
    return f"{made.path} holds {made.done} of {made.units} units, {rest}"


def duration(seconds: float) -> str:
    """A time for people: "40 s", "12 min", "3.5 h"."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"
