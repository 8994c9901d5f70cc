"""Writers of pictures: a movie, an animation, a folder of PNGs, or numbers."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Sized
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path, PurePath
from typing import TypedDict, TypeGuard, cast

import numpy as np
from numpy.typing import NDArray

from lightcube.errors import InputError
from lightcube.io import _encoders
from lightcube.io._files import Writer
from lightcube.io._places import Place, names_in
from lightcube.io.pictures_folder import VIEWS_FILE, is_left_by_systems, views_text
from lightcube.optics.transfer import Transfer, check_transfer, encode, from_levels
from lightcube.optics.views import Views
from lightcube.wording import counted

Picture = NDArray[np.float32]
Levels = NDArray[np.uint8]
Frame = Picture | Levels


class ClippedPictures(UserWarning):
    """Pictures have values that a display cannot show: below black or above white."""


class SmallerPictures(UserWarning):
    """Pictures have fewer pixels than they were given with."""


#: Bytes of a GIF that is to be sent.
SHARED_GIF = 5_000_000


@dataclass(frozen=True)
class _Job:
    """What every writer is told."""

    count: int
    transfer: Transfer
    fps: Fraction
    views: str
    scale: int
    shared: bool


@dataclass
class _Clipped:
    """How many values of how many were clipped."""

    values: int = 0
    total: int = 0


class Options(TypedDict, total=False):
    """What may be said of pictures.

    Parameters
    ----------
    count
        How many there are; needed where they have no length.
    transfer
        How linear light becomes display values; sRGB where nothing is said.
    fps
        Pictures per second of a movie; 10 where nothing is said.
    scale
        Enlarges each pixel to a square of so many.
    views, names
        One view and one name per picture, for a folder's `views.toml`.
    shared
        Small enough to be sent: an MP4 has at most 0.7 MB a second, a GIF 5 MB in all, made smaller until it has.
    """

    count: int | None
    transfer: Transfer
    fps: float
    scale: int
    views: Views | None
    names: Sequence[str] | None
    shared: bool


def _writer(write: Callable[[Path, Iterable[Frame], _Job, _Clipped], UserWarning | None]) -> Writer:
    """What `write` does, with all that is said of the pictures checked."""

    def checked(
        path: Path,
        pictures: Frame | Iterable[Frame],
        *,
        count: int | None = None,
        transfer: Transfer = "srgb",
        fps: float = 10.0,
        scale: int = 1,
        views: Views | None = None,
        names: Sequence[str] | None = None,
        shared: bool = False,
    ) -> UserWarning | None:
        number = _count(pictures, count, {"views": views, "names": names})
        if number < 1 or int(scale) != scale or scale < 1:
            raise InputError(
                f"cannot write {number} pictures at scale {scale}: both must be whole numbers of at least 1"
            )
        job = _Job(number, check_transfer(transfer), _rate(fps), views_text(views, names), int(scale), shared)
        clipped = _Clipped()
        try:
            told = write(path, _checked(pictures, number, job.scale), job, clipped)
        except Exception as error:
            from av.error import FFmpegError

            if isinstance(error, OSError) or not isinstance(error, FFmpegError):
                raise
            raise InputError(
                f"{path.name} cannot be encoded ({error.strerror}): try another suffix, fewer or smaller pictures"
            ) from error
        return _lost(clipped, path.name) or told

    return checked


def _count(pictures: Iterable[Frame], count: int | None, each: Mapping[str, Sized | None]) -> int:
    """How many pictures there are; `InputError` where there are not as many of `each`."""
    if count is None:
        if not isinstance(pictures, Sized):
            raise InputError("pictures that are made one by one need a count: say how many there are")
        count = len(pictures)
    for what, given in each.items():
        if given is not None and len(given) != count:
            raise InputError(f"{len(given)} {what} for {counted(count, 'picture')}: give one per picture")
    return count


def _lost(clipped: _Clipped, name: str) -> ClippedPictures | None:
    """What to warn of, where anything was clipped."""
    if not clipped.values:
        return None
    return ClippedPictures(
        f"{clipped.values} of {clipped.total} values in {name} ({clipped.values / clipped.total:.1%}) "
        "were clipped to black or white: "
        "write .npy to keep them"
    )


def _rate(fps: float) -> Fraction:
    """`fps` as the fraction that containers want."""
    if not (math.isfinite(fps) and 1e-3 <= fps <= 1000):
        raise InputError(f"pictures per second must be a number from 0.001 to 1000, not {fps}")
    return Fraction(fps).limit_denominator(1001)


def _checked(pictures: Iterable[Frame], count: int, scale: int) -> Iterator[Frame]:
    """Yield exactly `count` finite pictures of one shape, enlarged."""
    shape: tuple[int, ...] | None = None
    number = 0
    for number, given in enumerate(pictures, 1):
        picture = _real(given, number)
        shape = shape or picture.shape
        if number > count:
            raise InputError(f"more came than the {counted(count, 'picture')} announced: mend the count")
        if picture.ndim != 3 or picture.shape != shape or picture.size == 0:
            raise InputError(
                f"picture number {number} has shape {picture.shape} and the first one {shape}: give pictures of one "
                "shape (rows, columns, channels)"
            )
        if not (_is_levels(picture) or np.all(np.isfinite(picture))):
            raise InputError(f"picture number {number} holds NaN or infinite values and cannot be written: mend it")
        yield picture.repeat(scale, axis=0).repeat(scale, axis=1) if scale > 1 else picture
    if number != count:
        raise InputError(f"{counted(count, 'picture')} announced and {number} came: mend the count")


def _real(picture: Frame, number: int) -> Frame:
    """A picture, or a list of lists, as an array of real numbers; `InputError` where it is none."""
    try:
        array = np.asarray(picture)
    except ValueError:  # rows of unequal lengths
        array = np.asarray(None)
    if array.dtype.kind not in "biuf":
        raise InputError(f"picture number {number} does not hold real numbers but {array.dtype}: give linear light")
    return cast("Frame", array)


def _is_levels(picture: Frame) -> TypeGuard[Levels]:
    """Whether a picture holds 8-bit display levels, not light."""
    return picture.dtype == np.uint8


def _levels(pictures: Iterable[Frame], transfer: Transfer, clipped: _Clipped) -> Iterator[Levels]:
    """8-bit display levels of each picture, as given or of its light, counting what was clipped."""
    for picture in pictures:
        if picture.shape[2] != 3:
            raise InputError(f"a movie has three colour channels, not {picture.shape[2]}: write .npy instead")
        if _is_levels(picture):
            yield np.ascontiguousarray(picture)
            continue
        wanted = np.rint(encode(np.asarray(picture, np.float32), transfer) * 255)
        shown = np.clip(wanted, 0, 255)
        clipped.values += int(np.count_nonzero(wanted != shown))
        clipped.total += wanted.size
        yield np.ascontiguousarray(shown.astype(np.uint8))


def _movie(encoder: _encoders.Encoder) -> Writer:
    """Writer that hands 8-bit levels to an encoder."""

    def write(path: Path, pictures: Iterable[Frame], job: _Job, clipped: _Clipped) -> None:
        encoder(path, _levels(pictures, job.transfer, clipped), job.fps)

    return _writer(write)


def _write_mp4(path: Path, pictures: Iterable[Frame], job: _Job, clipped: _Clipped) -> None:
    """At half the colour resolution where pixels are enlarged evenly, so that no picture can lose by it."""
    encoder = _encoders.encode_mp4 if job.scale % 2 else _encoders.encode_doubled_mp4
    encoder = _encoders.encode_shared_mp4 if job.shared else encoder
    encoder(path, _levels(pictures, job.transfer, clipped), job.fps)


def _write_gif(path: Path, pictures: Iterable[Frame], job: _Job, clipped: _Clipped) -> UserWarning | None:
    """Made smaller until it is small enough to be sent, if it is to be, which is told."""
    levels = _levels(pictures, job.transfer, clipped)
    if not job.shared:
        _encoders.encode_gif(path, levels, job.fps)
        return None
    before, after = _encoders.encode_shared_gif(path, levels, job.fps, SHARED_GIF)
    if after == before:
        return None
    size, kept = (f"{columns} x {rows}" for rows, columns in (before, after))
    return SmallerPictures(
        f"{path.name} would have more than {SHARED_GIF / 1e6:.0f} MB at {size} pixels and has {kept}: "
        "write .mp4 to keep them"
    )


def _write_folder(path: Path, pictures: Iterable[Frame], job: _Job, clipped: _Clipped) -> None:
    """PNGs whose numbers have the same number of digits, and `views.toml` where there is something to say."""
    path.mkdir()
    digits = len(str(job.count))
    for number, levels in enumerate(_levels(pictures, job.transfer, clipped), 1):
        (path / f"{number:0{digits}d}.png").write_bytes(_encoders.png(levels))
    if job.views:
        (path / VIEWS_FILE).write_bytes(job.views.encode("utf-8", errors="replace"))


def _write_png(path: Path, pictures: Iterable[Frame], job: _Job, clipped: _Clipped) -> None:
    """A single picture."""
    if job.count > 1:
        raise InputError(f"a .png holds one picture, not {job.count}: give a folder (no suffix), or another suffix")
    for levels in _levels(pictures, job.transfer, clipped):
        path.write_bytes(_encoders.png(levels))


def _write_npy(path: Path, pictures: Iterable[Frame], job: _Job, clipped: _Clipped) -> None:
    """NumPy's own format, one picture after the other."""
    with path.open("wb") as file:
        for number, picture in enumerate(pictures):
            if not number:
                header = {"descr": "<f4", "fortran_order": False, "shape": (job.count, *picture.shape)}
                np.lib.format.write_array_header_1_0(file, header)
            light = from_levels(picture, job.transfer) if _is_levels(picture) else picture
            file.write(light.astype("<f4").tobytes())


def is_pictures_folder(path: Place) -> bool:
    """Whether a folder holds nothing but what `_write_folder` writes, and what systems leave."""
    return all(
        name == VIEWS_FILE or PurePath(name).suffix.lower() == ".png" or is_left_by_systems(name)
        for name in names_in(path)
    )


WRITERS = {
    ".mp4": _writer(_write_mp4),
    ".webm": _movie(_encoders.encode_webm),
    ".gif": _writer(_write_gif),
    ".webp": _movie(_encoders.encode_webp),
    ".apng": _movie(_encoders.encode_apng),
    ".npy": _writer(_write_npy),
    ".png": _writer(_write_png),
    "": _writer(_write_folder),
}
