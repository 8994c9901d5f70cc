"""What is said of a turntable before its pictures and its cube are known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Numbers, Reals, keep
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.glare import off_normals
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid, check_elevation, picture_shape
from lightcube.optics.rig import Rig
from lightcube.optics.setups import turntable
from lightcube.optics.tables import POWER_MAX, check_black, check_veil, power_bounds
from lightcube.optics.transfer import BLACK
from lightcube.optics.views import check_angles, check_lamp, check_span, distinct_angles, doubt_angles, spread_angles
from lightcube.pictures.pictures import Pictures
from lightcube.wording import counted

#: Elevation of the lamp, in degrees, where nothing says another: it holds most (measured).
RAISED_DEG = 35.0
#: The same of round glass, whose light goes further down on its way to the screen (measured).
ROUND_DEG = 20.0


@dataclass(frozen=True, eq=False)
class Turntable:
    """A turntable, as far as it is said; the rest is as its pictures say, or as usual.

    Parameters
    ----------
    angles_deg
        Turntable angles in degrees, one per picture; default those that came with the pictures, and where none did,
        spread evenly; before a block of glass as far from the normals of its sides as can be.
    span_deg
        Degrees over which angles are spread evenly, instead of those that came with the pictures.
    elevation_deg
        Of the lamp, in degrees; default the one that came with the pictures, else 35, and 20 behind round glass. Of a
        bath it is outside.
    power, power_max
        Power of the lamp where it is fixed, and its largest where it is not, as `lightcube.optics.rig.Rig.of` has them.
    black
        Display value, from half a level of 255 to below 1, that the screen cannot be darker than.
    lamp_deg
        Angular diameter of the lamp's disc, degrees from 0 to below 90; 0 = it has none.
    pixel
        Width and height of a picture's pixel in voxels, whole, from 1 to the cube's shortest side: a cube may be finer
        than what it shows.
    screen_mm
        How far behind the circle that the turning cube's corners sweep the screen stands, mm, where the lamp has a
        disc, or there is glass; default the cube's width, and with glass as `lightcube.optics.setups.in_glass` has it.
        Else it does not matter.
    glass
        What bends the light: the clear body of the cube, or its bath; None = nothing.
    veil
        Even light over the screen, whatever the cube, as a part of the lamp's, from 0 to below 1: what haze, or the
        room, throws there.

    Examples
    --------
    >>> import lightcube as lc
    >>> level = lc.Turntable(elevation_deg=0)
    >>> level.power_max
    16.0
    """

    angles_deg: Numbers | None = None
    span_deg: float | None = None
    elevation_deg: float | None = None
    power: float | None = None
    power_max: float = POWER_MAX
    black: float = BLACK
    lamp_deg: float = 0.0
    screen_mm: float | None = None
    pixel: int = 1
    glass: Glass | None = None
    veil: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        if self.angles_deg is not None:
            check_angles(self.angles_deg)
            keep(self, angles_deg=np.float64)
        if self.span_deg is not None:
            check_span(self.span_deg)
        if self.angles_deg is not None and self.span_deg is not None:
            raise InputError("angles and a span of angles are both given: use one of the two")
        span_deg = None if self.span_deg is None else (0.0, self.span_deg / 2, self.span_deg)
        doubt_angles(self.angles_deg if span_deg is None else span_deg, "turntable", stacklevel=3)
        if self.pixel < 1:
            raise InputError(f"a pixel is a whole number of voxels wide, of at least 1, not {self.pixel}")
        if self.elevation_deg is not None:
            check_elevation(self.elevation_deg)
        power_bounds(self.power, self.power_max)
        check_black(self.black)
        check_veil(self.veil)
        check_lamp(self.lamp_deg, self.screen_mm, matters=self.glass is not None)

    def elevation_of(self, pictures: Pictures) -> float:
        """Elevation of the lamp that pictures are shown with, degrees."""
        said = pictures.elevation_deg if self.elevation_deg is None else self.elevation_deg
        round_glass = self.glass is not None and self.glass.is_round
        return check_elevation((ROUND_DEG if round_glass else RAISED_DEG) if said is None else said)

    @checked
    def rig(self, pictures: Pictures, grid: Grid, *, picture_width: float = 1.0) -> Rig:
        """The turntable on which pictures shall be shown, each at a stop of its own, with the aspect of the first.

        Parameters
        ----------
        picture_width
            Width of the pictures as a fraction of the cube's; their aspect is the first one's as closely as
            `lightcube.optics.grid.picture_shape` can.

        Raises
        ------
        InputError
            Where there are fewer than two pictures, the angles do not fit, or they would be wider than the cube's
            screen, or a pixel larger than the cube.
        """
        if len(pictures) < 2:
            raise InputError(
                f"{len(pictures)} picture{'s' if not pictures.images else ''} cannot fill a cube: give at least two"
            )
        elevation_deg = self.elevation_of(pictures)
        rows, columns = pictures.images[0].shape[:2]
        return turntable(
            grid,
            self._angles(pictures, elevation_deg),
            elevation_deg=elevation_deg,
            picture_shape=picture_shape(grid, picture_width, columns / rows, elevation_deg, self.pixel),
            pixel=self.pixel,
            power=self.power,
            power_max=self.power_max,
            black=self.black,
            lamp_deg=self.lamp_deg,
            screen_mm=self.screen_mm,
            glass=self.glass,
            veil=self.veil,
        )

    def _angles(self, pictures: Pictures, elevation_deg: float) -> Reals:
        """One angle per picture: those asked for, else those that came along, else spread evenly."""
        angles_deg = pictures.angles_deg if self.angles_deg is None and self.span_deg is None else self.angles_deg
        if angles_deg is None:
            lens = self.glass is not None and self.glass.is_round  # half a turn on, it shows no mirror image
            span_deg = 360.0 if lens and self.span_deg is None else self.span_deg
            spread_deg = spread_angles(len(pictures), span_deg, elevation_deg=elevation_deg)
            return distinct_angles(off_normals(spread_deg, self.glass))
        chosen = distinct_angles(angles_deg)
        if len(chosen) != len(pictures):
            raise InputError(
                f"{counted(len(chosen), 'angle')} for {counted(len(pictures), 'picture')}: give one angle per picture"
            )
        return chosen
