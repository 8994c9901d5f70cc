"""Pages of TIFF files, through tifffile; through Pillow what its libtiff unpacks and tifffile does not."""

import ctypes
import logging
import math
import zlib
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np
from PIL import Image

from lightcube.errors import InputError
from lightcube.io._bounds import Budget, unpacks_beyond
from lightcube.io._decode import ROWS, Take, colours_of_image, damaged, refuse_cut_short, upright
from lightcube.io._frames import Levels
from lightcube.io._samples import Samples, full_of, of_inks, of_lab, spread, with_opacity
from lightcube.io._spaces import space_of_profile
from lightcube.io._tables import turn_of_profile

if TYPE_CHECKING:
    from tifffile import TiffPage

# What tifffile says of odd tags goes nowhere: what a picture needs of them is checked here.
logging.getLogger("tifffile").addHandler(logging.NullHandler())

#: How a TIFF or BigTIFF of either byte order starts.
TIFF_STARTS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")

_ORIENTATION, _PROFILE = 0x0112, 34675
_REDUCED, _MASK = 1, 4
_WHITE_IS_ZERO, _BLACK_IS_ZERO, _RGB, _PALETTE, _TRANSPARENCY, _INKS, _YCBCR, _LAB = 0, 1, 2, 3, 4, 5, 6, 8
#: How many samples make a colour; others are opacity or of no use here.
_COLOURS = {_WHITE_IS_ZERO: 1, _BLACK_IS_ZERO: 1, _RGB: 3, _PALETTE: 1, _INKS: 4, _YCBCR: 3, _LAB: 3}
_PLAIN, _CMYK = 1, 1
#: Fax and JPEG, which Pillow's libtiff always unpacks; and what it unpacks too: nothing, LZW, Deflate, PackBits.
_OF_LIBTIFF = (2, 3, 4, 6, 7, 32771)
_SIMPLE = (1, 5, 8, 32946, 32773)
_SIGNED, _FLOAT, _COMPLEX = 2, 3, (5, 6)
_ASSOCIATED, _UNASSOCIATED = 1, 2
_MOST_SAMPLES = 32
#: What has to be one number in each page.
_NUMBERS = (
    *("imagewidth", "imagelength", "imagedepth", "samplesperpixel", "bitspersample", "sampleformat"),
    *("photometric", "compression", "predictor", "planarconfig"),
)
_DEFLATE, _OLD_DEFLATE, _LZMA = 8, 32946, 34925
#: What packers may leave behind the last pixel of a strip.
_SLACK = 1 << 16


@cache
def _hush_libtiff() -> None:
    """Let Pillow's libtiff print nothing of damaged files, where it can be told so: readers say what is wrong."""
    library = ctypes.CDLL(Image.core.__file__)  # type: ignore[attr-defined]
    with suppress(AttributeError):
        for handler in (library.TIFFSetErrorHandler, library.TIFFSetWarningHandler):
            handler.argtypes, handler.restype = [ctypes.c_void_p], ctypes.c_void_p
            handler(None)


def read_tiff(path: Path, budget: Budget, take: Take, *, single: bool) -> None:
    """Give each page of a TIFF that is a picture to `take`, or only the first; thumbnails and masks are none.

    Raises
    ------
    InputError
        Where a page is damaged, is coloured or packed in a way that is not read, or needs the extra ``tiff``.
    """
    from tifffile import TiffFile

    refuse_cut_short(path)
    with TiffFile(path) as file:
        all_pages = cast("Iterable[TiffPage]", file.pages)
        pages = [page for page in all_pages if page.photometric != _TRANSPARENCY and not page.subfiletype & _MASK]
        pages = [page for page in pages if not page.subfiletype & _REDUCED] or pages
        if not pages:
            raise InputError(f"{path} holds masks or nothing at all, no picture: remove it")
        pages = pages[: 1 if single else None]
        for page in pages:
            _refuse_others(path, page)
        budget.check(path, *((page.imagelength, page.imagewidth) for page in pages))
        for page in pages:
            budget.spend(path, page.imagelength, page.imagewidth)
            profile = None if page.photometric == _LAB else page.tags.valueof(_PROFILE)
            take(_levels(path, page), space_of_profile(profile, inks=page.photometric == _INKS))


def _levels(path: Path, page: "TiffPage") -> Levels:
    """Levels of one page, upright."""
    unpacked = _is_unpacked(page)
    for_pillow = page.compression in _OF_LIBTIFF or page.photometric == _YCBCR
    if page.bitspersample <= 8 and (for_pillow or (page.compression in _SIMPLE and not unpacked)):
        unpacked_there = _levels_of_pillow(path, page.index)
        if unpacked_there is not None:
            return unpacked_there
    if not unpacked:
        raise _cannot_unpack(path, page)
    samples = _samples(path, page)
    inks = (page.photometric == _INKS and turn_of_profile(page.tags.valueof(_PROFILE), "CMYK")) or of_inks
    levels: Levels | None = None
    for first in range(0, len(samples), ROWS):
        part = _colours(page, samples[first : first + ROWS], inks)
        if levels is None:  # what has the same samples takes their place
            whole = (*samples.shape[:2], part.shape[2])
            alike = (whole, part.dtype) == (samples.shape, samples.dtype) and samples.flags.writeable
            levels = cast("Levels", samples if alike else np.empty(whole, part.dtype))
        levels[first : first + ROWS] = part
    assert levels is not None  # noqa: S101 - a page has rows
    return upright(levels, page.tags.valueof(_ORIENTATION, default=1))


def _cannot_unpack(path: Path, page: "TiffPage") -> InputError:
    """Return the exception for a page whose samples are packed as nothing that is installed unpacks them."""
    name = getattr(page.compression, "name", None)
    kind = f"{name or page.compression}, {page.bitspersample} bits"
    if name and find_spec("imagecodecs") is None:
        return InputError(
            f"{path}: reading this kind of TIFF ({kind}) needs one more package: pip install 'lightcube[tiff]'"
        )
    return InputError(f"{path} is packed in a way that is not read ({kind}): save it as a PNG first")


def _refuse_others(path: Path, page: "TiffPage") -> None:
    """Raise `InputError` where the samples of `page` are not levels of colours that are known here."""
    if not all(isinstance(getattr(page, name), int) for name in _NUMBERS):
        raise damaged(path)
    bits = page.bitspersample
    unequal = len(set(np.atleast_1d(page.tags.valueof("BitsPerSample", default=1)))) > 1
    if unequal or page.samplesperpixel > _MOST_SAMPLES or page.imagedepth > 1:
        raise InputError(f"{path} is laid out as no picture is: save it as a PNG first")
    if page.sampleformat in (_SIGNED, _FLOAT, *_COMPLEX) or bits > 16:
        raise InputError(f"{path} holds numbers instead of levels of 8 or 16 bits: save it as a PNG first")
    # JPEG is turned into RGB when it is unpacked; of others only libtiff does it, and with 8 bits.
    plain_ycbcr = page.photometric == _YCBCR and bits > 8 and page.compression not in _OF_LIBTIFF
    other_inks = page.photometric == _INKS and page.tags.valueof("InkSet", default=_CMYK) != _CMYK
    if page.photometric not in _COLOURS or plain_ycbcr or other_inks:
        kind = getattr(page.photometric, "name", page.photometric)
        raise InputError(f"{path} has colours of a kind that is not read ({kind}): save it as RGB first")
    if page.samplesperpixel < _COLOURS[page.photometric] or (page.photometric == _PALETTE and page.colormap is None):
        raise InputError(f"{path} lacks some of its colours, it is damaged: copy it or make it again")


def _is_unpacked(page: "TiffPage") -> bool:
    """Whether tifffile, with imagecodecs if that is installed, unpacks the samples of `page`."""
    from tifffile import TIFF

    whole_bytes = page.bitspersample in (1, 8, 16) or find_spec("imagecodecs") is not None
    known = page.compression == _PLAIN or page.compression in TIFF.DECOMPRESSORS
    return whole_bytes and known and (page.predictor == _PLAIN or page.predictor in TIFF.UNPREDICTORS)


def _levels_of_pillow(path: Path, index: int) -> Levels | None:
    """Levels of page `index` through Pillow, which turns them upright; None where it keeps them as no colours."""
    _hush_libtiff()
    # Not by its name: Pillow maps such files into memory, and then turns them wrongly.
    with path.open("rb") as file, Image.open(file) as image:
        image.seek(index)
        image.load()
        if image.mode not in ("1", "L", "LA", "P", "PA", "RGB", "RGBA", "RGBX", "RGBa", "CMYK"):
            return None
        return colours_of_image(image)


def _samples(path: Path, page: "TiffPage") -> Samples:
    """Unpacked samples ``(row, column, sample)`` of one page, as the file has them."""
    places = list(zip(page.dataoffsets, page.databytecounts, strict=False))
    pieces = int(np.prod(page.chunked))
    if len(places) < (1 if page.is_contiguous else pieces) or not all(at and length for at, length in places):
        raise InputError(f"{path} lacks some of its pixels, it is damaged: copy it or make it again")
    _refuse_swollen(path, page, places)
    try:
        samples = page.asarray(squeeze=False, maxworkers=1)
    except ImportError as error:  # Zstandard and LZMA stand in the tables of tifffile wherever they might be
        raise _cannot_unpack(path, page) from error
    wanted = (page.imagelength, page.imagewidth, page.samplesperpixel)
    separate, _, rows, columns, together = samples.shape
    samples = samples.transpose(1, 2, 3, 0, 4).reshape(rows, columns, separate * together)
    if samples.shape != wanted:
        raise InputError(f"{path} unpacks to {samples.shape} samples, not to {wanted}: copy it or make it again")
    return cast("Samples", samples.astype(np.uint8 if page.bitspersample <= 8 else np.uint16, copy=False))


def _refuse_swollen(path: Path, page: "TiffPage", places: Iterable[tuple[int, int]]) -> None:
    """Raise `InputError` where a strip or a tile unpacks to more than its pixels: what Python has unpacks it all."""
    wbits = {_DEFLATE: zlib.MAX_WBITS, _OLD_DEFLATE: zlib.MAX_WBITS, _LZMA: 0}.get(page.compression)
    if wbits is None:
        return
    most = math.prod(page.chunks) * max(1, page.bitspersample // 8) + _SLACK
    with path.open("rb") as file:
        for at, length in places:
            file.seek(at)
            if unpacks_beyond(file.read(length), most, wbits=wbits):
                raise damaged(path)


def _colours(page: "TiffPage", samples: Samples, inks: Callable[[Samples], Samples]) -> Levels:
    """Levels in sRGB of some rows of `page`, with opacity where the file has it."""
    count = _COLOURS[page.photometric]
    spare = spread(samples[..., count:], page.bitspersample)
    if page.colormap is not None and page.photometric == _PALETTE:
        # Of 16 bits some programs fill only the upper 8.
        palette = (page.colormap >> 8).astype(np.uint8).T
        colours: Samples = palette[np.minimum(samples[..., 0], len(palette) - 1)]
    else:
        colours = spread(samples[..., :count], page.bitspersample)
    if page.photometric == _WHITE_IS_ZERO:
        colours = full_of(colours) - colours
    elif page.photometric == _INKS:
        colours = inks(colours)
    elif page.photometric == _LAB:
        colours = of_lab(colours)
    colours = cast("Samples", np.broadcast_to(colours, (*colours.shape[:2], 3)))
    for at, kind in enumerate(page.extrasamples or [_UNASSOCIATED] * spare.shape[2]):
        if kind in (_ASSOCIATED, _UNASSOCIATED):
            return with_opacity(colours, spare[..., at, None], multiplied=kind == _ASSOCIATED)
    return colours
