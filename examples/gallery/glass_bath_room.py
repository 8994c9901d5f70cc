"""Turned in a basin of oil

In a basin with flat sides, filled with what has the glass's own index, light is straight inside, and the faces of the
block vanish.

    lightcube solve examples/stages/glass-bath.toml -o cube.zarr --iterations 60
    lightcube play cube.zarr --view room -o room.mp4
"""

from pathlib import Path

from tile import show

import lightcube as lc

stage, targets = lc.read_stage_targets(Path(__file__).parents[1] / "stages" / "glass-bath.toml")
cube = lc.solve(targets, stage.grid, lc.Recipe(passes=60)).cube
show(__doc__, cube, targets, stop=4)
