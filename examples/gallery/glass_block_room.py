"""A block of solid glass

Glass bends the light where it enters and leaves. Solved for it, the pictures are there all the same.

    lightcube solve examples/stages/glass-block.toml -o cube.zarr --iterations 60
    lightcube play cube.zarr --view room -o room.mp4
"""

from pathlib import Path

from tile import show

import lightcube as lc

stage, targets = lc.read_stage_targets(Path(__file__).parents[1] / "stages" / "glass-block.toml")
cube = lc.solve(targets, stage.grid, lc.Recipe(passes=60)).cube
show(__doc__, cube, targets, stop=2)
