"""Photographs, letters and gems by methods of other packages and by this one's: what a wall shows of each block.

    python benchmarks/comparison.py [--n N] [--repeats R] [--picture FILE]

One block of N voxels a side (an odd N) under a level lamp, half a turn, pictures as wide as the block. Others solve
what they are made for, absorbance: the logarithm of the wanted light, slice by slice and colour by colour, by exact
lengths or their own. Their blocks are then cast as all are, and scored as all are. A block lets through no more light
than falls on it, so what is below 0 counts as clear. One thread; seconds, of a processor, are from the pictures to the
block, the least of R, and stand in the table as parts of those of `lightcube sirt`.

Dr.TVAM's loss (B. Nicolet and others, 2024, after F. Wechsler and others, 2024) is of doses in resin: inside an object
they lie between an upper threshold and 1, outside below a lower one, and what is missed counts to the power of two.
Here light on the wall takes the place of the dose: each pixel has a least and a largest light, and L-BFGS of scipy does
the rest.
"""

import argparse
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np
import peers
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from scipy.optimize import minimize

import lightcube as lc
from lightcube.kernels.layout import columns_from_pictures, volume_from_columns
from lightcube.optics.transfer import BLACK, decode, to_uint8
from lightcube.pictures import samples

Array = NDArray[np.floating[Any]]
#: How far light may be off, of pictures in half-tones; what is dark and what is bright, of those in black and white.
NEAR, DARK, BRIGHT = 0.01, 0.05, 0.9
#: Of the drawing: pictures side by side; side of one, what is free between two, and letters of captions, pixels.
ACROSS, SIDE, GAP, LETTERS = 6, 150, 8, 15


class Problem(NamedTuple):
    """Pictures, and the block that is to show them."""

    name: str
    targets: lc.Targets
    grid: lc.Grid

    @property
    def slices(self) -> list[peers.Slice]:
        """One for each picture row and colour, bottom-up, the colour innermost."""
        n = self.grid.shape[2]
        layer = lc.Grid((1, n, n), self.grid.voxel_mm)
        angles_deg = self.targets.angles_deg
        matrix = lc.Projector(layer, lc.turntable(layer, angles_deg, picture_shape=(1, n)))
        absorbance = -np.log(np.maximum(columns_from_pictures(self.targets.pictures), decode(np.array([BLACK]))))
        blank = np.zeros((n, n), np.float32)
        return [peers.Slice(matrix, each.reshape(len(angles_deg), n), blank) for each in absorbance.T]


class Method(NamedTuple):
    """A way to a block: its name, what it makes small, and how."""

    name: str
    least: str
    run: Callable[[Problem], lc.Cube]


def cube_of(problem: Problem, columns: Array) -> lc.Cube:
    """The block of a solution, ``(y * x, z * colour)``, under the paper's lamp."""
    volume = volume_from_columns(np.maximum(columns, 0).astype(np.float32), problem.grid.shape, 3)
    return lc.Cube(volume, problem.grid, problem.targets.rig, np.ones((len(problem.targets), 3)))


def slice_by_slice(problem: Problem, run: Callable[[peers.Slice, int], Array], passes: int) -> lc.Cube:
    """One slice after the other; where nothing is to be absorbed (0 / 0 in conjugate gradients) it is clear."""
    found = [run(each, passes) if each.absorbance.any() else each.phantom for each in problem.slices]
    return cube_of(problem, np.stack([each.reshape(-1) for each in found], axis=1))


def by_tomosipo(given: peers.Slice, passes: int) -> Array:
    """The SIRT of tomosipo's algorithms, whose own projector needs a GPU, with ASTRA's in its place."""
    import astra

    try:
        matrix = astra.OpTomo(astra.create_projector("line", *peers.geometry(given)))
        y = given.absorbance[:, ::-1].ravel()
        sums = matrix @ np.ones(given.phantom.size, np.float32), matrix.T @ np.ones(y.size, np.float32)
        by_row, by_voxel = (np.divide(1, each, out=np.zeros_like(each), where=each > 1e-6) for each in sums)
        x = np.zeros(given.phantom.size, np.float32)
        for _ in range(passes):
            x = np.maximum(x - by_voxel * (matrix.T @ (by_row * (matrix @ x - y))), 0)
        return np.asarray(x.reshape(given.phantom.shape)[::-1])
    finally:
        astra.clear()


def by_thresholds(problem: Problem, passes: int) -> lc.Cube:
    """Dr.TVAM's loss of the light that reaches the wall."""
    matrix = lc.Projector(problem.grid, problem.targets.rig)
    light = columns_from_pictures(problem.targets.pictures).astype(np.float64)
    is_flat = np.all((light < DARK) | (light > BRIGHT))
    low = np.where(light > BRIGHT, BRIGHT, 0.0) if is_flat else light - NEAR
    high = np.where(light > BRIGHT, 1.0, DARK) if is_flat else light + NEAR
    shape = (matrix.shape[1], light.shape[1])

    def loss(x: Array) -> tuple[float, Array]:
        shown = np.exp(-matrix.forward(x.reshape(shape)))
        less, more = np.maximum(low - shown, 0), np.maximum(shown - high, 0)
        return float(np.sum(less**2) + np.sum(more**2)), matrix.adjoint(2 * (less - more) * shown).ravel()

    start = np.full(shape, 1 / problem.grid.shape[2]).ravel()
    found = minimize(
        loss, start, jac=True, method="L-BFGS-B", bounds=[(0, None)] * len(start), options={"maxiter": passes}
    )
    return cube_of(problem, found.x.reshape(shape))


def by_lightcube(problem: Problem, method: str, passes: int, *, areas: bool = False, strongest: float = 1.0) -> lc.Cube:
    """All slices and colours at once, under lamps of power 1, or of the best power up to `strongest`."""
    angles_deg, shape = problem.targets.angles_deg, problem.targets.rig.picture_shape
    power = 1.0 if strongest == 1 else None
    rig = lc.turntable(problem.grid, angles_deg, picture_shape=shape, power=power, power_max=max(strongest, 1.0))
    light = lc.Light() if areas else lc.Light.thin()
    recipe = lc.Recipe(method=method, passes=passes, light=light)
    return lc.solve(lc.Targets(problem.targets.pictures, rig), problem.grid, recipe).cube


LOGARITHMS, THRESHOLDS, SEEN = "squares of logarithms", "light beyond thresholds", "squares of what is seen"
METHODS = [
    Method("lightcube `sirt`", LOGARITHMS, partial(by_lightcube, method="sirt", passes=200)),
    Method("lightcube `cgls`", LOGARITHMS, partial(by_lightcube, method="cgls", passes=200)),
    Method(
        "ASTRA SIRT",
        LOGARITHMS,
        partial(slice_by_slice, run=partial(peers.by_astra, method="SIRT", MinConstraint=0.0), passes=200),
    ),
    Method("ASTRA CGLS", LOGARITHMS, partial(slice_by_slice, run=partial(peers.by_astra, method="CGLS"), passes=20)),
    Method("tomosipo's SIRT, by ASTRA", LOGARITHMS, partial(slice_by_slice, run=by_tomosipo, passes=200)),
    Method("scikit-image SART", LOGARITHMS, partial(slice_by_slice, run=peers.by_scikit_image, passes=20)),
    Method("Dr.TVAM's loss, by L-BFGS", THRESHOLDS, partial(by_thresholds, passes=200)),
    Method("lightcube `display`, thin beams", SEEN, partial(by_lightcube, method="display", passes=200)),
    Method("lightcube `display`, areas", SEEN, partial(by_lightcube, method="display", passes=120, areas=True)),
    Method(
        "the same, lamps up to 16",
        SEEN,
        partial(by_lightcube, method="display", passes=120, areas=True, strongest=16.0),
    ),
]


def problems(n: int) -> list[Problem]:
    """Four photographs, four letters, and twenty-four shadows of translucent solids."""
    grid = lc.Grid((n, n, n))
    four, many = (lc.turntable(grid, lc.spread_angles(count), picture_shape=(n, n), power=1.0) for count in (4, 24))
    letters = np.stack([letter(text, n) for text in "CUBE"])
    known = samples.photographs(16)
    names = ("astronaut", "coffee", "cat", "rocket")
    chosen = lc.Pictures(tuple(known.images[known.names.index(name)] for name in names), names)
    return [
        Problem("photographs", lc.fit(chosen, four), grid),
        Problem("letters", lc.Targets(letters, four), grid),
        Problem("gems", lc.scene_targets(lc.read_scene("gems"), many, grid), grid),
    ]


def letter(text: str, n: int) -> NDArray[np.float32]:
    """A black letter on white, ``(n, n, 3)``, without greys."""
    image = Image.new("L", (n, n), 255)
    ImageDraw.Draw(image).text((n / 2, n / 2), text, 0, ImageFont.load_default(0.9 * n), anchor="mm", stroke_width=1)
    return np.repeat((np.asarray(image) > 127).astype(np.float32)[..., None], 3, axis=2)


def main(arguments: Sequence[str] | None = None) -> None:
    """Parse, solve, score, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=47, help="odd")
    parser.add_argument("--repeats", type=int, default=2)
    parser.add_argument("--picture", type=Path, default=Path("out/comparison.png"))
    asked = parser.parse_args(arguments)
    lc.threads(1)
    given = problems(asked.n)
    heads = [f"{each.name}: on a wall · thin" for each in given]
    peers.line("method", "makes small", *heads, "seconds of processor, photographs")
    print("|---" * (len(given) + 3) + "|")
    rows = [("wanted", [each.targets.pictures[0] for each in given])]
    unit = 0.0
    for method in METHODS:
        cells, shown = [], []
        for problem in given:
            cube, seconds = timed(method, problem, asked.repeats if problem is given[0] else 1)
            scores = lc.score(cube, problem.targets)
            cells.append(f"{scores['psnr_mean']:.1f} / {scores['psnr_min']:.1f} · {scores['thin_psnr_mean']:.1f}")
            shown.append(next(lc.cast(cube)))
            if problem is given[0]:
                spent = seconds
        unit = unit or spent
        peers.line(method.name, method.least, *cells, f"{spent / unit:.2g} ({spent:.3g} s)")
        rows.append((method.name.replace("`", ""), shown))
    lc.save(drawn(rows), asked.picture, overwrite=True)


def timed(method: Method, problem: Problem, repeats: int) -> tuple[lc.Cube, float]:
    """The block, and the least of the seconds of processor that it takes."""
    times = []
    for _ in range(repeats):
        began = time.process_time()
        cube = method.run(problem)
        times.append(time.process_time() - began)
    return cube, min(times)


def drawn(rows: list[tuple[str, list[Array]]]) -> NDArray[np.uint8]:
    """A column for each method, in bands of so many; below each other the first pictures of all problems."""
    step, top = SIDE + GAP, 3 * LETTERS
    high = top + len(rows[0][1]) * step
    sheet = Image.new("RGB", (ACROSS * step, -(-len(rows) // ACROSS) * high), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(LETTERS)
    for number, (name, pictures) in enumerate(rows):
        left, down = number % ACROSS * step, number // ACROSS * high
        draw.multiline_text((left, down), "\n".join(wrap(name, 18)), "black", font, spacing=0)
        for row, picture in enumerate(pictures):
            place = (left, down + top + row * step)
            image = Image.fromarray(to_uint8(picture)).resize((SIDE, SIDE), Image.Resampling.NEAREST)
            sheet.paste(image, place)
            draw.rectangle((*place, place[0] + SIDE - 1, place[1] + SIDE - 1), outline=(200, 200, 200))
    return np.asarray(sheet)


if __name__ == "__main__":
    main()
