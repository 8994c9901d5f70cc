"""Held, to be turned by hand

Four pictures that each stand for six degrees: asked for at many angles around the stop, under one lamp. Turn it
slowly, and the picture stays: here at 3 and 1.5 degrees before the stop, at it, 1.5 and 3 after, and at 12, where
there is noise.

    lightcube solve photos -o cube.zarr --n 40 --picture-width 0.5 --hold-deg 3
    lightcube score cube.zarr photos --between --plot between.png
"""

from tile import beside, photographs, show

import lightcube as lc

pictures = photographs("rocket", "coffee", "astronaut", "cat")
plan = lc.plan(pictures, 40, lc.Recipe(hold_deg=3.0, passes=80), picture_width=0.5, told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
around = [cube.angles_deg[0] + off for off in (-3, -1.5, 0, 1.5, 3, 12)]
seen = lc.play(cube, around, picture_only=True)
show(__doc__, cube, plan.targets, seen=beside(list(seen), 3))
