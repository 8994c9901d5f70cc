"""Reading pictures: a folder of them, an animation, or a video."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path, PurePath

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError, encodable
from lightcube.io._bounds import Budget, check_file
from lightcube.io._decode import ROWS
from lightcube.io._excerpt import Excerpt, Read
from lightcube.io._files import suffix_entry, system_errors
from lightcube.io._frames import Levels
from lightcube.io._places import Place, fetched, name_of, names_in, place
from lightcube.io._spaces import Space
from lightcube.io._still import read_animation, read_single
from lightcube.io._video import read_video
from lightcube.io.pictures_folder import (
    PICTURE_SUFFIXES,
    VIEWS_FILE,
    FolderViews,
    is_picture,
    left_out,
    picture_files,
    read_views,
)
from lightcube.optics.arrays import locked
from lightcube.optics.checks import checked
from lightcube.optics.transfer import Transfer, check_transfer, decode
from lightcube.optics.views import doubt_angles
from lightcube.pictures.pictures import Pictures
from lightcube.wording import counted

#: Of films and of all other files with pictures, by suffix.
_FILMS = (".mp4", ".webm", ".mkv", ".mov", ".avi")
_MOVING = (".gif", ".apng")
_ANIMATIONS = (*_MOVING, *PICTURE_SUFFIXES)

#: Pixels of a picture as it is kept, at most: screens have some hundred rows, and linear light takes four times as much
#: memory as levels of 8 bits.
MOST_KEPT = 64_000_000


class TransparentPictures(UserWarning):
    """Some pictures that were read are not opaque, and were put on white."""


class ChangedPictures(UserWarning):
    """Pictures that were read are not of the kind that a cube shows, not sRGB for instance, and were changed."""


class ThinnedFilm(UserWarning):
    """Fewer pictures of a film were read than there are, as was asked for by their number."""


class DoubtfulFolder(UserWarning):
    """Not all of a folder was read."""


@checked
def read_pictures(
    path: str | Path,
    *,
    transfer: Transfer = "srgb",
    least: int = 2,
    every: int = 1,
    from_s: float | None = None,
    to_s: float | None = None,
    most: int | None = None,
) -> Pictures:
    """Read pictures in linear light.

    Parameters
    ----------
    path
        A folder of PNG, JPEG, WebP, TIFF, AVIF or HEIC files, taken in natural order (2 before 10), whose `views.toml`,
        if there is one, gives angles, elevation and names; or an animated GIF, WebP, APNG or AVIF, or a TIFF of several
        pages (thumbnails and masks are none); or a video (MP4, WebM, MKV, MOV, AVI), of which every picture is taken
        unless a part is asked for. HEIC takes the extra `heif`. It may be a URL.
    transfer
        How display values become linear light.
    least
        How many pictures there must be: a cube on a turntable needs two.
    every
        Of a video or an animation every so many pictures are taken.
    from_s, to_s
        Seconds at which the part of a video begins and ends that is read; None = with the video.
    most
        Of a video or an animation at most so many pictures are taken, evenly spread; None = all.

    Returns
    -------
    Pictures in float32, 1 = white, upright as their EXIF orientation says, with all the bits that the file has
    (at most 16). Colours that an ICC profile of curves and a matrix, a PNG's cICP chunk or a camera's EXIF names are
    turned into sRGB's; what sRGB has no colour for is clipped. Of a film they are what a player shows: by
    its own matrix and range, turned and mirrored, and with square pixels.

    Warns
    -----
    ChangedPictures
        Where a film is of high dynamic range (PQ, HLG) or wide colours, which are brought into sRGB with white at 203
        nits, or a picture has other colours than sRGB; and where a film is interlaced, of which one field is kept.
    ThinnedFilm
        Where `most` leaves pictures out.
    TransparentPictures
        Once, where pictures are not opaque: they are put on white, in linear light.
    DoubtfulFolder
        Where other files in a folder were left out, hidden ones and what systems leave not counted.
    DoubtfulAngles
        Where all angles lie so near to each other that they may be radians.

    Raises
    ------
    InputError
        Where there is nothing to read, a file is damaged or of another kind, there are too few pictures, they
        would not fit into half of the machine's memory, or `views.toml` has a fault; and where a part is asked for of
        what is no film, or there is none.

    Notes
    -----
    A file that is cut short is refused where it says itself how long it, or its last picture, should be. Damage inside
    a film is refused where its decoder sees it: most have no checksums, so changed bytes may pass as changed pictures.
    """
    transfer = check_transfer(transfer)
    with fetched(place(path), _is_wanted) as local:
        pictures, taken = _read(local, transfer, least, Excerpt(from_s, to_s, every, most))
        others = left_out(local)
    for note in taken.notes(path, len(pictures)):
        warnings.warn(note, stacklevel=3)
    if others:
        warnings.warn(f"{path}: {others}", DoubtfulFolder, stacklevel=3)
    doubt_angles(pictures.angles_deg, f"{path}", stacklevel=3)
    return pictures


def is_film(path: str | Path) -> bool:
    """Whether a place is named as films and animations are, of which a part can be read."""
    at = place(path)
    return PurePath(name_of(at)).suffix.lower() in _SUFFIXES and not (isinstance(at, Path) and at.is_dir())


def is_pictures(at: Place) -> bool:
    """Whether a place is named as pictures are, or is a folder on this disk with some in it."""
    folder = isinstance(at, Path) and at.is_dir()
    return any(map(is_picture, names_in(at))) if folder else PurePath(name_of(at)).suffix.lower() in _SUFFIXES


def is_several(at: Place) -> bool:
    """Whether a place is named as films and animations are, or is a folder on this disk with two pictures at least."""
    if isinstance(at, Path) and at.is_dir():
        return sum(map(is_picture, names_in(at))) > 1
    return PurePath(name_of(at)).suffix.lower() in (*_FILMS, *_MOVING)


def _is_wanted(name: str) -> bool:
    """Whether a file of a folder is read."""
    return name == VIEWS_FILE or is_picture(name)


class _Taken:
    """Pictures in linear light as they come from a reader, and what is to be said of them."""

    def __init__(self, transfer: Transfer) -> None:
        self.transfer = transfer
        self.images: list[NDArray[np.float32]] = []
        self.opacities: list[NDArray[np.float32] | None] = []
        self._spaces: list[Space | None] = []
        self.read = Read((), 0)

    def __call__(self, levels: Levels, space: Space | None = None) -> None:
        """Take one picture. Where display values are light (`transfer` linear), `space` is of no meaning."""
        space = space if self.transfer == "srgb" else None
        image, opacity = _linear_light(levels, space.light if space else partial(decode, transfer=self.transfer))
        self.images.append(locked(image))
        self.opacities.append(None if opacity is None else locked(opacity))
        self._spaces.append(space)

    def keep(self, numbers: Sequence[int]) -> None:
        """Forget all pictures but these."""
        self.images[:] = [self.images[number] for number in numbers]
        self.opacities[:] = [self.opacities[number] for number in numbers]
        self._spaces[:] = [self._spaces[number] for number in numbers]

    def notes(self, path: str | Path, count: int) -> Iterator[UserWarning]:
        """Yield what is to be said, at most once each."""
        whole = f"{counted(count, 'picture')} in {path}"
        yield from (ChangedPictures(f"{path} {what}") for what in self.read.changed)
        if count < self.read.of:
            yield ThinnedFilm(
                f"{count} of {self.read.of} pictures of {path} were taken, evenly spread: --most takes more"
            )
        transparent = sum(opacity is not None for opacity in self.opacities)
        spaces = [space for space in self._spaces if space]
        if transparent:
            yield TransparentPictures(f"{transparent} of {whole} are partly transparent: they were put on white")
        if spaces:
            names = ", ".join(dict.fromkeys(space.name for space in spaces if space.is_known))
            unknown = ", ".join(dict.fromkeys(space.name for space in spaces if not space.is_known))
            done = [f"{names}: turned into sRGB"] if names else []
            done += [f"{unknown}: not known here and taken as sRGB"] if unknown else []
            yield ChangedPictures(f"{len(spaces)} of {whole} have colours that are not sRGB ({'; '.join(done)})")


def _read(path: Path, transfer: Transfer, least: int, excerpt: Excerpt) -> tuple[Pictures, _Taken]:
    """Pictures, and what is to be said of them."""
    with system_errors(path, "reading"):
        there, is_folder = check_file(path).exists(), path.is_dir()
    if not there and path.suffix.lower() == ".toml":
        raise InputError(
            f"there is no {path}: give a stage's file or pictures, which `lightcube trace` makes of a scene's file"
        )
    if not there:
        raise InputError(f"there is no {path}: give a folder of pictures, an animation or a video")
    take = _Taken(transfer)
    images = take.images
    views = FolderViews()
    if is_folder and not excerpt.is_whole:
        raise InputError(f"{path} is a folder, and only of films a part is read: leave out how much of it")
    if is_folder:
        files = picture_files(path)
        views = read_views(path, len(files))
        budget = Budget()
        for file in files:
            read_single(file, budget, take)
        names = views.names or tuple(encodable(file.stem) for file in files)
    else:
        take.read = suffix_entry(path, _SUFFIXES, "pictures")(path, Budget(), take, excerpt)
        names = tuple(str(number + 1) for number in take.read.numbers)
        names = names if len(names) != 1 else (encodable(path.stem),)
    if len(images) < least:
        held = "one picture" if images else "no picture"
        needed = "a cube needs at least two: add more" if least > 1 else "one at least is needed: give another"
        raise InputError(f"{path} holds {held}, and {needed}")
    return Pictures(
        tuple(images), names, views.angles_deg, views.elevation_deg, transfer, opacities=tuple(take.opacities)
    ), take


def _read_animation(path: Path, budget: Budget, take: _Taken, excerpt: Excerpt) -> Read:
    """Take the chosen pictures of an animation, or pages of a TIFF: all are read, and some are kept."""
    read_animation(path, budget, take)
    numbers, count = excerpt.numbers(path, [None] * len(take.images))
    take.keep(numbers)
    return Read(numbers, count)


#: By suffix; of a film those that are not chosen are never kept.
_SUFFIXES: dict[str, Callable[[Path, Budget, _Taken, Excerpt], Read]] = {
    **dict.fromkeys(_ANIMATIONS, _read_animation),
    **dict.fromkeys(_FILMS, read_video),
}


def _linear_light(
    levels: Levels, light_of: Callable[[NDArray[np.float32]], NDArray[np.floating]]
) -> tuple[NDArray[np.float32], NDArray[np.float32] | None]:
    """Levels ``(row, column, 3 or 4)`` as linear light on white, made smaller if need be, and their opacity.

    None where they are opaque.

    Some rows at a time: what a large picture takes in between is little.
    """
    full = np.float32(np.iinfo(levels.dtype).max)
    rows, columns = levels.shape[:2]
    times = math.ceil(math.sqrt(rows * columns / MOST_KEPT))
    light = np.empty((-(-rows // times), -(-columns // times), 3), np.float32)
    opacities = np.empty(light.shape[:2], np.float32) if levels.shape[2] == 4 else None
    step = max(1, ROWS // times) * times
    for first in range(0, rows, step):
        part = levels[first : first + step]
        shown = light_of(part[..., :3].astype(np.float32) / full).astype(np.float32, copy=False)
        rows_made = slice(first // times, (first + step) // times)
        if opacities is not None:
            opacity = part[..., 3:].astype(np.float32) / full
            shown = opacity * shown + (1 - opacity)
            opacities[rows_made] = _averaged(opacity, times)[..., 0]
        light[rows_made] = _averaged(shown, times)
    return light, None if opacities is None or np.all(opacities == 1) else opacities


def _averaged(light: NDArray[np.float32], times: int) -> NDArray[np.float32]:
    """Light as means over squares of so many pixels; those at the end may be parts of squares."""
    for axis in (0, 1) if times > 1 else ():
        starts = np.arange(0, light.shape[axis], times)
        counts = np.diff(starts, append=light.shape[axis]).reshape([-1] + [1] * (2 - axis))
        light = (np.add.reduceat(light, starts, axis) / counts).astype(np.float32)
    return light
