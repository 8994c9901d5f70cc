"""Twenty-four pictures in their best order

Pictures of which it does not matter which comes after which: alike ones stand side by side, those that fight far
apart, and neighbours a little higher, lower or aside, so that each needs other voxels.

    lightcube solve photos -o cube.zarr --n 48 --picture-width 0.4 --order best --shift 6
"""

from tile import beside, show

import lightcube as lc
from lightcube.pictures import samples

plan = lc.plan(samples.photographs(24), 48, picture_width=0.4, order="best", shift=6, told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
seen = lc.play(cube, picture_only=True)
show(__doc__, cube, plan.targets, seen=beside(list(seen), 6))
