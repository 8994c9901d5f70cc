"""What one sees between the pictures, and what a set-up that is not perfect makes of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from lightcube.errors import InputError
from lightcube.forward.casting import cast
from lightcube.forward.turning import powers_of
from lightcube.optics.arrays import Counts, Reals, keep
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.cube import Cube
from lightcube.optics.transfer import encode
from lightcube.pictures.targets import Targets
from lightcube.scoring.metrics import check_same_views, psnr, ssim

#: A picture stands as long as its PSNR is at least this, dB.
LOBE_DB = 30.0
#: The ends of a lobe are enclosed by two samples so near to each other, degrees.
_RESOLUTION = 0.05


@dataclass(frozen=True, eq=False)
class Curve:
    """How well the nearer picture is seen as the cube turns, over one period.

    The samples ascend in angle from half a spacing before the first stop. Where two cells meet there is one
    sample against each of the two pictures.

    Parameters
    ----------
    angles_deg
        Turntable angle of each sample, degrees.
    nearest
        Index of the view whose stop is nearest.
    offsets_deg
        Degrees from that stop; 0 at the stops themselves.
    psnr, ssim
        What is cast there against the picture of that view.
    lobes_deg
        ``(views,)`` degrees around each view's stop over which the PSNR stays at 30 dB or more, at most as far
        as to halfway between the stop and its neighbours; 0 where the stop itself is below.
    period_deg
        Degrees after which the curve repeats.
    """

    angles_deg: Reals
    nearest: Counts
    offsets_deg: Reals
    psnr: Reals
    ssim: Reals
    lobes_deg: Reals
    period_deg: float

    def __post_init__(self) -> None:
        check_fields(self)
        reals = ("angles_deg", "offsets_deg", "psnr", "ssim", "lobes_deg")
        keep(self, nearest=np.intp, **dict.fromkeys(reals, np.float64))


@checked
def curve(cube: Cube, targets: Targets, steps: int = 8, *, callback: Callable[[int, int], None] | None = None) -> Curve:
    """Compare what is cast at, around and between the stops with the nearer of the two pictures.

    Parameters
    ----------
    targets
        The wanted pictures in the cube's views.
    steps
        Parts that each gap between neighbouring stops is divided into. Near the stops, and where a picture
        falls below 30 dB, samples lie closer, down to 0.05 degrees.
    callback
        Called with how many samples are done, and how many there are as far as is known.

    Raises
    ------
    InputError
        Where the targets do not fit the cube's pictures.

    Notes
    -----
    Lamps' powers between the stops are those of `lightcube.forward.turning.powers_of`. Where half a turn shows the
    mirror image the curve has a period of 180 degrees and the last stop's neighbour is the mirrored first one, unless
    two stops are half a turn apart. Several screens each have their own stops.
    """
    if steps < 1:
        raise InputError(f"a curve needs at least 1 step from one picture to the next, not {steps}")
    check_same_views(cube, targets)
    period = cube.rig.period_deg
    places = cube.angles_deg % period
    reach = _reach(places, period, cube.rig.stops.screen)
    samples = [(view, offset) for view in range(len(targets)) for offset in _offsets(reach[:, view], steps)]
    found = np.empty((0, 4))
    while samples:
        rows = []
        for row in _compared(cube, targets, *np.array(samples).T):
            rows.append(row)
            if callback is not None:
                callback(len(found) + len(rows), len(found) + len(samples))
        found = np.concatenate([found, rows])
        ends = [(view, side, *_end(found, view, side)) for view in range(len(targets)) for side in (-1, 1)]
        samples = [
            (view, side * (inside + outside) / 2)
            for view, side, _, inside, outside in ends
            if outside - inside > _RESOLUTION
        ]
    lobes = np.zeros(len(targets))
    for view, _, width, _, _ in ends:
        lobes[view] += width
    nearest = found[:, 0].astype(np.intp)
    order = np.lexsort((found[:, 1], places[nearest]))
    nearest, (offsets, quality, likeness) = nearest[order], found[order, 1:].T
    return Curve(places[nearest] + offsets, nearest, offsets, quality, likeness, lobes, period)


def _reach(places: Reals, period: float, screens: Counts) -> Reals:
    """``(2, pictures)``: degrees from each stop to halfway to the one before and to the one after it on its screen."""
    reach = np.empty((2, len(places)))
    for screen in np.unique(screens):
        own = np.flatnonzero(screens == screen)
        own = own[np.argsort(places[own], kind="stable")]
        gaps = np.diff(places[own], append=places[own[0]] + period)
        reach[:, own] = np.roll(gaps, 1) / 2, gaps / 2
    return reach


def _offsets(reach: Reals, steps: int) -> Reals:
    """Where a stop's cell is sampled, degrees from the stop: evenly, and by doubling distances near the stop."""
    sides = []
    for half in reach:
        even = np.append(np.arange(1, (steps + 1) // 2) * (2 * half / steps), half)
        doubling = _RESOLUTION * 2.0 ** np.arange(20)
        sides.append(np.append(doubling[doubling < even[0]], even))
    return np.concatenate([-sides[0], [0.0], sides[1]])


def _compared(cube: Cube, targets: Targets, view: Reals, offset: Reals) -> Iterator[tuple[float, float, float, float]]:
    """View, offset in degrees, PSNR and SSIM of what is cast there against that view's picture, sample by sample."""
    index = view.astype(np.intp)
    wanted = encode(targets.pictures, targets.transfer)
    now = cube.rig.take(index).turned(offset)
    shown = cast(cube, now, powers_of(cube, now))
    for place, degrees, picture in zip(index, offset, shown, strict=True):
        pair = encode(picture, targets.transfer), wanted[place], targets.weight[place]
        yield float(place), float(degrees), psnr(*pair), ssim(*pair)


def _end(found: Reals, view: int, side: int) -> tuple[float, float, float]:
    """Width of one side of a view's lobe, and the two distances from the stop that enclose its end (degrees)."""
    rows = found[(found[:, 0] == view) & (found[:, 1] * side >= 0)]
    distance, quality = rows[np.argsort(np.abs(rows[:, 1]))][:, 1:3].T
    distance = np.abs(distance)
    below = np.flatnonzero(quality < LOBE_DB)
    if not below.size or below[0] == 0:
        end = 0.0 if below.size else float(distance[-1])
        return end, end, end
    inside, outside = below[0] - 1, below[0]
    part = (quality[inside] - LOBE_DB) / (quality[inside] - quality[outside])
    width = distance[inside] + part * (distance[outside] - distance[inside])
    return float(width), float(distance[inside]), float(distance[outside])
