"""Every picture's views and how they add up to it, where the lamps and screens of a room stand, and what turns.

A picture is a sum over its views of ``P g (1 - a (1 - T))``: P the lamp's power, g the light of a lamp of power 1 that
reaches the pixel past no cube, T the transmittance of the beam, and a the strength of the shadow, which fades with
distance (`lightcube.optics.law`). Lengths are mm, all is in the cube's own axes, as in `lightcube.optics.views`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.optics.arrays import Counts, Flags, Indices, Numbers, Reals, as_indices, as_numbers, locked
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.glass import Glass
from lightcube.optics.grid import Grid, raster_shape
from lightcube.optics.tables import (
    POWER_MAX,
    Fading,
    Lamps,
    Screens,
    Stops,
    Sums,
    Turning,
    power_bounds,
)
from lightcube.optics.transfer import BLACK
from lightcube.optics.views import (
    Views,
    check_angles,
    hold_offsets_deg,
    rotated,
    smallest_gap_deg,
)
from lightcube.wording import counted

#: Stops nearer to each other than this, in degrees, are one.
_SAME_STOP = 1e-6
#: Places nearer to each other than this, in pixels, are one.
_SAME_PIXEL = 1e-6
#: A part of a vector smaller than this is none.
_NONE = 1e-9
#: A screen stands so many times as far as the focus of round glass, at least.
_BEYOND = 1.02


@dataclass(frozen=True, eq=False)
class Rig:
    """Every picture's views, how they add up, and what turns: of a turntable, or of a stage (`Stage.rig`).

    Parameters
    ----------
    views
        The beams, in the cube's axes: what the matrix is made of.
    sums, fading, turning
        Of each view.
    stops
        Of each picture.
    lamps, screens
        What stands in the room.
    glass
        What bends the light on its way to the voxels; None = nothing. Where each colour has an index of refraction each
        view is of one colour.

    Raises
    ------
    InputError
        Where they do not fit each other.

    Examples
    --------
    >>> import lightcube as lc
    >>> rig = lc.turntable(lc.Grid((3, 5, 7)), [0, 45, 90], elevation_deg=30)
    >>> rig
    <rig of 3 pictures of 9 x 9 pixels, 3 views>
    >>> rig.take([2, 0]).stops.angle_deg
    array([90.,  0.])
    """

    views: Views
    sums: Sums
    fading: Fading
    turning: Turning
    stops: Stops
    lamps: Lamps
    screens: Screens
    glass: Glass | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        self.views.check_screens()
        views = len(self.views)
        if not len(self.sums.picture) == len(self.fading.cosine) == len(self.turning.turns) == views:
            raise InputError(f"the parts of a rig are not all of {counted(views, 'view')}: make them of the same")
        if self.sums.picture[-1] + 1 != len(self.stops.angle_deg):
            stops, pictures = len(self.stops.angle_deg), int(self.sums.picture[-1]) + 1
            raise InputError(f"{counted(stops, 'stop')} for {counted(pictures, 'picture')}: give one each")
        for numbers, names in ((self.sums.lamp, self.lamps.names), (self.stops.screen, self.screens.names)):
            if np.any((numbers < 0) | (numbers >= len(names))):
                raise InputError("a rig's lamps and screens must be numbers of the names that it has, from 0")
        if self.glass is not None:
            self._check_glass(self.glass)

    def _check_glass(self, glass: Glass) -> None:
        """Raise `InputError` where light cannot be followed through the glass."""
        if np.any(self.views.lamps[:, 3] != 0):
            raise InputError("glass bends parallel light only: give its lamps a direction, not a place")
        if len(glass.iors) > 1 and np.any(np.sum(self.sums.share > 0, axis=1) > 1):
            raise InputError(
                "with an index of refraction for each colour a rig's views must be of one colour each: "
                "part them by Rig.by_colour first"
            )
        if glass.is_round and glass.bends:
            light = self.light
            ahead = light if glass.form == "sphere" else light * (1.0, 1.0, 0.0)
            away = np.sum(self.views.origins_mm * ahead, axis=1) / np.linalg.norm(ahead, axis=1)
            least = _BEYOND * glass.focus_mm(light)
            if np.any(away < least):
                view = int(np.argmax(least - away))
                raise InputError(
                    f"a screen {away[view]:.4g} mm behind the axis is within the focus of the {glass.form}, where "
                    f"several beams meet: stand it at least {least[view]:.4g} mm behind the axis"
                )

    @property
    def light(self) -> Reals:
        """``(views, 3)``: unit directions of parallel light."""
        light = self.views.lamps[:, :3]
        return np.asarray(light / np.linalg.norm(light, axis=1, keepdims=True))

    @classmethod
    @checked
    def of(
        cls,
        views: Views,
        angles_deg: Numbers | None = None,
        *,
        power: float | None = None,
        power_max: float = POWER_MAX,
        black: float = BLACK,
    ) -> Rig:
        """Each view a picture of its own, whose lamp and endless screen go round the standing cube together.

        Parameters
        ----------
        angles_deg
            Of the pictures' stops, degrees; default those of the views' parallel lamps.
        power
            Power of the lamp where it is fixed, linear light: 1 shows white where a beam meets nothing.
        power_max
            Its largest power where it is not, at least 1.
        black
            Display value, from half a level of 255 to below 1, that the screen cannot be darker than.
        """
        count = len(views)
        least, most = power_bounds(power, power_max)
        return cls(
            views,
            Sums(np.arange(count), np.zeros(count, np.intp), np.ones((count, 1)), np.zeros(count)),
            Fading.none(count),
            Turning(np.ones((count, 2), np.bool_), np.full((count, 2), -1.0), np.array([0.0, 0.0, 1.0])),
            Stops(
                views.angles_deg if angles_deg is None else check_angles(angles_deg),
                np.zeros(count, np.intp),
                np.tile(views.picture_shape, (count, 1)),
            ),
            Lamps(("lamp",), np.array([least]), np.array([most])),
            Screens(("screen",), np.array([black]), np.array([True])),
        )

    def __len__(self) -> int:
        return len(self.stops.angle_deg)

    def __repr__(self) -> str:
        rows, columns = self.picture_shape
        return (
            f"<rig of {counted(len(self), 'picture')} of {rows} x {columns} pixels, {counted(len(self.views), 'view')}>"
        )

    @property
    def picture_shape(self) -> tuple[int, int]:
        """``(rows, columns)`` of every picture; those on smaller screens use the upper left (`Stops.window`)."""
        return self.views.picture_shape

    @cached_property
    def pairs(self) -> Counts:
        """``(pairs, 2)``: every (picture, lamp) once, in order; each pair has lamp powers of its own."""
        found: Counts = np.unique(np.stack([self.sums.picture, self.sums.lamp], axis=1), axis=0)
        return locked(found)

    @cached_property
    def pair(self) -> Counts:
        """``(views,)``: which of the `pairs` each view belongs to."""
        lamps = len(self.lamps.names)
        keys = self.pairs[:, 0] * lamps + self.pairs[:, 1]
        return locked(np.searchsorted(keys, self.sums.picture * lamps + self.sums.lamp))

    @property
    def starts(self) -> Counts:
        """``(pictures + 1,)``: the views of picture p are those from ``starts[p]`` to before ``starts[p + 1]``."""
        return np.searchsorted(self.sums.picture, np.arange(len(self) + 1))

    @cached_property
    def is_thin(self) -> bool:
        """Whether every picture is the unfaded shadow of one white lamp in single beams: then the problem is convex."""
        return bool(
            len(self.views) == len(self)
            and np.all(self.sums.share == 1)
            and self.fading.is_none
            and self.glass is None
            and not np.any(self.sums.square)
        )

    @property
    def inside(self) -> Flags:
        """``(pictures, rows, columns)``: the pixels that lie on their screen."""
        rows, columns = (np.arange(count) for count in self.picture_shape)
        high, wide = self.stops.window[:, :1, None], self.stops.window[:, 1:, None]
        return np.asarray((rows[:, None] < high) & (columns < wide), np.bool_)

    @cached_property
    def mirrors(self) -> bool:
        """Whether half a turn of the table shows every picture mirrored: level light, and screens that go with it.

        Not where lamps have a disc: half a turn on, what was near the screen, and sharp, is far from it. Nor where
        glass bends the light, but for a bath with flat sides.
        """
        axis = self.turning.axis / np.linalg.norm(self.turning.axis)
        light, across = (
            vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
            for vectors in (self.views.lamps[:, :3], self.views.column_steps_mm)
        )
        upright = np.linalg.norm(np.cross(self.views.row_steps_mm, axis), axis=1)
        return bool(
            (self.glass is None or self.glass.form == "bath")
            and np.all(self.turning.turns)
            and np.all(self.turning.way[:, 0] == self.turning.way[:, 1])
            and np.all(self.views.lamps[:, 3] == 0)
            and np.all(self.sums.disc_deg == 0)
            and np.all(np.abs(light @ axis) < _NONE)
            and np.all(np.abs(across @ axis) < _NONE)
            and np.all(upright < _NONE * np.linalg.norm(self.views.row_steps_mm, axis=1))
        )

    @cached_property
    def period_deg(self) -> float:
        """Degrees after which lamps repeat: 360, or 180 where half a turn mirrors and no two stops are so far apart."""
        return (
            180.0
            if self.mirrors
            and all(
                len(np.unique(np.round(own % 180, 9))) == len(np.unique(np.round(own % 360, 9)))
                for own in (
                    self.stops.angle_deg[self.stops.screen == screen] for screen in np.unique(self.stops.screen)
                )
            )
            else 360.0
        )

    @property
    def widest_hold_deg(self) -> float:
        """Half the way, in degrees, between the two nearest stops of a screen."""
        apart = 180.0 if self.mirrors else 360.0
        screens = np.unique(self.stops.screen)
        return min(smallest_gap_deg(self.stops.angle_deg[self.stops.screen == screen], apart) for screen in screens) / 2

    def views_of(self, pictures: Sequence[int] | NDArray[np.integer]) -> Counts:
        """Numbers of the views that belong to some of the pictures, in their order."""
        starts = self.starts
        return np.concatenate([np.arange(starts[p], starts[p + 1]) for p in pictures])

    def take(self, pictures: Indices) -> Rig:
        """Some of the pictures, in this order; a picture may come several times."""
        chosen = as_indices(pictures, len(self), "pictures") % len(self)
        taken = self._with_views(self.views_of(chosen))
        counts = np.diff(self.starts)[chosen]
        sums = replace(taken.sums, picture=np.repeat(np.arange(len(chosen)), counts))
        stops = _taken(self.stops, chosen)
        return replace(taken, sums=sums, stops=stops)

    def _with_views(self, chosen: Counts) -> Rig:
        """Some of the views, which may be of no picture in order: to be given new ones."""
        rig = object.__new__(Rig)
        parts = {each.name: getattr(self, each.name) for each in fields(self)}
        parts["views"] = self.views.take(chosen)
        parts["fading"] = _taken(self.fading, chosen)
        parts["turning"] = replace(self.turning, turns=self.turning.turns[chosen], way=self.turning.way[chosen])
        sums = {each.name: getattr(self.sums, each.name)[chosen] for each in fields(self.sums)}
        parts["sums"] = replace(self.sums, **sums | {"picture": np.arange(len(chosen))})
        for name, part in parts.items():
            object.__setattr__(rig, name, part)
        return rig

    def of_views(self, views: slice) -> Rig:
        """Some of the views, and the pictures that they add to."""
        chosen = np.arange(len(self.views))[views]
        pictures, number = np.unique(self.sums.picture[chosen], return_inverse=True)
        taken = self._with_views(chosen)
        sums, stops = replace(taken.sums, picture=number), _taken(self.stops, pictures)
        return replace(taken, sums=sums, stops=stops)

    def by_colour(self, channels: int) -> Rig:
        """Each view as one of each colour, so that these may go different ways."""
        each = self._with_views(np.repeat(np.arange(len(self.views)), channels))
        share = self.sums.of_colours(channels).repeat(channels, axis=0)
        alone = np.tile(np.eye(channels), (len(self.views), 1))
        picture = self.sums.picture.repeat(channels)
        return replace(each, sums=replace(each.sums, share=share * alone, picture=picture), stops=self.stops)

    def as_one_colour(self) -> Rig:
        """The inverse of `by_colour`, where each colour has an index of refraction: all have the mean of them."""
        if self.glass is None or len(self.glass.iors) == 1:
            return self
        colours = len(self.glass.iors)
        one = self._with_views(np.arange(0, len(self.views), colours))
        share = self.sums.share.reshape(-1, colours, self.sums.share.shape[1]).sum(axis=1)
        sums = replace(one.sums, share=share, picture=self.sums.picture[::colours])
        glass = replace(self.glass, ior=float(np.mean(self.glass.iors)))
        return replace(one, sums=sums, stops=self.stops, glass=glass)

    def squared(self, side: float) -> Rig:
        """The same with pixels that show means over squares of a side in pixels, exactly; for films only."""
        return replace(self, sums=replace(self.sums, square=np.full(len(self.views), float(side))))

    def turned(self, degrees: Numbers) -> Rig:
        """The same when the table has turned on by so many degrees: one number, or one per picture."""
        angles_deg = as_numbers(degrees, "degrees", (), (len(self),))
        each = angles_deg[self.sums.picture]
        lamp, screen = (np.where(self.turning.turns[:, i], self.turning.way[:, i] * each, 0.0) for i in (0, 1))
        views = rotated(self.views, self.turning.axis, lamp, screen)
        return replace(self, views=views, stops=replace(self.stops, angle_deg=self.stops.angle_deg + angles_deg))

    @checked
    def held(self, hold_deg: float, step_deg: float, *, to_the_ends: bool = True) -> Rig:
        """Every picture at several angles within `hold_deg` degrees of its stop, at most `step_deg` apart, in a row.

        They are those of `lightcube.optics.views.hold_offsets_deg`.

        Raises
        ------
        InputError
            Where `hold_deg` is negative, or wider than half the way to the nearest other stop of a screen.
        """
        offsets = hold_offsets_deg(hold_deg, self.widest_hold_deg, step_deg, to_the_ends=to_the_ends)
        if len(offsets) == 1:
            return self
        return self.take(np.repeat(np.arange(len(self)), len(offsets))).turned(np.tile(offsets, len(self)))

    @cached_property
    def both_sides(self) -> Rig:
        """The same with the mirror image of every picture at the stop half a turn on, where level light shows it."""
        if self.period_deg == 360:
            return self
        again = self.turned(180.0)
        views = again.views
        aside = np.sum(views.origins_mm * views.column_steps_mm, axis=1) / np.sum(views.column_steps_mm**2, axis=1)
        views = replace(views, origins_mm=views.origins_mm - 2 * aside[:, None] * views.column_steps_mm)
        both = self.take(np.tile(np.arange(len(self)), 2))
        stops = replace(both.stops, angle_deg=np.concatenate([self.stops.angle_deg, again.stops.angle_deg]))
        return replace(both, views=self.views.joined(views), stops=stops)

    def at(self, angles_deg: Numbers) -> tuple[Rig, Counts]:
        """The room at any turntable angles (degrees), and of which picture each of its pictures is the nearest stop.

        The pictures of an angle follow each other, one for each screen in the order of ``screens.names``. The room is
        lit as at the stop that is nearest: a screen that no picture is wanted on there is dark (its shares are 0). Half
        a turn on level light shows pictures mirrored.
        """
        both = self.both_sides
        asked, screens = check_angles(angles_deg), np.unique(both.stops.screen)
        away = np.abs(np.remainder(asked[:, None] - both.stops.angle_deg + 180, 360) - 180)
        own = np.where(both.stops.screen == screens[:, None, None], away, np.inf)  # (screen, angle, picture)
        shown = np.argmin(own, axis=2).T.ravel()
        lit = (np.min(own, axis=2) < np.min(away, axis=1) + _SAME_STOP).T.ravel()
        now = np.repeat(asked, len(screens))
        moved = both.take(shown).turned(now - both.stops.angle_deg[shown])
        share = moved.sums.share * lit[moved.sums.picture][:, None]
        stops = replace(moved.stops, angle_deg=now)
        return replace(moved, sums=replace(moved.sums, share=share), stops=stops), shown % len(self)

    def split(self, points: Sequence[Reals]) -> Rig:
        """Each view as several, of which each has an equal share of its light.

        Parameters
        ----------
        points
            For each view ``(count, 4)``: how far its pixels move right and down, in pixels, and where in the lamp's
            disc, of radius 1, its light comes from. The disc faces the cube's middle; a lamp without one stays.
        """
        counts = np.array([len(each) for each in points])
        kept = np.repeat(np.arange(len(self.views)), counts)
        copied, moved = self._with_views(kept), np.concatenate(list(points))
        views = copied.views
        origins_mm = views.origins_mm + moved[:, :1] * views.column_steps_mm + moved[:, 1:2] * views.row_steps_mm
        lamps = np.concatenate(
            [
                _in_disc(lamp, disc_deg, each[:, 2:])
                for lamp, disc_deg, each in zip(self.views.lamps, self.sums.disc_deg, points, strict=True)
            ]
        )
        sums = replace(
            copied.sums,
            share=copied.sums.share / counts[kept, None],
            picture=self.sums.picture[kept],
            disc_deg=np.zeros(len(kept)),
        )
        views = replace(views, lamps=lamps, origins_mm=origins_mm)
        return replace(copied, views=views, sums=sums, stops=self.stops)

    @checked
    def shifted(self, offsets: NDArray[np.integer]) -> Rig:
        """Pictures that stand `offsets` ``(picture, 2)`` pixels further right and down on their screens."""
        offsets = np.asarray(offsets)
        if offsets.shape != (len(self), 2):
            raise InputError(
                f"offsets of shape {offsets.shape} do not fit the pictures, which want ({len(self)}, 2): give two each"
            )
        views, own = self.views, offsets[self.sums.picture]
        origins_mm = views.origins_mm + own[:, :1] * views.column_steps_mm + own[:, 1:] * views.row_steps_mm
        return replace(self, views=replace(views, origins_mm=origins_mm))

    @checked
    def with_pixels(self, ratio: float, picture_shape: tuple[int, int]) -> Rig:
        """The same pictures with pixels `ratio` times as large, so many of them around the same middle."""
        before = (np.multiply(picture_shape, ratio) - self.picture_shape) / 2  # what is added above and to the left
        windows = np.ceil((self.stops.window + before) / ratio - 1e-9).astype(np.intp)
        stops = replace(self.stops, window=np.minimum(windows, picture_shape))
        return replace(self, views=self.views.with_pixels(ratio, picture_shape), stops=stops)

    @checked
    def whole(self, grid: Grid) -> Rig:
        """Pictures as large as the cube's whole shadow, in its middle, on screens without edges; others as they are.

        The middle is where the beam through the cube's lands, or as near as the pictures' pixels allow, which are among
        those of the whole shadow: `places_in` says where. It is larger where a picture stands out of the shadow.
        """
        if not np.all(self.screens.endless[self.stops.screen]):
            return self
        views, light = self.views, self.views.lamps[:, :3]
        normals = np.cross(views.column_steps_mm, views.row_steps_mm)
        start = np.zeros((len(views), 3))
        if self.glass is not None:
            start[:, 2] = self.glass.rise_mm(self.light)
        behind = np.sum((views.origins_mm - start) * normals, axis=1) / np.sum(light * normals, axis=1)
        middles_mm = start + behind[:, None] * light
        off = -views.place_of(middles_mm)  # of the pictures, pixels right and down
        pixels = np.rint(off)
        rest = np.where(np.abs(off - pixels) < _SAME_PIXEL, 0.0, off - pixels)
        origins_mm = middles_mm + rest[:, :1] * views.column_steps_mm + rest[:, 1:] * views.row_steps_mm
        sizes = zip(self._whole_shape(grid), views.picture_shape, rest.T[::-1], pixels.T[::-1], strict=True)
        rows, columns = (
            _of_parity(max(most + 2 * math.ceil(np.max(np.abs(r))), own + 2 * int(np.max(np.abs(p)))), own)
            for most, own, r, p in sizes
        )
        stops = replace(self.stops, window=np.tile((rows, columns), (len(self), 1)))
        return replace(self, views=replace(views, origins_mm=origins_mm, picture_shape=(rows, columns)), stops=stops)

    def places_in(self, whole: Rig) -> Counts:
        """Row and column of the `whole` rig's pictures at which those of this one begin, ``(pictures, 2)``."""
        first = self.starts[:-1]
        right_down = whole.views.take(first).place_of(self.views.origins_mm[first])
        spare = np.subtract(whole.picture_shape, self.picture_shape) / 2
        return np.rint(spare + right_down[:, ::-1]).astype(np.intp)

    def _whole_shape(self, grid: Grid) -> tuple[int, int]:
        """Rows and columns of pixels of the cube's whole shadow, and of its blur where a lamp has a disc."""
        raised, wide = np.radians(np.abs(self.views.elevations_deg)), np.radians(self.sums.disc_deg / 2)
        behind, (high, across) = self.behind_mm / grid.voxel_mm, self.views.pixel_in(grid)
        higher = behind * (np.tan(raised + wide) - np.tan(raised))
        aside = np.sin(wide) / np.cos(
            raised + wide
        )  # of the disc's points, for each mm that light goes behind the cube
        wider = behind * aside + np.hypot(*grid.shape[1:]) / 2 * (np.hypot(1, aside) - 1)
        rows, columns = raster_shape(grid, float(np.max(np.degrees(raised + wide))), (high, across))
        columns = columns if self.glass is None else math.ceil(columns * self._wider(self.glass))
        beyond = (np.max(higher) / high, np.max(wider) / across)
        more_rows, more_columns = (2 * math.ceil(float(each) - _NONE) for each in beyond)
        return rows + more_rows, columns + more_columns

    def _wider(self, glass: Glass) -> float:
        """How many times as wide as straight light a round body shows itself on its screens, at least 1."""
        if not (glass.is_round and glass.bends):
            return 1.0
        return max(1.0, float(np.max(self.behind_mm / glass.focus_mm(self.light))) - 1)

    @property
    def behind_mm(self) -> Reals:
        """``(views,)``: how far behind the cube's middle each screen is, along the level way of its lamp's light."""
        level = self.views.lamps[:, :2]
        return np.sum(self.views.origins_mm[:, :2] * level, axis=1) / np.linalg.norm(level, axis=1)

    @property
    def elevation_deg(self) -> float | None:
        """Elevation of the light where all of it is parallel and raised alike, each picture being one view, else None.

        And screens stand upright behind the cube and go round with their lamps, as a turntable's do.
        """
        views = self.views
        raised = np.unique(views.elevations_deg)
        alike = len(views) == len(self) and np.all(views.lamps[:, 3] == 0) and len(raised) == 1
        upright = np.all(self.turning.turns) and np.all(np.abs(views.row_steps_mm[:, :2]) < _NONE)
        along = np.abs(np.sum(views.column_steps_mm * views.lamps[:, :3], axis=1))
        facing = np.all(along < _NONE * np.linalg.norm(views.column_steps_mm, axis=1))
        return float(raised[0]) if alike and upright and facing else None


def _of_parity(count: int, own: int) -> int:
    """The same count, or one more where it is not even or odd like another one."""
    return count + (count - own) % 2


def _taken(part: Any, chosen: Counts) -> Any:
    """Some rows of all arrays of a part."""
    return replace(part, **{each.name: getattr(part, each.name)[chosen] for each in fields(part)})


def _in_disc(lamp: Reals, disc_deg: float, places: Reals) -> Reals:
    """Points of a lamp's disc, homogeneous, ``(count, 4)``, at `places` in a disc of radius 1."""
    if disc_deg == 0:
        return np.tile(lamp, (len(places), 1))
    radius = math.tan(math.radians(disc_deg / 2)) * np.linalg.norm(lamp[:3])
    aside = np.cross(lamp[:3], (0.0, 0.0, 1.0) if np.hypot(lamp[0], lamp[1]) > abs(lamp[2]) else (1.0, 0.0, 0.0))
    beside = np.cross(lamp[:3], aside)
    ways = np.stack([way / np.linalg.norm(way) for way in (aside, beside)])
    return np.asarray(lamp + np.column_stack([radius * places @ ways, np.zeros(len(places))]))
