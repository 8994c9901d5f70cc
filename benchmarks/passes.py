"""Time the passes of a solve: of thin beams, of areas, and of all else that the defaults ask for; docs/performance.md.

    python benchmarks/passes.py [N ...] [--frames N]

Sixteen photographs half as wide as the cube, 35 degrees, from a clear cube, with all points from the first pass on: the
median of some passes. With `--frames`, as many shadows of the gems as the cube has voxels a side, level and as wide as
the cube, instead, with four points side by side. Multiply-adds of the two products of a pass are counted where no pixel
is left out, and compared with what one run of the same machine adds up from L2.
"""

import argparse
import time
from collections.abc import Iterator
from statistics import median

import numpy as np

import lightcube as lc
from lightcube.backward.job import Job
from lightcube.backward.problem import Problem, pose
from lightcube.bench.limits import ceilings
from lightcube.bench.products import multiply_adds
from lightcube.kernels import tasks
from lightcube.pictures import samples
from lightcube.solvers.contract import Progress

PASSES = 9


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


def photographs(n: int) -> Iterator[tuple[str, lc.Targets, lc.Grid, lc.Recipe]]:
    """Sixteen photographs, and what is asked for."""
    grid = lc.Grid((n, n, n), 100 / n)
    angles_deg = lc.spread_angles(16, elevation_deg=35)
    rig = lc.turntable(grid, angles_deg, elevation_deg=35, picture_shape=(n // 2, n // 2), power_max=16.0)
    targets = lc.fit(samples.photographs(16), rig)
    for name, recipe in recipes(n).items():
        yield name, targets, grid, recipe


def frames(n: int) -> Iterator[tuple[str, lc.Targets, lc.Grid, lc.Recipe]]:
    """So many level shadows of the gems, n x n pixels, by thin beams and by areas."""
    grid = lc.Grid((n, n, n), 100 / n)
    rig = lc.turntable(grid, lc.spread_angles(n), picture_shape=(n, n), power_max=16.0)
    targets = lc.scene_targets(lc.read_scene("gems"), rig, grid)
    yield "thin beams", targets, grid, lc.Recipe(light=lc.Light.thin())
    yield "areas, 4 points", targets, grid, lc.Recipe(light=lc.Light(row_points=4))


def seconds_a_pass(problem: Problem, targets: lc.Targets, grid: lc.Grid, recipe: lc.Recipe) -> float:
    """The median of some passes of the solver, without what is looked at in between."""
    times: list[float] = []

    def watch(_: Progress) -> None:
        times.append(time.perf_counter())

    wanted = problem.wanted(Job(targets, grid, recipe).lamp_bounds)
    recipe.solver.solve(problem.matrix, wanted, bounds=(0.0, np.inf), iterations=PASSES, callback=watch)
    return median(np.diff(times))


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("sides", nargs="*", type=int, default=[], metavar="N", help="voxels a side, of photographs")
    parser.add_argument("--frames", type=int, metavar="N", help="voxels a side, of as many frames")
    said = parser.parse_args()
    count = tasks.threads()
    most = ceilings(count, 0.3, 3)["l2"]
    print(f"{count} threads, {most / 1e9:.1f} G multiply-adds a second from L2\n")
    print("| n | asked for | beams | s a pass | of thin | multiply-adds | of the rate from L2 |")
    print("|---|---|---|---|---|---|---|")
    sides = said.sides or ([] if said.frames else [64, 128])
    jobs = [(n, photographs(n)) for n in sides] + ([(said.frames, frames(said.frames))] if said.frames else [])
    for n, asked in jobs:
        thin = 0.0
        for name, targets, grid, recipe in asked:
            problem = pose(targets, grid, recipe)
            took = seconds_a_pass(problem, targets, grid, recipe)
            thin = thin or took
            cells = [str(n), name, f"{problem.matrix.shape[0]:,}", f"{took:.3f}", f"{took / thin:.1f}"]
            made = 2 * multiply_adds(problem.matrix) if np.all(problem.weights > 0) else 0
            cells += [f"{made / 1e9:.2f} G", f"{made / took / most:.0%}"] if made else ["", ""]
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
