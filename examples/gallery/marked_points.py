"""Points, to be marked in glass by a laser

White points where the cube is dark, no two nearer than 0.8 mm, for shops that mark glass inside. Points scatter light:
they show the cube's shape, and none of its pictures.

    lightcube trace gems -o pictures --count 12 --size 40x40
    lightcube solve pictures -o cube.zarr --n 40 --picture-width 1 --mat none --lamp-power 1
    lightcube export points cube.zarr -o points.ply --spacing-um 800
"""

import numpy as np
from tile import FOLDER, scattered, show

import lightcube as lc
from lightcube.fabrication.points import Points

grid = lc.Grid((40, 40, 40), voxel_mm=1)
rig = lc.turntable(grid, lc.spread_angles(12), picture_shape=(40, 40), power=1.0)
targets = lc.scene_targets(lc.read_scene("gems"), rig, grid)
cube = lc.solve(targets, grid, lc.Recipe(passes=60)).cube
places = np.concatenate(list(Points(cube, 0.8, 1).layers()))
depth = (places @ (0.6, -0.7, 0.4))[:, None]
show(
    __doc__, cube, targets, seen=scattered(places, (0.6 + 0.4 * depth / abs(depth).max()) * np.array([0.75, 0.9, 1.0]))
)
lc.export(cube, FOLDER / "points.ply", "points", spacing_um=800.0, overwrite=True)
