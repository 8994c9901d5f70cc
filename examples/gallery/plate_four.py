"""Four pictures in one white plate

No glass, no colours: little columns throw shadows. Take the lamp round, and one photograph becomes the next. Here are
its heights, what four lamps show, and what one between two of them shows. The STL is ready to print.

    lightcube relief a.jpg b.jpg c.jpg d.jpg -o plate.stl -o plate.relief.zarr --columns 96 --sweeps 150
    lightcube view plate.relief.zarr
"""

import numpy as np
from tile import FOLDER, beside, photographs, show

import lightcube as lc
from lightcube.drawing.relief_sheet import as_seen

plate = lc.relief(photographs("camera", "cat", "coins", "rocket"), lc.ReliefRecipe(side=96, sweeps=150))
heights = np.repeat((plate.heights_px / plate.heights_px.max())[..., None] ** 2.2, 3, axis=2)
lamps = [as_seen(plate, lc.relief_shadow(plate, azimuth_deg)[None])[0] for azimuth_deg in (*plate.azimuths_deg, 45.0)]
show(__doc__, plate, seen=beside([heights, *lamps], 3))
lc.save(plate, FOLDER / "plate.stl", overwrite=True)
