"""The command `lightcube play`."""

from collections.abc import Callable, Iterable, Iterator
from typing import Annotated

import numpy as np
import typer
from numpy.typing import NDArray

from lightcube import io
from lightcube.cli import arguments
from lightcube.cli.console import done, err, progress
from lightcube.cli.options import FPS, JSON, OUT, OVERWRITE, threaded
from lightcube.errors import InputError
from lightcube.jobs.reading import load
from lightcube.optics.light import Beams, check_zoom
from lightcube.verbs import playing, words


@threaded
def play(
    cube: Annotated[str, typer.Argument(help="A cube.")],
    output: Annotated[str, OUT],
    angles_deg: Annotated[str | None, typer.Option(help="Turntable angles in degrees, A,B,C.")] = None,
    start_deg: Annotated[float | None, typer.Option("--from-deg", help="First angle in degrees.  [default: 0]")] = None,
    end_deg: Annotated[
        float | None, typer.Option("--to-deg", help="Where the turn ends, in degrees.  [default: 360]")
    ] = None,
    count: Annotated[int | None, typer.Option(help="Number of pictures of the turn.  [default: 120 or more]")] = None,
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
    room: Annotated[
        bool, typer.Option("--room", help="Show the room in perspective: cube, lamps, and screens with their pictures.")
    ] = False,
    light: Annotated[
        Beams, typer.Option(help="What a wall shows, averaged over pixels, or the paper's thin beams.")
    ] = "area",
    fps: Annotated[float, FPS] = 25.0,
    overwrite: Annotated[bool, OVERWRITE] = False,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Cast the cube's shadows: a movie, a folder of PNGs, or .npy, by suffix.

    Shows the whole screen: the picture, its mat, and what stands around it. A screen with edges is its picture.
    """
    movie = io.Output(output, "pictures", overwrite)
    movie.check()
    look = playing.Look(picture_only, check_zoom(zoom), light)
    if room and (target or picture_only or screens or zoom > 1):
        raise InputError("--room shows all there is: leave out --screens, --target, --picture-only and --zoom")
    loaded = load(cube)
    many = len(loaded.rig.screens.names) > 1
    if target and many:
        raise InputError(f"{cube} has several screens: leave out --target, and see score --sheet")
    turned = arguments.play_angles(loaded, angles_deg, start_deg, end_deg, count, stops=stops)
    if room:
        show = playing.of_room(loaded, np.unique(turned) if stops else turned)
    elif screens or (many and not stops):
        show = playing.of_screens(loaded, np.unique(turned) if stops else turned, look)
    elif stops:
        show = playing.of_stops(loaded, look, target=target)
    else:
        show = playing.of_turn(loaded, turned, look, target=target)
    for sentence in words.unsampled(loaded.rig, light):
        if not as_json:
            err.print(sentence)
    with progress("playing", as_json=as_json) as advance:
        movie.write(
            _counted(show.pictures, show.count, advance),
            count=show.count,
            transfer=loaded.transfer,
            fps=fps,
            scale=arguments.movie_scale(output, show.rows) if scale is None else scale,
            views=show.views,
            names=show.names,
        )
    done(as_json, f"{show.count} pictures in {output}", out=str(output), count=show.count)


def _counted(
    pictures: Iterable[NDArray[np.float32]], count: int, advance: Callable[..., None]
) -> Iterator[NDArray[np.float32]]:
    for number, picture in enumerate(pictures, 1):
        yield picture
        advance(number, count)
