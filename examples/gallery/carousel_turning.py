"""A merry-go-round

Eighteen pictures of a carousel that turns as the block turns: eggs ride up and down. Traced, solved and cast, the
three programs of the paper.

    lightcube trace carousel -o pictures --count 18 --size 32x32 --elevation-deg 35
    lightcube solve pictures -o cube.zarr --n 48
"""

from tile import show

import lightcube as lc

grid = lc.Grid((48, 48, 48), voxel_mm=2)
rig = lc.turntable(grid, lc.spread_angles(18, elevation_deg=35), elevation_deg=35, picture_shape=(32, 32))
targets = lc.scene_targets(lc.read_scene("carousel"), rig, grid)
cube = lc.solve(targets, grid, lc.Recipe.of_quality("normal")).cube
show(__doc__, cube, targets)
