"""What a cube casts when it is made of films: its slices as they are, films solved for themselves, and their pages.

    python benchmarks/thinning.py [--n 64] [--pictures 16] [--films 16 32 64] [--points 13 50]

Photographs half as wide as the cube, 35 degrees, 60 passes. The columns: films, points a pixel that are solved for, the
cube itself, its slices as they are, films solved for themselves (mean and worst PSNR, dB), the same judged at 233
points, not at the usual 55, what the exported pages cast, seconds.
"""

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

import lightcube as lc
from lightcube.fabrication import thinning
from lightcube.optics import light
from lightcube.pictures.fitting import targets_of
from lightcube.pictures.samples import photographs
from lightcube.scoring.metrics import score

#: Points of a pixel that films are judged at once more.
_FINE = 233


def main() -> None:
    """Print a row for each number of films and points."""
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("--n", type=int, default=64)
    asked.add_argument("--pictures", type=int, default=16)
    asked.add_argument("--films", type=int, nargs="+", default=[16, 32, 64])
    asked.add_argument("--points", type=int, nargs="+", default=[13, 50])
    said = asked.parse_args()
    cube = solved(said.n, said.pictures)
    own = score(cube, targets_of(cube))["psnr_mean"]
    print("| films | points | cube | slices | films solved | worst | finely judged | pages | s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for points in said.points:
        thinning._POINTS = points
        for films in said.films:
            print(row(cube, films, points, own), flush=True)


def solved(n: int, pictures: int) -> lc.Cube:
    """A cube of photographs."""
    grid = lc.Grid((n, n, n), 100 / n)
    angles_deg = lc.spread_angles(pictures, elevation_deg=35)
    rig = lc.turntable(grid, angles_deg, elevation_deg=35, picture_shape=(n // 2, n // 2), power_max=16.0)
    return lc.solve(lc.fit(photographs(pictures), rig), grid, lc.Recipe(passes=60)).cube


def row(cube: lc.Cube, films: int, points: int, own: float) -> str:
    """A row of the table."""
    began = time.monotonic()
    made = lc.as_films(cube, films)
    seconds = time.monotonic() - began
    fine = judged(made)
    with tempfile.TemporaryDirectory() as folder:
        pages = lc.export(made, Path(folder) / "prints.pdf", "film")["predicted"]["psnr_mean"]
    figures = (own, made.provenance["psnr_of_slices"], made.scores["psnr_mean"], made.scores["psnr_min"], fine, pages)
    return f"| {films} | {points} | {' | '.join(f'{each:.1f}' for each in figures)} | {seconds:.0f} |"


def judged(made: lc.Cube) -> float:
    """Mean PSNR at more points."""
    usual, light.JUDGE = light.JUDGE, _FINE
    light.lattice.cache_clear()
    found = float(np.mean(score(made, targets_of(made))["psnr_mean"]))
    light.JUDGE = usual
    light.lattice.cache_clear()
    return found


if __name__ == "__main__":
    main()
