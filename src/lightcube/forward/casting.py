"""Program 3, the forward computation: what the screen shows at any turntable angle."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from lightcube.errors import InputError
from lightcube.forward.turning import moment
from lightcube.kernels.layout import columns_from_volume
from lightcube.optics.arrays import Counts, Floats, Images, Numbers, Reals
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.light import Beams, check_zoom, in_parts
from lightcube.optics.rig import Rig
from lightcube.projection.shadows import Shadows


@checked
def cast(
    cube: Cube, rig: Rig | None = None, lamp_powers: Reals | None = None, *, zoom: int = 1, light: Beams = "area"
) -> Iterator[Images]:
    """Yield what the screen shows in each picture, ``(row, column, channel)`` float32 linear light, never clipped.

    A pixel shows the mean of the light over its area, and over its lamp's disc, at the points that all is judged by
    (`lightcube.optics.light.judged`). Pixels that are not on their screen are black; a beam that misses the cube shows
    the lamp's power.

    Parameters
    ----------
    rig
        Lamps and screens; None = those that the cube was made for.
    lamp_powers
        ``(pairs, channels)``, of the rig's ``pairs``; None = the cube's.
    zoom
        1 to 16: each pixel becomes as many rows and columns of parts, each the mean of the light over its own area, so
        that one sees what varies inside pixels; their mean is the pixel, but for what its points miss.
    light
        ``"thin"``: the beam through each pixel's or part's middle alone, as in the paper.

    Examples
    --------
    >>> import numpy as np, lightcube as lc
    >>> grid = lc.Grid((3, 5, 7))
    >>> cube = lc.Cube(np.full((3, 3, 5, 7), 0.1), grid, lc.turntable(grid, [0, 90], picture_shape=(3, 3)))
    >>> [picture.shape for picture in lc.cast(cube)]
    [(3, 3, 3), (3, 3, 3)]
    >>> along_x, along_y = lc.cast(cube, light="thin")
    >>> np.allclose(along_x, np.exp(-0.7)), np.allclose(along_y, np.exp(-0.5))
    (True, True)
    """
    powers = cube.powers if lamp_powers is None else np.asarray(lamp_powers, np.float64)
    shape = len((rig or cube.rig).pairs), len(cube.extinction)
    colours = (rig or cube.rig).sums.share.shape[1]
    if colours not in (1, shape[1]):
        raise InputError(f"a rig of {colours} colours does not fit a cube of {shape[1]}: give one of as many")
    if powers.shape != shape:
        raise InputError(f"lamp powers for this rig have shape {shape}, not {powers.shape}: give one for each pair")
    zoom = check_zoom(zoom)
    return _cast(columns_from_volume(cube.extinction), cube, rig or cube.rig, powers, zoom, light)


def _cast(
    columns: Floats, cube: Cube, rig: Rig, powers: Reals, zoom: int, light: Beams, *, around: bool = False
) -> Iterator[Images]:
    """Yield what `cast` does, of the cube's extinction as `columns_from_volume` lays it out."""
    parts = in_parts(rig, cube.grid, light, zoom, around=around)
    lines = [[Shadows(cube.grid, part)(columns, powers[part.pair]) for part in line] for line in parts]
    for _ in range(len(rig)):
        yield _joined([[next(part) for part in line] for line in lines], zoom)


def _joined(parts: list[list[Images]], zoom: int) -> Images:
    """The picture whose pixels have those parts ``[row][column]``; one row of them stands for all."""
    if zoom == 1:
        return parts[0][0]
    rows, columns, channels = parts[0][0].shape
    lines = [np.stack(line, axis=2).reshape(rows, zoom * columns, channels) for line in parts]
    shown = np.stack(lines, axis=1).reshape(-1, zoom * columns, channels)
    return shown if len(lines) == zoom else shown.repeat(zoom, axis=0)


@checked
def play(
    cube: Cube,
    angles_deg: Numbers | None = None,
    *,
    picture_only: bool = False,
    zoom: int = 1,
    light: Beams = "area",
) -> Images:
    """What the screen shows, ``(picture, row, column, channel)`` float32 linear light, lamp included, never clipped.

    All of it where the screen has no edges: the picture, its mat, and what stands around it, as far as the cube's
    shadow reaches. The picture is what `cast` gives of it; around it 13 points of a pixel do, or 7 in a row.

    Parameters
    ----------
    angles_deg
        Turntable angles in degrees; None = the pictures that the cube was made for. Where there are several screens the
        pictures of an angle follow each other (`lightcube.forward.turning.moment`).
    picture_only
        Show the picture's window alone.
    zoom, light
        As `cast` takes them.
    """
    return player(cube, picture_only=picture_only, zoom=zoom, light=light)(angles_deg)


@checked
def player(
    cube: Cube, *, picture_only: bool = False, zoom: int = 1, light: Beams = "area"
) -> Callable[[Numbers | None], Images]:
    """Make a function of the angles that shows what `play` does, fast enough for a cube that is turned by hand.

    The cube is laid out for casting once, which takes as much memory again.

    Parameters
    ----------
    picture_only, zoom, light
        As `play` takes them.
    """
    show = screens(cube, picture_only=picture_only, zoom=zoom, light=light)
    return lambda angles_deg: np.stack(list(show(angles_deg)))


def screens(cube: Cube, *, picture_only: bool, zoom: int, light: Beams) -> Callable[[Numbers | None], Iterator[Images]]:
    """Make a function of the angles that yields the pictures which `play` stacks, one by one."""
    columns, zoom = columns_from_volume(cube.extinction), check_zoom(zoom)
    whole = cube.rig if picture_only else cube.rig.whole(cube.grid)

    def show(angles_deg: Numbers | None) -> Iterator[Images]:
        rig, powers = (cube.rig, cube.powers) if angles_deg is None else moment(cube, angles_deg)
        pictures = _cast(columns, cube, rig, powers, zoom, light)
        if whole.picture_shape == rig.picture_shape:  # there is nothing around
            return pictures
        now = whole if angles_deg is None else whole.at(angles_deg)[0]
        surrounds = _cast(columns, cube, now, powers, zoom, light, around=True)
        return _framed(pictures, surrounds, zoom * rig.places_in(now), zoom * rig.stops.window)

    return show


def _framed(
    pictures: Iterator[Images], surrounds: Iterator[Images], places: Counts, windows: Counts
) -> Iterator[Images]:
    """Yield what surrounds each picture with the picture's window in its place: the very values."""
    for picture, surround, (top, left), (rows, columns) in zip(pictures, surrounds, places, windows, strict=True):
        surround[top : top + rows, left : left + columns] = picture[:rows, :columns]
        yield surround
