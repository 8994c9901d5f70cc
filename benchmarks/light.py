"""Measure what a wall shows: tables of docs/light.md for people, and one line of JSON per cube.

    python benchmarks/light.py [TABLE ...] [--out FOLDER] [--set bundled|other]

All light is averaged over pixels and judged at the judge's points (`lightcube.optics.light`). Pictures are the bundled
photographs, or 32 others: crops of Middlebury's motorcycle (scikit-image, CC0), of the Navy's portrait of Grace Hopper
(matplotlib, public domain), and faces of `skimage.data.lfw_subset` (no known copyright restrictions). Tables:

must        sixteen to sixty-four pictures of many shapes, quality best
hold        pictures that stand over a range of angles, the least PSNR within it
mat         pictures in a dark mat, and held
tilts       lamps of one, two and three elevations in turn, and screens square to the light; n = 32
starts      from smaller cubes, a clear one, and random ones; n = 32
beyond      how much the rest of the shadow counts, beyond the mat
points      points of a pixel, and the judge against 32 x 32 beams
means       means of light at few points, and of absorbance with its curvature; in how many pieces a pixel's light is
grain       how much points weigh beside a pixel's mean: pictures alone, and with mats and held
scenes      traced scenes: the juggler under a raised lamp, gems under a level one
pixel       pixels of one voxel and of 2 x 2, alike and as many
default     sixteen pictures with all defaults, n = 64 and 128
large       the same, n = 300
play        how far whole screens, and parts of pixels, are off means of very many beams

Rows that are in FOLDER (out/light) are not measured again. Seconds are those of the solve alone, with kernels warm.
"""

import argparse
import json
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import skimage.data
from matplotlib.cbook import get_sample_data
from numpy.typing import NDArray
from PIL import Image

import lightcube as lc
from lightcube.optics.light import JUDGE, judge_points, lattice
from lightcube.optics.transfer import decode, encode
from lightcube.pictures import samples
from lightcube.pictures.arranging import spread_over_screen
from lightcube.planning.order import best_order
from lightcube.planning.plan import plan
from lightcube.scoring.metrics import psnr

Row = dict[str, Any]
BEST = lc.Recipe.of_quality("best")


def pictures(which: str, count: int, aspect: float) -> lc.Pictures:
    """As many of a set as asked for, cut to an aspect; of the others, which are 32, halves of them beyond."""
    return samples.photographs(count, aspect) if which == "bundled" else others(count, aspect)


def others(count: int, aspect: float) -> lc.Pictures:
    """Parts of other pictures than the bundled ones, always the same."""
    rng = np.random.default_rng(11)
    hopper = np.asarray(Image.open(get_sample_data("grace_hopper.jpg", asfileobj=False)).convert("RGB"))
    motorcycle, faces = skimage.data.stereo_motorcycle()[0], skimage.data.lfw_subset()
    found: list[NDArray[np.float32]] = []
    for number in range(count):
        kind = number % 4
        if kind == 3:
            image = np.repeat(faces[number % 100][..., None] * 255, 3, axis=2)
        else:
            original = hopper if kind == 1 else motorcycle
            high, wide = original.shape[:2]
            side = min(high, wide / aspect) * rng.uniform(0.3, 0.8)
            rows, columns = int(side), int(side * aspect)
            top, left = rng.integers(0, high - rows), rng.integers(0, wide - columns)
            image = original[top : top + rows, left : left + columns]
        found.append(np.ascontiguousarray(decode(np.asarray(image, np.float32) / 255), np.float32))
    return lc.Pictures(tuple(found), tuple(f"other-{number + 1}" for number in range(count)))


def cube_for(
    which: str,
    count: int,
    columns: int,
    rows: int,
    elevation_deg: float,
    *,
    n: int = 64,
    power: float = 16.0,
    pixel: int = 1,
) -> tuple[lc.Targets, lc.Grid]:
    """Pictures of so many pixels, and the cube for them."""
    grid = lc.Grid((n, n, n), 100 / n)
    rig = lc.turntable(
        grid,
        lc.spread_angles(count, elevation_deg=elevation_deg),
        elevation_deg=elevation_deg,
        picture_shape=(rows, columns),
        pixel=pixel,
        power_max=power,
    )
    return lc.fit(pictures(which, count, columns / rows), rig), grid


def measured(
    targets: lc.Targets, grid: lc.Grid, recipe: lc.Recipe, start: lc.Cube | None = None
) -> tuple[Row, lc.Cube]:
    """Solve, and say how good it is by area, how long it took and how many passes."""
    began = time.perf_counter()
    solution = lc.solve(targets, grid, recipe, start=start)
    seconds = time.perf_counter() - began
    scores = lc.score(solution.cube, targets)
    names = ("psnr_mean", "psnr_min", "thin_psnr_mean", "grain_rms", "mat_rms", "beyond_rms")
    figures = {name: scores[name] for name in names if name in scores}
    return {**figures, "passes": len(solution.residuals), "seconds": seconds}, solution.cube


def solved(asked: tuple[str, int, int, int, float], power: float, recipe: lc.Recipe) -> Row:
    """Figures of a cube for pictures that `cube_for` takes."""
    return measured(*cube_for(*asked, power=power), recipe)[0]


def must(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """What has to be reached."""
    shapes = {
        "16 of 32 x 32, 35, P 4": (16, 32, 32, 35, 4),
        "16 of 32 x 32, 35": (16, 32, 32, 35, 16),
        "16 of 32 x 56, 45": (16, 32, 56, 45, 16),
        "16 of 48 x 48, 35": (16, 48, 48, 35, 16),
        "32 of 32 x 32, 35": (32, 32, 32, 35, 16),
        "16 of 22 x 64, level": (16, 22, 64, 0, 16),
        "16 of 32 x 64, level": (16, 32, 64, 0, 16),
    }
    for name, (count, columns, rows, elevation_deg, power) in shapes.items():
        asked = which, count, columns, rows, elevation_deg
        yield name, partial(solved, asked, power, BEST)
    for name, count, shift in (
        ("32 of 32 x 32, order best", 32, 0),
        ("32 of 32 x 32, order best, shift 8", 32, 8),
        ("64 of 32 x 32, order best, shift 8", 64, 8),
    ):
        yield name, partial(arranged, which, count, shift)


def arranged(which: str, count: int, shift: int) -> Row:
    """Pictures in their best order, some pixels up, down or aside."""
    targets, grid = cube_for(which, count, 32, 32, 35)
    if shift:
        targets = replace(targets, rig=targets.rig.shifted(spread_over_screen(targets, grid, shift)))
    return measured(best_order(targets, grid)(targets), grid, BEST)[0]


def hold(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """The least PSNR at nine angles within the hold."""
    for name, count, degrees in (("16, 0.25", 16, 0.25), ("16, 1", 16, 1.0), ("8, 3", 8, 3.0)):
        yield f"{name} degrees", partial(within, which, count, degrees)


def within(which: str, count: int, degrees: float) -> Row:
    """A held cube, at its stops and at the worst angle of its hold."""
    targets, grid = cube_for(which, count, 32, 32, 35)
    row, cube = measured(targets, grid, lc.Recipe.of_quality("best", hold_deg=degrees, light=lc.Light(21, 9)))
    means = []
    for off in np.linspace(-degrees, degrees, 9):
        pairs = zip(lc.cast(cube, cube.rig.turned(off)), targets.pictures, targets.weight, strict=True)
        means.append(float(np.mean([psnr(encode(shown), encode(wanted), weight) for shown, wanted, weight in pairs])))
    return row | {"least": min(means)}


def mat(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """A mat of 12 pixels on each side."""
    light = lc.Light(21, 9)
    for name, recipe in {
        "dark": lc.Recipe(passes=150, light=light, mat=lc.Mat()),
        "dark, held 0.25 degrees": lc.Recipe(passes=150, light=light, mat=lc.Mat(), hold_deg=0.25),
        "grey": lc.Recipe(passes=150, light=light, mat=lc.Mat(0.25)),
        "none": lc.Recipe(passes=150, light=light),
    }.items():
        yield name, partial(solved, (which, 16, 32, 32, 35), 16.0, recipe)


def beyond(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Weights of the shadow beyond the mat."""
    for weight in (0.0, 0.001, 0.003, 0.01):
        recipe = lc.Recipe(passes=120, light=lc.Light(grain=0.01), mat=lc.Mat(beyond=weight), hold_deg=0.25)
        yield f"{weight:g}", partial(solved, (which, 16, 32, 32, 35), 16.0, recipe)


def tilts(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Where lamps and screens may stand."""
    for count, side in ((16, 20), (32, 16)):
        for raised in ((35,), (25, 45), (20, 35, 50), (35, -35)):
            name = f"{count} of {side} x {side}, {' and '.join(map(str, raised))} degrees"
            yield name, partial(tilted, which, count, side, raised)
        for high in (side, side - 2):
            yield f"{count} of {high} x {high}, 35, square", partial(tilted, which, count, high, (35,), square=True)


def tilted(which: str, count: int, side: int, raised: tuple[float, ...], *, square: bool = False) -> Row:
    """Pictures under lamps of several elevations in turn, on screens that are upright or face the light."""
    grid, angles_deg = lc.Grid((32, 32, 32), 100 / 32), lc.spread_angles(count, elevation_deg=35)
    order = np.argsort(np.arange(count) % len(raised), kind="stable")
    each = [
        lc.turntable(grid, angles_deg[number :: len(raised)], elevation_deg=elevation_deg, picture_shape=(side, side))
        for number, elevation_deg in enumerate(raised)
    ]
    views = each[0].views
    for rig in each[1:]:
        views = views.joined(rig.views)
    if square:
        light, right = views.lamps[:, :3], views.column_steps_mm
        down = np.cross(light, right)
        down *= -np.sign(down[:, 2:]) * grid.voxel_mm / np.linalg.norm(down, axis=1, keepdims=True)
        views = replace(views, row_steps_mm=down)
    targets = lc.fit(pictures(which, count, 1.0), lc.Rig.of(views, angles_deg[order], power_max=16.0))
    return measured(targets, grid, lc.Recipe(passes=120))[0]


def starts(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Where one ends that starts elsewhere: what is asked for is not convex."""
    for seed, count, side in ((0, 8, 20), (1, 12, 18), (2, 16, 16), (3, 16, 20), (4, 24, 16)):
        for name in ("smaller cubes", "clear", "random, 1", "random, 3"):
            yield f"{count} of {side} x {side} from {name}", partial(started, which, seed, count, side, name)


def started(which: str, seed: int, count: int, side: int, name: str) -> Row:
    """A cube that starts from smaller ones, or from one that lets e^-1 or e^-3 of the light through on average."""
    rng, grid = np.random.default_rng(seed), lc.Grid((32, 32, 32), 100 / 32)
    angles_deg = lc.spread_angles(count, elevation_deg=35) + rng.uniform(0, 20)
    rig = lc.turntable(grid, angles_deg, elevation_deg=35, picture_shape=(side, side))
    targets, start = lc.fit(pictures(which, count, 1.0), rig), None
    if name != "smaller cubes":
        dark = 0.0 if name == "clear" else float(name[-1]) / 100
        extinction = rng.exponential(1, (3, *grid.shape)).astype(np.float32) * np.float32(dark)
        start = lc.Cube(extinction, grid, rig)
    return measured(targets, grid, lc.Recipe(passes=400, light=lc.Light(8, 5)), start)[0]


def points(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Points of a pixel, and the judge."""
    for count in (1, 3, 5, 8, 13, 21, 34):
        recipe = lc.Recipe(passes=100, light=lc.Light(count, count))
        yield f"{count} points", partial(solved, (which, 16, 32, 32, 35), 16.0, recipe)
    yield f"the judge's {JUDGE}", partial(judge, which)


def judge(which: str) -> Row:
    """How far the judge is from 32 x 32 beams: the worst picture, dB."""
    targets, grid = cube_for(which, 16, 32, 32, 35)
    cube = lc.solve(targets, grid, lc.Recipe(passes=100)).cube
    fine = (np.arange(32) + 0.5) / 32 - 0.5
    square = np.stack([each.ravel() for each in np.meshgrid(fine, fine)], axis=1)
    found = []
    for places in (square, judge_points(cube.rig, grid)):
        rig = cube.rig.split([np.hstack([places, np.zeros_like(places)])] * len(cube.rig.views))
        pairs = zip(lc.cast(cube, rig, light="thin"), targets.pictures, targets.weight, strict=True)
        found.append(np.array([psnr(encode(shown), encode(wanted), weight) for shown, wanted, weight in pairs]))
    off = np.abs(found[1] - found[0])
    return {"psnr_mean": float(found[0].mean()), "psnr_min": float(found[0].min()), "off_db": float(off.max())}


def means(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Ways to take the mean over a pixel."""
    yield "16 of 32 x 32, 35", partial(averaged, which)
    for elevation_deg in (0.0, 35.0):
        yield f"pieces, n = 64, {elevation_deg:g}", partial(pieces, 64, elevation_deg)


def averaged(which: str) -> Row:
    """Means of light at few points, and of absorbance with and without half its variance, beside those of 610 points.

    Of displayed values, root of the mean square.
    """
    targets, grid = cube_for(which, 16, 32, 32, 35)
    recipe = lc.Recipe.of_quality("normal", mat=lc.Mat(), hold_deg=0.25, light=lc.Light(grain=0.01))
    cube = lc.solve(targets, grid, recipe).cube
    powers = cube.powers[:, None, None]

    def through(count: int) -> NDArray[np.float64]:
        """The part of the light that comes through at each of some points of all pixels."""
        each = lattice(count)
        moved = [cube.rig.split([np.append(point, [0, 0])[None]] * len(cube.rig.views)) for point in each]
        return np.stack([np.stack(list(lc.cast(cube, rig, light="thin"))) / powers for rig in moved])

    def off(part: NDArray[np.float64]) -> float:
        return float(np.sqrt(np.mean((encode(part * powers) - encode(best * powers)) ** 2)))

    best, row = (fine := through(610)).mean(axis=0), {}
    for count, light in [(count, through(count)) for count in (3, 5, 8, 13, 21, 34)] + [(610, fine)]:
        dark = -np.log(light)
        row[f"{count} points, light"] = off(light.mean(axis=0))
        row[f"{count} points, absorbance"] = off(np.exp(-dark.mean(axis=0)))
        row[f"{count} points, absorbance and curvature"] = off(np.exp(-dark.mean(axis=0)) * (1 + dark.var(axis=0) / 2))
    return row


def pieces(n: int, elevation_deg: float) -> Row:
    """In how many pieces one pixel's beams fall that go through the same voxels, of 4000 in a row or 400 x 400."""
    turned, raised = np.radians(17.3), np.radians(elevation_deg)
    along = np.array([np.cos(turned) * np.cos(raised), -np.sin(turned) * np.cos(raised), -np.sin(raised)])
    right, up = np.array([-np.sin(turned), -np.cos(turned), 0]), np.array([0.0, 0.0, 1.0])
    fine = 400 if raised else 4000
    across = (np.arange(fine) + 0.5) / fine - 0.5
    planes, found = np.arange(n + 1) - n / 2, set()
    for above in across if raised else [0.0]:
        start = (0.3 * n + across)[:, None] * right + (0.06 * n + above) * up
        axes = [axis for axis in range(3) if along[axis]]
        times = np.stack([(planes - start[:, axis, None]) / along[axis] for axis in axes], axis=1)
        first, last = times.min(axis=2).max(axis=1), times.max(axis=2).min(axis=1)
        flat = times.reshape(fine, -1)
        flat = np.where((flat >= first[:, None]) & (flat <= last[:, None]), flat, np.inf)
        order = np.where(np.isinf(np.sort(flat, axis=1)), -1, np.argsort(flat, axis=1))
        found |= {crossed.tobytes() for crossed in order}
    return {"pieces": len(found)}


def grain(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Weights of points beside means."""
    for weight in (0.0, 0.003, 0.01, 0.03, 0.1, 0.3):
        light = lc.Light(13, 7, weight)
        asked = which, 16, 32, 32, 35
        yield f"{weight:g}, alone", partial(solved, asked, 16.0, lc.Recipe(passes=120, light=light))
        held = lc.Recipe(passes=120, light=light, mat=lc.Mat(), hold_deg=0.25)
        yield f"{weight:g}, in a mat and held", partial(solved, asked, 16.0, held)


def pixel(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Pixels of one voxel and of more, in dark mats and held."""
    for n, pixels, side in ((64, 32, 1), (64, 16, 2), (64, 48, 1), (64, 24, 2), (128, 64, 1), (128, 32, 2)):
        name = f"n = {n}, {pixels} x {pixels} pixels of {side} x {side} voxels"
        yield name, partial(coarse, which, n, pixels, side)


def coarse(which: str, n: int, pixels: int, side: int) -> Row:
    """Sixteen square pictures of so many pixels a side, of so many voxels each, and what is expected of them."""
    targets, grid = cube_for(which, 16, pixels, pixels, 35, n=n, pixel=side)
    recipe = lc.Recipe.of_quality("normal", mat=lc.Mat(), hold_deg=0.25 * 64 / n)
    return {"expected": lc.predict(targets, grid, recipe).psnr_mean, **measured(targets, grid, recipe)[0]}


def scenes(_: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Pictures that belong together, and pictures that do not."""
    yield "juggler, 32 of 48 x 48, 35", partial(traced, "juggler", 32, (48, 48), 35.0)
    yield "gems, 64 of 64 x 64, level", partial(traced, "gems", 64, (64, 64), 0.0)


def traced(name: str, count: int, shape: tuple[int, int], elevation_deg: float) -> Row:
    """Figures of a cube for a scene's pictures."""
    grid = lc.Grid((64, 64, 64), 100 / 64)
    angles_deg = lc.spread_angles(count, elevation_deg=elevation_deg)
    rig = lc.turntable(grid, angles_deg, elevation_deg=elevation_deg, picture_shape=shape)
    return measured(lc.scene_targets(lc.read_scene(name), rig, grid), grid, BEST)[0]


def default(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """All defaults."""
    for n in (64, 128):
        yield f"n = {n}", partial(planned, which, n)


def large(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """All defaults, of as many voxels as the paper's cube of an animation."""
    yield "n = 300", partial(planned, which, 300)


def planned(which: str, n: int) -> Row:
    """Sixteen square pictures as `solve` plans them."""
    began = time.perf_counter()
    recipe = lc.Recipe.of_quality("normal", mat=lc.Mat())
    made = plan(pictures(which, 16, 1.0), n, recipe, longest_hold=True, smooth=True)
    planning = time.perf_counter() - began
    row, _ = measured(made.targets, made.grid, made.recipe)
    width = made.targets.rig.picture_shape[1] / n
    told = {"expected": made.prediction.psnr_mean, "expected_min": made.prediction.psnr_min}
    return {"width": width, "hold_deg": made.recipe.hold_deg, "planning": planning, **told, **row}


def play(which: str) -> Iterator[tuple[str, Callable[[], Row]]]:
    """What `play` shows, of pixels and of parts of them."""
    yield "32 x 32, 35", partial(seen, which, 32, 35.0)
    yield "32 x 64, level", partial(seen, which, 64, 0.0)


def seen(which: str, rows: int, elevation_deg: float) -> Row:
    """Root of the mean square of what display values are off, 1, 2, 4 and 8 parts a side, in pictures and around."""
    targets, grid = cube_for(which, 16, 32, rows, elevation_deg)
    cube = lc.solve(targets, grid, lc.Recipe(passes=100, mat=lc.Mat())).cube
    angles_deg = cube.angles_deg[[0, 5, 10]]
    finest = np.stack([halves(lc.play(cube, [each], zoom=16)[0]) for each in angles_deg])
    row = {}
    for zoom in (8, 4, 2, 1):
        shown = lc.play(cube, angles_deg, zoom=zoom)
        own = zoom * np.array(targets.rig.picture_shape)
        (top, left), (high, wide) = (np.array(shown.shape[1:3]) - own) // 2, own
        inside = np.zeros(shown.shape[:3], bool)
        inside[:, top : top + high, left : left + wide] = True
        shadow = np.any(finest < 1, axis=-1)
        squares = np.diff(np.clip(encode(np.stack([shown, finest])), 0, 1), axis=0)[0] ** 2
        for name, chosen in (("pictures", inside), ("around", shadow & ~inside)):
            row[f"{name} in {zoom} x {zoom}"] = float(np.sqrt(np.mean(squares[chosen])))
        finest = np.stack([halves(each) for each in finest])
    return row


def halves(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    """The means of two by two pixels."""
    rows, columns, channels = picture.shape
    return picture.reshape(rows // 2, 2, columns // 2, 2, channels).mean(axis=(1, 3))


TABLES = {
    "must": must,
    "hold": hold,
    "mat": mat,
    "tilts": tilts,
    "starts": starts,
    "beyond": beyond,
    "points": points,
    "means": means,
    "grain": grain,
    "pixel": pixel,
    "scenes": scenes,
    "default": default,
    "large": large,
    "play": play,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=", ".join(TABLES))
    parser.add_argument("--out", type=Path, default=Path("out/light"))
    parser.add_argument("--set", dest="which", choices=("bundled", "other"), default="bundled")
    said = parser.parse_args()
    said.out.mkdir(parents=True, exist_ok=True)
    file = said.out / "measured.jsonl"
    known = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
    for table in said.tables or TABLES:
        print(f"\n{table}, {said.which} pictures", flush=True)
        for name, measure in TABLES[table](said.which):
            key = {"table": table, "set": said.which, "name": name}
            row = next((row for row in known if key.items() <= row.items()), None)
            if row is None:
                row = key | measure()
                with file.open("a") as stream:
                    stream.write(json.dumps(row) + "\n")
            figures = ", ".join(f"{what} {value:.4g}" for what, value in row.items() if what not in key)
            print(f"  {name}: {figures}", flush=True)


if __name__ == "__main__":
    main()
