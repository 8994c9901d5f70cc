"""The command `lightcube view`."""

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from lightcube import io
from lightcube.cli_options import JSON, OVERWRITE
from lightcube.console import done, err, progress
from lightcube.cube import Cube
from lightcube.viewer import described, packing, page, smaller


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
    io.check_page_target(target, overwrite=overwrite)
    loaded = io.load(cube)
    held = loaded if full else _smaller(loaded, as_json=as_json)
    with err.status("putting the page together"):
        packed = packing.pack(held)
        description = described.describe(loaded, packed, title)
        text = page.page_of(description, packed.data())
    io.write_page(target, text, overwrite=overwrite)
    if not as_json and held is not loaded:
        err.print(
            f"it holds {_voxels(held)} voxels, solved anew for the pictures of {_voxels(loaded)}: --full keeps all"
        )
    kept, size = description["kept"], len(text.encode())
    done(
        as_json,
        f"{target}, {size / 1e6:.1f} MB; its shadows are off by at most {kept['worst_levels']:.1f} of 255 levels "
        f"({kept['rms_levels']:.2f} on average)",
        out=target,
        bytes=size,
        shape=held.grid.shape,
        worst_levels=kept["worst_levels"],
        rms_levels=kept["rms_levels"],
    )
    if show:
        webbrowser.open(target if "://" in target else Path(target).absolute().as_uri())


def _smaller(cube: Cube, *, as_json: bool) -> Cube:
    """What the page holds of a cube; a smaller one takes a while to solve."""
    if max(cube.grid.shape) <= smaller.MOST_SIDE:
        return cube
    with progress("solving a smaller cube for the page", as_json=as_json) as advance:
        return smaller.smaller(cube, lambda step: advance(round(1000 * step.done), 1000))


def _voxels(cube: Cube) -> str:
    nz, ny, nx = cube.grid.shape
    return f"{nx} x {ny} x {nz}"
