"""Where the voxels, the lamp and the screen are.

Axes are right-handed with z up, lengths in millimetres, angles in degrees for people. Everything is
in the cube's own axes: the cube stands still and the lamp goes round it. See docs/conventions.md.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Flags, Indices, Numbers, Reals, as_indices, as_numbers, keep
from lightcube.optics.checks import check_fields, checked
from lightcube.optics.grid import Grid, check_elevation, check_pixel, raster_shape
from lightcube.wording import counted

#: Lengths in mm lie between these: squares of squares of others are no numbers.
SHORTEST_MM, FURTHEST_MM = 1e-18, 1e18
#: Columns and rows of a screen run along one line where the sine between them is no larger.
_ALONG = 1e-9
#: A picture has no more rows or columns.
_MOST_PIXELS = 1_000_000
#: Lamps and screens stand no further from a cube than so many times its longest side: float64 counts no further.
_MOST_SIDES = 1e15
#: A cube's pixels are no smaller than this in its voxels' widths: else there is no end to the pixels of its shadow.
_LEAST_PIXEL = 1e-4
#: No angle is larger: float64 would not tell a thousandth of a degree.
MOST_DEG = 1e9
#: More angles are not spread: no cube holds so many pictures.
_MOST_ANGLES = 1_000_000
#: Angles that lie within a whole turn in radians may be some.
_TURN_RAD = 2 * math.pi + 0.01


@dataclass(frozen=True, eq=False)
class Views:
    """Lamp and screen of every view, as vectors in the cube's axes (mm, float64).

    The centre of pixel ``(row, column)`` of view ``v`` lies at
    ``origins_mm[v] + (column - (columns - 1) / 2) * column_steps_mm[v] + (row - (rows - 1) / 2) * row_steps_mm[v]``.

    Parameters
    ----------
    lamps
        ``(views, 4)``, homogeneous: ``(x, y, z, 0)`` is parallel light travelling along ``(x, y, z)``,
        ``(x, y, z, 1)`` a point lamp standing at ``(x, y, z)``.
    origins_mm
        ``(views, 3)``, the middle of each picture on its screen.
    column_steps_mm, row_steps_mm
        ``(views, 3)``, from one pixel to the next one to its right, and to the next one below it.
    picture_shape
        ``(rows, columns)`` of every picture.

    Raises
    ------
    InputError
        Where vectors are not finite, not as many as lamps, or beyond 1e18 mm, a lamp shines nowhere, or a picture's
        sides are not 1 to a million pixels.

    Examples
    --------
    A point lamp 300 mm before the cube, and a picture of 2 x 4 pixels of 10 mm on a screen 100 mm behind it:

    >>> import numpy as np
    >>> import lightcube as lc
    >>> lamp, middle = np.array([[-300, 0, 0, 1]]), np.array([[100, 0, 0]])
    >>> views = lc.Views(lamp, middle, np.array([[0, -10, 0]]), np.array([[0, 0, -10]]), picture_shape=(2, 4))
    >>> len(views), views.picture_shape
    (1, (2, 4))

    On a turntable, where the lamp is parallel, its angles can be asked for, and some of the views be taken:

    >>> views = lc.turntable(lc.Grid((3, 5, 7)), [0, 45, 90], elevation_deg=30).views
    >>> views.take([2, 0]).angles_deg
    array([90.,  0.])
    """

    lamps: Reals
    origins_mm: Reals
    column_steps_mm: Reals
    row_steps_mm: Reals
    picture_shape: tuple[int, int]

    def __post_init__(self) -> None:
        check_fields(self)
        keep(self, **dict.fromkeys(("lamps", "origins_mm", "column_steps_mm", "row_steps_mm"), np.float64))
        count = len(np.atleast_2d(self.lamps))
        for name, width in (("lamps", 4), ("origins_mm", 3), ("column_steps_mm", 3), ("row_steps_mm", 3)):
            array = getattr(self, name)
            if array.shape != (count, width) or not np.all(np.isfinite(array)) or count == 0:
                raise InputError(
                    f"{name} of views must be finite numbers of shape ({count}, {width}), not {array.shape}"
                )
        self._check_lengths()
        if not 1 <= min(self.picture_shape) <= max(self.picture_shape) <= _MOST_PIXELS:
            raise InputError(f"a picture's shape is two whole numbers from 1 to a million, not {self.picture_shape}")
        object.__setattr__(self, "picture_shape", tuple(int(n) for n in self.picture_shape))

    def _check_lengths(self) -> None:
        """Raise `InputError` where a length cannot be computed with, or a lamp shines nowhere."""
        if not np.all(np.isin(self.lamps[:, 3], (0.0, 1.0))):
            raise InputError("lamps: the fourth number of a lamp is 0, a direction, or 1, a place")
        for name in ("lamps", "origins_mm", "column_steps_mm", "row_steps_mm"):
            sizes = np.max(np.abs(getattr(self, name)), axis=1)
            self._refuse(name, sizes, sizes > FURTHEST_MM)
        directions = np.max(np.abs(self.lamps[:, :3]), axis=1)
        self._refuse("lamps", directions, (self.lamps[:, 3] == 0) & (directions < SHORTEST_MM))

    def check_screens(self) -> None:
        """Raise `InputError` where a picture has no size."""
        for name in ("column_steps_mm", "row_steps_mm"):
            sizes = np.max(np.abs(getattr(self, name)), axis=1)
            self._refuse(name, sizes, sizes < SHORTEST_MM)
        across, down = unit(self.column_steps_mm), unit(self.row_steps_mm)
        if np.any(np.linalg.norm(np.cross(across, down), axis=1) <= _ALONG):
            raise InputError("column_steps_mm: a screen's columns and rows run along one line: give it a size")

    def _refuse(self, name: str, sizes: Reals, wrong: Flags) -> None:
        """Raise `InputError` with the first of the sizes that are wrong."""
        if np.any(wrong):
            view = int(np.argmax(wrong))
            raise InputError(
                f"{name} of view {view + 1} is {sizes[view]:g}, and must be between {SHORTEST_MM:g} and "
                f"{FURTHEST_MM:g} mm: mend it"
            )

    def __len__(self) -> int:
        return len(self.lamps)

    def __repr__(self) -> str:
        rows, columns = self.picture_shape
        return f"<{counted(len(self), 'view')} of {rows} x {columns} pixels>"

    @property
    def angles_deg(self) -> Reals:
        """Turntable angle of each view's parallel lamp, degrees in [0, 360), to 1e-9."""
        x, y = self.lamps[:, 0], self.lamps[:, 1]
        degrees: Reals = np.degrees(np.arctan2(-y, x))
        return np.asarray(np.round(degrees, 9) % 360, dtype=np.float64)

    @property
    def elevations_deg(self) -> Reals:
        """Elevation of each view's parallel lamp above the horizon, degrees in (-90, 90), to 1e-9."""
        level = np.hypot(self.lamps[:, 0], self.lamps[:, 1])
        return np.asarray(np.round(np.degrees(np.arctan2(-self.lamps[:, 2], level)), 9), dtype=np.float64)

    def pixel_in(self, grid: Grid) -> tuple[float, float]:
        """Height and width of the smallest pixel, in voxels' widths, to 1e-9."""
        steps = self.row_steps_mm, self.column_steps_mm
        high, wide = (round(float(np.min(np.linalg.norm(each, axis=1))) / grid.voxel_mm, 9) for each in steps)
        return high, wide

    def slices_a_row(self, grid: Grid) -> int:
        """How many slices the rows of all screens are apart, one right above the other; 0 where that is not whole."""
        side = grid.slice_mm
        apart = max(1, round(-float(self.row_steps_mm[0, 2]) / side))
        return apart if np.allclose(self.row_steps_mm, (0, 0, -apart * side), rtol=0, atol=1e-9 * side) else 0

    def take(self, indices: Indices) -> Views:
        """Return some of the views, in the order of `indices`."""
        chosen = as_indices(indices, len(self), "views")
        return Views(
            self.lamps[chosen],
            self.origins_mm[chosen],
            self.column_steps_mm[chosen],
            self.row_steps_mm[chosen],
            self.picture_shape,
        )

    def place_of(self, points_mm: Reals) -> Reals:
        """Where a point of each screen's plane, ``(views, 3)``, lies on it, right and down of its picture's middle.

        Returns
        -------
        ``(views, 2)``, in pixels.
        """
        steps = np.stack([self.column_steps_mm, self.row_steps_mm], axis=1)
        onto = steps @ (points_mm - self.origins_mm)[:, :, None]
        return np.asarray(np.linalg.solve(steps @ steps.transpose(0, 2, 1), onto)[..., 0])

    @checked
    def joined(self, other: Views) -> Views:
        """Return these views and then the others, of the same shape of pictures."""
        if other.picture_shape != self.picture_shape:
            raise InputError(
                f"views of {other.picture_shape} pixels do not join those of {self.picture_shape}: give as large ones"
            )
        names = ("lamps", "origins_mm", "column_steps_mm", "row_steps_mm")
        arrays = {name: np.concatenate([getattr(self, name), getattr(other, name)]) for name in names}
        return Views(**arrays, picture_shape=self.picture_shape)

    @checked
    def with_pixels(self, ratio: float, picture_shape: tuple[int, int]) -> Views:
        """Return the same views with pixels `ratio` times as large, so many of them around the same middle."""
        return Views(
            self.lamps, self.origins_mm, ratio * self.column_steps_mm, ratio * self.row_steps_mm, picture_shape
        )


class DoubtfulAngles(UserWarning):
    """Angles lie so near to each other that they may be radians."""


def doubt_angles(angles_deg: Numbers | None, of: str, *, stacklevel: int) -> None:
    """Warn where angles, three at least, lie as near to each other as if they were not in degrees."""
    if angles_deg is not None and np.size(angles_deg) > 2 and 0 < float(np.ptp(np.asarray(angles_deg))) <= _TURN_RAD:
        said = f"{of}: all angles lie within a few degrees: if they are radians, multiply them by 57.2958"
        warnings.warn(said, DoubtfulAngles, stacklevel=stacklevel + 1)


def check_angles(angles_deg: Numbers) -> Reals:
    """Return `angles_deg` as a float64 vector, or raise `InputError` unless all are finite and there is one."""
    vector = np.atleast_1d(as_numbers(angles_deg, "angles"))
    if vector.ndim != 1 or vector.size == 0:
        raise InputError("angles must be a list of at least one number of degrees")
    sane = np.abs(vector) <= MOST_DEG
    if not np.all(sane):
        raise InputError(
            f"angle number {int(np.argmin(sane)) + 1} is not a finite number of degrees below {MOST_DEG:g}: mend it"
        )
    return vector


@checked
def spread_angles(count: int, span_deg: float | None = None, *, elevation_deg: float = 0.0) -> Reals:
    """`count` angles spread evenly over `span_deg` degrees (default 180 at elevation 0, else 360).

    They start half a step from 0, or a third of a step where half a step would put one on a multiple
    of 90 degrees: there a picture as wide as the cube has no margin.

    Raises
    ------
    InputError
        Where `count` is below 1, or `span_deg` not above 0 or beyond 360.

    Examples
    --------
    >>> import lightcube as lc
    >>> lc.spread_angles(4)
    array([ 22.5,  67.5, 112.5, 157.5])
    >>> lc.spread_angles(4, elevation_deg=35)
    array([ 45., 135., 225., 315.])
    >>> lc.spread_angles(1)  # half a step would be 90
    array([60.])
    """
    check_elevation(elevation_deg)
    if span_deg is None:
        span_deg = 360.0 if elevation_deg else 180.0
    if not 1 <= count <= _MOST_ANGLES:
        raise InputError(f"cannot spread {count} angles: use 1 to {_MOST_ANGLES:,}")
    check_span(span_deg)
    step = span_deg / count
    for offset in (1 / 2, 1 / 3):
        angles_deg = (np.arange(count, dtype=np.float64) + offset) * step
        if np.min(np.abs(np.remainder(angles_deg + 45, 90) - 45)) > 1e-9:
            break
    return angles_deg


def check_span(span_deg: float) -> None:
    """Raise `InputError` unless angles can be spread over so many degrees."""
    if not 0 < span_deg <= 360:
        raise InputError(f"cannot spread angles over {span_deg:g} degrees: use a span above 0 and up to 360")


def swept_mm(grid: Grid) -> float:
    """Radius of the circle that the corners of a turning cube sweep, mm."""
    return math.hypot(*grid.shape[1:]) / 2 * grid.voxel_mm


def check_lamp(lamp_deg: float, screen_mm: float | None, *, matters: bool = False) -> None:
    """Raise `InputError` unless a lamp can have such a disc, and a screen stand so far behind the cube.

    Where the distance of a screen `matters` it may be said of lamps without a disc too.
    """
    if not 0 <= lamp_deg < 90:
        raise InputError(f"a lamp's disc has an angular diameter from 0 to below 90 degrees, not {lamp_deg:g}")
    if screen_mm is None:
        return
    if not (lamp_deg or matters):
        raise InputError(
            "how far away the screen stands changes nothing unless the lamp has a size: give its angular diameter too"
        )
    if not 0 <= screen_mm < math.inf:
        raise InputError(f"a screen {screen_mm:g} mm behind the turning cube would stand inside it: use at least 0")


def check_reach(views: Views, grid: Grid) -> None:
    """Raise `InputError` where lamps or screens are too far from a cube to be computed with."""
    most_mm = _MOST_SIDES * grid.longest * grid.voxel_mm
    places = np.where(views.lamps[:, 3:] == 1, views.lamps[:, :3], 0.0)
    half = np.multiply(views.picture_shape, 0.5)
    edges = np.abs(views.origins_mm) + half[1] * np.abs(views.column_steps_mm) + half[0] * np.abs(views.row_steps_mm)
    for what, lengths in (("lamp", np.abs(places)), ("picture", edges)):
        furthest = np.max(lengths, axis=1)
        if np.any(furthest > most_mm):
            view = int(np.argmax(furthest))
            raise InputError(
                f"the {what} of view {view + 1} reaches {furthest[view]:g} mm from the cube's middle, and "
                f"{most_mm:g} mm is the most for a cube of {grid.longest * grid.voxel_mm:g} mm: move it nearer"
            )


def check_pixels(views: Views, grid: Grid) -> None:
    """Raise `InputError` where pixels are too small for their number to have an end."""
    smallest = min(views.pixel_in(grid))
    if smallest < _LEAST_PIXEL:
        raise InputError(f"a pixel is {smallest:g} voxels large: make it {_LEAST_PIXEL:g} at least")


def _turned(angles_deg: Reals, vector: tuple[float, float, float]) -> Reals:
    """`vector` of the room in the axes of a cube that was turned counter-clockwise by `angles_deg` (degrees)."""
    cos, sin = _cos_sin(angles_deg)
    x, y, z = vector
    return np.stack([cos * x + sin * y, -sin * x + cos * y, np.full_like(cos, z)], axis=1)


def _cos_sin(degrees: Reals) -> tuple[Reals, Reals]:
    """Cosine and sine, exact at multiples of 90 degrees."""
    turn = np.remainder(degrees, 360.0)
    quarter = np.rint(turn / 90)
    rest = np.radians(turn - 90 * quarter)
    cos, sin = np.cos(rest), np.sin(rest)
    index = quarter.astype(int) % 4
    return np.choose(index, [cos, -sin, -cos, sin]), np.choose(index, [sin, cos, -sin, -cos])


def unit(vector: Numbers) -> Reals:
    """The vector, or each of ``(n, 3)`` vectors, of length 1 that points the same way."""
    array = np.asarray(vector, np.float64)
    return np.asarray(array / np.linalg.norm(array, axis=-1, keepdims=True))


def rotations(axis: Numbers, degrees: Reals) -> Reals:
    """``(n, 3, 3)``: rotations counter-clockwise about `axis` by each of the angles (O. Rodrigues, 1840)."""
    cos, sin = (each[:, None, None] for each in _cos_sin(degrees))
    x, y, z = unit(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    along = np.outer(unit(axis), unit(axis))
    return np.asarray(cos * (np.eye(3) - along) + sin * cross + along, np.float64)


def turntable_views(
    grid: Grid,
    angles_deg: Numbers,
    *,
    elevation_deg: float = 0.0,
    picture_shape: tuple[int, int] | None = None,
    pixel: int = 1,
) -> Views:
    """The beams of `lightcube.turntable`, which takes and raises the same.

    Examples
    --------
    >>> import lightcube as lc
    >>> rig = lc.turntable(lc.Grid((3, 5, 7)), [0, 90], elevation_deg=30, picture_shape=(3, 5))
    >>> rig.views.lamps  # turned by 90 degrees the cube sees the lamp from its other side
    array([[ 0.866,  0.   , -0.5  ,  0.   ],
           [ 0.   , -0.866, -0.5  ,  0.   ]])
    """
    turned = check_angles(angles_deg)
    elevation_deg = check_elevation(elevation_deg)
    side_mm = check_pixel(pixel, grid) * grid.voxel_mm
    raster = raster_shape(grid, elevation_deg, pixel)
    shape = picture_shape or raster
    if shape[0] > raster[0] or shape[1] > raster[1]:
        raise InputError(
            f"a picture of {shape[0]} x {shape[1]} pixels (rows x columns) is larger than "
            f"the cube's screen of {raster[0]} x {raster[1]}: make it smaller"
        )
    tilt = math.radians(elevation_deg)
    light = _turned(turned, (math.cos(tilt), 0.0, -math.sin(tilt)))
    return Views(
        lamps=np.concatenate([light, np.zeros((len(turned), 1))], axis=1),
        origins_mm=np.zeros((len(turned), 3)),
        column_steps_mm=_turned(turned, (0.0, -side_mm, 0.0)),
        row_steps_mm=_turned(turned, (0.0, 0.0, -side_mm)),
        picture_shape=shape,
    )


def rotated(views: Views, axis: Numbers, lamps: Reals, screens: Reals) -> Views:
    """Views whose lamps and screens have gone round the cube, counter-clockwise about `axis`, by degrees per view."""
    lamp, screen = rotations(axis, lamps), rotations(axis, screens)
    shone = np.einsum("vij,vj->vi", lamp, views.lamps[:, :3])
    origins_mm, right, down = (
        np.einsum("vij,vj->vi", screen, vectors)
        for vectors in (views.origins_mm, views.column_steps_mm, views.row_steps_mm)
    )
    return Views(np.column_stack([shone, views.lamps[:, 3]]), origins_mm, right, down, views.picture_shape)


def smallest_gap_deg(angles_deg: Reals, period: float) -> float:
    """Degrees between the two nearest of the `angles_deg` that differ, which repeat after `period` degrees."""
    stops = np.unique(np.round(angles_deg % period, 9) % period)
    return float(np.min(np.diff(stops, append=stops[0] + period)))


#: Angles of a hold that does not go to its ends are so much of a step apart at most: else pictures fall apart between
#: them (measured: 34.5 dB at a stop between angles 1.5 steps apart, 40.3 dB at 0.75).
_APART = 0.9


def hold_offsets_deg(hold_deg: float, most: float, step: float, *, to_the_ends: bool = True) -> Reals:
    """Degrees off its stop at which a picture is asked for, less than `step` apart.

    To the ends of the hold, with 0 in the middle; or in the middles of equal parts of it, the outer ones half as wide
    again, which takes fewer.

    Raises
    ------
    InputError
        Where `hold_deg` is negative, or wider than `most`.
    """
    if not hold_deg >= 0:
        raise InputError(f"a hold must be a number of degrees of at least 0, not {hold_deg:g}")
    if hold_deg > most + 1e-9:
        most = math.floor(most * 1000) / 1000
        raise InputError(
            f"a hold of {hold_deg:g} degrees is wider than half the way to the next stop: use at most {most:g}"
        )
    if hold_deg > 0 and not to_the_ends:
        count = 2
        while 2 * hold_deg * (1 - 0.5 / count) > _APART * step * (count - 1):
            count += 1
        return (1 - 0.5 / count) * np.linspace(-hold_deg, hold_deg, count)
    aside = max(math.ceil(hold_deg / step - 1e-9), int(hold_deg > 0))
    return np.linspace(-hold_deg, hold_deg, 2 * aside + 1)


#: Angles closer than this, in degrees and whole turns apart, are the same view.
_SAME_ANGLE = 1e-9


def distinct_angles(angles_deg: Numbers) -> Reals:
    """Return `angles_deg` (degrees) as a vector, or raise `InputError` where two are the same view, turns apart."""
    vector = check_angles(angles_deg)
    turned = np.remainder(vector, 360.0)
    order = np.argsort(turned, kind="stable")
    gaps = np.diff(turned[order], append=turned[order[0]] + 360.0)
    if len(vector) > 1 and np.min(gaps) < _SAME_ANGLE:
        at = int(np.argmin(gaps))
        first, second = sorted((int(order[at]), int(order[(at + 1) % len(vector)])))
        raise InputError(
            f"angles number {first + 1} and {second + 1} ({vector[first]:g} and {vector[second]:g} degrees) "
            "are the same view: give every picture an angle of its own"
        )
    return vector
