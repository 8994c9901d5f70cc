"""A bulb, one hand away

The lamp is a point near the block, so its beams spread, upwards and downwards too, and sixteen pictures have room.

    lightcube solve examples/stages/point-lamp.toml -o cube.zarr --iterations 30
    lightcube play cube.zarr --view room -o room.mp4
"""

from pathlib import Path

from tile import show

import lightcube as lc

stage, targets = lc.read_stage_targets(Path(__file__).parents[1] / "stages" / "point-lamp.toml")
cube = lc.solve(targets, stage.grid, lc.Recipe(passes=30)).cube
show(__doc__, cube, targets, stop=2)
