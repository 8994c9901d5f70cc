"""Gems: pictures that flow into each other

Twenty-four pictures as wide as the block, under a level lamp of power 1, and all of them right: they are shadows of
one and the same translucent solids, so nothing contradicts itself, and between two pictures there is the one in
between.

    lightcube trace gems -o pictures --count 24 --size 48x48
    lightcube solve pictures -o cube.zarr --n 48 --picture-width 1 --mat none --lamp-power 1
    lightcube play cube.zarr -o turn.mp4
"""

from tile import show

import lightcube as lc

grid = lc.Grid((48, 48, 48), voxel_mm=2)
rig = lc.turntable(grid, lc.spread_angles(24), picture_shape=(48, 48), power=1.0)
targets = lc.scene_targets(lc.read_scene("gems"), rig, grid)
cube = lc.solve(targets, grid, lc.Recipe(passes=60)).cube
show(__doc__, cube, targets)
