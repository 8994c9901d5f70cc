"""How near what is cast comes to what was wanted, always in display values and never clipped."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage import color
from skimage import metrics as similarities

from lightcube.errors import InputError
from lightcube.forward.casting import cast
from lightcube.optics.arrays import Images
from lightcube.optics.checks import checked
from lightcube.optics.cube import Cube
from lightcube.optics.transfer import encode
from lightcube.pictures.fitting import targets_of
from lightcube.pictures.targets import Targets

#: The best PSNR that is reported, dB.
BEST_DB = 100.0
#: Pictures of this PSNR, dB, are good: they are made small enough for it.
GOOD_DB = 40.0

Display = NDArray[np.floating[Any]]


def psnr(shown: Display, wanted: Display, weight: Display) -> float:
    """Peak signal-to-noise ratio in dB of display values ``(row, column, channel)``, at most 100.

    ``-10 log10(mean squared difference)``, pixels weighted by `weight` ``(row, column)``.
    """
    squares = np.mean((shown.astype(np.float64) - wanted) ** 2, axis=-1)
    error = float(np.sum(weight * squares) / np.sum(weight))
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
    """Compare what the cube really casts at its stops with what was wanted.

    Parameters
    ----------
    targets
        The wanted pictures, on the cube's rig; None = the 8-bit targets stored in the cube, which cap
        the PSNR at about 58.9 dB where the pictures were resampled.

    Returns
    -------
    ``psnr_mean, psnr_min, ssim_mean, delta_e_mean`` and ``pictures``, a list with ``name, angle_deg, psnr, ssim,
    delta_e`` of each.

    Raises
    ------
    InputError
        Where the cube has no targets and none are given, or they do not fit the cube's pictures.
    """
    wanted = targets_of(cube) if targets is None else targets
    check_same_views(cube, wanted)
    return score_pictures(cast(cube), wanted)


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
