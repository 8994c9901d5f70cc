"""Two walls at once

Walls at right angles, a lamp for each: every stop shows two photographs at the same time.

    lightcube solve examples/stages/two-screens.toml -o cube.zarr --iterations 40
    lightcube play cube.zarr --view room -o room.mp4
"""

from pathlib import Path

from tile import show

import lightcube as lc

stage, targets = lc.read_stage_targets(Path(__file__).parents[1] / "stages" / "two-screens.toml")
cube = lc.solve(targets, stage.grid, lc.Recipe(passes=40)).cube
show(__doc__, cube, targets, stop=2)
