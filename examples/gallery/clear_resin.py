"""In resin that is not quite clear

Even the clearest resin takes a little of the light. Solved with what the clearest voxel takes, one per cent a
millimetre, the lamps make up for it.

    lightcube solve photos -o cube.zarr --n 40 --picture-width 0.5 --size-mm 40 --clear 0.01
"""

from tile import photographs, show

import lightcube as lc

recipe = lc.Recipe.of_quality("normal", material=lc.Material(3.0, clear=0.01))
pictures = photographs("cat", "retina", "coffee", "astronaut", "rocket")
plan = lc.plan(pictures, 40, recipe, size_mm=40.0, picture_width=0.5, told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
show(__doc__, cube, plan.targets, stop=1)
