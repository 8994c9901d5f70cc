"""The commands `lightcube score` and `info`."""

from pathlib import Path
from typing import Annotated

import typer

from lightcube import io
from lightcube.cli import arguments, printing
from lightcube.cli.console import json_document, out, progress
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
    sheet_file = None if sheet is None else io.Output(sheet, "picture", overwrite)
    plot_file = None if plot is None else io.Output(plot, "plot", overwrite)
    if plot is not None and sheet is not None and Path(plot) == Path(sheet):
        raise InputError(f"--sheet and --plot both name {plot}: give them two names")
    for file in (sheet_file, plot_file):
        if file is not None:
            file.check()
    loaded = load(cube)
    wanted = frames_from_targets(loaded) if frames is None else refitted(loaded, frames)
    scores = metrics.score(loaded, wanted)
    if between_frames or plot is not None:
        with progress("between the frames", as_json=False) as advance:  # what is printed is one document
            curve = between.curve(loaded, wanted, callback=advance)
        columns = {"angles": curve.angles, "nearest": curve.nearest, "psnr": curve.psnr, "ssim": curve.ssim}
        scores["between"] = {name: column.tolist() for name, column in {**columns, "lobe_deg": curve.lobes}.items()}
        if plot_file is not None:
            plot_file.write(plots.between_plot({"": curve}))
    if robust:
        with progress("a set-up that is off", as_json=False) as advance:
            scores["robust"] = measure_robust(loaded, wanted, callback=advance)
    if sheet_file is not None:
        shown = casting.play(loaded)
        picture = contact_sheet(shown, wanted, [view["psnr"] for view in scores["views"]])
        sheet_file.write(picture)
    if as_json:
        json_document(scores)
    else:
        printing.scored(scores)


def info(
    cube: Annotated[str, typer.Argument(help="A cube.")],
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say what is in a cube file."""
    facts = metrics.facts(load(cube))
    if as_json:
        json_document(facts)
        return
    for name, value in facts.items():
        out.print(f"{name:>26}  {arguments.short(value)}")
