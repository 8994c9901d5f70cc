"""The command `lightcube view`."""

import webbrowser
from pathlib import Path, PurePosixPath
from typing import Annotated

import typer

from lightcube import io
from lightcube.cli.console import compiling, done, err, telling
from lightcube.cli.options import BY, JSON, NOTE, OVERWRITE, TITLE, threaded
from lightcube.drawing.relief_sheet import relief_preview
from lightcube.errors import InputError
from lightcube.io.outputs import Thing
from lightcube.jobs.reading import load
from lightcube.optics.cube import Cube
from lightcube.optics.stack import Stack
from lightcube.solids.relief import Relief
from lightcube.verbs import viewing
from lightcube.viewer.label import Label
from lightcube.viewer.page import films_page, relief_page
from lightcube.wording import counted


@threaded
def view(
    cube: Annotated[str, typer.Argument(help="A cube, a shape, films, or a relief.")],
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
    """Write a page in which the cube, or a relief's lamp, is turned by hand: one HTML file, to keep or to mail."""
    target = f"{io.bare_name(cube)}.html" if output is None else output
    picture = f"{target.removesuffix('.html').removesuffix('.htm')}.png" if preview else ""
    label = Label(io.bare_name(cube) if title is None else title, by, note, PurePosixPath(picture).name)
    page_file = io.Output(target, "page", overwrite)
    picture_file = io.Output(picture, "picture", overwrite)
    page_file.check()
    if preview:
        picture_file.check()
    if io.is_relief(cube):
        if full:
            raise InputError(f"{cube} is a relief, of which a page keeps all: leave out --full")
        _view_relief(io.read_relief(cube), label, page_file, picture_file if preview else None, as_json=as_json)
        _show(target, show=show)
        return
    loaded = load(cube)
    if isinstance(loaded.grid, Stack):
        if full:
            raise InputError(f"{cube} is of films, of which a page keeps all: leave out --full")
        _view_films(loaded, label, page_file, picture_file if preview else None, as_json=as_json)
        _show(target, show=show)
        return
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
    _show(target, show=show)


def _view_relief(relief: Relief, label: Label, page: io.Output, picture: io.Output | None, *, as_json: bool) -> None:
    """Write the page of a relief, and a picture of it where one is asked for."""
    with compiling(as_json=as_json):
        text = relief_page(relief, label)
    things: list[tuple[io.Output, Thing]] = [(page, text)]
    if picture is not None:
        things.append((picture, relief_preview(relief)))
    io.write_together(*things)
    rows, columns = relief.heights_px.shape
    size, shape = len(text.encode()), (rows, columns)
    told = f"{page.path}, {size / 1e6:.1f} MB; {columns} x {rows} columns, whose light the page casts exactly"
    done(as_json, told, out=str(page.path), bytes=size, shape=shape)


def _view_films(cube: Cube, label: Label, page: io.Output, picture: io.Output | None, *, as_json: bool) -> None:
    """Write the page of a stack of films, and a picture of it where one is asked for."""
    text = films_page(cube, label)
    things: list[tuple[io.Output, Thing]] = [(page, text)]
    if picture is not None:
        things.append((picture, viewing.preview(cube)))
    io.write_together(*things)
    films, rows, columns = cube.grid.shape
    size, kept = len(text.encode()), f"{counted(films, 'film')} of {columns} x {rows} cells"
    told = f"{page.path}, {size / 1e6:.1f} MB; {kept}, whose light the page casts exactly"
    done(as_json, told, out=str(page.path), bytes=size, shape=cube.grid.shape)


def _show(target: str, *, show: bool) -> None:
    """Open a page in a browser, if that is asked for."""
    if show:
        webbrowser.open(target if "://" in target else Path(target).absolute().as_uri())


def _voxels(shape: tuple[int, int, int]) -> str:
    nz, ny, nx = shape
    return f"{nx} x {ny} x {nz}"
