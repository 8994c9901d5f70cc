"""A flower that opens: a flip-book

Sixteen pictures of a flower. Beside the page the movie in which the lamp rests on each of them, as one turns the
pages of a flip-book.

    lightcube trace bloom -o pictures --count 16 --size 32x32 --elevation-deg 35
    lightcube solve pictures -o cube.zarr --n 48
    lightcube play cube.zarr -o flipbook.webp --stops --picture-only --fps 8 --scale 8
"""

from tile import FOLDER, beside, show

import lightcube as lc

grid = lc.Grid((48, 48, 48), voxel_mm=2)
rig = lc.turntable(grid, lc.spread_angles(16, elevation_deg=35), elevation_deg=35, picture_shape=(32, 32))
targets = lc.scene_targets(lc.read_scene("bloom"), rig, grid)
cube = lc.solve(targets, grid, lc.Recipe.of_quality("normal")).cube
pages = lc.play(cube, picture_only=True)
show(__doc__, cube, targets, seen=beside([pages[k] for k in range(0, 12, 2)], 3))
lc.save(pages, FOLDER / "flipbook.webp", fps=8, scale=8, overwrite=True)
