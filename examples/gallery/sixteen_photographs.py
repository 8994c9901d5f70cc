"""Sixteen photographs in one block

Sixteen pictures that have nothing to do with each other, in dark mats, in a block of 48 voxels a side. The sheet
below shows each of them as it was wanted and as the wall shows it.

    lightcube solve photos -o cube.zarr --n 48 --picture-width 0.5
    lightcube score cube.zarr photos --sheet sheet.png
"""

from tile import beside, show

import lightcube as lc
from lightcube.pictures import samples

plan = lc.plan(samples.photographs(16), 48, picture_width=0.5, told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
seen = lc.play(cube, picture_only=True)
show(__doc__, cube, plan.targets, seen=beside([seen[k] for k in range(15)], 5))
