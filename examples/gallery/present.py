"""A present with a title

A cube with a label of its own: what it is called, who made it, and for whom. The page is one file, which can be
mailed.

    lightcube solve photos -o cube.zarr --n 40 --picture-width 0.5
    lightcube view cube.zarr --title "Six mornings" --by "Ada" --note "for Bob, who sleeps late" --preview
"""

from tile import FOLDER, photographs, show

import lightcube as lc

pictures = photographs("coffee", "cat", "moon", "clock", "colours", "coins")
plan = lc.plan(pictures, 40, picture_width=0.5, told=False)
cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
show("Six mornings", cube, plan.targets, note="for Bob, who sleeps late")
lc.save(lc.film(cube, format="square", captions=True, fps=15), FOLDER / "to-share.mp4", overwrite=True)
