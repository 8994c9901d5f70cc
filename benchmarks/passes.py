"""Time the passes of a solve: of thin beams, of areas, and of all else that the defaults ask for; docs/performance.md.

    python benchmarks/passes.py [N ...]

Sixteen photographs half as wide as the cube, 35 degrees, from a clear cube, with all points from the first pass on: the
Sixteen photographs half as wide as the cube, 35 degrees, from a clear cube, with all points from the first pass: the
of the two products of a pass are counted where no pixel is left out, and compared with what one run of the same machine
adds up from L2.
"""

import argparse
import time
from dataclasses import replace
from statistics import median

import numpy as np

import lightcube as lc
from lightcube.backward.pieces import Step
from lightcube.backward.problem import pose
from lightcube.bench.limits import ceilings
from lightcube.bench.products import multiply_adds
from lightcube.kernels import tasks
from lightcube.pictures import samples

PASSES = 14


def recipes(n: int) -> dict[str, lc.Recipe]:
    """What is asked for, each time more."""
    hold_deg = 0.25 * 64 / n
    grain = lc.Light(grain=0.01)
    return {
        "thin beams": lc.Recipe(light=lc.Light.thin()),
        "areas, 13 points": lc.Recipe(),
        "and a mat": lc.Recipe(mat=lc.Mat(beyond=0)),
        "held": lc.Recipe(mat=lc.Mat(beyond=0), hold_deg=hold_deg),
        "with grain": lc.Recipe(mat=lc.Mat(beyond=0), hold_deg=hold_deg, light=grain),
        "and all the shadow: the defaults": lc.Recipe(mat=lc.Mat(), hold_deg=hold_deg, light=grain),
    }


def seconds_a_pass(targets: lc.Targets, grid: lc.Grid, recipe: lc.Recipe) -> float:
    """The median of the passes of one solve."""
    times: list[float] = []

    def watch(_: Step) -> None:
        times.append(time.perf_counter())

    clear = lc.Cube(np.zeros((3, *grid.shape), np.float32), grid, targets.rig)
    lc.solve(targets, grid, replace(recipe, passes=PASSES), start=clear, callback=watch)
    return median(np.diff(times))


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("sides", nargs="*", type=int, default=[64, 128], metavar="N", help="voxels a side")
    sides = parser.parse_args().sides
    count = tasks.threads()
    most = ceilings(count, 0.3, 3)["l2"]
    print(f"{count} threads, {most / 1e9:.1f} G multiply-adds a second from L2\n")
    print("| n | asked for | beams | s a pass | of thin | multiply-adds | of the rate from L2 |")
    print("|---|---|---|---|---|---|---|")
    for n in sides:
        grid = lc.Grid((n, n, n), 100 / n)
        angles_deg = lc.spread_angles(16, elevation_deg=35)
        rig = lc.turntable(grid, angles_deg, elevation_deg=35, picture_shape=(n // 2, n // 2), power_max=16.0)
        targets, thin = lc.fit(samples.photographs(16), rig), 0.0
        for name, recipe in recipes(n).items():
            problem = pose(targets, grid, recipe)
            took = seconds_a_pass(targets, grid, recipe)
            thin = thin or took
            cells = [str(n), name, f"{problem.matrix.shape[0]:,}", f"{took:.3f}", f"{took / thin:.1f}"]
            made = 2 * multiply_adds(problem.matrix) if np.all(problem.weights > 0) else 0
            cells += [f"{made / 1e9:.2f} G", f"{made / took / most:.0%}"] if made else ["", ""]
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
