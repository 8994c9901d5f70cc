"""The command `lightcube trace`."""

from typing import Annotated

import typer

from lightcube import io
from lightcube.cli import arguments
from lightcube.cli.console import done, telling
from lightcube.cli.options import FPS, JSON, OUT, OVERWRITE, threaded
from lightcube.verbs import tracing
from lightcube.wording import counted


@threaded
def trace(
    scene: Annotated[
        str, typer.Argument(help="A scene file (TOML), or the name of a scene that comes with lightcube.")
    ],
    output: Annotated[str, OUT],
    count: Annotated[int | None, typer.Option(help="Number of pictures; default the scene's own.")] = None,
    size: Annotated[
        str | None, typer.Option(help="Size of the pictures, WIDTHxHEIGHT; default the scene's own.")
    ] = None,
    span_deg: Annotated[float | None, typer.Option(help="Degrees that the pictures are spread over.")] = None,
    elevation_deg: Annotated[float | None, typer.Option(help="Elevation of the lamp in degrees.")] = None,
    fps: Annotated[float, FPS] = 25.0,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Ray-trace a moving scene: a folder of PNGs, or a movie by suffix."""
    described = io.read_scene(scene)
    movie = io.Output(output, "pictures", overwrite)
    movie.check()
    shape = None
    if size is not None:
        width, height = arguments.whole_numbers(size, "x", "--size", 2)
        shape = (width, height)
    with telling("tracing", as_json=as_json) as tell:
        made = tracing.trace(described, tell, count=count, size=shape, span_deg=span_deg, elevation_deg=elevation_deg)
    movie.write(made.pictures, fps=fps, views=made.rig.views)
    rows, columns = made.rig.picture_shape
    done(
        as_json, f"{counted(len(made), 'picture')} of {columns} x {rows} in {output}", out=str(output), count=len(made)
    )
