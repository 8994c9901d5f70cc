"""How the time of a pass grows with the cube: n pictures of the whole screen, a colour cube of n voxels a side.

    python benchmarks/growth.py [N ...]

Prints seconds of a pass (forward and adjoint, the least of three) with a level lamp and with one raised by 35 degrees,
and the exponents of n from each row to the next.
"""

import math
import sys
import time

import numpy as np

from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable
from lightcube.optics.views import spread_angles
from lightcube.projection.projector import Projector

SIZES = [64, 96, 128, 192, 256, 300]


def seconds_of_a_pass(n: int, elevation_deg: float, repeats: int = 3) -> float:
    grid = Grid((n, n, n))
    matrix = Projector(
        grid, turntable(grid, spread_angles(n, elevation_deg=elevation_deg), elevation_deg=elevation_deg)
    )
    x = np.random.default_rng(0).random((matrix.shape[1], 3 * n**3 // matrix.shape[1]), dtype=np.float32)
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        matrix.adjoint(matrix.forward(x))
        times.append(time.perf_counter() - began)
    return min(times)


def main() -> None:
    sizes = [int(argument) for argument in sys.argv[1:]] or SIZES
    print("| n | level, s | exponent | 35°, s | exponent |\n|---|---|---|---|---|")
    last: tuple[int, list[float]] | None = None
    for n in sizes:
        found = [seconds_of_a_pass(n, elevation_deg) for elevation_deg in (0.0, 35.0)]
        cells = []
        for index, seconds in enumerate(found):
            grown = "" if last is None else f"{math.log(seconds / last[1][index]) / math.log(n / last[0]):.1f}"
            cells += [f"{seconds:.3g}", grown]
        print("|", " | ".join([str(n), *cells]), "|", flush=True)
        last = n, found


if __name__ == "__main__":
    main()
