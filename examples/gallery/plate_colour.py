"""One photograph in colour, from a white plate

A red lamp on the right, a green one on the left, a blue one behind: the shadows of white columns add up to a
photograph in colour.

    lightcube relief cat.jpg -o plate.relief.zarr --colour --columns 96 --sweeps 150
    lightcube play plate.relief.zarr -o plate.mp4
"""

from tile import beside, photographs, show

import lightcube as lc
from lightcube.drawing.relief_sheet import as_seen
from lightcube.solids.relief_light import shown

plate = lc.relief(photographs("cat"), lc.ReliefRecipe(side=96, sweeps=150), colour=True)
seen = as_seen(plate, shown(plate))[0]
show(__doc__, plate, seen=beside([seen[16:80]], 1))
