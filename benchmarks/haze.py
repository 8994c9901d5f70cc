"""What a resin's haze, or a veil, does to pictures, and what it helps to know of it: the figures of docs/haze.md.

Twelve of the bundled photographs, 24 x 24 pixels of a voxel of 1 mm, in 40 x 40 x 40 voxels under a lamp raised by 35
degrees. Unscattered light is cast exactly: scattering takes from it as absorbing does. The veil is taken as even, so
large a part of all light as volpath of Mitsuba 3 found for such cubes with a screen 120 mm behind.
"""

import argparse
import json
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import chain

import numpy as np
from numpy.typing import NDArray
from PIL import Image

import lightcube as lc
from lightcube.optics.haze import MEASURED_MM, VEILS
from lightcube.optics.transfer import encode
from lightcube.pictures.samples import photographs

#: Even light that is laid over the wall, as parts of the lamp's.
EVEN = (0.0003, 0.001, 0.003, 0.01, 0.03)
#: Powers that are tried where lamps are readjusted, as parts of those that were solved for.
GAINS = np.exp(np.linspace(-4, 4, 401))


def psnr(shown: NDArray[np.floating], wanted: NDArray[np.floating]) -> float:
    """Mean over the pictures, dB."""
    squares = np.mean((encode(shown) - encode(wanted)) ** 2, axis=(1, 2, 3))
    return float(np.mean(-10 * np.log10(squares)))


def readjusted(shown: NDArray[np.floating], wanted: NDArray[np.floating]) -> NDArray[np.floating]:
    """The same under the lamps that suit each picture and colour best."""
    off = [np.mean((encode(gain * shown) - encode(wanted)) ** 2, axis=(1, 2)) for gain in GAINS]
    return GAINS[np.argmin(off, axis=0)][:, None, None, :] * shown


def veiled(shown: NDArray[np.floating], part: float) -> NDArray[np.floating]:
    """With an even veil that is such a part of all light, of each picture and colour."""
    return shown + part / (1 - part) * shown.mean(axis=(1, 2), keepdims=True)


def solved(targets: lc.Targets, grid: lc.Grid, clear: float) -> lc.Cube:
    recipe = lc.Recipe.of_quality("normal", material=lc.Material(3.0, "voxel", clear=clear))
    return lc.solve(targets, grid, recipe).cube


def asked(n: int, count: int, rows: int) -> tuple[lc.Targets, lc.Grid]:
    """The photographs, and 40 mm of voxels."""
    grid = lc.Grid((n, n, n), MEASURED_MM / n)
    rig = lc.turntable(grid, lc.spread_angles(count, 360.0), elevation_deg=35.0, picture_shape=(rows, rows))
    return lc.fit(photographs(count), rig), grid


def shown(cube: lc.Cube, loss: float, part: float) -> NDArray[np.floating]:
    """What a cube casts through haze that takes so much of the light, 1/mm, beside what the cube holds of it."""
    hazy = replace(cube, extinction=cube.extinction + np.float32(loss))
    return veiled(np.stack(list(lc.cast(hazy))), part)


def figures(targets: lc.Targets, grid: lc.Grid) -> Iterator[dict[str, float | str]]:
    """A line for each haze, without any first."""
    wanted, unaware = targets.pictures, solved(targets, grid, 0.0)
    yield {"without": psnr(shown(unaware, 0.0, 0.0), wanted)}
    for (phase, scattering), part in VEILS.items():
        now = shown(unaware, scattering, part)
        known = shown(solved(targets, grid, scattering), 0.0, part)
        yield {
            "phase": phase,
            "scattering_per_mm": scattering,
            "veil": part,
            "as_is": psnr(now, wanted),
            "readjusted": psnr(readjusted(now, wanted), wanted),
            "loss_known": psnr(readjusted(known, wanted), wanted),
        }


def under(targets: lc.Targets, veil: float) -> lc.Targets:
    """The same pictures, wanted under a veil."""
    fading = replace(targets.rig.fading, veil=np.full(len(targets.rig.views), veil))
    return replace(targets, rig=replace(targets.rig, fading=fading))


def veils(targets: lc.Targets, grid: lc.Grid) -> Iterator[dict[str, float]]:
    """A line for each veil."""
    wanted, unaware = targets.pictures, solved(targets, grid, 0.0)
    for veil in EVEN:
        asked_for = under(targets, veil)
        now = shown(replace(unaware, rig=asked_for.rig), 0.0, 0.0)
        known = solved(asked_for, grid, 0.0)
        yield {
            "veil": veil,
            "as_is": psnr(now, wanted),
            "readjusted": psnr(readjusted(now, wanted), wanted),
            "known": psnr(shown(known, 0.0, 0.0), wanted),
            "power_before": float(np.median(unaware.powers)),
            "power_known": float(np.median(known.powers)),
        }


def draw_veil(targets: lc.Targets, grid: lc.Grid, place: str) -> None:
    """One picture as it is wanted, under two veils that nobody knew of, and each known."""
    wanted, unaware = targets.pictures, solved(targets, grid, 0.0)
    columns = [wanted]
    for veil in (0.003, 0.03):
        asked_for = under(targets, veil)
        columns.append(readjusted(shown(replace(unaware, rig=asked_for.rig), 0.0, 0.0), wanted))
        columns.append(shown(solved(asked_for, grid, 0.0), 0.0, 0.0))
    keep(columns, place)


def draw_haze(targets: lc.Targets, grid: lc.Grid, place: str) -> None:
    """One picture as it is wanted, through haze nobody knew of, known, and through two that throw light ahead."""
    wanted, unaware = targets.pictures, solved(targets, grid, 0.0)
    scattering, ahead = 0.02, (0.01, 0.05)
    columns = [
        wanted,
        readjusted(shown(unaware, scattering, VEILS["isotropic", scattering]), wanted),
        readjusted(shown(solved(targets, grid, scattering), 0.0, VEILS["isotropic", scattering]), wanted),
        *(readjusted(shown(unaware, each, VEILS["forward", each]), wanted) for each in ahead),
    ]
    keep(columns, place)


def keep(columns: list[NDArray[np.floating]], place: str, number: int = 2) -> None:
    """One of the pictures of each column, side by side, each pixel 8 wide."""
    small = [encode(np.clip(column[number], 0, 1)) for column in columns]
    rows = [np.pad(picture, ((0, 0), (1, 1), (0, 0)), constant_values=1.0) for picture in small]
    levels = np.rint(255 * np.concatenate(rows, axis=1)).astype(np.uint8)
    Image.fromarray(levels.repeat(8, axis=0).repeat(8, axis=1)).save(place)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=40, help="voxels along a side, of 40 mm")
    parser.add_argument("--count", type=int, default=12, help="photographs")
    parser.add_argument("--rows", type=int, default=24, help="of each, and columns")
    parser.add_argument("--picture", help="write docs/pictures/haze.png, or veil.png, instead of measuring")
    given = parser.parse_args()
    targets, grid = asked(given.n, given.count, given.rows)
    if given.picture is not None:
        (draw_veil if "veil" in given.picture else draw_haze)(targets, grid, given.picture)
        return
    rows: Iterator[Mapping[str, float | str]] = chain(figures(targets, grid), veils(targets, grid))
    for row in rows:
        rounded = {name: value if isinstance(value, str) else round(value, 4) for name, value in row.items()}
        print(json.dumps(rounded), flush=True)


if __name__ == "__main__":
    main()
