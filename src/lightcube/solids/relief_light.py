"""What a relief shows, seen from above, under a lamp anywhere."""

from __future__ import annotations

import math

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Images, Reals
from lightcube.optics.checks import checked
from lightcube.optics.light import JUDGE, JUDGE_STEP
from lightcube.optics.views import check_angles
from lightcube.solids.relief import Relief

#: Steps of a point on its way to the lamp, about a nanosecond each.
_WORK = 12


@checked
def relief_shadow(relief: Relief, azimuth_deg: float, elevation_deg: float | None = None) -> Reals:
    """Linear light ``(row, column)`` of a relief's pixels, each the mean over its area, seen from above.

    Tops of columns under no shadow are 1 under any lamp: a camera or an eye takes the lightest as white. Shadows get
    what the recipe's `bounce` throws into them.

    Parameters
    ----------
    azimuth_deg
        Where the lamp stands, degrees from the right of the plate, against the clock from above.
    elevation_deg
        How high it stands; None: as high as the relief is made for.

    Raises
    ------
    InputError
        Where the lamp does not stand above the plate.
    """
    from lightcube.kernels import relief_light as kernel
    from lightcube.kernels.tasks import run

    high_deg = relief.recipe.elevation_deg if elevation_deg is None else elevation_deg
    if not 0 < high_deg < 90:
        raise InputError(
            f"a lamp {high_deg:g} degrees high throws no shadows on a plate: it stands 0 to 90 degrees high"
        )
    azimuth = math.radians(float(check_angles(azimuth_deg)[0]))
    to_lamp = np.array([-_exact(math.sin(azimuth)), _exact(math.cos(azimuth)), 0.0])
    to_lamp[2] = math.tan(math.radians(high_deg)) / math.tan(math.radians(relief.recipe.elevation_deg))
    light = np.empty(relief.heights_px.shape)
    work = light.size * JUDGE * _WORK
    run(kernel.cast, len(light), work, relief.heights_px, to_lamp, _points(), light)
    rows, columns = (relief.cell * side for side in relief.wanted.shape[1:])
    light = bounced(light, relief.recipe.bounce)
    return in_cells(light[:rows, :columns], relief.cell)


def bounced(light: Reals, bounce: float) -> Reals:
    """What lit columns ``(..., row, column)`` show of a plate that throws a part of its mean light into its shadows."""
    return np.asarray(light + bounce * light.mean(axis=(-2, -1), keepdims=True) * (1 - light))


def unbounced(shown: Reals, bounce: float) -> Reals:
    """How columns ``(..., row, column)`` must be lit so that `bounced` makes them `shown`, as far as they can be."""
    if not bounce:
        return shown
    mean = shown.mean(axis=(-2, -1), keepdims=True)
    whole = 1 + bounce  # with the mean m of what is lit, that of what is shown is m + bounce m (1 - m)
    thrown = (whole - np.sqrt(whole**2 - 4 * bounce * mean)) / 2
    return np.asarray(np.clip((shown - thrown) / (1 - thrown), 0, 1))


def in_cells(light: Reals, cell: int) -> Reals:
    """Means over squares of `cell` columns a side."""
    rows, columns = (side // cell for side in light.shape)
    return np.asarray(light.reshape(rows, cell, columns, cell).mean(axis=(1, 3)))


def shown(relief: Relief, off_deg: tuple[float, float] = (0.0, 0.0)) -> Reals:
    """What each lamp shows, ``(picture, row, column)`` linear light; all stand `off_deg` wrong, round and up."""
    high_deg = relief.recipe.elevation_deg + off_deg[1]
    return np.stack([relief_shadow(relief, azimuth_deg + off_deg[0], high_deg) for azimuth_deg in relief.azimuths_deg])


def coloured(relief: Relief, pictures: Reals) -> Images:
    """Pictures ``(picture, row, column)`` as ``(picture, row, column, 3)``; of a colour relief they make one."""
    planes = np.moveaxis(pictures, 0, -1)[None] if relief.is_colour else np.repeat(pictures[..., None], 3, axis=-1)
    return planes.astype(np.float32)


def _exact(value: float) -> float:
    """A sine or cosine that is 0 where it is meant to be."""
    return 0.0 if abs(value) < 1e-12 else value


def _points() -> Reals:
    """Places on a column's top, in its sides: those that all light on areas is judged at."""
    number = np.arange(JUDGE)
    return np.asarray(np.stack([(number + 0.5) / JUDGE, (JUDGE_STEP * number % JUDGE + 0.5) / JUDGE], axis=1))
