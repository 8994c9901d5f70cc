"""Measure what dyes cost and what solving for them gains: tables of docs/materials.md, and its pictures.

    python benchmarks/materials.py [dyes] [gain] [pictures]

dyes        a cube of 32 voxels a side, 20 mm wide, eight of the bundled photographs of 16 x 16 pixels, lamps at 35
            degrees: solved without dyes and converted afterwards, and solved for amounts of them
gain        the same cube as 32 clear films: an ink-jet printer whose dots grow, with and without its calibration
pictures    docs/pictures/materials-*.png, from the first table

All light is averaged over pixels and judged at the judge's points; 200 passes, nothing around the pictures asked for.
"""

import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import lightcube as lc
from lightcube.calibration.finding import Readings
from lightcube.calibration.fitting import fit_inks
from lightcube.calibration.wedge import Wedge, page
from lightcube.optics.dyes import Dyes, monotone
from lightcube.optics.gamut import nearest, out_of_reach
from lightcube.optics.transfer import encode, to_uint8
from lightcube.pictures import samples

GRID = lc.Grid((32, 32, 32), 20 / 32)
COUNT, SIDE, PASSES = 8, 16, 200
PICTURES = Path(__file__).parents[1] / "docs" / "pictures"


def targets() -> lc.Targets:
    angles = lc.spread_angles(COUNT, elevation_deg=35)
    return lc.fit(samples.photographs(COUNT), lc.turntable(GRID, angles, elevation_deg=35, picture_shape=(SIDE, SIDE)))


WANTED = targets()


def solved(material: lc.Material) -> lc.Cube:
    return lc.solve(WANTED, GRID, lc.Recipe(material=material, passes=PASSES)).cube


def of(cube: lc.Cube, dyes: Dyes, amounts: Any) -> lc.Cube:
    """The same set-up with other amounts of dyes, whatever their limits."""
    return replace(cube, extinction=dyes.in_block(GRID).mixed(amounts), amounts=None, dyes=None)


def relit(cube: lc.Cube) -> lc.Cube:
    """The same glass under the lamps that suit each of its pictures and colours best, coarsely and then finely."""
    bare = np.stack(list(lc.cast(replace(cube, lamp_powers=np.ones_like(cube.powers)))))
    best = np.ones_like(cube.powers)
    for tried in (np.geomspace(1e-3, 16, 400), np.linspace(0.97, 1.03, 121)):
        powers = tried[:, None, None] * best
        shown = encode(np.maximum(bare * powers[:, :, None, None], 0))
        off = np.mean((shown - encode(WANTED.pictures)) ** 2, axis=(2, 3))  # (power, picture, colour)
        best = np.take_along_axis(powers, np.argmin(off, axis=0)[None], axis=0)[0]
    return replace(cube, lamp_powers=best)


def said(what: str, cube: lc.Cube) -> None:
    kept, anew = (lc.score(each, WANTED) for each in (cube, relit(cube)))
    figures = " | ".join(f"{each['psnr_mean']:.1f} / {each['psnr_min']:.1f}" for each in (kept, anew))
    print(f"| {what} | {figures} |", flush=True)


def dyes_table() -> Iterator[tuple[str, lc.Cube]]:
    """Yield a cube for each row, and print it."""
    print("| | PSNR mean / worst, lamps as solved | lamps found anew |\n|---|---|---|")
    free = solved(lc.Material(12.0))
    said("any colours, up to 12/mm", free)
    yield "free", free
    resins = lc.read_dyes("polyjet")
    three = Dyes(resins.names[:3], resins.extinction[:3], base=resins.base)
    for name, dyes in {"CMYK resins": resins, "CMY resins": three, "CMY filaments": lc.read_dyes("pla")}.items():
        found = out_of_reach(free.extinction, dyes)
        converted = of(free, dyes, nearest(free.extinction, dyes))
        said(f"converted to {name} ({found.voxels:.0%} of the voxels, {found.extinction:.0%} out of reach)", converted)
        yield f"{name} converted", converted
        began = time.perf_counter()
        cube = solved(lc.Material(dyes=dyes))
        said(f"**solved for {name}**, {time.perf_counter() - began:.1f} s", cube)
        yield f"{name} solved", cube


def gain_table() -> None:
    """Films whose ink spreads by a tenth at half coverage."""
    at = np.linspace(0, 1, 16)
    inks = replace(
        lc.read_dyes("cmyk-film"), base=np.zeros(3), gain=(np.stack([at, at + 0.4 * at * (1 - at)], axis=1),) * 4
    )
    cube = solved(lc.Material(dyes=inks))
    fitted = {noise: fit_inks(readings(inks, noise)).dyes for noise in (0.01, 0.003)}
    rows = {
        "as solved": cube.amounts,
        "coverages of 8 bits, no dot gain": printed(replace(inks, gain=()), replace(inks, gain=()), cube.amounts),
        "dot gain, known exactly": printed(inks, inks, cube.amounts),
        "dot gain, not allowed for": printed(inks, replace(inks, gain=()), cube.amounts),
    }
    rows |= {
        f"dot gain, calibrated by a photograph with noise of {noise:.1%}": printed(inks, known, cube.amounts)
        for noise, known in fitted.items()
    }
    print("| | PSNR mean / worst, lamps as solved | lamps found anew |\n|---|---|---|")
    for what, amounts in rows.items():
        said(what, of(cube, inks, amounts))


def printed(printer: Dyes, known: Dyes, amounts: Any) -> Any:
    """Amounts that a printer lays down which is sent what known inks make of those that are wanted, in 8 bits."""
    sent = np.rint(255 * known.coverage(amounts)) / 255
    return printer.amount(sent).astype(np.float32)


def readings(inks: Dyes, noise: float) -> Readings:
    """A printed wedge, with such noise in each of a patch's 700 pixels."""
    wedge, random = Wedge(inks.names), np.random.default_rng(0)
    light = []
    for patch in wedge.patches:
        gains = [monotone(curve) for curve in inks.gain if curve is not None]
        covered = np.array([np.interp(part, *gain) for part, gain in zip(patch.coverages, gains, strict=True)])
        light.append(np.prod(1 + covered[:, None] * np.expm1(-inks.extinction), axis=0))
    off = noise / np.sqrt(700) * random.standard_normal((len(light), 3))
    return Readings(wedge, wedge.patches, np.array(light) + off, inks.base, [])


def draw(cubes: dict[str, lc.Cube]) -> None:
    """Wanted, converted, and solved for, four pictures each; and the page of patches."""
    rows = [WANTED.pictures]
    rows += [np.stack(list(lc.cast(relit(cubes[f"CMYK resins {how}"])))) for how in ("converted", "solved")]
    strip = np.concatenate([np.concatenate(list(to_uint8(np.clip(row[:6], 0, 1), "srgb")), axis=1) for row in rows])
    zoomed = Image.fromarray(strip).resize((strip.shape[1] * 8, strip.shape[0] * 8), Image.Resampling.NEAREST)
    zoomed.save(PICTURES / "materials-solved.png", optimize=True)
    Image.fromarray(page(Wedge(("cyan", "magenta", "yellow", "black")), 72)).save(
        PICTURES / "materials-wedge.png", optimize=True
    )


if __name__ == "__main__":
    asked = sys.argv[1:] or ["dyes", "gain", "pictures"]
    if {"dyes", "pictures"} & set(asked):
        made = dict(dyes_table())
    if "gain" in asked:
        gain_table()
    if "pictures" in asked:
        draw(made)
