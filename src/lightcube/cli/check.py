"""The command `lightcube check`."""

from typing import Annotated

import typer

from lightcube import io
from lightcube.cli.console import err, json_document, out, telling
from lightcube.cli.fields import one_by_one
from lightcube.cli.hull import INVERT, SOURCES, THRESHOLD, WALLS
from lightcube.cli.options import JSON, OVERWRITE, VERBOSE, threaded
from lightcube.errors import InputError
from lightcube.verbs import checking, hull_words, hulls, solving
from lightcube.verbs.options import Options


@threaded
@one_by_one
def check(
    pictures: SOURCES,
    options: Options,
    sheet: Annotated[
        str | None,
        typer.Option(
            help="Draw what will be asked for: each picture, what is cut off, what is left (PNG, WebP or JPEG).",
            rich_help_panel="Output",
        ),
    ] = None,
    opaque: Annotated[
        bool,
        typer.Option(
            "--opaque",
            help="Whether an opaque object can cast them, and what is in the way.",
            rich_help_panel="Pictures",
        ),
    ] = False,
    walls: Annotated[bool, WALLS] = False,
    threshold: Annotated[float | None, THRESHOLD] = None,
    invert: Annotated[bool | None, INVERT] = None,
    maps: Annotated[
        str | None,
        typer.Option(
            "--map",
            help="With --opaque: write maps of what cannot be cast, coloured by what is in the way, into this folder.",
            rich_help_panel="Output",
        ),
    ] = None,
    overwrite: Annotated[bool, OVERWRITE] = False,
    verbose: Annotated[bool, VERBOSE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Say before solving what can be known: how good it will be, what contradicts itself, or on a stage cannot be.

    The exit code is 2 where anything on a stage is impossible; with --opaque it is 0 where the silhouettes can be built
    in one piece, 3 where they cannot without small changes, 4 where they contradict each other too much.
    """
    how = hulls.Cutting(threshold, invert, walls)
    if opaque:
        if sheet is not None or options.paper:
            raise InputError("--sheet and --paper are for cubes of glass: leave them out with --opaque")
        _check_opaque(pictures, options, how, maps, overwrite=overwrite, as_json=as_json)
        return
    if maps is not None or how != hulls.Cutting():
        raise InputError("--walls, --threshold, --invert and --map are for opaque objects: say --opaque too")
    if len(pictures) > 1:
        raise InputError("more than one place is for opaque objects: put all pictures into one folder, or say --opaque")
    sheet_file = None if sheet is None else io.Output(sheet, "picture", overwrite)
    if sheet_file is not None:
        sheet_file.check()
    planning = solving.read(pictures[0], options)
    with telling("planning", as_json=as_json) as tell:
        small = solving.rehearsals(None if as_json else tell)  # a document is all that is printed
        # all that would help contradicts the paper
        planned = planning(small)
        found = checking.check(planned, small, advise=not options.paper)
    if sheet_file is not None:
        sheet_file.write(checking.sheet(planned))
    if as_json:
        json_document(found.facts)
    else:
        for line in [*found.lines, *(["", *found.figures] if verbose else [])]:
            out.print(line)
        for sentence in found.impossible:
            err.print(f"impossible: {sentence}")
    if found.impossible:
        raise typer.Exit(2)


def _check_opaque(
    pictures: list[str], options: Options, how: hulls.Cutting, maps: str | None, *, overwrite: bool, as_json: bool
) -> None:
    """Say whether an opaque object can cast silhouettes."""
    from lightcube.verbs import building  # here: who asks for glass does without

    folder = None if maps is None else io.Output(maps, "pictures", overwrite)
    if folder is not None:
        folder.check()
    with telling("checking", as_json=False):  # what is printed is one document
        wanted = hulls.read(pictures, options, how)
        found = building.check(wanted, is_walls=how.is_walls)
    doubts = hull_words.doubts(wanted)
    if folder is not None:
        folder.write(found.maps(), names=list(wanted.silhouettes.names), scale=4)
    if as_json:
        json_document({**found.facts, "doubts": doubts})
    else:
        for line in [*hull_words.in_short(wanted), *(f"note: {each}" for each in doubts)]:
            err.print(line)
        for line in building.lines(found):
            out.print(line)
    if code := building.EXIT[found.verdict]:
        raise typer.Exit(code)
