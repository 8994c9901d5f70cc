"""How large pictures may be, how the cube follows them, how long each can stand: chosen by prediction."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from lightcube.errors import InputError
from lightcube.optics.grid import Grid, dense_step
from lightcube.optics.views import widest_hold
from lightcube.pictures.fitting import RAISED, Fit, fit
from lightcube.pictures.frames import Frames, Pictures
from lightcube.planning.prediction import Prediction, predict
from lightcube.scoring.metrics import GOOD_DB

if TYPE_CHECKING:
    from lightcube.planning.order import Order

#: What hold may cost, dB; above so much no eye sees a loss.
HOLD_COSTS_DB, BEST_SEEN_DB = 1.0, 45.0
#: Widths of the pictures, as parts of the cube's, that are tried.
WIDTHS = (0.25, 0.28, 0.32, 0.36, 0.4, 0.45, 0.5, 0.55, 0.6, 0.66, 0.72, 0.8, 0.9, 1.0)
#: Steps of dense angles, on either side of a stop, that are tried as hold.
_HOLDS = (0.5, 1.0, 2.0, 4.0, 8.0)


@dataclass(frozen=True, eq=False)
class Plan:
    """What `lightcube.solve` shall be given.

    Parameters
    ----------
    frames, grid
        The pictures, fitted, and the cube.
    hold
        Degrees on either side of its stop over which each picture shall stand.
    prediction
        What to expect.
    """

    frames: Frames
    grid: Grid
    hold: float
    prediction: Prediction


@dataclass(frozen=True, eq=False)
class Prepared:
    """Pictures, what is planned for them, and in which order they shall stand."""

    pictures: Pictures
    plan: Plan
    order: "Order | None"

    @property
    def frames(self) -> Frames:
        """As they are to be solved."""
        return self.plan.frames


def plan(
    pictures: Pictures,
    n: int = 128,
    *,
    size_mm: float = 100.0,
    shape: tuple[int, int, int] | None = None,
    frame_width: float | None = None,
    angles: ArrayLike | None = None,
    span: float | None = None,
    elevation: float | None = None,
    fit_mode: Fit = "crop",
    hold: float | None = 0.0,
    **lamp: Any,
) -> Plan:
    """Choose the width of the pictures, the shape of the cube and the hold by predicting how good the pictures become.

    Parameters
    ----------
    n
        Voxels along the longest side of the cube.
    size_mm
        Length of that side.
    shape
        ``(nz, ny, nx)`` instead; default the proportions of the first picture under a raised lamp, and as high as the
        pictures under a level one.
    frame_width
        Width of the pictures as a fraction of the cube's; default the largest in `WIDTHS` with a predicted mean PSNR
        of at least 40 dB, or the smallest.
    angles, span, elevation, fit_mode
        As `lightcube.fit` takes them.
    hold
        Degrees; None = as much as is predicted to cost less than 1 dB (of what lies below 45 dB), at most half the way
        to the next stop; none where less than 40 dB are predicted without.
    lamp
        ``lamp``, ``lamp_power``, ``lamp_max``, ``max_extinction`` as `lightcube.solve` takes them.

    Raises
    ------
    InputError
        As `lightcube.fit` and `lightcube.solve`.
    """
    if not pictures.images:
        raise InputError("there are no pictures: give at least two")
    if n < 1 or not 0 < (1 if frame_width is None else frame_width) < math.inf:
        raise InputError(
            f"a cube of {n} voxels with pictures {frame_width} of its width: give at least 1 voxel, and a width above "
            "0 and at most 1.41"
        )
    rows, columns = pictures.images[0].shape[:2]
    height = pictures.elevation if elevation is None else elevation
    level = (RAISED if height is None else height) == 0

    def at(width: float) -> tuple[Frames, Grid]:
        voxels = shape or proportions(n, columns / rows, width, level=level)
        while True:
            grid = Grid(voxels, size_mm / max(voxels))
            frames = fit(pictures, grid, angles=angles, span=span, elevation=elevation, frame_width=width, fit=fit_mode)
            high = frames.views.picture_shape[0]
            if shape is not None or not level or high == voxels[0] or max(voxels[1:]) < n:
                return frames, grid
            voxels = (high, *voxels[1:])  # no slices above and below the pictures

    def predicted(width: float) -> Plan:
        frames, grid = at(width)
        return Plan(frames, grid, hold or 0.0, predict(frames, grid, hold=hold or 0.0, **lamp))

    best = _widest(predicted) if frame_width is None else predicted(frame_width)
    return best if hold is not None else longest_hold(best, **lamp)


def _widest(predicted: Callable[[float], Plan]) -> Plan:
    """Return the plan for the largest of `WIDTHS` with good pictures, or for the smallest; by bisection."""
    best, first, last = None, 0, len(WIDTHS)
    while last - first > 1 or best is None:
        middle = (first + last) // 2
        candidate = predicted(WIDTHS[middle])
        if candidate.prediction.psnr_mean >= GOOD_DB or middle == 0:
            best, first = candidate, middle
        else:
            last = middle
    return best


def proportions(n: int, aspect: float, frame_width: float, *, level: bool) -> tuple[int, int, int]:
    """``(nz, ny, nx)`` of a cube, `n` voxels along its longest side, for pictures of so much width / height.

    Under a raised lamp the cube has the pictures' proportions, so that the margin is the same all around them. Under
    a level one slices above and below the pictures would be of no use.
    """
    upright = aspect / frame_width if level else aspect
    wide, high = (n, n / upright) if upright >= 1 else (n * upright, n)
    return max(1, round(high)), max(1, round(wide)), max(1, round(wide))


def longest_hold(without: Plan, **lamp: Any) -> Plan:
    """Find the longest hold that costs less than 1 dB of what is predicted for the plan `without`."""
    if without.prediction.psnr_mean < GOOD_DB:  # where pictures drown in each other hold costs nothing, and is worth it
        return without
    step, most = dense_step(without.grid), widest_hold(without.frames.views)
    enough = min(without.prediction.psnr_mean, BEST_SEEN_DB) - HOLD_COSTS_DB
    best = without
    for steps in _HOLDS:
        hold = steps * step
        if hold > most:
            break
        prediction = predict(without.frames, without.grid, hold=hold, **lamp)
        if prediction.psnr_mean < enough:
            break
        best = replace(without, hold=hold, prediction=prediction)
    return best
