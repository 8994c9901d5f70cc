"""One slice, reconstructed by this package's methods and by others': residual, error, time, and a picture.

    python benchmarks/peers.py [--n N] [--views V] [--passes P ...] [--repeats R] [--picture FILE]

A slice of N x N pixels (an odd N) of known extinction, at least 0 and none outside the circle, under level light from V
angles over 180 degrees, N beams each. The absorbance of the beams is that of ellipses, by their formula: no pixels, no
matrix, and so nobody's own. All get the same float32 numbers and one thread; seconds are from there to the picture,
everything in between counted, the median of R. This package is made for many columns at a time: a row says what a slice
costs where 48 are solved at once, sixteen slices in three colours, say. The residual is |A x - b| / |b| with one and
the same matrix of exact lengths for all, the error |x - p| / |p| with p the ellipses averaged over pixels.
"""

import argparse
import math
import statistics
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import lightcube as lc
from lightcube.solvers.contract import Wanted

Array = NDArray[np.floating[Any]]
#: Largest absorbance of a beam.
MOST = 2.0
#: Of ellipses: middle x and y, half axes, all in radii of the circle, degrees that they are turned by, extinction.
ELLIPSES = [
    (0.0, 0.0, 0.9, 0.75, 20.0, 0.3),
    (0.35, 0.2, 0.25, 0.25, 0.0, 0.5),
    (-0.4, -0.1, 0.35, 0.12, 60.0, 0.7),
    (0.1, -0.45, 0.3, 0.1, 0.0, -0.3),
    (-0.15, 0.4, 0.06, 0.06, 0.0, 0.7),
    (0.45, -0.2, 0.04, 0.12, -30.0, 0.7),
]


class Slice(NamedTuple):
    """What everybody is given, and what is wanted."""

    matrix: lc.Projector
    #: ``(views, n)`` float32.
    absorbance: Array
    #: ``(y, x)``.
    phantom: Array


class Method(NamedTuple):
    """A way to reconstruct a slice: ``run(slice, passes)`` is an image ``(y, x)``."""

    name: str
    bounded: bool
    run: Callable[[Slice, int], Array]
    #: Whether it stops by itself, and is not told how many passes to take.
    whole: bool = False
    #: Slices that are solved at once: the seconds are those of one.
    slices: int = 1


def inside(place: Array, ellipse: tuple[float, ...], radius: float) -> tuple[Array, Array]:
    """Places ``(..., 2)`` in the axes in which an ellipse is the unit circle, and the matrix that leads there."""
    x, y, a, b, degrees, _ = ellipse
    turn = math.radians(degrees)
    axes = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    axes /= radius * np.array([[a], [b]])
    return (place - radius * np.array([x, y])) @ axes.T, axes


def absorbance_of(views: lc.Views, radius: float) -> Array:
    """``(views, columns)``: chords of each beam in the ellipses, times their extinction."""
    columns = views.picture_shape[1]
    steps = (np.arange(columns) - (columns - 1) / 2)[:, None]
    points = views.origins_mm[:, None, :2] + steps * views.column_steps_mm[:, None, :2]
    total = np.zeros(points.shape[:2])
    for ellipse in ELLIPSES:
        start, axes = inside(points, ellipse, radius)
        way = (views.lamps[:, :2] @ axes.T)[:, None, :]
        along, speed = np.sum(start * way, axis=2), np.sum(way**2, axis=2)
        squared = along**2 - speed * (np.sum(start**2, axis=2) - 1)
        total += ellipse[-1] * 2 * np.sqrt(np.maximum(squared, 0)) / speed
    return total


def phantom_of(n: int, radius: float, finer: int = 16) -> Array:
    """``(y, x)``: extinction averaged over `finer` x `finer` points of each pixel."""
    places = (np.arange(n * finer) + 0.5) / finer - n / 2
    points = np.stack(np.meshgrid(places, places), axis=2)
    fine = sum(each[-1] * (np.sum(inside(points, each, radius)[0] ** 2, axis=2) < 1) for each in ELLIPSES)
    return np.asarray(fine).reshape(n, finer, n, finer).mean(axis=(1, 3))


def slice_of(n: int, views: int) -> Slice:
    """What all are given: `n` pixels a side, an odd number."""
    if n % 2 == 0:
        raise lc.InputError(
            f"a slice of {n} x {n} pixels has no middle one for scikit-image to turn about: give an odd --n"
        )
    grid = lc.Grid((1, n, n))
    matrix = lc.Projector(grid, lc.turntable(grid, lc.spread_angles(views), picture_shape=(1, n)))
    absorbance = absorbance_of(matrix.views, n / 2)
    scale = MOST / np.max(absorbance)
    return Slice(matrix, (scale * absorbance).astype(np.float32), scale * phantom_of(n, n / 2))


def by_lightcube(given: Slice, passes: int, method: str, least: float = 0.0, slices: int = 1) -> Array:
    light = np.tile(np.exp(-given.absorbance.reshape(-1, 1)), slices)
    found = lc.METHODS[method].solve(given.matrix, Wanted(light), bounds=(least, np.inf), iterations=passes)
    return found.x[:, 0].reshape(given.phantom.shape)


def geometry(given: Slice) -> tuple[Any, Any]:
    """Screen and volume for ASTRA, whose angles turn the other way from another axis."""
    import astra

    n = len(given.phantom)
    screen = astra.create_proj_geom("parallel", 1.0, n, np.radians(90 - given.matrix.views.angles_deg))
    return screen, astra.create_vol_geom(n, n)


def by_astra(given: Slice, passes: int, method: str, **options: float) -> Array:
    """By its line projector; its rows run downwards."""
    import astra

    screen, volume = geometry(given)
    try:
        settings = astra.astra_dict(method)
        settings["ProjectorId"] = astra.create_projector("line", screen, volume)
        settings["ProjectionDataId"] = astra.data2d.create("-sino", screen, given.absorbance[:, ::-1])
        settings["ReconstructionDataId"] = astra.data2d.create("-vol", volume, 0.0)
        settings["option"] = options
        astra.algorithm.run(astra.algorithm.create(settings), passes)
        return np.asarray(astra.data2d.get(settings["ReconstructionDataId"])[::-1])
    finally:
        astra.clear()


def by_scikit_image(given: Slice, passes: int) -> Array:
    from skimage.transform import iradon_sart

    sinogram, image = np.ascontiguousarray(given.absorbance.T), None
    for _ in range(passes):
        image = iradon_sart(sinogram, given.matrix.views.angles_deg + 90, image, clip=(0, np.inf))
    return np.asarray(image)


def by_scipy(given: Slice, passes: int) -> Array:
    from scipy.optimize import lsq_linear

    b = given.absorbance.reshape(-1).astype(np.float64)
    found = lsq_linear(given.matrix.to_sparse(), b, bounds=(0, np.inf))
    return np.asarray(found.x).reshape(given.phantom.shape)


METHODS = [
    Method("lightcube sirt", True, partial(by_lightcube, method="sirt")),
    Method("lightcube sirt, one of 48", True, partial(by_lightcube, method="sirt", slices=48), slices=48),
    Method("lightcube cgls", True, partial(by_lightcube, method="cgls")),
    Method("lightcube cgls, unbounded", False, partial(by_lightcube, method="cgls", least=-np.inf)),
    *(Method(f"lightcube {m}", True, partial(by_lightcube, method=m)) for m in ("display", "gauss-seidel")),
    Method("ASTRA SIRT", True, partial(by_astra, method="SIRT", MinConstraint=0.0)),
    Method("ASTRA CGLS", False, partial(by_astra, method="CGLS")),
    Method("scikit-image iradon_sart", True, by_scikit_image),
    Method("scipy lsq_linear", True, by_scipy, whole=True),
]


def timed(run: Callable[[Slice, int], Array], given: Slice, passes: int, repeats: int) -> tuple[Array, float]:
    """The image, and the median of the seconds that it takes."""
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        image = run(given, passes)
        times.append(time.perf_counter() - began)
    return image, statistics.median(times)


def relative(difference: Array, whole: Array) -> float:
    return float(np.linalg.norm(difference) / np.linalg.norm(whole))


def figures(given: Slice, image: Array) -> list[str]:
    """Residual and error of an image."""
    missed = given.matrix(image[None].astype(np.float64))[:, 0] - given.absorbance
    return [
        f"{relative(missed, given.absorbance):.2%}",
        f"{relative(image - given.phantom, given.phantom):.1%}",
    ]


def line(*cells: str) -> None:
    print(f"| {' | '.join(cells)} |", flush=True)


def row_of(given: Slice, method: Method, passes: int, repeats: int) -> tuple[Array, list[str]]:
    """The image, and what the table says of it."""
    if not method.whole:
        method.run(given, 1)  # what is compiled or loaded the first time does not count
    image, seconds = timed(method.run, given, passes, repeats)
    keeps = "yes" if method.bounded else "no"
    done = "to the end" if method.whole else str(passes)
    return image, [method.name, keeps, done, *figures(given, image), f"{seconds / method.slices:.2g}"]


def compare(given: Slice, passes: Sequence[int], repeats: int) -> list[list[tuple[str, Array]]]:
    """Print the table; return the images with their titles in columns, one for each method that is told its passes."""
    line("method", "x ≥ 0", "passes", "residual", "error", "seconds")
    print("|---" * 6 + "|")
    line("the phantom itself", "yes", "", *figures(given, given.phantom), "")
    columns, absent = [[("the phantom", given.phantom)]], set()
    for method in METHODS:
        column = []
        try:
            for count in passes[-1:] if method.whole else passes:
                image, cells = row_of(given, method, count, repeats)
                line(*cells)
                column.append((f"{method.name}\n{cells[2]}{' passes' * (not method.whole)}: {cells[4]} off", image))
        except ImportError:
            absent.add(method.name.split()[0])
        if method.whole:
            columns[0] += column
        elif method.slices == 1 and column:
            columns.append(column)
    for name in sorted(absent):
        print(f"\n{name} is not installed and left out: pip install 'lightcube[oracle]'")
    return columns


def draw(columns: list[list[tuple[str, Array]]], path: Path) -> None:
    """All images side by side, on one scale."""
    from matplotlib.figure import Figure

    rows = max(len(column) for column in columns)
    figure = Figure(figsize=(1.5 * len(columns), 1.9 * rows), layout="constrained")
    most = 1.2 * float(np.max(columns[0][0][1]))
    panels = figure.subplots(rows, len(columns), squeeze=False)
    for panel in panels.ravel():
        panel.set_axis_off()
    for side, column in zip(panels.T, columns, strict=True):
        for panel, (title, image) in zip(side, column, strict=False):
            panel.imshow(image, cmap="gray", vmin=0, vmax=most, origin="lower", interpolation="nearest")
            panel.set_title(title, fontsize=7)
    lc.save(figure, path, overwrite=True)


def main(arguments: Sequence[str] | None = None) -> None:
    """Parse, measure, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=63, help="odd")
    parser.add_argument("--views", type=int, default=60)
    parser.add_argument("--passes", type=int, nargs="+", default=[20, 200])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--picture", type=Path, default=Path("out/peers.png"))
    asked = parser.parse_args(arguments)
    lc.threads(1)
    draw(compare(slice_of(asked.n, asked.views), sorted(asked.passes), asked.repeats), asked.picture)


if __name__ == "__main__":
    main()
