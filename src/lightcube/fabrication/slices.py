"""Droplets as PNG slices, of which a PolyJet printer's voxel print is made, and the volume that such slices hold.

A slice is as seen from above: columns go along x, rows against y, and slices go up. RGBA, since indexed pictures are
refused by the printer's program; each material is one colour.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from lightcube.errors import InputError
from lightcube.fabrication.blocks import Blocks
from lightcube.fabrication.droplets import Droplets, Labels
from lightcube.io._bounds import memory
from lightcube.optics.arrays import Reals, Volume, locked
from lightcube.optics.grid import Grid
from lightcube.wording import counted

#: What is needed of memory for each voxel that slices are read into, bytes, until it is scored the other way round too.
_PER_VOXEL = 48
#: The colour of the clear material in slices.
CLEAR = (224, 240, 255)


def most_voxels() -> int:
    """Voxels that slices are read into, at most, so that all that is done with them takes half of the memory."""
    return memory() // 2 // _PER_VOXEL


def name_of(prefix: str, number: int) -> str:
    """What a slice's file is called."""
    return f"{prefix}_{number:04d}.png"


def write_slices(
    folder: Path,
    droplets: Droplets,
    palette: NDArray[np.uint8],
    look: Look,
    advance: Callable[[int, int], None],
) -> NDArray[np.int64]:
    """Write all slices of a block into a new folder; returns how many droplets there are of each material.

    Parameters
    ----------
    palette
        ``(material, 4)``: the colour of the clear material, and those of the dyes.
    """
    folder.mkdir()
    slices, found = droplets.shape[0], np.zeros(len(palette), np.int64)
    for number in range(slices):
        labels = droplets.layer(number)
        found += np.bincount(labels.ravel(), minlength=len(palette))
        encoded = io.BytesIO()  # not into the file: Pillow takes no notice of a disk that is full
        pixels = palette[look.turned(labels)]
        Image.fromarray(pixels).save(encoded, "PNG", dpi=look.dpi, compress_level=4)
        if not np.array_equal(np.asarray(Image.open(encoded)), pixels):
            raise InputError(f"slice {number} does not come back as it was written: install another version of Pillow")
        (folder / name_of(look.prefix, look.place(number, slices))).write_bytes(encoded.getbuffer())
        advance(number + 1, slices)
    return found


@dataclass(frozen=True)
class Look:
    """How slices are written.

    Parameters
    ----------
    prefix
        What their names begin with.
    dpi
        Droplets an inch along x and y.
    flips
        Axes along which all is written the other way round.
    """

    prefix: str
    dpi: tuple[int, int]
    flips: str = ""

    def turned(self, labels: Labels) -> Labels:
        """A slice ``(y, x)`` as a picture, or such a picture as a slice: rows against y, flips on top of that."""
        rows = slice(None) if "y" in self.flips else slice(None, None, -1)
        return labels[rows, slice(None, None, -1 if "x" in self.flips else 1)]

    def place(self, number: int, slices: int) -> int:
        """The number in the file's name of a slice, counted from below."""
        return slices - 1 - number if "z" in self.flips else number


@dataclass(frozen=True, eq=False)
class Held:
    """What slices hold.

    Parameters
    ----------
    folder
        Where they lie.
    shape
        Droplets along z, y and x.
    sides_mm
        Of a droplet along x, y and z.
    palette
        ``(material, 4)`` colours.
    extinction
        ``(material, channel)``, 1/mm.
    look
        How they were written.
    """

    folder: Path
    shape: tuple[int, int, int]
    sides_mm: tuple[float, float, float]
    palette: NDArray[np.uint8]
    extinction: Reals
    look: Look

    def volume(self, *, forced: bool = False) -> tuple[Volume, Grid]:
        """The extinction that the slices hold, droplet by droplet, or where there are too many, block by block.

        Parameters
        ----------
        forced
            Take the nearest colour of the palette where a slice has others, and slices that are missing for clear.
        """
        blocks = Blocks.of(self.shape, self.sides_mm, most_voxels())
        (below, _), *around = blocks.padding(self.shape)
        volume = np.empty((self.extinction.shape[1], *blocks.counts), np.float32)
        for layer in range(blocks.counts[0]):
            numbers = range(layer * blocks.each[0] - below, (layer + 1) * blocks.each[0] - below)
            labels = np.stack([self._labels(number, forced=forced) for number in numbers])
            volume[:, layer] = blocks.seen(self.extinction.T[:, np.pad(labels, [(0, 0), *around])])
        return locked(volume), blocks.grid

    def _labels(self, number: int, *, forced: bool) -> Labels:
        """The materials of a slice, counted from below, ``(y, x)``: all clear below and above."""
        if not 0 <= number < self.shape[0]:
            return np.zeros(self.shape[1:], np.uint8)
        file = self.folder / name_of(self.look.prefix, self.look.place(number, self.shape[0]))
        if forced and not file.exists():
            return np.zeros(self.shape[1:], np.uint8)
        pixels = _pixels(file)
        if pixels.shape[:2] != self.shape[1:]:
            raise InputError(
                f"{file} is {pixels.shape[1]} x {pixels.shape[0]} pixels, not {self.shape[2]} x {self.shape[1]}: it "
                "was resized or is of another print, export the slices again"
            )
        return self.look.turned(_materials(file, pixels, self.palette, forced=forced))


def _pixels(file: Path) -> NDArray[np.uint8]:
    """``(row, column, 4)`` of a picture."""
    try:
        with Image.open(file) as image:
            return np.asarray(image.convert("RGBA"))
    except FileNotFoundError as error:
        raise InputError(f"{file} is missing: export the slices again, or --force takes it for clear") from error
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise InputError(f"{file} is no picture, or is damaged: export the slices again") from error


def _materials(file: Path, pixels: NDArray[np.uint8], palette: NDArray[np.uint8], *, forced: bool) -> Labels:
    """The number of the material that each pixel's colour stands for."""
    codes, known = (np.ascontiguousarray(each).view("<u4")[..., 0] for each in (pixels, palette))
    found, which = np.unique(codes, return_inverse=True)
    order = np.argsort(known)
    at = np.searchsorted(known[order], found).clip(max=len(known) - 1)
    strange = known[order][at] != found
    if np.any(strange) and not forced:
        count = int(np.count_nonzero(strange[which]))
        raise InputError(
            f"{file} has {counted(count, 'pixel')} of colours that are no material's: it was edited, or went through "
            "JPEG; export the slices again, or --force takes the nearest"
        )
    colours = found.view(np.uint8).reshape(-1, 1, 4).astype(np.int64)
    nearest = np.argmin(np.sum((colours - palette) ** 2, axis=2), axis=1)
    return np.where(strange, nearest, order[at]).astype(np.uint8)[which.reshape(codes.shape)]


def palette_of(labels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The colours of materials in slices, ``(material, 4)``, clear first; none is another's.

    Parameters
    ----------
    labels
        ``(dye, 3)``: what dyes are known by.
    """
    colours = [CLEAR, *map(tuple, labels.tolist())]
    if len(set(colours)) < len(colours):
        twice = next(colour for colour in colours if colours.count(colour) > 1)
        raise InputError(
            f"two materials have the same label {list(twice)}, and {list(CLEAR)} is the clear one's: give each its own"
        )
    return np.array([(*colour, 255) for colour in colours], np.uint8)
