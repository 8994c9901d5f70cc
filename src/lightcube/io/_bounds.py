"""Sizes that files state, checked before they are believed, and what is no file at all."""

import lzma
import os
import zlib
from pathlib import Path

from lightcube.errors import InputError

#: A picture in memory takes three float32 numbers per pixel.
_BYTES_PER_PIXEL = 12
#: No camera's picture has more; a file that says so would only fill the memory.
MOST_PIXELS = 250_000_000
#: More than a turntable can stop for; each costs time, however small it is.
MOST_PICTURES = 10_000
#: Of a document in JSON: the views of some 80,000 beams. Lists take twenty times as much memory as they are long.
MOST_TEXT = 20 << 20
#: What is unpacked at a time to see how much there is.
_PIECE = 1 << 20


def memory() -> int:
    """Bytes of memory that the machine has; 8 GiB where the system does not tell."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return 8 * 2**30


def check_file(path: Path) -> Path:
    """Return `path`, or raise `InputError` where it is a pipe, a device or a socket: such may never end."""
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise InputError(f"{path} is a pipe, a device or a socket: give a file")
    return path


def check_text(size: int) -> None:
    """Raise `InputError` where what is to be written of a cube beside its arrays is longer than what is read again."""
    if size > MOST_TEXT:
        raise InputError(
            f"a cube says at most {MOST_TEXT >> 20} MiB beside its arrays, and this one more: "
            "give fewer pictures, lamps and screens, or say less in its names, scores and provenance"
        )


def too_large(path: Path) -> InputError:
    """Return the exception for a picture that is larger than any may be."""
    return InputError(
        f"{path} has more than {MOST_PIXELS / 1e6:g} megapixels, the most a picture can have: make it smaller first"
    )


def crowded(path: Path) -> InputError:
    """Return the exception for a file of more pictures than any may hold."""
    return InputError(f"{path} holds more than {MOST_PICTURES} pictures, the most that one file can: make it shorter")


def unpacks_beyond(packed: bytes, most: int, *, wbits: int = zlib.MAX_WBITS) -> bool:
    """Whether deflated bytes, or those of an LZMA stream if `wbits` is 0, unpack to more than `most`; none are kept."""
    unpacker = zlib.decompressobj(wbits) if wbits else lzma.LZMADecompressor()
    size = 0
    for at in range(0, len(packed), _PIECE):  # what is not unpacked yet is copied each time: never all of it
        rest, made = packed[at : at + _PIECE], 1
        while (rest or made) and not unpacker.eof and size <= most:
            made = len(unpacker.decompress(rest, _PIECE))
            rest = getattr(unpacker, "unconsumed_tail", b"")
            size += made
    return size > most


class Budget:
    """Pixels that may still be unpacked, so that no file fills the machine's memory: half of it, at most."""

    def __init__(self) -> None:
        self.pixels = memory() // 2 // _BYTES_PER_PIXEL

    def check(self, path: Path, *shapes: tuple[int, int]) -> None:
        """Raise `InputError` where more pictures, whose rows and columns a header tells, are too large or too many."""
        pixels = [rows * columns for rows, columns in shapes]
        if max(pixels, default=0) > MOST_PIXELS:
            raise too_large(path)
        if len(shapes) > MOST_PICTURES:
            raise crowded(path)
        if self.pixels < sum(pixels):
            raise InputError(
                f"{path} is one too many: with it, pictures fill more than half of this machine's memory: "
                "give fewer or smaller ones"
            )

    def spend(self, path: Path, rows: int, columns: int) -> None:
        """Take one picture's pixels off, after `check`."""
        self.check(path, (rows, columns))
        self.pixels -= rows * columns
