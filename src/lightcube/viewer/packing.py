"""A cube's extinction in few bits, for a page: what is lost is measured, not guessed."""

import gzip
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.forward.casting import cast
from lightcube.forward.turning import moment
from lightcube.optics.cube import Cube
from lightcube.optics.transfer import encode
from lightcube.viewer.smaller import shown_coarsely

#: Bits of a code: the first of these that keep the shadows within a level. Three of 10 are four bytes of a texture.
BITS = (10, 12, 16)
#: Absorbance across the whole cube, up to which steps are even; beyond, they grow with the extinction. A few voxels are
#: a thousand times as dark as most, so even steps are too coarse for those, and powers cost twice as much (measured).
_EVEN = 3.2
#: The longest side of a browser's 3-D textures, in voxels, and the longest text that it reads, in characters.
_TEXTURE, _TEXT = 2048, 500_000_000


@dataclass(frozen=True, eq=False)
class Packed:
    """What a page holds of a cube.

    Parameters
    ----------
    codes
        ``(channel, z, y, x)`` whole numbers of so many bits.
    bits
        10, 12 or 16.
    least, rates
        Of a code c, the extinction is ``least * (exp(rate * c) - 1)``, 1/mm, with a rate for each channel.
    cube
        The cube that these make.
    lost
        How far its shadows are from the given cube's, as `lost` tells.
    """

    codes: NDArray[np.uint16]
    bits: int
    least: float
    rates: tuple[float, ...]
    cube: Cube
    lost: tuple[float, float]

    def data(self) -> bytes:
        """The codes, gzipped: the upper 8 bits of all, then the lower ones, filling bytes, the first one lowest."""
        flat = self.codes.ravel()
        low = self.bits - 8
        places = np.arange(0, 8, low).astype(np.uint8)
        together = 8 // low
        rest = np.pad((flat & (2**low - 1)).astype(np.uint8), (0, -len(flat) % together)).reshape(-1, together)
        filled = np.bitwise_or.reduce(rest << places, axis=1)
        return gzip.compress((flat >> low).astype(np.uint8).tobytes() + filled.tobytes(), 6, mtime=0)


def pack(cube: Cube) -> Packed:
    """Round a cube's extinction to 10 bits, or where that moves a shadow by a level of 255 or more, to 12 or 16.

    Raises
    ------
    InputError
        Where the cube has other than 1 or 3 colours, or more voxels than a browser takes.
    """
    channels, *shape = cube.extinction.shape
    if channels not in (1, 3):
        raise InputError(f"a page shows cubes of 1 or 3 colours, and this one has {channels}: play it instead")
    if max(shape) > _TEXTURE or math.prod(shape) * channels * BITS[-1] / 6 > _TEXT:
        raise InputError(
            f"a cube of {' x '.join(str(count) for count in shape[::-1])} voxels is too large for a browser's 3-D "
            "textures: leave out --full"
        )
    for bits in BITS:
        packed = _rounded(cube, bits)
        if packed.lost[0] < 1:
            break
    return packed


def _rounded(cube: Cube, bits: int) -> Packed:
    levels = 2**bits - 1
    least = _EVEN / max(cube.grid.size_mm)
    codes = np.zeros(cube.extinction.shape, np.uint16)
    extinction = np.zeros(cube.extinction.shape, np.float32)
    rates = tuple(math.log1p(float(given.max()) / least) / levels for given in cube.extinction)
    for channel, (given, rate) in enumerate(zip(cube.extinction, rates, strict=True)):
        if rate > 0:
            codes[channel] = np.rint(np.log1p(given / np.float32(least)) / np.float32(rate))
            extinction[channel] = (least * np.expm1(rate * np.arange(levels + 1))).astype(np.float32)[codes[channel]]
    rounded = replace(cube, extinction=extinction, amounts=None, dyes=None)
    return Packed(codes, bits, least, rates, rounded, lost(cube, rounded))


def lost(cube: Cube, kept: Cube) -> tuple[float, float]:
    """How far the shadows of what is kept of a cube are from its own, in levels of 255: the largest and the mean.

    The mean is the root of that of the squares. Both are of display values no brighter than white, at all stops and
    halfway between neighbouring ones, by thin beams, which differ more than their means do; where a `smaller` one is
    kept, of whole pixels at the stops.
    """
    if kept.grid.shape == cube.grid.shape:
        stops = np.unique(cube.angles_deg)
        angles_deg = np.sort(np.concatenate([stops, stops + np.diff(stops, append=stops[0] + 360) / 2]))
        pairs = zip(_shadows(cube, angles_deg), _shadows(kept, angles_deg), strict=True)
    else:
        shown = cast(kept)
        pairs = zip(shown_coarsely(cube, kept), shown, strict=True)
    worst, squares, count = 0.0, 0.0, 0
    for pair in pairs:
        right, found = (255 * encode(np.minimum(each, np.float32(1)), cube.transfer) for each in pair)
        off = np.abs(right - found)
        worst = max(worst, float(off.max()))
        squares, count = squares + float(np.sum(off.astype(np.float64) ** 2)), count + off.size
    return worst, math.sqrt(squares / count)


def _shadows(cube: Cube, angles_deg: NDArray[np.float64]) -> Iterator[NDArray[np.float32]]:
    return cast(cube, *moment(cube, angles_deg), light="thin")
