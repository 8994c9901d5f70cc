"""Measure how good cubes become: tables for people, one line of JSON per solved cube, and the plots of docs/pictures.

    python benchmarks/quality.py [TABLE ...] [--out FOLDER] [--figures FOLDER] [--passes N]

Inputs are fixed: photographs that come with scikit-image, in the crops that `pictures.samples.photographs` states, and
traced scenes. Tables, all of them unless some are named:

must        what has to be reached, with the paper's own method and set-up as the first figure
default     sixteen photographs by the command line with all its defaults, n = 300
literal     the paper's set-up: level, half a turn, pictures as wide as the cube, a lamp of power 1
hold        what it costs that pictures stand over a range of angles
elevation   how high the lamp should stand
animations  traced scenes of 64 pictures
capacity    PSNR against load: the plots

Every solve has a fixed number of passes at full size, and ends before where it has converged; the coarser cubes that
it starts from cost about 13 passes more. Seconds are those of the solve alone. Rows that are in FOLDER (out/quality)
are not measured again: to measure anew, remove it. `--passes` allows no solve more passes, for a quick look. About a
quarter of an hour on two cores.
"""

import argparse
import json
import subprocess
import sys
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from PIL import Image

import lightcube as lc
from lightcube.backward.recipe import Recipe
from lightcube.drawing import plots
from lightcube.optics.transfer import encode, to_uint8
from lightcube.pictures import samples
from lightcube.pictures.fitting import fit
from lightcube.planning.order import best_order
from lightcube.scoring.metrics import psnr

Row = dict[str, Any]
PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
COMMAND_LINE = "command line"


@dataclass(frozen=True)
class Problem:
    """One cube to solve; lengths in voxels, angles in degrees."""

    count: int
    columns: int
    rows: int
    elevation_deg: float
    #: Largest lamp power; None is the paper's fixed lamp of power 1.
    lamp_max: float | None
    #: At most so many; 0 is the command line's own number.
    passes: int
    n: int = 64
    hold_deg: float | None = None
    order: str = "given"
    method: str = "display"
    #: Photographs, or the name of a scene.
    pictures: str = "photographs"


class Entry(NamedTuple):
    """A row of a table: what to solve, and what has to be reached, in dB and in seconds."""

    problem: Problem
    target: float | None = None
    limit: float | None = None


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


#: Count, columns, rows, elevation, order, passes, seconds allowed, and the target of each largest lamp power.
MUST: list[tuple[int, int, int, float, str, int, float | None, dict[float, float | None]]] = [
    (16, 32, 32, 35, "given", 200, 15, {4: 52, 16: 57}),
    (16, 32, 56, 45, "given", 200, 25, {4: 32, 16: 41, 64: 47}),
    (32, 32, 32, 35, "given", 200, 40, {16: 26.5, 64: None}),
    (32, 32, 32, 35, "best", 200, 40, {16: 32.5, 64: None}),
    (64, 32, 32, 35, "best", 200, None, {16: 22.5, 64: None}),
    (16, 16, 64, 0, "given", 400, 10, {4: 48, 16: 55}),
    (16, 16, 64, 0, "best", 400, None, {4: 48}),
    (16, 22, 64, 0, "given", 400, 15, {4: 30.5, 16: 36, 64: 41}),
    (16, 32, 64, 0, "given", 400, 20, {4: 23, 16: 25.6, 64: 28.2, 1024: 33.2}),
    (32, 32, 64, 0, "given", 400, 40, {64: 21.3, 1024: 23.9}),
]
ELEVATIONS = (10, 20, 25, 30, 35, 40, 45, 50)
TABLES: dict[str, list[Entry]] = {
    "must": [
        Entry(Problem(count, columns, rows, raised, power, passes, order=order), target, limit)
        for count, columns, rows, raised, order, passes, limit, targets in MUST
        for power, target in targets.items()
    ],
    "default": [Entry(Problem(16, 0, 0, 0, None, 0, 300, method=COMMAND_LINE), 42, 360)],
    "literal": [
        Entry(problem)
        for own in (paper("photographs", 16), paper("photographs", 32), paper("photographs", 64), paper("gems", 64))
        for problem in (own, replace(own, method="display"))
    ],
    "hold_deg": [
        Entry(Problem(8, 22, 64, 0, 4, 200, hold_deg=1.5), 42),
        Entry(Problem(8, 22, 64, 0, 64, 250, hold_deg=3), 41),
        Entry(Problem(8, 32, 32, 35, 16, 150, hold_deg=1.5)),
        Entry(Problem(8, 32, 32, 35, 16, 150, hold_deg=3)),
        Entry(Problem(8, 32, 32, 35, 16, 250, hold_deg=6), 39),
        Entry(Problem(8, 32, 32, 35, 16, 100, hold_deg=12)),
        Entry(Problem(8, 32, 32, 35, 16, 60, hold_deg=22.5)),
        *(Entry(Problem(16, 32, 32, 35, 16, 150, hold_deg=degrees)) for degrees in (0.375, 0.75, 1.5, 3)),
    ],
    "elevation_deg": [
        *(
            Entry(Problem(16, 32, rows, raised, power, 80))
            for rows in (32, 56)
            for power in (4, 16)
            for raised in ELEVATIONS
        ),
        *(Entry(Problem(16, 64, 64, raised, 4, 80, 128)) for raised in (25, 35, 45)),
    ],
    "animations": [
        Entry(Problem(64, 64, 64, 0, 16, 150, pictures="gems"), 45),
        *(
            Entry(Problem(64, side, side, raised, power, 150, pictures="juggler"))
            for raised, power, sides in ((0, 16, (16, 24, 32, 48)), (0, 64, (16, 32)), (35, 16, (16, 24, 32, 40)))
            for side in sides
        ),
        *(Entry(Problem(64, 32, 32, raised, 16, 150, pictures="juggler")) for raised in (20, 45)),
    ],
}
WIDTHS, SIDES = (8, 12, 16, 18, 20, 22, 26, 32, 48, 64), (16, 24, 28, 32, 36, 40, 48, 64)
#: File, elevation, and the curves of the capacity plots.
PLOTS: list[tuple[str, float, list[Curve]]] = [
    (
        "capacity.png",
        0,
        [
            *(Curve(f"lamp power up to {power}", power, WIDTHS) for power in (64, 16, 4, 1)),
            Curve("up to 16, 32 pictures", 16, (4, 8, 10, 12, 16, 32), count=32),
            Curve("up to 16, n = 32", 16, (4, 6, 8, 10, 12, 16, 32), n=32),
            Curve("up to 16, n = 128", 16, (16, 32, 40, 48), n=128),
        ],
    ),
    (
        "capacity-raised.png",
        35,
        [
            *(Curve(f"lamp power up to {power}", power, SIDES) for power in (16, 4, 1)),
            Curve("up to 16, 32 pictures", 16, (16, 20, 24, 28, 32, 40), count=32),
            Curve("up to 16, n = 32", 16, (8, 12, 16, 20, 24, 32), n=32),
            Curve("up to 16, n = 128", 16, (48, 64), n=128),
        ],
    ),
]
TABLES["capacity"] = [
    Entry(problem) for _, raised, curves in PLOTS for curve in curves for problem in curve.problems(raised)
]


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
    row: Row = {}
    if problem.order == "best":
        began = time.perf_counter()
        targets = best_order(targets, grid)(targets)
        row["order_seconds"] = time.perf_counter() - began
    recipe = Recipe(method=problem.method, hold_deg=problem.hold_deg or 0.0, passes=problem.passes)
    began = time.perf_counter()
    solution = lc.solve(targets, grid, recipe)
    row["seconds"] = time.perf_counter() - began
    scores = lc.score(solution.cube, targets)
    row |= {name: scores[name] for name in ("psnr_mean", "psnr_min", "ssim_mean", "delta_e_mean")}
    row |= {"done": len(solution.residuals), "rejected": len(solution.rejected) / targets.pictures.size or None}
    row |= solution.optimality or {}
    if problem.hold_deg:
        row |= over_the_hold(solution.cube, targets, problem.hold_deg)
    return row


def over_the_hold(cube: lc.Cube, targets: lc.Targets, degrees: float) -> Row:
    """The least mean over the pictures, and the worst picture, at every tenth of a degree of the held range."""
    wanted = encode(targets.pictures, targets.transfer)
    each = np.array(
        [
            [
                psnr(encode(shown, targets.transfer), *pair)
                for shown, *pair in zip(
                    lc.play(cube, cube.angles_deg + offset, picture_only=True), wanted, targets.weight, strict=True
                )
            ]
            for offset in np.append(np.arange(-degrees, degrees - 1e-9, 0.1), degrees)
        ]
    )
    return {"held_min": float(each.mean(axis=1).min()), "held_worst": float(each.min())}


def by_command_line(problem: Problem, folder: Path) -> Row:
    """Solve photographs as someone does who has never read the manual: a folder, a name, and --n."""
    folder.mkdir(parents=True, exist_ok=True)
    photos = samples.photographs(problem.count)
    for number, (name, image) in enumerate(zip(photos.names, photos.images, strict=True)):
        Image.fromarray(to_uint8(image)).save(folder / f"{number:02}-{name}.png")
    made = folder.with_suffix(".zarr")
    command = [Path(sys.executable).with_name("lightcube"), "solve", folder, "-o", made, "--n", problem.n]
    options = ["--json", "--overwrite", *(["--iterations", problem.passes] if problem.passes else [])]
    words = [str(word) for word in (*command, *options)]
    said = subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True)  # noqa: S603 - our own words
    result = json.loads(said.stdout.splitlines()[-1])
    cube = lc.load(made)
    rows, columns = cube.rig.picture_shape
    return {
        **{name: result[name] for name in ("psnr_mean", "psnr_min", "ssim_mean", "delta_e_mean", "seconds")},
        "done": result["iterations"],
        **result["optimality"],
        "elevation_deg": float(cube.rig.views.elevations_deg[0]),
        "columns": columns,
        "rows": rows,
        "lamp_max": cube.provenance.get("lamp_max"),
        "hold_deg": cube.hold_deg or None,
    }


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
            by_hand = problem.method != COMMAND_LINE
            figures = measure(problem) if by_hand else by_command_line(problem, self.folder / "photographs")
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
    "elevation_deg": "{elevation:g}°",
    "order": "{order}",
    "method": "{method}",
    "lamp": "{lamp}",
    "hold_deg": "± {hold:g}°",
    "the paper": "{paper:.1f}",
    "target": "{target:.1f}",
    "mean dB": "{psnr_mean:.1f}",
    "worst dB": "{psnr_min:.1f}",
    "least mean in hold": "{held_min:.1f}",
    "worst in hold": "{held_worst:.1f}",
    "SSIM": "{ssim_mean:.3f}",
    "ΔE2000": "{delta_e_mean:.2f}",
    "thrown out": "{rejected:.0%}",
    "passes": "{done}",
    "seconds": "{seconds:.1f}",
    "allowed": "{limit:.0f}",
    "ordering s": "{order_seconds:.1f}",
    "objective": "{objective:.3g}",
    "bound": "{lower_bound:.3g}",
    "dB left at most": "{left_db:.1f}",
}


def cell(row: Row, text: str) -> str:
    try:
        return text.format_map({name: value for name, value in row.items() if value not in (None, "given", "display")})
    except KeyError:
        return ""


def print_table(title: str, rows: list[Row]) -> None:
    columns = [(name, texts) for name, text in COLUMNS.items() if any(texts := [cell(row, text) for row in rows])]
    print(f"\n## {title}\n\n| " + " | ".join(name for name, _ in columns) + " |")
    print("|---" * len(columns) + "|")
    for cells in zip(*(texts for _, texts in columns), strict=True):
        print("| " + " | ".join(cells) + " |")
    sys.stdout.flush()


def say_best_elevation(rows: list[Row]) -> None:
    for n in sorted({row["n"] for row in rows}):
        means = {
            raised: np.mean([row["psnr_mean"] for row in rows if (row["n"], row["elevation_deg"]) == (n, raised)])
            for raised in sorted({row["elevation_deg"] for row in rows if row["n"] == n})
        }
        said = ", ".join(f"{raised:g}° {mean:.1f}" for raised, mean in means.items())
        print(f"\nn = {n}, mean of all rows: {said} dB; best: {max(means, key=lambda raised: means[raised]):g}°")


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
        rows = []
        for problem, target, limit in TABLES[name]:
            row = run(problem) | {"target": target, "limit": limit}
            if name == "must":
                row["paper"] = run(paper(problem.pictures, problem.count))["psnr_mean"]
            rows.append(row)
        print_table(name, rows)
        if name == "elevation_deg":
            say_best_elevation(rows)
        if name == "capacity":
            for file, raised, curves in PLOTS:
                lc.save(capacity_plot(run, curves, raised), given.figures / file, overwrite=True)


if __name__ == "__main__":
    main()
