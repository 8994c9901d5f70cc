"""Three coloured lamps on one wall

Amber, mint and violet light adds up: the wall shows photographs in all colours.

    lightcube solve examples/stages/coloured-lamps.toml -o cube.zarr --iterations 40
    lightcube play cube.zarr --view room -o room.mp4
"""

from pathlib import Path

from tile import show

import lightcube as lc

stage, targets = lc.read_stage_targets(Path(__file__).parents[1] / "stages" / "coloured-lamps.toml")
cube = lc.solve(targets, stage.grid, lc.Recipe(passes=40)).cube
show(__doc__, cube, targets, stop=4)
