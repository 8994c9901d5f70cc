"""What `check` and `solve` share: from the options of the command line to a plan, and what is said of it."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lightcube import arguments, backward, io
from lightcube.cli_options import Options
from lightcube.conditioning import Order, best_order, shifted, spread_over_screen
from lightcube.consistency import advice, check
from lightcube.errors import InputError
from lightcube.fitting import fit, fit_report
from lightcube.frames import Frames, Pictures
from lightcube.geometry import Grid, held
from lightcube.job import Job
from lightcube.needs import expected_passes, job_memory, memory_needed, seconds_a_pass
from lightcube.planning import Plan, plan
from lightcube.prediction import Prediction, predict
from lightcube.units import most_units

#: A picture below this PSNR, dB, is hardly recognised.
POOR_DB = 25.0
#: Orders of more pictures than this are looked for only when asked for: it takes too long.
_QUICK = 40


@dataclass(frozen=True, eq=False)
class Prepared:
    """Pictures, what is planned for them, and in which order they shall stand."""

    pictures: Pictures
    plan: Plan
    order: Order | None

    @property
    def frames(self) -> Frames:
        """As they are to be solved."""
        return self.plan.frames


def settled(options: Options) -> Options:
    """Fill in the lamp's kind and the paper's own set-up; `InputError` where others contradict them."""
    check_passes(options)
    if options.paper:
        options = _as_in_the_paper(options)
    if max(options.lamp_samples, options.pixel_samples) > 1:
        raise InputError("--lamp-samples and --pixel-samples are for a stage: describe lamp and screen in a stage file")
    kind = backward.check_options(options.method, **options.lamps, iterations=options.iterations)
    return replace(options, lamp=kind)


def check_passes(options: Options) -> None:
    """Raise `InputError` where options contradict each other about the number of passes."""
    if options.quality is not None and options.iterations is not None:
        raise InputError("--quality and --iterations both say how many passes: leave one of them out")
    if options.quality is not None and options.method != "display":
        raise InputError(f"--quality is for method display: use --iterations with method {options.method}")


def _as_in_the_paper(options: Options) -> Options:
    said = {
        "--frame-width": options.frame_width,
        "--angles": options.angles,
        "--span": options.span,
        "--elevation": options.elevation,
        "--lamp": options.lamp,
        "--lamp-power": options.lamp_power,
        "--lamp-max": options.lamp_max,
        "--hold": options.hold,
        "--shift": options.shift or None,
    }
    contradiction = [name for name, value in said.items() if value is not None]
    if contradiction:
        raise InputError(
            f"--paper says what {contradiction[0]} says too (lamp level and of power 1, half a turn, pictures as wide "
            "as the cube, no hold): leave out one of the two"
        )
    voxels = ",".join(str(count) for count in arguments.voxels(options.n, options.shape, options.size_mm))
    white: dict[str, Any] = {"elevation": 0.0, "span": 180.0, "frame_width": 1.0, "lamp_power": 1.0, "hold": 0.0}
    return replace(options, **white, shape=voxels, n=None)


def prepare(path: str, options: Options) -> Prepared:
    """Read the pictures and plan the cube, for options that are settled; `InputError` for all that cannot be."""
    shape = arguments.voxels(options.n, options.shape, options.size_mm)
    check_memory(memory_needed(options.method, Grid(shape), (1, 1), 1, units=3))
    pictures = io.read_pictures(path, transfer=options.transfer)
    turned = None if options.angles is None else arguments.numbers(options.angles, "--angles")
    lamps = options.lamps
    planned = plan(
        pictures,
        max(shape),
        size_mm=options.size_mm,
        shape=None if options.shape is None else shape,
        frame_width=options.frame_width,
        angles=turned,
        span=options.span,
        elevation=options.elevation,
        fit_mode=options.fit,
        hold=options.hold if options.method == "display" else options.hold or 0.0,
        **lamps,
    )
    if options.shift:
        frames = shifted(planned.frames, spread_over_screen(planned.frames, planned.grid, options.shift))
        planned = replace(planned, frames=frames, prediction=predict(frames, planned.grid, hold=planned.hold, **lamps))
    order = None
    if options.order == "best" or len(pictures) <= _QUICK:
        order = best_order(planned.frames, planned.grid, **lamps)
    if options.order == "best" and order is not None:
        frames = order(planned.frames)
        planned = replace(planned, frames=frames, prediction=predict(frames, planned.grid, hold=planned.hold, **lamps))
    return Prepared(pictures, planned, order)


def job(prepared: Prepared, options: Options, *, memory: int | None = None, units: int | None = None) -> Job:
    """Settle all that decides the cube; `InputError` where it does not fit into `memory` bytes."""
    planned = prepared.plan
    provenance: dict[str, Any] = {"fit": options.fit, "predicted": said(planned.prediction)}
    if options.shift:
        provenance["shift"] = options.shift
    if options.order == "best" and prepared.order is not None:
        provenance["order"] = [int(picture) for picture in prepared.order.pictures]
    passes: dict[str, Any] = {"iterations": options.iterations}
    if options.iterations is None and options.method == "display":
        most, enough = backward.QUALITIES[options.quality or "normal"]
        passes = {"iterations": most, "enough_db": enough}
    made = backward.make_job(
        planned.frames,
        planned.grid,
        method=options.method,
        hold=planned.hold,
        units=units,
        memory=memory,
        provenance=provenance,
        **passes,
        **options.lamps,
    )
    needed = job_memory(made)
    if memory is not None and needed > memory:
        raise too_much(needed, memory)
    return made


def too_much(needed: int, memory: int) -> InputError:
    """The error of a job that needs more bytes than --memory allows."""
    return InputError(
        f"this needs {needed / 1e9:.3g} GB of memory at least, more than --memory {memory / 1e9:.3g}GB allows: "
        "allow more, or use a smaller cube, or fewer or smaller pictures"
    )


def divided(made: Job, output: str, workers: int, memory: int | None = None) -> Job:
    """A job in units for so many workers, or in as many as its unfinished cube was begun with, if they fit `memory`."""
    most = most_units(made.grid.shape, made.channels, level=made.level)
    begun = io.begun_units(output, made)
    if begun is None or (memory is not None and job_memory(replace(made, units=begun)) > memory):
        begun = max(made.units, min(workers, most))
    return replace(made, units=begun)


def needs(made: Job) -> dict[str, Any]:
    """What a job will need, for JSON: a smaller one is timed for it."""
    passes = expected_passes(made)
    seconds = None if passes is None else passes * seconds_a_pass(made)
    return {
        "memory": job_memory(made),
        "free_memory": io.free_memory(),
        "units": made.units,
        "unit_voxels": [part.columns * made.grid.shape[1] * made.grid.shape[2] for part in made.parts],
        "coarse_sizes": made.levels,
        "passes": passes,
        "seconds": seconds,
    }


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
        "predicted": said(planned.prediction),
        "shift": options.shift,
        "order": None
        if prepared.order is None
        else {
            "best": [int(picture) for picture in prepared.order.pictures],
            "gain_db": prepared.order.best_db - prepared.order.given_db,
        },
    }


def said(prediction: Prediction) -> dict[str, Any]:
    """A prediction for JSON."""
    each = [round(float(value), 2) for value in prediction.psnr]
    return {"psnr_mean": prediction.psnr_mean, "psnr_min": prediction.psnr_min, "views": each}


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
    most = min(16 * options.power, backward.LAMP_MOST)
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


def check_memory(needed: int) -> None:
    """Raise `InputError` where so many bytes are not free."""
    free = io.free_memory()
    if needed > free:
        raise InputError(
            f"this needs {needed / 1e9:.3g} GB of memory and {free / 1e9:.3g} GB are free: "
            "use a smaller cube, or fewer or smaller pictures"
        )
