"""How near what is cast comes to what was wanted, always in display values and never clipped."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage import color
from skimage import metrics as similarities

from lightcube.backward.mat import Mat, judged_beyond, judged_pixels, widened
from lightcube.backward.recipe import recipe_of
from lightcube.errors import InputError
from lightcube.forward.casting import cast, screens
from lightcube.optics.arrays import Images, Reals
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.light import is_exact, judged_one_by_one
from lightcube.optics.transfer import Transfer, encode
from lightcube.pictures.fitting import targets_of
from lightcube.pictures.targets import Targets

#: The best PSNR that is reported, dB.
BEST_DB = 100.0
#: Pictures of this PSNR, dB, are hard to tell from what is wanted: they are made small enough for it.
GOOD_DB = 40.0
#: The least PSNR, dB, of a picture that is called good, and of one that is fair: recognisable, with faults that one
#: sees. A worse one is poor.
WELL_DB, FAIR_DB = 33.0, 26.0

Display = NDArray[np.floating[Any]]


#: Grain below these is called so; else coarse.
_GRAINS = {"smooth": 0.03, "fine": 0.10}


def grain_word(rms: float) -> str:
    """How light that varies so much inside pixels (display values) looks: smooth, fine or coarse."""
    return next((word for word, least in _GRAINS.items() if rms < least), "coarse")


def nearness(decibels: float) -> str:
    """What a picture of such a PSNR looks like, in a few words."""
    return "hard to tell from what is wanted" if decibels >= GOOD_DB else mark(decibels)


def mark(decibels: float) -> str:
    """The mark of a picture of such a PSNR: good, fair or poor, as the page that is turned by hand gives it."""
    return "good" if decibels >= WELL_DB else "fair" if decibels >= FAIR_DB else "poor"


def psnr(shown: Display, wanted: Display, weight: Display) -> float:
    """Peak signal-to-noise ratio in dB of display values ``(row, column, channel)``, at most 100.

    ``-10 log10(mean squared difference)``, pixels weighted by `weight` ``(row, column)``.
    """
    squares = np.mean((shown.astype(np.float64) - wanted) ** 2, axis=-1)
    return psnr_of(float(np.sum(weight * squares) / np.sum(weight)))


def psnr_of(error: float) -> float:
    """PSNR in dB, at most 100, of a mean squared difference of display values."""
    return BEST_DB if error <= 10 ** (-BEST_DB / 10) else -10 * float(np.log10(error))


def ssim(shown: Display, wanted: Display, weight: Display) -> float:
    """Structural similarity of display values, the weighted mean over pixels (scikit-image, uniform window).

    The window is 7 x 7 pixels, or the largest odd one that fits a smaller picture; NaN below 3 x 3 pixels. Pixels of
    no weight that a window reaches over count as right.
    """
    shown = np.where(weight[..., None] > 0, shown, wanted)
    smallest = min(shown.shape[:2])
    if smallest < 3:
        return float("nan")
    window = min(7, smallest - 1 + smallest % 2)
    _, similarity = similarities.structural_similarity(
        shown.astype(np.float64), wanted.astype(np.float64), win_size=window, data_range=1.0, channel_axis=-1, full=True
    )
    return float(np.sum(weight * similarity.mean(axis=-1)) / np.sum(weight))


def delta_e(shown: Display, wanted: Display, weight: Display) -> float:
    """Colour difference CIEDE2000 (D65, sRGB primaries), the weighted mean over pixels; one channel is grey."""
    colours = (np.broadcast_to(each.astype(np.float64), (*each.shape[:2], 3)) for each in (shown, wanted))
    difference = color.deltaE_ciede2000(*(color.rgb2lab(each) for each in colours))
    return float(np.sum(weight * difference) / np.sum(weight))


@checked
def score(cube: Cube, targets: Targets | None = None) -> dict[str, Any]:
    """Compare what a wall shows of the cube at its stops with what was wanted.

    A wall's pixel is the mean of the light over its area (`lightcube.optics.light`). Beside it stand the thin beams
    through the pixels' middles, which the paper has, and the **grain**: how much light varies inside pixels.

    Parameters
    ----------
    targets
        The wanted pictures, on the cube's rig; None = the 16-bit targets stored in the cube.

    Returns
    -------
    figures by name
        ``psnr_mean, psnr_min, ssim_mean, delta_e_mean`` and ``pictures``, a list with ``name, angle_deg, psnr, ssim,
        delta_e`` of each; ``thin_psnr_mean, thin_psnr_min`` of the thin beams; ``grain_rms``, how far a pixel's beams
        are off the pixel's value (root of the mean square, display values), and ``grain_db``, how much lower the PSNR
        of all beams one by one is than that of their means; and where the pictures have mats ``mat_rms``, how far those
        are off their tone (root of the mean square, display values), and ``beyond_rms``, how far the rest of the shadow
        is.

    Raises
    ------
    InputError
        Where the cube has no targets and none are given, or they do not fit the cube's pictures.
    """
    wanted = targets_of(cube) if targets is None else targets
    check_same_views(cube, wanted)
    seen = Seen.of(cube, wanted.transfer)
    figures = score_pictures(seen.light, wanted)
    thin = [picture["psnr"] for picture in score_pictures(cast(cube, light="thin"), wanted)["pictures"]]
    beams = [psnr_of(error) for error in seen.errors(encode(wanted.pictures, wanted.transfer), wanted.weight)]
    grain = float(np.mean(seen.errors(encode(seen.light, wanted.transfer), wanted.weight)))
    return {
        **figures,
        "thin_psnr_mean": float(np.mean(thin)),
        "thin_psnr_min": float(np.min(thin)),
        "grain_rms": float(np.sqrt(max(grain, 0.0))),
        "grain_db": max(figures["psnr_mean"] - float(np.mean(beams)), 0.0),
        **_mat(cube),
    }


def _mat(cube: Cube) -> dict[str, float]:
    """How far the mats of a cube's pictures are off their tone, and the shadow beyond, where they have any."""
    mat = recipe_of(cube).mat
    if mat is None:
        return {}
    near = cast(cube, widened(cube.rig, cube.grid, mat)), judged_pixels(cube.rig, cube.grid, mat)
    beyond = screens(cube, picture_only=False, zoom=1, light="area")(None), judged_beyond(cube.rig, cube.grid, mat)
    off = {"mat_rms": _off_tone(cube, mat, *near), "beyond_rms": _off_tone(cube, mat, *beyond)}
    return {name: value for name, value in off.items() if value is not None}


def _off_tone(cube: Cube, mat: Mat, shown: Iterator[Images], chosen: Images) -> float | None:
    """How far chosen pixels of some pictures are off a mat's tone; None where there are none."""
    if not np.any(chosen):
        return None
    error = 0.0
    for picture, weight in zip(shown, chosen, strict=True):
        error += float(np.sum(weight[..., None] * (encode(picture, cube.transfer) - mat.tone) ** 2))
    return float(np.sqrt(error / (np.sum(chosen) * len(cube.extinction))))


@dataclass(frozen=True, eq=False)
class Seen:
    """What a wall shows of a cube at its stops, and within pixels, ``(picture, row, column, channel)``.

    Parameters
    ----------
    light
        The mean over a pixel, linear light.
    display, squares
        The mean of its beams' display values, and of their squares.
    """

    light: Images
    display: Display
    squares: Display

    @classmethod
    def of(cls, cube: Cube, transfer: Transfer) -> Seen:
        """Cast a cube at all points of its pixels."""
        rigs = judged_one_by_one(cube.rig, cube.grid)
        shape = len(cube.rig), *cube.rig.picture_shape, len(cube.extinction)
        sums = np.zeros((3, *shape))
        for rig in rigs:
            for index, picture in enumerate(cast(cube, rig, light="thin")):
                display = encode(picture, transfer)
                for total, value in zip(sums, (picture, display, display.astype(np.float64) ** 2), strict=True):
                    total[index] += value
        light, display, squares = sums / len(rigs)
        if is_exact(cube.rig, cube.grid):
            light = np.stack(list(cast(cube)))
        return cls(light.astype(np.float32), display, squares)

    def errors(self, wanted: Display, weight: Display) -> Reals:
        """Of each picture, the mean squared difference of all its beams, one by one, from display values `wanted`."""
        off = np.mean(self.squares - 2 * wanted * self.display + wanted.astype(np.float64) ** 2, axis=-1)
        return np.asarray(np.sum(weight * off, axis=(1, 2)) / np.sum(weight, axis=(1, 2)))


def score_pictures(shown: Iterable[Images], targets: Targets) -> dict[str, Any]:
    """Compare pictures in linear light ``(row, column, channel)`` with the targets, in order; returns as `score`."""
    views: list[dict[str, Any]] = []
    for index, picture in enumerate(shown):
        pair = (
            encode(picture, targets.transfer),
            encode(targets.pictures[index], targets.transfer),
            targets.weight[index],
        )
        views.append(
            {
                "name": targets.names[index],
                "angle_deg": float(targets.angles_deg[index]),
                "psnr": psnr(*pair),
                "ssim": ssim(*pair),
                "delta_e": delta_e(*pair),
            }
        )
    columns = {key: [view[key] for view in views] for key in ("psnr", "ssim", "delta_e")}
    return {
        "psnr_mean": float(np.mean(columns["psnr"])),
        "psnr_min": float(np.min(columns["psnr"])),
        "ssim_mean": float(np.mean(columns["ssim"])),
        "delta_e_mean": float(np.mean(columns["delta_e"])),
        "pictures": views,
    }


def mean_psnr(shown: Images, targets: Targets, window: tuple[slice, slice] = (slice(None), slice(None))) -> float:
    """Mean over pictures of `psnr`, for pictures in linear light ``(view, row, column, channel)``.

    `shown` are the rows and channels of the targets that `window` says; pictures without weight there do not count.
    """
    rows, channels = window
    each = [
        psnr(encode(picture, targets.transfer), encode(wanted[rows, :, channels], targets.transfer), weight[rows])
        for picture, wanted, weight in zip(shown, targets.pictures, targets.weight, strict=True)
        if np.any(weight[rows])
    ]
    return float(np.mean(each)) if each else BEST_DB


def check_same_views(cube: Cube, targets: Targets) -> None:
    """Raise `InputError` unless the targets are as many and as large as the cube's own pictures."""
    given, made_for = (f"{len(rig)} of {'{} x {}'.format(*rig.picture_shape)}" for rig in (targets.rig, cube.rig))
    if given != made_for:
        raise InputError(
            f"pictures ({given} pixels) do not fit the cube, which was made for {made_for}: give those it was made from"
        )
