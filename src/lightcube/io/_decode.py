"""Levels of the pictures in one file, through Pillow, and through PyAV where Pillow would drop bits."""

import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from PIL import Image

from lightcube.errors import InputError
from lightcube.io._containers import is_cut_short
from lightcube.io._files import system_errors
from lightcube.io._frames import Levels, levels_of
from lightcube.io._newer import learn

#: Called with each picture of a file in turn.
Take = Callable[[Levels], None]

#: A picture in memory takes three float32 numbers per pixel.
_BYTES_PER_PIXEL = 12
_ORIENTATION = 0x0112
_BITS_PER_SAMPLE, _SAMPLES_PER_PIXEL = 258, 277
_PNG_HEADER = 26


@contextmanager
def decoding(path: Path) -> Iterator[None]:
    """Turn whatever a decoder raises over `path` into an `InputError` of one sentence."""
    with system_errors(path, "reading"), warnings.catch_warnings():
        # Pillow warns of odd tags and metadata that no picture needs; broken pixels are an exception.
        warnings.filterwarnings("ignore", category=UserWarning, module="PIL")
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # the budget refuses those
        try:
            yield
        except InputError:
            raise
        except (Image.DecompressionBombError, MemoryError) as error:
            raise too_large(path) from error
        except Exception as error:  # decoders raise whatever they trip over in damaged bytes
            if isinstance(error, OSError) and error.errno is not None and error.filename is not None:
                raise
            raise InputError(f"{path} cannot be read, it is damaged, cut short or no picture: mend or remove it") from (
                error
            )


def too_large(path: Path) -> InputError:
    """Return the exception for pictures that do not fit into memory."""
    return InputError(f"{path} unpacks to more pixels than this machine can hold: make it smaller first")


def refuse_cut_short(path: Path) -> None:
    """Raise `InputError` where the container in `path` says that there should be more of it."""
    with path.open("rb") as file:
        if is_cut_short(file):
            raise InputError(f"{path} is cut short, its end is missing: copy it or make it again")


class Budget:
    """Pixels that may still be unpacked, so that no file fills the machine's memory: half of it, at most."""

    def __init__(self) -> None:
        self.pixels = _memory() // 2 // _BYTES_PER_PIXEL

    def spend(self, path: Path, rows: int, columns: int) -> None:
        """Take one picture's pixels off; `InputError` where there are not enough, or it is larger than any photo."""
        self.pixels -= rows * columns
        if self.pixels < 0 or rows * columns > (Image.MAX_IMAGE_PIXELS or rows * columns):
            raise too_large(path)


def _memory() -> int:
    """Bytes of memory that the machine has; 8 GiB where the system does not tell."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return 8 * 2**30


def read_single(path: Path, budget: Budget, take: Take) -> None:
    """Give the one picture of `path` to `take`; a TIFF's further pages are left out.

    Raises
    ------
    InputError
        Where the file cannot be read, or is an animation.
    """
    learn(path)
    with decoding(path), Image.open(path) as image:
        if image.format in ("PNG", "WEBP", "GIF", "AVIF") and getattr(image, "n_frames", 1) > 1:
            raise InputError(f"{path} is an animation inside a folder of pictures: give that file itself, or move it")
        budget.spend(path, image.height, image.width)
        take(_deep(path, image) if _deep_colour(path, image) else _frame(path, image))


def read_animation(path: Path, budget: Budget, take: Take) -> None:
    """Give every picture of an animated GIF, WebP or APNG, or every page of a TIFF, to `take`."""
    learn(path)
    with decoding(path), Image.open(path) as image:
        refuse_cut_short(path)
        count = getattr(image, "n_frames", 1)
        if _deep_colour(path, image):
            if count > 1:
                raise InputError(
                    f"{path} holds several pictures of 16 bits per colour: save them as single files in a folder"
                )
            budget.spend(path, image.height, image.width)
            take(_deep(path, image))
            return
        for index in range(count):
            image.seek(index)
            budget.spend(path, image.height, image.width)
            if index or not getattr(image, "default_image", False):
                take(_frame(path, image))


def _frame(path: Path, image: Image.Image) -> Levels:
    """Levels of the frame that `image` stands at, upright."""
    image.load()
    if image.mode.startswith("I;16"):
        grey = np.asarray(image).astype(np.uint16)
        levels: Levels = np.repeat(grey[:, :, None], 3, axis=2)
    elif image.mode in ("I", "F"):
        raise InputError(f"{path} holds numbers instead of levels of 8 or 16 bits: save it as a PNG first")
    else:
        levels = np.asarray(image.convert("RGBA" if image.has_transparency_data else "RGB"))
    # After loading: only then has Pillow read everything, and it turns a TIFF upright itself.
    return _upright(levels, image.getexif().get(_ORIENTATION, 1))


def _deep_colour(path: Path, image: Image.Image) -> bool:
    """Whether the file has 16 bits per channel in several channels, of which Pillow keeps only 8."""
    if image.format == "PNG":
        with path.open("rb") as file:
            header = file.read(_PNG_HEADER)
        return header[24] == 16 and header[25] != 0
    if image.format == "TIFF":
        tags = image.tag_v2  # type: ignore[attr-defined]
        return tags.get(_SAMPLES_PER_PIXEL, 1) > 1 and max(tags.get(_BITS_PER_SAMPLE, (8,))) == 16
    return False


def _deep(path: Path, image: Image.Image) -> Levels:
    """Levels of a PNG or TIFF with 16 bits in several channels, upright."""
    import av

    image.load()  # for its checks of the whole file and its metadata; a TIFF loses its orientation here, so look again
    with Image.open(path) as again:
        orientation = again.getexif().get(_ORIENTATION) or image.getexif().get(_ORIENTATION, 1)
    with path.open("rb") as file, av.open(file, "r", format=f"{(image.format or '').lower()}_pipe") as container:
        frame = next(iter(container.decode(video=0)))
    return _upright(levels_of(frame), orientation)


def _upright(levels: Levels, orientation: int) -> Levels:
    """`levels` turned and mirrored as an EXIF `orientation` (1 to 8) says."""
    if orientation in (5, 6, 7, 8):
        levels = levels.transpose(1, 0, 2)
    if orientation in (3, 4, 7, 8):
        levels = levels[::-1]
    if orientation in (2, 3, 6, 7):
        levels = levels[:, ::-1]
    return levels
