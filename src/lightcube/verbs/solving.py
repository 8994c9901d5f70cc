"""What `check` and `solve` share: from pictures or a stage, and options, to a plan and a job."""

import json
import platform
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import partial
from hashlib import sha256
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from lightcube import io
from lightcube.backward.job import Job
from lightcube.backward.mat import Mat
from lightcube.backward.needs import (
    MEMORY,
    Speed,
    expected_passes,
    job_memory,
    measured_speed,
    memory_needed,
    seconds_a_pass,
    with_room,
)
from lightcube.backward.solving import make_job
from lightcube.errors import InputError
from lightcube.events import Tell
from lightcube.jobs.partial import begun_units
from lightcube.optics.attenuator import Films, attenuator
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.stack import Stack
from lightcube.pictures.pictures import Pictures
from lightcube.planning.plan import Plan, plan, plan_stage
from lightcube.planning.prediction import as_json
from lightcube.planning.rehearsals import Rehearsals
from lightcube.verbs.options import Options

if TYPE_CHECKING:
    from lightcube.planning.order import Order

#: Orders of more pictures than this are looked for only when asked for: it takes too long.
_QUICK = 40


#: Options that a stage file leaves no room for.
_SAID_BY_STAGE = (
    *("n", "shape", "size_mm", "films", "gap_mm", "slices_tall", "picture_width", "pixel", "fit", "focus"),
    *("angles_deg", "span_deg", "elevation_deg", "paper", "order", "shift", "lamp_power", "lamp_max", "black"),
    *("lamp_deg", "screen_mm", "ior", "form", "bottom", "bath_mm", "veil"),
)


#: Plans a cube, which takes seconds where small cubes are asked that were not asked before.
Planning = Callable[[Rehearsals], Plan]


def rehearsals(tell: Tell | None = None) -> Rehearsals:
    """Small cubes that are asked once, by this command or an earlier one; `tell` hears of each that is."""
    return Rehearsals(io.Remembered(), tell)


def read(source: str, options: Options, *, told: bool = True) -> Planning:
    """Read a stage, or pictures for a turntable; what is returned plans the cube.

    Parameters
    ----------
    told
        Whether to predict what comes of it even where nothing is left to choose.

    Raises
    ------
    InputError
        For all that is said and cannot be; planning, too, for what is found only then.
    """
    films = options.stack
    if io.is_stage(source):
        planning = _read_stage(source, options)
    elif films is not None:
        planning = _read_films(source, options, films)
    else:
        planning = _read_pictures(source, options)
    return lambda small: planning(rehearsals=small, told=told)


def _read_stage(source: str, options: Options) -> Callable[..., Plan]:
    """Read a stage file, which says all there is."""
    refuse_beside_stage(source, options)
    recipe = options.recipe
    smooth = options.grain is None and not recipe.beams.is_thin
    stage, pictures, ways = io.read_stage(source, transfer=options.transfer)
    return partial(plan_stage, stage, pictures, ways, recipe, smooth=smooth)


def _read_films(source: str, options: Options, films: Films) -> Callable[..., Plan]:
    """Read pictures for a stack of films, each of which has a lamp of its own."""
    focus = options.middle
    pictures = io.read_pictures(source, transfer=options.transfer, **part(source, options))
    rows, columns = pictures.images[0].shape[:2]
    stage = attenuator(pictures.names, films, columns / rows)
    black, most = options.black, options.lamp_max
    stage = replace(
        stage,
        lamps=tuple(
            replace(lamp, power=options.lamp_power, power_max=lamp.power_max if most is None else most)
            for lamp in stage.lamps
        ),
        screens=tuple(replace(screen, black=screen.black if black is None else black) for screen in stage.screens),
    )
    return partial(plan_stage, stage, replace(pictures, focus=focus), options.fit, options.recipe)


def refuse_beside_stage(source: str, options: Options) -> None:
    """Raise `InputError` where something is said that a stage file says itself."""
    part(source, options)
    nothing = Options()
    for name in _SAID_BY_STAGE:
        if getattr(options, name) != getattr(nothing, name):
            option = name.replace("_", "-")
            raise InputError(f"--{option} is not for a stage, and {source} is one that says all there is: leave it out")


def _read_pictures(source: str, options: Options) -> Callable[..., Plan]:
    """Read pictures for a turntable."""
    return of_pictures(partial(io.read_pictures, source, transfer=options.transfer, **part(source, options)), options)


def of_pictures(read_pictures: Callable[[], Pictures], options: Options) -> Callable[..., Plan]:
    """Plan pictures, which become as wide and are held as long as is good for them where nothing else is said.

    They are read when options were found not to contradict each other.
    """
    options = options.as_in_the_paper() if options.paper else options
    shape, turntable, recipe = options.voxels, options.turntable, options.recipe
    if options.mat is None and recipe.solver.chooses_lamps and not recipe.beams.is_thin:
        recipe = replace(recipe, mat=Mat())
    check_memory(memory_needed(recipe.solver, Grid(shape), (1, 1), 1, units=3))
    focus = options.middle
    pictures = read_pictures()
    return partial(
        plan,
        replace(pictures, focus=focus),
        max(shape),
        recipe,
        size_mm=options.longest_mm,
        shape=options.shape,
        tall=float(options.slices_tall),
        picture_width=options.picture_width,
        turntable=turntable,
        fit=options.fit,
        longest_hold=options.hold_deg is None and recipe.solver.chooses_lamps,
        smooth=options.grain is None and not recipe.beams.is_thin,
        shift=options.shift,
        order=options.order,
    )


def part(source: str, options: Options) -> dict[str, Any]:
    """What of a film is taken; `InputError` where something of that is said of what is none."""
    if options.is_of_a_film and not io.is_film(source):
        raise InputError(
            f"--most, --every, --from and --to are for films and animations, not for {source}: leave them out"
        )
    return options.film if io.is_film(source) else {}


def another_order(planned: Plan, small: Rehearsals) -> "Order | None":
    """The best order of a plan: its own, or one that is looked for where that does not take long; none of a stage."""
    if planned.order is not None or planned.stage is not None or len(planned.pictures) > _QUICK:
        return planned.order
    return small.best_order(planned.targets, planned.grid, planned.recipe)


def job(
    planned: Plan,
    *,
    memory: int | None = None,
    units: int | None = None,
    start: Cube | None = None,
    film: Mapping[str, Any] | None = None,
) -> Job:
    """Settle all that decides the cube; `InputError` where it cannot be, or does not fit into `memory` bytes.

    `film` is what was taken of a film, where it was one: the cube remembers it.
    """
    if planned.impossible:
        raise InputError(f"on this stage {planned.impossible[0]}")
    made = make_job(
        planned.targets,
        planned.grid,
        planned.recipe,
        units=units,
        memory=memory,
        start=start,
        provenance=_origin(planned) | ({"film": dict(film)} if film else {}),
    )
    needed = job_memory(made)
    if memory is not None and needed > memory:
        raise InputError(
            f"this needs {needed / 1e9:.3g} GB of memory at least, more than --memory {memory / 1e9:.3g}GB allows: "
            "allow more, or use a smaller cube, or fewer or smaller pictures"
        )
    return made


def _origin(planned: Plan) -> dict[str, Any]:
    """What a cube remembers of its plan."""
    known: dict[str, Any] = {}
    if isinstance(planned.fit, str):  # of a stage's file each picture says its own
        known["fit"] = planned.fit
        if planned.pictures.focus != (0.5, 0.5):
            known["focus"] = list(planned.pictures.focus)
    if planned.prediction.is_known:
        known["predicted"] = as_json(planned.prediction)
    if planned.shift:
        known["shift"] = planned.shift
    if planned.order is not None:
        known["order"] = [int(picture) for picture in planned.order.pictures]
    return known


def divided(made: Job, output: str, workers: int, memory: int | None = None) -> Job:
    """A job in units for so many workers, or in as many as its unfinished cube was begun with, if they fit `memory`."""
    most = made.most_units
    begun = begun_units(output, made)
    if begun is None or (memory is not None and job_memory(replace(made, units=begun, room=0)) > memory):
        begun = max(made.units, min(workers, most))
    return with_room(replace(made, units=begun), memory or MEMORY)


def fitted(made: Job, processes: int = 1) -> Job:
    """A job that keeps pieces of rays only where so many processes find room for them in half of what memory is free.

    `InputError` where there is not even as much as all else needs.
    """
    check_memory(job_memory(replace(made, room=0)) * processes)
    return replace(made, room=min(made.room, with_room(made, io.free_memory() // (2 * processes)).room))


def needs(made: Job) -> dict[str, Any]:
    """What a job will need, for JSON: a smaller one is timed for it, unless one like it was timed here before."""
    work = expected_passes(made)
    seconds = None if work is None else work * seconds_a_pass(made, _speed(made))
    return {
        "memory": job_memory(made),
        "free_memory": io.free_memory(),
        "units": made.units,
        "unit_voxels": [part.columns * made.grid.shape[1] * made.grid.shape[2] for part in made.parts],
        "coarse_sizes": made.levels,
        "passes": None if work is None else made.recipe.passes or made.recipe.solver.passes,
        "seconds": seconds,
    }


def _speed(made: Job) -> Speed:
    """How fast jobs like this one are on this machine, with so many threads, as they were when it was last measured."""
    from lightcube.kernels.tasks import threads  # here: the compiler comes with it

    kind = made.recipe.method if isinstance(made.recipe.method, str) else ""
    asked = [
        version("lightcube"),
        platform.node(),
        threads(),
        kind,
        made.recipe.dtype,
        made.level,
        made.channels,
        made.kinds,
        isinstance(made.grid, Stack),
    ]
    known, name = io.Remembered(), sha256(json.dumps(["speed", *asked]).encode()).hexdigest()
    if kind and name in known:
        with suppress(TypeError, ValueError):
            products, rest = known[name]
            return Speed(float(products), float(rest))
    speed = measured_speed(made)
    if kind:
        known[name] = speed
    return speed


def check_memory(needed: int) -> None:
    """Raise `InputError` where so many bytes are not free."""
    free = io.free_memory()
    if needed > free:
        raise InputError(
            f"this needs {needed / 1e9:.3g} GB of memory and {free / 1e9:.3g} GB are free: "
            "use a smaller cube, or fewer or smaller pictures"
        )
