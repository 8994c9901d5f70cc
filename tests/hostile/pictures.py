"""Pictures that state enormous sizes or counts in a small file."""

import io
import struct
import warnings
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

import lightcube as lc

MILLION = 1_000_000
GIGABYTE = 10**9


def blanks(size: int, wbits: int = 15, begins: bytes = b"") -> bytes:
    """So many bytes of nothing, deflated, behind others: a million are packed, and stand there again and again."""
    packer = zlib.compressobj(9, wbits=-15)
    head = packer.compress(begins) + packer.flush(zlib.Z_FULL_FLUSH)
    million = packer.compress(bytes(MILLION)) + packer.flush(zlib.Z_FULL_FLUSH)
    raw = head + million * (size // MILLION) + packer.flush()
    if wbits == -15:
        return raw
    if wbits == 31:
        checked = struct.pack("<II", crc_of_blanks(size, begins), (size + len(begins)) % 2**32)
        return b"\x1f\x8b\x08\0\0\0\0\0\0\xff" + raw + checked
    assert not begins
    return b"\x78\xda" + raw + struct.pack(">HH", size % 65521, 1)


def crc_of_blanks(size: int, begins: bytes = b"") -> int:
    """The checksum of so many bytes of nothing behind others."""
    found, million = zlib.crc32(begins), bytes(MILLION)
    for _ in range(size // MILLION):
        found = zlib.crc32(million, found)
    return found


def chunk(name: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))


def png(columns: int, rows: int, pixels: bytes, before: bytes = b"", bits: int = 8, behind: bytes = b"") -> bytes:
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, bits, 2, 0, 0, 0))
    body = before + chunk(b"IDAT", pixels) + behind
    return b"\x89PNG\r\n\x1a\n" + header + body + chunk(b"IEND", b"")


def apng_frame(number: int, columns: int = 1, rows: int = 1) -> bytes:
    control = chunk(b"fcTL", struct.pack(">IIIIIHHBB", number, columns, rows, 0, 0, 1, 10, 0, 0))
    return control + chunk(b"fdAT", struct.pack(">I", number + 1) + zlib.compress(b"\0\0\0\0"))


def apng(columns: int, rows: int, count: int) -> bytes:
    first = chunk(b"fcTL", struct.pack(">IIIIIHHBB", 0, columns, rows, 0, 0, 1, 10, 0, 0))
    before = chunk(b"acTL", struct.pack(">II", count, 0)) + first
    pixels = blanks(rows * (3 * columns + 1) // MILLION * MILLION + MILLION)
    return png(columns, rows, pixels, before, behind=b"".join(apng_frame(2 * k - 1) for k in range(1, count)))


def gif(columns: int, rows: int, count: int) -> bytes:
    screen = b"GIF89a" + struct.pack("<HHBBB", columns, rows, 0x80, 0, 0) + bytes(6)
    frame = b"," + struct.pack("<HHHHB", 0, 0, 1, 1, 0) + b"\x02\x02\x44\x01\0"
    return screen + frame * count + b";"


def tags(entries: list[tuple[int, int, int, int]], following: int) -> bytes:
    body = b"".join(struct.pack("<HHII", *entry) for entry in entries)
    return struct.pack("<H", len(entries)) + body + struct.pack("<I", following)


def tiff(columns: int, rows: int, packed: bytes, *, compression: int = 8, bits: int = 16, strip: int = 0) -> bytes:
    at = 8
    entries = [
        *((256, 4, 1, columns), (257, 4, 1, rows), (258, 3, 1, bits), (259, 3, 1, compression), (262, 3, 1, 1)),
        *((273, 4, 1, 200), (277, 3, 1, 1), (278, 4, 1, strip or rows), (279, 4, 1, len(packed))),
    ]
    return (b"II*\0" + struct.pack("<I", at) + tags(entries, 0)).ljust(200, b"\0") + packed


def tiff_of_pages(count: int) -> bytes:
    """So many pages, all of the same pixel."""
    data = bytearray(b"II*\0" + struct.pack("<I", 8))
    entries = [
        *((256, 4, 1, 1), (257, 4, 1, 1), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 1)),
        *((273, 4, 1, 0), (277, 3, 1, 1), (278, 4, 1, 1), (279, 4, 1, 1)),
    ]
    size = len(tags(entries, 0))
    for page in range(count):
        data += tags(entries, 8 + size * (page + 1) if page < count - 1 else 0)
    return bytes(data)


def webp(columns: int, rows: int, count: int) -> bytes:
    """An animation on a canvas of that size, of pictures of one pixel."""
    packed = io.BytesIO()
    Image.new("RGB", (1, 1)).save(packed, "WEBP", lossless=True)
    bitstream = packed.getvalue()[12:]

    def part(name: bytes, content: bytes) -> bytes:
        return name + struct.pack("<I", len(content)) + content + b"\0" * (len(content) % 2)

    def three(number: int) -> bytes:
        return struct.pack("<I", number)[:3]

    frame = part(b"ANMF", three(0) * 2 + three(0) * 2 + three(100) + b"\0" + bitstream)
    head = part(b"VP8X", b"\x02\0\0\0" + three(columns - 1) + three(rows - 1)) + part(b"ANIM", bytes(6))
    body = b"WEBP" + head + frame * count
    return b"RIFF" + struct.pack("<I", len(body)) + body


def jpeg(columns: int, rows: int, scans: int = 0) -> bytes:
    """A small JPEG whose header says another size; with so many more scans of nothing, if it is progressive."""
    packed = io.BytesIO()
    Image.new("RGB", (16, 16)).save(packed, "JPEG", progressive=scans > 0)
    data = packed.getvalue()
    for marker in (b"\xff\xc0", b"\xff\xc2"):
        at = data.find(marker)
        if at > 0:
            data = data[: at + 5] + struct.pack(">HH", rows, columns) + data[at + 9 :]
    scan = b"\xff\xda\x00\x08\x01\x01\x00\x01\x3f\x10"
    return data[:-2] + (scan + b"\x00") * scans + data[-2:]


def film(path: Path, **changes: int) -> bytes:
    """A film whose header says other sizes or counts."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        lc.save(np.zeros((4, 16, 16, 3), np.float32), path, overwrite=True)
    data = bytearray(path.read_bytes())
    if "size" in changes:
        at = data.find(b"avc1") + 28
        data[at : at + 4] = struct.pack(">HH", changes["size"], changes["size"])
        at = data.find(b"tkhd") + 4 + 76
        data[at : at + 8] = struct.pack(">II", changes["size"] << 16, changes["size"] << 16)
    if "samples" in changes:
        at = data.find(b"stsz") + 8
        data[at : at + 8] = struct.pack(">II", 1, changes["samples"])
        at = data.find(b"stsc") + 8
        data[at : at + 16] = struct.pack(">IIII", 1, 1, changes["samples"], 1)
        at = data.find(b"stts") + 8
        data[at : at + 12] = struct.pack(">III", 1, changes["samples"], 1)
    return bytes(data)


def bytes_pictures() -> dict[str, Callable[[Path], bytes]]:
    """By file's name, what makes its bytes."""
    return {
        "wide.gif": lambda _: gif(65535, 65535, 2),
        "many-large.gif": lambda _: gif(5000, 5000, 1000),
        "million.gif": lambda _: gif(1, 1, MILLION),
        "wide.png": lambda _: png(60000, 60000, blanks(MILLION)),
        "huge.png": lambda _: png(2**31 - 1, 2**31 - 1, b""),
        "cut-250.png": lambda _: png(15811, 15811, blanks(MILLION)),
        "more-pixels.png": lambda _: png(4, 4, blanks(GIGABYTE)),
        "more-pixels-16.png": lambda _: png(4, 4, blanks(GIGABYTE), bits=16),
        "text.png": lambda _: png(4, 4, blanks(MILLION), chunk(b"zTXt", b"a\0\0" + blanks(GIGABYTE))),
        "profile.png": lambda _: png(4, 4, blanks(MILLION), chunk(b"iCCP", b"a\0\0" + blanks(GIGABYTE))),
        "chunks.png": lambda _: png(4, 4, blanks(MILLION), chunk(b"abCd", b"") * MILLION),
        "many-large.apng": lambda _: apng(5000, 5000, 1000),
        "many.apng": lambda _: apng(1, 1, MILLION // 5),
        "chunks.apng": lambda _: apng(2, 2, 2).replace(
            b"\0\0\0\0IEND", chunk(b"abCd", b"") * MILLION + b"\0\0\0\0IEND"
        ),
        "pieces.apng": lambda _: apng(2, 2, 2).replace(
            b"\0\0\0\0IEND", chunk(b"fdAT", b"\0\0\0\3") * MILLION + b"\0\0\0\0IEND"
        ),
        "states-many.apng": lambda _: apng(1, 1, 2).replace(
            chunk(b"acTL", struct.pack(">II", 2, 0)), chunk(b"acTL", struct.pack(">II", 2**32 - 1, 0))
        ),
        "wide.tif": lambda _: tiff(60000, 60000, blanks(MILLION)),
        "wide-8.tif": lambda _: tiff(60000, 60000, blanks(MILLION), bits=8),
        "cut-250.tif": lambda _: tiff(15811, 15811, blanks(MILLION)),
        "unpacks.tif": lambda _: tiff(100, 100, blanks(2 * GIGABYTE)),
        "unpacks-8.tif": lambda _: tiff(100, 100, blanks(2 * GIGABYTE), bits=8),
        "rows.tif": lambda _: tiff(100, 100, blanks(MILLION), strip=2**31 - 1),
        "many.tif": lambda _: tiff_of_pages(MILLION // 5),
        "tag.tif": lambda _: tiff(4, 4, blanks(MILLION)).replace(
            struct.pack("<HHII", 277, 3, 1, 1), struct.pack("<HHII", 277, 3, 2**30, 8)
        ),
        "canvas.webp": lambda _: webp(16384, 16384, 2),
        "many-large.webp": lambda _: webp(15000, 15000, 1000),
        "million.webp": lambda _: webp(1, 1, MILLION // 10),
        "wide.jpg": lambda _: jpeg(65000, 65000),
        "cut-250.jpg": lambda _: jpeg(15811, 15811),
        "scans.jpg": lambda _: jpeg(4000, 4000, 100_000),
        "samples.mp4": lambda folder: film(folder / "honest.mp4", samples=2**31 - 1),
    }
