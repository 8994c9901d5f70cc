"""The command `lightcube materials`."""

from typing import Annotated, Literal

import typer

from lightcube import io
from lightcube.cli import arguments
from lightcube.cli.console import json_document, out
from lightcube.cli.options import JSON
from lightcube.errors import InputError
from lightcube.verbs import materials as verb

WHAT = typer.Argument(metavar="list|show", help="List the materials that come along, or show one.")
NAME = typer.Argument(metavar="NAME|FILE", help="Of show: one of those, or a file (TOML).", show_default=False)


def materials(
    what: Annotated[Literal["list", "show"], WHAT] = "list",
    name: Annotated[str | None, NAME] = None,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say what inks, resins and filaments there are, and what each absorbs."""
    if what == "list":
        if name is not None:
            raise InputError(f"lightcube materials list takes no name: lightcube materials show {name} says more of it")
        if as_json:
            json_document({"materials": io.material_names()})
            return
        for line in verb.listed():
            out.print(line)
        return
    if name is None:
        raise InputError("lightcube materials show takes the name or the file of a material, as in show polyjet")
    dyes = io.read_dyes(name)
    known = verb.facts(dyes)
    if as_json:
        json_document(known)
        return
    for key, value in known.items():
        out.print(f"{key:>26}  {arguments.short(value)}")
    for line in verb.in_words(dyes):
        out.print(line)
