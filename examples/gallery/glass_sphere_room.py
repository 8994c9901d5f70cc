"""A crystal ball

The largest sphere in the block, before a screen square to the light: eight photographs in a ball of glass.

    lightcube solve examples/stages/glass-sphere.toml -o cube.zarr --iterations 60
    lightcube play cube.zarr --view room -o room.mp4
"""

from pathlib import Path

from tile import show

import lightcube as lc

stage, targets = lc.read_stage_targets(Path(__file__).parents[1] / "stages" / "glass-sphere.toml")
cube = lc.solve(targets, stage.grid, lc.Recipe(passes=60)).cube
show(__doc__, cube, targets, stop=7)
