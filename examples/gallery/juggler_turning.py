"""A juggler who keeps three balls in the air

Turn the block steadily, and its shadow throws the balls: twenty pictures, one for every eighteen degrees.

    lightcube trace juggler -o pictures --count 20 --size 32x32 --elevation-deg 35
    lightcube solve pictures -o cube.zarr --n 48
"""

from tile import show

import lightcube as lc

grid = lc.Grid((48, 48, 48), voxel_mm=2)
rig = lc.turntable(grid, lc.spread_angles(20, elevation_deg=35), elevation_deg=35, picture_shape=(32, 32))
targets = lc.scene_targets(lc.read_scene("juggler"), rig, grid)
cube = lc.solve(targets, grid, lc.Recipe.of_quality("normal")).cube
show(__doc__, cube, targets)
