"""The command `lightcube play`."""

from typing import Annotated

import numpy as np
import typer

from lightcube import io
from lightcube.cli import arguments
from lightcube.cli.console import counting, done, err, progress
from lightcube.cli.options import JSON, OUT, OVERWRITE, threaded
from lightcube.drawing import films, shows
from lightcube.drawing.poster import Format
from lightcube.errors import InputError
from lightcube.optics.arrays import Reals
from lightcube.optics.cube import Cube
from lightcube.optics.light import Beams, check_zoom
from lightcube.optics.stack import Stack
from lightcube.verbs import reliefs, words
from lightcube.verbs.exporting import opened
from lightcube.wording import counted


@threaded
def play(
    cube: Annotated[
        str,
        typer.Argument(
            help="A cube, a stack of films, a relief (its lamp goes round), or an exported volume, slices or pages."
        ),
    ],
    output: Annotated[str, OUT],
    even: Annotated[
        bool, typer.Option("--even", help="Turn evenly under a steady lamp: what flickers, flickers.")
    ] = False,
    view: Annotated[
        films.View,
        typer.Option(
            help="The pictures on the wall; the room; or the way to the lamp's eye: noise becomes the picture."
        ),
    ] = "wall",
    shape: Annotated[
        Format | None,
        typer.Option(
            "--format",
            help="Large in the dark, to share: 1080 x 1080, 1080 x 1920 or 1920 x 1080 pixels; GIFs a third.",
        ),
    ] = None,
    captions: Annotated[bool, typer.Option("--captions", help="Put names below the pictures of a --format.")] = False,
    angles_deg: Annotated[str | None, typer.Option(help="Turntable angles in degrees, A,B,C.")] = None,
    start_deg: Annotated[
        float | None, typer.Option("--from-deg", help="First angle of an even turn, in degrees.  [default: 0]")
    ] = None,
    end_deg: Annotated[
        float | None, typer.Option("--to-deg", help="Where an even turn ends, in degrees.  [default: 360]")
    ] = None,
    count: Annotated[
        int | None, typer.Option(help="Number of pictures of an even turn.  [default: 120 or more]")
    ] = None,
    stops: Annotated[bool, typer.Option("--stops", help="Play just the pictures that the cube was made for.")] = False,
    zoom: Annotated[
        int, typer.Option(help="Show each pixel in K x K parts, each the mean of its own light: finer, 1 to 16.")
    ] = 1,
    scale: Annotated[
        int | None,
        typer.Option(help="Repeat each pixel (or part of one), a square of so many.  [default: movies about 256 high]"),
    ] = None,
    target: Annotated[
        bool, typer.Option("--target", help="Put the wanted picture of the nearest stop to the right.")
    ] = False,
    picture_only: Annotated[
        bool, typer.Option("--picture-only", help="Show the picture's window alone, not what stands around it.")
    ] = False,
    screens: Annotated[
        bool, typer.Option("--screens", help="Show all screens of a stage side by side; with --stops each stop once.")
    ] = False,
    light: Annotated[
        Beams, typer.Option(help="What a wall shows, averaged over pixels, or the paper's thin beams.")
    ] = "area",
    fps: Annotated[
        float | None,
        typer.Option(help="Pictures per second of a movie.  [default: 30; 10 in a GIF of a --format]"),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Take exported files that were changed since for what they are now.")
    ] = False,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Cast the cube's shadows: a movie, a folder of PNGs, or .npy, by suffix.

    In a movie the lamp fades in on each stop, rests for a second and fades out, and the table turns in the dark to the
    next: what a wall shows under a lamp that is dimmed. Where pictures flow into each other it turns evenly. PNGs and
    .npy have an even turn.

    Films turn nowhere: each of their pictures is shown, under its lamp or as films are moved for it.

    Shows the whole screen: the picture, its mat, and what stands around it. A screen with edges is its picture.
    """
    movie = io.Output(output, "pictures", overwrite)
    movie.check()
    if shape is not None and scale is not None:
        raise InputError("--format and --scale both say how large the picture is: leave one of them out")
    look = shows.Look(picture_only or (screens and shape is not None), check_zoom(zoom), light)
    size, fps = films.frames_of(output, shape, fps)
    style = films.Style(size, captions, fps, view)
    in_room = view != "wall"
    if in_room and (target or picture_only or screens or zoom > 1):
        raise InputError(f"--view {view} shows the room: leave out --screens, --target, --picture-only and --zoom")
    if io.is_relief(cube):
        cubes_own = (shape, start_deg, end_deg, count, captions, in_room, zoom > 1, target, picture_only, screens)
        if any(each not in (None, False) for each in cubes_own) or light != "area":
            raise InputError("a relief takes --stops, --even, --angles-deg, --fps and --scale: leave out all else")
        _play_relief(cube, movie, angles_deg, fps, scale, stops=stops, even=even, as_json=as_json)
        return
    turns = even or [start_deg, end_deg, count] != [None] * 3
    if view == "eye" and turns:
        raise InputError("--view eye stays at an angle: leave out --even, --from-deg, --to-deg and --count")
    loaded = opened(cube, force=force)
    if isinstance(loaded.grid, Stack):
        if turns or angles_deg is not None:
            raise InputError(
                f"{cube} is of films, and nothing turns: leave out --even, --angles-deg, --from-deg, --to-deg and "
                "--count, and each of its pictures is shown"
            )
        stops = stops or not arguments.is_movie(output)
    many = len(loaded.rig.screens.names) > 1
    if target and many:
        raise InputError(f"{cube} has several screens: leave out --target, and see score --sheet")
    turned = arguments.play_angles(loaded, angles_deg, start_deg, end_deg, count, stops=stops)
    if stops or angles_deg is not None:
        shown = np.unique(turned) if stops and (screens or in_room) else turned
        film = _film_at(loaded, look, style, shown, stops=stops, screens=screens or (many and not stops), target=target)
    else:
        steady = turns or not arguments.is_movie(output)
        film = films.filmed(loaded, look, style, turned, even=steady, target=target, screens=screens)
    for sentence in words.unsampled(loaded.rig, light):
        if not as_json:
            err.print(sentence)
    with progress("playing", as_json=as_json) as advance:
        movie.write(
            counting(film, len(film), advance),
            count=len(film),
            transfer=loaded.transfer,
            fps=film.fps,
            scale=_scale(output, film, style, scale),
            shared=shape is not None or in_room,
            views=film.show.views,
            names=film.show.names,
        )
    _told(output, film, as_json=as_json)


def _film_at(
    cube: Cube, look: shows.Look, style: films.Style, shown: Reals, *, stops: bool, screens: bool, target: bool
) -> films.Film:
    """What is shown at angles, on the wall or in the room."""
    if style.view != "wall":
        return (films.in_room if style.view == "room" else films.to_the_lamp)(cube, style, shown)
    if screens:
        show = shows.of_screens(cube, shown, look)
    else:
        show = shows.of_stops(cube, look, target=target) if stops else shows.of_turn(cube, shown, look, target=target)
    return films.styled(cube, show, style, shown)


def _play_relief(
    path: str,
    movie: io.Output,
    angles_deg: str | None,
    fps: float | None,
    scale: int | None,
    *,
    stops: bool,
    even: bool,
    as_json: bool,
) -> None:
    """Show what a relief's lamp shows on its way round, or at its pictures."""
    relief, output = io.read_relief(path), str(movie.path)
    if stops and angles_deg is not None:
        raise InputError("--stops and --angles-deg are two ways to say the same: use one")
    turned = reliefs.course(relief, even=even or not arguments.is_movie(output))
    if angles_deg is not None:
        turned = np.array(arguments.numbers(angles_deg, "--angles-deg"))
    elif stops:
        turned = reliefs.stops_deg(relief)
    with progress("playing", as_json=as_json) as advance:
        movie.write(
            counting(reliefs.under_lamp(relief, turned), len(turned), advance),
            count=len(turned),
            fps=films.FPS if fps is None else fps,
            scale=arguments.movie_scale(output, len(relief.wanted[0])) if scale is None else scale,
        )
    done(as_json, f"{counted(len(turned), 'picture')} in {output}", out=output, count=len(turned))


def _told(output: str, film: films.Film, *, as_json: bool) -> None:
    """Say what was made, how it goes, and what is wrong with it."""
    how = f"\n{film.said}" if film.said else ""
    flicker = film.flicker.share if arguments.is_movie(output) else None
    done(
        as_json,
        f"{counted(len(film), 'picture')} in {output}{how}",
        out=output,
        count=len(film),
        how=film.said,
        flicker=flicker,
    )
    if film.warning and arguments.is_movie(output) and not as_json:
        err.print(f"note: {film.warning}")


def _scale(output: str, film: films.Film, style: films.Style, asked: int | None) -> int:
    """How large a pixel is drawn."""
    if style.size is not None:
        return 1
    return arguments.movie_scale(output, film.show.rows) if asked is None else asked
