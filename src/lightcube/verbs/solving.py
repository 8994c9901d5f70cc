"""What `check` and `solve` share: from the options of the command line to a plan, and what is said of it."""

from dataclasses import replace
from typing import Any

from lightcube import io
from lightcube.backward import recipe, solving
from lightcube.backward.job import Job
from lightcube.backward.needs import expected_passes, job_memory, memory_needed, seconds_a_pass
from lightcube.backward.units import most_units
from lightcube.errors import InputError
from lightcube.jobs.partial import begun_units
from lightcube.optics.grid import Grid
from lightcube.pictures.arranging import shifted, spread_over_screen
from lightcube.planning.order import best_order
from lightcube.planning.plan import Prepared, plan
from lightcube.planning.prediction import as_json, predict
from lightcube.solvers import find_method
from lightcube.verbs.options import Options

#: Orders of more pictures than this are looked for only when asked for: it takes too long.
_QUICK = 40


def settled(options: Options) -> Options:
    """Fill in the lamp's kind and the paper's own set-up; `InputError` where others contradict them."""
    check_passes(options)
    if options.paper:
        options = _as_in_the_paper(options)
    if max(options.lamp_samples, options.pixel_samples) > 1:
        raise InputError("--lamp-samples and --pixel-samples are for a stage: describe lamp and screen in a stage file")
    kind = recipe.check_options(options.method, **options.lamps, iterations=options.iterations)
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
    white: dict[str, Any] = {"elevation": 0.0, "span": 180.0, "frame_width": 1.0, "lamp_power": 1.0, "hold": 0.0}
    return replace(options, **white, shape=options.voxels, n=None)


def prepare(path: str, options: Options) -> Prepared:
    """Read the pictures and plan the cube, for options that are settled; `InputError` for all that cannot be."""
    shape = options.voxels
    check_memory(memory_needed(find_method(options.method), Grid(shape), (1, 1), 1, units=3))
    pictures = io.read_pictures(path, transfer=options.transfer)
    lamps = options.lamps
    planned = plan(
        pictures,
        max(shape),
        size_mm=options.size_mm,
        shape=None if options.shape is None else shape,
        frame_width=options.frame_width,
        angles=options.angles,
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
    provenance: dict[str, Any] = {"fit": options.fit, "predicted": as_json(planned.prediction)}
    if options.shift:
        provenance["shift"] = options.shift
    if options.order == "best" and prepared.order is not None:
        provenance["order"] = [int(picture) for picture in prepared.order.pictures]
    passes: dict[str, Any] = {"iterations": options.iterations}
    if options.iterations is None and options.method == "display":
        most, enough = recipe.QUALITIES[options.quality or "normal"]
        passes = {"iterations": most, "enough_db": enough}
    made = solving.make_job(
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
    begun = begun_units(output, made)
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


def check_memory(needed: int) -> None:
    """Raise `InputError` where so many bytes are not free."""
    free = io.free_memory()
    if needed > free:
        raise InputError(
            f"this needs {needed / 1e9:.3g} GB of memory and {free / 1e9:.3g} GB are free: "
            "use a smaller cube, or fewer or smaller pictures"
        )
