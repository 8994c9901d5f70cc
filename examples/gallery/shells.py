"""Shells of three colours

Surfaces around the darkness of a cube, each of one colour, as a printer with three filaments takes them; here with a
quarter cut out. They are an ornament, and cast no pictures: the cube that they were drawn from does, on the page.

    lightcube trace gems -o pictures --count 12 --size 40x40
    lightcube solve pictures -o cube.zarr --n 40 --picture-width 1 --mat none --lamp-power 1
    lightcube export shell cube.zarr -o shells.3mf --levels 3
"""

import numpy as np
from tile import FOLDER, body, scattered, show

import lightcube as lc
from lightcube.fabrication.shells import shells

grid = lc.Grid((40, 40, 40), voxel_mm=1)
rig = lc.turntable(grid, lc.spread_angles(12), picture_shape=(40, 40), power=1.0)
targets = lc.scene_targets(lc.read_scene("gems"), rig, grid)
cube = lc.solve(targets, grid, lc.Recipe(passes=60)).cube
drawn = [body(each.mesh, np.array(each.colour) / max(each.colour)) for each in shells(cube, 3)]
points, colours = (np.concatenate(each) for each in zip(*drawn, strict=True))
stays = (points[:, 0] < 0) | (points[:, 1] > 0)
show(__doc__, cube, targets, seen=scattered(points[stays], colours[stays]))
lc.export(cube, FOLDER / "shells.3mf", "shell", overwrite=True)
