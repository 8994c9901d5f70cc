"""The command `lightcube score`."""

from pathlib import Path
from typing import Annotated

import typer

from lightcube import io
from lightcube.cli import printing
from lightcube.cli.console import compiling, json_document, progress
from lightcube.cli.options import JSON, OVERWRITE
from lightcube.drawing import plots
from lightcube.drawing.sheet import contact_sheet
from lightcube.errors import InputError
from lightcube.forward import casting
from lightcube.jobs.cubes import load
from lightcube.pictures.fitting import frames_from_targets
from lightcube.scoring import between, metrics
from lightcube.scoring.robust import robust as measure_robust
from lightcube.verbs.wanted import refitted


def score(
    cube: Annotated[str, typer.Argument(help="A cube.")],
    frames: Annotated[
        str | None, typer.Argument(help="The pictures it was made from; default its own targets.")
    ] = None,
    sheet: Annotated[
        str | None, typer.Option(help="Draw a contact sheet: wanted, shown, difference (PNG, WebP or JPEG).")
    ] = None,
    between_frames: Annotated[
        bool, typer.Option("--between", help="Add PSNR and SSIM between the frames, and how far each one stands.")
    ] = False,
    robust: Annotated[bool, typer.Option("--robust", help="Add what a set-up that is a little off costs.")] = False,
    plot: Annotated[str | None, typer.Option(help="Draw PSNR against the angle (PNG or SVG); --between.")] = None,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Compare what a cube really casts with what was wanted."""
    if sheet is not None:
        io.check_sheet_target(sheet, overwrite=overwrite)
    if plot is not None and sheet is not None and Path(plot) == Path(sheet):
        raise InputError(f"--sheet and --plot both name {plot}: give them two names")
    if plot is not None:
        io.check_figure_target(plot, overwrite=overwrite)
    loaded = load(cube)
    wanted = frames_from_targets(loaded) if frames is None else refitted(loaded, frames)
    with compiling(as_json=as_json):
        scores = metrics.score(loaded, wanted)
    if between_frames or plot is not None:
        with progress("between the frames", as_json=False) as advance:  # what is printed is one document
            curve = between.curve(loaded, wanted, callback=advance)
        columns = {"angles": curve.angles, "nearest": curve.nearest, "psnr": curve.psnr, "ssim": curve.ssim}
        scores["between"] = {name: column.tolist() for name, column in {**columns, "lobe_deg": curve.lobes}.items()}
        if plot is not None:
            io.write_figure(plot, plots.between_plot({"": curve}), overwrite=overwrite)
    if robust:
        with progress("a set-up that is off", as_json=False) as advance:
            scores["robust"] = measure_robust(loaded, wanted, callback=advance)
    if sheet is not None:
        shown = casting.play(loaded)
        picture = contact_sheet(shown, wanted, [view["psnr"] for view in scores["views"]])
        io.write_sheet(sheet, picture, overwrite=overwrite)
    if as_json:
        json_document(scores)
    else:
        printing.scored(scores)
