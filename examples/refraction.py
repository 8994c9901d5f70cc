"""The picture of docs/glass.md: what glass does to a cube that does not know of it, and to cubes that do.

    python examples/refraction.py [FOLDER]

Half a minute; the picture goes to docs/pictures, or FOLDER.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

import lightcube as lc
from lightcube.optics.transfer import encode, to_uint8
from lightcube.pictures import samples

#: Voxels a side, pictures, pixels of these, display pixels of each.
SIDE, COUNT, PIXELS, SCALE = 48, 8, 28, 6
SHOWN = (0, 2, 4, 5)


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "docs" / "pictures"
    wanted, straight = solved(None, 35.0)
    block, cylinder = solved(lc.Glass(1.5), 35.0)[1], solved(lc.Glass(1.5, "cylinder"), 20.0)[1]
    unaware = replace(straight, rig=block.rig)
    rows = [wanted, *(np.stack(list(lc.cast(cube))) for cube in (straight, unaware, block, cylinder))]
    shown = np.concatenate([np.concatenate([larger(encode(row[k])) for k in SHOWN], axis=1) for row in rows])
    Image.fromarray(to_uint8(np.clip(shown, 0, 1), "linear")).save(folder / "glass.png")


def solved(glass: lc.Glass | None, elevation_deg: float) -> tuple[NDArray[np.float32], lc.Cube]:
    """What is wanted, and a cube that shows it."""
    grid = lc.Grid((SIDE, SIDE, SIDE), 100 / SIDE)
    angles_deg = lc.spread_angles(COUNT, elevation_deg=elevation_deg)
    rig = lc.turntable(grid, angles_deg, elevation_deg=elevation_deg, picture_shape=(PIXELS, PIXELS), glass=glass)
    targets = lc.fit(samples.photographs(COUNT), rig)
    return targets.pictures, lc.solve(targets, grid, lc.Recipe(passes=150)).cube


def larger(picture: NDArray[np.floating]) -> NDArray[np.floating]:
    """Each pixel in several, with a dark seam around."""
    return np.pad(picture.repeat(SCALE, 0).repeat(SCALE, 1), ((4, 4), (4, 4), (0, 0)), constant_values=1.0)


if __name__ == "__main__":
    main()
