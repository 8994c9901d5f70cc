"""Measure how good reliefs become: the tables of docs/relief.md, in Markdown.

    python benchmarks/relief.py [TABLE ...] [--side N] [--sweeps N]

Photographs that come with scikit-image, as squares, black 0.4 unless said. Light is cast by small steps from 64 points
of every column (the tests' own second implementation), and seen with a blur of one and of two columns; PSNR in display
values. Tables, all unless some are said:

pictures    one to four pictures: near and far, time, and how near the model is
wrong       lamps that stand wrong, solved for one elevation and for three; heights in layers
black       the black level, given and by the law of the floor
height      how high the relief is
mesh        shadows of the mesh's triangles, of every fourth row of columns
local       what the local method takes of photographs

About fifteen minutes on one core.
"""

import argparse
import math
import time
from dataclasses import replace

import numpy as np
import skimage.data
from numpy.typing import NDArray
from tests.helpers.reliefs import cast_by_triangles, marched

import lightcube as lc
from lightcube.optics.transfer import decode
from lightcube.scoring.reliefs import BLURS, OFF_DEG, compared
from lightcube.solids.relief_annealing import light_of
from lightcube.solids.relief_light import shown

NAMES = ("camera", "astronaut", "coins", "chelsea")


def photographs(count: int) -> lc.Pictures:
    """The first so many; of the astronaut the face."""
    images = []
    for name in NAMES[:count]:
        levels = np.atleast_3d(getattr(skimage.data, name)())
        levels = levels[:260, 90:350] if name == "astronaut" else levels
        high, wide = levels.shape[:2]
        side, top, left = min(high, wide), (high - min(high, wide)) // 2, (wide - min(high, wide)) // 2
        square = np.broadcast_to(levels[top : top + side, left : left + side], (side, side, 3))
        images.append(decode(square.astype(np.float32) / 255).astype(np.float32))
    return lc.Pictures(tuple(images), NAMES[:count])


def stepped(relief: lc.Relief) -> NDArray[np.float64]:
    """What the lamps show, by small steps."""
    return np.stack([marched(relief.heights_px, azimuth_deg) for azimuth_deg in relief.azimuths_deg])


def figures(relief: lc.Relief, light: NDArray[np.float64], blur: float) -> tuple[float, float, float]:
    """PSNR, mean and worst, and mean SSIM."""
    psnr, ssim = np.array(compared(relief, light, blur)).T
    return float(psnr.mean()), float(psnr.min()), float(ssim.mean())


def pictures(recipe: lc.ReliefRecipe) -> None:
    print(
        "| pictures | blur 1: mean / worst, SSIM | blur 2: mean / worst, SSIM | model off by, rms | cpu |\n"
        "|---|---|---|---|---|"
    )
    for count in (1, 2, 3, 4):
        begun = time.process_time()
        relief = lc.relief(photographs(count), recipe)
        took, light = time.process_time() - begun, stepped(relief)
        off = math.sqrt(np.mean((light - light_of(relief.heights_px, count)) ** 2))
        near, far = (figures(relief, light, blur) for blur in (BLURS["near"], BLURS["far"]))
        seen = " | ".join(f"{mean:.1f} / {worst:.1f}, {ssim:.3f}" for mean, worst, ssim in (near, far))
        print(f"| {count} | {seen} | {off:.4f} | {took:.1f} s |", flush=True)


def wrong(recipe: lc.ReliefRecipe) -> None:
    print(f"| pictures, tolerance | right | {' | '.join(OFF_DEG)} | layers of 1/4 px |\n|{'---|' * (3 + len(OFF_DEG))}")
    for count in (2, 3, 4):
        for tolerance_deg in (0.0, 3.0):
            relief = lc.relief(photographs(count), replace(recipe, tolerance_deg=tolerance_deg))
            layered = replace(relief, recipe=replace(recipe, layer_mm=recipe.px_mm / 4)).layered()
            cast = [shown(relief), *(shown(relief, off) for off in OFF_DEG.values()), shown(layered)]
            said = " | ".join(f"{figures(relief, light, BLURS['far'])[0]:.2f}" for light in cast)
            print(f"| {count}, {tolerance_deg:g}° | {said} |", flush=True)


def black(recipe: lc.ReliefRecipe) -> None:
    print("| black | blur 1 | blur 2 |\n|---|---|---|")
    for level in (0.1, 0.2, 0.3, 0.4, None, 0.5):
        relief = lc.relief(photographs(4), replace(recipe, black=level))
        near, far = (figures(relief, shown(relief), blur)[0] for blur in (BLURS["near"], BLURS["far"]))
        print(f"| {'auto, ' if level is None else ''}{relief.recipe.black:g} | {near:.1f} | {far:.1f} |", flush=True)


def height(recipe: lc.ReliefRecipe) -> None:
    print("| relief, columns | blur 1 | blur 2 | mean step | steepest |\n|---|---|---|---|---|")
    for high, steepest in ((5.0, math.inf), (10.0, math.inf), (20.0, math.inf), (10.0, 4.0), (10.0, 2.0)):
        relief = lc.relief(photographs(4), replace(recipe, relief_px=high, steepest_px=steepest))
        near, far = (figures(relief, shown(relief), blur)[0] for blur in (BLURS["near"], BLURS["far"]))
        steps = np.abs(np.diff(relief.heights_px, axis=0))
        print(f"| {high:g} | {near:.1f} | {far:.1f} | {steps.mean():.2f} | {steps.max():.1f} |", flush=True)


def mesh(recipe: lc.ReliefRecipe) -> None:
    """Of the lamp to the right: rays of a row of columns meet that row's triangles only."""
    relief = lc.relief(photographs(4), recipe)
    surface, pitch, over = lc.relief_mesh(relief), recipe.pitch_mm, 4
    high = math.radians(recipe.elevation_deg)
    to_lamp, side = np.array([math.cos(high), 0.0, math.sin(high)]), recipe.side
    y = surface.triangles[:, :, 1]
    found = []
    for row in range(0, side, 4):
        back, front = (side - row) * pitch, (side - row - 1) * pitch
        near = lc.Mesh(surface.vertices_mm, surface.faces[(y.min(axis=1) < back) & (y.max(axis=1) > front)])
        places = (np.arange(side * over) + 0.5) / over
        x, down = (each.ravel() for each in np.meshgrid(places, (np.arange(over) + 0.5) / over))
        tops = recipe.base_mm + relief.heights_mm[row, x.astype(int)] + 1e-6
        lit = cast_by_triangles(near, np.stack([x * pitch, back - down * pitch, tops], axis=1), to_lamp)
        found.append(lit.reshape(over, side, over).mean(axis=(0, 2)))
    by_columns = light_of(relief.heights_px, 1)[0]
    light = by_columns.copy()
    light[::4] = found
    off = light[::4] - by_columns[::4]
    print(f"triangles off columns by {math.sqrt(np.mean(off**2)):.4f} rms, on average {off.mean():+.4f}")
    one = lc.Relief(relief.heights_px, relief.wanted[:1], relief.recipe)
    wide = np.array(found).repeat(4, axis=0)  # rows in between as those that were cast
    pair = [
        figures(replace(one, wanted=one.wanted[:, ::4].repeat(4, axis=1)), each[None], 2.0)
        for each in (wide, by_columns[::4].repeat(4, axis=0))
    ]
    print(f"PSNR at blur 2 of the rows: triangles {pair[0][0]:.2f} dB, columns {pair[1][0]:.2f} dB")


def local(recipe: lc.ReliefRecipe) -> None:
    print("| pictures of pixels | relief that they take, columns of shadow |\n|---|---|")
    for pixels in (16, 32, 64, 128):
        try:
            made = lc.relief(
                photographs(2), replace(recipe, method="local", black=None, side=5 * pixels, relief_px=10.0)
            )
            said = f"{made.heights_px.max():.1f}"
        except lc.InputError as refused:
            said = str(refused).split("relief ")[1].split(",")[0]
        print(f"| {pixels} | {said} |", flush=True)


TABLES = {each.__name__: each for each in (pictures, wrong, black, height, mesh, local)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="*", choices=[[], *TABLES], help="default all")
    parser.add_argument("--side", type=int, default=128)
    parser.add_argument("--sweeps", type=int, default=lc.ReliefRecipe().sweeps)
    said = parser.parse_args()
    for name in said.tables or TABLES:
        print(f"\n**{name}**\n")
        TABLES[name](lc.ReliefRecipe(side=said.side, sweeps=said.sweeps, black=0.4))


if __name__ == "__main__":
    main()
