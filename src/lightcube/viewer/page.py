"""One HTML file in which a cube is turned, with all that it needs inside."""

from __future__ import annotations

import base64
import html
import re
from collections.abc import Sequence
from hashlib import sha256
from typing import Any

from lightcube.backward.pieces import Watching
from lightcube.errors import InputError
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.stack import Stack
from lightcube.solids.relief import Relief
from lightcube.solids.shape import is_opaque
from lightcube.viewer.description import describe, zipped
from lightcube.viewer.films import WHAT as WHAT_FILMS
from lightcube.viewer.films import describe_films, films_data
from lightcube.viewer.label import Label
from lightcube.viewer.modules import joined, source
from lightcube.viewer.packing import pack
from lightcube.viewer.plate import WHAT, describe_relief, heights_data
from lightcube.viewer.smaller import in_cubes, smaller

#: What is run of the page's scripts: its policy knows them by their digests, and a browser runs no other.
_RUN = re.compile(r'<script(?: type="module")?>(.*?)</script>', re.DOTALL)
#: Pictures that are named where a page's address is shared.
_NAMED = 6


@checked
def page(cube: Cube | Relief, label: str | Label, *, full: bool = False, callback: Watching | None = None) -> str:
    """The text of a page that shows a cube, films or a relief, in any browser, from a file, without a network.

    Parameters
    ----------
    label
        For people; a text is a title.
    full
        Keep all voxels; else a `smaller` cube is solved for one of more than 128 along a side, and the page says so.
    callback
        Is told of every pass of that.

    Raises
    ------
    InputError
        Where the cube has other than 1 or 3 colours, more voxels than a browser takes, slices that are no whole voxels
        tall, or lamps at several elevations.
    """
    if isinstance(cube, Relief):
        return relief_page(cube, Label.of(label))
    if isinstance(cube.grid, Stack):
        return films_page(cube, Label.of(label))
    return page_of(Label.of(label), *contents(cube, label, full=full, callback=callback))


def parts_of(thing: Cube | Relief, label: str | Label) -> tuple[dict[str, Any], bytes]:
    """What the page's modules read of a cube, films or a relief: its description, and its voxels or heights."""
    if isinstance(thing, Relief):
        return describe_relief(thing, label), heights_data(thing)
    if isinstance(thing.grid, Stack):
        return describe_films(thing, label), films_data(thing)
    return contents(thing, label)


def relief_page(relief: Relief, label: Label) -> str:
    """The page in which the lamp goes round a relief."""
    description, heights = parts_of(relief, label)
    names = [picture["name"] for picture in description["pictures"]]
    return _put_together(label, description, heights, WHAT, names)


def films_page(cube: Cube, label: Label) -> str:
    """The page in which light falls through a stack of films, lamp by lamp."""
    return _put_together(label, *parts_of(cube, label), WHAT_FILMS, cube.names)


def page_of(label: Label, description: dict[str, Any], voxels: bytes) -> str:
    """The same of what `contents` returns."""
    what = "A solid stands in the light" if description["solid"] else "Light falls through a block of coloured glass"
    names = [picture["name"] for picture in description["pictures"] if not picture["mirrored"]]
    return _put_together(label, description, voxels, f"{what}, and its shadows are pictures", names)


def _put_together(label: Label, description: dict[str, Any], data: bytes, what: str, names: Sequence[str]) -> str:
    """The text of a page of a description and voxels or heights; `what` is to be seen, before its pictures' `names`."""
    parts = {
        "title": html.escape(description["title"]),
        "sharing": _sharing(label, description["title"], what, names),
        "what": html.escape(f"{what}."),
        "style": source("style.css"),
        "code": joined("page.js"),
        "scene": base64.b64encode(zipped(description)).decode(),
        "voxels": base64.b64encode(data).decode(),
    }
    template = source("page.html")
    run = (each.replace("{{code}}", parts["code"]) for each in _RUN.findall(template))
    parts["scripts"] = " ".join(f"'sha256-{base64.b64encode(sha256(each.encode()).digest()).decode()}'" for each in run)
    return re.sub(r"\{\{(\w+)\}\}", lambda found: parts[found[1]], template)


def _sharing(label: Label, title: str, what: str, names: Sequence[str]) -> str:
    """What is shown of the page where its address is shared (https://ogp.me)."""
    shown = ", ".join(names[:_NAMED]) + (f" and {len(names) - _NAMED} more" if len(names) > _NAMED else "")
    said = f"{what}: {shown}."
    told = {"og:type": "website", "og:title": title, "og:description": said, "og:image": label.picture}
    lines = [f'<meta name="description" content="{html.escape(said)}">']
    lines += [f'<meta property="{name}" content="{html.escape(text)}">' for name, text in told.items() if text]
    return "\n".join(lines)


def contents(
    cube: Cube, label: str | Label, *, full: bool = False, callback: Watching | None = None
) -> tuple[dict[str, Any], bytes]:
    """Description and voxels, as the page's modules read them; takes and raises what `page` does."""
    if isinstance(cube.grid, Stack):
        raise InputError("a notebook turns cubes, and these are films: write a page of them, lightcube view")
    cubic = in_cubes(cube)
    packed = pack(cubic if full or is_opaque(cube) else smaller(cubic, callback))
    return describe(cubic, packed, label), packed.data()
