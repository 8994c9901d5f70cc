"""Two walls and a floor

The block stands still. Three lamps shine through it, and three pictures are there at once.

    lightcube solve examples/stages/three-screens.toml -o cube.zarr --iterations 60
    lightcube play cube.zarr --view room -o room.mp4
"""

from pathlib import Path

from tile import show

import lightcube as lc

stage, targets = lc.read_stage_targets(Path(__file__).parents[1] / "stages" / "three-screens.toml")
cube = lc.solve(targets, stage.grid, lc.Recipe(passes=60)).cube
show(__doc__, cube, targets, stop=0)
