"""Measure how good cubes become on stages: tables for people, and one line of JSON per solved cube.

    python benchmarks/stages.py [TABLE ...] [--n N] [--passes P] [--out FILE]

Inputs are fixed: photographs that come with scikit-image. Tables, all of them unless some are named:

presets     the stages of examples/stages as they are, 200 passes
hemisphere  32 photographs half as wide as the cube, P <= 64: one lamp, a few tilts, and lamps all over the hemisphere
points      level pictures all around a point lamp at several distances, against parallel light
soft        a lamp with a size: solved without minding it, and with
starts      sums of lamps, solved from several starts: where they end

Lengths are in voxels and lamps have one power per picture and colour. Seconds are those of the solve alone.
"""

import argparse
import json
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import lightcube as lc
from lightcube.backward.problem import pose
from lightcube.backward.recipe import Recipe
from lightcube.io import read_stage, read_stage_targets
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.pictures import samples
from lightcube.pictures.fitting import fit
from lightcube.solvers import METHODS

Row = dict[str, Any]
EXAMPLES = Path(__file__).parents[1] / "examples" / "stages"


def way(elevation_deg: float, azimuth: float = 0.0) -> NDArray[np.float64]:
    """Direction of light from a lamp so many degrees up."""
    up, round_ = math.radians(elevation_deg), math.radians(azimuth)
    return np.array([math.cos(up) * math.cos(round_), math.cos(up) * math.sin(round_), -math.sin(up)])


def square(name: str, light: NDArray[np.float64], n: int, pixels: int) -> Screen:
    """A screen square to parallel light, 1.5 cube widths behind the middle, with pixels as wide as voxels."""
    x, y, z = 1.5 * n * light
    return Screen(name, (x, y, z), (pixels, pixels), 1.0, normal=(-x, -y, -z))


def tilts(n: int, count: int, elevations_deg: list[float], power: float, *, vertical: bool = False) -> Stage:
    """A turntable whose stops are lit by lamps of several elevations in turn, each with a screen of its own."""
    lamps, screens = [], []
    for number, elevation_deg in enumerate(elevations_deg):
        light = way(elevation_deg)
        lamps.append(Lamp(f"lamp {number}", direction=tuple(light.tolist()), power_max=power))
        screen = square(f"screen {number}", light, n, n // 2)
        screens.append(replace(screen, normal=(-1.0, 0.0, 0.0)) if vertical else screen)
    shots = [Shot(str(p), f"screen {p % len(lamps)}", (f"lamp {p % len(lamps)}",), p) for p in range(count)]
    stops = (np.arange(count) + 0.5) * 360 / count
    return Stage(lc.Grid((n, n, n)), tuple(lamps), tuple(screens), tuple(shots), tuple(stops.tolist()))


def all_over(n: int, count: int, power: float) -> Stage:
    """A lamp for every picture, spread over the hemisphere like a sunflower's seeds, around a fixed cube."""
    height = (np.arange(count) + 0.5) / count
    lights = [way(math.degrees(math.asin(up)), 137.507764 * number) for number, up in enumerate(height)]
    lamps = tuple(Lamp(str(p), direction=tuple(light.tolist()), power_max=power) for p, light in enumerate(lights))
    screens = tuple(square(str(p), light, n, n // 2) for p, light in enumerate(lights))
    shots = tuple(Shot(str(p), str(p), (str(p),)) for p in range(count))
    return Stage(lc.Grid((n, n, n)), lamps, screens, shots, cube_turns=False)


def around(n: int, count: int, columns: int, distance: float, span_deg: float, power: float) -> Stage:
    """Level light from a point so many cube widths off (infinity = parallel), the stops spread over `span_deg`."""
    rows, behind = n // 2, 1.5 * n
    enlarged = 1.0 if math.isinf(distance) else 1 + behind / (distance * n)
    lamp = Lamp("lamp", direction=(1.0, 0.0, 0.0), power_max=power)
    if not math.isinf(distance):
        lamp = Lamp("lamp", position_mm=(-distance * n, 0.0, 0.0), power_max=power)
    screen = Screen("wall", (behind, 0.0, 0.0), (columns * enlarged, rows * enlarged), enlarged)
    stops = lc.spread_angles(count, span_deg)
    shots = tuple(Shot(str(p), "wall", ("lamp",), p) for p in range(count))
    return Stage(lc.Grid((n, n, n)), (lamp,), (screen,), shots, tuple(stops.tolist()))


def targets_on(stage: Stage, pictures: lc.Pictures) -> lc.Targets:
    """Photographs on a stage, one for each shot."""
    return fit(pictures, stage.rig())


def measured(name: str, grid: lc.Grid, targets: lc.Targets, passes: int, **more: Any) -> tuple[Row, lc.Cube]:
    """Solve, and say how good it is and how long it took."""
    began = time.perf_counter()
    solution = lc.solve(targets, grid, Recipe(passes=passes))
    seconds = time.perf_counter() - began
    scores = lc.score(solution.cube, targets)
    figures = {"psnr_mean": scores["psnr_mean"], "psnr_min": scores["psnr_min"], "passes": len(solution.residuals)}
    return {"name": name, **figures, "seconds": seconds, **more}, solution.cube


def presets(n: int, passes: int) -> Iterator[Row]:
    """The examples, whose cubes have the size that they say."""
    for path in sorted(EXAMPLES.glob("*.toml")):
        stage, targets = read_stage_targets(path)
        yield measured(path.stem, stage.grid, targets, passes)[0]


def hemisphere(n: int, passes: int) -> Iterator[Row]:
    """How many lamps or tilts it takes."""
    stages = {
        "one lamp at 35, vertical screen": tilts(n, 32, [35], 64, vertical=True),
        "one lamp at 35": tilts(n, 32, [35], 64),
        "20, 50": tilts(n, 32, [20, 50], 64),
        "10, 35, 60": tilts(n, 32, [10, 35, 60], 64),
        "10, 30, 50, 70": tilts(n, 32, [10, 30, 50, 70], 64),
        "32 lamps all over": all_over(n, 32, 64),
    }
    for name, stage in stages.items():
        yield measured(name, stage.grid, targets_on(stage, samples.photographs(32)), passes)[0]


def points(n: int, passes: int) -> Iterator[Row]:
    """Capacity under level light: load = pictures times their width, in cube widths."""
    for count, part in ((16, 0.25), (16, 0.34), (16, 0.5), (32, 0.25), (32, 0.34)):
        columns = 2 * round(part * n / 2)
        for distance, span_deg in (
            (math.inf, 180.0),
            (math.inf, 360.0),
            (4.0, 360.0),
            (1.5, 360.0),
            (1.0, 360.0),
            (1.5, 180.0),
        ):
            stage = around(n, count, columns, distance, span_deg, 16)
            targets = targets_on(stage, samples.photographs(count, aspect=2 * columns / n))
            said = "parallel" if math.isinf(distance) else f"{distance:g} widths"
            yield measured(f"{count} x {part}, {said}, {span_deg:g}", stage.grid, targets, passes, load=count * part)[0]


def soft(n: int, passes: int) -> Iterator[Row]:
    """What a lamp's size costs, and what comes back where the solver knows of it."""
    for size in (0.5, 1.0, 2.0, 4.0):
        point = tilts(n, 8, [35], 16, vertical=True)
        disc = replace(point, lamps=tuple(replace(lamp, size_deg=size) for lamp in point.lamps))
        pictures = samples.photographs(8)
        true = targets_on(disc, pictures)
        for name, stage in (("not minded", point), ("minded", disc)):
            row, cube = measured(f"{size:g} degrees, {name}", stage.grid, targets_on(stage, pictures), passes)
            shown = lc.score(replace(cube, rig=true.rig), true)
            yield row | {"psnr_mean": shown["psnr_mean"], "psnr_min": shown["psnr_min"]}


def starts(n: int, passes: int) -> Iterator[Row]:
    """Where sums of lamps end from an empty cube, and from random ones."""
    for name in ("coloured-lamps", "fading"):
        stage = read_stage(EXAMPLES / f"{name}.toml")[0]
        coarser = max(stage.grid.shape) / n
        screens = tuple(replace(screen, pitch_mm=screen.pitch_mm * coarser) for screen in stage.screens)
        stage = replace(stage, grid=lc.Grid((n, n, n), stage.grid.voxel_mm * coarser), screens=screens)
        problem = pose(targets_on(stage, samples.photographs(8)), stage.grid, Recipe())
        assert problem.lighting.mixture is not None  # noqa: S101
        lamps = problem.lighting.lamps
        bounds = np.full((lamps, 3), 1e-4), np.full((lamps, 3), float(stage.lamps[0].power_max))
        for seed in range(4):
            random = np.random.default_rng(seed)
            x0 = random.gamma(0.3, 0.1 * seed, (problem.matrix.shape[1], 3)).astype(np.float32)
            began = time.perf_counter()
            result = METHODS["display"].solve(problem.matrix, problem.wanted(bounds), x0=x0, iterations=passes)
            error = 2 * float(result.residuals[-1]) / float(np.sum(problem.weights, dtype=np.float64))
            yield {
                "name": f"{name}, start {seed or 'empty'}",
                "psnr_mean": -10 * math.log10(error),
                "psnr_min": math.nan,
                "passes": len(result.residuals),
                "seconds": time.perf_counter() - began,
            }


TABLES: dict[str, Callable[[int, int], Iterator[Row]]] = {
    "presets": presets,
    "hemisphere": hemisphere,
    "points": points,
    "soft": soft,
    "starts": starts,
}


def main() -> None:
    """Parse, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="*", choices=[[], *TABLES], default=[])
    parser.add_argument("--n", type=int, default=64)
    parser.add_argument("--passes", type=int, default=200)
    parser.add_argument("--out", type=Path, default=Path("out/stages.jsonl"))
    asked = parser.parse_args()
    asked.out.parent.mkdir(parents=True, exist_ok=True)
    for name in asked.tables or TABLES:
        print(f"\n{name}\n\n| | PSNR mean / worst, dB | passes | s |\n|---|---|---|---|")
        for row in TABLES[name](asked.n, asked.passes):
            print(
                f"| {row['name']} | {row['psnr_mean']:.1f} / {row['psnr_min']:.1f} | {row['passes']} "
                f"| {row['seconds']:.0f} |",
                flush=True,
            )
            with asked.out.open("a") as file:
                file.write(json.dumps({"table": name, "n": asked.n, **row}) + "\n")


if __name__ == "__main__":
    main()
