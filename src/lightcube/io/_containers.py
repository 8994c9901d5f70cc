"""Whether a file is as long as it says itself: decoders take what there is of a cut file and say nothing."""

from typing import BinaryIO, Literal

_EBML_SEGMENT = b"\x18\x53\x80\x67"


def is_cut_short(file: BinaryIO) -> bool:
    """Whether the container in `file` says that there should be more of it than there is.

    Knows ISO media (MP4, MOV), RIFF (AVI, WebP), Matroska (MKV, WebM), GIF and TIFF; of others it says False.
    """
    size = file.seek(0, 2)
    file.seek(0)
    start = file.read(12)
    if start[:4] == b"GIF8":
        return _gif_end_missing(file)
    if start[4:8] in (b"ftyp", b"moov", b"mdat", b"wide", b"free", b"skip"):
        return _boxes_end(file, size) > size
    if start[:4] == b"RIFF":
        return int.from_bytes(start[4:8], "little") + 8 > size
    if start[:4] == b"\x1a\x45\xdf\xa3":
        return _segment_end(file) > size
    if start[:2] in (b"II", b"MM"):
        return _page_missing(file, start, size)
    return False


def _page_missing(file: BinaryIO, start: bytes, size: int) -> bool:
    """Whether the chain of a TIFF's directories leads beyond the file (TIFF 6.0, section 2; BigTIFF)."""
    order: Literal["little", "big"] = "little" if start[:2] == b"II" else "big"
    big = int.from_bytes(start[2:4], order) == 43
    wide, counted, entry = (8, 8, 20) if big else (4, 2, 12)
    seen = set()
    file.seek(8 if big else 4)
    while (at := int.from_bytes(file.read(wide), order)) and at not in seen:
        seen.add(at)
        file.seek(at)
        end = at + counted + int.from_bytes(file.read(counted), order) * entry
        if end + wide > size:
            return True
        file.seek(end)
    return False


def _gif_end_missing(file: BinaryIO) -> bool:
    """Whether a GIF ends before the block that says it is over (GIF89a specification, 17 to 27)."""
    file.seek(10)
    _skip_palette(file, behind=2)
    while block := file.read(1):
        if block == b";":
            return False
        if block == b",":
            file.seek(8, 1)
            _skip_palette(file, behind=1)
        elif block == b"!":
            file.seek(1, 1)
        else:  # damaged: for the decoder to refuse
            return False
        while (length := int.from_bytes(file.read(1), "little")) > 0:
            file.seek(length, 1)
    return True


def _skip_palette(file: BinaryIO, behind: int) -> None:
    """Read a GIF's flags, and skip `behind` bytes and the palette that the flags announce."""
    flags = int.from_bytes(file.read(1), "little")
    file.seek(behind + (3 * 2 << (flags & 7) if flags & 0x80 else 0), 1)


def _boxes_end(file: BinaryIO, size: int) -> int:
    """Where the last top-level box of an ISO media file ends (ISO/IEC 14496-12, 4.2)."""
    at = 0
    while at + 8 <= size:
        file.seek(at)
        head = file.read(16)
        length = int.from_bytes(head[:4], "big")
        if length == 1:
            length = int.from_bytes(head[8:16], "big")
        if length < 8:  # 0: up to the end of the file; anything else is for the decoder to refuse
            return size
        at += length
    return at if at >= size else size + 1


def _segment_end(file: BinaryIO) -> int:
    """Where the segment of a Matroska file ends by its own word; 0 where it does not tell (RFC 8794, 4 and 6)."""
    file.seek(4)
    header = _vint(file)
    file.seek(max(header, 0), 1)
    if file.read(4) != _EBML_SEGMENT:
        return 0
    length = _vint(file)
    return file.tell() + length if length >= 0 else 0


def _vint(file: BinaryIO) -> int:
    """Read the next variable-size integer of an EBML file; -1 where it says that the length is unknown."""
    first = int.from_bytes(file.read(1), "big")
    if not first:
        return 0
    width = 9 - first.bit_length()
    value = int.from_bytes(bytes([first & (0xFF >> width)]) + file.read(width - 1), "big")
    return -1 if value == (1 << (7 * width)) - 1 else value
