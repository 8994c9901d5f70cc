"""The figures of the lessons: a sinogram, beams as equations, rows and factors, light behind glass.

    python examples/teach.py [FOLDER]

Some seconds, with matplotlib (extra `plot`); the pictures go to docs/pictures, or FOLDER.
"""

import io
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image
from scipy.optimize import nnls

import lightcube as lc

Array = NDArray[np.floating]

PAPER, INK, FAINT, LINES = "#fdfcf8", "#22262b", "#b9b5aa", ("#b4501e", "#2f6f9f", "#4f8a4b")


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "docs" / "pictures"
    for name, figure in (
        ("sinogram", sinogram()),
        ("equations", equations()),
        ("kaczmarz", rows_and_factors()),
        ("beer", behind_glass()),
    ):
        drawn = io.BytesIO()
        figure.savefig(drawn, format="png", dpi=150)
        Image.open(drawn).convert("RGB").save(folder / f"teach-{name}.webp", quality=88, method=6)


def sheet(widths: Sequence[float], high: float) -> tuple[Figure, list[Axes]]:
    """A figure of several drawings in a row."""
    figure = Figure(figsize=(8, high), facecolor=PAPER, layout="constrained")
    drawings = figure.subplots(1, len(widths), width_ratios=widths)
    found = list(np.atleast_1d(drawings))
    for each in found:
        each.set_facecolor(PAPER)
        each.tick_params(colors=INK, labelsize=8)
    return figure, found


def bare(drawing: Axes, title: str) -> None:
    drawing.set_title(title, fontsize=9, color=INK)
    drawing.set_xticks([])
    drawing.set_yticks([])


def sinogram() -> Figure:
    """A bar and a block, all their shadows, and what is found from few and from many."""
    grid = lc.Grid((1, 32, 32))
    thing = np.zeros((1, 32, 32), np.float32)
    thing[0, 6:14, 8:24] = 1.0
    thing[0, 18:26, 18:26] = 2.0
    figure, drawings = sheet([1, 1.4, 1, 1, 1], 2.0)
    drawings[0].imshow(thing[0], cmap="Greys", origin="lower", vmax=2.5)
    bare(drawings[0], "a thing")
    shadows = lc.Projector(grid, lc.turntable(grid, list(np.arange(180.0))))(thing)[:, 0]
    drawings[1].imshow(shadows, cmap="Greys", aspect="auto", extent=(0, 1, 180, 0))
    bare(drawings[1], "its shadows, 0 to 180°")
    for drawing, count in zip(drawings[2:], (4, 16, 64), strict=True):
        cast = lc.Projector(grid, lc.turntable(grid, list(180 * (np.arange(count) + 0.25) / count)))
        drawing.imshow(all_at_once(cast, cast(thing))[0], cmap="Greys", origin="lower", vmin=0, vmax=2.5)
        bare(drawing, f"from {count}")
    return figure


def all_at_once(cast: lc.Projector, wanted: Array, rounds: int = 200) -> Array:
    """SIRT, not below nothing."""
    found: Array = np.zeros(cast.domain_shape, np.float32)
    along, across = cast(np.ones_like(found)), cast.T(np.ones_like(wanted))
    for _ in range(rounds):
        more = cast.T((wanted - cast(found)) / np.maximum(along, 1)) / np.maximum(across, 1)
        found = np.clip(found + more, 0, None)
    return found


def equations() -> Figure:
    """Five beams through three by three voxels, and the length of the middle three in each."""
    figure, (drawing,) = sheet([1], 4.2)
    grid = lc.Grid((1, 3, 3))
    rig = lc.turntable(grid, [30])
    lengths = lc.Projector(grid, rig).to_sparse().toarray().reshape(-1, 3, 3)  # beam, y, x
    views = rig.views
    light, step = views.lamps[0, :2], views.column_steps_mm[0, :2]
    for column in range(5):
        middle = (column - 2) * step
        ends = np.stack([middle - 2.6 * light, middle + 2.6 * light])
        colour = LINES[(column - 1) % 3]
        drawing.plot(*ends.T, color=colour, lw=2, alpha=1 if 0 < column < 4 else 0.45)
        for y, x in np.argwhere(lengths[column] > 0.2):
            across, up = inside(middle, light, np.array([x - 1.0, y - 1.0]))
            drawing.text(
                across,
                up,
                f"{lengths[column, y, x]:.2f}",
                fontsize=9,
                color=colour,
                ha="center",
                va="center",
                bbox={"facecolor": PAPER, "edgecolor": "none", "pad": 1},
            )
    for edge in np.arange(4) - 1.5:
        drawing.plot([edge, edge], [-1.5, 1.5], color=INK, lw=1)
        drawing.plot([-1.5, 1.5], [edge, edge], color=INK, lw=1)
    drawing.set_aspect("equal")
    drawing.set_xlim(-3, 3)
    drawing.set_ylim(-2, 2)
    drawing.axis("off")
    return figure


def inside(middle: Array, light: Array, centre: Array) -> Array:
    """Where a beam is halfway through a voxel of side 1."""
    faces = (centre + np.array([[-0.5], [0.5]]) - middle) / light
    entered, left = faces.min(axis=0).max(), faces.max(axis=0).min()
    return middle + (entered + left) / 2 * light


def rows_and_factors() -> Figure:
    """Row by row to a crossing and round in a triangle, and by multiplying."""
    rows, wanted = np.array([[2.0, 1.0], [1.0, 3.0], [1.0, -1.0]]), np.array([4.0, 7.0, 1.5])
    figure, drawings = sheet([1, 1, 1], 2.9)
    titles = ("row by row", "three that do not meet", "by multiplying")
    for drawing, count, title in zip(drawings, (2, 3, 2), titles, strict=True):
        for row, b, colour in zip(rows[:count], wanted, LINES, strict=False):
            x = np.array([-0.5, 4.0])
            drawing.plot(x, (b - row[0] * x) / row[1], color=colour, lw=1.2)
        bare(drawing, title)
        drawing.set(xlim=(-0.3, 3.2), ylim=(-0.3, 3.2), aspect="equal")
    walked(drawings[0], row_by_row(rows[:2], wanted, 5))
    walked(drawings[1], row_by_row(rows, wanted, 6))
    for start in ([0.1, 3.0], [2.8, 0.2], [3.0, 3.0]):
        walked(drawings[2], multiplied(rows[:2], wanted[:2], np.array(start)))
    drawings[2].axhline(0, color=FAINT, lw=1)
    drawings[2].axvline(0, color=FAINT, lw=1)
    return figure


def row_by_row(rows: Array, wanted: Array, sweeps: int) -> list[Array]:
    path: list[Array] = [np.zeros(2)]
    for _ in range(sweeps):
        for row, b in zip(rows, wanted, strict=False):
            path.append(path[-1] + row * (b - row @ path[-1]) / (row @ row))
    return path


def multiplied(rows: Array, wanted: Array, start: Array) -> list[Array]:
    path = [start]
    for _ in range(40):
        path.append(path[-1] * (rows.T @ wanted) / (rows.T @ (rows @ path[-1])))
    return path


def walked(drawing: Axes, path: list[Array]) -> None:
    drawing.plot(*np.array(path).T, "o-", color=INK, ms=3, lw=0.9)


def behind_glass() -> Figure:
    """Light against thickness, and a slice that may or may not be below nothing."""
    figure, drawings = sheet([1.3, 1, 1], 2.6)
    thick = np.linspace(0, 100, 200)
    for extinction, colour in zip((0.01, 0.03, 0.1), LINES, strict=True):
        drawings[0].plot(thick, np.exp(-extinction * thick), color=colour, lw=2, label=f"{extinction} per mm")
    drawings[0].set_xlabel("mm of glass", fontsize=8, color=INK)
    drawings[0].set_ylabel("light behind it", fontsize=8, color=INK)
    drawings[0].legend(fontsize=8, frameon=False)
    grid = lc.Grid((1, 8, 8))
    rows = lc.Projector(grid, lc.turntable(grid, [15, 75, 135])).to_sparse().toarray()
    rows = rows[rows.sum(axis=1) > 0]
    wanted = np.random.default_rng(4).uniform(0, 1, len(rows))
    free, real = np.linalg.lstsq(rows, wanted, rcond=None)[0], nnls(rows, wanted)[0]
    for drawing, found, title in zip(drawings[1:], (free, real), ("below nothing allowed", "real glass"), strict=True):
        drawing.imshow(found.reshape(8, 8), cmap="RdGy", vmin=-0.3, vmax=0.3, origin="lower")
        bare(drawing, title)
    return figure


if __name__ == "__main__":
    main()
