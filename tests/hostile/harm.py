"""Bytes that are changed, lost or put in: anywhere in a file, or inside a part of it whose checksum is then right."""

import gzip
import random
import zipfile
import zlib
from collections.abc import Callable
from io import BytesIO

from numcodecs import Zstd

PNG_START = b"\x89PNG\r\n\x1a\n"
ZIP_START = b"PK\3\4"
#: What sizes and counts are replaced by.
NUMBERS = (b"\xff\xff\xff\xff", b"\0\0\0\0", b"\x7f\xff\xff\xff", b"\0\0\0\1", b"1e999", b"nan", b"9" * 30)
#: How packed bytes begin, and what unpacks and packs them with a checksum.
PACKERS: dict[bytes, tuple[Callable[[bytes], bytes], Callable[[bytes], bytes]]] = {
    b"\x28\xb5\x2f\xfd": (Zstd().decode, Zstd(checksum=True).encode),
    b"\x1f\x8b": (gzip.decompress, gzip.compress),
    b"\x78": (zlib.decompress, zlib.compress),
}


def harmed(chance: random.Random, honest: bytes) -> bytes:
    """The same file with one to twenty places changed, one in five of them cut short too."""
    data = bytearray(honest)
    for _ in range(chance.choice((1, 2, 5, 20))):
        at, length = chance.randrange(len(data) + 1), chance.randrange(1, 20)
        how = chance.randrange(4)
        if how == 0 and at < len(data):
            data[at] = chance.randrange(256)
        elif how == 1:
            number = chance.choice(NUMBERS)
            data[at : at + len(number)] = number
        elif how == 2 and len(data) > length:
            del data[at : at + length]
        else:
            data[at:at] = chance.randbytes(length)
    return bytes(data[: chance.randrange(len(data) + 1)] if chance.random() < 0.2 else data)


def harmed_inside(chance: random.Random, honest: bytes) -> bytes:
    """The same PNG or zip archive with one of its parts harmed, in half of them before it is packed; checksums hold.

    Other files have no checksums.
    """
    if honest.startswith(PNG_START):
        chunks = chunks_of(honest)
        at = chance.randrange(len(chunks) - 1)
        chunks[at] = (chunks[at][0], _harmed_part(chance, chunks[at][1], 4 * (chunks[at][0] == b"fdAT")))
        return png_of(chunks)
    if honest.startswith(ZIP_START):
        with zipfile.ZipFile(BytesIO(honest)) as archive:
            members = {name: archive.read(name) for name in archive.namelist()}
        name = chance.choice(list(members))
        members[name] = _harmed_part(chance, members[name])
        return zip_of(members)
    return harmed(chance, honest)


def _harmed_part(chance: random.Random, content: bytes, head: int = 0) -> bytes:
    """One part harmed; where it is packed behind a head of so many bytes, it may be what is inside that is harmed."""
    for start, (unpack, pack) in PACKERS.items():
        if content[head:].startswith(start) and chance.random() < 0.5:
            return content[:head] + pack(harmed(chance, unpack(content[head:])))
    return harmed(chance, content)


def chunks_of(png: bytes) -> list[tuple[bytes, bytes]]:
    """Name and content of each chunk of an honest PNG."""
    chunks, at = [], len(PNG_START)
    while at < len(png):
        length = int.from_bytes(png[at : at + 4], "big")
        chunks.append((png[at + 4 : at + 8], png[at + 8 : at + 8 + length]))
        at += 12 + length
    return chunks


def png_of(chunks: list[tuple[bytes, bytes]]) -> bytes:
    """A PNG of these chunks, with their checksums."""
    return PNG_START + b"".join(
        len(content).to_bytes(4, "big") + name + content + zlib.crc32(name + content).to_bytes(4, "big")
        for name, content in chunks
    )


def zip_of(members: dict[str, bytes]) -> bytes:
    """A zip archive of these members, with their checksums."""
    made = BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return made.getvalue()
