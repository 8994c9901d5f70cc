"""The mat: a calm surround that frames each picture on the wall, where else there would be coloured chaos.

Nothing outside a picture would be asked for, and whatever suits the pictures best would stand there. A mat asks for one
tone around them, with a small weight: it is a coarse thing, and costs few of the pictures' decibels (docs/light.md).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Images, locked
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
    """

    tone: float = TONES["dark"]
    weight: float = 0.05
    width: float = 0.375

    def __post_init__(self) -> None:
        check_fields(self)
        if not (0 <= self.tone <= 1 and 0 < self.weight <= 1 and 0 < self.width < np.inf):
            raise InputError(
                f"a mat has a tone from 0 to 1, a weight above 0 and at most 1, and a width above 0, not "
                f"{self.tone:g}, {self.weight:g} and {self.width:g}"
            )


def margin(rig: Rig, grid: Grid, mat: Mat | None) -> tuple[int, int]:
    """How many rows and columns of pixels a mat has on each side; none on screens with edges, which pictures fill."""
    if mat is None or not np.all(rig.screens.endless[rig.stops.screen]):
        return 0, 0
    steepest = float(np.max(np.abs(rig.views.elevations_deg)))
    wanted = round(mat.width * max(rig.picture_shape))
    most = [whole - own for whole, own in zip(raster_shape(grid, steepest), rig.picture_shape, strict=True)]
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


def judged_pixels(rig: Rig, grid: Grid, mat: Mat) -> Images:
    """``(picture, row, column)`` of the `widened` rig: 1 where the mat is judged, which is not next to the picture."""
    rows, columns = margin(rig, grid, mat)
    high, wide = rig.picture_shape
    chosen = _can_be_dark(widened(rig, grid, mat), grid)
    down, across = max(rows - _SEAM, 0), max(columns - _SEAM, 0)
    chosen[:, down : rows + high + _SEAM, across : columns + wide + _SEAM] = 0
    return chosen


def _can_be_dark(rig: Rig, grid: Grid) -> Images:
    """``(picture, row, column)``: 1 where enough of the cube lies in the way of each view's beam, else 0."""
    through = Projector(grid, rig)(np.ones(grid.shape, np.float32)) > _THROUGH * min(grid.shape[1:]) * grid.voxel_mm
    first = rig.starts[:-1]
    return np.asarray(np.minimum.reduceat(through, first, axis=0), np.float32)
