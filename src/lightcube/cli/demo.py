"""The demonstrations: photographs and a traced scene in a cube, and the paper's own experiment."""

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from numpy.typing import NDArray

from lightcube import io
from lightcube.backward import solving
from lightcube.backward.recipe import Recipe
from lightcube.cli.console import compiling, out, progress
from lightcube.cli.options import threaded
from lightcube.drawing.films import film
from lightcube.drawing.sheet import contact_sheet
from lightcube.forward import casting
from lightcube.kernels.layout import columns_from_volume, pictures_from_columns, volume_from_columns
from lightcube.optics.absorption import extinction, transmittance
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.rig import turntable
from lightcube.optics.views import spread_angles
from lightcube.pictures.samples import photographs
from lightcube.pictures.targets import Targets
from lightcube.planning.plan import plan
from lightcube.projection.projector import Projector
from lightcube.scene.tracer import scene_targets
from lightcube.scoring import metrics
from lightcube.solvers import METHODS
from lightcube.solvers.contract import Wanted
from lightcube.viewer.page import page

_SIDE = 64


@threaded
def demo(
    output: Annotated[Path, typer.Option("-o", "--out", help="Folder for what the demo makes.")] = Path("out"),
    as_in_the_paper: Annotated[
        bool, typer.Option("--paper", help="Redo the paper: a 3x3x3 cube, there and back.")
    ] = False,
) -> None:
    """Make a cube of photographs and one of a traced scene, into a folder."""
    with compiling(as_json=False):
        (paper if as_in_the_paper else run)(output)


def run(folder: Path) -> None:
    """Solve, play and score a cube of photographs and a cube of a traced scene, into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    grid = Grid((_SIDE, _SIDE, _SIDE), 100 / _SIDE)
    out.print(f"Two cubes of {_SIDE} x {_SIDE} x {_SIDE} voxels, 100 mm wide.")
    planned = plan(photographs(), _SIDE, longest_hold=True, smooth=True)
    rows = [
        _one("photographs", planned.targets, grid, folder, planned.recipe),
        _one("juggler", _juggler(grid), grid, folder, replace(planned.recipe, light=None)),
    ]
    io.save({row["name"]: row for row in rows}, folder / "metrics.json", overwrite=True)
    out.print()
    out.print(
        f"{'cube':>14} {'pictures':>16} {'lamp':>6} {'PSNR':>8} {'worst':>7} {'SSIM':>7} {'dE2000':>7} {'time':>7}"
    )
    for row in rows:
        out.print(
            f"{row['name']:>14} {row['size']:>16} {row['elevation_deg']:>5.0f}° {row['psnr_mean']:>5.1f} dB "
            f"{row['psnr_min']:>4.1f} dB {row['ssim_mean']:>7.3f} {row['delta_e_mean']:>7.2f} {row['seconds']:>5.0f} s"
        )
    out.print(f"\nLook at the movies and contact sheets in {folder}/. Turn the cubes by hand: open, in a browser,")
    for row in rows:
        out.print(f"  {folder / row['name']}.html")


def _juggler(grid: Grid) -> Targets:
    """A traced scene, one picture for every step of a whole turn of the cube under a raised lamp."""
    rig = turntable(grid, spread_angles(24, elevation_deg=35.0), elevation_deg=35.0, picture_shape=(32, 32))
    with progress("tracing", as_json=False) as advance:
        return scene_targets(io.read_scene("juggler"), rig, grid, callback=advance)


def _one(name: str, targets: Targets, grid: Grid, folder: Path, recipe: Recipe) -> dict[str, Any]:
    """Solve, save, play and score one cube; returns a row of the table."""
    began = time.monotonic()
    with progress(f"solving {name}", as_json=False) as advance:
        solution = solving.solve(targets, grid, recipe, callback=lambda step: advance(round(1000 * step.done), 1000))
    seconds = time.monotonic() - began
    scores = metrics.score(solution.cube, targets)
    cube = replace(solution.cube, scores=scores)
    io.save(cube, folder / f"{name}.zarr", overwrite=True)
    shown = casting.play(cube, picture_only=True)
    sheet = contact_sheet(shown, targets, [view["psnr"] for view in scores["pictures"]])
    io.save(sheet, folder / f"{name}.png", overwrite=True)
    stops = _on_a_screen(casting.cast(cube))
    io.save(
        stops, folder / f"{name}-stops.mp4", count=len(targets), fps=min(10, len(targets) / 4), scale=6, overwrite=True
    )
    movie = film(cube, format="square", captions=True)
    io.save(movie, folder / f"{name}-turn.mp4", fps=movie.fps, shared=True, overwrite=True)
    io.save(page(cube, name), folder / f"{name}.html", overwrite=True)
    rows, columns = targets.rig.picture_shape
    return {
        "name": name,
        "size": f"{len(targets)} of {columns} x {rows}",
        "elevation_deg": targets.rig.elevation_deg,
        "seconds": seconds,
        **scores,
    }


def _on_a_screen(pictures: Iterator[NDArray[np.float32]]) -> Iterator[NDArray[np.float32]]:
    """Pictures no brighter than a screen's white: around the cube a strong lamp is."""
    return (np.minimum(picture, 1) for picture in pictures)


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
    out.print("Its pictures at 8 angles over 180 degrees, and back (float64):")
    for method in ("row-reduction", "gauss-seidel"):
        found = METHODS[method].solve(matrix, wanted, iterations=5000)
        wrong = _largest_error(volume_from_columns(found.x, grid.shape, 3), truth)
        out.print(
            f"  {method:>14}: largest error of a voxel {wrong:.1e} of the darkest, {len(found.rejected)} rejected"
        )


def _largest_error(found: NDArray[np.floating], truth: NDArray[np.floating]) -> float:
    return float(np.max(np.abs(found - truth)) / np.max(truth))
