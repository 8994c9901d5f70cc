"""The same shadows, of a lace

All that no shadow needs was taken out of it, voxel by voxel: a tenth of the solid is left, and it casts the same
three letters.

    lightcube hull front.png side.png top.png --walls -o word.shape.zarr --n 64
    lightcube carve word.shape.zarr -o lace.shape.zarr --carve lace --keep-deep 2
    lightcube view lace.shape.zarr
"""

from tile import FOLDER, letter, picture, show

import lightcube as lc
from lightcube.solids.walls import block

cuts = lc.cut(lc.Pictures(tuple(map(letter, "GEB")), tuple("GEB")))
grid, _ = block(cuts, 64, 80.0)
shape = lc.hull(lc.silhouettes([each.trimmed() for each in cuts], lc.walls(grid).rig(), "stretch"), grid)
less = lc.carve(shape, "lace", deep=2)
show(__doc__, less, seen=picture(less))
lc.save(less.mesh, FOLDER / "lace.stl", overwrite=True)
