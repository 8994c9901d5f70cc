"""What a set-up that is off costs

One photograph as it was made; turned by 0.2 degrees; half a voxel aside; under a lamp as wide as the sun; in resin that
throws a third of the light aside, by an estimate; and with several things wrong at once.

    lightcube solve photos -o cube.zarr --n 40 --picture-width 0.5
    lightcube score cube.zarr photos --robust
"""

from tile import beside, show

import lightcube as lc
from lightcube.pictures import samples
from lightcube.scoring.robust import disturbances, disturbed

plan = lc.plan(samples.photographs(16), 40, picture_width=0.5, told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
ways = disturbances(cube)
chosen = [ways[name] for name in ("undisturbed", "turned", "sideways", "disc", "haze-more", "all")]
show(__doc__, cube, plan.targets, seen=beside([list(disturbed(cube, way))[4] for way in chosen], 3))
