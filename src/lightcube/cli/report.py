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
    cube: Annotated[str, typer.Argument(help="A cube, a shape, or a relief.")],
    pictures: Annotated[
        str | None, typer.Argument(help="The pictures a cube was made from; default its own targets.")
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
    if io.is_shape(cube) or io.is_relief(cube):
        if pictures is not None:
            raise InputError(f"{cube} keeps its own pictures: leave out {pictures}")
        _solid(cube, label, page_file, as_json=as_json)
        return
    loaded = load(cube)
    with telling("measuring", as_json=as_json) as tell:
        made = reporting.report(loaded, cube, pictures, tell, label)
    _written(page_file, made, as_json=as_json)


def _solid(path: str, label: Label, page: io.Output, *, as_json: bool) -> None:
    """Report on a shape or a relief."""
    with telling("measuring", as_json=as_json) as tell:
        if io.is_shape(path):
            made = reporting.shape_report(io.read_shape(path), path, label, tell)
        else:
            made = reporting.relief_report(io.read_relief(path), path, label, tell)
    _written(page, made, as_json=as_json)


def _written(page: io.Output, made: reporting.Report, *, as_json: bool) -> None:
    """Write a report, and say how good the thing is."""
    page.write(made.text)
    size, scores = len(made.text.encode()), made.scores
    if "overlap_mean" in scores:
        how = f"shadows overlap by {scores['overlap_mean']:.2%} (worst {scores['overlap_min']:.2%})"
    else:
        how = f"mean PSNR {scores['psnr_mean']:.2f} dB (worst {scores['psnr_min']:.2f})"
    kept = {name: value for name, value in scores.items() if name != "pictures"}
    done(as_json, f"{page.path}, {size / 1e6:.1f} MB: {how}", out=str(page.path), bytes=size, **kept)
