"""Films that are slid over each other

Three sheets that touch, the upper one slid by a thumb's width: each place shows another picture, whatever the lamp is.
Above what was wanted, below what is shown.

    lightcube solve slid.toml -o stack.zarr
"""

from tile import beside, photographs, show

import lightcube as lc

names = ("cat", "rocket", "retina")
moves = [lc.Move(name, shift_mm=((0, 0), (0, 0), (20.0 * k, 0))) for k, name in enumerate(names)]
stage = lc.attenuator(names, lc.Films(count=3, gap_mm=0.0, size_mm=80, pixels=24), moves=moves)
targets = lc.fit(photographs(*names), stage.rig())
cube = lc.solve(targets, stage.grid, lc.Recipe(material=stage.material, passes=120)).cube
show(__doc__, cube, targets, seen=beside([*targets.pictures, *lc.play(cube, picture_only=True)], 3))
