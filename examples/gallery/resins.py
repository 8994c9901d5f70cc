"""Mixed of cyan, magenta, yellow, black

A printer has a few resins, and each takes more than its own colour. Solved for the amounts of them in every voxel,
the pictures are nearly as good as those of any colours.

    lightcube solve photos -o cube.zarr --n 32 --size-mm 20 --picture-width 0.5 --material polyjet
    lightcube info cube.zarr
"""

from tile import photographs, show

import lightcube as lc

recipe = lc.Recipe.of_quality("normal", material=lc.Material(dyes=lc.read_dyes("polyjet")))
pictures = photographs("colours", "coffee", "cat", "rocket", "retina", "tissue")
plan = lc.plan(pictures, 32, recipe, size_mm=20.0, picture_width=0.5, told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
show(__doc__, cube, plan.targets)
