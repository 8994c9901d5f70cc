"""Measure how well cubes show their pictures, fit the law of `planning.prediction` to it, and say how far off it is.

    python benchmarks/prediction.py

Solves some eighty random problems (photographs with random crops, saturated and grey ones, traced scenes; level and
raised lamps, 4 to 64 pictures of many shapes, cubes that are wider or higher, every kind of lamp, masks, holds; 32 to
128 voxels wide) as `solve` does by default, those with mats held as it holds them, and rehearses them. Even cases are
what the law is fitted on. Odd ones have photographs of other originals, and tell its error: the median, what 90 % keep
below, and the largest, in dB, means and worst pictures above 50 counting as 50. About an hour with one thread, which
`NUMBA_NUM_THREADS=1` gives. What was measured is kept in out/prediction/, and is not measured again.
"""

import json
import math
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import skimage.data
from numpy.typing import NDArray
from scipy.optimize import minimize

from lightcube import io
from lightcube.backward.mat import Mat
from lightcube.backward.recipe import Recipe
from lightcube.backward.solving import solve
from lightcube.forward.casting import cast
from lightcube.optics.grid import Grid, dense_step_deg, raster_shape
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import decode, encode
from lightcube.optics.views import spread_angles
from lightcube.pictures.fitting import fit
from lightcube.pictures.pictures import Pictures
from lightcube.pictures.targets import Targets
from lightcube.planning.plan import GRAIN, SMOOTH_DB
from lightcube.planning.prediction import AREA, MOST_DB, Rehearsal, law, predict, rehearse
from lightcube.scene.tracer import scene_targets
from lightcube.scoring.metrics import psnr

OUT = Path("out/prediction")
#: Photographs of even and of odd cases.
ORIGINALS: tuple[tuple[Callable[[], Any], ...], ...] = (
    (
        skimage.data.astronaut,
        skimage.data.coffee,
        skimage.data.brick,
        skimage.data.rocket,
        skimage.data.immunohistochemistry,
        skimage.data.coins,
        skimage.data.hubble_deep_field,
        skimage.data.gravel,
        skimage.data.text,
        lambda: skimage.data.stereo_motorcycle()[0],
    ),
    (
        skimage.data.chelsea,
        skimage.data.moon,
        skimage.data.clock,
        skimage.data.retina,
        skimage.data.camera,
        skimage.data.grass,
        skimage.data.colorwheel,
        skimage.data.cell,
        skimage.data.page,
        skimage.data.microaneurysms,
    ),
)
SCENES = ("juggler", "carousel", "bloom", "gems")
Rng = np.random.Generator


class Case(NamedTuple):
    """One problem; lengths in voxels, angles in degrees."""

    seed: int
    shape: tuple[int, int, int]
    views: int
    elevation_deg: float
    picture: tuple[int, int]
    #: ``photo``, ``saturated``, ``gray``, or the name of a scene.
    style: str
    #: Or ``"fixed"``, at power 1.
    powers: str
    lamp_max: float
    #: Only a disc in the middle of the pictures counts.
    disc: bool
    #: Photographs are put next to similar ones.
    tour: bool
    hold_deg: float
    #: Pictures are framed by a dark mat.
    mat: bool

    @property
    def recipe(self) -> Recipe:
        """How it is solved."""
        powers = "per-picture" if self.powers == "fixed" else self.powers
        return Recipe.of_quality("normal", powers=powers, hold_deg=self.hold_deg, mat=Mat() if self.mat else None)

    @property
    def lamp(self) -> dict[str, float]:
        """Its power, or the largest one."""
        return {"power": 1.0} if self.powers == "fixed" else {"power_max": self.lamp_max}


def case(seed: int, sizes: tuple[int, ...], *, held: bool = False) -> Case:
    """A random problem; its load is spread evenly over what is between trivial and hopeless."""
    rng = np.random.default_rng([seed, 77])
    n = int(rng.choice(sizes)) if len(sizes) > 1 else sizes[0]
    level = bool(rng.random() < 0.35)
    elevation_deg = 0.0 if level else float(rng.choice([20, 25, 30, 35, 35, 40, 45]))
    views = int(rng.choice([8, 8, 12, 16] if held else [4, 6, 8, 11, 16, 16, 24, 32, 48, 64]))
    aspect = math.exp(rng.uniform(math.log(0.5), math.log(1.6)))
    nz = round(n * float(rng.choice([1, 1, 1, 0.6, 1.3])))
    ny, nx = n, round(n * float(rng.choice([1, 1, 1, 0.8])))
    if rng.random() < 0.5:
        ny, nx = nx, ny
    style = str(rng.choice(["photo", "photo", "photo", "saturated", "gray"]))
    lamp_max = float(rng.choice([1, 4, 16, 16, 16, 64]))
    kind = int(rng.integers(8))
    powers = "per-picture" if kind < 6 else ("shared", "fixed")[kind - 6]
    load = math.exp(rng.uniform(math.log(1.5 if held else 2.5), math.log(6 if held else 14)))
    disc, tour = bool(rng.random() < 0.16), bool(rng.random() < 0.2)
    width = load * math.sqrt(nx * ny) / views if level else math.sqrt(load * nx * ny * nz / n / views * aspect)
    width = min(max(width, 0.12 * ny), 1.25 * ny)
    high = nz if level and rng.random() < 0.6 else width / aspect
    most = raster_shape(Grid((nz, ny, nx)), elevation_deg)
    picture = even_with(high, nz, most[0] if elevation_deg else nz), even_with(width, ny, most[1])
    hold_deg = float(min(rng.choice([0.5, 1.5, 3]), (180 if level else 360) / views / 2)) if held else 0.0
    if not held and rng.random() < 0.22:
        style, tour = str(rng.choice(SCENES)), False
    mat = bool(rng.random() < 0.5)
    if mat and not held:
        hold_deg = min(dense_step_deg(Grid((nz, ny, nx))) / 2, (180 if level else 360) / views / 2)
    return Case(seed, (nz, ny, nx), views, elevation_deg, picture, style, powers, lamp_max, disc, tour, hold_deg, mat)


def even_with(value: float, parity: int, most: int) -> int:
    """Whole number nearest to `value` that is even or odd like `parity`, from 1 to `most`."""
    odd = parity % 2
    return min(max(2 * round((value - odd) / 2) + odd, 2 - odd), most)


def targets_of_case(problem: Case) -> tuple[Targets, Grid]:
    """The pictures of a case, and its cube."""
    grid = Grid(problem.shape)
    rows, columns = problem.picture
    angles_deg = spread_angles(problem.views, elevation_deg=problem.elevation_deg)
    lamp: dict[str, Any] = dict(problem.lamp)
    rig = turntable(grid, angles_deg, elevation_deg=problem.elevation_deg, picture_shape=problem.picture, **lamp)
    if problem.style in SCENES:
        pictures = scene_targets(io.read_scene(problem.style), rig, grid).pictures
    else:
        crops = photographs(problem, np.random.default_rng([problem.seed, 78]))
        names = tuple(str(index) for index in range(len(crops)))
        pictures = fit(Pictures(tuple(tour(crops) if problem.tour else crops), names), rig).pictures
    weights = np.ones(pictures.shape[:3], np.float32)
    if problem.disc:
        y, x = (np.linspace(-1 + 1 / count, 1 - 1 / count, count) for count in (rows, columns))
        weights[:, y[:, None] ** 2 + x**2 > 1] = 0
    return Targets(pictures, rig, weights), grid


def photographs(problem: Case, rng: Rng) -> list[NDArray[np.float32]]:
    """Random parts of photographs, in linear light."""
    originals = ORIGINALS[problem.seed % 2]
    aspect = problem.picture[1] / problem.picture[0]
    rounds = math.ceil(problem.views / len(originals))
    crops = []
    for chosen in np.concatenate([rng.permutation(len(originals)) for _ in range(rounds)])[: problem.views]:
        original = np.atleast_3d(originals[chosen]())[..., :3].astype(np.float32) / 255
        high, wide = original.shape[:2]
        side = min(high, wide / aspect) * rng.uniform(0.35, 1.0)
        rows, columns = min(max(int(side), 16), high), min(max(int(side * aspect), 16), wide)
        top, left = rng.integers(0, high - rows + 1), rng.integers(0, wide - columns + 1)
        part = np.repeat(original, 3 // original.shape[2], axis=2)[top : top + rows, left : left + columns]
        crops.append(decode(styled(part[:, :: int(rng.choice([-1, 1]))], problem.style, rng)))
    return crops


def styled(picture: NDArray[Any], style: str, rng: Rng) -> NDArray[np.float32]:
    """A photograph in display values as it is, grey, or with strong colours; grey ones are tinted."""
    grey = picture.mean(axis=2, keepdims=True)
    if style == "gray":
        picture = np.repeat(grey, 3, axis=2)
    elif style == "saturated" and np.ptp(picture - grey) < 0.05:
        picture = picture * 2 * rng.dirichlet([0.6, 0.6, 0.6])
    elif style == "saturated":
        picture = grey + 2.5 * (picture - grey)
    if style == "saturated":
        picture = np.clip(1.4 * (picture - 0.5) + 0.45, 0, 1)
    return np.ascontiguousarray(picture, np.float32)


def tour(pictures: list[NDArray[np.float32]]) -> list[NDArray[np.float32]]:
    """The pictures one after the other, each followed by the most similar of those that are left, at 4 x 4 pixels."""
    rig = turntable(Grid((4, 4, 4)), np.arange(len(pictures)), picture_shape=(4, 4))
    names = tuple("" for _ in pictures)
    small = encode(fit(Pictures(tuple(pictures), names), rig, "stretch").pictures)
    path, left = [0], set(range(1, len(pictures)))
    while left:
        path.append(min(left, key=lambda other: float(np.sum((small[other] - small[path[-1]]) ** 2))))
        left.remove(path[-1])
    return [pictures[index] for index in path]


def kept(problems: list[Case]) -> list[list[float]]:
    """What `measured` says of each problem: from out/prediction/ where an earlier run has kept it there."""
    OUT.mkdir(parents=True, exist_ok=True)
    file = OUT / "measured.jsonl"
    lines = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
    known: dict[str, list[float]] = {json.dumps(line["case"]): line["psnr"] for line in lines}
    with file.open("a") as stream:
        for problem in problems:
            key = json.dumps(problem)
            if key not in known:
                began = time.monotonic()
                known[key] = measured(problem)
                stream.write(json.dumps({"case": problem, "psnr": known[key]}) + "\n")
                stream.flush()
                print(f"{problem}: {np.mean(known[key]):.1f} dB, {time.monotonic() - began:.0f} s", flush=True)
    return [known[json.dumps(problem)] for problem in problems]


def measured(problem: Case) -> list[float]:
    """PSNR of each picture of a case that is solved for real."""
    targets, grid = targets_of_case(problem)
    cube = solve(targets, grid, smoothed(targets, grid, problem.recipe)).cube
    shown = cast(cube)
    pairs = zip(shown, targets.pictures, targets.weight, strict=True)
    return [round(psnr(encode(picture), encode(wanted), weight), 3) for picture, wanted, weight in pairs]


def smoothed(targets: Targets, grid: Grid, recipe: Recipe) -> Recipe:
    """The recipe with the grain that a plan gives it."""
    if predict(targets, grid, recipe).psnr_mean < SMOOTH_DB:
        return recipe
    return replace(recipe, light=replace(recipe.beams, grain=GRAIN))


class Rehearsed(NamedTuple):
    """A case and its rehearsal: PSNR of its pictures in the real cube and in the `ratio` times narrower one."""

    case: Case
    wanted: NDArray[np.float64]
    reached: NDArray[np.float64]
    ratio: float


def rehearsed(problem: Case, wanted: list[float]) -> Rehearsed:
    """Rehearse a case that was measured."""
    targets, grid = targets_of_case(problem)
    reached, width = rehearse(targets, grid, problem.recipe)
    return Rehearsed(problem, np.array(wanted), reached, max(grid.shape[1:]) / width)


def told_of(one: Rehearsed, by: Rehearsal) -> NDArray[np.float64]:
    """What the law says of a case's pictures."""
    return law(one.reached, one.ratio, by, level=one.case.elevation_deg == 0, enough_db=one.case.recipe.enough_db)


def errors(cases: list[Rehearsed], by: Rehearsal, part: Callable[[Any], Any]) -> NDArray[np.float64]:
    """How far the law is off for means, or worst pictures; what is above 50 dB in both does not count."""
    wanted = np.array([min(float(part(one.wanted)), MOST_DB) for one in cases])
    told = np.array([min(float(part(told_of(one, by))), MOST_DB) for one in cases])
    return np.asarray((told - wanted)[np.minimum(told, wanted) < MOST_DB])


def fitted(cases: list[Rehearsed]) -> Rehearsal:
    """The law of least absolute errors of means and worst pictures together."""

    def cost(law_of: NDArray[np.float64]) -> float:
        by = AREA._replace(bias=law_of[0], growth=law_of[1], level=law_of[2])
        return float(sum(np.mean(np.hypot(errors(cases, by, part), 0.5)) for part in (np.mean, np.min)))

    found = minimize(cost, (AREA.bias, AREA.growth, AREA.level), method="Nelder-Mead")
    return AREA._replace(bias=found.x[0], growth=found.x[1], level=found.x[2])


def report(title: str, cases: list[Rehearsed]) -> None:
    """Print how far the law in use is off."""
    for name, part in (("mean", np.mean), ("worst", np.min)):
        error = errors(cases, AREA, part)
        if len(error):
            size = np.abs(error)
            print(
                f"{title:>28} {name:>6} {len(error):>5} {np.mean(error):>+7.2f} {np.median(size):>7.2f} "
                f"{np.quantile(size, 0.9):>6.2f} {np.max(size):>6.2f} {np.mean(size <= 3):>6.0%}"
            )


def misses(cases: list[Rehearsed]) -> None:
    """Name the cases whose means are told wrong by more than 3 dB."""
    for one in cases:
        wanted, told = float(np.mean(one.wanted)), float(np.mean(told_of(one, AREA)))
        if abs(min(told, MOST_DB) - min(wanted, MOST_DB)) > 3:
            print(f"missed: {told:.1f} dB told, {wanted:.1f} came of {one.case}")


def main() -> None:
    problems = cases()
    results = [rehearsed(*each) for each in zip(problems, kept(problems), strict=True)]
    best = fitted([one for one in results if one.case.seed % 2 == 0])
    print(f"\nfitted on even cases: {best}\nin use: {AREA}\n")
    print(f"{'PSNR, dB':>28} {'':>6} {'cases':>5} {'bias':>7} {'median':>7} {'90 %':>6} {'max':>6} {'<= 3':>6}")
    for parity, name in enumerate(("fitted on", "other pictures")):
        chosen = [one for one in results if one.case.seed % 2 == parity]
        for group in ("32 to 64", "96, 128", "held"):
            report(f"{name}, {group}", [one for one in chosen if group_of(one.case) == group])
        report(f"{name}, all", chosen)
    misses(results)


def group_of(problem: Case) -> str:
    if problem.hold_deg:
        return "held"
    return "96, 128" if max(problem.shape[1:]) > 64 else "32 to 64"


def cases() -> list[Case]:
    """All problems: larger ones, some with a hold, and many small ones."""
    return [
        *(case(seed, (32,)) for seed in range(60, 66)),
        *(case(seed, (48,)) for seed in range(20)),
        *(case(seed, (48,), held=True) for seed in range(400, 408)),
        *(case(seed, (64,)) for seed in range(20, 40)),
        *(case(seed, (48,)) for seed in range(40, 60)),
        *(case(seed, (96,)) for seed in range(200, 204)),
        *(case(seed, (128,)) for seed in range(300, 302)),
    ]


if __name__ == "__main__":
    main()
