"""What is said of plans, jobs and cubes, in sentences: what is well, what is wrong, what to do."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from lightcube.backward.recipe import recipe_of
from lightcube.backward.solution import Solution
from lightcube.jobs.publishing import Published
from lightcube.optics.grid import Grid
from lightcube.optics.light import MOST_GRAIN, Beams, Light
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.optics.tables import POWER_MOST
from lightcube.pictures.fitting import cut_off, fit_report, said_sizes
from lightcube.planning.consistency import advice, check
from lightcube.planning.measured import is_measured
from lightcube.planning.plan import Plan, narrower
from lightcube.planning.rehearsals import Rehearsals
from lightcube.scoring.metrics import FAIR_DB, grain_word, nearness
from lightcube.verbs import materials
from lightcube.wording import counted, in_ev

if TYPE_CHECKING:
    from lightcube.planning.order import Order

#: An order that gains so many dB is worth a word.
_WORTH_DB = 1.0
#: So many pictures are named; and so many characters of a name.
_NAMED, _LONGEST = 5, 40
#: A picture that loses more than this part of its area by cropping is named.
_MUCH = 1 / 3
#: What is said of grain.
_FROM_NEAR = {
    "smooth": "from close up too, the pictures are smooth",
    "fine": "from close up, the pictures look a little grainy, like fine film",
    "coarse": "from close up, the pictures look grainy, like coarse film: stand further back",
}
#: Films that are laid by hand lie so far off, mm. Off by so many cells, pictures are about as good as this, dB, solved
#: as if they lay right or for films that lie off (docs/films.md).
_BY_HAND_MM, _LAID, _LAID_DB = 0.2, 0.08, (31.0, 34.0)
#: So many times as much is tried against grain as a cube was made with, and so much where that was nothing.
_SMOOTHER, _LITTLE = 3, 0.01


def in_short(planned: Plan, order: "Order | None") -> list[str]:
    """Lines that `solve` says before it starts; `order` is the best one, if it was looked for."""
    hold_deg, rig = planned.recipe.hold_deg, planned.targets.rig
    held = f"; each picture stands for {hold_deg:.2g} degrees to either side of its stop" if hold_deg else ""
    return [
        _wanted(planned),
        *_cropped(planned),
        f"{block(planned.grid)}{held}",
        *_screen(planned),
        *expected(planned),
        *gain(planned, order),
        *([] if planned.recipe.dyes is None else materials.in_words(planned.recipe.dyes)),
        *materials.clearest(planned.recipe.bounded_by, planned.grid),
        *(f"doubtful: {sentence}" for sentence in planned.doubtful),
        *unsampled(rig, "thin" if planned.recipe.beams.is_thin else "area"),
    ]


def block(grid: Grid) -> str:
    """What is to be made, and how large it is."""
    if not isinstance(grid, Stack):
        return f"cube of {voxels(grid.shape)} voxels, {grid.size_mm[2]:.3g} mm wide"
    high, *sides = grid.size_mm
    across = " x ".join(f"{side:.4g}" for side in reversed(sides))
    return f"{counted(grid.shape[0], 'film')} of {across} mm in cells of {grid.voxel_mm:.3g} mm, {high:.3g} mm deep"


def voxels(shape: tuple[int, int, int]) -> str:
    """``(z, y, x)`` as people say it: across, in depth, upwards."""
    return " x ".join(str(count) for count in reversed(shape))


def _screen(planned: Plan) -> list[str]:
    """How far away the screen of a turntable stands, where that decides what it shows."""
    rig = planned.targets.rig
    if planned.stage is not None or (rig.glass is None and not np.any(rig.sums.disc_deg)):
        return []
    return [f"the screen stands {rig.behind_mm[0]:.0f} mm behind the axis"]


def _wanted(planned: Plan) -> str:
    """What happens to the pictures; in a room that is described, on how many screens they are, and so on."""
    if planned.stage is None:
        return fit_report(planned.pictures, planned.targets, planned.fit)
    rig = planned.targets.rig
    counts = {
        "picture": len(rig),
        "screen": len(rig.screens.names),
        "lamp": len(rig.lamps.names),
        "stop": 0 if isinstance(planned.grid, Stack) else len(planned.stage.stops_deg),
        "move": len({shot.move for shot in planned.stage.shots if shot.move is not None}),
    }
    return ", ".join(counted(count, name) for name, count in counts.items() if count)


def _cropped(planned: Plan) -> list[str]:
    """Which pictures lose much by cropping, the worst first, and what helps; nothing of a stage, which says its own."""
    if planned.stage is not None or planned.fit != "crop":
        return []
    parts = zip(cut_off(planned.pictures, planned.targets), planned.pictures.names, strict=True)
    much = [f"{part:.0%} of {_short(name)}" for part, name in sorted(parts) if part > _MUCH]
    if not much:
        return []
    helps = "look at it by lightcube check --sheet, move it by --focus X,Y, or keep all by --fit pad"
    return [f"doubtful: cropping cuts off {_worst(much)}: {helps}"]


def unsampled(rig: Rig, light: Beams) -> list[str]:
    """A sentence where lamps have a size that thin beams do not mind."""
    if light != "thin" or not np.any(rig.sums.disc_deg):
        return []
    names = dict.fromkeys(rig.lamps.names[lamp] for lamp in rig.sums.lamp[rig.sums.disc_deg > 0])
    return [f"thin beams do not mind the size of lamp {', '.join(map(repr, names))}: leave out --light thin"]


def expected(planned: Plan) -> list[str]:
    """What the pictures will be like, as far as it is known."""
    if isinstance(planned.grid, Stack):
        return [_laid(planned)]
    prediction, by = planned.prediction, " (by method display)" * (planned.recipe.method != "display")
    if prediction.is_known:
        return [f"{judged(planned.targets.names, prediction.psnr, 'will be', planned.targets.rig)}{by}"]
    told = planned.impossible or is_measured(planned.targets.rig, planned.grid)
    return [] if told else ["how good the pictures become was not measured in rooms like this"]


def _laid(planned: Plan) -> str:
    """What becomes of pictures when films are laid by hand: what counts is how far they lie off in cells (measured)."""
    off_mm, cell_mm = planned.recipe.assembly_mm or _BY_HAND_MM, planned.grid.voxel_mm
    decibels = _LAID_DB[planned.recipe.assembly_mm > 0] - 18 * math.log10(off_mm / cell_mm / _LAID)
    helps = "" if planned.recipe.assembly_mm else f"; --assembly-mm {off_mm:g} gains about 3 dB there"
    return f"with films {off_mm:g} mm off pictures will be {nearness(decibels)}, about {decibels:.0f} dB{helps}"


def judged(names: Sequence[str], psnr: Iterable[float], are: str, rig: Rig) -> str:
    """How near pictures come, in words, the nearest first, which of them are no good, and of how many pixels they are.

    The same words of a picture of few pixels and of one of many do not mean as much.
    """
    at = f", at {said_sizes([(int(rows), int(columns)) for rows, columns in rig.stops.window])}"
    kinds: dict[str, list[str]] = {}
    for decibels, name in sorted(zip(map(float, psnr), names, strict=True), key=lambda each: -each[0]):
        kinds.setdefault(nearness(decibels), []).append(name)
    label, one = "wrong" if "poor" in kinds else "well", "is" if are == "are" else are
    many = counted(len(names), "picture")
    if len(kinds) == 1:
        (kind,) = kinds
        return f"{label}: all {many} {are} {kind}{at}" if len(names) > 1 else f"{label}: it {one} {kind}{at}"
    said = [
        f"{len(those)} {are if len(those) > 1 else one} {kind}{_those(kind, those)}" for kind, those in kinds.items()
    ]
    return f"{label}: of {many} {', '.join(said[:-1])} and {said[-1]}{at}"


def _those(kind: str, names: Sequence[str]) -> str:
    """Which pictures are fair or poor, the worst first."""
    if kind not in ("fair", "poor"):
        return ""
    return f" ({_worst([_short(name) for name in names])})"


def _worst(said: Sequence[str]) -> str:
    """What is said of the worst, which are the last, the worst of all first, and how many more there are."""
    more = f" and {len(said) - _NAMED} more" if len(said) > _NAMED else ""
    return f"{', '.join(reversed(said[-_NAMED:]))}{more}"


def _short(name: str) -> str:
    return name[:_LONGEST]


def gain(planned: Plan, order: "Order | None") -> list[str]:
    """What another order would gain, or which one is used."""
    if order is None:
        return []
    if planned.order is not None:
        return [f"order: {', '.join(planned.targets.names)}"]
    better = order.best_db - order.given_db
    less = 1 - 10 ** (-better / 20)
    return (
        [f"better: in another order pictures come nearer, by {less:.0%} (--order best)"] if better >= _WORTH_DB else []
    )


def is_poor(planned: Plan) -> bool:
    """Whether poor pictures are expected."""
    return planned.prediction.is_known and planned.prediction.psnr_mean < FAIR_DB


def what_to_change(planned: Plan, remedies: Mapping[str, float]) -> list[str]:
    """Sentences on what is wrong with the pictures, and on what would help, by the PSNR that it brings.

    None of a stage: they name options that it leaves no room for. In glass pictures are not held against each other.
    """
    if planned.stage is not None:
        return []
    straight = planned.targets.rig.glass is None
    found = advice(check(planned.targets, planned.grid), crowded=is_poor(planned)) if straight else []
    return [*(f"wrong: {sentence}" for sentence in found), *_helps(remedies)]


def _helps(remedies: Mapping[str, float]) -> list[str]:
    """What makes pictures better than poor, the best first; several changes together where none is enough."""
    enough = [each for each in sorted(remedies.items(), key=lambda each: -each[1]) if each[1] >= FAIR_DB]
    if remedies and not enough:
        return [f"try: several of these together, one is not enough: {', '.join(remedies)}"]
    return [f"try: {change}, then they will be {nearness(decibels)}" for change, decibels in enough]


def remedies(planned: Plan, small: Rehearsals) -> dict[str, float]:
    """The PSNR that three changes would bring where poor pictures are expected on a turntable, dB, predicted."""
    if planned.stage is not None or not is_poor(planned):
        return {}
    rig, lamps = planned.targets.rig, planned.targets.rig.lamps
    power, now = float(lamps.most.max()), planned.picture_width
    changed = {}
    every_second = np.arange(0, len(planned.targets), 2)
    if len(every_second) > 1:
        changed[f"{len(every_second)} of the pictures"] = planned.targets.take(every_second)
    changed[f"--picture-width {0.7 * now:.2g}"] = narrower(planned, 0.7 * now)
    most = min(16 * power, POWER_MOST)
    if not lamps.are_fixed and most > power:
        stronger = replace(rig, lamps=replace(lamps, most=np.full(len(lamps.names), most)))
        changed[f"--lamp-max {most:g} ({in_ev(most)})"] = replace(planned.targets, rig=stronger)
    return {
        change: small.predict(targets, planned.grid, planned.recipe).psnr_mean for change, targets in changed.items()
    }


def needed(needs: dict[str, Any], *, verbose: bool = False) -> str:
    """What a job will need, in words; with how many passes and units if `verbose`."""
    memory = f"{needs['memory'] / 1e9:.2g} GB of memory ({needs['free_memory'] / 1e9:.2g} GB are free)"
    parts = f", in {counted(needs['units'], 'unit')}" if verbose or needs["units"] > 1 else ""
    if needs["seconds"] is None:
        return f"{memory}{parts}"
    passes = f", at most {counted(round(needs['passes']), 'pass')}" if verbose else ""
    return f"{memory}{parts}{passes}, about {duration(needs['seconds'])}"


def holds(made: Published) -> str:
    """How much of a published cube is finished, and what the rest is."""
    rest = "the rest is as far as it was solved, or what it would start from; solve --overwrite goes on with it"
    return f"{made.path} holds {made.done} of {counted(made.units, 'unit')}, {rest}"


def solved(solution: Solution) -> list[str]:
    """How good a cube is, how strong a lamp it takes, and what it looks like from near by."""
    cube, scores = solution.cube, solution.cube.scores
    lines = [judged(cube.names, (view["psnr"] for view in scores["pictures"]), "are", cube.rig)]
    power = float(cube.powers.max())
    if power != 1:
        lines.append(
            f"lamp: at most {power:.3g} times as strong as one that makes the bare wall white ({in_ev(power)})"
        )
    if isinstance(cube.grid, Stack):
        near = "from close up, pixels fall into coloured cells, whose light adds up further back"
        return [*lines, *materials.held(cube), near]
    return [*lines, *materials.held(cube), from_near(scores["grain_rms"], recipe_of(cube).beams)]


def from_near(grain_rms: float, light: Light) -> str:
    """What pictures look like from close up, by their grain, and what makes one that was solved for `light` calmer."""
    word = grain_word(grain_rms)
    said = _FROM_NEAR[word]
    if word != "coarse":
        return said
    if light.is_thin:
        return f"{said}, or solve by method display, without --light thin or --paper"
    grain = min(_SMOOTHER * light.grain or _LITTLE, MOST_GRAIN)
    return f"{said}, or try --grain {grain:g}, which costs some likeness" if grain > light.grain else said


def duration(seconds: float) -> str:
    """A time for people: "40 s", "12 min", "3.5 h"."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"
