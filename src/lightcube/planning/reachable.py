"""Which pixels are darker than a shadow that fades with distance can be, or brighter than the lamps."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.law import falling_light
from lightcube.pictures.targets import Targets

Plane = NDArray[np.floating[Any]]

#: Bright pixels of each picture that are looked at.
_BRIGHT = 32
#: A pixel is out of reach where it is wanted darker than this part of the least that it can be.
_SURE = 0.99
#: Smaller parts of a picture are not worth a sentence.
_WORTH_SAYING = 0.005


def least_light(targets: Targets) -> NDArray[np.float64]:
    """What each pixel shows at least if the picture's brightest ones are as bright as wanted, linear light.

    ``(picture, row, column, channel)``, 0 where shadows do not fade and no veil lies over them. A lamp that makes pixel
    j as bright as b shows on pixel i, behind a cube however dark, no less than ``b D_i / G_j``, with ``G = sum_v share
    g`` and ``D = sum_v share g (1 - a)`` over that lamp's views (`lightcube.optics.law`); several lamps show no less
    than the one with the least such quotient.
    """
    rig = targets.rig
    least = np.zeros(targets.pictures.shape)
    if np.all(np.isinf(rig.fading.reach_mm)) and not np.any(rig.fading.veil):
        return least
    light, shadow = falling_light(rig)
    share_of = rig.sums.of_colours(targets.pictures.shape[-1])
    for picture, wanted in enumerate(targets.pictures):
        heard = targets.weight[picture] > 0
        views = np.flatnonzero(rig.sums.picture == picture)
        groups = [views[rig.sums.lamp[views] == lamp] for lamp in np.unique(rig.sums.lamp[views])]
        for channel in range(wanted.shape[-1]):
            shares = [share_of[own, channel][:, None, None] for own in groups]
            full = [np.sum(share * light[own], axis=0) for share, own in zip(shares, groups, strict=True)]
            dark = [
                np.sum(share * light[own] * (1 - shadow[own]), axis=0)
                for share, own in zip(shares, groups, strict=True)
            ]
            least[picture, ..., channel] = _least(np.where(heard, wanted[..., channel], 0), full, dark)
    return least


def _least(bright: Plane, full: list[Plane], dark: list[Plane]) -> Plane:
    """Least light of each pixel of one colour, from the wanted light and each lamp's G and D."""
    brightest = np.argsort(bright / np.maximum(sum(full), 1e-30), axis=None)[-_BRIGHT:]
    least = np.zeros(bright.shape)
    for place in zip(*np.unravel_index(brightest, bright.shape), strict=True):
        quotients = [unfaded / each[place] for unfaded, each in zip(dark, full, strict=True) if each[place] > 0]
        if quotients:
            least = np.maximum(least, bright[place] * np.min(quotients, axis=0))
    return least


def out_of_reach(targets: Targets) -> NDArray[np.float64]:
    """``(pictures,)``: the part of each picture's colours that no cube and no lamp can make as dark as wanted."""
    certain = (targets.pictures < _SURE * least_light(targets)) & (targets.weight[..., None] > 0)
    return np.asarray(np.sum(certain, axis=(1, 2, 3)) / _counted(targets))


def too_bright(targets: Targets) -> NDArray[np.float64]:
    """``(pictures,)``: the part of each picture's colours that all its lamps at their largest power fall short of."""
    rig = targets.rig
    light, _ = falling_light(rig)
    most = np.zeros(targets.pictures.shape)
    for view, picture in enumerate(rig.sums.picture):
        most[picture] += rig.lamps.most[rig.sums.lamp[view]] * rig.sums.share[view] * light[view][..., None]
    certain = (targets.pictures > most / _SURE) & (targets.weight[..., None] > 0)
    return np.asarray(np.sum(certain, axis=(1, 2, 3)) / _counted(targets))


def _counted(targets: Targets) -> NDArray[np.float64]:
    return np.asarray(np.sum(targets.weight > 0, axis=(1, 2)) * float(targets.pictures.shape[-1]))


def sentences(targets: Targets) -> list[str]:
    """One sentence for each picture with colours out of reach."""
    dark, bright = out_of_reach(targets), too_bright(targets)
    named = list(zip(targets.names, dark, bright, strict=True))
    if np.all(np.isinf(targets.rig.fading.reach_mm)):
        why = "the veil over it allows: keep even light off the screen, or make the picture paler"
    else:
        why = "its shadow can be at this distance: bring the screen nearer, or give lamp or screen more reach_mm"
    return [
        f"{part:.0%} of picture {name!r} is brighter than its lamps can make it here: give them more power_max, or "
        "light of all colours"
        for name, _, part in named
        if part >= _WORTH_SAYING
    ] + [f"{part:.0%} of picture {name!r} is darker than {why}" for name, part, _ in named if part >= _WORTH_SAYING]
