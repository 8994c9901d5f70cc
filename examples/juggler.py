"""Make the README's picture: wanted pictures of the juggler above the whole shadows of one cube.

python examples/juggler.py [OUT.png]
"""

import sys

import numpy as np

import lightcube as lc
from lightcube.optics.transfer import to_uint8

STOPS, SCALE, PIXELS = (0, 5, 10, 14, 19), 3, 32


def main(out: str) -> None:
    grid = lc.Grid((64, 64, 64), voxel_mm=1.5)
    angles_deg = lc.spread_angles(24, elevation_deg=35)
    views = lc.turntable(grid, angles_deg, elevation_deg=35, picture_shape=(PIXELS, PIXELS))
    targets = lc.scene_targets(lc.read_scene("juggler"), views, grid)
    cube = lc.solve(targets, grid, lc.Recipe.of_quality("normal", mat=lc.Mat(), hold_deg=0.25)).cube
    chosen = list(STOPS)
    shadows = lc.play(cube, angles_deg[chosen])
    lower = np.concatenate(list(shadows), axis=1)
    rows, columns = shadows.shape[1:3]
    wanted = np.ones((5, PIXELS, columns, 3), np.float32)
    left = (columns - PIXELS) // 2
    wanted[:, :, left : left + PIXELS] = targets.pictures[chosen]
    upper = np.concatenate(list(wanted), axis=1)
    gap = np.ones((4, upper.shape[1], 3), np.float32)
    sheet = to_uint8(np.concatenate([upper, gap, lower], axis=0)).repeat(SCALE, axis=0).repeat(SCALE, axis=1)
    lc.save(sheet, out, overwrite=True)
    scores = lc.score(cube, targets)
    print(f"{out}: {scores['psnr_mean']:.1f} dB, worst {scores['psnr_min']:.1f}, {rows} rows")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "juggler.png")
