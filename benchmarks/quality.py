"""Measure how good cubes become: tables for people, one line of JSON per solved cube, and the plots of docs/pictures.

    python benchmarks/quality.py [TABLE ...] [--out FOLDER] [--figures FOLDER] [--passes N]

Inputs are fixed: photographs that come with scikit-image, in the crops that `pictures.samples.photographs` states, and
traced scenes. Light is averaged over pixels, in the paper's set-up by thin beams too. Tables, all unless some are said:

literal     the paper's set-up: level, half a turn, pictures as wide as the cube, a lamp of power 1
elevation   how high the lamp should stand
animations  traced scenes of 64 pictures
capacity    PSNR against load: the plots

What has to be reached, holds, mats and defaults are in `light.py`. Every solve has a fixed number of passes at full
size, and ends before where it has converged; the coarser cubes that it starts from cost about 13 passes more. Seconds
are those of the solve alone. Rows that are in FOLDER (out/quality) are not measured again: to measure anew, remove it.
`--passes` allows no solve more passes, for a quick look. About an hour on two cores.
"""

import argparse
import json
import sys
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import lightcube as lc
from lightcube.backward.recipe import Recipe
from lightcube.drawing import plots
from lightcube.optics.light import Beams, Light
from lightcube.pictures import samples
from lightcube.pictures.fitting import fit

Row = dict[str, Any]
PICTURES = Path(__file__).parents[1] / "docs" / "pictures"


@dataclass(frozen=True)
class Problem:
    """One cube to solve; lengths in voxels, angles in degrees."""

    count: int
    columns: int
    rows: int
    elevation_deg: float
    #: Largest lamp power; None is the paper's fixed lamp of power 1.
    lamp_max: float | None
    passes: int
    n: int = 64
    method: str = "display"
    #: Photographs, or the name of a scene.
    pictures: str = "photographs"
    light: Beams = "area"


@dataclass(frozen=True)
class Curve:
    """A curve of a capacity plot: sixteen photographs in a 64-cube, unless it says otherwise, of several widths."""

    label: str
    lamp_max: int
    widths: tuple[int, ...]
    count: int = 16
    n: int = 64

    def problems(self, raised: float) -> list[Problem]:
        """Square pictures under a raised lamp, pictures as high as the cube under a level one."""
        passes = 100 if raised else 120
        return [
            Problem(self.count, width, width if raised else self.n, raised, self.lamp_max, passes, self.n)
            for width in self.widths
        ]


def paper(pictures: str, count: int) -> Problem:
    """The paper's own method in its own set-up."""
    return Problem(count, 64, 64, 0, None, 100, method="gauss-seidel", pictures=pictures)


ELEVATIONS = (10, 20, 25, 30, 35, 40, 45, 50)
TABLES: dict[str, list[Problem]] = {
    "literal": [
        problem
        for own in (paper("photographs", 16), paper("photographs", 32), paper("photographs", 64), paper("gems", 64))
        for problem in (own, replace(own, method="display", light="thin"), replace(own, method="display"))
    ],
    "elevation": [Problem(16, 32, rows, raised, 16, 80) for rows in (32, 56) for raised in ELEVATIONS],
    "animations": [
        Problem(64, 64, 64, 0, 16, 100, pictures="gems"),
        *(
            Problem(64, side, side, raised, 16, 100, pictures="juggler")
            for raised, sides in ((0, (16, 24, 32, 48)), (35, (16, 24, 32, 40)))
            for side in sides
        ),
    ],
}
WIDTHS, SIDES = (16, 22, 32, 40, 48, 64), (24, 32, 40, 48, 56, 64)
#: File, elevation, and the curves of the capacity plots.
PLOTS: list[tuple[str, float, list[Curve]]] = [
    (
        "capacity.png",
        0,
        [
            *(Curve(f"lamp power up to {power}", power, WIDTHS) for power in (16, 4, 1)),
            Curve("up to 16, 32 pictures", 16, (11, 16, 24, 32), count=32),
            Curve("up to 16, n = 32", 16, (11, 16, 24, 32), n=32),
            Curve("up to 16, n = 128", 16, (64,), n=128),
        ],
    ),
    (
        "capacity-raised.png",
        35,
        [
            *(Curve(f"lamp power up to {power}", power, SIDES) for power in (16, 4, 1)),
            Curve("up to 16, 32 pictures", 16, (17, 24, 32, 40), count=32),
            Curve("up to 16, n = 32", 16, (12, 16, 20, 24), n=32),
            Curve("up to 16, n = 128", 16, (64,), n=128),
        ],
    ),
]
TABLES["capacity"] = [problem for _, raised, curves in PLOTS for curve in curves for problem in curve.problems(raised)]


def targets_of_problem(problem: Problem) -> tuple[lc.Targets, lc.Grid]:
    grid = lc.Grid((problem.n,) * 3, voxel_mm=100 / problem.n)
    angles_deg = lc.spread_angles(problem.count, elevation_deg=problem.elevation_deg)
    shape = (problem.rows, problem.columns)
    lamp: dict[str, Any] = {"power": 1.0} if problem.lamp_max is None else {"power_max": float(problem.lamp_max)}
    rig = lc.turntable(grid, angles_deg, elevation_deg=problem.elevation_deg, picture_shape=shape, **lamp)
    if problem.pictures == "photographs":
        return fit(samples.photographs(problem.count, problem.columns / problem.rows), rig), grid
    return lc.scene_targets(lc.read_scene(problem.pictures), rig, grid), grid


def measure(problem: Problem) -> Row:
    """Solve a problem and score it."""
    targets, grid = targets_of_problem(problem)
    thin = problem.light == "thin" or problem.method != "display"
    recipe = Recipe(method=problem.method, passes=problem.passes, light=Light.thin() if thin else None)
    began = time.perf_counter()
    solution = lc.solve(targets, grid, recipe)
    row: Row = {"seconds": time.perf_counter() - began}
    scores = lc.score(solution.cube, targets)
    row |= {name: scores[name] for name in ("psnr_mean", "psnr_min", "ssim_mean", "delta_e_mean", "thin_psnr_mean")}
    row |= {"done": len(solution.residuals), "rejected": len(solution.rejected) / targets.pictures.size or None}
    row |= solution.optimality or {}
    return row


class Runs:
    """What was measured, in a file of one line of JSON per cube; what is missing is measured when it is asked for."""

    def __init__(self, folder: Path, most_passes: int | None) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder, self.file, self.most_passes = folder, folder / "runs.jsonl", most_passes
        lines = self.file.read_text().splitlines() if self.file.exists() else []
        self.known = {Problem(**line["problem"]): line for line in map(json.loads, lines)}

    def __call__(self, problem: Problem) -> Row:
        if self.most_passes is not None:
            problem = replace(problem, passes=min(problem.passes or self.most_passes, self.most_passes))
        if problem not in self.known:
            figures = measure(problem)
            self.known[problem] = {"problem": asdict(problem), **figures}
            with self.file.open("a") as stream:
                stream.write(json.dumps(self.known[problem]) + "\n")
            print(
                f"  {problem}: {figures['psnr_mean']:.1f} dB, {figures['seconds']:.0f} s", file=sys.stderr, flush=True
            )
        row = self.known[problem]["problem"] | self.known[problem]
        return row | {"lamp": "= 1" if row["lamp_max"] is None else f"≤ {row['lamp_max']:g}"}


#: Columns of the printed tables. A cell whose figure is missing is empty; a column of empty cells is left out.
COLUMNS = {
    "pictures": "{count} {pictures} {columns} × {rows}",
    "n": "{n}",
    "elevation": "{elevation_deg:g}°",
    "method": "{method}",
    "light": "{light}",
    "lamp": "{lamp}",
    "mean dB": "{psnr_mean:.1f}",
    "worst dB": "{psnr_min:.1f}",
    "by thin beams": "{thin_psnr_mean:.1f}",
    "SSIM": "{ssim_mean:.3f}",
    "ΔE2000": "{delta_e_mean:.2f}",
    "thrown out": "{rejected:.0%}",
    "passes": "{done}",
    "seconds": "{seconds:.1f}",
    "objective": "{objective:.3g}",
    "bound": "{lower_bound:.3g}",
    "dB left at most": "{left_db:.1f}",
}


def cell(row: Row, text: str) -> str:
    try:
        return text.format_map({name: value for name, value in row.items() if value not in (None, "display", "area")})
    except KeyError:
        return ""


def print_table(title: str, rows: list[Row]) -> None:
    columns = [(name, texts) for name, text in COLUMNS.items() if any(texts := [cell(row, text) for row in rows])]
    print(f"\n## {title}\n\n| " + " | ".join(name for name, _ in columns) + " |")
    print("|---" * len(columns) + "|")
    for cells in zip(*(texts for _, texts in columns), strict=True):
        print("| " + " | ".join(cells) + " |")
    sys.stdout.flush()


def points(run: "Runs", curve: Curve, raised: float) -> list[tuple[float, float]]:
    """Load, as `planning.consistency.load`, and mean PSNR of each width; level pictures are as high as the cube."""
    rows = [run(problem) for problem in curve.problems(raised)]
    return [(row["count"] * row["columns"] * row["rows"] / row["n"] ** 2, row["psnr_mean"]) for row in rows]


def capacity_plot(run: "Runs", curves: list[Curve], raised: float) -> Any:
    """Sixteen photographs in a 64-cube as curves, all else as points."""
    main = [curve for curve in curves if (curve.count, curve.n) == (16, 64)]
    others = {curve.label: points(run, curve, raised) for curve in curves if curve not in main}
    return plots.capacity_plot({c.lamp_max: points(run, c, raised) for c in main}, others, elevation_deg=raised)


def main() -> None:
    parser = argparse.ArgumentParser(description="Measure how good cubes become.")
    parser.add_argument("tables", nargs="*", choices=TABLES, default=list(TABLES), help="default: all")
    parser.add_argument("--out", type=Path, default=Path("out/quality"), help="folder for what was measured")
    parser.add_argument("--figures", type=Path, default=PICTURES, help="folder for the plots")
    parser.add_argument("--passes", type=int, help="no solve has more")
    given = parser.parse_args()
    for elevation_deg in (0.0, 35.0):  # what numba compiled is loaded before anything is timed
        measure(Problem(2, 4, 4, elevation_deg, 16, 1, n=8))
    run = Runs(given.out, given.passes)
    for name in given.tables:
        rows = [run(problem) for problem in TABLES[name]]
        print_table(name, rows)
        if name == "capacity":
            for file, raised, curves in PLOTS:
                lc.save(capacity_plot(run, curves, raised), given.figures / file, overwrite=True)


if __name__ == "__main__":
    main()
