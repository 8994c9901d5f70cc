"""Playback: one picture at a time, as a cube that is turned by hand wants it."""

import numpy as np

from lightcube.bench.clock import seconds
from lightcube.bench.products import CHANNELS
from lightcube.forward.casting import player
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable

#: Angles that are looked at for each repeat.
_ANGLES = 5


def playback(n: int, elevation_deg: float, repeats: int) -> dict[str, float]:
    """Seconds of one picture of an n-cube, the whole screen in colour, with all threads; the cube is laid out before.

    A picture is beams, light, lamp and layout, ready to be encoded for a screen.
    """
    grid = Grid((n, n, n))
    extinction = np.full((CHANNELS, *grid.shape), 1 / n, np.float32)
    show = player(Cube(extinction, grid, turntable(grid, [10.0], elevation_deg=elevation_deg)))
    rows, columns = show([10.0]).shape[1:3]
    angles_deg = iter(np.linspace(3, 177, repeats * _ANGLES))
    return {"rows": rows, "columns": columns, **seconds(lambda: show([next(angles_deg)]), repeats * _ANGLES)}
