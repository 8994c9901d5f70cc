"""Between two pictures

From a photograph to the next one, a quarter of a turn on: at its stop; 1.4, 2.8 and 5.6 degrees further, where it
dissolves; halfway, where there is noise; and the next. That is why a movie rests on the stops, and turns in the dark.

    lightcube solve photos -o cube.zarr --n 40 --picture-width 0.5 --hold-deg 0
    lightcube score cube.zarr photos --between --plot between.png
"""

from tile import beside, photographs, show

import lightcube as lc

plan = lc.plan(
    photographs("coffee", "astronaut", "cat", "retina"), 40, lc.Recipe(passes=80), picture_width=0.5, told=False
)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
way = cube.angles_deg[1] - cube.angles_deg[0]
steps = [cube.angles_deg[0] + part * way for part in (0, 1 / 64, 1 / 32, 1 / 16, 1 / 2, 1)]
show(__doc__, cube, plan.targets, seen=beside(list(lc.play(cube, steps, picture_only=True)), 3))
