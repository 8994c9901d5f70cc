"""Make the page of the cube at the head of the site: eight photographs in 48 x 48 x 48 voxels of stained glass.

python examples/home.py [OUT.html]
"""

import sys
from dataclasses import replace
from pathlib import Path

import lightcube as lc
from lightcube.pictures.samples import photographs

NAMES = ("astronaut", "coffee", "cat", "rocket", "retina", "tissue", "colours", "camera")
#: Voxels along a side, what the darkest glass may absorb (1/mm), and bytes that the page may have.
SIDE, CLEAR, MOST = 48, 0.12, 1_500_000


def main(out: str) -> None:
    every = photographs(16)
    some = replace(every, images=tuple(every.images[every.names.index(name)] for name in NAMES), names=NAMES)
    recipe = lc.Recipe.of_quality("normal", material=lc.Material(CLEAR))
    plan = lc.plan(some, SIDE, recipe, picture_width=0.5, longest_hold=True, smooth=True)
    cube = lc.solve(plan.targets, plan.grid, plan.recipe).cube
    lc.save(lc.page(cube, "Eight photographs in stained glass"), out, overwrite=True)
    if Path(out).stat().st_size > MOST:
        raise SystemExit(f"{out} has more than {MOST} bytes: take fewer voxels")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "home.html")
