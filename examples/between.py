"""Measure and draw what is seen between the pictures: the tables and pictures of docs/between.md.

python examples/between.py [FOLDER]
"""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

import lightcube as lc
from lightcube.drawing import plots
from lightcube.optics.disturbance import DISTURBANCES
from lightcube.optics.transfer import to_uint8
from lightcube.pictures import samples
from lightcube.scoring.between import Curve, curve
from lightcube.scoring.metrics import mean_psnr
from lightcube.scoring.robust import robust

#: Where the strips show a picture, as a fraction of the way to the next stop, and how much they are enlarged.
PARTS, SCALE = (0.0, 1 / 64, 1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 3 / 4, 1.0), 3


def block(n: int) -> lc.Grid:
    return lc.Grid((n, n, n), voxel_mm=96 / n)


def photographs(grid: lc.Grid) -> lc.Targets:
    pictures = samples.photographs()
    return lc.fit(pictures, lc.Turntable(elevation_deg=35.0).rig(pictures, grid, picture_width=0.5))


def juggler(grid: lc.Grid, count: int) -> lc.Targets:
    table = lc.turntable(grid, lc.spread_angles(count, elevation_deg=35.0), elevation_deg=35.0, picture_shape=(32, 32))
    return lc.scene_targets(lc.read_scene("juggler"), table, grid)


def gems(grid: lc.Grid, count: int) -> lc.Targets:
    table = lc.turntable(grid, lc.spread_angles(count), picture_shape=(64, 64))
    return lc.scene_targets(lc.read_scene("gems"), table, grid)


#: Name, voxels a side, pictures, hold in degrees, and whether to draw it.
CASES: list[tuple[str, int, Callable[[lc.Grid], lc.Targets], float, bool]] = [
    ("16 photographs, n = 32", 32, photographs, 0.0, False),
    ("16 photographs", 64, photographs, 0.0, True),
    ("16 photographs, held 1.5°", 64, photographs, 1.5, False),
    ("juggler, 8 pictures, held 6°", 64, lambda grid: juggler(grid, 8), 6.0, True),
    ("juggler, 8 pictures", 64, lambda grid: juggler(grid, 8), 0.0, True),
    ("juggler, 16 pictures", 64, lambda grid: juggler(grid, 16), 0.0, False),
    ("juggler, 32 pictures", 64, lambda grid: juggler(grid, 32), 0.0, False),
    ("juggler, 64 pictures", 64, lambda grid: juggler(grid, 64), 0.0, True),
    ("gems, 16 pictures", 64, lambda grid: gems(grid, 16), 0.0, False),
    ("gems, 64 pictures", 64, lambda grid: gems(grid, 64), 0.0, True),
]


def over_the_turn(found: Curve) -> str:
    """Spacing; PSNR at the stops; lobe, also as a part of the turn; PSNR over the turn; PSNR and SSIM halfway."""
    spacing = found.period_deg / len(found.lobes_deg)
    turn = np.trapezoid(found.psnr, found.angles_deg) / found.period_deg
    halfway = np.isclose(np.abs(found.offsets_deg), spacing / 2)
    return (
        f"{spacing:.1f}° | {np.mean(found.psnr[found.offsets_deg == 0]):.1f} | {np.mean(found.lobes_deg):.2f}° | "
        f"{100 * found.lobes_deg.sum() / found.period_deg:.0f} % | {turn:.1f} | {np.mean(found.psnr[halfway]):.1f} | "
        f"{np.mean(found.ssim[halfway]):.2f}"
    )


def strip(cube: lc.Cube, spacing: float) -> np.ndarray:
    """What is seen from the first stop to the next, side by side, 8-bit, each picture 32 pixels wide."""
    shown = lc.play(cube, cube.angles_deg[0] + spacing * np.array(PARTS), picture_only=True)
    every = shown.shape[2] // 32
    padded = np.pad(shown[:, ::every, ::every], [(0, 0), (0, 2), (0, 2), (0, 0)], constant_values=1)
    return to_uint8(np.concatenate(list(padded), axis=1))


def half_a_pixel(targets: lc.Targets) -> float:
    """PSNR of the wanted pictures themselves, moved by half a pixel to the right: the mean of neighbours."""
    columns = targets.pictures.shape[2]
    left = np.maximum(np.arange(columns) - 1, 0)
    return mean_psnr((targets.pictures + targets.pictures[:, :, left]) * np.float32(0.5), targets)


def main(folder: Path) -> None:
    curves, strips, left, moved = {}, [], {}, []
    print("| pictures | spacing | at the stops | lobe | of the turn | over the turn | halfway | SSIM there |")
    print("|---|---|---|---|---|---|---|---|")
    for name, n, make, hold_deg, drawn in CASES:
        grid = block(n)
        targets = make(grid)
        cube = lc.solve(targets, grid, lc.Recipe(hold_deg=hold_deg)).cube
        found = curve(cube, targets)
        print(f"| {name} | {over_the_turn(found)} |", flush=True)
        if drawn:
            curves[name], left[name] = found, robust(cube, targets)
            moved.append(half_a_pixel(targets))
            if make is not photographs:  # the strips are committed, and show nobody else's pictures
                strips.append(strip(cube, found.period_deg / len(targets)))
    print("\n| set-up | " + " | ".join(left) + " |")
    print("|---" * (1 + len(left)) + "|")
    everywhere = set.intersection(*map(set, left.values()))  # not all can be tried of every cube
    for kind, disturbance in DISTURBANCES.items():
        if kind not in everywhere:
            continue
        words = "all of these at once" if kind == "all" else disturbance
        print(f"| {words} | " + " | ".join(f"{each[kind]['psnr_mean']:.1f}" for each in left.values()) + " |")
    print("| *the wanted picture half a pixel to the right* | " + " | ".join(f"{each:.1f}" for each in moved) + " |")
    lc.save(plots.between_plot(curves), folder / "between.png", overwrite=True)
    sheet = np.concatenate(strips).repeat(SCALE, axis=0).repeat(SCALE, axis=1)
    lc.save(sheet, folder / "between-strips.png", overwrite=True)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
