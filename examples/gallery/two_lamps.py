"""Two lamps, one high, one low

Pictures in turn under a lamp at 20 and one at 50 degrees look through the block on different ways, and fight less.

    lightcube solve examples/stages/hemisphere.toml -o cube.zarr --iterations 30
    lightcube play cube.zarr --view room -o room.mp4
"""

from pathlib import Path

from tile import room, show

import lightcube as lc

stage, targets = lc.read_stage_targets(Path(__file__).parents[1] / "stages" / "hemisphere.toml")
cube = lc.solve(targets, stage.grid, lc.Recipe(passes=30)).cube
show(__doc__, cube, targets, seen=room(cube)[115:525, :615])
