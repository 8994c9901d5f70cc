"""Eight photographs in stained glass

Turn it: at each stop the wall shows another photograph. Nothing is asked for around the pictures, and no voxel may be
very dark, so the block looks like stained glass and not like a lump of coal.

    lightcube solve photos -o cube.zarr --n 48 --picture-width 0.5 --mat none --max-extinction 0.12
    lightcube view cube.zarr
"""

from tile import photographs, show

import lightcube as lc

pictures = photographs("astronaut", "coffee", "cat", "rocket", "retina", "tissue", "colours", "camera")
recipe = lc.Recipe.of_quality("normal", material=lc.Material(0.12))
plan = lc.plan(pictures, 48, recipe, picture_width=0.5, told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
show(__doc__, cube, plan.targets)
