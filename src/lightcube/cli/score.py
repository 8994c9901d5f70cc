"""The command `lightcube score`."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from lightcube import io
from lightcube.cli import arguments, printing
from lightcube.cli.console import json_document, out, telling
from lightcube.cli.fields import flag
from lightcube.cli.hull import INVERT, THRESHOLD, WALLS
from lightcube.cli.options import JSON, OVERWRITE, threaded
from lightcube.drawing.relief_sheet import relief_sheet
from lightcube.errors import InputError
from lightcube.fabrication.reading import is_exported
from lightcube.io.outputs import Thing
from lightcube.jobs.reading import load
from lightcube.optics.cube import Cube
from lightcube.pictures.targets import Targets
from lightcube.scoring.reliefs import score_relief
from lightcube.solids.reach import count_pieces
from lightcube.verbs import exporting, hull_words, hulls, meshes, photographing, reliefs, scoring
from lightcube.verbs.options import Options
from lightcube.verbs.refitting import wanted_of


@threaded
def score(
    cube: Annotated[
        str,
        typer.Argument(
            help="A cube, a shape, a relief, a mesh (.stl, .3mf, .obj, .ply), or an exported volume, slices or film.",
        ),
    ],
    pictures: Annotated[
        list[str] | None,
        typer.Argument(
            help="The pictures it was made from; default its own targets. Of an export, or its cube. A mesh has none: "
            "give what hull takes, or a shape.",
        ),
    ] = None,
    walls: Annotated[bool, WALLS] = False,
    threshold: Annotated[float | None, THRESHOLD] = None,
    invert: Annotated[bool | None, INVERT] = None,
    elevation_deg: Annotated[float | None, flag("elevation_deg")] = None,
    span_deg: Annotated[float | None, flag("span_deg")] = None,
    angles_deg: Annotated[str | None, flag("angles_deg")] = None,
    sheet: Annotated[
        str | None, typer.Option(help="Draw a contact sheet: shown beside wanted (PNG, WebP or JPEG).")
    ] = None,
    between_pictures: Annotated[
        bool, typer.Option("--between", help="Add PSNR and SSIM between the pictures, and how far each one stands.")
    ] = False,
    robust: Annotated[bool, typer.Option("--robust", help="Add what a set-up that is a little off costs.")] = False,
    plot: Annotated[str | None, typer.Option(help="Draw PSNR against the angle (PNG or SVG); --between.")] = None,
    photo: Annotated[
        str | None, typer.Option(help="Compare a photograph of the real thing with what was promised; with --stop.")
    ] = None,
    stop: Annotated[int | None, typer.Option(help="Number of the picture that --photo shows, from 1 on.")] = None,
    corners: Annotated[
        str | None,
        typer.Option(
            help="X,Y of the picture's four corners in --photo, in pixels, clockwise from its upper left; roughly will "
            "do.  [default: they are looked for]"
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Take exported files that were changed since for what they are now.")
    ] = False,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Compare what a cube, a shape, a relief or a mesh really casts with what was wanted."""
    standing = Options(
        elevation_deg=elevation_deg,
        span_deg=span_deg,
        angles_deg=None if angles_deg is None else arguments.numbers(angles_deg, "--angles-deg"),
    )
    how = hulls.Cutting(threshold, invert, walls)
    of_cubes = {"--sheet": sheet, "--between": between_pictures, "--robust": robust, "--plot": plot, "--photo": photo}
    if io.is_mesh(cube):
        _refuse(cube, "a mesh", of_cubes)
        _score_mesh(cube, pictures or [], standing, how, as_json=as_json)
        return
    if standing != Options() or how != hulls.Cutting():
        raise InputError(
            f"{cube} knows how its pictures were cut out and where they stand: say that of meshes, and leave it out"
        )
    if pictures is not None and len(pictures) > 1:
        raise InputError(
            f"{pictures[1]} is too much for lightcube score, which takes pictures one by one of meshes only: put all "
            "of them into one folder, and give that"
        )
    if io.is_shape(cube):
        _refuse(cube, "a shape", {"pictures": pictures, **of_cubes})
        _score_shape(cube, as_json=as_json)
        return
    sheet_file, plot_file = _files(sheet, plot, overwrite=overwrite)
    if io.is_relief(cube):
        refused = bool(pictures or plot or between_pictures or photo)
        _score_relief(cube, sheet_file, off=robust, refused=refused, as_json=as_json)
        return
    loaded, wanted, is_file = _loaded(cube, pictures[0] if pictures else None, force=force)
    if photo is not None or stop is not None or corners is not None:
        if photo is None or stop is None or between_pictures or robust or plot is not None:
            raise InputError("--photo, --stop and --corners belong together, and take --sheet only: give a photograph")
        _score_photo(cube, loaded, wanted, (photo, stop, corners), sheet_file, as_json=as_json)
        return
    with telling("measuring", as_json=False) as tell:  # what is printed is one document
        found = scoring.score(loaded, wanted, tell, between=between_pictures or plot is not None, off=robust)
    drawn: list[tuple[io.Output, Thing]] = []
    if plot_file is not None and found.curve is not None:
        drawn.append((plot_file, scoring.plot(found.curve)))
    if sheet_file is not None:
        drawn.append((sheet_file, scoring.sheet(loaded, wanted, found, io.bare_name(cube))))
    io.write_together(*drawn)
    _told(cube, loaded, wanted, found.scores, is_file=is_file, as_json=as_json)


def _files(sheet: str | None, plot: str | None, *, overwrite: bool) -> tuple[io.Output | None, io.Output | None]:
    """Where the sheet and the plot go, checked."""
    if plot is not None and sheet is not None and Path(plot) == Path(sheet):
        raise InputError(f"--sheet and --plot both name {plot}: give them two names")
    sheet_file = None if sheet is None else io.Output(sheet, "picture", overwrite)
    plot_file = None if plot is None else io.Output(plot, "plot", overwrite)
    for file in (sheet_file, plot_file):
        if file is not None:
            file.check()
    return sheet_file, plot_file


def _loaded(cube: str, pictures: str | None, *, force: bool) -> tuple[Cube, Targets, bool]:
    """A cube, or what an exported file holds, what was wanted of it, and whether it is such a file."""
    is_file = is_exported(cube)
    if force and not is_file:
        raise InputError("--force is for files that lightcube export wrote: leave it out")
    if is_file:
        return *exporting.measured(cube, pictures, force=force), True
    loaded = load(cube)
    return loaded, wanted_of(loaded, pictures), False


def _told(path: str, cube: Cube, wanted: Targets, scores: dict[str, Any], *, is_file: bool, as_json: bool) -> None:
    """Print scores, and of an exported file whether it lies the other way round."""
    other = exporting.turned(cube, wanted, scores["psnr_mean"]) if is_file else None
    if as_json:
        turned = {} if other is None else {"other_way_round": {"flip": other.axes, "psnr_mean": other.psnr_mean}}
        json_document({**scores, **turned})
        return
    printing.scored(scores, cube.rig)
    for line in exporting.said_of_score(path, other, scores["psnr_mean"]) if is_file else ():
        out.print(line)


def _score_photo(
    path: str,
    cube: Cube,
    wanted: Targets,
    asked: tuple[str, int, str | None],
    sheet: io.Output | None,
    *,
    as_json: bool,
) -> None:
    """Print how near a photograph of a stop comes to what was promised and wanted."""
    photo, stop, corners = asked
    given = None if corners is None else np.array(arguments.numbers(corners, "--corners"))
    if given is not None and len(given) != 8:
        raise InputError(f"--corners {corners}: give eight numbers, x and y of each corner, clockwise from upper left")
    found = photographing.compare(cube, wanted, photo, stop, None if given is None else given.reshape(4, 2))
    if sheet is not None:
        sheet.write(found.sheet(f"{io.bare_name(path)}, photographed"))
    if as_json:
        json_document(found.figures)
        return
    for line in found.lines:
        out.print(line)


def _refuse(path: str, what: str, given: Mapping[str, object]) -> None:
    """Raise `InputError` where something is said that is for cubes."""
    said = next((name for name, value in given.items() if value), None)
    if said is not None:
        raise InputError(f"{path} is {what}, and {said} is for cubes: leave it out")


def _score_mesh(path: str, sources: list[str], options: Options, how: hulls.Cutting, *, as_json: bool) -> None:
    """Print how far the shadows of a mesh are silhouettes."""
    if not sources:
        raise InputError(f"{path} is a mesh and keeps no pictures: give them after it, or the shape it was made of")
    silhouettes, grid = meshes.read(sources, options, how)
    found = meshes.score(path, silhouettes, grid)
    if as_json:
        json_document(found.facts)
        return
    for line in found.lines:
        out.print(line)


def _score_shape(path: str, *, as_json: bool) -> None:
    """Print how far the shadows of a shape's mesh are its silhouettes."""
    shape = io.read_shape(path)
    found, pieces = hulls.certificate(path, shape), count_pieces(shape.inside)
    if as_json:
        json_document({"pieces": pieces, "bad_edges": shape.mesh.bad_edges, **found.facts})
        return
    for line in hull_words.results(shape, found, pieces):
        out.print(line)


def _score_relief(path: str, sheet: io.Output | None, *, off: bool, refused: bool, as_json: bool) -> None:
    """Compare what a relief's lamps show with the pictures that it keeps."""
    if refused:
        raise InputError(
            "a relief keeps its pictures, and nothing is between them: leave out all but --sheet, --robust"
        )
    relief = io.read_relief(path)
    scores = score_relief(relief, off=off)
    if sheet is not None:
        sheet.write(relief_sheet(relief, scores, io.bare_name(path)))
    if as_json:
        json_document(scores)
        return
    for line in reliefs.scored(relief, scores):
        out.print(line)
