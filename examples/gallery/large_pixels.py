"""Few pixels, fine voxels

Pixels of two by two voxels: pictures of sixteen pixels a side, which is enough for an icon, and each of them nearly
perfect, because there is more glass for every pixel.

    lightcube solve icons -o cube.zarr --n 48 --pixel 2 --picture-width 0.66
"""

import numpy as np
from tile import show

import lightcube as lc

HEART = ["0110110", "1111111", "1111111", "0111110", "0011100", "0001000", "0000000"]
colours = [(0.95, 0.25, 0.2), (0.95, 0.7, 0.15), (0.25, 0.75, 0.3), (0.2, 0.5, 0.95), (0.6, 0.3, 0.85)]
inside = np.pad(np.array([[int(pixel) for pixel in row] for row in HEART], bool), 1).repeat(16, 0).repeat(16, 1)
icons = [np.where(inside[..., None], colour, (0.03, 0.03, 0.05)) for colour in colours]
pictures = lc.Pictures(tuple(icons), ("red", "yellow", "green", "blue", "violet"))
plan = lc.plan(pictures, 48, picture_width=0.66, turntable=lc.Turntable(pixel=2), told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
show(__doc__, cube, plan.targets)
