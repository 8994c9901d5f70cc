"""Prints on grey card

A grey mat instead of a dark one: around each picture an even grey is asked for, as on a mounted print.

    lightcube solve photos -o cube.zarr --n 48 --picture-width 0.4 --mat grey
"""

from tile import beside, photographs, show

import lightcube as lc

recipe = lc.Recipe.of_quality("normal", mat=lc.Mat(tone=0.5))
plan = lc.plan(photographs("rocket", "cat", "camera", "retina"), 48, recipe, picture_width=0.4, told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
screens = list(lc.play(cube))
show(__doc__, cube, plan.targets, seen=beside(screens[1:3], 2))
