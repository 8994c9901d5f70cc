"""A cube's extinction in few bits, for a page: what is lost is measured, not guessed."""

import gzip
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from lightcube.cube import Cube
from lightcube.errors import InputError
from lightcube.forward import cast, exposures_at, lamp_at, views_at
from lightcube.transfer import encode
from lightcube.viewer.smaller import shown_coarsely

#: The largest of the codes, which have 10 bits: a texture holds three of them in four bytes.
LEVELS = 1023
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
        ``(channel, z, y, x)`` whole numbers from 0 to 1023.
    least, rates
        Of a code c, the extinction is ``least * (exp(rate * c) - 1)``, 1/mm, with a rate for each channel.
    cube
        The cube that these make.
    """

    codes: NDArray[np.uint16]
    least: float
    rates: tuple[float, ...]
    cube: Cube

    def data(self) -> bytes:
        """The codes, gzipped: the upper 8 bits of all, then the lower 2, four to a byte, the first one lowest."""
        flat = self.codes.ravel()
        low = np.pad((flat & 3).astype(np.uint8), (0, -len(flat) % 4)).reshape(-1, 4)
        fours = np.bitwise_or.reduce(low << np.array([0, 2, 4, 6], np.uint8), axis=1)
        return gzip.compress((flat >> 2).astype(np.uint8).tobytes() + fours.tobytes(), 6, mtime=0)


def pack(cube: Cube) -> Packed:
    """Round a cube's extinction to 10 bits.

    Raises
    ------
    InputError
        Where the cube has other than 1 or 3 colours, or more voxels than a browser takes.
    """
    channels, *shape = cube.extinction.shape
    if channels not in (1, 3):
        raise InputError(f"a page shows cubes of 1 or 3 colours, and this one has {channels}: play it instead")
    if max(shape) > _TEXTURE or math.prod(shape) * channels * 5 / 3 > _TEXT:
        raise InputError(
            f"a cube of {' x '.join(str(count) for count in shape[::-1])} voxels is too large for a browser's 3-D "
            "textures: leave out --full"
        )
    least = _EVEN / max(cube.grid.size_mm)
    codes = np.zeros(cube.extinction.shape, np.uint16)
    extinction = np.zeros(cube.extinction.shape, np.float32)
    rates = tuple(math.log1p(float(given.max()) / least) / LEVELS for given in cube.extinction)
    for channel, (given, rate) in enumerate(zip(cube.extinction, rates, strict=True)):
        if rate > 0:
            codes[channel] = np.rint(np.log1p(given / np.float32(least)) / np.float32(rate))
            extinction[channel] = (least * np.expm1(rate * np.arange(LEVELS + 1))).astype(np.float32)[codes[channel]]
    return Packed(codes, least, rates, replace(cube, extinction=extinction))


def lost(cube: Cube, packed: Packed) -> tuple[float, float]:
    """How far the packed cube's shadows are from the full one's, in levels of 255: the largest and the mean difference.

    The mean is the root of that of the squares. Both are of display values no brighter than white, at all stops and
    halfway between neighbouring ones; where the packed cube is a smaller one, at the stops, on its pixels.
    """
    if packed.cube.grid.shape == cube.grid.shape:
        stops = np.unique(cube.angles)
        angles = np.sort(np.concatenate([stops, stops + np.diff(stops, append=stops[0] + 360) / 2]))
        pairs = zip(_shadows(cube, angles), _shadows(packed.cube, angles), strict=True)
    else:
        small = packed.cube
        shown = cast(small, small.views, small.powers, small.lighting)
        pairs = zip(shown_coarsely(cube, small), shown, strict=True)
    worst, squares, count = 0.0, 0.0, 0
    for pair in pairs:
        right, kept = (255 * encode(np.minimum(each, np.float32(1)), cube.transfer) for each in pair)
        off = np.abs(right - kept)
        worst = max(worst, float(off.max()))
        squares, count = squares + float(np.sum(off.astype(np.float64) ** 2)), count + off.size
    return worst, math.sqrt(squares / count)


def _shadows(cube: Cube, angles: NDArray[np.float64]) -> Iterator[NDArray[np.float32]]:
    if cube.lighting is None:
        return cast(cube, views_at(cube, angles), lamp_at(cube, angles))
    views, lighting, powers = exposures_at(cube, angles)
    return cast(cube, views, powers, lighting)
