"""The command `lightcube draw`."""

from pathlib import PurePath
from typing import Annotated

import typer

from lightcube import io
from lightcube.cli.console import done
from lightcube.cli.options import JSON, OVERWRITE
from lightcube.errors import InputError
from lightcube.jobs.reading import load
from lightcube.verbs import drawing


def draw(
    thing: Annotated[str, typer.Argument(metavar="STAGE|CUBE", help="A stage (TOML), or a cube or stack.")],
    output: Annotated[
        str,
        typer.Option(
            "-o",
            "--out",
            help="Where to write: an SVG of a stage or of films, a PNG, WebP or JPEG of a room.",
            rich_help_panel="Output",
        ),
    ],
    angle_deg: Annotated[
        float | None, typer.Option(help="Turntable angle of a cube's room in degrees.  [default: its first stop]")
    ] = None,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Draw a stage from above and from the side, with its beams, or the room of a cube in perspective.

    Films are drawn as they are put together: heights, gaps, lamps, and what each shows.
    """
    if io.is_stage(thing):
        if angle_deg is not None:
            raise InputError("--angle-deg is for a cube: a stage is drawn at its first stop, leave it out")
        plan = io.Output(output, "drawing", overwrite)
        plan.check()
        plan.write(drawing.of_stage(thing))
    elif PurePath(output).suffix.lower() == ".svg":
        plan = io.Output(output, "drawing", overwrite)
        plan.check()
        if angle_deg is not None:
            raise InputError("--angle-deg is for a room: films are drawn as they are put together, leave it out")
        plan.write(drawing.of_films(load(thing)))
    else:
        picture = io.Output(output, "picture", overwrite)
        picture.check()
        picture.write(drawing.of_cube(load(thing), angle_deg))
    done(as_json, output, out=output)
