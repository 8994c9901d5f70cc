"""The mat: a calm surround that frames each picture on the wall, where else there would be coloured chaos.

Nothing outside a picture would be asked for, and whatever suits the pictures best would stand there. A mat asks for one
tone around them, with a small weight: it is a coarse thing, and costs few of the pictures' decibels (docs/light.md).
Beyond its width the same tone is asked for as far as the shadow reaches, with a much smaller weight: so all of the
glass is calm and dark, and not only what is next to the picture.

What lies beyond is asked for in windows of the size of a picture with its mat, which stand beside it on the screen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Counts, Images, locked
from lightcube.optics.checks import check_fields
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.rig import Rig
from lightcube.optics.transfer import decode
from lightcube.pictures.targets import Targets
from lightcube.projection.projector import Projector

#: Display values of the tones that have names.
TONES = {"dark": 0.02, "grey": 0.25, "light": 0.5}
#: A beam that runs through less of the cube than this part of its width cannot be made dark: nothing is asked of it.
_THROUGH = 0.25
#: Pixels of a mat next to a picture that are not judged.
_SEAM = 1


@dataclass(frozen=True)
class Mat:
    """What surrounds each picture.

    Parameters
    ----------
    tone
        Its display value, 0 to 1.
    weight
        How much a pixel of it counts beside one of the pictures, above 0 and at most 1.
    width
        On each side, as a part of the picture's longer side; at most to the end of the shadow.
    beyond
        How much a pixel of the shadow beyond that counts, at least 0 and at most 1; 0 = whatever suits the pictures.
    """

    tone: float = TONES["dark"]
    weight: float = 0.05
    width: float = 0.375
    beyond: float = 0.001

    def __post_init__(self) -> None:
        check_fields(self)
        fine = 0 <= self.tone <= 1 and 0 < self.weight <= 1 and 0 < self.width < np.inf and 0 <= self.beyond <= 1
        if not fine:
            raise InputError(
                f"a mat has a tone from 0 to 1, a weight above 0 and at most 1, a width above 0, and a weight from 0 "
                f"to 1 beyond, not {self.tone:g}, {self.weight:g}, {self.width:g} and {self.beyond:g}"
            )


def margin(rig: Rig, grid: Grid, mat: Mat | None) -> tuple[int, int]:
    """How many rows and columns of pixels a mat has on each side; none on screens with edges, which pictures fill."""
    if mat is None or not _is_endless(rig):
        return 0, 0
    steepest = float(np.max(np.abs(rig.views.elevations_deg)))
    wanted = round(mat.width * max(rig.picture_shape))
    raster = raster_shape(grid, steepest, rig.views.pixel_in(grid))
    most = [whole - own for whole, own in zip(raster, rig.picture_shape, strict=True)]
    rows, columns = (max(0, min(wanted, each // 2)) for each in most)
    return rows, columns


def widened(rig: Rig, grid: Grid, mat: Mat | None) -> Rig:
    """The same pictures with their mats around them."""
    rows, columns = margin(rig, grid, mat)
    if rows == columns == 0:
        return rig
    shape = rig.picture_shape[0] + 2 * rows, rig.picture_shape[1] + 2 * columns
    stops = replace(rig.stops, window=np.tile(shape, (len(rig), 1)))
    return replace(rig, views=rig.views.with_pixels(1.0, shape), stops=stops)


def inner(rig: Rig, grid: Grid, mat: Mat | None) -> tuple[slice, slice]:
    """Rows and columns of the `widened` rig that are the pictures'."""
    return tuple(  # type: ignore[return-value]
        slice(each, each + size) for each, size in zip(margin(rig, grid, mat), rig.picture_shape, strict=True)
    )


def framed(targets: Targets, grid: Grid, mat: Mat | None) -> Targets:
    """The same targets with their mats around them, as wanted; no weight where a mat cannot be made."""
    rows, columns = margin(targets.rig, grid, mat)
    if mat is None or rows == columns == 0:
        return targets
    rig = widened(targets.rig, grid, mat)
    around = (0, 0), (rows, rows), (columns, columns)
    tone = decode(np.array(mat.tone, np.float32), targets.transfer)
    pictures = np.pad(targets.pictures, (*around, (0, 0)), constant_values=tone)
    weights = mat.weight * _can_be_dark(rig, grid)
    weights[:, rows : rows + targets.rig.picture_shape[0], columns : columns + targets.rig.picture_shape[1]] = (
        targets.weight
    )
    return replace(targets, pictures=locked(pictures), rig=rig, weights=locked(weights))


def places_beyond(rig: Rig, grid: Grid, mat: Mat | None) -> Counts:
    """``(count, 2)``: so far right and down, in pixels, stand windows that cover the rest of the shadow.

    They are as large as the `widened` pictures, and may share pixels with them.
    """
    if mat is None or not mat.beyond or not _is_endless(rig):
        return np.empty((0, 2), np.intp)
    sizes = widened(rig, grid, mat).picture_shape
    down, across = (
        (own - whole) // 2 + own * np.arange(-(-whole // own))
        for whole, own in zip(rig.whole(grid).picture_shape, sizes, strict=True)
    )
    every = np.stack([each.ravel() for each in np.meshgrid(across, down)], axis=1)
    return every[np.any(every != 0, axis=1)]


def weights_beyond(rig: Rig, grid: Grid, mat: Mat, place: Sequence[int]) -> Images:
    """``(picture, row, column)``: how much each pixel of the windows at one of the `places_beyond` counts."""
    wide = widened(rig, grid, mat)
    weights = mat.beyond * _can_be_dark(wide.shifted(np.tile(place, (len(rig), 1))), grid)
    right, down = place
    rows, columns = wide.picture_shape
    weights[:, max(-down, 0) : max(rows - down, 0), max(-right, 0) : max(columns - right, 0)] = 0
    return weights


def judged_beyond(rig: Rig, grid: Grid, mat: Mat) -> Images:
    """``(picture, row, column)`` of the `Rig.whole` one: 1 where the shadow beyond the mats can be dark."""
    whole = rig.whole(grid)
    chosen = _can_be_dark(whole, grid)
    rows, columns = widened(rig, grid, mat).picture_shape
    for own, (top, left) in zip(chosen, rig.places_in(whole) - margin(rig, grid, mat), strict=True):
        own[max(top, 0) : top + rows, max(left, 0) : left + columns] = 0
    return chosen


def judged_pixels(rig: Rig, grid: Grid, mat: Mat) -> Images:
    """``(picture, row, column)`` of the `widened` rig: 1 where the mat is judged, which is not next to the picture."""
    rows, columns = margin(rig, grid, mat)
    high, wide = rig.picture_shape
    chosen = _can_be_dark(widened(rig, grid, mat), grid)
    down, across = max(rows - _SEAM, 0), max(columns - _SEAM, 0)
    chosen[:, down : rows + high + _SEAM, across : columns + wide + _SEAM] = 0
    return chosen


def _is_endless(rig: Rig) -> bool:
    """Whether no screen of the pictures has edges."""
    return bool(np.all(rig.screens.endless[rig.stops.screen]))


def _can_be_dark(rig: Rig, grid: Grid) -> Images:
    """``(picture, row, column)``: 1 where enough of the cube lies in the way of each view's beam, else 0."""
    through = Projector(grid, rig)(np.ones(grid.shape, np.float32)) > _THROUGH * min(grid.shape[1:]) * grid.voxel_mm
    first = rig.starts[:-1]
    return np.asarray(np.minimum.reduceat(through, first, axis=0), np.float32)
