"""The paper's cube: 3 × 3 × 3 voxels

The cube that Rankin and Boyapati turned: twenty-seven coloured voxels, pictures of five by three pixels. Here the way
back is found too, exactly, by both of the methods that the paper proposes.

    lightcube demo --paper
"""

import numpy as np
from tile import show

import lightcube as lc
from lightcube.drawing.small import small_cube

grid = lc.Grid((3, 3, 3))
rig = lc.turntable(grid, lc.spread_angles(8), power=1.0)
clear = np.random.default_rng(2).uniform(0.3, 1.0, (3, 3, 3, 3))
truth = lc.Cube((-np.log(clear) / np.sqrt(2)).astype(np.float32), grid, rig, np.ones((8, 3)))
wanted = lc.play(truth, light="thin", picture_only=True)
targets = lc.Targets(np.stack(list(wanted)), rig)
cube = lc.solve(targets, grid, lc.Recipe(method="gauss-seidel", dtype="float64")).cube
print("largest error of a voxel", abs(cube.extinction - truth.extinction).max())
drawn = small_cube(clear, targets.pictures, rig.views.angles_deg)
margin = (2 * drawn.shape[1] // 3 - len(drawn)) // 2  # to the shape of a thumbnail, which then cuts nothing off
show(__doc__, cube, seen=np.pad(drawn, ((margin, margin), (0, 0), (0, 0)), mode="edge"))
