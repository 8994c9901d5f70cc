"""What all readers of pictures share: levels, Pillow's settings, and what is said of damaged files."""

import lzma
import struct
import traceback
import warnings
import zlib
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from threading import Lock
from typing import Protocol

import numpy as np
from PIL import Image, UnidentifiedImageError

from lightcube.errors import InputError
from lightcube.io import _bounds
from lightcube.io._bounds import too_large
from lightcube.io._containers import is_cut_short
from lightcube.io._files import system_errors
from lightcube.io._frames import Levels
from lightcube.io._spaces import Space
from lightcube.io._tables import turn_of_profile


class Take(Protocol):
    """Called with each picture of a file in turn, and with its colours where they are not sRGB."""

    def __call__(self, levels: Levels, space: Space | None = None) -> None: ...


_ORIENTATION = 0x0112
#: How many rows of a picture are worked on at a time: what a large one takes in between is little.
ROWS = 256

#: What is raised over bytes that are not what they should be, beside what decoders raise of their own.
_WRONG = (
    OSError,
    EOFError,
    SyntaxError,
    ValueError,
    LookupError,
    struct.error,
    zlib.error,
    lzma.LZMAError,
)
#: How PNG, JPEG, GIF, WebP and TIFF start.
_STARTS = (b"\x89PNG", b"\xff\xd8", b"GIF8", b"RIFF", b"II*\0", b"MM\0*")
_DECODERS = ("PIL", "av", "tifffile", "imagecodecs")


@contextmanager
def decoding(path: Path) -> Iterator[None]:
    """Turn what a decoder raises over the bytes of `path` into an `InputError` of one sentence."""
    with system_errors(path, "reading"), _OF_PILLOW:
        try:
            yield
        except InputError:
            raise
        except Image.DecompressionBombError as error:
            raise too_large(path) from error
        except MemoryError as error:
            raise InputError(f"{path} does not fit into this machine's memory: make it smaller first") from error
        except UnidentifiedImageError as error:
            raise _unidentified(path) from error
        except Exception as error:
            of_system = isinstance(error, OSError) and error.errno is not None and error.filename is not None
            if of_system or not _means_damage(error):
                raise
            raise damaged(path) from error


def _means_damage(error: Exception) -> bool:
    """Whether `error` is about a file's bytes, not about a fault of this program."""
    if isinstance(error, _WRONG) or type(error).__module__.partition(".")[0] in _DECODERS:
        return True
    trace = list(traceback.walk_tb(error.__traceback__))
    # Over a tag of the wrong type or a missing palette decoders stumble so; this program's own lines are at fault.
    stumbled = isinstance(error, (TypeError, ArithmeticError, AssertionError))
    return stumbled and trace[-1][0].f_globals["__name__"].partition(".")[0] in _DECODERS


class _OfPillow:
    """What is set in Pillow and of warnings while pictures are read: by the first reader of several, until the last.

    Both are the whole program's. Readers in threads that each put back what they found would leave another's behind.
    """

    def __init__(self) -> None:
        self._lock, self._readers, self._settings = Lock(), 0, ExitStack()

    def __enter__(self) -> None:
        with self._lock:
            self._readers += 1
            if self._readers == 1:
                self._set()

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._readers -= 1
            if not self._readers:
                self._settings.close()

    def _set(self) -> None:
        self._settings.enter_context(warnings.catch_warnings())
        # Pillow warns of odd tags and metadata that no picture needs; broken pixels are an exception.
        warnings.filterwarnings("ignore", category=UserWarning, module="PIL")
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # the budget refuses those
        self._settings.callback(setattr, Image, "MAX_IMAGE_PIXELS", Image.MAX_IMAGE_PIXELS)
        Image.MAX_IMAGE_PIXELS = _bounds.MOST_PIXELS // 2  # it refuses what has more than twice as many


_OF_PILLOW = _OfPillow()


def damaged(path: Path) -> InputError:
    """Return the exception for a file whose bytes are not what they should be."""
    return InputError(f"{path} cannot be read, it is damaged or cut short: mend or remove it")


def _unidentified(path: Path) -> InputError:
    """Return the exception for a file that Pillow does not know: a damaged header, or something else."""
    with path.open("rb") as file:
        if file.read(4).startswith(_STARTS):
            return damaged(path)
    return InputError(f"{path} cannot be read, it is no picture of a known kind: mend or remove it")


def refuse_cut_short(path: Path) -> None:
    """Raise `InputError` where the container in `path` says that there should be more of it."""
    with path.open("rb") as file:
        if is_cut_short(file):
            raise InputError(f"{path} is cut short, its end is missing: copy it or make it again")


def levels_of_image(path: Path, image: Image.Image) -> Levels:
    """Levels of the picture that `image` stands at, as it lies in the file."""
    image.load()
    if image.mode[0] in "IF":
        raise InputError(f"{path} holds numbers instead of levels of 8 or 16 bits: save it as a PNG first")
    return colours_of_image(image)


def colours_of_image(image: Image.Image) -> Levels:
    """Levels of what `image` has loaded; of inks by its profile, if it has one of theirs. Some rows at a time."""
    turn = turn_of_profile(image.info.get("icc_profile"), "CMYK") if image.mode == "CMYK" else None
    mode = "RGBA" if image.has_transparency_data else "RGB"
    levels = np.empty((image.height, image.width, len(mode)), np.uint8)
    for first in range(0, image.height, ROWS):
        last = min(first + ROWS, image.height)
        part = image.crop((0, first, image.width, last))
        levels[first:last] = turn(np.asarray(part)) if turn else np.asarray(part.convert(mode))
    return levels


def orientation_of(image: Image.Image) -> int:
    """Return the EXIF orientation of a picture that is loaded: only then has Pillow read everything."""
    return image.getexif().get(_ORIENTATION, 1)


def upright(levels: Levels, orientation: int) -> Levels:
    """`levels` turned and mirrored as an EXIF `orientation` (1 to 8) says."""
    if orientation in (5, 6, 7, 8):
        levels = levels.transpose(1, 0, 2)
    if orientation in (3, 4, 7, 8):
        levels = levels[::-1]
    if orientation in (2, 3, 6, 7):
        levels = levels[:, ::-1]
    return levels
