"""Pixels and lamps' discs divided as plainly as can be: into squares and seeds, each with each."""

import numpy as np

from lightcube.optics.light import seeds
from lightcube.optics.rig import Rig


def divided(rig: Rig, *, lamp: int = 1, pixel: int = 1) -> Rig:
    """Every view at so many points of its lamp's disc, and so many along each side of a pixel."""
    fine = (np.arange(pixel) + 0.5) / pixel - 0.5
    square = np.stack([each.ravel() for each in np.meshgrid(fine, fine)], axis=1)
    disc = seeds(lamp)
    points = np.hstack([np.repeat(square, lamp, axis=0), np.tile(disc, (len(square), 1))])
    bare = np.hstack([square, np.zeros_like(square)])
    return rig.split([points if disc_deg else bare for disc_deg in rig.sums.disc_deg])
