"""How large pictures may be, how the cube follows them, how long each can stand: chosen by prediction."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal

from lightcube.backward.mat import Mat
from lightcube.backward.recipe import Recipe
from lightcube.errors import InputError
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.grid import Grid, check_tall, dense_step_deg
from lightcube.optics.rig import Rig
from lightcube.optics.stack import Stack
from lightcube.optics.stage import Stage
from lightcube.optics.views import swept_mm
from lightcube.pictures.arranging import spread_over_screen
from lightcube.pictures.fitting import Fit
from lightcube.pictures.fitting import fit as fitted
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.targets import Targets
from lightcube.pictures.turntable import Turntable
from lightcube.planning import films, glass
from lightcube.planning.feasibility import doubtful, impossible
from lightcube.planning.measured import is_measured, unmeasured, voxels_a_pixel
from lightcube.planning.prediction import Prediction
from lightcube.planning.reachable import sentences
from lightcube.planning.rehearsals import Rehearsals

if TYPE_CHECKING:
    from lightcube.planning.order import Order

#: Pictures are made as wide as so much is expected of them, dB; half as wide as the cube where this is.
PLANNED_DB, LEAST_DB, HALF = 40.0, 36.0, 0.5
#: Where so much is expected of pictures, dB, points weigh so much beside means: it costs 2 dB at most, where there is
#: a mat or a hold nothing, and the grain becomes a third less (measured).
SMOOTH_DB, GRAIN = 38.0, 0.01
#: What hold may cost, dB, of what lies below so much.
HOLD_COSTS_DB, BEST_SEEN_DB = 1.0, 45.0
#: Widths of the pictures, as parts of the cube's, that are tried.
WIDTHS = (0.25, 0.28, 0.32, 0.36, 0.4, 0.45, 0.5, 0.55, 0.6, 0.66, 0.72, 0.8, 0.9, 1.0)
#: PSNR falls by about so many dB as pictures become e times as wide, and within these bounds (measured).
_FALL, _FALLS = 36.0, (15.0, 80.0)
#: Steps of dense angles, on either side of a stop, that are tried as hold.
_HOLDS = (0.5, 1.0, 2.0, 4.0, 8.0)


Arrangement = Literal["given", "best"]


@dataclass(frozen=True, eq=False)
class Plan:
    """What `lightcube.solve` shall be given, and what comes of it.

    Parameters
    ----------
    pictures
        As they were read.
    targets, grid, recipe
        The pictures, fitted and where they shall stand, the cube, and how it is solved.
    fit
        What happened to pictures of another aspect, of all or of each.
    prediction
        What to expect; it is not known of all rooms (`lightcube.planning.measured`).
    shift
        By how many pixels at most pictures stand higher, lower or aside.
    order
        Which picture stands at which stop; None = as given.
    stage
        The description of the room, where there is one.
    """

    pictures: Pictures
    targets: Targets
    grid: Grid
    recipe: Recipe
    fit: Fit | tuple[Fit, ...]
    prediction: Prediction
    shift: int = 0
    order: Order | None = None
    stage: Stage | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        if self.order is not None:
            from lightcube.planning.order import Order  # here: the compiler comes with it

            if not isinstance(self.order, Order):
                raise InputError(
                    f"Plan takes an Order as order, not {self.order!r}: find one with lightcube.best_order"
                )

    def __repr__(self) -> str:
        return f"<plan of {self.targets!r} for {self.grid!r}: {self.prediction!r}>"

    @property
    def picture_width(self) -> float:
        """Width of the pictures as a part of the cube's."""
        rig = self.targets.rig
        return rig.picture_shape[1] * rig.views.pixel_in(self.grid)[1] / self.grid.shape[1]

    @cached_property
    def impossible(self) -> list[str]:
        """What cannot be in the room, a sentence each."""
        return [] if self.stage is None or isinstance(self.grid, Stack) else impossible(self.stage)

    @cached_property
    def doubtful(self) -> list[str]:
        """What is probably not meant in a room that is described, which pictures are out of reach, what is unknown."""
        unknown = unmeasured(self.targets.rig) if self.prediction.is_known else []
        unknown = [*glass.sentences(self.targets), *unknown]
        if self.stage is None:
            return unknown
        doubts = films.doubtful(self.stage) if isinstance(self.grid, Stack) else doubtful(self.stage)
        return [*doubts, *sentences(self.targets), *unknown]


@checked
def plan(
    pictures: Pictures,
    n: int = 128,
    recipe: Recipe | None = None,
    *,
    size_mm: float = 100.0,
    shape: tuple[int, int, int] | None = None,
    tall: float = 1.0,
    picture_width: float | None = None,
    turntable: Turntable | None = None,
    fit: Fit = "crop",
    longest_hold: bool = False,
    smooth: bool = False,
    shift: int = 0,
    order: Arrangement = "given",
    rehearsals: Rehearsals | None = None,
    told: bool = True,
) -> Plan:
    """Choose the width of the pictures, the shape of the cube and the hold by predicting how good the pictures become.

    Parameters
    ----------
    n
        Voxels along the longest side of the cube.
    recipe
        How it will be solved; None = ``Recipe.of_quality("normal", mat=Mat())``.
    size_mm
        Length of that side.
    shape
        ``(nz, ny, nx)`` instead; default the proportions of the first picture under a raised lamp, and as high as the
        pictures under a level one.
    tall
        Height of a slice in the width of a voxel; `n` counts widths.
    picture_width
        Width of the pictures as a fraction of the cube's; default the largest in `WIDTHS` with a predicted mean PSNR
        of at least 40 dB, or the smallest; but half of it where 36 dB are predicted for that.
    turntable
        Angles, lamp and screen, as far as they are said; None = ``Turntable()``.
    fit
        What happens to pictures of another aspect, as `lightcube.fit` takes it.
    longest_hold
        Hold pictures over a quarter of a degree for 64 voxels across, instead of as long as the recipe says: turned by
        less than one can turn by hand, a picture stands. By thin beams as long as is predicted to cost less than 1 dB
        (of what lies below 45 dB), at most half the way to the next stop.
    smooth
        Let the points of pixels weigh 0.01 beside their means where 38 dB are expected: from near by pictures are the
        calmer, at hardly any cost.
    shift
        Let pictures stand up to so many pixels higher, lower or aside, in turn.
    order
        ``"best"``: pictures change places so that they fight each other least (`lightcube.best_order`).
    rehearsals
        Who predicts, and remembers it; None = for this plan alone.
    told
        Whether to predict what comes of it even where nothing is left to choose.

    Raises
    ------
    InputError
        As `lightcube.fit` and `lightcube.solve`.

    Examples
    --------
    >>> import numpy as np, lightcube as lc
    >>> pictures = lc.Pictures([np.full((4, 6, 3), level) for level in (0.2, 0.8)], ("dark", "pale"))
    >>> plan = lc.plan(pictures, 12, picture_width=0.5, told=False)
    >>> plan.grid.shape, plan.targets
    ((8, 12, 12), <2 pictures wanted on <rig of 2 pictures of 4 x 6 pixels, 2 views>>)
    """
    if not pictures.images:
        raise InputError("there are no pictures: give at least two")
    if n < 1 or not 0 < (1 if picture_width is None else picture_width) < math.inf:
        raise InputError(
            f"a cube of {n} voxels with pictures {picture_width} of its width: give at least 1 voxel, and a width "
            "above 0 and at most 1.41"
        )
    check_tall(tall)
    asked, table = recipe or Recipe.of_quality("normal", mat=Mat()), turntable or Turntable()
    small, chooses = rehearsals or Rehearsals(), picture_width is None or longest_hold or smooth

    def as_wide(width: float) -> Plan:
        grid, rig = _cube_for(pictures, shape or n, (size_mm, tall), table, width)
        targets = fitted(pictures, rig, fit)
        glass.check_lit(targets, grid)
        recipe = replace(asked, hold_deg=least_hold_deg(rig, grid, asked)) if longest_hold else asked
        return Plan(pictures, targets, grid, recipe, fit, Prediction.unknown(len(targets)))

    def predicted(planned: Plan) -> Plan:
        return replace(planned, prediction=small.predict(planned.targets, planned.grid, planned.recipe))

    if picture_width is None:
        widths = WIDTHS if table.glass is None else _lit_widths(as_wide)
        best = _widest(lambda width: predicted(as_wide(width)), widths)
    else:
        best = predicted(as_wide(picture_width)) if chooses else as_wide(picture_width)
    best = held_longest(best, small) if longest_hold else best
    if shift:
        best = replace(best, targets=spread(best, best.targets, shift), shift=shift)
    if order == "best":
        found = small.best_order(best.targets, best.grid, best.recipe)
        best = replace(best, targets=found(best.targets), order=found)
    as_predicted = chooses and not (shift or best.order)
    best = predicted(best) if (chooses or told) and not as_predicted else best
    return _smoothed(best) if smooth else best


def plan_stage(
    stage: Stage,
    pictures: Pictures,
    ways: Fit | tuple[Fit, ...] = "crop",
    recipe: Recipe | None = None,
    *,
    smooth: bool = False,
    rehearsals: Rehearsals | None = None,
    told: bool = True,
) -> Plan:
    """The plan of a room that says all there is, so that nothing is chosen.

    Parameters
    ----------
    stage, pictures, ways
        As `lightcube.read_stage` gives them.
    recipe
        How it will be solved; None = ``Recipe()``.
    smooth, rehearsals, told
        As `plan` takes them.
    """
    asked, rig = recipe or Recipe(), stage.rig()
    if isinstance(stage.grid, Stack):
        asked = replace(asked, enough_db=math.inf, material=asked.material or stage.material)
    elif stage.material is not None and not asked.bounded_by.clear and asked.dyes is None:
        asked = asked.in_clear(stage.material.clear)
    targets = fitted(pictures, rig, ways)
    glass.check_lit(targets, stage.grid)
    made = Plan(pictures, targets, stage.grid, asked, ways, Prediction.unknown(len(targets)), stage=stage)
    if not (told or smooth) or made.impossible or not is_measured(rig, stage.grid):
        return made
    made = replace(made, prediction=(rehearsals or Rehearsals()).predict(targets, stage.grid, asked))
    return _smoothed(made) if smooth else made


def _smoothed(planned: Plan) -> Plan:
    """The plan with points that weigh a little beside their pixels' means, where its pictures can afford it."""
    if not planned.prediction.psnr_mean >= SMOOTH_DB:  # or it is not known
        return planned
    light = replace(planned.recipe.beams, grain=GRAIN)
    return replace(planned, recipe=replace(planned.recipe, light=light))


def _cube_for(
    pictures: Pictures,
    size: int | tuple[int, int, int],
    sides: tuple[float, float],
    turntable: Turntable,
    width: float,
) -> tuple[Grid, Rig]:
    """A cube of a shape, or of so many voxels, for pictures of a width, and the rig that shows them.

    `sides` are the cube's longest in mm, and how tall slices are.
    """
    size_mm, tall = sides
    rows, columns = pictures.images[0].shape[:2]
    level = turntable.elevation_of(pictures) == 0
    if isinstance(size, int):
        high, *across = proportions(size, columns / rows, width, level=level)
        voxels = max(1, round(high / tall)), across[0], across[1]
    else:
        voxels = size
    while True:
        grid = Grid(voxels, tall=tall)
        grid = replace(grid, voxel_mm=size_mm / grid.longest)
        rig = turntable.rig(pictures, grid, picture_width=width)
        if not isinstance(size, int) or not level or max(voxels[1:]) < size:
            return grid, rig
        high = min(turntable.pixel * rig.picture_shape[0], size)
        slices = max(1, round(high / tall))
        if slices == voxels[0]:
            return grid, rig
        voxels = (slices, *voxels[1:])  # no slices above and below the pictures


def spread(planned: Plan, targets: Targets, shift: int) -> Targets:
    """Targets in the plan's cube, standing up to so many pixels higher, lower or aside in turn."""
    return replace(targets, rig=targets.rig.shifted(spread_over_screen(targets, planned.grid, shift)))


def _lit_widths(as_wide: Callable[[float], Plan]) -> tuple[float, ...]:
    """Those of `WIDTHS` at which glass lights all of the pictures; the smallest is not asked."""
    found = list(WIDTHS[:1])
    for width in WIDTHS[1:]:
        try:
            as_wide(width)
        except InputError:
            break
        found.append(width)
    return tuple(found)


def _widest(predicted: Callable[[float], Plan], widths: tuple[float, ...] = WIDTHS) -> Plan:
    """Return the plan for the largest of the `widths` with good pictures, for half the width, or for the smallest one.

    What is tried next is where the last one's PSNR, and how it fell from the one before, lead to.
    """
    tried: dict[int, Plan] = {}
    at, fall = min(widths.index(HALF) if HALF in widths else len(widths), len(widths) - 1), _FALL
    good, poor = -1, len(widths)
    while good < at < poor:
        tried[at] = predicted(widths[at])
        spare = tried[at].prediction.psnr_mean - PLANNED_DB
        if widths[at] == HALF and LEAST_DB - PLANNED_DB <= spare < 0:
            return tried[at]
        good, poor = (at, poor) if spare >= 0 else (good, at)
        if min(good, len(widths) - 1 - poor) >= 0:
            fell = tried[good].prediction.psnr_mean - tried[poor].prediction.psnr_mean
            fall = min(max(fell / math.log(widths[poor] / widths[good]), _FALLS[0]), _FALLS[1])
        goal = widths[at] * math.exp(spare / fall)
        at = min(max(bisect_right(widths, goal) - 1, good + 1), poor - 1)
    return tried[max(good, 0)]


def proportions(n: int, aspect: float, picture_width: float, *, level: bool) -> tuple[int, int, int]:
    """``(nz, ny, nx)`` of a cube, `n` voxels along its longest side, for pictures of so much width / height.

    Under a raised lamp the cube has the pictures' proportions, so that the margin is the same all around them. Under
    a level one slices above and below the pictures would be of no use.
    """
    upright = aspect / picture_width if level else aspect
    wide, high = (n, n / upright) if upright >= 1 else (n * upright, n)
    return max(1, round(high)), max(1, round(wide)), max(1, round(wide))


def least_hold_deg(rig: Rig, grid: Grid, recipe: Recipe) -> float:
    """How long pictures are held at least where nothing is said: not at all by thin beams."""
    return 0.0 if recipe.beams.is_thin else min(dense_step_deg(grid) / 2, rig.widest_hold_deg)


def held_longest(without: Plan, small: Rehearsals) -> Plan:
    """Find the longest hold by thin beams that costs less than 1 dB of what is predicted for the plan `without`.

    Pictures that drown in each other are held at no cost; where light is averaged more than the least costs more.
    """
    if without.prediction.psnr_mean < PLANNED_DB or not without.recipe.beams.is_thin:
        return without
    step, most = dense_step_deg(without.grid), without.targets.rig.widest_hold_deg
    enough = min(without.prediction.psnr_mean, BEST_SEEN_DB) - HOLD_COSTS_DB
    best = without
    for steps in _HOLDS:
        hold_deg = steps * step
        if hold_deg > most:
            break
        if hold_deg <= without.recipe.hold_deg:
            continue
        recipe = replace(without.recipe, hold_deg=hold_deg)
        prediction = small.predict(without.targets, without.grid, recipe)
        if prediction.psnr_mean < enough:
            break
        best = replace(without, recipe=recipe, prediction=prediction)
    return best


def narrower(planned: Plan, width: float) -> Targets:
    """The targets of a plan as they would be at another width, at the same stops."""
    rig = planned.targets.rig
    disc_deg = float(rig.sums.disc_deg[0])
    said = Turntable(
        angles_deg=rig.stops.angle_deg,
        elevation_deg=rig.as_one_colour().elevation_deg,
        pixel=voxels_a_pixel(rig, planned.grid),
        lamp_deg=disc_deg,
        screen_mm=max(0.0, float(rig.behind_mm[0]) - swept_mm(planned.grid)) if disc_deg or rig.glass else None,
        glass=rig.glass,
    )
    narrow = said.rig(planned.pictures, planned.grid, picture_width=width)
    targets = fitted(planned.pictures, replace(narrow, lamps=rig.lamps, screens=rig.screens), planned.fit)
    if planned.shift:
        targets = spread(planned, targets, planned.shift)
    return targets if planned.order is None else planned.order(targets)
