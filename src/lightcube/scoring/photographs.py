"""A photograph of the real thing beside what was promised: found in it, straightened, and exposed as the promise is.

What a camera sees of a flat picture is a projection of it. Its corners are given, or guessed from what is lit in the
dark; from there on they are moved until the photograph is most like the promise, coarsely first. Exposure and white
balance of a photograph are its photographer's: each colour is scaled to what brings it nearest to the promise.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Floats, Images, Reals
from lightcube.optics.transfer import Transfer, decode, encode
from lightcube.pictures.projective import homography, projected
from lightcube.scoring.metrics import delta_e, psnr, ssim

#: Points along each side of a pixel at which a photograph is looked at.
_POINTS = 3
#: Corners are moved at so many pixels a side, and by such steps in sides of the picture, from coarse to fine.
_LEVELS = ((6, 0.03), (12, 0.012), (24, 0.004), (64, 0.001))
#: A photograph that is less like the promise, correlated, was not found.
_ALIKE = 0.7
#: Values from here on may be clipped.
_CLIPPED = 0.985
#: A photograph whose brightest is darker, in display values, shows nothing.
_NIGHT = 0.02
#: What is lit is brighter than so much of the way from dark to bright.
_LIT = 0.15


@dataclass(frozen=True, eq=False)
class Photographed:
    """What a photograph shows of a picture.

    Parameters
    ----------
    light
        ``(row, column, channel)`` linear light, exposed as the promise is.
    corners_px
        ``(4, 2)``: x and y in the photograph of the picture's upper left, upper right, lower right, lower left corner.
    exposure
        ``(channel,)``: by how much each colour was brightened.
    clipped
        Part of the pixels that were too bright for the camera.
    is_mirrored
        Whether right and left are exchanged.
    """

    light: Images
    corners_px: Reals
    exposure: Reals
    clipped: float
    is_mirrored: bool

    def figures(self, promised: Images, wanted: Images, weight: Images, transfer: Transfer) -> dict[str, Any]:
        """How near it comes to what was promised, and to what was wanted: ``psnr, ssim, delta_e`` of each."""
        seen = encode(self.light, transfer)
        found: dict[str, Any] = {}
        for name, picture in (("promised", promised), ("wanted", wanted)):
            pair = seen, encode(picture, transfer), weight
            found[name] = {"psnr": psnr(*pair), "ssim": ssim(*pair), "delta_e": delta_e(*pair)}
        return found | {
            "exposure_ev": (-np.log2(self.exposure)).tolist(),
            "clipped": self.clipped,
            "mirrored": self.is_mirrored,
            "corners_px": self.corners_px.tolist(),
        }


def photographed(
    photo: Images, promised: Images, corners_px: Reals | None = None, transfer: Transfer = "srgb"
) -> Photographed:
    """Find a picture in a photograph of it.

    Parameters
    ----------
    photo
        ``(row, column, channel)`` linear light.
    promised
        ``(row, column, channel)`` linear light, what the wall is to show.
    corners_px
        ``(4, 2)`` x and y of the corners, roughly, clockwise from the picture's upper left; None = they are guessed.
    transfer
        Of display values, by which the two are compared.

    Raises
    ------
    InputError
        Where corners do not make a quadrangle inside the photograph, or the picture is not found.
    """
    if photo.ndim != 3 or photo.shape[2] != promised.shape[2]:
        raise InputError(f"a photograph of shape {photo.shape} has other colours than the picture: give one in colour")
    shown = encode(promised, transfer)
    given = _guessed(photo) if corners_px is None else [_checked(corners_px, photo)]
    tried = [_moved(photo, shown, corners, transfer, *_LEVELS[0]) for corners in given]
    likeness, corners = max(tried, key=lambda each: each[0])
    for level in _LEVELS[1:]:
        likeness, corners = _moved(photo, shown, corners, transfer, *level)
    if likeness < _ALIKE:
        hint = "give its corners" if corners_px is None else "are these its corners, and is it this stop's picture?"
        raise InputError(f"the picture was not found in the photograph, which is {likeness:.0%} like it: {hint}")
    raw = straightened(photo, corners, promised.shape[:2])
    exposure = _exposure(raw, shown, transfer)
    clipped = float(np.mean(np.max(raw, axis=-1) >= _CLIPPED))
    light = (raw * exposure).astype(np.float32)
    return Photographed(light, corners, exposure, clipped, _area(corners) < 0)


def straightened(photo: Floats, corners_px: Reals, shape: tuple[int, int]) -> Reals:
    """``(row, column, channel)``: means over the pixels of a picture whose corners are where they are said to be."""
    rows, columns = shape
    place = homography(np.array([[0, 0], [columns, 0], [columns, rows], [0, rows]], np.float64), corners_px)
    across, along = ((np.arange(count * _POINTS) + 0.5) / _POINTS for count in (columns, rows))
    values = _between(photo, projected(place, np.stack(np.meshgrid(across, along), axis=-1)) - 0.5)
    return np.asarray(values.reshape(rows, _POINTS, columns, _POINTS, -1).mean(axis=(1, 3)))


def _between(photo: Floats, points: Reals) -> Reals:
    """Light at points x, y of a photograph, between its pixels; what is outside is as at its border."""
    rows, columns = photo.shape[:2]
    x, y = np.clip(points[..., 0], 0, columns - 1.000001), np.clip(points[..., 1], 0, rows - 1.000001)
    left, above = x.astype(np.intp), y.astype(np.intp)
    right, down = (x - left)[..., None], (y - above)[..., None]
    upper = photo[above, left] * (1 - right) + photo[above, np.minimum(left + 1, columns - 1)] * right
    below = np.minimum(above + 1, rows - 1)
    lower = photo[below, left] * (1 - right) + photo[below, np.minimum(left + 1, columns - 1)] * right
    return np.asarray(upper * (1 - down) + lower * down)


def _checked(corners_px: Reals, photo: Images) -> Reals:
    """Corners that make a quadrangle, or `InputError`."""
    corners = np.asarray(corners_px, np.float64)
    rows, columns = photo.shape[:2]
    if corners.shape != (4, 2) or not np.all(np.isfinite(corners)):
        raise InputError("a picture has four corners, x and y of each: give 8 numbers")
    if np.any(corners < 0) or np.any(corners > (columns, rows)):
        raise InputError(
            f"a corner lies outside the photograph of {columns} x {rows} pixels: give those of the picture"
        )
    edge = np.roll(corners, -1, axis=0) - corners
    turned = np.roll(edge, -1, axis=0)
    turns = edge[:, 0] * turned[:, 1] - edge[:, 1] * turned[:, 0]
    if not (np.all(turns > 0) or np.all(turns < 0)):
        raise InputError("the corners do not follow each other round the picture: give them clockwise from upper left")
    return corners


def _guessed(photo: Images) -> list[Reals]:
    """The corners of what is lit in the dark, from each of them on, both ways round."""
    from scipy.ndimage import binary_closing, label, uniform_filter  # here: it takes long to load

    grain = 1 + max(photo.shape[:2]) // 200
    light = uniform_filter(np.sqrt(np.maximum(photo, 0)).mean(axis=2), grain)
    dark, bright = np.percentile(light, (5, 99.5))
    pieces, count = label(binary_closing(light > dark + _LIT * (bright - dark), iterations=4 * grain))
    if not count or bright < _NIGHT:
        raise InputError("nothing is lit in the photograph: give the corners of the picture, or another photograph")
    lit = np.argwhere(pieces == 1 + np.argmax(np.bincount(pieces.ravel())[1:]))[:, ::-1] + 0.5
    upper_left, lower_right = (lit[pick(lit @ (1, 1))] for pick in (np.argmin, np.argmax))
    lower_left, upper_right = (lit[pick(lit @ (1, -1))] for pick in (np.argmin, np.argmax))
    around = np.array([upper_left, upper_right, lower_right, lower_left])
    middle = around.mean(axis=0)
    sizes = (around, middle + 0.85 * (around - middle))  # the mat, if any, may be lit too
    return [np.roll(each[::way], turn, axis=0) for each, way, turn in itertools.product(sizes, (1, -1), range(4))]


def _moved(
    photo: Images, shown: Floats, corners: Reals, transfer: Transfer, most: int, step: float
) -> tuple[float, Reals]:
    """Corners moved until the photograph is most like the promise, at so many pixels a side, and how like it is."""
    from scipy.optimize import least_squares  # here: it takes long to load

    rows, columns = shown.shape[:2]
    shape = min(rows, most), min(columns, most)
    goal, side = _shrunk(shown, shape), np.sqrt(abs(_area(corners)))

    def seen(moves: Reals) -> Reals:
        raw = straightened(photo, corners + side * (moves.reshape(4, 2) - 1), shape)
        return np.asarray(encode(raw * _exposure(raw, goal, transfer), transfer), np.float64)

    def off(moves: Reals) -> Reals:
        return np.asarray((seen(moves) - goal).ravel())

    # steps are parts of numbers, which therefore begin at 1
    found = least_squares(off, np.ones(8), jac="3-point", diff_step=np.full(8, step))
    return _likeness(seen(found.x), goal), corners + side * (found.x.reshape(4, 2) - 1)


def _shrunk(picture: Floats, shape: tuple[int, int]) -> Reals:
    """A picture at fewer pixels, each the mean of its points."""
    rows, columns = picture.shape[:2]
    whole = np.array([[0, 0], [columns, 0], [columns, rows], [0, rows]], np.float64)
    return straightened(picture, whole, shape)


def _exposure(raw: Floats, shown: Floats, transfer: Transfer) -> Reals:
    """``(channel,)``: how much brighter each colour must be for its light to be nearest to the promise's."""
    wanted = decode(np.asarray(shown, np.float32), transfer)
    strong = np.sum(wanted * raw, axis=(0, 1)) / np.maximum(np.sum(raw * raw, axis=(0, 1)), 1e-12)
    return np.asarray(np.maximum(strong, 1e-6), np.float64)


def _likeness(one: Floats, other: Floats) -> float:
    """Correlation of two pictures, over all colours."""
    left, right = (np.asarray(each, np.float64) - np.mean(each) for each in (one, other))
    return float(np.sum(left * right) / max(np.sqrt(np.sum(left**2) * np.sum(right**2)), 1e-12))


def _area(corners: Reals) -> float:
    """Area within corners, above 0 where they go clockwise in a picture whose y points down."""
    x, y = corners.T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)
