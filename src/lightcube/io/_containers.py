"""Whether a file is as long as it says itself: decoders take what there is of a cut file and say nothing."""

from collections import deque
from collections.abc import Iterator
from itertools import islice
from typing import BinaryIO, Literal

_EBML_SEGMENT = b"\x18\x53\x80\x67"
_EBML_CLUSTER = b"\x1f\x43\xb6\x75"
#: Boxes that stand at the top of ISO media files.
_BOXES = frozenset(
    b"ftyp styp moov moof mdat free skip wide uuid meta sidx ssix mfra prft emsg pnot udta pdin imda".split()
)
_UNTOLD = 0xFFFFFFFF


def is_cut_short(file: BinaryIO) -> bool:
    """Whether the container in `file` says that there should be more of it than there is.

    Knows ISO media (MP4, MOV), RIFF (AVI, WebP), Matroska (MKV, WebM), GIF and TIFF; of others, and of an AVI that was
    written through a pipe and does not know its length, it says False.
    """
    size = file.seek(0, 2)
    file.seek(0)
    start = file.read(12)
    if start[:4] == b"GIF8":
        return _gif_end_missing(file)
    if start[4:8] in _BOXES:
        return _boxes_cut(file, size)
    if start[:4] == b"RIFF":
        return _riffs_cut(file, size)
    if start[:4] == b"\x1a\x45\xdf\xa3":
        return _elements_cut(file, size)
    if start[:2] in (b"II", b"MM"):
        return _page_missing(file, start, size)
    return False


def count_of_pictures(file: BinaryIO, most: int) -> int:
    """How many pictures a GIF or a TIFF holds, by its blocks or directories, counted to one more than `most`.

    Of others, which say so themselves, and of damaged ones, there is the number that was found.
    """
    file.seek(0)
    start = file.read(8)
    if start[:4] == b"GIF8":
        blocks = _gif_blocks(file)
        return sum(1 for _ in islice((block for block in blocks if block == b","), most + 1))
    if start[:2] in (b"II", b"MM"):
        return sum(1 for _ in islice(_directories(file, start), most + 1))
    return 0


def _directories(file: BinaryIO, start: bytes) -> Iterator[int]:
    """Yield where each directory of a TIFF ends, one after the other, also beyond the file (TIFF 6.0, 2; BigTIFF)."""
    order: Literal["little", "big"] = "little" if start[:2] == b"II" else "big"
    big = int.from_bytes(start[2:4], order) == 43
    wide, counted, entry = (8, 8, 20) if big else (4, 2, 12)
    seen = set()
    file.seek(8 if big else 4)
    while (at := int.from_bytes(file.read(wide), order)) and at not in seen:
        seen.add(at)
        file.seek(at)
        end = at + counted + int.from_bytes(file.read(counted), order) * entry
        yield end + wide
        file.seek(end)


def _page_missing(file: BinaryIO, start: bytes, size: int) -> bool:
    """Whether the chain of a TIFF's directories leads beyond the file."""
    return any(end > size for end in _directories(file, start))


def _gif_end_missing(file: BinaryIO) -> bool:
    """Whether a GIF ends before the block that says it is over."""
    last = deque(_gif_blocks(file), maxlen=1)
    return not last or last[0] in b",!"  # any other that is not ";" is damaged: for the decoder to refuse


def _gif_blocks(file: BinaryIO) -> Iterator[bytes]:
    """Yield what each block of a GIF begins with, to the first that is no picture and no extension (GIF89a, 17-27)."""
    file.seek(10)
    _skip_palette(file, behind=2)
    while block := file.read(1):
        yield block
        if block == b",":
            file.seek(8, 1)
            _skip_palette(file, behind=1)
        elif block == b"!":
            file.seek(1, 1)
        else:
            return
        while (length := int.from_bytes(file.read(1), "little")) > 0:
            file.seek(length, 1)


def _skip_palette(file: BinaryIO, behind: int) -> None:
    """Read a GIF's flags, and skip `behind` bytes and the palette that the flags announce."""
    flags = int.from_bytes(file.read(1), "little")
    file.seek(behind + (3 * 2 << (flags & 7) if flags & 0x80 else 0), 1)


def _boxes_cut(file: BinaryIO, size: int) -> bool:
    """Whether a top-level box of an ISO media file ends behind its end (ISO/IEC 14496-12, 4.2).

    What stands behind the last box and is no box is nobody's loss: cameras and messengers leave such bytes.
    """
    at = 0
    while at + 8 <= size:
        file.seek(at)
        head = file.read(16)
        length = int.from_bytes(head[:4], "big")
        if length == 1:
            length = int.from_bytes(head[8:16], "big")
        if head[4:8] not in _BOXES or length < 8:  # 0: up to the end of the file
            return False
        at += length
    return at > size


def _riffs_cut(file: BinaryIO, size: int) -> bool:
    """Whether a RIFF file, or one of the parts that a large AVI is made of, ends behind the end of the file."""
    at = 0
    while True:
        file.seek(at)
        head = file.read(8)
        length = int.from_bytes(head[4:], "little")
        # What is written through a pipe does not know its length.
        if head[:4] != b"RIFF" or length in (0, _UNTOLD):
            return False
        if at + 8 + length > size:
            return True
        at += 8 + length + length % 2


def _elements_cut(file: BinaryIO, size: int) -> bool:
    """Whether an element of a Matroska file ends behind the end of the file (RFC 8794, 4 to 6).

    A segment that knows its length says so at once; of one that was written through a pipe its last block does.
    """
    file.seek(0)
    while file.tell() < size:
        start = file.read(1)
        name = start + file.read(8 - start[0].bit_length())
        length = _vint(file)
        if name in (_EBML_SEGMENT, _EBML_CLUSTER) and length < 0:
            continue  # its elements follow
        if start == b"\0" or length < 0:  # damaged: for the decoder to refuse
            return False
        if file.tell() == size:  # the file ends in the head of an element
            return True
        file.seek(length, 1)
        if name == _EBML_SEGMENT:
            break
    return file.tell() > size


def _vint(file: BinaryIO) -> int:
    """Read the next variable-size integer of an EBML file; -1 where it says that the length is unknown."""
    first = int.from_bytes(file.read(1), "big")
    if not first:
        return 0
    width = 9 - first.bit_length()
    value = int.from_bytes(bytes([first & (0xFF >> width)]) + file.read(width - 1), "big")
    return -1 if value == (1 << (7 * width)) - 1 else value
