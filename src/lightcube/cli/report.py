"""The command `lightcube report`."""

from typing import Annotated

import typer

from lightcube import io
from lightcube.cli.console import done, telling
from lightcube.cli.options import BY, JSON, NOTE, OVERWRITE, TITLE, threaded
from lightcube.errors import InputError
from lightcube.jobs.reading import load
from lightcube.verbs import reporting
from lightcube.viewer.label import Label


@threaded
def report(
    cube: Annotated[str, typer.Argument(help="A cube.")],
    pictures: Annotated[
        str | None, typer.Argument(help="The pictures it was made from; default its own targets.")
    ] = None,
    output: Annotated[
        str | None,
        typer.Option("-o", "--out", help="The page to write.  [default: the cube's name, -report.html, here]"),
    ] = None,
    title: Annotated[str | None, TITLE] = None,
    by: Annotated[str, BY] = "",
    note: Annotated[str, NOTE] = "",
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Write all that is known of a cube into one HTML file, to keep and to print: pictures, curves, how it was made."""
    target = f"{io.bare_name(cube)}-report.html" if output is None else output
    label = Label(io.bare_name(cube) if title is None else title, by, note)
    page_file = io.Output(target, "page", overwrite)
    page_file.check()
    if io.is_shape(cube):
        raise InputError(f"{cube} is a shape, and reports are of cubes: lightcube score and view take it")
    loaded = load(cube)
    with telling("measuring", as_json=as_json) as tell:
        made = reporting.report(loaded, cube, pictures, tell, label)
    page_file.write(made.text)
    size, scores = len(made.text.encode()), made.scores
    done(
        as_json,
        f"{target}, {size / 1e6:.1f} MB: mean PSNR {scores['psnr_mean']:.2f} dB (worst {scores['psnr_min']:.2f})",
        out=target,
        bytes=size,
        **{name: value for name, value in scores.items() if name != "pictures"},
    )
