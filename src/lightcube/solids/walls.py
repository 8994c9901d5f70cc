"""Three walls: a picture from the front, one from the right, one from above, each cast by a lamp of its own."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.checks import checked
from lightcube.optics.grid import Grid
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.solids.cutting import Cut

#: The pictures of three walls, in their order.
FRONT, SIDE, TOP = WALLS = ("front", "side", "top")
#: From the block to its walls, in its longest sides.
_AWAY = 0.5


@checked
def walls(grid: Grid) -> Stage:
    """A stage of three lamps and three screens as large as the block's faces, a pixel for each row of voxels.

    The front's picture is seen along y, x to the right; the side's from the right, along -x, y to the right; the top's
    from above, x to the right and y up. So a shadow is seen as its lamp sees the object.
    """
    depth, wide, high = grid.size_mm[1], grid.size_mm[2], grid.size_mm[0]
    if grid.tall != 1:
        raise InputError(f"three walls take voxels that are cubes, not {grid.tall:g} times as tall: leave that out")
    away = _AWAY * max(grid.size_mm)
    pitch = grid.voxel_mm
    return Stage(
        grid,
        (
            Lamp(FRONT, direction=(0.0, 1.0, 0.0)),
            Lamp(SIDE, direction=(-1.0, 0.0, 0.0)),
            Lamp(TOP, direction=(0.0, 0.0, -1.0)),
        ),
        (
            Screen(FRONT, (0.0, depth / 2 + away, 0.0), (wide, high), pitch, normal=(0.0, -1.0, 0.0)),
            Screen(SIDE, (-wide / 2 - away, 0.0, 0.0), (depth, high), pitch, normal=(1.0, 0.0, 0.0)),
            Screen(TOP, (0.0, 0.0, -high / 2 - away), (wide, depth), pitch, normal=(0.0, 0.0, 1.0), up=(0.0, 1.0, 0.0)),
        ),
        tuple(Shot(name, name, (name,)) for name in WALLS),
        cube_turns=False,
    )


def block(cuts: Sequence[Cut], n: int, size_mm: float) -> tuple[Grid, float]:
    """The block of `n` voxels along its longest side whose faces three shapes fill, and how much one is stretched most.

    Three aspects say the block's two: each picture is stretched by the same factor, the least that makes them agree.
    """
    if len(cuts) != 3:
        raise InputError(
            f"three walls take three pictures, front, side and top, not {len(cuts)}: give three, or leave out --walls"
        )
    front, side, top = (
        math.log(one.inside.shape[1] / one.inside.shape[0]) for one in (each.trimmed() for each in cuts)
    )
    apart = top - front + side
    wide, deep = front + apart / 3, side - apart / 3  # in heights
    sides = np.exp([0.0, deep, wide])
    shape = [max(1, round(n * float(side) / float(sides.max()))) for side in sides]
    return Grid((shape[0], shape[1], shape[2]), size_mm / n), math.exp(abs(apart) / 3) - 1
