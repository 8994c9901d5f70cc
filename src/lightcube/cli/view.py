"""The command `lightcube view`."""

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from lightcube import io
from lightcube.cli.console import done, err, progress
from lightcube.cli.options import JSON, OVERWRITE
from lightcube.jobs.cubes import load
from lightcube.viewer import page, smaller
from lightcube.viewer.page import contents


def view(
    cube: Annotated[str, typer.Argument(help="A cube.")],
    output: Annotated[
        str | None, typer.Option("-o", "--out", help="The page to write.  [default: the cube's name with .html, here]")
    ] = None,
    full: Annotated[
        bool, typer.Option("--full", help="Keep all voxels of a cube of more than 128 along a side.")
    ] = False,
    show: Annotated[bool, typer.Option("--open", help="Open the page in a browser.")] = False,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Write a page in which the cube is turned by hand: one HTML file, for any browser, to keep or to mail."""
    title = io.bare_name(cube)
    target = f"{title}.html" if output is None else output
    page_file = io.Output(target, "page", overwrite)
    page_file.check()
    loaded = load(cube)
    is_smaller = not full and max(loaded.grid.shape) > smaller.MOST_SIDE
    doing = "solving a smaller cube for the page" if is_smaller else "putting the page together"
    if not as_json:
        err.print(f"{doing} ...")
    with progress(doing, as_json=as_json) as advance:
        description, packed = contents(
            loaded, title, full=full, callback=lambda step: advance(round(1000 * step.done), 1000)
        )
    text = page.page_of(description, packed)
    page_file.write(text)
    held, kept, size = description["voxels"]["shape"], description["kept"], len(text.encode())
    if not as_json and is_smaller:
        both = _voxels(held), _voxels(loaded.grid.shape)
        err.print(f"it holds {both[0]} voxels, solved anew for the pictures of {both[1]}: --full keeps all")
    done(
        as_json,
        f"{target}, {size / 1e6:.1f} MB; its shadows are off by at most {kept['worst_levels']:.1f} of 255 levels "
        f"({kept['rms_levels']:.2f} on average)",
        out=target,
        bytes=size,
        shape=held,
        worst_levels=kept["worst_levels"],
        rms_levels=kept["rms_levels"],
    )
    if show:
        webbrowser.open(target if "://" in target else Path(target).absolute().as_uri())


def _voxels(shape: tuple[int, int, int]) -> str:
    nz, ny, nx = shape
    return f"{nx} x {ny} x {nz}"
