"""Five printed films on the kitchen table

Four photographs in five transparent sheets, 12 mm apart. Hold a lamp to the right, and one of them lies on the table;
to the left, and it is another one. On the page a slider lays the films a little wrong.

    lightcube solve photos --films 5 --n 48 -o stack.zarr
    lightcube export film stack.zarr -o prints.pdf
"""

from tile import photographs, show

import lightcube as lc

names = ("astronaut", "cat", "coffee", "retina")
stage = lc.attenuator(names, lc.Films(count=5, pixels=24))
targets = lc.fit(photographs(*names), stage.rig())
cube = lc.solve(targets, stage.grid, lc.Recipe(material=stage.material, passes=80)).cube
show(__doc__, cube, targets, stop=2)
