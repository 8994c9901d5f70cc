"""The law of light: how much of a lamp's light reaches a pixel, and how strong a shadow is there."""

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.grid import PARALLEL
from lightcube.optics.rig import Rig

Reals = NDArray[np.float64]


def falling_light(rig: Rig) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Light g and strength of the shadow a of every pixel, ``(view, row, column)``, without the lamps' shares.

    With u the unit direction of the beam through the pixel at q, n the screen's normal and l the place of a point lamp:
    ``g = (full_at / |q - l|)^2 |u.n|``, each factor only where it is asked for, and
    ``a = exp(-max(0, u.q - reach) / falloff)``, a factor for the lamp and one for the screen. ``u.q`` is how far
    the light travels from where it is nearest to the cube's centre to the screen.
    """
    views, fading = rig.views, rig.fading
    rows, columns = views.picture_shape
    across = np.arange(columns) - (columns - 1) / 2
    along = np.arange(rows) - (rows - 1) / 2
    light = np.ones((len(views), rows, columns), np.float32)
    shadow = np.ones_like(light)
    for v in range(len(views)):
        asked = fading.cosine[v], np.isfinite(fading.full_at_mm[v]), np.isfinite(fading.reach_mm[v])
        if not np.any(np.hstack(asked)):
            continue
        pixels = (
            views.origins_mm[v]
            + along[:, None, None] * views.row_steps_mm[v]
            + across[None, :, None] * views.column_steps_mm[v]
        )
        ways = pixels - views.lamps[v, :3] if views.lamps[v, 3] else np.broadcast_to(views.lamps[v, :3], pixels.shape)
        lengths = np.maximum(np.linalg.norm(ways, axis=-1), PARALLEL)  # a lamp may stand on a pixel
        units = ways / lengths[..., None]
        if asked[0]:
            normal = np.cross(views.column_steps_mm[v], views.row_steps_mm[v])
            light[v] *= np.abs(units @ normal) / np.linalg.norm(normal)
        if asked[1] and views.lamps[v, 3]:
            light[v] *= (fading.full_at_mm[v] / lengths) ** 2
        travelled = np.sum(units * pixels, axis=-1)
        for reach, falloff in zip(fading.reach_mm[v], fading.falloff_mm[v], strict=True):
            shadow[v] *= fade(travelled, reach, falloff)
    return light, shadow


def fade(distance: Reals, reach: float, falloff: float) -> Reals:
    """Strength of a shadow so far behind the cube: 1 up to `reach`, then ``exp(-(distance - reach) / falloff)``."""
    beyond = np.maximum(distance - reach, 0)
    if falloff == 0:
        return np.where(beyond > 0, 0.0, 1.0)
    return np.asarray(np.exp(-beyond / falloff))
