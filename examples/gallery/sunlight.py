"""Made for the sun

The sun is half a degree wide, so its shadows have soft edges. Solved for that disc, before a wall ten centimetres
behind the turning cube, the pictures are as sharp as they can be there.

    lightcube solve photos -o cube.zarr --n 40 --picture-width 0.5 --lamp-deg 0.53 --screen-mm 100
"""

from tile import photographs, show

import lightcube as lc

table = lc.Turntable(lamp_deg=0.53, screen_mm=100.0)
pictures = photographs("cat", "astronaut", "coffee", "rocket")
plan = lc.plan(pictures, 40, lc.Recipe(passes=60), picture_width=0.5, turntable=table, told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
show(__doc__, cube, plan.targets, stop=3)
