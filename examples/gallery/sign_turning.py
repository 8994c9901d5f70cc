"""A sign whose letters throw coloured shadows

Tinted glass letters turn over a white floor: sixteen traced pictures, kept in one block.

    lightcube trace sign -o pictures --count 16 --size 48x24 --elevation-deg 35
    lightcube solve pictures -o cube.zarr --n 48
"""

from tile import show

import lightcube as lc

grid = lc.Grid((48, 48, 48), voxel_mm=2)
rig = lc.turntable(grid, lc.spread_angles(16, elevation_deg=35), elevation_deg=35, picture_shape=(24, 48))
targets = lc.scene_targets(lc.read_scene("sign"), rig, grid)
cube = lc.solve(targets, grid, lc.Recipe.of_quality("normal")).cube
show(__doc__, cube, targets)
