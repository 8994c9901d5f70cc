"""The demonstrations: three small wonders, and the paper's own experiment."""

import time
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from numpy.typing import NDArray

from lightcube import io
from lightcube.backward import solving
from lightcube.cli.console import compiling, out, progress
from lightcube.cli.options import threaded
from lightcube.drawing.films import film
from lightcube.drawing.sheet import contact_sheet
from lightcube.drawing.small import small_cube
from lightcube.drawing.tableau import tableau
from lightcube.forward import casting
from lightcube.kernels.layout import columns_from_volume, pictures_from_columns, volume_from_columns
from lightcube.optics.absorption import extinction, transmittance
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.setups import turntable
from lightcube.optics.transfer import to_uint8
from lightcube.optics.views import spread_angles
from lightcube.projection.projector import Projector
from lightcube.report.gallery import Card, gallery
from lightcube.scoring import metrics
from lightcube.solvers import METHODS
from lightcube.solvers.contract import Wanted
from lightcube.verbs import words
from lightcube.verbs.wonders import SIDE, SIZE_MM, WONDERS, Wonder
from lightcube.viewer.page import page
from lightcube.wording import counted

#: What is seen of a cube on the page of all: rows and columns.
_SEEN = (450, 600)


@threaded
def demo(
    output: Annotated[
        Path, typer.Option("-o", "--out", help="Folder for what the demo makes.", rich_help_panel="Output")
    ] = Path("out"),
    as_in_the_paper: Annotated[
        bool, typer.Option("--paper", help="Redo the paper: a 3x3x3 cube, there and back, and a drawing of it.")
    ] = False,
) -> None:
    """Make three small cubes to be turned by hand, and one page that shows them, into a folder."""
    with compiling(as_json=False):
        (paper if as_in_the_paper else run)(output)


def run(folder: Path) -> None:
    """Solve, play and score three cubes, into `folder`, and write the page that shows them all."""
    folder.mkdir(parents=True, exist_ok=True)
    out.print(f"{counted(len(WONDERS), 'cube')} of {SIDE} x {SIDE} x {SIDE} voxels, {SIZE_MM:g} mm wide.")
    cards, rows = [], {}
    for wonder in WONDERS:
        cube, seconds = _made(wonder, folder)
        rows[wonder.name] = {"seconds": seconds, **cube.scores}
        good = words.judged(cube.names, [view["psnr"] for view in cube.scores["pictures"]], "are", cube.rig)
        out.print(f"{wonder.title}, after {words.duration(seconds)}. {good}")
        seen = to_uint8(tableau(cube, float(cube.angles_deg[0]), _SEEN), cube.transfer)
        cards.append(Card(wonder.title, wonder.said, seen, f"{wonder.name}.html"))
    io.save(rows, folder / "metrics.json", overwrite=True)
    told = "Light falls through a block of coloured glass; at each stop of the turntable its shadow is another picture."
    own = ["lightcube solve photos -o cube.zarr", "lightcube view cube.zarr -o cube.html --open"]
    io.save(gallery("Three light cubes", told, cards, own), folder / "index.html", overwrite=True)
    out.print(f"\nOpen {folder / 'index.html'} in a browser: it shows the three, to be turned by hand.")
    out.print("With pictures of your own in the folder photos:")
    for command in own:
        out.print(f"  {command}")


def _made(wonder: Wonder, folder: Path) -> tuple[Cube, float]:
    """Solve, play and score a wonder; returns the cube and how many seconds it took to solve."""
    began = time.monotonic()
    targets, grid, recipe = wonder.make()
    with progress(f"solving {wonder.name}", as_json=False) as advance:
        solution = solving.solve(targets, grid, recipe, callback=lambda step: advance(round(1000 * step.done), 1000))
    seconds = time.monotonic() - began
    cube = replace(solution.cube, scores=metrics.score(solution.cube, targets))
    io.save(cube, folder / f"{wonder.name}.zarr", overwrite=True)
    sheet = contact_sheet(
        casting.play(cube, picture_only=True),
        targets,
        [view["psnr"] for view in cube.scores["pictures"]],
        wonder.title,
    )
    io.save(sheet, folder / f"{wonder.name}.png", overwrite=True)
    movie = film(cube, picture_only=True)
    io.save(movie, folder / f"{wonder.name}.mp4", fps=movie.fps, count=len(movie), scale=8, overwrite=True)
    io.save(page(cube, wonder.title), folder / f"{wonder.name}.html", overwrite=True)
    return cube, seconds


def paper(folder: Path) -> None:
    """Redo the paper: a random 3 x 3 x 3 cube, its 5 x 3 pictures (its Figure 2), and back by both of its methods."""
    folder.mkdir(parents=True, exist_ok=True)
    grid = Grid((3, 3, 3))
    truth = extinction(np.random.default_rng(2).uniform(0.3, 1.0, (3, 3, 3, 3)), grid.voxel_mm)
    x = columns_from_volume(truth)
    whole_turn = turntable(grid, np.arange(0, 360, 5.0))
    rows, columns = raster_shape(grid)
    shown = pictures_from_columns(transmittance(Projector(grid, whole_turn).forward(x)), (rows, columns), 3)
    io.save(shown.astype(np.float32), folder / "paper.gif", fps=12, scale=48, overwrite=True)
    out.print(f"A random cube of 3 x 3 x 3 voxels turns: {columns} x {rows} pictures in {folder}/paper.gif")
    views = turntable(grid, spread_angles(8))
    matrix = Projector(grid, views)
    wanted = Wanted(transmittance(matrix.forward(x)))
    angles_deg = views.views.angles_deg
    drawn = pictures_from_columns(wanted.light, (rows, columns), 3)
    io.save(
        small_cube(np.exp(-truth * grid.voxel_mm * np.sqrt(2)), drawn, angles_deg), folder / "paper.png", overwrite=True
    )
    out.print(f"The cube and its pictures at 8 angles over 180 degrees are drawn in {folder}/paper.png")
    out.print("Back from these pictures (float64):")
    for method in ("row-reduction", "gauss-seidel"):
        found = METHODS[method].solve(matrix, wanted, iterations=5000)
        wrong = _largest_error(volume_from_columns(found.x, grid.shape, 3), truth)
        out.print(
            f"  {method:>14}: largest error of a voxel {wrong:.1e} of the darkest, {len(found.rejected)} rejected"
        )


def _largest_error(found: NDArray[np.floating], truth: NDArray[np.floating]) -> float:
    return float(np.max(np.abs(found - truth)) / np.max(truth))
