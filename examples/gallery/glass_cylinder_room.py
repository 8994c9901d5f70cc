"""A cylinder of glass is a lens

The beams cross behind it, and the picture stands where they part again. No seams, nothing that changes as it turns.

    lightcube solve examples/stages/glass-cylinder.toml -o cube.zarr --iterations 60
    lightcube play cube.zarr --view room -o room.mp4
"""

from pathlib import Path

from tile import show

import lightcube as lc

stage, targets = lc.read_stage_targets(Path(__file__).parents[1] / "stages" / "glass-cylinder.toml")
cube = lc.solve(targets, stage.grid, lc.Recipe(passes=60)).cube
show(__doc__, cube, targets, stop=6)
