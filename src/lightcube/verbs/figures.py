"""The numbers behind what is said of plans, stages and jobs: aligned lines, and facts for JSON."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from lightcube.backward.wishes import held
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.stage import Stage
from lightcube.planning import feasibility
from lightcube.planning.consistency import check
from lightcube.planning.measured import is_measured
from lightcube.planning.plan import Plan
from lightcube.planning.prediction import MOST_DB, as_json

if TYPE_CHECKING:
    from lightcube.planning.order import Order


def table(planned: Plan, order: "Order | None", remedies: Mapping[str, float]) -> list[str]:
    """Aligned lines: what is expected, with `remedies` too, how full the cube is, what contradicts itself, where."""
    rows = _expected(planned)
    if planned.recipe.hold_deg:
        angles = len(held(planned.targets.rig, planned.recipe, planned.grid)) // len(planned.targets)
        work = f"{angles} angles a picture, and as many times the work"
        rows["hold"] = f"{planned.recipe.hold_deg:g} degrees either way: {work}"
    if order is not None:
        used = "used" if planned.order is not None else "not used"
        rows["best order"] = f"worth {order.best_db - order.given_db:.1f} dB in a draft, {used}"
    if _speaks_of_each_other(planned.targets.rig, planned.grid):
        rows |= _contradictions(check(planned.targets, planned.grid))
    rows |= {f"with {change}": f"PSNR of {decibels:.0f} dB expected" for change, decibels in remedies.items()}
    lines = [f"{name:<15} {value}" for name, value in rows.items()]
    return lines if planned.stage is None else [*lines, *([""] if lines else []), *_places(planned.stage)]


def _speaks_of_each_other(rig: Rig, grid: Grid) -> bool:
    """Whether pictures can be held against each other: they are cast by straight light, as it was measured."""
    return rig.glass is None and is_measured(rig, grid)


def _expected(planned: Plan) -> dict[str, str]:
    prediction = planned.prediction
    if not prediction.is_known:
        return {}
    more = " or more" if prediction.psnr_mean >= MOST_DB else ""
    by = " by method display" * (planned.recipe.method != "display")
    return {"PSNR expected": f"{prediction.psnr_mean:.0f} dB{more} (worst {prediction.psnr_min:.0f}){by}"}


def _contradictions(facts: dict[str, Any]) -> dict[str, str]:
    totals = facts["moments"]
    off = f"{totals['across']:.1%} of the width" + f", {totals['down']:.1%} of the height" * (
        facts["elevation_deg"] != 0
    )
    conflicts = len({(each["row"]) for each in facts["row_conflicts"]})
    white = sum(last - first + 1 for runs in facts["white_rows"].values() for first, last in runs)
    return {
        "load": f"{facts['load']:.1f}, well up to {facts['load_limit']:g}",
        "mirrored pairs": str(len(facts["mirrored"]) or "none"),
        "same pictures": str(len(facts["duplicates"]) or "none"),
        "white rows": str(white or "none"),
        "row conflicts": f"in {conflicts} of {facts['rows']} rows" if conflicts else "none",
        "totals differ": f"{totals['total']:.0%} (a solid's shadows: 5% at most); margin and lamp take it up",
        "centroids": f"off by {off}",
    }


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
        "picture_width": planned.picture_width,
        "hold_deg": planned.recipe.hold_deg,
        "predicted": as_json(planned.prediction),
        "shift": planned.shift,
        "order": None
        if order is None
        else {"best": [int(picture) for picture in order.pictures], "gain_db": order.best_db - order.given_db},
        "impossible": planned.impossible,
        "doubtful": planned.doubtful,
    }
    if _speaks_of_each_other(targets.rig, planned.grid):
        known |= check(targets, planned.grid)
    return known if planned.stage is None else known | feasibility.facts(planned.stage)
