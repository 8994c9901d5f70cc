"""A Zarr store that is not trusted: files only, documents of a bounded length, chunks that unpack to what is stated."""

import zlib
from collections.abc import Callable

from zarr.abc.codec import Codec
from zarr.abc.store import ByteRequest
from zarr.codecs import BloscCodec, BytesCodec, Crc32cCodec, GzipCodec, TransposeCodec, ZstdCodec
from zarr.core.buffer import Buffer, BufferPrototype
from zarr.storage import LocalStore, WrapperStore, ZipStore

from lightcube.errors import InputError
from lightcube.io._bounds import MOST_TEXT, unpacks_beyond

_DOCUMENT = "zarr.json"
#: What packing adds at most to what cannot be packed.
_SLACK = 1 << 16
_GZIP = zlib.MAX_WBITS | 16
_ZSTD_START, _ZSTD_BLOCK, _REPEATED = b"\x28\xb5\x2f\xfd", 1 << 17, 1
#: Blocks of a frame that does not say how long it is may be short ones: so much more than is stated is let through.
_UNTOLD = 64 << 20


class Guarded(WrapperStore[LocalStore | ZipStore]):
    """A store that gives what is in bounds, and raises for what is not.

    Parameters
    ----------
    size
        Bytes that stand under a key, before they are unpacked.
    damaged
        Makes the error of what is wrong.
    """

    def __init__(
        self, store: LocalStore | ZipStore, size: Callable[[str], int], damaged: Callable[[str], InputError]
    ) -> None:
        super().__init__(store)
        self._size, self._damaged = size, damaged
        self._most = 0
        self._packing: tuple[Codec, ...] = ()

    def expect(self, codecs: tuple[Codec, ...], most: int) -> None:
        """Let chunks come from now on that `codecs` unpack to so many bytes at most."""
        packing = tuple(codec for codec in codecs if not isinstance(codec, BytesCodec | Crc32cCodec | TransposeCodec))
        if len(packing) > 1 or not all(isinstance(codec, ZstdCodec | GzipCodec | BloscCodec) for codec in packing):
            names = ", ".join(type(codec).__name__ for codec in packing)
            raise self._damaged(f"it is packed by {names}, which is not read: pack it with zstd")
        self._most, self._packing = most, packing

    async def get(self, key: str, prototype: BufferPrototype, byte_range: ByteRequest | None = None) -> Buffer | None:
        """Return what stands under a key."""
        is_document = key.rpartition("/")[2] == _DOCUMENT
        if self._size(key) > (MOST_TEXT if is_document else self._most + self._most // 8 + _SLACK):
            raise self._damaged(f"{key} is larger than it can be")
        data = await super().get(key, prototype, byte_range)
        if data is not None and not is_document and any(_swells(codec, data, self._most) for codec in self._packing):
            raise self._damaged(f"{key} unpacks to more than it states")
        return data


def _swells(codec: Codec, data: Buffer, most: int) -> bool:
    """Whether a packed chunk says, or is found, to unpack to more than `most` bytes."""
    packed = data.to_bytes()
    if isinstance(codec, ZstdCodec):
        return _zstd_least(packed) > most
    if isinstance(codec, BloscCodec):
        return int.from_bytes(packed[4:8], "little") > most
    return unpacks_beyond(packed, most, wbits=_GZIP)


def _zstd_least(packed: bytes) -> int:
    """Bytes that a Zstandard frame says it unpacks to, or else what its blocks may hold, less `_UNTOLD` (RFC 8878)."""
    at = size = 0
    while packed[at : at + 4] == _ZSTD_START and at + 5 < len(packed):
        flags = packed[at + 4]
        single = flags >> 5 & 1
        length = (single, 2, 4, 8)[flags >> 6]
        at += 6 - single + (0, 1, 2, 4)[flags & 3]
        if length:
            return size + int.from_bytes(packed[at : at + length], "little")
        last = 0
        while not last and at + 3 <= len(packed):
            head = int.from_bytes(packed[at : at + 3], "little")
            last, kind, length = head & 1, head >> 1 & 3, head >> 3
            size += length if kind <= _REPEATED else _ZSTD_BLOCK
            at += 3 + (1 if kind == _REPEATED else length)
        at += 4 * (flags >> 2 & 1)
    return size - _UNTOLD
