"""Films that are slid over each other

Three sheets that touch, the upper one slid by a thumb's width: each place shows another picture, whatever the lamp is.
Above what was wanted, below what is shown.

    lightcube solve examples/films/slid.toml -o stack.zarr --iterations 120
    lightcube export film stack.zarr -o prints.pdf
"""

from pathlib import Path

from tile import beside, show

import lightcube as lc

stage, targets = lc.read_stage_targets(Path(__file__).parents[1] / "films" / "slid.toml")
cube = lc.solve(targets, stage.grid, lc.Recipe(material=stage.material, passes=120)).cube
show(__doc__, cube, targets, seen=beside([*targets.pictures, *lc.play(cube, picture_only=True)], 3))
