"""The command `lightcube calibrate`."""

from typing import Annotated, Literal

import typer

from lightcube.calibration.wedge import Wedge, page
from lightcube.cli.console import done, err
from lightcube.cli.options import JSON, OUT, OVERWRITE
from lightcube.errors import InputError
from lightcube.io import Output
from lightcube.optics.transfer import Transfer
from lightcube.verbs import calibrating

WHAT = typer.Argument(metavar="wedge|fit", help="Make the page that is to be printed, or read it again.")
SOURCE = typer.Argument(
    metavar="PHOTO|TABLE", help="Of fit: a photograph of the printed page, or densities (CSV).", show_default=False
)
INKS = typer.Option(help="The inks of the page, with commas.", rich_help_panel="Material")
STEPS = typer.Option(help="Steps of each ink: 16 or 32.", rich_help_panel="Material")
DPI = typer.Option(help="Dots an inch of the page, 50 to 1200 pixels.", rich_help_panel="Output")
TRANSFER = typer.Option(help="What the photograph's values mean: srgb, or linear light.", rich_help_panel="Pictures")


def calibrate(
    what: Annotated[Literal["wedge", "fit"], WHAT],
    output: Annotated[str, OUT],
    source: Annotated[str | None, SOURCE] = None,
    inks: Annotated[str, INKS] = "cyan,magenta,yellow,black",
    steps: Annotated[int, STEPS] = 16,
    dpi: Annotated[int, DPI] = 300,
    transfer: Annotated[Transfer, TRANSFER] = "srgb",
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Print a page of patches, photograph it, and know your own inks."""
    names = tuple(name.strip() for name in inks.split(","))
    if what == "wedge":
        if source is not None:
            raise InputError(f"lightcube calibrate wedge reads nothing, and {source} was given: leave it out")
        target = Output(output, "picture", overwrite)
        target.check()
        target.write(page(Wedge(names, steps), dpi))
        size = f"A4 at {dpi} dots an inch: print it at 100 %, without colour management"
        done(as_json, f"{output} is {size}", out=output, inks=list(names), steps=steps)
        return
    if source is None:
        raise InputError("lightcube calibrate fit takes a photograph, as in calibrate fit photo.png -o inkjet.toml")
    target = Output(output, "material", overwrite)
    target.check()
    found = calibrating.fitted(source, names, steps, transfer)
    target.write(found.dyes)
    if not as_json:
        for line in calibrating.in_words(found):
            err.print(line)
    said = f"{output} is measured: lightcube solve photos -o cube.zarr --material {output}"
    done(as_json, said, out=output, residual=found.residual, doubtful=found.said, dyes=found.dyes.plain())
