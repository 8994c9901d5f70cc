"""Time the products of rays in any direction, and what bounds them.

    python benchmarks/rays.py [--n N] [--views V] [--pixels P]

A colour cube, views from all over the hemisphere onto screens square to them, P x P pixels a voxel apart where they
pass the cube's middle. Best of three; traced anew in every product, and where there is room also with pieces that are
kept. *traversal* is the same rays traced and not used; *from L2* multiplies and adds
up rows of three colours in random order out of 240 KB: what a product would take if lengths were known and every row
near.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.kernels import tasks
from lightcube.kernels.compiled import compiled
from lightcube.kernels.marching import ABREAST
from lightcube.kernels.ray import FIELDS, most_pieces
from lightcube.kernels.rays import trace_rows
from lightcube.kernels.tiles import paper
from lightcube.optics.grid import Grid
from lightcube.optics.views import Views
from lightcube.projection.rays import Rays

#: Work that is worth all threads, however little it is.
_LONG = 1 << 40


def views(n: int, count: int, pixels: int, *, point: bool) -> Views:
    """Directions all over the hemisphere; point lamps stand 2.3 cube widths off."""
    random = np.random.default_rng(0)
    away, behind = 2.3 * n, 1.2 * n
    pitch = 1 + behind / away if point else 1.0
    lamps, origins_mm, right, down = [], [], [], []
    for _ in range(count):
        light = random.normal(size=3)
        light /= np.linalg.norm(light)
        light[2] = -abs(light[2])
        side = np.cross(light, (0, 0, 1.0))
        side /= np.linalg.norm(side)
        lamps.append([*(-away * light), 1] if point else [*light, 0])
        origins_mm.append(behind * light)
        right.append(pitch * side)
        down.append(pitch * np.cross(light, side))
    return Views(np.array(lamps), np.array(origins_mm), np.array(right), np.array(down), (pixels, pixels))


def traversal(*data: Any) -> int:
    """Number of all pieces, found by tracing them."""
    found = np.zeros(len(data[0]) * data[3][0], np.int64)
    tasks.run(_traversal, len(found), _LONG, *data, found)
    return int(found.sum())


@compiled
def _traversal(first_line, last_line, lamps, screens, lines, shape, heard, grid, found):  # type: ignore[no-untyped-def]
    nz, ny, nx = grid
    state, traced = np.zeros((FIELDS, ABREAST)), paper(0, most_pieces(nx, ny, nz), np.empty(0, np.float32))
    for line in range(first_line, last_line):
        row = 0
        while row < shape[1]:
            row, met = trace_rows(
                lamps[line // shape[0]],
                screens[line // shape[0]],
                lines[0],
                heard[line],
                line % shape[0],
                row,
                shape[1],
                (0, 0, 0),
                (nx, ny, nz),
                (nz, nx * nz, 1),
                1.0,
                1.0,
                state,
                traced,
            )
            found[line] += traced.counts[:met].sum()


@compiled
def from_l2(first, last, x, places, weights, times, sums):  # type: ignore[no-untyped-def]
    """Weighted sums of rows of three, again and again."""
    for part in range(first, last):
        red = green = blue = np.float32(0)
        for _ in range(times):
            for k in range(len(places)):
                red += weights[k] * x[places[k], 0]
                green += weights[k] * x[places[k], 1]
                blue += weights[k] * x[places[k], 2]
        sums[part] = red, green, blue


def best(call: Callable[[], object]) -> float:
    """Least seconds of three calls, after one that compiles."""
    call()
    times = []
    for _ in range(3):
        began = time.perf_counter()
        call()
        times.append(time.perf_counter() - began)
    return min(times)


def near(threads: int) -> float:
    """Nanoseconds that a thread needs for a piece whose row is in L2."""
    tasks.set_threads(threads)
    random = np.random.default_rng(0)
    x: NDArray[np.float32] = random.random((20_000, 3), dtype=np.float32)
    places, weights = random.permutation(len(x)), random.random(len(x), dtype=np.float32)
    data = x, places, weights, 200, np.zeros((64, 3))
    return best(lambda: tasks.run(from_l2, 64, _LONG, *data)) / (64 * 200 * len(x)) * 1e9 * threads


def rows(kind: str, grid: Grid, beams: Views) -> Iterator[str]:
    """Lines of the table, for one thread and for all: traced anew, and kept."""
    anew, kept = Rays(grid, beams), Rays(grid, beams)
    x = np.random.default_rng(1).random((anew.shape[1], 3), dtype=np.float32)
    b = anew.forward(x)
    anew._lists = ()
    yield from _lines(kind, anew, x, b)
    kept.adjoint(b)
    if kept._lists:
        yield from _lines(f"{kind}, kept", kept, x, b)


def _lines(kind: str, matrix: Rays, x: NDArray[np.float32], b: NDArray[np.float32]) -> Iterator[str]:
    data = *matrix._rays, matrix._picture, matrix._heard, matrix.grid.shape
    pieces = traversal(*data)
    for threads in sorted({1, tasks.threads()}):
        tasks.set_threads(threads)
        took = [best(lambda: traversal(*data)), best(lambda: matrix.forward(x)), best(lambda: matrix.adjoint(b))]
        each = (took[1] + took[2]) / 2 / pieces * 1e9 * threads
        figures = " | ".join(f"{seconds:.3f}" for seconds in (*took, took[1] + took[2]))
        yield f"| {kind} | {threads} | {pieces / 1e6:.0f} M | {figures} | {each:.1f} | {near(threads):.2f} |"


def main() -> None:
    """Parse, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in (("--n", 128), ("--views", 64), ("--pixels", 192)):
        parser.add_argument(name, type=int, default=default)
    asked = parser.parse_args()
    grid = Grid((asked.n,) * 3)
    heads = "light", "threads", "pieces", "traversal, s", "forward, s", "adjoint, s", "pass, s", "ns a piece and thread"
    print(f"| {' | '.join(heads)} | from L2, ns |\n|{'---|' * (len(heads) + 1)}")
    for point in (False, True):
        beams = views(asked.n, asked.views, asked.pixels, point=point)
        for row in rows("from points" if point else "parallel", grid, beams):
            print(row, flush=True)


if __name__ == "__main__":
    main()
