"""Program 3, the forward computation: what the screen shows at any turntable angle."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from lightcube.errors import InputError
from lightcube.forward.turning import moment
from lightcube.kernels.layout import columns_from_volume
from lightcube.optics.arrays import Floats, Images, Numbers, Reals
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.light import Beams, judged
from lightcube.optics.rig import Rig
from lightcube.projection.shadows import shadows


@checked
def cast(
    cube: Cube, rig: Rig | None = None, lamp_powers: Reals | None = None, *, light: Beams = "area"
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
    light
        ``"thin"``: the beam through each pixel's middle alone, as in the paper.
    """
    powers = cube.powers if lamp_powers is None else np.asarray(lamp_powers, np.float64)
    shape = len((rig or cube.rig).pairs), len(cube.extinction)
    colours = (rig or cube.rig).sums.share.shape[1]
    if colours not in (1, shape[1]):
        raise InputError(f"a rig of {colours} colours does not fit a cube of {shape[1]}: give one of as many")
    if powers.shape != shape:
        raise InputError(f"lamp powers for this rig have shape {shape}, not {powers.shape}: give one for each pair")
    return _cast(columns_from_volume(cube.extinction), cube, rig or cube.rig, powers, light)


def _cast(columns: Floats, cube: Cube, rig: Rig, powers: Reals, light: Beams) -> Iterator[Images]:
    """Yield what `cast` does, of the cube's extinction as `columns_from_volume` lays it out."""
    lit = rig if light == "thin" else judged(rig, cube.grid)
    return shadows(columns, cube.grid, lit, powers[lit.pair])


@checked
def play(cube: Cube, angles_deg: Numbers | None = None, *, whole_shadow: bool = False, light: Beams = "area") -> Images:
    """What the screen shows, ``(picture, row, column, channel)`` float32 linear light, lamp included, never clipped.

    Parameters
    ----------
    angles_deg
        Turntable angles in degrees; None = the pictures that the cube was made for. Where there are several screens the
        pictures of an angle follow each other (`lightcube.forward.turning.moment`).
    whole_shadow
        Show the whole shadow and its surroundings instead of the picture, where the screen has no edges.
    light
        As `cast` takes it.
    """
    return player(cube, whole_shadow=whole_shadow, light=light)(angles_deg)


@checked
def player(cube: Cube, *, whole_shadow: bool = False, light: Beams = "area") -> Callable[[Numbers | None], Images]:
    """Make a function of the angles that shows what `play` does, fast enough for a cube that is turned by hand.

    The cube is laid out for casting once, which takes as much memory again.

    Parameters
    ----------
    whole_shadow, light
        As `play` takes them.
    """
    columns = columns_from_volume(cube.extinction)

    def show(angles_deg: Numbers | None) -> Images:
        if angles_deg is None:
            now, powers = cube.rig.whole(cube.grid) if whole_shadow else cube.rig, cube.powers
        else:
            now, powers = moment(cube, angles_deg, whole_shadow=whole_shadow)
        return np.stack(list(_cast(columns, cube, now, powers, light)))

    return show
