"""What a resin's haze does to pictures, and what it helps to know of it: the figures of docs/haze.md.

Twelve of the bundled photographs, 24 x 24 pixels of a voxel of 1 mm, in 40 x 40 x 40 voxels under a lamp raised by 35
degrees. Unscattered light is cast exactly: scattering takes from it as absorbing does. The veil is taken as even, so
large a part of all light as volpath of Mitsuba 3 found for such cubes with a screen 120 mm behind.
"""

import argparse
import json
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import lightcube as lc
from lightcube.optics.haze import VEILS
from lightcube.optics.transfer import encode
from lightcube.pictures.samples import photographs

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


def figures(n: int, count: int, rows: int) -> Iterator[dict[str, float | str]]:
    grid = lc.Grid((n, n, n), 40 / n)
    pictures = photographs(count)
    rig = lc.turntable(grid, lc.spread_angles(count, 360.0), elevation_deg=35.0, picture_shape=(rows, rows))
    targets = lc.fit(pictures, rig)
    unaware = solved(targets, grid, 0.0)
    wanted = targets.pictures
    for (phase, scattering), part in VEILS.items():
        hazy = replace(unaware, extinction=unaware.extinction + np.float32(scattering))
        shown = veiled(np.stack(list(lc.cast(hazy))), part)
        knowing = veiled(np.stack(list(lc.cast(solved(targets, grid, scattering)))), part)
        yield {
            "phase": phase,
            "scattering_per_mm": scattering,
            "veil": part,
            "without": psnr(np.stack(list(lc.cast(unaware))), wanted),
            "as_is": psnr(shown, wanted),
            "readjusted": psnr(readjusted(shown, wanted), wanted),
            "loss_known": psnr(readjusted(knowing, wanted), wanted),
        }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=40, help="voxels along a side, of 40 mm")
    parser.add_argument("--count", type=int, default=12, help="photographs")
    parser.add_argument("--rows", type=int, default=24, help="of each, and columns")
    given = parser.parse_args()
    for row in figures(given.n, given.count, given.rows):
        print(
            json.dumps({name: round(value, 3) if isinstance(value, float) else value for name, value in row.items()}),
            flush=True,
        )


if __name__ == "__main__":
    main()
