"""Under a level lamp

A level lamp, half a turn, a block as high as its pictures: what Rankin and Boyapati describe, here with six photographs
half as wide as the block, and a lamp that may be stronger for some of them.

    lightcube solve photos -o cube.zarr --n 48 --elevation-deg 0 --span-deg 180 --picture-width 0.5 --mat none
"""

from tile import photographs, show

import lightcube as lc

pictures = photographs("astronaut", "cat", "coffee", "rocket", "retina", "camera")
table = lc.Turntable(elevation_deg=0.0, span_deg=180.0)
plan = lc.plan(pictures, 48, lc.Recipe.of_quality("normal"), picture_width=0.5, turntable=table, told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
show(__doc__, cube, plan.targets, stop=3)
