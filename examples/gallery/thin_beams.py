"""Thin beams, and what a wall makes of them

Solved as in the paper, for one infinitely thin beam through each pixel's middle. By these beams (above) the photographs
are perfect; a wall shows areas, and inside every pixel there is noise (below, each pixel in six by six parts). *Thin
beams* on the page switches.

    lightcube solve photos -o cube.zarr --n 40 --picture-width 0.5 --light thin --mat none
    lightcube play cube.zarr -o thin.mp4 --light thin
    lightcube play cube.zarr -o wall.mp4 --zoom 6
"""

from tile import beside, show

import lightcube as lc
from lightcube.pictures import samples

recipe = lc.Recipe(light=lc.Light.thin(), passes=150)
plan = lc.plan(samples.photographs(12), 40, recipe, picture_width=0.5, told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
thin = lc.play(cube, picture_only=True, light="thin").repeat(6, axis=1).repeat(6, axis=2)
wall = lc.play(cube, picture_only=True, zoom=6)
show(__doc__, cube, plan.targets, seen=beside([each[k] for each in (thin, wall) for k in (0, 2, 4)], 3))
