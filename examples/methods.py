"""Solve the same pictures by every iterative method: the table of docs/method.md.

python examples/methods.py
"""

from dataclasses import replace

import numpy as np

import lightcube as lc
from lightcube.pictures import samples


def photographs(grid: lc.Grid, elevation_deg: float, picture_width: float = 1.0) -> lc.Targets:
    pictures = samples.photographs()
    return lc.fit(pictures, lc.Turntable(elevation_deg=elevation_deg).rig(pictures, grid, picture_width=picture_width))


def main() -> None:
    grid = lc.Grid((64, 64, 64), voxel_mm=1.5)
    raised = lc.turntable(grid, lc.spread_angles(32, elevation_deg=35), elevation_deg=35, picture_shape=(48, 48))
    level = lc.turntable(grid, lc.spread_angles(64), picture_shape=(64, 64))
    pictures = {
        "photographs 32 x 32, 35 degrees": photographs(grid, elevation_deg=35, picture_width=0.5),
        "photographs 64 x 64, 0 degrees": photographs(grid, elevation_deg=0),
        "juggler 48 x 48, 35 degrees": lc.scene_targets(lc.read_scene("juggler"), raised, grid),
        "gems 64 x 64, 0 degrees": lc.scene_targets(lc.read_scene("gems"), level, grid),
    }
    for name, targets in pictures.items():
        dim = replace(targets.rig.lamps, least=np.array([1.0]), most=np.array([1.0]))
        paper = replace(targets, rig=replace(targets.rig, lamps=dim))
        for method, wanted, light in (
            ("display", targets, lc.Light()),
            ("display", targets, lc.Light.thin()),
            ("display", paper, lc.Light()),
            *((method, paper, lc.Light.thin()) for method in ("display", "sirt", "cgls", "gauss-seidel")),
        ):
            sweeps = 100 if method == "gauss-seidel" else 200
            solution = lc.solve(wanted, grid, lc.Recipe(method=method, passes=sweeps, light=light))
            scores = lc.score(solution.cube, targets)
            figures = f"{scores['psnr_mean']:.1f} / {scores['psnr_min']:.1f} dB, thin {scores['thin_psnr_mean']:.1f} dB"
            lamp = "per view" if wanted is targets else "1"
            asked = "thin beams" if light.is_thin else "areas"
            thrown = len(solution.rejected) / targets.pictures.size
            print(f"{name}: {method}, {asked}, lamp {lamp}: {figures}, {thrown:.0%} thrown out", flush=True)


if __name__ == "__main__":
    main()
