"""Three letters in one solid

Seen from the front it is a G, from the side an E, from above a B, and it is the largest solid that all three allow.
The STL beside it is ready to print.

    lightcube hull front.png side.png top.png --walls -o word.stl -o word.shape.zarr --n 64
    lightcube view word.shape.zarr
"""

from tile import FOLDER, letter, picture, show

import lightcube as lc
from lightcube.solids.walls import block

cuts = lc.cut(lc.Pictures(tuple(map(letter, "GEB")), tuple("GEB")))
grid, _ = block(cuts, 64, 80.0)
shape = lc.hull(lc.silhouettes([each.trimmed() for each in cuts], lc.walls(grid).rig(), "stretch"), grid)
show(__doc__, shape, seen=picture(shape))
lc.save(shape.mesh, FOLDER / "word.stl", overwrite=True)
