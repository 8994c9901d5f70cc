"""What `check`, `solve` and `score` do with a stage instead of a folder of pictures."""

from typing import Any

import numpy as np

from lightcube import io
from lightcube.backward.job import Job
from lightcube.backward.needs import job_memory
from lightcube.backward.solving import make_job
from lightcube.errors import InputError
from lightcube.optics.rig import Rig
from lightcube.optics.stage import Stage
from lightcube.pictures.targets import Targets
from lightcube.planning.placement import doubtful, facts, impossible
from lightcube.planning.reachable import sentences
from lightcube.verbs.options import Options
from lightcube.verbs.solving import check_memory, too_much

#: Options that a stage file leaves no room for.
_SAID = (
    *(
        "n",
        "shape",
        "size_mm",
        "picture_width",
        "fit",
        "angles_deg",
        "span_deg",
        "elevation_deg",
        "paper",
        "order",
        "shift",
    ),
    *("lamp_power", "lamp_max", "black"),
)


def read(path: str, options: Options) -> tuple[Stage, Targets]:
    """Read a stage and fit its pictures, or raise `InputError` where it cannot be, or an option contradicts it."""
    _ = options.recipe  # refuses what cannot be
    for name in _SAID:
        if getattr(options, name) != getattr(Options(), name):
            option = name.replace("_", "-")
            raise InputError(f"--{option} is not for a stage, and {path} is one that says all there is: leave it out")
    samples = {"lamp_samples": options.lamp_samples, "pixel_samples": options.pixel_samples}
    stage, targets = io.read_stage_targets(path, transfer=options.transfer, **samples)
    found = impossible(stage)
    if found:
        raise InputError(f"{path}: {found[0]}")
    return stage, targets


def job(
    stage: Stage, targets: Targets, options: Options, *, memory: int | None = None, units: int | None = None
) -> Job:
    """Settle all that decides the cube of a stage; `InputError` where it does not fit into `memory` bytes."""
    samples = {name: getattr(options, name) for name in ("lamp_samples", "pixel_samples") if getattr(options, name) > 1}
    made = make_job(targets, stage.grid, options.recipe, units=units, memory=memory, provenance=samples)
    if memory is not None and job_memory(made) > memory:
        raise too_much(job_memory(made), memory)
    check_memory(job_memory(made))
    return made


def in_short(stage: Stage, targets: Targets) -> list[str]:
    """Lines that `solve` says of a stage before it starts."""
    nz, ny, nx = stage.grid.shape
    counts = {
        "picture": len(targets),
        "screen": len(stage.screens),
        "lamp": len(stage.lamps),
        "stop": len(stage.stops_deg),
    }
    said = ", ".join(f"{count} {name}{'s' * (count != 1)}" for name, count in counts.items())
    count = len(targets.rig.views)
    views = f", {count} views" if count != len(targets) else ""
    first = f"{said}{views}; cube of {nx} x {ny} x {nz} voxels"
    return [first, *doubtful(stage), *sentences(targets), *unsampled(targets.rig)]


def unsampled(rig: Rig) -> list[str]:
    """A sentence where lamps have a size that is not minded."""
    if not np.any(rig.sums.disc_deg):
        return []
    names = dict.fromkeys(rig.lamps.names[lamp] for lamp in rig.sums.lamp[rig.sums.disc_deg > 0])
    return [f"the size of lamp {', '.join(map(repr, names))} is not minded: --lamp-samples 16 does"]


def table(stage: Stage) -> list[str]:
    """What is known of each picture of a stage, as aligned lines."""
    heads = f"{'picture':>20} {'screen':>12} {'stop':>5} {'angle':>8} {'pixels':>11} {'through cube':>13}"
    return [f"{heads} {'voxels a pixel':>15}  lamps", *(_line(each) for each in facts(stage)["per_picture"])]


def _line(each: dict[str, Any]) -> str:
    """The line of one picture."""
    where = f"{each['name'][:20]:>20} {each['screen'][:12]:>12} {each['stop']:>5} {each['angle_deg']:>8.2f}"
    size = f"{each['columns']:>4} x {each['rows']:<4} {each['beams_in_cube']:>13.0%} {each['pixel_in_voxels']:>15.2f}"
    return f"{where} {size}  {', '.join(each['lamps'])}"
