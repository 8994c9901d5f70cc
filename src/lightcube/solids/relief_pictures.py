"""What a relief's shadows are to be: square grey pictures between black and white, of any pictures."""

from __future__ import annotations

import warnings

import numpy as np

from lightcube.errors import InputError
from lightcube.optics.arrays import Images, Reals, locked
from lightcube.optics.transfer import decode, encode
from lightcube.pictures.fitting import cropped
from lightcube.pictures.pictures import Pictures
from lightcube.solids.relief import MOST, ReliefRecipe, darkest, display
from lightcube.wording import counted

#: Of linear light, sRGB primaries: how light colours are.
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
#: What becomes black and white, in per cent of the pixels, and the least difference in display values between the two.
_ENDS, _EVEN = (1, 99), 0.02


class DarkPictures(UserWarning):
    """A black that is asked for is darker than a relief can show."""


class CroppedPictures(UserWarning):
    """Pictures that are no squares were cropped to squares."""


def wanted_of(pictures: Pictures, recipe: ReliefRecipe, side: int, *, colour: bool) -> tuple[Reals, tuple[str, ...]]:
    """Linear light ``(picture, row, column)`` of `side` pixels that is wanted, from black to 1, and its names.

    Display values of each picture are stretched so that a hundredth of the pixels is black and a hundredth white, the
    three colours of one picture together. Pictures are cropped to squares around their focus.

    Warns
    -----
    CroppedPictures
        Where a picture is no square.
    DarkPictures
        Where the recipe's black is darker than its relief can show.

    Raises
    ------
    InputError
        Where there are too many pictures or none, one is all of one tone, or holds NaN.
    """
    _check_count(pictures, colour=colour)
    for name, image in zip(pictures.names, pictures.images, strict=True):
        if not np.all(np.isfinite(image)):
            raise InputError(f"picture {name} holds NaN or infinite values: give finite ones")
    _tell_of_crops(pictures)
    _tell_of_black(recipe)
    shown = [_planes(image, side, pictures, colour=colour) for image in pictures.images]
    stretched = [_stretched(planes, name) for planes, name in zip(shown, pictures.names, strict=True)]
    black = recipe.black_level
    light = decode(black + (1 - black) * np.concatenate(stretched))
    names = [f"{pictures.names[0]} {each}" for each in ("red", "green", "blue")] if colour else pictures.names
    return locked(np.asarray(light, np.float64)), tuple(names)


def _check_count(pictures: Pictures, *, colour: bool) -> None:
    count = len(pictures)
    if colour and count != 1:
        raise InputError(f"three coloured lamps show one colour picture, not {count}: give one, or show them in grey")
    if not 1 <= count <= MOST:
        raise InputError(f"a relief shows 1 to {MOST} pictures, not {count}: give fewer" if count else "give a picture")


def _tell_of_crops(pictures: Pictures) -> None:
    """Say which pictures are no squares."""
    oblong = [
        (name, image) for name, image in zip(pictures.names, pictures.images, strict=True) if not _is_square(image)
    ]
    if oblong:
        name, image = oblong[0]
        others = f" and {counted(len(oblong) - 1, 'other picture')}" if len(oblong) > 1 else ""
        rows, columns = image.shape[:2]
        warnings.warn(
            f"{name} ({columns} x {rows}){others} cropped to {min(rows, columns)} x {min(rows, columns)}: "
            "a relief is a square",
            CroppedPictures,
            stacklevel=5,
        )


def _is_square(image: Images) -> bool:
    return image.shape[0] == image.shape[1]


def _tell_of_black(recipe: ReliefRecipe) -> None:
    """Say where black is beyond the law of the floor."""
    least = display(darkest(recipe.relief_px / max(recipe.slopes)))
    if recipe.method == "global" and recipe.black_level < least:
        warnings.warn(
            f"black {recipe.black_level:g} is darker than a relief of {recipe.relief_px:g} columns can show: what "
            f"throws a shadow is lit, so black is {least:.2f} at best",
            DarkPictures,
            stacklevel=5,
        )


def _planes(image: Images, side: int, pictures: Pictures, *, colour: bool) -> Reals:
    """Display values ``(plane, row, column)``: one grey, or three colours."""
    light = cropped(image, (side, side), pictures.focus).astype(np.float64)
    planes = np.moveaxis(light, 2, 0) if colour else (light @ _LUMINANCE)[None]
    return np.asarray(encode(np.clip(planes, 0, 1)))


def _stretched(planes: Reals, name: str) -> Reals:
    """Display values from 0 to 1."""
    low, high = np.percentile(planes, _ENDS)
    if high - low < _EVEN:
        low, high = planes.min(), planes.max()  # a line or two on an even ground
    if high - low < _EVEN:
        tone = "black" if high < _EVEN else "white" if low > 1 - _EVEN else "of one tone"
        raise InputError(f"picture {name} is all {tone}: there is nothing that shadows could show, leave it out")
    return np.clip((planes - low) / (high - low), 0, 1)
