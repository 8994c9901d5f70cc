"""A printed wedge before a lamp, photographed: what its inks let through, from wherever one stands."""

import math

import numpy as np
from skimage.transform import ProjectiveTransform, warp

from lightcube.calibration.wedge import MARKS_MM, PAGE_MM, PATCH_MM, WINDOWS_MM, Patch, Wedge, page
from lightcube.optics.arrays import Images, Reals
from lightcube.optics.dyes import Dyes, monotone

#: Dots of the print, a mm.
DOTS = 6
TURNED = {"upright": 8.0, "turned": 97.0, "upside down": 185.0}


def printed(dyes: Dyes, patch: Patch) -> Reals:
    """What a patch lets through: each ink a screen of its own, by Murray and Davies, after its dot gain."""
    covered = [
        part if curve is None else float(np.interp(part, *monotone(curve)))
        for part, curve in zip(patch.coverages, dyes.gain, strict=True)
    ]
    return np.asarray(np.prod(1 - np.array(covered)[:, None] * (1 - np.exp(-dyes.extinction)), axis=0))


def film(wedge: Wedge, dyes: Dyes, *, windows: bool = True) -> Images:
    """Light behind the film, ``(row, column, 3)``, of 1 behind nothing."""
    ground = np.asarray(page(wedge, round(DOTS * 25.4)), np.float32) / 255
    bare = np.exp(-dyes.base).astype(np.float32)
    light = np.where(ground.min(axis=2, keepdims=True) < 0.5, 0.03, 1) * bare  # marks, and what is written
    half = PATCH_MM / 2

    def square(middle_mm: tuple[float, float]) -> tuple[slice, slice]:
        x, y = middle_mm
        return tuple(slice(round((along - half) * DOTS), round((along + half) * DOTS)) for along in (y, x))  # type: ignore[return-value]

    for patch in wedge.patches:
        light[square(patch.middle_mm)] = bare * printed(dyes, patch)
    for x, y in WINDOWS_MM if windows else ():
        light[square((x, y))] = 1
    return light.astype(np.float32)


def photograph(
    film: Images,
    turned_deg: float = 8.0,
    *,
    mirrored: bool = False,
    noise: float = 0.01,
    uneven: float = 0.3,
    exposure: float = 0.7,
    side: int = 1500,
) -> Images:
    """A photograph of a film before an uneven lamp in a dark room, from aslant, with noise."""
    tall, wide = (length * DOTS for length in PAGE_MM[::-1])
    corners = np.array([(0, 0), (wide, 0), (wide, tall), (0, tall)], float)
    angle = math.radians(turned_deg)
    way = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    seen = (corners - (wide / 2, tall / 2)) * ((-1, 1) if mirrored else (1, 1)) / tall * 0.9 @ way
    seen = seen / (1 + 0.12 * seen[:, :1] + 0.08 * seen[:, 1:]) * side + side / 2
    place = ProjectiveTransform.from_estimate(seen, corners)
    shown = warp(film, place, output_shape=(side, side), order=1, cval=0.002)
    y, x = np.mgrid[0:side, 0:side] / side - 0.5
    lamp = exposure * (1 - uneven * ((x - 0.1) ** 2 + (y + 0.15) ** 2) * 2 - 0.1 * uneven * x)
    random = np.random.default_rng(0)
    light = shown * lamp[..., None] * np.array([1, 0.9, 0.8]) + noise * random.standard_normal((side, side, 1))
    return np.clip(light, 0, 1).astype(np.float32)


__all__ = ["MARKS_MM", "TURNED", "film", "photograph", "printed"]
