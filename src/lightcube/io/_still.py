"""Pictures and animations that are no videos: TIFF and PNG by readers of their own, all others through Pillow."""

from contextlib import suppress
from pathlib import Path

from PIL import Image

from lightcube.errors import InputError
from lightcube.io._bounds import MOST_PICTURES, Budget, check_file, crowded
from lightcube.io._containers import count_of_pictures
from lightcube.io._decode import (
    Take,
    damaged,
    decoding,
    levels_of_image,
    orientation_of,
    refuse_cut_short,
    upright,
)
from lightcube.io._newer import learn
from lightcube.io._png import PNG_START, read_png
from lightcube.io._spaces import Space, adobe_rgb, space_of_container, space_of_profile
from lightcube.io._tiff import TIFF_STARTS, read_tiff

#: How the kinds of pictures of a multi-picture JPEG begin that are views of their own: panorama, disparity, angles.
_VIEW_OF_MPO = "Multi-Frame"
#: A JPEG takes one bit at least for each 8 x 8 pixels; what is missing would be filled up with grey.
_PIXELS_PER_BYTE = 512
#: How each pass over a JPEG's pixels begins; encoders make about ten.
_SCAN, _MOST_SCANS = b"\xff\xda", 500
_MP_ENTRIES = 0xB002
_INTEROPERABILITY = 0xA005
#: Before the pixels of an AVIF or HEIC stands what is said of them.
_HEAD_BYTES = 1 << 16


def read_single(path: Path, budget: Budget, take: Take) -> None:
    """Give the one picture of `path` to `take`; a TIFF's or JPEG's further ones are left out.

    Raises
    ------
    InputError
        Where the file cannot be read, or is an animation.
    """
    _read(path, budget, take, single=True)


def read_animation(path: Path, budget: Budget, take: Take) -> None:
    """Give every picture of an animated GIF, WebP or APNG, or every page of a TIFF, to `take`."""
    _read(path, budget, take, single=False)


def _read(path: Path, budget: Budget, take: Take, *, single: bool) -> None:
    """Give the pictures of `path` to `take`, by the reader of what the file starts with."""
    learn(path)
    with decoding(path):
        with check_file(path).open("rb") as file:
            start = file.read(8)
            if count_of_pictures(file, MOST_PICTURES) > MOST_PICTURES:
                raise crowded(path)
        if start.startswith(TIFF_STARTS):
            read_tiff(path, budget, take, single=single)
        elif start == PNG_START:
            read_png(path, budget, take, single=single)
        else:
            refuse_cut_short(path)
            with Image.open(path) as image:
                _read_others(path, image, budget, take, single=single)


def _read_others(path: Path, image: Image.Image, budget: Budget, take: Take, *, single: bool) -> None:
    """Give the pictures of a GIF, WebP, JPEG, AVIF or HEIC to `take`, all of the size of the first."""
    columns, rows = image.size
    if image.format in ("JPEG", "MPO"):
        data = path.read_bytes()
        if rows * columns > _PIXELS_PER_BYTE * len(data) or data.count(_SCAN) > _MOST_SCANS:
            raise damaged(path)
    views = _views(image)
    budget.check(path, *[(rows, columns)] * (1 if single else len(views)))
    for index in views:
        if single and index:
            if image.format in ("GIF", "WEBP", "AVIF"):
                raise InputError(
                    f"{path} is an animation inside a folder of pictures: give that file itself, or move it"
                )
            return
        image.seek(index)
        budget.spend(path, *reversed(image.size))
        levels = levels_of_image(path, image)
        if image.format == "GIF":  # Pillow lets the screen grow where a later picture goes beyond it
            levels = levels[:rows, :columns]
        orientation, space = orientation_of(image), _space(path, image)
        if single or len(views) == 1:
            image.close()  # what it has loaded is no longer needed, and much of a large one
        take(upright(levels, orientation), space)


def _views(image: Image.Image) -> list[int]:
    """Which pictures of a file are such; a phone's JPEG has thumbnails, masks and gain maps behind the first."""
    count = getattr(image, "n_frames", 1)
    if image.format != "MPO":
        return list(range(count))
    entries = image.mpinfo.get(_MP_ENTRIES, [])  # type: ignore[attr-defined]
    kinds = [entry["Attribute"]["MPType"] for entry in entries]
    return [0, *(index for index in range(1, count) if kinds[index].startswith(_VIEW_OF_MPO))]


def _space(path: Path, image: Image.Image) -> Space | None:
    """Colours of a picture, by its profile, or by what its container or a camera's EXIF says instead of one."""
    profile = image.info.get("icc_profile")
    if not profile and image.format in ("AVIF", "HEIF"):
        with path.open("rb") as file:
            return space_of_container(file.read(_HEAD_BYTES))
    with suppress(KeyError):  # Pillow 11 has no empty answer where nothing is said
        if not profile and image.getexif().get_ifd(_INTEROPERABILITY).get(1) == "R03":
            return adobe_rgb()
    return space_of_profile(profile, inks=image.mode == "CMYK")
