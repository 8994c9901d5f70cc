"""A cube of a few voxels, drawn so that each is seen, beside the pictures that it casts."""

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from lightcube.optics.transfer import to_uint8

#: Sides in pixels: of a voxel, of a picture's pixel, of what stands between things; and of letters.
_VOXEL, _PIXEL, _GAP, _LETTERS = 64, 34, 28, 20
#: How far voxels stand apart, in their sides.
_APART = 1.35
#: Pictures in a line.
_IN_A_LINE = 4
_PAPER, _INK, _EDGE = (250, 250, 248), (40, 40, 40), (190, 190, 186)
#: Where x, y and z lead on paper, in sides of a voxel, seen from above: y goes away from the eye.
_WAYS = np.array([(math.cos(math.pi / 6), -0.5), (-math.cos(math.pi / 6), -0.5), (0.0, -1.0)]) * (1, 1)
#: Faces that are seen, as corners (x, y, z) of a voxel, and how light they are.
_FACES = (
    (((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)), 0.92),
    (((0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)), 0.80),
    (((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)), 1.0),
)


def small_cube(
    transparency: NDArray[np.floating], pictures: NDArray[np.floating], angles_deg: Iterable[float]
) -> NDArray[np.uint8]:
    """Draw voxels and pictures; ``(row, column, 3)`` levels.

    Parameters
    ----------
    transparency
        Of voxels, ``(channel, z, y, x)``, linear light.
    pictures
        ``(view, row, column, channel)`` in linear light.
    angles_deg
        Of the pictures.
    """
    block, middle = _block_size(transparency.shape[1:])
    rows, columns = pictures.shape[1] * _PIXEL, pictures.shape[2] * _PIXEL
    lines = -(-len(pictures) // _IN_A_LINE)
    high = max(block[1], lines * (rows + _GAP + _LETTERS)) + 2 * _GAP + 2 * _LETTERS
    wide = block[0] + _IN_A_LINE * (columns + _GAP) + 3 * _GAP
    sheet = Image.new("RGB", (wide, high), _PAPER)
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(_LETTERS - 3)
    _, nz, ny, nx = transparency.shape
    draw.text((_GAP, _GAP), f"{nx} x {ny} x {nz} voxels", _INK, font)
    _voxels(draw, transparency, (_GAP + middle, high - _GAP - (high - 2 * _GAP - 2 * _LETTERS - block[1]) // 2))
    left, top = block[0] + 3 * _GAP, (high - lines * (rows + _GAP + _LETTERS) + _GAP) // 2
    for number, (picture, angle_deg) in enumerate(zip(pictures, angles_deg, strict=True)):
        line, place = divmod(number, _IN_A_LINE)
        at = left + place * (columns + _GAP), top + line * (rows + _GAP + _LETTERS)
        draw.text(at, f"turned by {angle_deg:g}°", _INK, font)
        tile = Image.fromarray(to_uint8(picture)).resize((columns, rows), Image.Resampling.NEAREST)
        below = at[1] + _LETTERS + 4
        draw.rectangle((at[0] - 1, below - 1, at[0] + columns, below + rows), outline=_EDGE)
        sheet.paste(tile, (at[0], below))
    return np.asarray(sheet)


def _block_size(shape: tuple[int, ...]) -> tuple[tuple[int, int], int]:
    """Width and height of all voxels on paper, and where their nearest corner is from the left, pixels."""
    nz, ny, nx = ((count - 1) * _APART + 1 for count in shape)
    (right, down), (left, _), (_, up) = _WAYS * _VOXEL
    return (math.ceil(nx * right - ny * left), math.ceil(-(nx + ny) * down - nz * up)), math.ceil(-ny * left)


def _voxels(draw: ImageDraw.ImageDraw, transparency: NDArray[np.floating], nearest: tuple[int, int]) -> None:
    """Draw voxels, those that are further away first, their nearest lower corner at a place."""
    colours = np.moveaxis(transparency, 0, -1)
    order = sorted(np.ndindex(*transparency.shape[1:]), key=lambda each: (-each[1] - each[2], each[0]))
    for z, y, x in order:
        for corners, light in _FACES:
            places = (np.array([(x, y, z)]) * _APART + np.array(corners)) @ _WAYS * _VOXEL + nearest
            colour = tuple(int(level) for level in to_uint8((colours[z, y, x] * light)[None, None])[0, 0])
            draw.polygon([(float(across), float(down)) for across, down in places], colour, _INK)
