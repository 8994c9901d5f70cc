"""The command `lightcube view`."""

import webbrowser
from pathlib import Path, PurePosixPath
from typing import Annotated

import typer

from lightcube import io
from lightcube.cli.console import done, err, telling
from lightcube.cli.options import BY, JSON, NOTE, OVERWRITE, TITLE, threaded
from lightcube.io.outputs import Thing
from lightcube.jobs.reading import load
from lightcube.verbs import viewing
from lightcube.viewer.label import Label


@threaded
def view(
    cube: Annotated[str, typer.Argument(help="A cube.")],
    output: Annotated[
        str | None, typer.Option("-o", "--out", help="The page to write.  [default: the cube's name with .html, here]")
    ] = None,
    title: Annotated[str | None, TITLE] = None,
    by: Annotated[str, BY] = "",
    note: Annotated[str, NOTE] = "",
    preview: Annotated[
        bool, typer.Option("--preview", help="Write a picture of it too, a PNG beside the page, for who shares it.")
    ] = False,
    full: Annotated[
        bool, typer.Option("--full", help="Keep all voxels of a cube of more than 128 along a side.")
    ] = False,
    show: Annotated[bool, typer.Option("--open", help="Open the page in a browser.")] = False,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Write a page in which the cube is turned by hand: one HTML file, for any browser, to keep or to mail."""
    target = f"{io.bare_name(cube)}.html" if output is None else output
    picture = f"{target.removesuffix('.html').removesuffix('.htm')}.png" if preview else ""
    label = Label(io.bare_name(cube) if title is None else title, by, note, PurePosixPath(picture).name)
    page_file = io.Output(target, "page", overwrite)
    picture_file = io.Output(picture, "picture", overwrite)
    page_file.check()
    if preview:
        picture_file.check()
    loaded = load(cube)
    is_smaller = viewing.is_solved_anew(loaded, full=full)
    doing = "solving a smaller cube for the page" if is_smaller else "putting the page together"
    if not as_json:
        err.print(f"{doing} ...")
    with telling(doing, as_json=as_json) as tell:
        page = viewing.page(loaded, label, tell, full=full)
    things: list[tuple[io.Output, Thing]] = [(page_file, page.text)]
    if preview:
        things.append((picture_file, viewing.preview(loaded)))
    io.write_together(*things)
    if not as_json and is_smaller:
        both = _voxels(page.shape), _voxels(loaded.grid.shape)
        err.print(f"it holds {both[0]} voxels, solved anew for the pictures of {both[1]}: --full keeps all")
    size = len(page.text.encode())
    done(
        as_json,
        f"{target}, {size / 1e6:.1f} MB; its shadows are off by at most {page.worst_levels:.1f} of 255 levels "
        f"({page.rms_levels:.2f} on average)",
        out=target,
        bytes=size,
        shape=page.shape,
        worst_levels=page.worst_levels,
        rms_levels=page.rms_levels,
    )
    if show:
        webbrowser.open(target if "://" in target else Path(target).absolute().as_uri())


def _voxels(shape: tuple[int, int, int]) -> str:
    nz, ny, nx = shape
    return f"{nx} x {ny} x {nz}"
