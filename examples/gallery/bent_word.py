"""A word that had to be bent

H, U and T contradict each other: most of the U cannot be cast where the H has nothing. So their outlines are bent, as
little as can be, until one solid casts all three. Dark is what was drawn and is cast, orange what was drawn only,
blue what is cast beside it.

    lightcube hull h.png u.png t.png --walls -o hut.shape.zarr --n 64 --overlay bent.png
"""

import numpy as np
from tile import FOLDER, letter, show

import lightcube as lc
from lightcube.drawing.overlay import overlays

grid = lc.Grid((64, 64, 64), voxel_mm=1.25)
cuts = lc.cut(lc.Pictures(tuple(map(letter, "HUT")), tuple("HUT")))
bent = lc.repair(lc.silhouettes(cuts, lc.walls(grid).rig(), "stretch"), grid, wall_px=1.0)
drawn = overlays(bent)
show(__doc__, bent.shape, seen=np.pad(drawn, ((drawn.shape[1] // 6,) * 2, (0, 0), (0, 0)), constant_values=255))
lc.save(bent.shape.mesh, FOLDER / "hut.3mf", overwrite=True)
