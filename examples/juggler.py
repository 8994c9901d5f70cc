"""Make the README's picture: wanted pictures of the juggler above the whole shadows of one cube.

python examples/juggler.py [OUT.png]
"""

import sys

import numpy as np

import lightcube as lc
from lightcube.optics.transfer import to_uint8

STOPS, SCALE = (0, 6, 13, 19, 26), 3


def main(out: str) -> None:
    grid = lc.Grid((64, 64, 64), voxel_mm=1.5)
    angles_deg = lc.spread_angles(32, elevation_deg=35)
    views = lc.turntable(grid, angles_deg, elevation_deg=35, picture_shape=(48, 48))
    targets = lc.scene_targets(lc.read_scene("juggler"), views, grid)
    cube = lc.solve(targets, grid).cube
    chosen = list(STOPS)
    shadows = lc.play(cube, angles_deg[chosen])
    lower = np.concatenate(list(shadows), axis=1)
    rows, columns = shadows.shape[1:3]
    wanted = np.ones((5, 48, columns, 3), np.float32)
    left = (columns - 48) // 2
    wanted[:, :, left : left + 48] = targets.pictures[chosen]
    upper = np.concatenate(list(wanted), axis=1)
    gap = np.ones((4, upper.shape[1], 3), np.float32)
    sheet = to_uint8(np.concatenate([upper, gap, lower], axis=0)).repeat(SCALE, axis=0).repeat(SCALE, axis=1)
    lc.save(sheet, out, overwrite=True)
    print(f"{out}: {lc.score(cube, targets)['psnr_mean']:.1f} dB, {rows} rows")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "juggler.png")
