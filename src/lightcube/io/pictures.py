"""Reading pictures: a folder of them, an animation, or a video."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.io._decode import Budget, Take, read_animation, read_single
from lightcube.io._files import suffix_entry, system_errors
from lightcube.io._frames import Levels
from lightcube.io._places import fetched, place
from lightcube.io._video import read_video
from lightcube.io.pictures_folder import (
    PICTURE_SUFFIXES,
    VIEWS_FILE,
    FolderViews,
    is_picture,
    left_out,
    may_be_radians,
    picture_files,
    read_views,
)
from lightcube.optics.arrays import locked
from lightcube.optics.checks import checked
from lightcube.optics.transfer import Transfer, check_transfer, decode
from lightcube.pictures.pictures import Pictures

#: By suffix; they return what had to be changed, as the rest of a sentence that begins with the file's name.
_READERS: dict[str, Callable[[Path, Budget, Take], Sequence[str] | None]] = {
    ".gif": read_animation,
    ".apng": read_animation,
    **dict.fromkeys(PICTURE_SUFFIXES, read_animation),
    **dict.fromkeys((".mp4", ".webm", ".mkv", ".mov", ".avi"), read_video),
}


class TransparentPictures(UserWarning):
    """Some pictures that were read are not opaque, and were put on white."""


class ChangedPictures(UserWarning):
    """Pictures that were read are not of the kind that a cube shows, and were changed."""


class DoubtfulFolder(UserWarning):
    """Not all of a folder was read, or its angles may not be degrees."""


@checked
def read_pictures(path: str | Path, *, transfer: Transfer = "srgb", least: int = 2) -> Pictures:
    """Read pictures in linear light.

    Parameters
    ----------
    path
        A folder of PNG, JPEG, WebP, TIFF, AVIF or HEIC files, taken in natural order (2 before 10), whose `views.toml`,
        if there is one, gives angles, elevation and names; or an animated GIF, WebP, APNG or AVIF, or a TIFF of several
        pages; or a video (MP4, WebM, MKV, MOV, AVI), of which every picture is taken. HEIC takes the extra `heif`. It
        may be a URL.
    transfer
        How display values become linear light.
    least
        How many pictures there must be: a cube on a turntable needs two.

    Returns
    -------
    Pictures in float32, 1 = white, upright as their EXIF orientation says, with all the bits that the file has
    (8 or 16). Colour profiles are not applied: numbers are taken as sRGB. Of a film they are what a player shows: by
    its own matrix and range, turned and mirrored, and with square pixels.

    Warns
    -----
    ChangedPictures
        Where a film is of high dynamic range (PQ, HLG) or wide colours, which are brought into sRGB with white at 203
        nits; and where it is interlaced, of which one field is kept.
    TransparentPictures
        Once, where pictures are not opaque: they are put on white, in linear light.
    DoubtfulFolder
        Where other files in a folder were left out, hidden ones and what systems leave not counted; and where all
        angles lie so near to each other that they may be radians.

    Raises
    ------
    InputError
        Where there is nothing to read, a file is damaged or of another kind, there are too few pictures, they
        would not fit into half of the machine's memory, or `views.toml` has a fault.

    Notes
    -----
    A file that is cut short is refused where it says itself how long it, or its last picture, should be. Damage inside
    a film is refused where its decoder sees it: most have no checksums, so changed bytes may pass as changed pictures.
    """
    transfer = check_transfer(transfer)
    with fetched(place(path), _is_wanted) as local:
        pictures, transparent, notes = _read(local, transfer, least)
        others = left_out(local)
    for note in notes:
        warnings.warn(f"{path} {note}", ChangedPictures, stacklevel=3)
    if others:
        warnings.warn(f"{path}: {others}", DoubtfulFolder, stacklevel=3)
    if may_be_radians(pictures.angles_deg):
        warnings.warn(
            f"{path}: all angles lie within a few degrees: if they are radians, multiply them by 57.2958",
            DoubtfulFolder,
            stacklevel=3,
        )
    if transparent:
        warnings.warn(
            f"{transparent} of {len(pictures)} pictures in {path} are partly transparent: they were put on white",
            TransparentPictures,
            stacklevel=3,
        )
    return pictures


def _is_wanted(name: str) -> bool:
    """Whether a file of a folder is read."""
    return name == VIEWS_FILE or is_picture(name)


def _read(path: Path, transfer: Transfer, least: int) -> tuple[Pictures, int, Sequence[str]]:
    """Pictures, how many of them are not opaque, and what was changed in them."""
    with system_errors(path, "reading"):
        there, is_folder = path.exists(), path.is_dir()
    if not there:
        raise InputError(f"there is no {path}: give a folder of pictures, an animation or a video")
    images: list[NDArray[np.float32]] = []
    transparent = 0
    notes: Sequence[str] = ()

    def take(levels: Levels) -> None:
        nonlocal transparent
        image, opaque = _linear_light(levels, transfer)
        images.append(locked(image))
        transparent += not opaque

    views = FolderViews()
    if is_folder:
        files = picture_files(path)
        views = read_views(path, len(files))
        budget = Budget()
        for file in files:
            read_single(file, budget, take)
        names = views.names or tuple(file.stem for file in files)
    else:
        notes = suffix_entry(path, _READERS, "pictures")(path, Budget(), take) or ()
        names = tuple(str(index + 1) for index in range(len(images))) if len(images) > 1 else (path.stem,)
    if len(images) < least:
        held = "one picture" if images else "no picture"
        needed = "a cube needs at least two: add more" if least > 1 else "one at least is needed: give another"
        raise InputError(f"{path} holds {held}, and {needed}")
    return Pictures(tuple(images), names, views.angles_deg, views.elevation_deg, transfer), transparent, notes


def _linear_light(levels: Levels, transfer: Transfer) -> tuple[NDArray[np.float32], bool]:
    """Levels ``(row, column, 3 or 4)`` as linear light on white, and whether they were opaque."""
    full = np.float32(np.iinfo(levels.dtype).max)
    light = decode(levels[..., :3].astype(np.float32) / full, transfer).astype(np.float32, copy=False)
    if levels.shape[2] == 3:
        return light, True
    opacity = levels[..., 3:].astype(np.float32) / full
    return opacity * light + (1 - opacity), bool(np.all(opacity == 1))
