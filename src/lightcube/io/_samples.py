"""Samples that are no display levels yet (few bits, inks, Lab, colours multiplied by opacity) as levels."""

from typing import cast

import numpy as np
from numpy.typing import NDArray

from lightcube.optics.transfer import to_uint16

#: ``(row, column, ...)`` in uint8 or uint16.
Samples = NDArray[np.uint8] | NDArray[np.uint16]

#: XYZ of white under D50, which profiles and Lab are relative to.
_WHITE = np.array([0.9642, 1.0, 0.8249])
#: XYZ under D50 to linear sRGB: the inverse of the colourants that profiles of sRGB have.
LIGHT_OF_XYZ = np.linalg.inv(
    [[0.43607, 0.38515, 0.14307], [0.22249, 0.71687, 0.06061], [0.01392, 0.09708, 0.71410]],
)


def full_of(samples: Samples) -> int:
    """Return the largest level."""
    return int(np.iinfo(samples.dtype).max)


def spread(samples: Samples, bits: int) -> Samples:
    """Numbers of `bits` bits spread over all levels of their 8 or 16 bits."""
    full, most = full_of(samples), 2**bits - 1
    if full == most:
        return samples
    return ((samples.astype(np.uint32) * full + most // 2) // most).astype(samples.dtype)


def of_inks(inks: Samples) -> Samples:
    """Cyan, magenta, yellow and black as RGB, without a profile: each ink takes its share of the light."""
    full = full_of(inks)
    light = full - inks.astype(np.uint32)
    return cast("Samples", ((light[..., :3] * light[..., 3:] + full // 2) // full).astype(inks.dtype))


def of_lab(samples: Samples) -> NDArray[np.uint16]:
    """CIE L*a*b* as TIFF has it (L from 0 to 100 over all levels, a and b signed) as RGB of 16 bits."""
    if samples.dtype == np.uint8:
        steps, most = samples.astype(np.uint8).view(np.int8).astype(np.float64), 255
    else:
        steps, most = samples.astype(np.uint16).view(np.int16) / 256.0, 65535
    y = (samples[..., 0] * (100 / most) + 16) / 116
    roots = np.stack([y + steps[..., 1] / 500, y, y - steps[..., 2] / 200], axis=-1)
    xyz = _WHITE * np.where(roots > 6 / 29, roots**3, 3 * (6 / 29) ** 2 * (roots - 4 / 29))
    return to_uint16(np.clip(xyz @ LIGHT_OF_XYZ.T, 0, 1))


def with_opacity(colours: Samples, opacity: Samples, *, multiplied: bool) -> Samples:
    """Join colours and opacity ``(row, column, 1)``; where it is `multiplied` into the colours it is divided out."""
    if multiplied or colours.dtype != opacity.dtype:
        colours, opacity = _deep(colours), _deep(opacity)
    if multiplied:
        wide = opacity.astype(np.uint32)
        divided = (colours * np.uint32(65535) + wide // 2) // np.maximum(wide, 1)
        colours = np.minimum(divided, 65535).astype(np.uint16)
    return np.concatenate([colours, opacity], axis=2)


def _deep(levels: Samples) -> NDArray[np.uint16]:
    """Levels of 8 or 16 bits in 16."""
    return levels.astype(np.uint16) * 257 if levels.dtype == np.uint8 else levels.astype(np.uint16, copy=False)
