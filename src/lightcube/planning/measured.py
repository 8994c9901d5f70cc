"""What was measured, and on what: planning knows rooms with one parallel lamp and a screen behind the cube.

In other rooms a rehearsal on a small cube is no guide: told as `lightcube.planning.prediction` does, the mean PSNR of
rooms with a point lamp, or lamps of several elevations, came out 2 to 10 dB too low (21 rooms of benchmarks/stages.py).
Pixels of several voxels are rehearsed as such: three cubes with pixels of 2 x 2 came out 0.4 dB worse, and 1.6 and
1.9 dB better, than was told (benchmarks/light.py pixel). Glass and veils are rehearsed as well: 24 cubes in a block, a
cylinder, a sphere and a bath of glass came out from 1.5 dB worse to 4.4 better than told, 12 under a veil of a
thousandth or a hundredth of the light from 1.7 worse to 1.5 better (benchmarks/glass.py foretold).
"""

from dataclasses import replace

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig


def is_measured(rig: Rig, grid: Grid) -> bool:
    """Whether one parallel lamp, raised alike for all pictures, shines on a screen behind, its pixels whole voxels."""
    one = rig.as_one_colour()
    straight = replace(one, glass=None, fading=replace(one.fading, veil=np.zeros(len(one.views))))
    return straight.is_thin and one.elevation_deg is not None and voxels_a_pixel(rig, grid) > 0


def voxels_a_pixel(rig: Rig, grid: Grid) -> int:
    """How many voxels all pixels are wide and high, to a millionth; 0 where that is not one whole number."""
    steps = rig.views.column_steps_mm, rig.views.row_steps_mm
    sides = np.concatenate([np.linalg.norm(each, axis=1) for each in steps]) / grid.voxel_mm
    pixel = round(float(sides[0]))
    return pixel if np.allclose(sides, pixel, rtol=1e-6, atol=0) else 0


def unmeasured(rig: Rig) -> list[str]:
    """A sentence where a lamp has a size: rehearsals mind it, but their law was fitted without."""
    if not np.any(rig.sums.disc_deg):
        return []
    return ["how much a lamp's size costs was not measured: pictures may become worse than expected"]


def raised(rig: Rig, grid: Grid) -> float:
    """Elevation of a rig's light, degrees, or `InputError` where planning was not measured on rooms like it."""
    elevation_deg = rig.elevation_deg
    if elevation_deg is None or not is_measured(rig, grid):
        raise InputError(
            "what to expect was measured for one parallel lamp, raised alike for all pictures, and a screen behind the "
            "cube with pixels of whole voxels: this room is another one, so solve a small cube to see"
        )
    return elevation_deg
