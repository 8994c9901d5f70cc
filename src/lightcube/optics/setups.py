"""Rigs of usual set-ups: a turntable before a wall, its glass, and its lamp's disc."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Numbers
from lightcube.optics.checks import checked
from lightcube.optics.glare import has_ghosts
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid
from lightcube.optics.rig import Rig
from lightcube.optics.tables import POWER_MAX
from lightcube.optics.transfer import BLACK
from lightcube.optics.views import check_lamp, swept_mm, turntable_views

#: So many times as far behind a block of glass as usual a screen may stand, so that no ghost falls on a picture.
_FURTHER = np.arange(1.1, 3.05, 0.1)


@checked
def turntable(
    grid: Grid,
    angles_deg: Numbers,
    *,
    elevation_deg: float = 0.0,
    picture_shape: tuple[int, int] | None = None,
    pixel: int = 1,
    power: float | None = None,
    power_max: float = POWER_MAX,
    black: float = BLACK,
    lamp_deg: float = 0.0,
    screen_mm: float | None = None,
    glass: Glass | None = None,
    veil: float = 0.0,
) -> Rig:
    """A cube on a turntable in parallel light, before a vertical screen with rows and columns whole voxels apart.

    Parameters
    ----------
    angles_deg
        Turntable angles in degrees; a positive angle turns the cube counter-clockwise seen from above.
    elevation_deg
        Of the lamp, in degrees: light travels along ``(cos e, 0, -sin e)`` in the room.
    picture_shape
        ``(rows, columns)`` of a window in the middle of the screen; default the whole `raster_shape`.
    pixel
        Width and height of a pixel in voxels, whole, from 1 to the cube's shortest side.
    power, power_max, black
        Of the lamp and the screen, as `Rig.of` takes them.
    lamp_deg, screen_mm
        Of a lamp with a disc and its screen, as `soft` takes them; 0 = the lamp has none.
    glass
        What bends the light: a body, or bath, around the grid; None = nothing.
    veil
        Even light over the screen, as a part of the lamp's, from 0 to below 1 (`lightcube.optics.tables.Fading`).

    Notes
    -----
    Parallel light casts the same picture on every parallel screen, so the screen's plane is put through the
    cube's centre, unless the lamp has a disc or there is glass. The picture's middle is where the beam through that
    centre lands; of a block of glass, where it would land without.

    Examples
    --------
    >>> import lightcube as lc
    >>> rig = lc.turntable(lc.Grid((4, 6, 6)), [0, 90], picture_shape=(4, 2))
    >>> rig.views.column_steps_mm.round(3) + 0.0
    array([[ 0., -1.,  0.],
           [-1.,  0.,  0.]])

    The same window in pixels of 2 x 2 voxels, and all of the shadow in such pixels:

    >>> lc.turntable(lc.Grid((4, 6, 6)), [0, 90], picture_shape=(2, 1), pixel=2)
    <rig of 2 pictures of 2 x 1 pixels, 2 views>
    >>> lc.turntable(lc.Grid((4, 6, 6)), [0, 90], pixel=2).picture_shape
    (2, 5)
    """
    bends = glass is not None and (glass.bends or glass.is_bath)
    check_lamp(lamp_deg, screen_mm, matters=bends)
    views = turntable_views(grid, angles_deg, elevation_deg=elevation_deg, picture_shape=picture_shape, pixel=pixel)
    sharp = Rig.of(views, power=power, power_max=power_max, black=black)
    if glass is not None and bends:
        sharp = in_glass(sharp, grid, glass, screen_mm)
    if veil:
        sharp = replace(sharp, fading=replace(sharp.fading, veil=np.full(len(sharp.views), float(veil))))
    return soft(sharp, grid, lamp_deg, screen_mm) if lamp_deg else sharp


def in_glass(rig: Rig, grid: Grid, glass: Glass, screen_mm: float | None = None) -> Rig:
    """A turntable's rig with glass around the grid, and its screens so far behind it that pictures come out well.

    Parameters
    ----------
    screen_mm
        As `soft` takes it; default one and a half widths behind what is round, and three behind a block, or up to nine
        where only there nothing falls on a picture that the block throws back inside (`lightcube.optics.glare`).
    """
    body = glass.around(grid)
    if screen_mm is not None:
        return _before(rig, body, swept_mm(grid) + screen_mm)
    usual = _before(rig, body, body.far_mm)
    further = (_before(rig, body, times * body.far_mm) for times in _FURTHER)
    return next((each for each in chain([usual], further) if not has_ghosts(each)), usual)


def _before(rig: Rig, body: Glass, behind_mm: float) -> Rig:
    """A rig with glass, and its screens so far behind the axis."""
    light, views = rig.light, rig.views
    further = (behind_mm - rig.behind_mm) / np.linalg.norm(light[:, :2], axis=1)
    origins_mm = views.origins_mm + further[:, None] * light
    origins_mm[:, 2] += body.rise_mm(light)
    moved = replace(rig, views=replace(views, origins_mm=origins_mm))
    if len(body.iors) > 1:
        moved = moved.by_colour(len(body.iors))
    return replace(moved, glass=body)


def soft(rig: Rig, grid: Grid, lamp_deg: float, screen_mm: float | None = None) -> Rig:
    """A turntable's rig, its lamp having a disc, and its screens so far behind the cube that it blurs their pictures.

    Parameters
    ----------
    lamp_deg
        Angular diameter of the disc, degrees above 0 and below 90: the sun's is 0.5.
    screen_mm
        From the circle that the turning cube's corners sweep to the screens, which move along the light; default the
        cube's width.
    """
    check_lamp(lamp_deg, screen_mm)
    steepest = float(np.max(np.abs(rig.views.elevations_deg))) + lamp_deg / 2
    if steepest >= 90:
        raise InputError(
            f"a lamp raised by {steepest - lamp_deg / 2:g} degrees with a disc of {lamp_deg:g} shines from behind the "
            "screen too: raise it less, or make it smaller"
        )
    wanted_mm = swept_mm(grid) + (grid.size_mm[1] if screen_mm is None else screen_mm)
    if rig.glass is not None and screen_mm is None:
        wanted_mm = rig.glass.far_mm
    light = rig.views.lamps[:, :3]
    further = (wanted_mm - rig.behind_mm) / np.linalg.norm(light[:, :2], axis=1)
    views = replace(rig.views, origins_mm=rig.views.origins_mm + further[:, None] * light)
    return replace(rig, views=views, sums=replace(rig.sums, disc_deg=np.full(len(views), lamp_deg)))
