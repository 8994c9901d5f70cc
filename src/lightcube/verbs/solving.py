"""What `check` and `solve` share: from the options of the command line to a plan, and what is said of it."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from lightcube import io
from lightcube.backward.job import Job
from lightcube.backward.needs import expected_passes, job_memory, memory_needed, seconds_a_pass
from lightcube.backward.solving import make_job
from lightcube.backward.units import most_units
from lightcube.errors import InputError
from lightcube.jobs.partial import begun_units
from lightcube.optics.grid import Grid
from lightcube.pictures.pictures import Pictures
from lightcube.planning.plan import Plan, plan
from lightcube.planning.prediction import as_json
from lightcube.solvers import find_method
from lightcube.verbs.options import Options

if TYPE_CHECKING:
    from lightcube.planning.order import Order

#: Orders of more pictures than this are looked for only when asked for: it takes too long.
_QUICK = 40


def settled(options: Options) -> Options:
    """Fill in the paper's own set-up; `InputError` where options contradict it or each other."""
    if options.paper:
        options = _as_in_the_paper(options)
    if max(options.lamp_samples, options.pixel_samples) > 1:
        raise InputError("--lamp-samples and --pixel-samples are for a stage: describe lamp and screen in a stage file")
    _ = options.lamp  # refuses what cannot be
    return options


def _as_in_the_paper(options: Options) -> Options:
    said = {
        "--picture-width": options.picture_width,
        "--angles-deg": options.angles_deg,
        "--span-deg": options.span_deg,
        "--elevation-deg": options.elevation_deg,
        "--powers": options.powers,
        "--lamp-power": options.lamp_power,
        "--lamp-max": options.lamp_max,
        "--hold-deg": options.hold_deg,
        "--shift": options.shift or None,
    }
    contradiction = [name for name, value in said.items() if value is not None]
    if contradiction:
        raise InputError(
            f"--paper says what {contradiction[0]} says too (lamp level and of power 1, half a turn, pictures as wide "
            "as the cube, no hold): leave out one of the two"
        )
    white: dict[str, Any] = {
        "elevation_deg": 0.0,
        "span_deg": 180.0,
        "picture_width": 1.0,
        "lamp_power": 1.0,
        "hold_deg": 0.0,
    }
    return replace(options, **white, shape=options.voxels, n=None)


def read(path: str, options: Options) -> Pictures:
    """Read the pictures, for options that are settled; `InputError` where they or the cube cannot be."""
    check_memory(memory_needed(find_method(options.method), Grid(options.voxels), (1, 1), 1, units=3))
    return io.read_pictures(path, transfer=options.transfer)


def prepare(pictures: Pictures, options: Options) -> Plan:
    """Plan the cube, for options that are settled; `InputError` for all that cannot be."""
    shape, recipe = options.voxels, options.recipe
    return plan(
        pictures,
        max(shape),
        recipe,
        size_mm=options.size_mm,
        shape=None if options.shape is None else shape,
        picture_width=options.picture_width,
        angles_deg=options.angles_deg,
        span_deg=options.span_deg,
        elevation_deg=options.elevation_deg,
        **options.lamp,
        fit=options.fit,
        longest_hold=options.hold_deg is None and recipe.solver.chooses_lamps,
        shift=options.shift,
        order=options.order,
    )


def another_order(planned: Plan) -> "Order | None":
    """The best order of a plan: its own, or one that is looked for where that does not take long."""
    if planned.order is not None or len(planned.pictures) > _QUICK:
        return planned.order
    from lightcube.planning.order import best_order  # here: the compiler comes with it

    return best_order(planned.targets, planned.grid, planned.recipe)


def job(planned: Plan, *, memory: int | None = None, units: int | None = None) -> Job:
    """Settle all that decides the cube; `InputError` where it does not fit into `memory` bytes."""
    provenance: dict[str, Any] = {"fit": planned.fit, "predicted": as_json(planned.prediction)}
    if planned.shift:
        provenance["shift"] = planned.shift
    if planned.order is not None:
        provenance["order"] = [int(picture) for picture in planned.order.pictures]
    made = make_job(planned.targets, planned.grid, planned.recipe, units=units, memory=memory, provenance=provenance)
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
